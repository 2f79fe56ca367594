"""The same filter written out by hand: complex steps and dense matrices over the declaration, without CasADi."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from shipid import Component, ExtendedKalmanFilter, find_model, find_ship, given, join, output, parameter, state
from shipid.declaration.model import Evaluation, Model
from shipid.parameters.parameter_set import ParameterSet, Value


class Yaw(Component):
    """Nomoto's first order: linear, and both states shown."""

    psi = state("rad", "heading", wraps=True)
    r = state("rad/s", "rate of turn")
    delta = given("rad", "rudder angle")
    K = parameter("1/s", "gain", start=0.05, low=0.001, high=1.0)
    tau = parameter("s", "time constant", start=30.0, low=1.0, high=300.0)
    b = parameter("rad", "rudder offset", start=0.0, low=-0.2, high=0.2)

    @psi.rate
    def turning(self):
        """Kinematics."""
        return self.r

    @r.rate
    def yaw(self):
        """Nomoto (1957)."""
        return (self.K * (self.delta + self.b) - self.r) / self.tau


class Waves(Component):
    """A lag driven by a noise that the compass shows as well: noise of the step and of the sample at once."""

    v = state("rad", "heading by the waves")
    w = given("rad", "noise that drives them", default=0.0)
    psi = given("rad", "heading", wraps=True)
    compass = output("rad", "heading shown", measures="psi", noise="0.1 deg")

    @v.rate
    def lag(self):
        """A first-order lag of 3 s."""
        return (self.w - self.v) * self.pace

    @compass.equals
    def reading(self):
        """Heading, wave motion, and half the noise at once."""
        return self.psi + self.v + 0.5 * self.w

    pace = parameter("1/s", "pace of the lag", start=0.3, low=0.01, high=5.0)


class Counted(Component):
    """A state that is defined by its next sample, beside one that has a rate."""

    r = given("rad/s", "rate of turn")
    held = state("rad/s", "rate of turn, lagged over samples")

    @held.next
    def lagged(self):
        """Half of the old, half of the new."""
        return 0.5 * self.held + 0.5 * self.r


class Surge(Component):
    """Speed with quadratic resistance, shown by a log whose curve is not straight: nothing about it is linear."""

    u = state("m/s", "forward speed")
    thrust = given("m/s^2", "thrust over mass")
    c = parameter("1/m", "resistance", start=0.01, low=0.0001, high=1.0)
    log = output("m/s", "speed shown", measures="u", noise="0.1 m/s")

    @u.rate
    def moving(self):
        """Quadratic resistance."""
        return self.thrust - self.c * self.u**2

    @log.equals
    def reading(self):
        """A log that reads a little high at speed."""
        return self.u * (1 + self.u / self.one)

    one = parameter("m/s", "scale of the log's curve", start=100.0, low=1.0, high=1e4)


yaw = join("yaw", Yaw)
waved = join("waved", Yaw, Waves)
counted = join("counted", Yaw, Counted)
surge = join("surge", Surge)
VALUES = {"K": 0.07, "tau": 40.0, "b": 0.0, "pace": 1 / 3, "c": 0.01, "one": 60.0}


