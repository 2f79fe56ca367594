"""A rudder that goes over between two samples of a coarse log: what it does there is followed, as far as the residuals show it."""

from __future__ import annotations

import importlib
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.declaration.vocabulary import FIELDS
from shipid.generation.record import make_record
from shipid.identification.evidence.between_samples import KINDS, input_errors
from shipid.identification.noise import filled_inputs
from shipid.identification.problem.trial_data import prepare

identifying = importlib.import_module("shipid.identification.identify")
FINE, SPEED, COARSE = 0.05, 5.0, 1.0
EVERY = round(COARSE / FINE)
NOISE = {"psi": np.deg2rad(0.1), "r": np.deg2rad(0.01)}


@pytest.fixture(scope="module")
def fine():
    """Times and rudder of a zig-zag, in small steps: 10 deg/s, and a time constant at the end."""
    sailed = shipid.simulate("norrbin", "zeefakkel", "zigzag:20/20", sampling=FINE)
    return sailed["t"], sailed["delta"]


def log(t, delta, first, seed, every=EVERY):
    """A noisy log of every so many-th sample, of a ship that has the rudder at all of them."""
    model = shipid.find_model("norrbin")
    record = make_record(model, tuple(NOISE))
    inputs = np.array([delta if n == "delta" else np.full(t.size, SPEED if n == "u" else 0.0) for n in model.inputs])
    p = record.system.vector(record.system.coefficients, truth())
    y, _ = record(np.zeros(len(model.states)), inputs, np.diff(t, append=t[-1]), p)
    rng = np.random.default_rng(seed)
    columns = {"t": t[first::every], "delta": delta[first::every]}
    columns |= {n: row[first::every] for n, row in zip(NOISE, y)}
    columns |= {n: columns[n] + s * rng.standard_normal(columns["t"].size) for n, s in NOISE.items()}
    units = {n: FIELDS[n].unit for n in columns}
    return shipid.Trial.from_frame(pd.DataFrame(columns), name="log", units=units)


def truth():
    return shipid.find_ship("zeefakkel").values(shipid.find_model("norrbin"), speed=SPEED)


def off(fit):
    """How far the coefficients are from the truth, in standard deviations, and these."""
    known = truth()
    found = [(fit.parameters[n].value - known[n], fit.parameters[n].std) for n in fit.estimated]
    return np.array([e / s for e, s in found]), np.array([s for _, s in found])


def follows(fit):
    """How much of the corners the inputs of a fit follow, in shares of all of them."""
    data = fit.identified.problem.trials[0]
    k = fit.model.inputs.index("delta")
    whole = input_errors(
        replace(data, inputs=np.where(np.arange(len(data.inputs))[:, None] == k, data.trial["delta"], 0.0))
    )
    whole = whole[:KINDS, k].sum(axis=0)
    return float(np.sum((data.inputs[k] - data.trial["delta"]) * whole) / np.sum(whole**2))


def test_a_rudder_is_followed_between_its_samples(fine, monkeypatch):
    """In straight lines the gain is several standard deviations off, always to the same side."""
    trials = [log(*fine, first, first) for first in range(0, EVERY, 3)]
    fits = [shipid.identify("norrbin", trial, ship="zeefakkel", starts=1) for trial in trials]
    errors = np.array([off(fit)[0] for fit in fits])
    assert np.sqrt(np.mean(errors**2)) < 1.3
    assert np.mean([follows(fit) for fit in fits]) == pytest.approx(1.0, abs=0.3)
    monkeypatch.setattr(identifying, "follow_corners", lambda solution, _: solution)
    straight = [shipid.identify("norrbin", trial, ship="zeefakkel", starts=1) for trial in trials]
    assert np.mean([off(fit)[0][0] for fit in straight]) > 2


def test_orders_on_the_clock_of_the_samples(monkeypatch):
    """Every rudder sets out at a sample and stops between two: what all have in common is then not what it is in the mean."""
    pilot = shipid.design_autopilot("nomoto", "zeefakkel")
    orders = [(f"{20 + 140 * k} s", "10 deg" if k % 2 == 0 else "0 deg") for k in range(6)]
    sailed = shipid.sail(pilot, orders, duration="900 s", sampling=f"{FINE} s")
    logs = [log(sailed["t"], sailed["delta"], 0, seed) for seed in range(4)]
    gains = [off(shipid.identify("norrbin", one, ship="zeefakkel", starts=1))[0][0] for one in logs]
    assert np.median(np.abs(gains)) < 1.5
    monkeypatch.setattr(identifying, "follow_corners", lambda solution, _: solution)
    assert off(shipid.identify("norrbin", logs[0], ship="zeefakkel", starts=1))[0][0] > 5


def test_straight_lines_are_followed_where_they_are_what_the_rudder_did(fine):
    """The same log, of a ship whose rudder did move in straight lines from sample to sample."""
    t, delta = fine
    for first in (0, 10):
        at = slice(first, None, EVERY)
        straight = np.interp(t, t[at], delta[at])
        fit = shipid.identify("norrbin", log(t, straight, first, first), ship="zeefakkel", starts=1)
        assert follows(fit) < 0.3
        assert np.abs(off(fit)[0]).max() < 2


