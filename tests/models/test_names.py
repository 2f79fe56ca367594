from __future__ import annotations

import subprocess
import sys
from types import ModuleType

import shipid.models
from shipid import Component, Model


def test_the_components_are_listed_and_all_of_them_are_there():
    names = [n for n in dir(shipid.models) if not n.startswith("__")]
    assert {"DeKeizer", "PlanarMotion", "SteeringMachine", "de_keizer", "norrbin"} <= set(names)
    found = {n: getattr(shipid.models, n) for n in names}
    strange = [
        n
        for n, v in found.items()
        if not (isinstance(v, Model | ModuleType) or (isinstance(v, type) and issubclass(v, Component)))
    ]
    assert strange == []
    declared = {
        n
        for module in found.values()
        if isinstance(module, ModuleType)
        for n, v in vars(module).items()
        if isinstance(v, type) and issubclass(v, Component) and v.__module__ == module.__name__ and n[0] != "_"
    }
    assert declared <= set(names)


def test_listing_imports_no_model():
    code = "import shipid.models, sys; dir(shipid.models); print('shipid.models.norrbin' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
