"""A clock wrong by a factor is one fault: rates and speeds that are both off by it are not scaled."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.repair import NoSafeRepairError, fix_trial
from shipid.trials.measuring.measure import measure


def logged(simulated, path, noise="standard", **factors):
    """Write a simulated zig-zag with columns multiplied by factors."""
    table = simulated(noise=noise).table.copy()
    for name, factor in factors.items():
        table[name] = table[name] * factor
    shipid.write_trial(shipid.Trial("log", table), path)
    return path


@pytest.mark.parametrize("factor", [2.0, 0.5, 4.0, 1.2])
def test_one_factor_of_all_rates_is_the_clock(simulated, tmp_path, factor):
    path = logged(simulated, tmp_path / "log.csv", t=factor)
    diagnosis = check_trial(path)
    found = next(f for f in diagnosis.findings if f.kind == "clock-scale")
    assert found.serious and not found.repaired and found.fix["factor"] == pytest.approx(1 / factor, rel=0.02)
    assert not any(f.repaired for f in diagnosis.findings)
    assert not {"unit", "rate-scale", "speed-scale", "latency"} & set(diagnosis.kinds)
    with pytest.raises(NoSafeRepairError, match="clock-scale"):
        fix_trial(path, tmp_path / "fixed.csv")


def test_measured_times_are_doubtful(simulated, tmp_path):
    path = logged(simulated, tmp_path / "log.csv", t=2.0)
    assert any("clock-scale" in note for note in measure(shipid.read_trial(path)).notes)


@pytest.mark.parametrize(
    ("factors", "kinds"),
    [({"r": 2.0}, {"rate-scale"}), ({"r": 2.0, "u": 1.5}, {"rate-scale", "speed-scale"}), ({"u": 1.1}, {"speed-scale"})],
)  # fmt: skip
def test_factors_that_differ_are_faults_of_their_own(simulated, tmp_path, factors, kinds):
    diagnosis = check_trial(logged(simulated, tmp_path / "log.csv", **factors))
    assert "clock-scale" not in diagnosis.kinds and kinds <= set(diagnosis.kinds)


def test_noise_of_a_fast_log_is_no_fast_ship(simulated):
    trial = simulated()
    t = np.arange(0.0, trial["t"][-1], 0.1)
    random = np.random.default_rng(2)
    frame = {f"{c} [m]": np.interp(t, trial["t"], trial[c]) + random.normal(0, 6, t.size) for c in ("x", "y")}
    frame |= {f"{c} [deg]": np.degrees(np.interp(t, trial["t"], trial[c])) for c in ("psi", "delta")}
    assert "clock-scale" not in check_trial(shipid.Trial.from_frame({"t [s]": t, **frame})).kinds
