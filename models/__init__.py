"""Ship models: one file for each family; a new file needs no registration.

``from shipid.models import DeKeizer`` looks through the files of this folder for the name, then through the parts that
every ship joins (`shipid.parts`).
"""

from __future__ import annotations

import ast
import importlib
import pkgutil
from collections.abc import Iterator
from pathlib import Path
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


def __dir__() -> list[str]:
    """The components and joined models of all files, and the files themselves; nothing is imported for it."""
    files = [f for package in (__name__, parts.__name__) for f in _files(package)]
    names = {name for file in files for name in _declared(file)}
    return sorted({*names, *(file.stem for file in _files(__name__)), "__doc__", "__file__", "__name__"})


def _files(package: str) -> list[Path]:
    folders = importlib.import_module(package).__path__
    return [Path(folder) / f"{m.name}.py" for folder in folders for m in pkgutil.iter_modules([folder]) if not m.ispkg]


def _declared(file: Path) -> Iterator[str]:
    """Names of the components of a file, and of what it joins."""
    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef):
            names = [node.name]
        elif isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
            names = [target.id for target in node.targets if isinstance(target, ast.Name)]
        else:
            continue
        yield from (name for name in names if not name.startswith("_"))
