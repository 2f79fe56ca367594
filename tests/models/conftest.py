from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from shipid import Component, Model, join
from shipid.declaration.model import Evaluation


def _evaluate(model: Model | type[Component], values: Mapping[str, Any]) -> dict[str, float]:
    """Every right-hand side of a model or component over plain floats; inputs not given take their default."""
    whole = model if isinstance(model, Model) else join("alone", model)
    defaults = {n: whole[n].number("default") for n in whole.inputs + whole.constants}
    known = {n: v for n, v in defaults.items() if v is not None} | dict(values)
    evaluation = Evaluation(whole, known)
    result: dict[str, Any] = {}
    for kind in ("rate", "next", "equals"):
        result |= evaluation.right_hand_sides(kind)
    return {n: float(v) for n, v in result.items()}


@pytest.fixture(scope="session")
def evaluate() -> Callable[..., dict[str, float]]:
    return _evaluate


@pytest.fixture(scope="session")
def integrate() -> Callable[..., dict[str, np.ndarray]]:
    """Runge and Kutta's classical rule over plain floats: an integrator this project did not generate."""

    def run(
        model: Model, start: Mapping[str, float], values: Mapping[str, float], seconds: float, step: float
    ) -> dict[str, np.ndarray]:
        names = model.states

        def rates(x: np.ndarray) -> np.ndarray:
            sides = _evaluate(model, dict(values) | dict(zip(names, x)))
            return np.array([sides[n] for n in names])

        x = np.array([start.get(n, 0.0) for n in names])
        rows = [x]
        for _ in range(round(seconds / step)):
            k1 = rates(x)
            k2 = rates(x + step / 2 * k1)
            k3 = rates(x + step / 2 * k2)
            k4 = rates(x + step * k3)
            x = x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            rows.append(x)
        return {n: np.array(rows)[:, i] for i, n in enumerate(names)}

    return run
