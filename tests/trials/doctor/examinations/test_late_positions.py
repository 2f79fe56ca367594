"""Positions on another clock than speeds and heading are named, and warned of at the distances of a turn."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.measuring.measure import measure


@pytest.mark.parametrize("late", [3.0, -3.0, 0.0])
def test_positions_that_are_late_are_named(simulated, late):
    table, rng = simulated("turn:15", "none").table.copy(), np.random.default_rng(1)
    t = table["t"].to_numpy()
    for name in ("x", "y"):
        table[name] = np.interp(t - late, t, table[name]) + rng.normal(0, 0.5, t.size)
    trial = shipid.Trial("log", table)
    found = [f for f in check_trial(trial).findings if f.kind == "latency" and "x" in f.channels]
    assert bool(found) == (late != 0)
    if late:
        assert found[0].serious and f"are {abs(late):.2g} s {'late' if late > 0 else 'early'}" in found[0].message
        assert any(note.serious and "the positions are" in note for note in measure(trial).notes)
