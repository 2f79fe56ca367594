"""Steps and whole records: order of convergence, holds, sensitivities, sampled and mixed models."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from shipid import Component, find_model, find_ship, generate, given, join, state
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.generation.record import make_record
from shipid.generation.step import METHODS, make_step
from shipid.parts.helm import ZigzagHelm
from shipid.parts.steering_machine import SteeringMachine


def container(**changed: float) -> dict[str, float]:
    values = find_ship("soesterberg").values(find_model("de-keizer")) | {"cruise": 9.5, "u": 9.5}
    return values | {"alpha3": 2.0} | changed


def test_simulations_agree_with_scipy(sailing: Any, sail: Any) -> None:
    """Over a zig-zag of 150 samples, to 1e-6 of each state's largest value, with an integrator that is not ours.

    The integrator starts afresh at every sample, where the rudder's line has a corner.
    """
    x0, u, intervals = sail(sailing, 150, 0.1 * sailing.unit_time)
    # The lag of the rudder is twenty times as fast as the ship; wake and flow at the rudder bend where the flow changes sides.
    substeps = 16 if sailing.model.name.startswith(("cross-flow", "mmg")) else 8
    record = make_record(sailing.model, sailing.model.states, substeps=substeps, compiled=False)
    system = record.system
    p = system.vector(system.coefficients, sailing.coefficients)
    got, _ = record(x0, u, intervals, p)

    rates, x, wanted = system.right_hand_side, x0, [x0]
    for k, interval in enumerate(intervals[:-1]):

        def motion(t: float, x: np.ndarray, k: int = k, interval: float = interval) -> np.ndarray:
            return rates(x, u[:, k] + t / interval * (u[:, k + 1] - u[:, k]), p).full().ravel()

        x = solve_ivp(motion, (0, interval), x, method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
        wanted.append(x)
    reference = np.array(wanted).T
    assert np.abs(reference[system.states.index("psi")]).max() > 0.2
    sizes = np.abs(reference).max(axis=1)
    assert (np.abs(got - reference).max(axis=1) <= 1e-6 * sizes).all()


@pytest.mark.parametrize("method", METHODS)
def test_order_of_convergence(method: str, run_record: Any) -> None:
    """The slope of the error against the step, on log scales, is the order; within 0.15 at steps of 1.5 to 12 s."""
    model, values = find_model("de-keizer"), container(delta=0.2)
    system = generate(model)
    p, u = system.vector(system.coefficients, values), system.vector(system.inputs, values)
    x0, end = system.vector(system.states, values, default=0.0), 96.0
    exact = solve_ivp(
        lambda _, x: system.right_hand_side(x, u, p).full().ravel(), (0, end), x0, "DOP853", rtol=1e-13, atol=1e-13
    ).y[:, -1]
    counts = np.array([8, 16, 32, 64])
    errors = []
    for count in counts:
        y = run_record(model, model.states, values, {}, np.linspace(0, end, count + 1), method=method)
        errors.append(np.linalg.norm((y[:, -1] - exact) / np.abs(exact)))
    slope = -np.polyfit(np.log(counts[1:]), np.log(errors[1:]), 1)[0]
    assert slope == pytest.approx(METHODS[method].order, abs=0.15)


def test_substeps_are_finer_steps(run_record: Any) -> None:
    model, values = find_model("de-keizer"), container(delta=0.2)
    coarse, fine = np.linspace(0, 90, 10), np.linspace(0, 90, 37)
    for hold in ("linear", "zero"):
        one = run_record(model, model.states, values, {}, coarse, substeps=4, hold=hold)
        four = run_record(model, model.states, values, {}, fine, hold=hold)
        np.testing.assert_allclose(one, four[:, ::4], rtol=1e-13)


def test_substeps_follow_a_rudder_that_runs_in_a_line(run_record: Any) -> None:
    model, values = find_model("de-keizer"), container()
    coarse, fine = np.linspace(0, 90, 10), np.linspace(0, 90, 37)
    rudder = 0.3 * np.sin(coarse / 10)
    one = run_record(model, model.states, values, {"delta": rudder}, coarse, substeps=4)
    four = run_record(model, model.states, values, {"delta": np.interp(fine, coarse, rudder)}, fine)
    np.testing.assert_allclose(one, four[:, ::4], rtol=1e-12, atol=1e-15)


class Integrator(Component):
    """The area under an input."""

    area = state("m", "area under the input")
    height = given("m/s", "input")

    @area.rate
    def grow(self) -> Any:
        """By definition."""
        return self.height


def test_holds_by_the_area_under_the_input(run_record: Any) -> None:
    """Trapezia for a straight line, rectangles for a held input: over uneven intervals, to rounding."""
    t = np.array([0.0, 1.0, 1.5, 4.0, 4.25])
    height = np.array([2.0, -1.0, 3.0, 0.5, 7.0])
    model = join("integrator", Integrator)
    linear, zero = (run_record(model, ("area",), {}, {"height": height}, t, hold=h)[0] for h in ("linear", "zero"))
    steps = np.diff(t)
    np.testing.assert_allclose(linear, np.r_[0, np.cumsum(steps * (height[1:] + height[:-1]) / 2)], rtol=1e-14)
    np.testing.assert_allclose(zero, np.r_[0, np.cumsum(steps * height[:-1])], rtol=1e-14)


#: Of a stern that is the same to both sides: with others the equations bend where the flow changes sides, and differences are none.
BENDS = {"C_2_port": 1.0, "C_2_starboard": 1.0, "gamma_port": 0.5, "gamma_starboard": 0.5}


@pytest.mark.parametrize("hold", ["linear", "zero"])
def test_sensitivities_over_a_whole_record(one: Any, sail: Any, hold: str) -> None:
    """By every coefficient, every initial state and the bias of every input.

    Against five-point differences of the record itself: within 1e-7 of the largest derivative by that unknown, as
    (1e-3)^4 of a fifth derivative, and rounding divided by 1e-3, leave. Where the rudder's sign matters it
    never comes near rest.
    """
    # With the lag of its rudder, cross-flow is stable up to steps of 2.7 times that.
    step = 0.1 if one.model.name.startswith("cross-flow") else 0.2
    x0, u, intervals = sail(one, 60, step * one.unit_time)
    x0 = x0 + 0.01  # away from rest, so that a relative step of each initial state is one
    model = one.model
    outputs = (*model.states, *model.derived)
    published = {n for n in model.derived if n in ("tau1", "tau2")}  # of complex poles: no numbers
    outputs = tuple(n for n in outputs if n not in published)
    names = model.parameters + model.constants
    record = make_record(model, outputs, names, model.states, model.inputs, hold=hold, compiled=False)
    values = make_record(model, outputs, hold=hold, compiled=False)
    p = record.system.vector(names, one.coefficients | {n: v for n, v in BENDS.items() if n in names})
    bias = np.zeros(len(model.inputs))
    y, dy = record(x0, u, intervals, p, bias)
    assert dy.shape == (len(outputs), len(record.unknowns), 60)
    np.testing.assert_allclose(y, values(x0, u, intervals, p)[0], rtol=1e-11, atol=1e-13)

    vector = np.concatenate([p, x0, bias])
    sizes = np.concatenate([np.where(p == 0, 1.0, np.abs(p)), np.abs(x0), np.abs(u).mean(axis=1)])
    parts = np.cumsum([p.size, x0.size])

    def again(moved: np.ndarray) -> np.ndarray:
        q, start, offset = np.split(moved, parts)
        return values(start, u, intervals, q, offset)[0]

    moving = 0
    for j, name in enumerate(record.unknowns):
        h = 1e-3 * (sizes[j] or 1e-3)
        unit = np.eye(vector.size)[j]
        y = {k: again(vector + k * h * unit) for k in (-2, -1, 1, 2)}
        measured = (8 * (y[1] - y[-1]) - y[2] + y[-2]) / (12 * h)
        # Rounding of the outputs is of their own size, whatever the unknown does to them.
        rounding = 1e-13 * np.abs(y[1]).max(axis=1) / h
        # The cross-flow changes its sign along the hull, where its drag bends within a tenth of the speed.
        smooth = 1e-5 if model.name.startswith("cross-flow") else 1e-7
        smooth = 1e-3 if name in BENDS else smooth
        allowed = smooth * np.abs(measured).max(axis=1) + rounding
        assert (np.abs(dy[:, j] - measured).max(axis=1) <= allowed).all(), name
        moving += np.abs(dy[:, j]).max() > 0
    assert moving >= len(record.unknowns) - 2  # nothing depends on the positions' start but the positions


def test_unknowns_are_named() -> None:
    record = make_record(find_model("nomoto"), ("r",), ("K",), ("psi",), ("delta",), compiled=False)
    assert record.unknowns == ("K", "x0:psi", "bias:delta")


def test_records_of_one_sample_and_of_none() -> None:
    record = make_record(find_model("nomoto"), ("r", "psi"), ("K",), ("r",), compiled=False)
    x0, p = np.array([0.01, 0, 0, 0.5]), np.array([0.07, 40.0])
    y, dy = record(x0, np.zeros((6, 1)), np.zeros(1), p)
    assert y.tolist() == [[0.01], [0.5]]
    assert dy[:, :, 0].tolist() == [[0, 1], [0, 0]]
    y, dy = record(x0, np.zeros((6, 0)), np.zeros(0), p)
    assert y.shape == (2, 0)
    assert dy.shape == (2, 2, 0)


def test_the_last_interval_is_not_used() -> None:
    record = make_record(find_model("nomoto"), ("r",), compiled=False)
    x0, u, p = np.array([0.01, 0, 0, 0.5]), np.ones((6, 3)), np.array([0.07, 40.0])
    first = record(x0, u, np.array([1.0, 2.0, 0.0]), p)[0]
    assert np.array_equal(first, record(x0, u, np.array([1.0, 2.0, np.nan]), p)[0])


def test_a_model_that_runs_away_gives_numbers_that_are_not_finite(run_record: Any) -> None:
    values = {"a": 1e-3, "b1": 0.01, "b3": -500.0, "u": 5.0, "delta": 0.5}
    r = run_record(find_model("norrbin"), ("r",), values, {}, np.arange(400.0))[0]
    assert np.isfinite(r[:5]).all()
    assert not np.isfinite(r[-1])


@pytest.mark.parametrize("name", ["pershitz-discrete", "pershitz-track", "pershitz-track-augmented"])
def test_sampled_models_are_exact(name: str, plain: Any, run_record: Any) -> None:
    """A state that is defined by its next sample is that equation, applied again and again."""
    model = find_model(name)
    values = find_ship("semerdjiev").values(model) | {"cruise": 30.0, "delta": 0.4, "Omega": 0.003, "V_U": 30.0}
    values |= {"dOmega": 0.001}
    t = 3.0 * np.arange(40)
    got = run_record(model, model.states, values, {}, t)
    point, rows = dict(values), []
    for _ in t:
        rows.append([point.get(s, 0.0) for s in model.states])
        point |= plain(model, dict.fromkeys(model.states, 0.0) | point | {"T_s": 3.0}, "next")
    np.testing.assert_allclose(got, np.array(rows).T, rtol=1e-12)


def test_a_helmsman_and_a_ship(plain: Any, run_record: Any) -> None:
    """The ship is integrated, the helmsman decides on the samples, from what the ship is at their beginning."""
    model = join("helmed", find_model("de-keizer"), SteeringMachine, ZigzagHelm)
    assert not model.is_sampled
    values = find_ship("soesterberg").values(model) | container()
    values |= {"helm_start": 20.0, "helm_course": 0.0, "helm_rudder": 0.3, "helm_heading": 0.2}
    start = {s: values.get(s, model[s].number("start") or 0.0) for s in model.states}
    t = np.arange(0, 400, 0.5)
    got = run_record(model, (*model.states, "delta_order"), values | start, {}, t, hold="zero")

    ship = {n: values.get(n, 0.0) for n in model.inputs} | values | {"T_s": 0.5}
    continuous = tuple(s for s in model.states if model[s].equation.kind == "rate")

    def rates(point: dict[str, float], ahead: float, slope: dict[str, float]) -> dict[str, float]:
        moved = point | {n: point[n] + ahead * slope[n] for n in continuous if slope}
        return plain(model, ship | moved, "rate")

    point, rows = dict(start), []
    for _ in t:
        rows.append([*point.values(), plain(model, ship | point, "equals")["delta_order"]])
        k1 = rates(point, 0.0, {})
        k2 = rates(point, 0.25, k1)
        k3 = rates(point, 0.25, k2)
        k4 = rates(point, 0.5, k3)
        decided = plain(model, ship | point, "next")
        point |= {n: point[n] + 0.5 / 6 * (k1[n] + 2 * k2[n] + 2 * k3[n] + k4[n]) for n in continuous}
        point |= decided
    wanted = np.array(rows, dtype=float).T
    side = wanted[list(start).index("helm_side")]
    assert np.count_nonzero(np.diff(side)) >= 3
    # 800 steps, rounding of 1e-16 each, in a model that forgets.
    np.testing.assert_allclose(got[:, :-1], wanted[:, :-1], rtol=1e-10, atol=1e-11)


def test_what_a_step_refuses() -> None:
    system = generate(find_model("nomoto"))
    with pytest.raises(UnknownNameError, match="Did you mean heun"):
        make_step(system, "huen")
    with pytest.raises(UnknownNameError, match="linear"):
        make_step(system, hold="liner")
    with pytest.raises(UsageError, match="at least one substep"):
        make_step(system, substeps=0)


@pytest.mark.parametrize("hold", ["linear", "zero"])
def test_the_function_of_a_step(hold: str) -> None:
    system = generate(find_model("nomoto"))
    function = make_step(system, hold=hold).function
    x, u, p = np.array([0.01, 0, 0, 0]), np.array([0.1, 0, 5, 0, 0, 0]), np.array([0.07, 40.0])
    held = function(x, u, u, p, 1.0).full()
    moved = function(x, u, 2 * u, p, 1.0).full()
    # r + (K delta - r) (1 - e^(-T/tau)), to the fourth order's (1/40)^5/120
    exact = 0.01 + (0.007 - 0.01) * (1 - np.exp(-1 / 40))
    assert held[0, 0] == pytest.approx(exact, abs=1e-12)
    assert np.array_equal(held, moved) == (hold == "zero")
