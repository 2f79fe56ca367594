"""Ship models: one file for each family; a new file needs no registration.

``from shipid.models import DeKeizer`` looks through the files of this folder for the name, then through the parts that
every ship joins (`shipid.parts`).
"""

from __future__ import annotations

import importlib
import pkgutil
from types import ModuleType

from shipid import parts
from shipid.declaration.component import Component
from shipid.declaration.model import Model


def __getattr__(name: str) -> type[Component] | Model | ModuleType:
    if name.startswith("_"):
        raise AttributeError(name)
    for package in (__name__, parts.__name__):
        for found in pkgutil.iter_modules(importlib.import_module(package).__path__):
            module = importlib.import_module(f"{package}.{found.name}")
            if name == found.name and package == __name__:
                return module
            if name in vars(module):
                globals()[name] = vars(module)[name]
                return globals()[name]
    raise AttributeError(f"no file in shipid.models declares '{name}'")
