"""Trial records: read, describe, check, measure and write.

The names are imported on first use: pandas costs 0.3 s.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_WHERE = {
    "COLUMNS": "columns",
    "Measures": "measures",
    "Source": "source",
    "Trial": "trial",
    "TrialFormat": "format",
    "check_identifiable_input": "fitness",
    "check_regular": "fitness",
    "measure": "measuring",
    "overshoots_of": "zigzag",
    "read_format": "format",
    "read_trial": "reading",
    "write_trial": "writing",
}

__all__ = list(_WHERE)


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        return getattr(import_module(f"{__name__}.{_WHERE[name]}"), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted(_WHERE)
