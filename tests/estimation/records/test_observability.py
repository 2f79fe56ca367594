"""What no sensor shows is named."""

import json
from typing import Any

import numpy as np
import pytest

from shipid import Component, ExtendedKalmanFilter, given, join, output, parameter, state
from shipid.estimation.records.first_estimate import first_estimate
from shipid.estimation.records.observability import observability


class Twins(Component):
    """Two headings of which only the sum is shown, both driven by the same rate: the difference stays what it was."""

    r = state("rad/s", "rate of turn")
    psi = state("rad", "heading")
    drift = state("rad", "offset of the compass")
    delta = given("rad", "rudder angle")
    K = parameter("1/s", "gain", start=0.07)
    tau = parameter("s", "time constant", start=40.0)
    compass = output("rad", "heading shown", noise="0.1 deg")
    gyro = output("rad/s", "rate shown", noise="0.01 deg/s")

    @r.rate
    def yaw(self):
        """Nomoto (1957)."""
        return (self.K * self.delta - self.r) / self.tau

    @psi.rate
    def turning(self):
        """Kinematics."""
        return self.r

    @drift.rate
    def staying(self):
        """A constant."""
        return 0.0 * self.r / self.unit

    unit = parameter("1", "one", start=1.0)

    @compass.equals
    def reading(self):
        """Their sum."""
        return self.psi + self.drift

    @gyro.equals
    def rate(self):
        """The rate."""
        return self.r


twins = join("twins", Twins)


@pytest.fixture(scope="module")
def own() -> Any:
    from shipid.parameters.parameter_set import ParameterSet, Value

    values = {"K": (0.07, "1/s"), "tau": (40.0, "s"), "unit": (1.0, "1")}
    return ParameterSet("twins", sections={"particulars": {n: Value(n, *v, "assumed") for n, v in values.items()}})


def record(swing: Any, count: int = 200) -> dict[str, np.ndarray]:
    t = np.arange(count) * 0.7
    return {"t": t, "delta": swing(t), "compass": np.zeros(count), "gyro": np.zeros(count)}


def test_a_pair_that_is_shown_as_a_sum(own: Any, swing: Any) -> None:
    kalman = ExtendedKalmanFilter(
        twins, own, initial={"psi": "0.1 rad", "drift": "0.1 rad"}, model_noise=False, gate=None
    )
    told = observability(kalman.filter(record(swing)))
    assert told.states == ("r", "psi", "drift")
    assert len(told.unobservable) == 1
    weights = told.unobservable[0].weights
    assert set(weights) == {"psi", "drift"} and weights["psi"] == pytest.approx(-weights["drift"], abs=1e-6)
    assert told.information[0] < 1e-9 * told.information[-1] and np.all(np.diff(told.information) >= 0)
    (message,) = told.messages
    assert "psi and drift are not observable apart" in message or "drift and psi are not observable apart" in message
    assert "+1 psi -1 drift" in message or "+1 drift -1 psi" in message or "-1 drift" in message
    plain = json.loads(json.dumps(told.to_dict(), allow_nan=False))
    assert len(plain["unobservable"]) == 1 and plain["weak"] == []


def test_the_null_direction_is_in_first_standard_deviations(own: Any, swing: Any) -> None:
    """Their sum is shown, so a change of one is undone by as much of the other, counted in what each was unsure by."""
    kalman = ExtendedKalmanFilter(twins, own, initial={"psi": "0.2 rad", "drift": "0.05 rad"}, model_noise=False)
    (direction,) = observability(kalman.filter(record(swing))).unobservable
    # d psi = -d drift: 1/0.2 against 1/0.05.
    assert direction.weights["psi"] / direction.weights["drift"] == pytest.approx(-0.05 / 0.2, rel=1e-6)


def test_a_state_that_nothing_shows(own: Any, swing: Any) -> None:
    kalman = ExtendedKalmanFilter(twins, own, measured={"gyro": None}, model_noise=False)
    told = observability(kalman.filter(record(swing)))
    assert sorted(next(iter(d.weights)) for d in told.unobservable) == ["drift", "psi"]
    assert "psi is not observable: no sensor shows it, and no measurement makes its error smaller." in told.messages


def test_what_a_short_record_hardly_shows_is_weak(own: Any, swing: Any) -> None:
    """Ten seconds of a rate tell nearly nothing of a time constant of a minute, which is not nothing."""
    kalman = ExtendedKalmanFilter(twins, own, measured={"gyro": "2 deg/s"}, estimated=["tau"], initial={"tau": "1 s"},
                                  model_noise=False)  # fmt: skip
    told = observability(kalman.filter(record(swing, 15)))
    named = {n for d in told.weak for n in d.weights}
    assert "tau" in named and all(0 < d.information < 1e-2 for d in told.weak)


def test_all_is_well(setup: Any, swing: Any) -> None:
    hand = setup("yaw", {"psi": 0.01}, density={"r": 1e-4}, estimated=["K", "tau", "b"])
    t = np.arange(400) * 0.7
    first = {"log_K": np.log(0.07), "log_tau": np.log(40.0)}
    x0 = np.array([first.get(s, 0.0) for s in hand.states])
    told = hand.kalman.filter(hand.sail(t, {"delta": swing(t)}, x0, np.array([0.01]), np.random.default_rng(1))[0])
    told = observability(told)
    assert told.unobservable == () and told.weak == () and told.messages == ()
    # The Gramian by hand, over the first hundred samples, in first standard deviations.
    run = hand.kalman.filter({"t": t[:100], "delta": swing(t[:100]), "psi": np.zeros(100)})
    n, phi = len(hand.states), np.eye(4 + 1)[: len(hand.states), : len(hand.states)]
    before = run.start[hand.kalman.design.layout.carried["x"]]
    _, deviation = first_estimate(hand.kalman.design, {})
    total = np.zeros((n, n))
    u = swing(t[:100])[:, None]
    for k in range(100):
        if k:
            phi = hand.transition(before, u[k - 1], u[k], 0.7) @ phi
        ahead = run.rows("ahead")[k]
        row = hand.sensitivity(ahead, u[k]) @ phi @ np.diag(deviation)
        total += row.T @ row / 0.01**2
        before = run.x[k]
    wanted = np.linalg.eigvalsh(total)
    assert observability(run).information == pytest.approx(np.maximum(wanted, 0), rel=1e-6, abs=1e-9 * wanted[-1])
