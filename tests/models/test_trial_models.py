"""Closed forms of the models that real trials ask for: surge with Bech's yaw, cross-flow drag, scaling, lag, wind."""

from collections.abc import Callable
from math import degrees, exp, radians, sqrt
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import shipid.models as declared
from shipid import find_model, find_ship
from shipid.parts.planar_motion import LEAST_WAY

Evaluate = Callable[..., dict[str, float]]
SURGING = [
    ("bech-surge", "kvlcc2-7m"),
    ("bech-slipstream", "kvlcc2"),
    ("cross-flow", "kvlcc2"),
    ("de-keizer-lag", "gunnerus"),
]


def ship(model: str, name: str, **changed: float) -> dict[str, float]:
    """A ship's numbers on a straight course at her own speed, all states zero but the speed."""
    known, whole = find_ship(name), find_model(model)
    speed = known.particular("speed", "m/s")
    assert speed is not None
    still = dict.fromkeys(whole.states, 0.0) | {"u": speed, "cruise": speed, "delta": 0.0}
    return still | known.values(whole, speed) | changed


@pytest.mark.parametrize(("model", "name"), SURGING)
def test_the_steady_speed_on_a_straight_course_is_the_cruise(evaluate: Evaluate, model: str, name: str) -> None:
    values = ship(model, name)
    assert all(evaluate(find_model(model), values)[s] == 0.0 for s in set(find_model(model).states) - {"x", "y"})
    cruise = values["cruise"]
    assert evaluate(find_model(model), values | {"u": 0.9 * cruise})["u"] > 0
    assert evaluate(find_model(model), values | {"u": 1.1 * cruise})["u"] < 0


@pytest.mark.parametrize(("model", "name"), SURGING)
@pytest.mark.parametrize("share", [-0.2, 0.0, 0.01, LEAST_WAY, 0.3])
def test_a_ship_with_little_way_or_none_stays_finite_and_gathers_way(
    evaluate: Evaluate, model: str, name: str, share: float
) -> None:
    values = ship(model, name)
    values |= {"u": share * values["cruise"], "delta": 0.5, "r_disturbance": 1e-5}
    turning = {"r": 0.1 * values["cruise"] / values["L"], "w": 0.3, "v": -0.05 * values["cruise"]}
    for moving in ({}, {n: v for n, v in turning.items() if n in find_model(model).states}):
        sides = evaluate(find_model(model), values | moving)
        assert all(np.isfinite(v) for v in sides.values())
        if share <= 0:
            assert sides["u"] > 0


@pytest.mark.parametrize(("model", "name"), SURGING[:3])
@pytest.mark.parametrize("side", [1.0, -1.0], ids=["starboard", "port"])
def test_the_hardest_turn_stays_finite_and_keeps_way(
    evaluate: Evaluate, integrate: Callable[..., Any], model: str, name: str, side: float
) -> None:
    values = ship(model, name, delta=side * radians(35))
    pace, start = values["L"] / values["cruise"], {"u": values["cruise"]}
    inside = {n: v for n, v in values.items() if n not in find_model(model).states}
    run = integrate(find_model(model), start, inside, seconds=40 * pace, step=pace / 20)
    assert all(np.isfinite(record).all() for record in run.values())
    assert LEAST_WAY * values["cruise"] < run["u"].min() < 0.6 * values["cruise"]
    assert 0.2 < side * run["r"][-1] * values["L"] / run["u"][-1] < 2.0


@pytest.mark.parametrize("rudder", [-35.0, 10.0, 20.0, 35.0])
def test_the_steady_turn_of_bech_with_surge(evaluate: Evaluate, rudder: float) -> None:
    """A0 r* + A3 r*^3 = B0 delta, u = U0 / sqrt(1 + r*^2 X_rr/X0), w = A1 r* - B1 delta: both equations balance."""
    values = ship("bech-surge", "kvlcc2-7m", delta=radians(rudder))
    cubic = [values["A3"], 0.0, values["A0"], -values["B0"] * radians(rudder)]
    turn = next(z.real for z in np.roots(cubic) if z.real * rudder > 0 and abs(z.imag) < 1e-12)
    u = values["cruise"] / sqrt(1 + turn**2 * values["X_rr"] / values["X0"])
    state = {"u": u, "r": turn * u / values["L"], "w": values["A1"] * turn - values["B1"] * radians(rudder)}
    sides = evaluate(find_model("bech-surge"), values | state)
    for name in ("r", "w", "u"):  # sums of terms of 1e-2 to 1
        assert abs(sides[name]) < 1e-15
    assert sides["v"] / u == pytest.approx(-values["gamma"] * turn, rel=1e-12)


