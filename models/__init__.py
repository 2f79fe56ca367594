"""Ship models, declared once each: one file a family, found without being listed.

``from shipid.models import DeKeizer`` looks through the files of this folder for the name.
"""

from __future__ import annotations

import importlib
import pkgutil
from typing import Any


def __getattr__(name: str) -> Any:
    if name.startswith("_"):
        raise AttributeError(name)
    for found in pkgutil.iter_modules(__path__):
        module = importlib.import_module(f"{__name__}.{found.name}")
        if name == found.name:
            return module
        if name in vars(module):
            globals()[name] = vars(module)[name]
            return globals()[name]
    raise AttributeError(f"no file in shipid.models declares '{name}'")
