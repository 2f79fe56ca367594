from __future__ import annotations

import sys
from pathlib import Path

import pytest

# Processes that run a study find it by its name.
sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def studies():
    """The studies of the tests, under the name that a process of its own imports them by."""
    import studies

    return studies