@dataclass
class Plain:
    """A filter by hand, for the settings of `kalman`; noise in SI, by state or input.

    Attributes
    ----------
    density, sample, driving : mapping of str to float
        Noise of states per root second, of states per sample, of inputs per sample.
    lasting : mapping of str to float
        White noise of inputs, times root second.
    """

    kalman: ExtendedKalmanFilter
    values: Mapping[str, float]
    density: Mapping[str, float] = field(default_factory=dict)
    sample: Mapping[str, float] = field(default_factory=dict)
    driving: Mapping[str, float] = field(default_factory=dict)
    lasting: Mapping[str, float] = field(default_factory=dict)

    @property
    def states(self) -> tuple[str, ...]:
        return self.kalman.model.states

    def evaluation(self, x: np.ndarray, u: np.ndarray) -> Evaluation:
        point: dict[str, Any] = dict(self.values) | dict(zip(self.kalman.design.base.inputs, u))
        for name, value in zip(self.states, x):
            base = name.removeprefix("log_")
            point[base] = np.exp(value) if base != name else value
        return Evaluation(self.kalman.design.base, point)

    def advance(self, x: np.ndarray, u0: np.ndarray, u1: np.ndarray, T: float) -> np.ndarray:
        def rate(x: np.ndarray, u: np.ndarray) -> np.ndarray:
            found = self.evaluation(x, u).right_hand_sides("rate")
            return np.array([found.get(s, 0.0) for s in self.states])

        middle = (u0 + u1) / 2
        a = rate(x, u0)
        b = rate(x + T / 2 * a, middle)
        c = rate(x + T / 2 * b, middle)
        d = rate(x + T * c, u1)
        ahead = x + T / 6 * (a + 2 * b + 2 * c + d)
        for name, value in self.evaluation(x, u0).right_hand_sides("next").items():
            ahead[self.states.index(name)] = value if T > 0 else x[self.states.index(name)]
        return ahead

    def shown(self, x: np.ndarray, u: np.ndarray) -> np.ndarray:
        point = self.evaluation(x, u)
        return np.array([point[n] for n in self.kalman.measured])

    @staticmethod
    def slope(function: Callable[[np.ndarray], np.ndarray], at: np.ndarray) -> np.ndarray:
        """Derivative by complex steps: exact to rounding."""
        columns = []
        for i in range(at.size):
            nudged = at.astype(complex)
            nudged[i] += 1e-30j
            columns.append(function(nudged).imag / 1e-30)
        return np.array(columns).T

    def transition(self, x: np.ndarray, u0: np.ndarray, u1: np.ndarray, T: float) -> np.ndarray:
        return self.slope(lambda x: self.advance(x, u0, u1, T), x)

    def sensitivity(self, x: np.ndarray, u: np.ndarray) -> np.ndarray:
        return self.slope(lambda x: self.shown(x, u), x)

    def effect(self, x: np.ndarray, u0: np.ndarray, u1: np.ndarray, T: float) -> np.ndarray:
        """Derivative by what is added to the inputs over the whole step."""
        return self.slope(lambda w: self.advance(x, u0 + w, u1 + w, T), np.zeros(u0.size))

    def halves(self, T: float) -> np.ndarray:
        """Variance of white noise over half a step."""
        return np.array([self.density.get(s, 0.0) ** 2 for s in self.states]) * T / 2

    def noise(self, x: np.ndarray, u0: np.ndarray, u1: np.ndarray, T: float, F: np.ndarray) -> np.ndarray:
        """Covariance that a step adds."""
        half = np.diag(self.halves(T))
        total = F @ half @ F.T + half
        if T > 0:
            total += np.diag([self.sample.get(s, 0.0) ** 2 for s in self.states])
            names = self.kalman.design.base.inputs
            power = [self.driving.get(n, 0.0) ** 2 + self.lasting.get(n, 0.0) ** 2 / T for n in names]
            G = self.effect(x, u0, u1, T)
            total += G @ np.diag(power) @ G.T
        return total

    def rows(self, record: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Intervals, inputs and what the sensors show, from the record."""
        t = record["t"]
        inputs = [
            record.get(n, np.full(t.size, self.kalman.design.instruments.inputs.get(n, 0.0)))
            for n in self.kalman.design.base.inputs
        ]
        shown = np.array([record[n] for n in self.kalman.measured]).T
        return np.diff(t, prepend=t[0]), np.array(inputs).T.reshape(t.size, len(inputs)), shown

    def sail(
        self, t: np.ndarray, inputs: Mapping[str, np.ndarray], x0: np.ndarray, levels: np.ndarray, rng: Any
    ) -> tuple[dict[str, np.ndarray], np.ndarray]:
        """Simulate a record with its noise; return it with the true states."""
        names = self.kalman.design.base.inputs
        u = np.array([np.broadcast_to(inputs.get(n, 0.0), t.shape) for n in names], dtype=float).T.reshape(t.size, -1)
        x, states, shown = np.array(x0, dtype=float), [], []
        w = np.zeros(len(names))
        for k, T in enumerate(np.diff(t, prepend=t[0])):
            if k:
                half = np.sqrt(self.halves(T))
                x = self.advance(x + half * rng.standard_normal(x.size), u[k - 1] + w, u[k] + w, T)
                x = x + half * rng.standard_normal(x.size)
                x = x + np.array([self.sample.get(s, 0.0) for s in self.states]) * rng.standard_normal(x.size)
            w = np.array([self.driving.get(n, 0.0) for n in names]) * rng.standard_normal(len(names))
            states.append(x)
            shown.append(self.shown(x, u[k] + w) + levels * rng.standard_normal(levels.size))
        record = {"t": t, **dict(zip(names, u.T)), **dict(zip(self.kalman.measured, np.array(shown).T))}
        return record, np.array(states)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(11)


@pytest.fixture(scope="session")
def models() -> dict[str, Model]:
    """Small models: linear yaw, the same with waves, with a sampled state, and a speed that is not linear at all."""
    return {"yaw": yaw, "waved": waved, "counted": counted, "surge": surge, "de-keizer": find_model("de-keizer")}


@pytest.fixture(scope="session")
def ship() -> ParameterSet:
    """Values of the small models."""
    units = {n: m[n].unit for m in (yaw, waved, surge) for n in m.parameters}
    return ParameterSet(
        "small", sections={"particulars": {n: Value(n, VALUES[n], u, "assumed") for n, u in units.items()}}
    )


def _of_model(name: str, ship: ParameterSet) -> tuple[Model, ParameterSet | str, dict[str, float]]:
    if name == "de-keizer":
        model, known = find_model(name), find_ship("soesterberg")
        return model, known, known.values(model, speed=9.5)
    return {"yaw": yaw, "waved": waved, "counted": counted, "surge": surge}[name], ship, VALUES


@pytest.fixture(scope="session")
def setup(ship: ParameterSet) -> Callable[..., Plain]:
    """Make a filter and the same one by hand, from noise in SI."""

    def make(name: str, sensors: Mapping[str, float], **options: Any) -> Plain:
        model, known, values = _of_model(name, ship)
        levels = {k: options.pop(k, {}) for k in ("density", "sample", "driving", "lasting")}
        unit = {n: f"({model[n].unit})" for k in levels.values() for n in k}
        noise = {n: (v, f"{unit[n]}*s^-0.5") for n, v in levels["density"].items()}
        noise |= {n: (v, f"{unit[n]}*s^0.5") for n, v in levels["lasting"].items()}
        noise |= {n: (v, unit[n]) for k in ("sample", "driving") for n, v in levels[k].items()}
        kalman = ExtendedKalmanFilter(
            model,
            known,
            measured={n: (v, model[n].unit) for n, v in sensors.items()},
            noise=noise,
            **{"model_noise": False, "gate": None} | options,
        )
        by_state = {kalman.parameters.get(n, n): v for n, v in levels["sample"].items()}
        walking = {kalman.parameters.get(n, n): v for n, v in levels["density"].items()}
        return Plain(kalman, values, walking, by_state, levels["driving"], levels["lasting"])

    return make


@pytest.fixture(scope="session")
def swing() -> Callable[..., np.ndarray]:
    """A rudder that goes over every half period, within one sample."""
    return lambda t, size=0.2, period=60.0: size * np.sign(np.sin(2 * np.pi * t / period + 0.1))


@pytest.fixture(scope="session")
def uneven() -> Callable[..., np.ndarray]:
    """Times of samples that do not come regularly."""
    return lambda count, mean=0.7: np.cumsum(np.random.default_rng(3).uniform(0.4, 1.6, count) * mean)
