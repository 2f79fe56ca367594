"""The ladder: equation error, multiple shooting, and which rung a result came from."""

from __future__ import annotations

import json

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.identification.errors import NotRegressableError
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import make_problem
from shipid.identification.problem.signals import unknown_biases
from shipid.identification.problem.trial_data import prepare
from shipid.identification.search.equation_error import instrumental_variables, least_squares
from shipid.identification.search.least_squares import minimise
from shipid.identification.search.multiple_shooting import shoot
from shipid.identification.search.regression import make_regression, make_window
from shipid.identification.search.trust_region import search
from shipid.parameters.parameter_set import Value

SIGMA = {"psi": np.deg2rad(0.2), "r": np.deg2rad(0.02), "u": 0.1, "v": 0.1}


def problem_of(trial, model, truth, signals=("psi", "r"), names=("a", "b1", "b3")):
    found = shipid.find_model(model)
    fixed = {n: v for n, v in truth.items() if n not in names}
    sigma = np.array([SIGMA[s] for s in signals])
    prepared = [prepare(found, trial, signals, None)]
    return make_problem(found, prepared, signals, names, fixed, sigma, unknown_biases(found, signals))


def test_a_window_smooths_and_differentiates():
    """Exact for a straight line; the two sides fit each other: the smoothed derivative is that of the smoothed."""
    window = make_window(6, 0.5)
    t = 0.5 * np.arange(60)
    assert window.smooth(np.ones((1, 60))) == pytest.approx(1.0)
    assert window.rate(3 * t[None]) == pytest.approx(3.0)
    wave, slope = np.sin(0.3 * t)[None], 0.3 * np.cos(0.3 * t)[None]
    # The sums over samples stand for integrals: to the fourth order of the step.
    assert window.rate(wave) == pytest.approx(window.smooth(slope), abs=1e-3)


@pytest.mark.parametrize("method", ["equation-error", "instrumental-variables"])
@pytest.mark.parametrize(("model", "ship"), [("norrbin", "zeefakkel"), ("de-keizer", "soesterberg")])
def test_equation_error_recovers_the_truth_without_noise(sail, truth_of, model, ship, method):
    """Linear in its coefficients, and not; what is left is the window's sums over samples and the rudder's corners."""
    trial = sail(model, ship, noise=None, sampling="0.2 s")
    truth = truth_of(model, ship)
    fit = shipid.identify(model, [trial], ship=_particulars(ship), method=method)
    assert fit.converged
    for name in fit.estimated:
        size = max(abs(truth[name]), 0.05 * abs(fit.model[name].number("start") or 1.0))
        assert fit.parameters[name].value == pytest.approx(truth[name], abs=0.01 * size), name
    assert [(r.method, r.used) for r in fit.ladder] == [(method, True)]
    assert "not their bias" in fit.message
    section = fit.ship.sections[model]
    assert f"identified by {method.replace('-', ' ')}" in next(iter(section.values())).source


def _particulars(ship):
    known = shipid.find_ship(ship)
    return shipid.ParameterSet(ship, sections={"particulars": known.sections["particulars"]})


def test_linear_regression_is_the_normal_equations(sail, truth_of):
    """Against NumPy's solution of the same rows, the rudder believed; it needs no start."""
    trial = sail("norrbin", "zeefakkel", sampling="0.5 s")
    found = shipid.find_model("norrbin")
    prepared = [prepare(found, trial, ("psi", "r"), None)]
    sigma = np.array([SIGMA["psi"], SIGMA["r"]])
    truth = truth_of("norrbin", "zeefakkel", 5.0)
    problem = make_problem(found, prepared, ("psi", "r"), ("a", "b1", "b3"), {}, sigma, ())
    regression = make_regression(problem, 9.0)
    assert regression.equations == ("r",) and regression.covered == ("a", "b1", "b3") and regression.linear
    window = regression.blocks[0].window
    r, delta = trial["r"], trial["delta"]
    rows = np.array([window.smooth(x[None])[0] for x in (delta, -r, -(r**3))]).T
    expected = np.linalg.lstsq(rows, window.rate(r[None])[0], rcond=None)[0]
    far = Box(np.array([-5.0, 20.0, -900.0]), np.full(3, -np.inf), np.full(3, np.inf))
    answer = least_squares(regression, far)
    assert answer.theta == pytest.approx(expected, rel=1e-6)
    assert answer.theta == pytest.approx([truth[n] for n in ("a", "b1", "b3")], rel=0.1)


