"""Held samples of a slower sensor are found whatever its beat; digits far finer than the record are no finding."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.foundation.numbers import percent
from shipid.trials.doctor.check_trial import check_trial


def with_column(trial, path, name, values):
    """Write a trial with another heading or rate of turn, in SI units, and examine it."""
    columns = {n: np.asarray(trial[n]) for n in ("t", "psi", "r", "delta")} | {name: values}
    units = {"t": "s", "psi": "rad", "r": "rad/s", "delta": "rad"}
    head = ",".join(f"{n} [{units[n]}]" for n in columns)
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", fmt="%.10g", header=head, comments="")
    return check_trial(path)


@pytest.mark.parametrize("beat", [2, 5, 8])
def test_a_slower_sensor_whose_samples_are_held(simulated, tmp_path, beat):
    trial = simulated("zigzag:20/20", "none")
    noise = np.random.default_rng(4).normal(0.0, 0.1 * float(np.ptp(trial["r"])), len(trial))
    held = (trial["r"] + noise)[beat * (np.arange(len(trial)) // beat)]
    found = next(f for f in with_column(trial, tmp_path / "log.csv", "r", held).findings if f.kind == "resampled")
    assert found.channel == "r" and found.confidence >= 0.5
    # One sample in `beat` was measured.
    assert f"{percent(1 - 1 / beat)} of the samples" in found.message


def test_digits_far_finer_than_the_record_are_no_finding(simulated, tmp_path):
    """The heading of a turn stands still at every other sample, but a step is less than a thousandth of its range."""
    trial = simulated("turn:35", "none")
    step = 2 * float(np.median(np.abs(np.diff(trial["psi"]))))
    assert step < 0.002 * float(np.ptp(trial["psi"]))
    diagnosis = with_column(trial, tmp_path / "log.csv", "psi", step * np.round(trial["psi"] / step))
    assert not [f for f in diagnosis.findings if f.kind == "quantised" and "psi" in f.channel]


@pytest.mark.parametrize("digit", [0.1, 0.05])
def test_a_compass_that_prints_tenths_is_not_resampled(simulated, tmp_path, digit):
    """Steps of a few digits are often equal: three samples on a line are no sign of interpolation."""
    trial = simulated("zigzag:20/20", "none")
    step = np.deg2rad(digit)
    printed = step * np.round(trial["psi"] / step)
    assert np.mean(np.abs(np.diff(printed, 2)) < 1e-9) > 0.25
    diagnosis = with_column(trial, tmp_path / "log.csv", "psi", printed)
    assert not [f for f in diagnosis.findings if f.kind == "resampled"]


def test_interpolation_leaves_the_digits_of_a_slower_sensor(simulated, tmp_path):
    trial = simulated("zigzag:20/20", "none")
    step, t = np.deg2rad(0.1), trial["t"]
    slow = step * np.round(trial["psi"][::4] / step)
    diagnosis = with_column(trial, tmp_path / "log.csv", "psi", np.interp(t, t[::4], slow))
    assert [f.channel for f in diagnosis.findings if f.kind == "resampled" and f.confidence > 0.5] == ["psi"]
