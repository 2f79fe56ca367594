"""Every kind is found where it is planted, and nothing where it is not."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import shipid
from shipid.trials.doctor.check_trial import check_trial

SIMPLE = [
    "clock-quantised", "clock-repeats", "clock-unsorted", "gap", "resampled", "missing samples", "trailing-empty", "outlier",
    "frozen", "unit of the heading", "unit of the rate", "unit of the speed", "unit of the rudder", "unit of the clock",
    "speed-scale", "rate-scale", "mislabelled", "rudder-sign", "rate-sign", "earth-fixed-velocity", "heading-wrap",
    "heading-interpolated", "heading-glitch", "order-not-feedback", "accelerating", "bias of the rudder",
    "bias of the rate", "position-jump", "short", "no-rudder-movement", "coarse-sampling", "quantised",
    "latency of the rate", "latency of the rudder", "text", "sentinel", "hole", "track-direction", "speed-stands",
    "early rudder", "closed-loop", "frozen rudder", "clock-set", "clock-jitter", "written-on-change", "unit of the positions",
    "order-early",
]  # fmt: skip


def examine(log, path):
    log.frame().to_csv(path, index=False, float_format="%.10g")
    return check_trial(path, ship=log.ship)


def sure(diagnosis):
    return {f.kind for f in diagnosis.findings if f.confidence >= 0.5}


@pytest.mark.parametrize("what", SIMPLE)
def test_planted_fault_is_found(faults, simulated, tmp_path, what):
    plant, sizes, kind, _ = faults.FAULTS[what]
    log = faults.Log(simulated(noise="none"), "soesterberg", 1)
    plant(log, sizes[2])
    diagnosis = examine(log, tmp_path / "log.csv")
    assert kind in sure(diagnosis)
    found = next(f for f in diagnosis.findings if f.kind == kind)
    assert found.effect and found.repair and found.message
    assert 0 <= found.rows[0] <= found.rows[1]


def test_asymmetric_ship_is_found(faults, tmp_path):
    trial = faults.lopsided("zeefakkel", 0.3, "none", 0)
    assert "asymmetric" in sure(examine(faults.Log(trial, "zeefakkel", 0), tmp_path / "log.csv"))


def test_current_is_found(faults, simulated, tmp_path):
    log = faults.Log(simulated("turn:35", "none"), "soesterberg", 1)
    faults.FAULTS["track-inconsistent"][0](log, 0.2)
    assert "track-inconsistent" in sure(examine(log, tmp_path / "log.csv"))


@pytest.mark.parametrize("noise", ["none", "standard"])
@pytest.mark.parametrize("manoeuvre", ["zigzag:20/20", "zigzag:-10/10", "turn:35", "course:60", "spiral:25"])
def test_clean_trial_has_no_finding(simulated, manoeuvre, noise):
    diagnosis = check_trial(simulated(manoeuvre, noise))
    assert sure(diagnosis) == set()
    assert diagnosis.serious == ()


@given(
    angle=st.sampled_from(["deg", "rad"]),
    rate=st.sampled_from(["deg/s", "rad/s", "deg/min"]),
    speed=st.sampled_from(["m/s", "kn", "km/h"]),
    helm=st.sampled_from(["deg", "rad"]),
    first=st.sampled_from(["zigzag:20/20", "zigzag:-10/10", "turn:-25"]),
    noise=st.sampled_from(["none", "standard"]),
)
@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_clean_trial_stays_clean_in_any_unit(simulated, tmp_path, angle, rate, speed, helm, first, noise):
    trial = simulated(first, noise)
    path = tmp_path / "log.csv"
    units = {"psi": angle, "r": rate, "u": speed, "delta": helm, "delta_order": helm}
    shipid.write_trial(trial, path, units, overwrite=True)
    assert sure(check_trial(path)) == set()


def test_the_confidence_of_a_fault_far_larger_is_no_smaller(faults, simulated, tmp_path):
    seen = []
    for size in (1.05, 1.5):
        log = faults.Log(simulated(noise="none"), "soesterberg", 1)
        faults.FAULTS["rate-scale"][0](log, size)
        diagnosis = examine(log, tmp_path / "log.csv")
        seen.append(next(f.confidence for f in diagnosis.findings if f.kind == "rate-scale"))
    assert seen[0] <= seen[1]