def test_bech_with_surge_at_one_speed_is_bech(evaluate: Evaluate) -> None:
    generator = np.random.default_rng(3)
    for _ in range(20):
        u, length = generator.uniform(1, 12), generator.uniform(5, 300)
        pace = u / length
        numbers = dict(zip(("B1", "B0", "A1", "A0", "A3"), generator.uniform(0.2, 5.0, 5)))
        numbers["A0"] *= generator.choice([-1, 1])
        numbers["A1"] += 4.5  # real poles, so that bech's published time constants are numbers
        converted = {"d1": numbers["B1"] * pace**2, "d0": numbers["B0"] * pace**3, "c1": numbers["A1"] * pace}
        converted |= {"c0": numbers["A0"] * pace**2, "c3": numbers["A3"]}
        point = {"r": generator.normal(0, 0.5) * pace, "delta": generator.normal(0, 0.3), "psi": 0.0, "u": u}
        point["r_disturbance"] = generator.normal(0, 0.1) * pace**2
        w = generator.normal(0, 0.3)
        surging = {"X0": 0.1, "X_rr": 1.0, "gamma": 0.5, "cruise": u, "L": length, "w": w}
        got = evaluate(find_model("bech-surge"), numbers | point | surging)
        wanted = evaluate(find_model("bech"), converted | point | {"w": w * pace**2})
        assert got["r"] == pytest.approx(wanted["r"], rel=1e-12, abs=1e-15 * pace**2)
        assert got["w"] * pace**2 == pytest.approx(wanted["w"], rel=1e-11, abs=1e-14 * pace**3)


def test_a_steady_disturbance_turns_bech_with_surge_as_the_first_order_model(evaluate: Evaluate) -> None:
    """r* = (A1/A0 - B1/B0) d (L/u)^2, which is tau1 + tau2 - tau3 times the disturbance, for a stable ship."""
    values = ship("bech-surge", "kvlcc2-7m", A0=0.4, A3=0.0)
    pace = values["u"] / values["L"]
    push = 1e-3 * pace**2
    r_star = (values["A1"] / 0.4 - values["B1"] / values["B0"]) * 1e-3
    state = {"r": r_star * pace, "w": values["A1"] * r_star - 1e-3}
    sides = evaluate(find_model("bech-surge"), values | state | {"r_disturbance": push})
    assert abs(sides["r"]) < 1e-17
    assert abs(sides["w"]) < 1e-17


@pytest.mark.parametrize("u", [0.0, 2.0, 5.0, 8.0])
def test_without_slipstream_it_is_bech_with_surge(evaluate: Evaluate, u: float) -> None:
    values = ship("bech-slipstream", "kvlcc2", m=0.0, delta=-0.3, u=u, r=0.004, w=-0.2, r_disturbance=1e-6)
    sides = evaluate(find_model("bech-slipstream"), values)
    inside = {n: v for n, v in values.items() if n != "m"}
    assert sides == pytest.approx(evaluate(find_model("bech-surge"), inside), rel=1e-13)


@pytest.mark.parametrize(("m", "power"), [(0.56, 1.44), (2.0, 0.0), (0.0, 2.0)])
def test_the_rudder_force_goes_by_its_power_of_the_speed(evaluate: Evaluate, m: float, power: float) -> None:
    values = ship("bech-slipstream", "kvlcc2", m=m)
    cruise = values["cruise"]
    force = [
        evaluate(find_model("bech-slipstream"), values | {"u": share * cruise, "delta": 0.2})["r"]
        for share in (1.0, 0.6)
    ]
    assert force[1] / force[0] == pytest.approx(0.6**power, rel=1e-12)