def test_instrumental_variables_take_the_bias_of_noise_off(sail, truth_of):
    """A rate of turn twenty times as noisy: least squares misses the cubic damping, the instruments do not."""
    truth = truth_of("norrbin", "zeefakkel", 5.0)
    errors, claimed = {"squares": [], "instruments": []}, []
    for seed in range(12):
        noise = {"psi": "0.2 deg", "r": "0.4 deg/s"}
        trial = sail("norrbin", "zeefakkel", noise=noise, sampling="0.5 s", seed=seed, speed="5 m/s")
        problem = problem_of(trial, "norrbin", {})
        start = np.array([truth[n] for n in problem.estimated])
        box = Box(start, np.full(3, -np.inf), np.full(3, np.inf))
        first = least_squares(make_regression(problem, 9.0), box)
        second = instrumental_variables(first, box)
        assert second.converged, second.message
        errors["squares"].append(first.theta[:3] / start - 1)
        errors["instruments"].append(second.theta[:3] / start - 1)
        claimed.append(np.sqrt(np.diag(second.covariance())) / start)
    away = {k: np.abs(np.mean(v, axis=0)) / np.std(v, axis=0, ddof=1) * np.sqrt(12) for k, v in errors.items()}
    assert away["squares"][2] > 4
    # Three standard errors: each of three coefficients once in 370 by chance.
    assert away["instruments"].max() < 3
    # The scatter is the one that is claimed; that of 12 runs is known to 21 %.
    assert np.std(errors["instruments"], axis=0, ddof=1) == pytest.approx(np.mean(claimed, axis=0), rel=0.5)


def test_equation_error_says_what_it_lacks(sail):
    trial = sail("bech", "kvlcc2", sampling="2 s")
    with pytest.raises(NotRegressableError, match=r"equation-error cannot find 'd1' of model bech: .* not measured: w"):
        shipid.identify("bech", [trial], ship="kvlcc2", method="equation-error")


def test_equation_error_of_a_sampled_state_is_refused():
    model = shipid.find_model("pershitz-discrete")
    trial = shipid.simulate(
        shipid.find_model("pershitz"), "semerdjiev", "zigzag:20/20", sampling="1 s", noise="standard"
    )
    with pytest.raises(NotRegressableError, match="cannot find"):
        shipid.identify(model, [trial], ship="semerdjiev", method="instrumental-variables")


#: Coefficients from which output error alone runs away or stays in a far minimum; Bech's d1, d0, c1, c0, c3 over the truth.
BAD = [(1.06, 7.96, 0.19, 7.89, 0.42), (2.33, -3.75, -0.24, -4.02, 0.24), (0.35, 0.1, 1.96, 2.75, -4.69)]


@pytest.fixture(scope="module")
def unstable(sail, truth_of):
    trial = sail("bech", "kvlcc2", sampling="2 s")
    truth = truth_of("bech", "kvlcc2")
    names = ("d1", "d0", "c1", "c0", "c3")
    return problem_of(trial, "bech", truth, names=names), np.array([truth[n] for n in names])


@pytest.mark.parametrize("factors", BAD)
def test_multiple_shooting_comes_home_from_where_output_error_does_not(unstable, factors):
    problem, truth = unstable
    wide = Box(truth, np.full(5, -np.inf), np.full(5, np.inf))
    best = minimise(problem, problem.first_guess(truth), wide, most=100)
    q0 = problem.first_guess(truth * np.array(factors))
    alone = minimise(problem, q0, wide, most=100)
    joined = shoot(problem, q0, wide, unit_time=40.0)
    home = minimise(problem, joined.q, wide, most=100)
    assert alone.cost > 10 * best.cost
    assert home.cost == pytest.approx(best.cost, rel=1e-4)
    assert home.q[:5] == pytest.approx(best.q[:5], rel=1e-2)


def test_multiple_shooting_at_the_truth_closes_its_joints(unstable):
    problem, truth = unstable
    wide = Box(truth, np.full(5, -np.inf), np.full(5, np.inf))
    joined = shoot(problem, problem.first_guess(truth), wide, unit_time=40.0)
    best = minimise(problem, joined.q, wide, most=100)
    # What its joints leave open, two thousandths of a weight, output error has not to pay for.
    assert joined.converged and joined.cost == pytest.approx(best.cost, rel=0.02)


