"""Every installed model with a ship that holds its numbers, and points at which to compare."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from shipid import Model, ParameterSet
from shipid.declaration.model import Evaluation
from shipid.generation.record import make_record
from shipid.parameters.catalogue import known_models, known_ships

# Sizes at which nothing vanishes and no term hides in another.
SIZES = {"x": 100.0, "y": 100.0, "psi": 1.0, "r": 0.01, "w": 1e-4, "v": 0.3, "r_star": 0.4, "u_star": 0.2, "s_star": 3.0,
         "omega": 0.03, "beta": 0.1, "Omega": 0.003, "dOmega": 0.001, "delta": 0.3, "r_disturbance": 1e-5,
         "u_disturbance": 1e-3, "current_north": 0.5, "current_east": 0.5, "delta_lagged": 0.25,
         "wind_speed": 8.0, "wind_direction": 1.0, "r_residual": 1e-5, "vx": 5.0, "vy": 5.0, "ax": 0.1, "ay": 0.1,
         "domega": 0.01, "v_disturbance": 1e-3, "n": 2.0, "more": 1e-3, "turn": 0.02, "curvature": 2e-3, "dcurvature": 1e-3}  # fmt: skip


@dataclass(frozen=True)
class Pair:
    """A model and a ship that determines all its coefficients."""

    model: Model
    ship: ParameterSet
    speed: float
    coefficients: dict[str, float]

    def __repr__(self) -> str:
        return f"{self.model.name}-{self.ship.name}"

    @property
    def unit_time(self) -> float:
        """L/U in s."""
        return (self.ship.particular("L", "m") or 0.0) / self.speed

    def random(self, rng: np.random.Generator) -> dict[str, float]:
        """Draw a point: signed states and inputs, coefficients within a tenth of the ship's."""
        names = self.model.states + self.model.inputs
        point = {n: rng.choice([-1, 1]) * rng.uniform(0.5, 1.5) * SIZES[n] for n in names if n in SIZES}
        point |= {n: rng.uniform(0.5, 1.0) * self.speed for n in names if n in ("u", "V_U")}
        point |= {n: self.speed for n in names if n == "cruise"}
        point |= {n: v * rng.uniform(0.9, 1.1) for n, v in self.coefficients.items()}
        missing = set(names) - set(point)
        assert not missing, f"say how large {missing} of {self.model.name} are"
        return point


def _pairs() -> list[Pair]:
    found = []
    for model in known_models().values():
        for ship in known_ships().values():
            speed = ship.particular("speed", "m/s")
            values = ship.values(model, speed=speed)
            if speed and not set(model.parameters + model.constants) - set(values):
                found.append(Pair(model, ship, speed, values))
                if not values:
                    break  # the motion of a point is the same beside every ship
    return found


PAIRS = _pairs()
ONE_EACH = list({p.model.name: p for p in reversed(PAIRS)}.values())


def pytest_generate_tests(metafunc: Any) -> None:
    """`pair`: every model with every ship it fits; `one`: every model once; `continuous`, `sailing`: the continuous ones of them, and those with a heading."""
    choices = {
        "pair": PAIRS,
        "one": ONE_EACH,
        "sailing": [p for p in ONE_EACH if not p.model.is_sampled and "psi" in p.model.states],
        "continuous": [p for p in ONE_EACH if not p.model.is_sampled],
    }
    for name, pairs in choices.items():
        if name in metafunc.fixturenames:
            metafunc.parametrize(name, pairs, ids=repr)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(7)


@pytest.fixture(scope="session")
def plain() -> Callable[..., dict[str, Any]]:
    """Every right-hand side of a model, evaluated without CasADi over whatever numbers are given."""

    def run(model: Model, values: dict[str, Any], *kinds: str) -> dict[str, Any]:
        evaluation = Evaluation(model, values)
        result: dict[str, Any] = {}
        for kind in kinds or ("rate", "next", "equals"):
            result |= evaluation.right_hand_sides(kind)
        return result

    return run


def zigzag(pair: Pair, count: int, interval: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Initial states, inputs and intervals of a run in which the rudder swings between two sides, never through rest.

    The rudder goes over within one sample; current and disturbances act all the time.
    """
    swing = np.where((np.arange(count) // 25) % 2 == 0, 0.15, -0.12)
    constant = {"u": pair.speed, "cruise": pair.speed, "v": -0.1, "r_disturbance": 1e-6, "u_disturbance": 1e-5,
                "current_north": 0.4, "current_east": -0.3, "wind_speed": 5.0, "wind_direction": 1.0, "n": 1.5 * (320.0 / (pair.ship.particular("L", "m") or 320.0)) ** 0.5}  # fmt: skip
    rows = {n: np.full(count, constant.get(n, 0.0)) for n in pair.model.inputs} | {"delta": swing, "Omega": swing / 50}
    x0 = np.array([{"u": pair.speed, "V_U": pair.speed, "psi": 0.3}.get(s, 0.0) for s in pair.model.states])
    return x0, np.array([rows[n] for n in pair.model.inputs]), np.full(count, interval)


@pytest.fixture(scope="session")
def sail() -> Callable[..., Any]:
    """Return `zigzag`: it is a fixture so that test files need not import this one."""
    return zigzag


@pytest.fixture(scope="session")
def named() -> dict[str, Pair]:
    """Every model with a ship, by the model's name."""
    return {p.model.name: p for p in ONE_EACH}


@pytest.fixture
def run_record() -> Callable[..., Any]:
    """Run a model over a record without compiling, by names instead of vectors."""

    def run(
        model: Model,
        outputs: tuple[str, ...],
        values: dict[str, float],
        u: dict[str, Any],
        t: np.ndarray,
        **options: Any,
    ) -> np.ndarray:
        record = make_record(model, outputs, compiled=False, **options)
        system = record.system
        x0 = system.vector(system.states, values, default=0.0)
        rows = np.array([np.broadcast_to(u.get(n, values.get(n, 0.0)), t.shape) for n in system.inputs])
        p = system.vector(system.coefficients, values)
        return record(x0, rows.reshape(len(system.inputs), t.size), np.diff(t, append=t[-1]), p)[0]

    return run
