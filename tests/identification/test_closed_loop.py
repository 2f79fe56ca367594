"""A ship that an autopilot steers in gusts: the truth by the defaults, and a record that cannot give it is named."""

from __future__ import annotations

import importlib.util
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import shipid
from shipid.identification.noise.whitened import as_not_whitened, on_white_residuals
from shipid.identification.problem.box import Box
from shipid.trials.doctor.autopilot_steers import autopilot_steers, rudder_answers


@pytest.fixture(scope="module")
def study():
    """The study, whose records are sailed here as well."""
    folder = Path(__file__).parents[2] / "studies"
    sys.path.insert(0, str(folder))
    try:
        spec = importlib.util.spec_from_file_location("closed_loop_study", folder / "closed_loop.py")
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(folder))
    return module


def test_course_changes_give_the_truth_by_the_defaults(study):
    (trial,) = study.records(20.0, 1)
    fit = shipid.identify("nomoto", [trial], starts=1)
    assert fit.identified.method == "prediction-error"
    assert "an autopilot steers steps-20-0" in repr(fit)
    for name, true in study.TRUTH.items():
        found = fit.parameters[name]
        assert found.value == pytest.approx(true, rel=0.1)  # asked of a closed loop at this excitation
        assert abs(found.value - true) < 2 * found.std
    # Output error is farther off, and is taken only where it is asked for.
    plain = shipid.identify("nomoto", [trial], starts=1, method="output-error")
    assert plain.identified.method == "output-error"
    for name, true in study.TRUTH.items():
        assert abs(plain.parameters[name].value - true) > abs(fit.parameters[name].value - true)
    # The finding that it is biased no longer spoils the fit that is not.
    serious = {m: _serious(f) for m, f in (("default", fit), ("plain", plain))}
    assert "closed-loop" not in serious["default"] and "closed-loop" in serious["plain"]


def test_gusts_that_move_the_ship_more_than_her_rudder_leave_honest_intervals(study):
    """A run with the rudder alone misses more than the whole rate of turn, and prediction error is no worse for it."""
    (trial,) = study.records(10.0, 1)
    fit = shipid.identify("nomoto", [trial], starts=1)
    for name, true in study.TRUTH.items():
        found = fit.parameters[name]
        assert found.identifiable and abs(found.value - true) < 2 * found.std
    assert [n.kind for n in fit.warnings] == ["mostly-disturbances"] and not fit.warnings[0].serious
    assert "note      Disturbances turned the ship more than her rudder did" in fit.text()


@pytest.fixture(scope="module")
def kept(study):
    """Records in which the course is kept; slow gusts push the heading farther off in each."""
    return study.records(0.0, 3)


def test_a_kept_course_gives_no_number(kept):
    """Prediction error finds K 0.0034 ± 0.0031 in the last one, where 0.08 is right."""
    fit = shipid.identify("nomoto", [kept[-1]], starts=1)
    assert all(e.value is None and "the course is kept" in e.why for e in fit.parameters.values())
    (notice,) = fit.warnings
    assert notice.kind == "not-determined" and notice.serious and "Change the course" in str(notice)


def in_heavy_waves(step: int, seed: int, first: int) -> shipid.Trial:
    """The zeefakkel under her autopilot, whose rudder answers the waves; courses to and fro from a first time in s on."""
    pilot = shipid.design_autopilot("nomoto", "zeefakkel")
    orders = [(f"{first + 140 * k} s", f"{step} deg" if k % 2 == 0 else "0 deg") for k in range(6)]
    how = {"waves": "1 deg from 40 deg", "noise": "psi=0.2 deg,r=0.05 deg/s", "duration": "900 s", "sampling": "1 s"}
    return shipid.sail(pilot, orders, **how, seed=seed)


def _serious(fit):
    return {f.finding.kind for f in shipid.assess(fit, bands=False).assessment.findings if f.finding.serious}


def test_course_keeping_is_named_and_stays_serious(study, kept):
    for trial in kept:
        found = {f.kind: f for f in shipid.check_trial(trial).findings}["course-keeping"]
        assert found.serious and "nothing but disturbances moves the rudder" in found.message
    for step in (5.0, 20.0):
        (changed,) = study.records(step, 1)
        assert "course-keeping" not in {f.kind for f in shipid.check_trial(changed).findings}


@pytest.mark.parametrize("manoeuvre", ["zigzag:20/20", "zigzag:10/5", "turn:35"])
def test_a_trial_of_orders_is_not_steered_by_an_autopilot(manoeuvre):
    trial = shipid.simulate("de-keizer", "soesterberg", manoeuvre, noise="standard")
    assert autopilot_steers(trial) is None


def test_one_long_change_of_course_is_no_course_keeping():
    """The helm law explains nearly all of its rudder, too."""
    trial = shipid.simulate("de-keizer", ship="soesterberg", manoeuvre="course:60", noise="standard", seed=4)
    assert "course-keeping" not in {f.kind for f in shipid.check_trial(trial).findings}


def test_waves_that_the_rudder_follows_leave_the_truth_within_a_tenth() -> None:
    """Prediction error takes them for a force on the ship, and nothing is left for her rudder: no gain, or half of it."""
    pilot = shipid.design_autopilot("nomoto", "soesterberg")
    orders = [("30 s", "40 deg"), ("280 s", "0 deg")]
    trial = shipid.sail(pilot, orders, waves="0.3 deg from 40 deg", noise="standard", duration="500 s", seed=2)
    # Against the limit of the autopilot the rudder stands, and is not frozen there.
    assert shipid.check_trial(trial).kinds == ("closed-loop",)
    fit = shipid.identify("nomoto", [trial], ship="soesterberg", starts=1)
    assert fit.identified.method == "output-error"
    assert fit.parameters["K"].value == pytest.approx(0.0672566, rel=0.1)
    assert fit.parameters["tau"].value == pytest.approx(40.4421, rel=0.1)
    assert "Noise of the sensors that lasts, such as waves" in fit.text() and "The rudder answers it" in fit.text()
    assert fit.identified.solution.whitened and "whitened by their autoregression" in fit.method
    assert "closed-loop" in _serious(fit)