@pytest.mark.parametrize(("v", "turn"), [(-0.4, 0.3), (0.0, 0.5), (0.2, 1.3), (-0.7, 0.0), (0.3, 0.6), (0.01, -0.2)])
def test_the_drag_of_the_cross_flow_against_its_closed_form(evaluate: Evaluate, v: float, turn: float) -> None:
    """Integrals of w |w| and xi w |w| over -1/2..1/2 for w = v + turn xi, whose zero is put in by hand."""
    length = 100.0
    values = ship("cross-flow", "kvlcc2", L=length, u=5.0, w_0=0.0)
    moved = values | {"v": v, "r": turn / length}
    drag = []
    for coefficient in ("c_y", "c_z"):
        at = {"c_y": 0.0, "c_z": 0.0}
        with_drag = evaluate(find_model("cross-flow"), moved | at | {coefficient: 1.0})
        without = evaluate(find_model("cross-flow"), moved | at)
        row, scale = ("v", length) if coefficient == "c_y" else ("r", length**2)
        drag.append((without[row] - with_drag[row]) * scale)
    bow, stern = v + turn / 2, v - turn / 2
    if turn == 0:
        wanted = [v * abs(v), 0.0]
    else:
        force = (abs(bow) ** 3 - abs(stern) ** 3) / (3 * turn)
        moment = ((bow**3 * abs(bow) - stern**3 * abs(stern)) / 4 - v * turn * force) / turn**2
        wanted = [force, moment]
    ends = max(abs(bow), abs(stern)) ** 2
    if bow * stern > 0:  # a polynomial: the rule is exact, and what is left is the rounding of the differences
        assert drag == pytest.approx(wanted, rel=1e-10, abs=1e-13)
    else:
        assert drag[0] == pytest.approx(wanted[0], abs=1.5e-3 * ends)
        assert drag[1] == pytest.approx(wanted[1], rel=3e-3)


def test_the_drag_develops_from_a_cube_to_a_square(evaluate: Evaluate) -> None:
    """|w| w^2/(w_0 u) where the cross-flow is slow, |w| w where it is fast, and 1/sqrt(2) of that at w = w_0 u."""
    values = ship("cross-flow", "kvlcc2", q21=0.0, c_y=1.0, w_0=0.4)
    at, length = 0.4 * values["u"], values["L"]

    def drag(v: float) -> float:
        return -evaluate(find_model("cross-flow"), values | {"v": v})["v"] * length

    assert drag(at) == pytest.approx(at**2 / sqrt(2), rel=1e-12)
    assert drag(1e-3 * at) == pytest.approx((1e-3 * at) ** 3 / at, rel=1e-6)
    assert drag(-100 * at) == pytest.approx(-((100 * at) ** 2), rel=1e-4)


def test_the_propeller_pushes_the_stern_aside_as_she_slows(evaluate: Evaluate) -> None:
    """At the cruise nothing; at half of it delta_p (U0/u - 1) = delta_p of rudder."""
    values = ship("cross-flow", "kvlcc2", delta_p=0.02)
    assert evaluate(find_model("cross-flow"), values)["r"] == 0.0
    slow = values | {"u": 0.5 * values["cruise"]}
    steered = slow | {"delta_p": 0.0, "delta_lagged": 0.02}
    pushed, wanted = (evaluate(find_model("cross-flow"), v) for v in (slow, steered))
    assert [pushed[n] for n in ("v", "r")] == pytest.approx([wanted[n] for n in ("v", "r")], rel=1e-12)


def test_thrust_and_rudder_drag_of_the_cross_flow_model(evaluate: Evaluate) -> None:
    values = ship("cross-flow", "kvlcc2", X0=0.05)
    u0, length = values["cruise"], values["L"]
    slowed = evaluate(find_model("cross-flow"), values | {"u": 0.5 * u0})["u"]
    assert slowed == pytest.approx(0.05 * u0**2 / length * (1 + 0.8 * 0.5 - 0.25), rel=1e-12)
    turned = evaluate(find_model("cross-flow"), values | {"delta_lagged": 0.5})
    assert turned["u"] / turned["v"] == pytest.approx(0.77 * 0.5, rel=1e-12)


