"""--fix: the numbers are back within the noise, and nothing is found any more."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import OverwriteError
from shipid.trials import errors as e
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.repair import NoSafeRepairError, fix_trial

#: What is planted, at which size, and how far the columns may be from the truth: in shares of their range.
REPAIRED = [
    ("clock-repeats", 0.01, 1e-6), ("clock-unsorted", 0.01, 1e-6), ("trailing-empty", 0.02, 1e-6), ("outlier", 2.0, 1e-2), ("unit of the heading", 3, 1e-6), ("unit of the rate", 2, 1e-6),
    ("unit of the speed", 2, 1e-2), ("unit of the rudder", 3, 1e-6), ("unit of the clock", 2, 1e-6),
    ("speed-scale", 1.1, 1e-2), ("rate-scale", 1.15, 1e-2), ("mislabelled", 3, 1e-6), ("rudder-sign", 1, 1e-6),
    ("rate-sign", 1, 1e-6), ("heading-wrap", 2, 1e-6), ("heading-glitch", 10.0, 1e-2), ("bias of the rate", 0.1, 1e-2),
]  # fmt: skip


@pytest.mark.parametrize(("what", "size", "within"), REPAIRED)
def test_repair_gives_the_numbers_back(faults, simulated, tmp_path, what, size, within):
    truth = simulated(noise="none")
    plant, _, kind, _ = faults.FAULTS[what]
    log = faults.Log(truth, "soesterberg", 1)
    plant(log, size)
    broken, fixed = tmp_path / "broken.csv", tmp_path / "fixed.csv"
    log.frame().to_csv(broken, index=False, float_format="%.12g")
    path, repaired = fix_trial(broken, fixed)
    assert path == fixed and kind in {f.kind for f in repaired}
    trial = shipid.read_trial(fixed)
    assert f"repaired: {kind}" in trial.source.comment
    left = {f.kind for f in check_trial(fixed).findings if f.confidence >= 0.5}
    assert kind not in left
    n = min(len(trial), len(truth))
    for column in ("t", "psi", "r", "u", "delta"):
        span = np.ptp(truth[column]) or 1.0
        shift = 2 * np.pi * np.round((trial[column][0] - truth[column][0]) / (2 * np.pi)) if column == "psi" else 0.0
        # heading-wrap is planted about another north
        off = trial[column][:n] - truth[column][:n] - shift
        off = off - off[0] if kind == "heading-wrap" else off
        assert np.nanmax(np.abs(off)) <= within * span, column


def test_quantised_clock_is_rebuilt(faults, simulated, tmp_path):
    log = faults.Log(simulated(noise="none"), "soesterberg", 1)
    interval = 1.0373 * log.dt
    faults.FAULTS["clock-quantised"][0](log, 1.5)
    broken, fixed = tmp_path / "broken.csv", tmp_path / "fixed.csv"
    log.frame().to_csv(broken, index=False)
    with pytest.raises(e.ClockError):
        shipid.read_trial(broken)
    fix_trial(broken, fixed)
    t = shipid.read_trial(fixed)["t"]
    assert np.diff(t) == pytest.approx(interval, rel=2e-4)


def test_earth_fixed_velocities_are_rotated(faults, simulated, tmp_path):
    log = faults.Log(simulated(noise="none"), "soesterberg", 1)
    u, v = log["u"].copy(), log["v"].copy()
    faults.FAULTS["earth-fixed-velocity"][0](log, 1)
    broken, fixed = tmp_path / "broken.csv", tmp_path / "fixed.csv"
    log.frame().to_csv(broken, index=False, float_format="%.12g")
    fix_trial(broken, fixed)
    trial = shipid.read_trial(fixed)
    np.testing.assert_allclose(trial["u"], u, atol=1e-3 * np.max(u))
    np.testing.assert_allclose(trial["v"], v, atol=1e-3 * np.max(u))


def test_what_has_no_safe_repair_is_not_written(faults, simulated, tmp_path):
    log = faults.Log(simulated(noise="none"), "soesterberg", 1)
    faults.FAULTS["gap"][0](log, 0.15)
    log.frame().to_csv(tmp_path / "broken.csv", index=False)
    with pytest.raises(NoSafeRepairError, match="gap"):
        fix_trial(tmp_path / "broken.csv", tmp_path / "fixed.csv")
    assert not (tmp_path / "fixed.csv").exists()


def test_nothing_is_overwritten(simulated, tmp_path):
    there = tmp_path / "there.csv"
    there.write_text("mine")
    with pytest.raises(OverwriteError, match="never overwrites"):
        fix_trial(simulated(), there)
    assert there.read_text() == "mine"


def test_a_trial_in_memory_is_repaired_too(simulated, tmp_path):
    trial = simulated(noise="none")
    table = trial.table.copy()
    table["r"] = -table["r"]
    turned = shipid.Trial("turned", table)
    fix_trial(turned, tmp_path / "fixed.csv")
    np.testing.assert_allclose(shipid.read_trial(tmp_path / "fixed.csv")["r"], trial["r"], atol=1e-9)


def test_times_that_a_file_holds_as_one_are_one(tmp_path):
    """1e-300 s and 0 s are written alike: the log that was repaired had a clock that repeats, and was refused."""
    source = tmp_path / "log.csv"
    body = "".join(f"{t},{k % 7},{10 if k % 40 < 20 else -10}\n" for k, t in enumerate(["0", "1e-300", *range(1, 120)]))
    source.write_text("t [s],psi [deg],delta [deg]\n" + body, encoding="utf-8")
    fix_trial(source, tmp_path / "fixed.csv")
    t = shipid.read_trial(tmp_path / "fixed.csv")["t"]
    assert t.size == 121 and (np.diff(t) > 0).all() and t[-1] == 119.0
