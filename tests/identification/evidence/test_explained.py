"""A record that shows nothing gives no coefficient; one with much noise on it does."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import UsageError
from shipid.identification.evidence.explained import least_unexplained, nothing_explained, unread_wind_notices

UNIT = 45 / 4.95


@pytest.fixture(scope="module")
def fit(sail):
    return shipid.identify("nomoto", [sail("nomoto", "zeefakkel", seed=1)], ship="zeefakkel", starts=1)


def wandering(rng, count, slow):
    """Noise of first order without a relation to anything."""
    drive = rng.standard_normal(count)
    for k in range(1, count):
        drive[k] += slow * drive[k - 1]
    return drive / drive.std()


@pytest.mark.parametrize("signal", ["r", "psi"])
def test_a_rudder_without_a_relation_to_the_turns_determines_nothing(signal):
    rng, t = np.random.default_rng(5), np.arange(800.0)
    rate = np.deg2rad(0.3) * wandering(rng, t.size, 0.9)
    frame = pd.DataFrame({"t": t, "delta": np.deg2rad(4.0) * wandering(rng, t.size, 0.8), "r": rate, "u": 5.0})
    if signal == "psi":
        frame["psi"] = np.cumsum(frame.pop("r"))
    trial = shipid.Trial.from_frame(frame, name="wandering", units={n: FIELDS[n].unit for n in frame})
    fit = shipid.identify("nomoto", [trial], ship="zeefakkel", starts=1)
    assert [(w.kind, w.serious) for w in fit.warnings] == [("not-determined", True)]
    assert fit.unidentifiable == fit.estimated == ("K", "tau")
    for e in fit.parameters.values():
        assert e.value is e.std is e.ci95 is e.prime is None
        assert e.why == "the model explains nothing of how the ship moved in these trials."
    assert "runs to infinity" not in fit.text() and fit.text().count("no value   not determined: the model") == 2
    assert (
        "warning   Not determined: the model explains nothing of how the ship turned in these trials (the error"
        in fit.text()
    )
    assert json.dumps(fit.to_dict(), allow_nan=False)
    # What was known of the ship beforehand stays, and nothing is added to it.
    before = shipid.find_ship("zeefakkel").sections["nomoto"]
    assert {n: fit.ship.sections["nomoto"][n] for n in ("K", "tau")} == {n: before[n] for n in ("K", "tau")}
    with pytest.raises(UsageError, match="'K' has no value in this fit: the model explains nothing"):
        fit.profile("K")


def test_noise_of_a_sensor_that_hides_the_turns_from_sample_to_sample_hides_nothing(fit, sail):
    """Noise on the rate three times as large as the rate: its mean over L/U shows the turns, and so do heading and coefficients."""
    frame = sail("nomoto", "zeefakkel", seed=2).table[["t", "psi", "r", "u", "delta"]].copy()
    frame["r"] += 3 * frame["r"].std() * np.random.default_rng(1).standard_normal(len(frame))
    noisy = shipid.Trial.from_frame(frame, name="noisy", units={n: FIELDS[n].unit for n in frame})
    compared = fit.validate([noisy]).validation
    raw = compared[0].rmse["r"] / np.std(noisy["r"])
    assert raw > 0.9
    assert least_unexplained(compared, UNIT) < 0.8
    assert [w.kind for w in fit.warnings] == []
    assert least_unexplained(fit.fitted, UNIT) < 0.1


def test_the_motion_that_is_explained_best_decides(fit):
    (c,) = fit.fitted
    rate = c.trial["r"]
    half = {"r": np.where(np.isfinite(rate), 0.5 * rate, 0.0)}
    # One half of the rate of turn is left, sample by sample; its mean is not zero and adds a little.
    only_rate = replace(c, rmse={"r": 1.0}, predicted=half)
    assert least_unexplained([only_rate], UNIT) == pytest.approx(0.5, abs=0.02)
    assert least_unexplained([only_rate, c], UNIT) == least_unexplained([c], UNIT)
    # A ship that only gains way has turned by nothing but noise.
    faster = replace(c, rmse={"r": 1.0, "u": 1.0}, predicted={"r": np.zeros_like(rate), "u": c.trial["u"]})
    assert least_unexplained([faster], UNIT) == 0.0
    away = replace(c, rmse={"psi": 1.0}, predicted={"psi": np.full_like(rate, np.inf)})
    assert least_unexplained([away], UNIT) == np.inf
    assert least_unexplained([replace(c, rmse={})], UNIT) is None


def test_nothing_is_said_where_nothing_is_known():
    assert not nothing_explained(None)
    assert nothing_explained(0.8) and not nothing_explained(0.79)


def test_a_speed_that_something_unlogged_changes_is_told_and_one_that_the_turns_change_is_not():
    """A wind of 6 m/s that no log holds gave K_u as 0.95 ± 0.12, where 0.35 is right, without a word."""
    noise = "psi=0.1 deg,r=0.02 deg/s,u=0.03 m/s,v=0.03 m/s"
    for wind, told in (("6 m/s from 60 deg", ["motion-unexplained", "effect-missing"]), (None, [])):
        logged = shipid.simulate("de-keizer", "soesterberg", "zigzag:20/20", wind=wind, noise=noise, sampling=2.0)
        trial = replace(logged, table=logged.table.drop(columns=["wind_speed", "wind_direction"], errors="ignore"))
        fit = shipid.identify("de-keizer", [trial], ship="soesterberg", starts=1)
        assert [w.kind for w in fit.warnings] == told
        for notice in fit.warnings[:1]:
            assert notice.serious and str(notice).startswith("The model explains nothing of the forward speed (its")
            assert str(notice) in fit.text()
        # Where the log holds the wind, the model that reads it is named.
        known = tuple(replace(c, trial=logged) for c in fit.fitted)
        said = [w for w in replace(fit, fitted=known).warnings if w.kind == "wind-unread"]
        assert len(said) == bool(told) and all("Take de-keizer-wind, or" in str(w) for w in said)
        assert not unread_wind_notices(shipid.find_model("de-keizer-wind"), known, 9.5)
        assert not unread_wind_notices(fit.model, known, 20.0)
