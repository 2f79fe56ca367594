"""Steps, transitions and sensor rows against an evaluation of the declaration that shares nothing with the generated one."""

from typing import Any

import casadi as ca
import numpy as np
import pytest

#: Where nothing vanishes: states, and both ends of a step's inputs.
POINTS = {
    "yaw": ([0.3, 0.01], [0.1], [0.15]),
    "waved": ([0.3, 0.01, 0.02], [0.1, 0.004], [0.15, -0.003]),
    "counted": ([0.3, 0.01, 0.02], [0.1], [0.15]),
    "surge": ([5.0], [0.3], [0.35]),
    "de-keizer": (
        [0.012, 8.1, 120.0, -40.0, 0.7],
        [9.5, 0.2, 1e-5, 1e-3, 0.4, -0.2],
        [9.5, -0.1, 2e-5, 2e-3, 0.3, -0.1],
    ),
}
SENSORS = {
    "yaw": {"psi": 1e-3, "r": 1e-4},
    "waved": {"compass": 1e-3, "r": 1e-4},
    "counted": {"psi": 1e-3, "held": 1e-4},
    "surge": {"log": 0.1},
    "de-keizer": {"psi": 1e-3, "r": 1e-4, "v": 0.1, "x": 5.0, "r_star": 0.01},
}
ESTIMATED = {"yaw": ["K", "tau", "b"], "waved": ["K", "pace"], "surge": ["c"], "de-keizer": ["K", "tau", "alpha3"]}


@pytest.mark.parametrize("augmented", [False, True])
@pytest.mark.parametrize("name", POINTS)
def test_jacobians_are_exact(setup: Any, name: str, augmented: bool) -> None:
    """F and H against complex steps through equations run by NumPy, to 1e-12 of the largest entry of a row."""
    estimated = ESTIMATED.get(name, []) if augmented else []
    hand = setup(name, SENSORS[name], estimated=estimated)
    kalman, eq = hand.kalman, hand.kalman.design.equations
    base = dict(zip(kalman.design.base.states, POINTS[name][0]))
    x = np.array([base.get(s, np.log(hand.values[s[4:]]) if s[:4] == "log_" else 0.05) for s in kalman.model.states])
    u0, u1 = (np.array(p) for p in POINTS[name][1:])
    joint = np.concatenate([x, np.zeros(kalman.design.layout.joint - x.size)])
    evaluate = ca.Function(
        "all",
        [eq.joint, eq.u0, eq.u1, eq.T, eq.p],
        [eq.advanced, ca.densify(eq.transition), eq.shown, ca.densify(eq.sensitivity)],
    )
    got = [m.full() for m in evaluate(joint, u0, u1, 0.8, kalman.design.p)]
    wanted = [
        hand.advance(x, u0, u1, 0.8)[:, None],
        hand.transition(x, u0, u1, 0.8),
        hand.shown(x, u1)[:, None],
        hand.sensitivity(x, u1),
    ]
    for g, w in zip(got, wanted):
        assert np.all(np.abs(g - w) <= 1e-12 * np.abs(w).max(axis=1, keepdims=True))


def test_the_effect_of_a_noise_is_exact(setup: Any) -> None:
    """Noise that drives and shows is an unknown of its own; its columns against complex steps."""
    hand = setup("waved", SENSORS["waved"], driving={"w": 0.01})
    kalman, eq = hand.kalman, hand.kalman.design.equations
    x, u0, u1 = (np.array(p) for p in POINTS["waved"])
    w = np.array([0.002])
    evaluate = ca.Function("all", [eq.joint, eq.u0, eq.u1, eq.T, eq.p], [eq.transition, eq.sensitivity])
    p = kalman.design.p
    F, H = (m.full() for m in evaluate(np.concatenate([x, w]), u0, u1, 0.8, p))
    both = np.array([0.0, w[0]])
    assert F[:, 3] == pytest.approx(hand.effect(x, u0 + both, u1 + both, 0.8)[:, 1], rel=1e-12)
    shown = hand.slope(lambda w: hand.shown(x, u1 + w), np.zeros(2))[:, 1]
    assert H[:, 3] == pytest.approx(shown, rel=1e-12) and H[0, 3] == 0.5


@pytest.mark.parametrize(
    ("name", "options", "linear"),
    [
        ("yaw", {}, True),
        ("waved", {"driving": {"w": 0.01}}, True),
        # Linear in K beside a rudder that is known, so the states still enter linearly; not in tau, nor in log K.
        ("yaw", {"estimated": ["K"], "log": ()}, True),
        ("yaw", {"estimated": ["K"]}, False),
        ("yaw", {"estimated": ["tau"], "log": ()}, False),
        ("surge", {}, False),
        ("counted", {}, True),
    ],
)
def test_a_linear_model_is_known_as_one(setup: Any, name: str, options: dict[str, Any], linear: bool) -> None:
    kalman = setup(name, SENSORS[name], **options).kalman
    assert kalman.linear is linear
    assert repr(kalman).startswith("<Kalman filter" if linear else "<extended Kalman filter")