@pytest.mark.parametrize("purpose", [None, "filter"])
def test_a_rudder_that_answers_heavy_waves_leaves_no_bias(purpose) -> None:
    """Output error by name finds three quarters of the time constant: the noise that the rudder answered counts as her answer to the rudder."""
    trial = in_heavy_waves(20, 6, first=30)
    plain = shipid.identify("nomoto", [trial], ship="zeefakkel", starts=1, method="output-error")
    fit = shipid.identify("nomoto", [trial], ship="zeefakkel", starts=1, purpose=purpose)
    assert fit.identified.solution.whitened
    for name, truth in (("K", 0.5), ("tau", 31.0)):
        assert abs(fit.parameters[name].value - truth) < 2 * fit.parameters[name].std
    assert plain.parameters["tau"].value < 31.0 - 4 * plain.parameters["tau"].std


def test_intervals_of_whitened_residuals_hold_what_they_say() -> None:
    """The numbers of the autoregression are estimated too, and the rudder moves between its samples: without either a third are missed."""
    errors = []
    for seed in range(103, 109):
        fit = shipid.identify("nomoto", [in_heavy_waves(10, seed, first=20)], ship="zeefakkel", starts=1)
        assert fit.identified.solution.whitened
        errors += [(fit.parameters[n].value - v) / fit.parameters[n].std for n, v in (("K", 0.5), ("tau", 31.0))]
    assert 0.4 < np.sqrt(np.mean(np.square(errors))) < 1.5


def test_an_effect_that_a_model_lacks_is_told_under_an_autopilot_as_well() -> None:
    """A first-order model of a second-order ship finds four fifths of her gain, and the intervals of noise were ten deviations off that."""
    pilot = shipid.design_autopilot("nomoto-second-order", "mariner")
    orders = [(f"{30 + 270 * k} s", "30 deg" if k % 2 == 0 else "0 deg") for k in range(4)]
    how = {"waves": "0.5 deg from 60 deg", "noise": "psi=0.1 deg,r=0.02 deg/s", "duration": "1100 s", "sampling": "1 s"}
    fit = shipid.identify("nomoto", [shipid.sail(pilot, orders, **how, seed=1)], ship="mariner", starts=1)
    assert fit.identified.solution.whitened
    assert [n.kind for n in fit.warnings] == ["effect-missing"]
    gain = fit.parameters["K"]
    assert 0.185 - 2 * gain.std < gain.value < 0.165


def test_a_zigzag_in_waves_is_not_whitened() -> None:
    """Her helmsman waits for the heading; what he does between is no answer to noise."""
    trial = shipid.simulate("nomoto", "zeefakkel", "zigzag:20/20", waves="1 deg from 40 deg", noise="standard", seed=1)
    assert not shipid.identify("nomoto", [trial], ship="zeefakkel", starts=1).identified.solution.whitened


def test_samples_of_the_rudder_that_are_missing_do_not_matter() -> None:
    pilot = shipid.design_autopilot("nomoto", "zeefakkel")
    trial = shipid.sail(
        pilot, [("20 s", "20 deg")], waves="2 deg from 40 deg", duration="300 s", sampling="1 s", seed=3
    )
    assert rudder_answers(trial, 9.0) and not rudder_answers(trial, 1.0)
    holes = trial.table.assign(delta=trial["delta"])
    holes.loc[::7, "delta"] = np.nan
    assert rudder_answers(replace(trial, table=holes), 9.0)
    assert rudder_answers(replace(trial, table=holes.assign(delta=np.nan)), 9.0)
    assert not rudder_answers(replace(trial, table=holes.assign(delta=np.nan, delta_order=np.nan)), 9.0)
    assert not rudder_answers(replace(trial, table=holes.drop(columns=["delta", "delta_order"])), 9.0)


def test_whitened_coefficients_beyond_their_bounds_are_no_result() -> None:
    trial = in_heavy_waves(20, 3, first=30)
    plain = shipid.identify("nomoto", [trial], ship="zeefakkel", starts=1, method="output-error").identified
    assert on_white_residuals(plain.solution, plain.box).whitened
    narrow = replace(plain.box, high=1.05 * plain.solution.parameters)
    assert on_white_residuals(plain.solution, narrow) is None


def test_coloured_residuals_that_cannot_be_whitened_are_told() -> None:
    """What output error finds stood without a word, three quarters of the time constant among it."""
    trial = in_heavy_waves(20, 6, first=30)
    found = shipid.identify("nomoto", [trial], ship="zeefakkel", starts=1, method="output-error").identified.solution
    # The least gain is above what whitened residuals lead to.
    box = Box(np.array([0.6, 31.0]), np.array([0.55, 5.0]), np.array([5.0, 500.0]))
    assert on_white_residuals(found, box) is None
    (notice,) = as_not_whitened(found).notices
    assert notice.serious and notice.kind == "not-whitened" and "A zig-zag tells" in notice
    white = np.random.default_rng(0).standard_normal(found.residual.size)
    assert as_not_whitened(replace(found, residual=white)).notices == ()
