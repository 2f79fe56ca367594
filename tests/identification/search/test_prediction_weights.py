"""Weights for prediction: none firmer than the residuals, less where they last, and fewer samples where they repeat."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import shipid
from shipid.declaration.vocabulary import FIELDS
from shipid.identification.problem.box import box_of
from shipid.identification.problem.output_error import make_problem
from shipid.identification.problem.prior import Prior
from shipid.identification.problem.trial_data import prepare
from shipid.identification.search.least_squares import minimise, thinned_to
from shipid.identification.search.prediction_weights import (
    correlation_times,
    independent_samples,
    weigh_again,
    weigh_first,
)
from shipid.identification.search.solution import Solution, residual_levels

SIGNALS = ("psi", "r")


@pytest.fixture(scope="module")
def problem(sail):
    trial = sail("nomoto", "zeefakkel", "zigzag:20/20", seed=1, name="t")
    data = prepare(shipid.find_model("nomoto"), trial, SIGNALS, 5.0)
    return make_problem(
        shipid.find_model("nomoto"), [data], SIGNALS, ("K", "tau"), {"L": 45.0}, np.array([0.02, 0.002]), ()
    )


def solution_of(problem, residual) -> Solution:
    size = residual.size
    return Solution(problem, np.zeros(problem.size), residual, np.zeros((size, problem.size)), True, "", 0)


def test_noise_levels_spend_the_unknowns(drift, drifting):
    """Of a linear regression: the sum of squares over the samples less the three unknowns."""
    trial, design = drifting(np.deg2rad(0.5), 30, seed=3)
    sailed, box = prepare(drift, trial, ("psi",), None), box_of({"gain": (0.1, -10, 10), "swing": (0.0, -1, 1)})
    problem = make_problem(drift, [sailed], ("psi",), ("gain", "swing"), {}, np.array([0.1]), ())
    found = minimise(problem, problem.first_guess(box.start), box, most=50, tolerance=1e-12)
    (squares,) = np.linalg.lstsq(design, trial["psi"], rcond=None)[1]
    assert residual_levels(found) == pytest.approx([np.sqrt(squares / (30 - 3))], rel=1e-6)


def test_how_long_a_residual_lasts(problem):
    """White noise lasts for one sample; a moving average of n samples for n of them."""
    count = problem.trials[0].intervals.size
    rng = np.random.default_rng(1)
    n = 20
    white = rng.standard_normal(count)
    smooth = np.convolve(rng.standard_normal(count + n - 1), np.ones(n), "valid")
    lasting = correlation_times(solution_of(problem, np.concatenate([smooth, white])))
    interval = problem.trials[0].intervals[0]
    # Of one record: a sum of autocorrelations scatters by its square root over the number of those lengths.
    assert lasting[0] == pytest.approx(n * interval, rel=0.4)
    assert lasting[1] == pytest.approx(interval, rel=0.4)


def test_samples_that_repeat_each_other_are_left_out_and_their_times_kept(problem):
    whole = problem.trials[0]
    few = independent_samples(problem, 220 * whole.intervals[0]).trials[0]  # forty in 220 are one in five
    assert few.intervals[0] == pytest.approx(5 * whole.intervals[0])
    assert np.array_equal(few.measured, whole.measured[:, ::5])
    again = few.thinned(few.intervals.size // 3)
    assert np.array_equal(again.measured, whole.measured[:, ::15])
    assert again.intervals[0] == pytest.approx(15 * whole.intervals[0])
    assert independent_samples(problem, 10 * whole.intervals[0]).trials[0] is whole


@pytest.mark.parametrize(("strength", "thinned"), [(20.0, 4.0), (3.0, 1.0)])
def test_beliefs_are_thinned_with_the_samples_but_count_once(problem, strength, thinned):
    believing = replace(problem, prior=Prior({}, {}, {}, {"r": 0.01}, strength=strength))
    few = thinned_to(believing, [problem.trials[0].intervals.size // 5])
    assert few.prior.strength == pytest.approx(thinned, rel=0.02)
    assert few.prior.initial == believing.prior.initial


def test_a_disturbed_signal_loses_weight_and_the_others_keep_theirs(sail):
    """Heading with a slow drift of five degrees on it: it gets the weight of that, the rate keeps the structure's."""
    frame = sail("nomoto", "zeefakkel", "zigzag:20/20", seed=2, name="t").table.copy()
    clean = shipid.Trial.from_frame(frame, name="clean", units={n: FIELDS[n].unit for n in frame})
    frame["psi"] += np.deg2rad(5) * np.sin(2 * np.pi * frame["t"] / 40.0)
    drifting = shipid.Trial.from_frame(frame, name="drifting", units={n: FIELDS[n].unit for n in frame})
    gain, rate = {}, {}
    for trial in (clean, drifting):
        fit = shipid.identify("nomoto", [trial], ship="zeefakkel", purpose="prediction", starts=2)
        gain[trial.name], rate[trial.name] = fit.parameters["K"], fit.noise["r"]
        assert fit.converged
    true = shipid.find_ship("zeefakkel").values(shipid.find_model("nomoto"), speed=5.0)["K"]
    assert gain["clean"].value == pytest.approx(true, rel=0.02)
    assert gain["drifting"].value == pytest.approx(true, rel=0.05)
    # The rate still tells it, and its residuals are the noise of its sensor; under the weights of the structure alone the
    # heading pulls the coefficients until they are a quarter larger.
    sensor = np.deg2rad(0.02)
    assert rate["clean"] == pytest.approx(sensor, rel=0.05)
    assert rate["drifting"] == pytest.approx(sensor, rel=0.05)


