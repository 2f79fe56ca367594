from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

import shipid

ROOT = Path(__file__).resolve().parents[3]


def _load():
    spec = importlib.util.spec_from_file_location("doctor_faults", ROOT / "studies" / "_faults.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["doctor_faults"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def faults():
    """The faults the study plants."""
    return _load()


@pytest.fixture(scope="session")
def simulated():
    """Simulated trials, made once: manoeuvre, noise."""
    made = {}

    def get(manoeuvre="zigzag:20/20", noise="standard", model="de-keizer", ship="soesterberg") -> shipid.Trial:
        key = (manoeuvre, noise, model, ship)
        if key not in made:
            made[key] = shipid.simulate(
                shipid.find_model(model), ship, manoeuvre, noise=noise, seed=3, heading="40 deg"
            )
        return made[key]

    return get
