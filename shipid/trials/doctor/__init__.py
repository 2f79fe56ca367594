"""The trial doctor: what is wrong with a record, what it does to an identification, and what repairs it.

The names are imported on first use: pandas and scipy cost half a second.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_WHERE = {
    "Diagnosis": "findings",
    "Finding": "findings",
    "Stretch": "findings",
    "check_trial": "examination",
    "fix_trial": "repair",
}

__all__ = list(_WHERE)


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        return getattr(import_module(f"{__name__}.{_WHERE[name]}"), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted(_WHERE)
