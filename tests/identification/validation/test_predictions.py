"""Predictions of trials that were not fitted take nothing from them but their first seconds."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import shipid
from shipid.declaration.vocabulary import FIELDS
from shipid.identification.problem.trial_data import warm_up_samples
from shipid.trials.measuring.measure import measure

DATA = Path(__file__).resolve().parents[4] / "shared" / "data"
FORMATS = Path(__file__).resolve().parents[3] / "studies" / "formats"


@pytest.fixture(scope="module")
def fit(sail):
    return shipid.identify("norrbin", [sail("norrbin", "zeefakkel", seed=1)], ship="zeefakkel", starts=2)


def test_a_right_model_predicts_to_the_noise(fit, sail):
    other = sail("norrbin", "zeefakkel", "zigzag:10/10", seed=2)
    compared = fit.validate([other]).validation[0]
    assert np.rad2deg(compared.refitted["psi"]) == pytest.approx(0.2, rel=0.1)
    assert compared.rmse["psi"] < 5 * compared.refitted["psi"]
    assert np.rad2deg(compared.predicted_overshoots) == pytest.approx(np.rad2deg(compared.overshoots), abs=0.5)
    assert len(compared.overshoots) >= 4


def test_what_comes_after_the_first_seconds_does_not_touch_the_prediction(fit, sail):
    trial = sail("norrbin", "zeefakkel", "zigzag:10/10", seed=2)
    table = trial.table.copy()
    count = warm_up_samples(trial, 45 / 4.95)
    table.loc[count + 5 :, "psi"] += 0.5
    table.loc[count + 5 :, "r"] *= 3
    spoiled = replace(trial, table=table)
    first, second = (fit.validate([t]).validation[0] for t in (trial, spoiled))
    assert second.predicted["psi"] == pytest.approx(first.predicted["psi"], abs=1e-12)
    assert second.rmse["psi"] > 10 * first.rmse["psi"]


def test_a_heading_that_comes_late_starts_the_prediction_where_it_would_have_been(fit, sail):
    """The compass is silent for the first 60 s: four of its samples, and what the rest shows of the turn, are enough."""
    trial = sail("norrbin", "zeefakkel", "zigzag:10/10", seed=2)
    table = trial.table.copy()
    table.loc[trial["t"] < 60.0, "psi"] = np.nan
    whole, late = (fit.validate([t]).validation[0] for t in (trial, replace(trial, table=table)))
    assert abs(np.rad2deg(late.initial["psi"] - whole.initial["psi"])) < 1.0
    table.loc[np.flatnonzero(trial["t"] >= 60.0)[4] :, "psi"] += 0.5
    assert fit.validate([replace(trial, table=table)]).validation[0].initial == pytest.approx(late.initial, rel=1e-4)


@pytest.mark.parametrize(("interval", "samples"), [("0.5 s", 50), ("2 s", 13), ("5 s", 10)])
def test_the_first_seconds_are_a_quarter_of_the_ship_s_time(sail, interval, samples):
    """Of L/U = 100 s they are 25 s, and never fewer than ten samples."""
    assert warm_up_samples(sail("nomoto", "zeefakkel", sampling=interval), 100.0) == samples


def test_what_was_learnt_before_the_first_reversal_is_judged_on_the_rest(fit, sail):
    """Half a radian on the heading of the last third of the record: the error of the rest is that, by its share."""
    trial = sail("norrbin", "zeefakkel", "zigzag:10/10", seed=2)
    table, begin = trial.table.copy(), 2 * len(trial) // 3
    table.loc[begin:, "psi"] += 0.5
    clean, spoiled = (fit.validate([t]).validation[0] for t in (trial, replace(trial, table=table)))
    reversal = np.searchsorted(trial["t"], measure(trial).executes[0])
    share = (len(trial) - begin) / (len(trial) - reversal)
    assert np.rad2deg(clean.warm["psi"]) < 1.0
    assert spoiled.warm["psi"] == pytest.approx(0.5 * np.sqrt(share), rel=0.03)
    assert spoiled.warm["r"] == pytest.approx(clean.warm["r"], rel=1e-6)


def test_the_bias_before_the_first_reversal_stays_near_that_of_the_fitted_trials(fit, sail):
    """A gust that turns the ship by a degree in the first leg is no rudder bias, which would turn her for the rest of the record."""
    trial = sail("norrbin", "zeefakkel", "zigzag:10/10", seed=2)
    table, leg = trial.table.copy(), np.clip(trial["t"] / measure(trial).executes[0], 0, 1)
    table["psi"] += np.deg2rad(1.0) * leg
    fit = fit.validate([trial, replace(trial, table=table)])
    calm, compared = fit.validation
    # She is a degree off, and what the prediction is off by without the gust comes to it or goes from it.
    off = np.rad2deg(calm.rmse["psi"])
    assert off < 0.3 and 1.0 - off < np.rad2deg(compared.rmse["psi"]) < 1.0 + off
    assert np.rad2deg(compared.warm["psi"]) < 0.5


def test_refitting_the_bias_is_reported_apart(fit, sail):
    frame = sail("norrbin", "zeefakkel", "zigzag:10/10", seed=2).table.copy()
    frame["delta"] -= np.deg2rad(1.0)
    units = {n: FIELDS[n].unit for n in frame.columns}
    biased = shipid.Trial.from_frame(frame, name="biased", units=units)
    compared = fit.validate([biased]).validation[0]
    assert np.rad2deg(compared.refitted_bias) == pytest.approx(1.0, abs=0.05)
    assert compared.bias == pytest.approx(fit.fitted[0].bias)
    assert compared.rmse["psi"] > 5 * compared.refitted["psi"]


def test_the_bias_of_a_prediction_is_the_mean_of_the_fitted_trials(sail):
    """Rudder zeros of 2 and -1 degrees, each fitted in its trial: the next trial is predicted with half a degree."""
    units = {n: FIELDS[n].unit for n in ("t", "psi", "r", "u", "delta")}
    trials = []
    for name, zero in (("first", 2.0), ("second", -1.0)):
        frame = sail("norrbin", "zeefakkel", seed=1).table[list(units)].copy()
        frame["delta"] -= np.deg2rad(zero)
        trials.append(shipid.Trial.from_frame(frame, name=name, units=units))
    fit = shipid.identify("norrbin", trials, ship="zeefakkel", starts=1)
    assert np.rad2deg([c.bias for c in fit.fitted]) == pytest.approx([2.0, -1.0], abs=0.1)
    compared = fit.validate([sail("norrbin", "zeefakkel", "zigzag:10/10", seed=2)]).validation[0]
    assert np.rad2deg(compared.bias) == pytest.approx(0.5, abs=0.1)


def test_validation_does_not_change_the_fit(fit, sail):
    after = fit.validate([sail("norrbin", "zeefakkel", "zigzag:10/10", seed=2)])
    assert after.parameters == fit.parameters
    assert fit.validation == ()


def test_trials_of_one_name_are_told_apart(sail):
    first, second, third = (sail("norrbin", "zeefakkel", seed=i, name="zz") for i in range(3))
    fit = shipid.identify("norrbin", [first, second], ship="zeefakkel", validate=[third], starts=1)
    result = fit.to_dict()
    assert list(result["fit"]) == ["zz", "zz-2"]
    assert list(result["validation"]) == ["zz-3"]
    assert list(result["provenance"]["trials"]) == ["zz", "zz-2", "zz-3"]


def test_a_turning_circle_has_no_overshoots(fit, sail):
    compared = fit.validate([sail("norrbin", "zeefakkel", "turn:15", seed=3)]).validation[0]
    assert compared.overshoots == () and compared.predicted_overshoots == ()


def test_a_prediction_that_runs_away_is_said_without_nan(sail):
    """A cubic with the wrong sign, fitted to small angles, has no bound at large ones."""
    fit = shipid.identify(
        "norrbin", [sail("norrbin", "zeefakkel", "zigzag:5/5", seed=1)], ship="zeefakkel", fixed={"b3": "-200 s/rad^2"}
    )
    fit = fit.validate([sail("norrbin", "zeefakkel", "turn:35", seed=2)])
    assert not np.isfinite(fit.validation[0].rmse["psi"])
    text = json.dumps(fit.to_dict(), allow_nan=False)
    name = fit.validation[0].trial.name
    assert json.loads(text)["validation"][name]["psi"]["rmse"]["value"] is None


@pytest.mark.skipif(not DATA.is_dir(), reason="the real trials are not on this machine")
def test_real_trials_stay_where_they_were():
    """The first pass on MARIN's zig-zags: no worse than the baseline of output error at constant speed.

    The baseline is a fit whose initial states and rudder biases are free in each trial. Those of a fit by default are not: they are
    drawn towards what was measured and towards each other. So the same is compared: the error that the identified coefficients
    leave in the fitted trials where initial state and bias are refitted, as in the trial that is predicted.
    """
    trial_format = str(FORMATS / "kvlcc2-marin.toml")
    files = {n: str(DATA / f"kvlcc2-marin/MARIN_FREE_KVLCC2_{n}_m.dat") for n in ("zz_20", "zz_-20", "zz_10")}
    trials = {n: shipid.read_trial(f, format=trial_format) for n, f in files.items()}
    for model, fitted, predicted in (("nomoto", 1.76, 3.5), ("norrbin", 1.28, 1.05)):
        fit = shipid.identify(model, [trials["zz_20"], trials["zz_-20"]], ship="kvlcc2", starts=3)
        *sailed, other = fit.validate(list(trials.values())).validation
        together = np.sqrt(np.mean([c.refitted["psi"] ** 2 for c in sailed]))
        assert np.rad2deg(together) <= fitted
        assert np.rad2deg(other.refitted["psi"]) <= predicted
        # By default the start is given: it may cost a part of that error, and no more.
        given = np.sqrt(np.mean([c.rmse["psi"] ** 2 for c in fit.fitted]))
        assert given <= 1.4 * together