def lasting_for(problem, share: float, size: float) -> Solution:
    """Residuals that last for this share of the time of independence of 10 s, of this size in standard deviations."""
    count, interval = problem.trials[0].intervals.size, problem.trials[0].intervals[0]
    n = max(1, round(share * 10.0 / interval))
    white = np.random.default_rng(4).standard_normal((2, count + n - 1))
    smooth = np.array([np.convolve(row, np.ones(n), "valid") / np.sqrt(n) for row in white])
    return solution_of(problem, (size * smooth).ravel())


@pytest.mark.parametrize(
    ("share", "size", "expected", "beyond"),
    [
        # White noise, of any size: its own size, over the samples that the time of independence holds.
        (0.0, 0.5, None, 0.0),
        (0.0, 5.0, None, 0.0),
        # Within the error of the structure, and lasting as long as that does: the error of the structure.
        (1.0, 0.5, 1.0, 0.0),
        # Larger, and lasting three times as long: off at the start by what is beyond the error of the structure.
        (3.0, 2.0, 2.0 * np.sqrt(3.0), np.sqrt(3.0)),
    ],
)
def test_weights_by_size_and_duration_of_residuals(problem, monkeypatch, share, size, expected, beyond):
    problem = replace(problem, prior=Prior({}, {}, {}, {"psi": 0.01, "r": 0.001}))
    found = lasting_for(problem, share, size)
    module = "shipid.identification.search.prediction_weights.minimise_robustly"
    monkeypatch.setattr(module, lambda again, *_, **__: replace(found, problem=again, residual=found.residual))
    monkeypatch.setattr("shipid.identification.search.prediction_weights._TURNS", 1)
    again = weigh_again(found, None, problem.sigma, 10.0).problem
    weighed = again.sigma / problem.sigma
    # The size of one record scatters less than the time for which it lasts.
    off = np.array([again.prior.lasting[n] for n in SIGNALS]) / problem.sigma
    assert off == pytest.approx([beyond, beyond], rel=0.3, abs=1e-12)
    if expected is None:
        expected = size * np.sqrt(problem.trials[0].intervals[0] / 10.0)
    # The time for which one record lasts scatters by a half, its root by a quarter.
    assert weighed == pytest.approx([expected, expected], rel=0.35)


@pytest.mark.parametrize("right", [True, False])
def test_residuals_that_last_only_under_the_weights_of_a_wrong_structure_are_noise(problem, monkeypatch, right):
    """A right model with a wind was held to its prior: the moment of the wind came out at a half, and all intervals ten times wider."""
    problem = replace(problem, prior=Prior({}, {}, {}, {"psi": 0.01, "r": 0.001}))
    held, free = lasting_for(problem, 1.0, 0.5), lasting_for(problem, 0.0, 0.05)

    def search(again, *_, **__):
        found = free if right and (again.sigma < 0.5 * problem.sigma).all() else held
        own = problem.sigma / again.sigma
        return replace(found, problem=again, residual=(found.residual.reshape(2, -1) * own[:, None]).ravel())

    monkeypatch.setattr("shipid.identification.search.prediction_weights.minimise_robustly", search)
    structure, noise = 1.0, 0.05 * np.sqrt(problem.trials[0].intervals[0] / 10.0)
    for weigh, expected in ((weigh_again, structure), (weigh_first, noise if right else structure)):
        weighed = weigh(held, None, problem.sigma, 10.0).problem.sigma / problem.sigma
        assert weighed == pytest.approx([expected, expected], rel=0.5)


def test_a_start_is_as_uncertain_as_what_was_measured_and_the_lasting_error_of_the_model_together(problem):
    """One term a state: the distance from the measured start, over the root of the sum of both squares."""
    prior = Prior({}, {}, {}, {"psi": 0.3, "r": 0.01}, lasting={"psi": 0.4, "u": 1.0})
    data = replace(problem.trials[0], start={"psi": 0.0, "r": 0.0}, start_std={"psi": 0.0, "r": 0.0})
    sailed = replace(problem, trials=(data,))
    q = sailed.first_guess(np.array([0.1, 10.0]))
    q[sailed.own(0)] = [1.0 if n == "psi" else 0.02 for n in sailed.initial]
    residual, _ = sailed.prior_residuals(q, prior)
    assert dict(zip(sailed.initial, residual)) == pytest.approx({"psi": 1.0 / 0.5, "r": 0.02 / 0.01})


def test_a_wrong_structure_is_not_held_to_the_measured_start_until_it_misses_the_record():
    """A ship that is unstable on a straight course, under a model with one time constant.

    With free initial states the heading is missed by 1.6 degrees. Weights that follow the residuals, and a start that does not,
    drive each other up: then it is 3.8 degrees.
    """
    ship, rng, trials = shipid.find_model("norrbin"), np.random.default_rng(0), []
    values = {n: (v, ship[n].unit) for n, v in {"a": 3.12e-4, "b1": -2.63e-3, "b3": 272.0}.items()}
    for manoeuvre in ("zigzag:20/20", "zigzag:-20/20"):
        frame = shipid.simulate(ship, "kvlcc2", manoeuvre, sampling="2 s", values=values).table
        frame = frame[["t", "psi", "r", "u", "delta"]].copy()
        frame["psi"] += np.deg2rad(0.1) * rng.standard_normal(len(frame))
        frame["r"] += np.deg2rad(0.005) * rng.standard_normal(len(frame))
        trials.append(shipid.Trial.from_frame(frame, name=manoeuvre, units={n: FIELDS[n].unit for n in frame}))
    fit = shipid.identify("nomoto", trials, ship="kvlcc2", starts=1)
    assert fit.converged
    assert np.rad2deg([c.rmse["psi"] for c in fit.fitted]).max() < 1.5 * 1.62