def test_a_corner_that_is_cut_has_the_area_of_its_error(fine):
    """The correction, of logs that begin at any time, is the mean error of straight lines within a fifth."""
    t, delta = fine
    trial = prepare(shipid.find_model("norrbin"), log(t, delta, 0, 1), tuple(NOISE), SPEED)
    shares = []
    for first in range(0, EVERY, 2):
        at = np.arange(first, t.size - EVERY, EVERY)
        error = np.where((t >= t[at[0]]) & (t <= t[at[-1]]), delta - np.interp(t, t[at], delta[at]), 0.0)
        # What each sample stands for.
        near = np.minimum(np.maximum(np.arange(t.size) - first + EVERY // 2, 0) // EVERY, at.size - 1)
        area = np.bincount(near, error * FINE, at.size)
        inputs = np.zeros((len(trial.inputs), at.size))
        inputs[0] = delta[at]
        data = replace(trial, inputs=inputs, intervals=np.append(np.full(at.size - 1, COARSE), 0.0))
        common = input_errors(data)[:KINDS, 0].sum(axis=0) * COARSE
        shares.append((area @ common) / (common @ common))
    assert np.mean(shares) == pytest.approx(1.0, abs=0.2)


def corrected(values, every=EVERY):
    """Areas of the errors of straight lines between samples, and of their correction, about each of the samples."""
    at = np.arange(0, values.size, every)
    model = shipid.find_model("norrbin")
    data = prepare(model, log(np.arange(values.size) * FINE, values, 0, 1, every), tuple(NOISE), SPEED)
    error = values - np.interp(np.arange(values.size), at, values[at])
    return error.sum() * FINE, input_errors(data)[:KINDS, model.inputs.index("delta")].sum() * every * FINE


@pytest.mark.parametrize("part", (0.0, 0.2, 0.5, 0.75))
def test_a_corner_between_two_samples_is_found(part):
    """Of one that stands by itself the area is that of its triangle, wherever in its interval it is."""
    t = np.arange(0, 20.01, FINE)
    error, correction = corrected(np.deg2rad(np.minimum(t, 10 + part)))
    assert error == pytest.approx(np.deg2rad(part * (1 - part) / 2), abs=1e-12)
    assert correction == pytest.approx(error, abs=1e-12)


def test_a_constant_bend_is_found():
    """A parabola is above its chords by a twelfth of the bend and the cube of the interval."""
    t = np.arange(0, 40.01, FINE)
    error, correction = corrected(-0.0005 * (t - 10) ** 2 * (t > 10))
    assert error == pytest.approx(30 * 0.001 / 12, rel=0.01)
    assert correction == pytest.approx(error, rel=0.05)


def test_the_common_error_of_two_trials_is_one(fine):
    """What is left unknown of it moves the coefficients alike in both, errors of single intervals do not."""
    trials = [log(*fine, first, first) for first in (3, 11)]
    fit = shipid.identify("norrbin", trials, ship="zeefakkel", starts=1)
    one, other = (data.unsure for data in fit.identified.problem.trials)
    assert one.shape[0] == other.shape[0]
    assert one[:KINDS].any() and other[:KINDS].any()
    assert not (one[KINDS:].any(axis=(1, 2)) & other[KINDS:].any(axis=(1, 2))).any()
    assert np.abs(off(fit)[0]).max() < 2.5


def test_a_rudder_that_is_sampled_finely_is_left_as_it_is(fine):
    """Corners that are nothing beside the noise are not looked for."""
    t, delta = fine
    fit = shipid.identify("norrbin", log(t, delta, 0, 1, every=1), ship="zeefakkel", starts=1)
    data = fit.identified.problem.trials[0]
    assert data.unsure is None
    assert (data.inputs[0] == data.trial["delta"]).all()


def test_an_error_that_changes_nothing_is_not_run(fine, monkeypatch):
    """Those of the other trials, and of the speed, which moves only positions of this model: no run for them, and no change by them."""
    trials = [log(*fine, first, first) for first in (3, 11)]
    fit = shipid.identify("norrbin", trials, ship="zeefakkel", starts=1).identified
    whole, runs = filled_inputs.run_many, []
    monkeypatch.setattr(filled_inputs, "run_many", lambda *a: runs.append(len(a[1])) or whole(*a))
    errors = fit.problem.trials[0].unsure
    beside = np.zeros_like(errors)
    beside[:, fit.problem.model.inputs.index("u")] = 0.1
    changes = filled_inputs.changes_by(fit.problem, fit.solution.q, 0, np.concatenate([errors, beside]))
    acting = errors.any(axis=(1, 2))
    assert acting.any() and not acting.all()
    assert runs == [1 + np.count_nonzero(acting)]
    assert changes[: len(errors)][acting].any(axis=(1, 2)).all()
    assert not changes[: len(errors)][~acting].any() and not changes[len(errors) :].any()