def test_cross_flow_without_drag_at_one_speed_is_linear(evaluate: Evaluate) -> None:
    """Its matrix and its poles, from Pershitz's coefficients for the drift angle: beta = -v/u."""
    values = ship("cross-flow", "kvlcc2", c_y=0.0, c_z=0.0)
    model, names = find_model("cross-flow"), ("v", "r")
    sides = [evaluate(model, values | {n: 1.0}) for n in (*names, "delta_lagged")]
    got = np.array([[side[row] for side in sides] for row in names])
    a, length = values["u"] / values["L"], values["L"]
    drift = np.array([[-a * values["q21"], -values["r21"]], [-(a**2) * values["q31"], -a * values["r31"]]])
    turned = np.diag([-1 / values["u"], 1.0])  # (v, r) to (beta, r)
    linear = np.linalg.inv(turned) @ drift @ turned
    rudder = np.linalg.inv(turned) @ np.array([-a * values["s21"], -(a**2) * values["s31"]])
    assert got == pytest.approx(np.column_stack([linear, rudder]), rel=1e-12)
    poles = np.sort(np.linalg.eigvals(got[:, :2])) * length / values["u"]
    trace, product = values["q21"] + values["r31"], values["q21"] * values["r31"] - values["q31"] * values["r21"]
    assert poles == pytest.approx([(-trace + k * sqrt(trace**2 - 4 * product)) / 2 for k in (-1, 1)], rel=1e-12)
    assert poles[1] > 0  # this ship does not keep her course
    twice = evaluate(model, values | {"v": 2.0, "r": 0.02, "delta_lagged": 0.4})
    assert [twice[n] for n in names] == pytest.approx(got @ [2.0, 0.02, 0.4], rel=1e-12)


def test_the_drag_takes_energy_from_every_drift_and_turn(evaluate: Evaluate) -> None:
    generator = np.random.default_rng(4)
    values = ship("cross-flow", "kvlcc2")
    length = values["L"]
    for v, turn in generator.normal(0, 1, (50, 2)):
        moved = values | {"v": v, "r": turn / length}
        free = evaluate(find_model("cross-flow"), moved | {"c_y": 0.0, "c_z": 0.0})
        braked = evaluate(find_model("cross-flow"), moved | {"c_y": 1.0, "c_z": 1.0})
        assert v * (braked["v"] - free["v"]) + turn * length * (braked["r"] - free["r"]) < 0


def test_port_mirrors_starboard(evaluate: Evaluate) -> None:
    generator = np.random.default_rng(5)
    for model, name in SURGING:
        values = ship(model, name, **({"delta_p": 0.0} if model == "cross-flow" else {}))
        odd = [
            n for n in ("v", "r", "w", "delta", "delta_lagged") if n in values and n not in find_model(model).derived
        ]
        for _ in range(5):
            moved = {n: generator.normal(0, 0.1) for n in odd}
            one = evaluate(find_model(model), values | moved)
            other = evaluate(find_model(model), values | {n: -v for n, v in moved.items()})
            assert other["u"] == pytest.approx(one["u"], rel=1e-12)
            for n in odd:
                if n in one:
                    assert other[n] == pytest.approx(-one[n], rel=1e-12)


def test_cubic_at_one_speed_is_norrbin_and_steady_turns_keep_r_star(evaluate: Evaluate) -> None:
    starred = {"a": 1.21, "b1": 0.56, "b3": 2.25, "gamma": 0.46}
    turn = brentq(lambda z: 0.56 * z + 2.25 * z**3 - 1.21 * radians(20), 0.0, 2.0, xtol=1e-15)
    for u in (0.2, 0.323, 0.5):
        pace = u / 3.0
        values = starred | {"u": u, "cruise": u, "L": 3.0, "psi": 0.0, "delta": radians(20)}
        assert abs(evaluate(find_model("cubic"), values | {"r": turn * pace})["r"]) < 1e-16
        norrbin = {"a": 1.21 * pace**2, "b1": 0.56 * pace, "b3": 2.25 / pace}
        point = {"r": -0.3 * pace, "delta": 0.1, "r_disturbance": 1e-4}
        wanted = evaluate(find_model("norrbin"), norrbin | point | {"u": u, "psi": 0.0})["r"]
        assert evaluate(find_model("cubic"), values | point)["r"] == pytest.approx(wanted, rel=1e-12)


