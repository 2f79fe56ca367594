"""A clock that was set while the log ran is told from a gap, and from two logs in one file."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.repair import fix_trial
from shipid.trials.measuring.measure import measure


def logged(simulated, path, jump, *, lost=0):
    """A simulated zig-zag whose clock jumps in its middle; `lost` rows are missing there."""
    table = simulated().table.copy()
    middle = len(table) // 2
    t = table["t"].to_numpy().copy()
    t[middle:] += jump
    table["t"] = t
    table = table.drop(index=range(middle, middle + lost))
    table.rename(columns={"t": "t [s]"})[["t [s]"]].to_csv(path, index=False)
    names = {c: f"{c} [{'rad' if c in ('psi', 'delta') else 'rad/s' if c == 'r' else 'm/s' if c == 'u' else 'm'}]" for c in ("psi", "delta", "r", "u", "x", "y")}  # fmt: skip
    table[["t", *names]].rename(columns={"t": "t [s]", **names}).to_csv(path, index=False)
    return path


@pytest.mark.parametrize("jump", [-3.0, 20.0, 3600.0])
def test_a_clock_that_was_set_is_told_and_put_right(simulated, tmp_path, jump):
    path = logged(simulated, tmp_path / "log.csv", jump)
    found = check_trial(path)
    [one] = [f for f in found.findings if f.kind == "clock-set"]
    assert one.serious and one.repaired and f"{jump:+.4g} s" in one.message
    assert not {"gap", "clock-unsorted", "clock-repeats", "heading-glitch"} & set(found.kinds)
    fixed = shipid.read_trial(fix_trial(path, tmp_path / "fixed.csv")[0])
    np.testing.assert_allclose(fixed["t"], simulated()["t"], atol=1e-6)


def test_a_gap_is_no_clock_that_was_set(simulated, tmp_path):
    found = check_trial(logged(simulated, tmp_path / "log.csv", 0.0, lost=20))
    assert "gap" in found.kinds and "clock-set" not in found.kinds


def test_measured_times_behind_the_jump_are_doubtful(simulated, tmp_path):
    notes = measure(shipid.read_trial(logged(simulated, tmp_path / "log.csv", 10.0))).notes
    assert any("clock-set" in note for note in notes)


@pytest.mark.parametrize(("again", "word"), [(True, "Two logs stand in one file"), (False, "The clock was set back")])
def test_what_to_do_about_a_clock_that_runs_backwards_once(simulated, tmp_path, again, word):
    table = simulated().table[["t", "psi"]].copy()
    t = table["t"].to_numpy().copy()
    t[len(t) // 2 :] -= t[len(t) // 2] - t[0] if again else 5.0
    path = tmp_path / "log.csv"
    table.assign(t=t).rename(columns={"t": "t [s]", "psi": "psi [rad]"}).to_csv(path, index=False)
    with pytest.raises(shipid.trials.errors.ClockError, match=word):
        shipid.read_trial(path)