def _bad_ship(truth, factors):
    """Kvlcc2 with coefficients so far off that Bech's model runs away over a record; the search starts at them."""
    model, known = shipid.find_model("bech"), shipid.find_ship("kvlcc2").sections["particulars"]
    names = ("d1", "d0", "c1", "c0", "c3")
    section = {n: Value(n, truth[n] * f, model[n].unit, "assumed") for n, f in zip(names, factors)}
    return shipid.ParameterSet("bad", sections={"particulars": known, "bech": section})


def test_the_rescue_is_climbed_where_output_error_runs_away(sail, truth_of):
    trial, truth = sail("bech", "kvlcc2", sampling="2 s"), truth_of("bech", "kvlcc2")
    ship = _bad_ship(truth, BAD[2])
    fit = shipid.identify("bech", [trial], ship=ship, starts=1)
    first, second = fit.ladder
    assert (first.method, first.used, first.cost, first.converged) == ("output-error", False, None, False)
    assert "runs away from every start" in first.reason
    assert (second.method, second.used, second.converged) == ("multiple-shooting", True, True)
    assert fit.converged and fit.method.startswith("multiple shooting, finished by output error on psi, r")
    for name in fit.estimated:
        assert abs(fit.parameters[name].value - truth[name]) < 4 * fit.parameters[name].std, name
    tried = json.loads(json.dumps(fit.to_dict(), allow_nan=False))["ladder"]
    assert [set(r) for r in tried] == [{"method", "cost", "converged", "used", "reason", "evaluations"}] * 2
    assert "tried     multiple-shooting (cost" in fit.text()
    # The method asked for alone is not rescued.
    alone = shipid.identify("bech", [trial], ship=ship, starts=1, method="output-error")
    assert not alone.converged and [r.method for r in alone.ladder] == ["output-error"]
    asked = shipid.identify("bech", [trial], ship=ship, starts=1, method="multiple-shooting")
    assert asked.parameters["d0"].value == pytest.approx(fit.parameters["d0"].value, rel=1e-4)


def test_a_regression_is_one_of_the_starts(sail):
    """From a first value a hundred times off, with no other start."""
    trial = sail("norrbin", "zeefakkel", sampling="0.5 s")
    ship = shipid.ParameterSet("far", sections={"particulars": shipid.find_ship("zeefakkel").sections["particulars"]})
    far = {"norrbin": {"a": Value("a", 2.0, "1/s^2", "assumed"), "b1": Value("b1", 5.0, "1/s", "assumed")}}
    lost = shipid.ParameterSet("lost", sections={**ship.sections, **far})
    fit = shipid.identify("norrbin", [trial], ship=lost, starts=1)
    good = shipid.identify("norrbin", [trial], ship="zeefakkel")
    assert fit.ladder[0].method == "instrumental-variables"
    assert fit.parameters["a"].value == pytest.approx(good.parameters["a"].value, rel=1e-4)


def test_a_direction_no_residual_sees_does_not_cut_the_steps():
    """A column of zeros beside two that matter, its bound near: the search still ends at the least squares."""
    rng = np.random.default_rng(1)
    a, b = rng.standard_normal((40, 2)), rng.standard_normal(40)
    full = np.column_stack([a, np.zeros(40)])
    low, high = np.array([-100.0, -100.0, 1e-3]), np.array([100.0, 100.0, 2.0])
    logs = np.array([False, False, True])
    found = search(lambda q: (full @ q - b, full), np.array([50.0, -50.0, 1.9]), logs, low, high, 20, 1e-10)
    assert found.converged and found.evaluations < 12
    assert found.q[:2] == pytest.approx(np.linalg.lstsq(a, b, rcond=None)[0], rel=1e-6)
    assert found.q[2] == pytest.approx(1.9)


def test_methods_losses_and_their_names(sail):
    trial = sail("norrbin", "zeefakkel", sampling="2 s")
    with pytest.raises(UnknownNameError, match="method"):
        shipid.identify("norrbin", [trial], ship="zeefakkel", method="magic")
    with pytest.raises(UnknownNameError, match="loss"):
        shipid.identify("norrbin", [trial], ship="zeefakkel", loss="cubic")
    with pytest.raises(UsageError, match="method equation-error uses squares only"):
        shipid.identify("norrbin", [trial], ship="zeefakkel", method="equation-error", loss="huber")


def test_a_profile_of_a_regression_is_refused(sail):
    fit = shipid.identify("norrbin", [sail("norrbin", "zeefakkel")], ship="zeefakkel", method="equation-error")
    with pytest.raises(UsageError, match="profile"):
        fit.profile("a")