def test_cubic_at_rest_is_finite(evaluate: Evaluate) -> None:
    values = ship("cubic", "esso-osaka-3m", u=0.0, r=0.01, delta=0.5)
    assert all(np.isfinite(v) for v in evaluate(find_model("cubic"), values).values())


def test_a_wind_from_ahead_and_aft_turns_nobody(evaluate: Evaluate) -> None:
    values = {"psi": 0.7, "u": 0.4, "L": 3.0, "N_w": -0.0002, "N_w1": -0.0001}
    for wind in ({}, {"wind_speed": 2.0, "wind_direction": 0.7}, {"wind_speed": 2.0, "wind_direction": 0.7 + np.pi}):
        assert evaluate(declared.WindMoment, values | wind)["r_disturbance"] == pytest.approx(0.0, abs=1e-18)


def test_the_windage_of_a_ship_with_her_house_aft_turns_the_bow_into_the_wind(evaluate: Evaluate) -> None:
    """Of a ship that lies still, only the first harmonic acts on the beam; the wind blows to starboard, so the bow goes to port."""
    known = find_ship("esso-osaka-3m").values(find_model("cubic-wind"))
    values = {n: known[n] for n in ("L", "N_w", "N_w1")} | {"psi": 0.2, "u": 0.0, "wind_speed": 2.0}
    beam = evaluate(declared.WindMoment, values | {"wind_direction": 0.2 + np.pi / 2})["r_disturbance"]
    assert beam == pytest.approx(known["N_w1"] * 4.0, rel=1e-12)
    assert beam < 0
    # Turned half round, the first harmonic changes its sign and the second does not.
    both = [
        evaluate(declared.WindMoment, values | {"wind_direction": 0.9 + k * np.pi})["r_disturbance"] for k in (0, 1)
    ]
    assert sum(both) / 2 == pytest.approx(known["N_w"] * np.sin(1.4) * 4.0, rel=1e-12)


@pytest.mark.parametrize("share", [1.0, 0.5])
def test_the_lag_answers_a_step_alike_at_every_speed(integrate: Callable[..., Any], share: float) -> None:
    """1 - exp(-t/t_delta), in seconds: the speed of the ship does not enter."""
    values = ship("de-keizer-lag", "gunnerus", delta=radians(10))
    speed = share * values["cruise"]
    inside = {n: v for n, v in values.items() if n not in find_model("de-keizer-lag").states} | {"cruise": speed}
    run = integrate(find_model("de-keizer-lag"), {"u": speed}, inside, seconds=5.0, step=0.05)
    wanted = [10 * (1 - exp(-0.05 * k / values["t_delta"])) for k in range(101)]
    # Runge and Kutta at a nineteenth of the time constant
    assert [degrees(d) for d in run["delta_lagged"]] == pytest.approx(wanted, abs=1e-6)


def test_de_keizer_with_the_lag_settled_is_de_keizer(evaluate: Evaluate) -> None:
    values = ship("de-keizer-lag", "gunnerus", delta=0.12, delta_lagged=0.12, r=0.03, u=4.9)
    inside = {n: v for n, v in values.items() if n not in ("t_delta", "delta_lagged")}
    sides, wanted = evaluate(find_model("de-keizer-lag"), values), evaluate(find_model("de-keizer"), inside)
    assert sides.pop("delta_lagged") == 0.0
    assert sides == wanted
    late = evaluate(find_model("de-keizer-lag"), values | {"delta": -0.3})
    assert late["r"] == wanted["r"] and late["delta_lagged"] < 0
