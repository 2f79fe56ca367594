"""A gap of the clock over an execute is a gap, and no lag, no bias and no asymmetry of the ship."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.check_trial import check_trial


def second_executes(trial):
    order = trial["delta_order"] if trial.has("delta_order") else trial["delta"]
    return trial["t"][np.flatnonzero(np.abs(np.diff(np.sign(order))) > 1) + 1]


@pytest.mark.parametrize("swing", [0, 1, 2])
@pytest.mark.parametrize(("before", "after"), [(0.15, 0.15), (0.05, 0.4)])
def test_a_gap_over_an_execute_is_only_a_gap(simulated, swing, before, after):
    trial = simulated()
    t, executes = trial["t"], second_executes(trial)
    half = float(np.median(np.diff(executes)))
    when = executes[swing]
    kept = (t < when - before * half) | (t > when + after * half)
    diagnosis = check_trial(shipid.Trial("log", trial.table[kept].reset_index(drop=True)))
    assert set(diagnosis.kinds) == {"gap"}


def test_a_block_with_a_gap_in_it_is_not_whole():
    t = np.concatenate((np.arange(50.0), np.arange(80.0, 130.0)))
    assert robust.whole(t, np.array([0, 20, 40, 60, 99])).tolist() == [True, True, False, True]
    # Logged in bursts, pauses are the usual thing.
    bursts = (np.arange(30)[:, None] * 10 + np.arange(3) * 0.1).ravel()
    assert robust.whole(bursts, np.arange(0, 90, 9)).all()
