"""The trials' doctor asked about a fit: what it found is in the result; nothing is repaired."""

from __future__ import annotations

import json

import pytest

import shipid
from shipid.identification.validation.trial_findings import TrialFinding, lines_of
from shipid.trials.doctor.findings import Finding

UNITS = {"t": "s", "delta": "rad", "psi": "rad", "r": "rad/s", "u": "m/s"}


@pytest.fixture(scope="module")
def mirrored(sail):
    """A zig-zag whose rudder counts positive to port."""
    trial = sail("norrbin", "zeefakkel", sampling="0.5 s")
    table = trial.table[list(UNITS)].copy()
    table["delta"] *= -1
    return shipid.Trial.from_frame(table, name="mirrored", units=UNITS)


def test_a_finding_is_in_the_result_and_nothing_is_repaired(mirrored):
    before = mirrored["delta"].copy()
    fit = shipid.assess(shipid.identify("norrbin", [mirrored], ship="zeefakkel", starts=1), bands=False)
    first = fit.assessment.findings[0]
    assert (first.trial, first.role, first.finding.kind) == ("mirrored", "fitted", "rudder-sign")
    assert (fit.fitted[0].trial["delta"] == before).all()
    found = json.loads(json.dumps(fit.to_dict(), allow_nan=False))["warnings"]
    # A gain that is held positive explains nothing of such a record.
    assert [w["kind"] for w in found] == ["not-determined", "rudder-sign"]
    assert found[1]["trial"] == "mirrored" and found[1]["repair"]
    line = next(x for x in fit.text().splitlines() if "rudder-sign" in x)
    assert line.startswith("  check     mirrored: rudder-sign (delta")
    # What spoils the fit stands before the coefficients, with what it does to them.
    lines = fit.text().splitlines()
    assert lines.index(line) == 1 and "The gain comes out negative" in line and found[1]["serious"]


def test_a_trial_kept_apart_is_looked_at_too(sail, mirrored):
    fit = shipid.identify("norrbin", [sail("norrbin", "zeefakkel")], ship="zeefakkel", starts=1, validate=[mirrored])
    findings = shipid.assess(fit, bands=False).assessment.findings
    assert [(f.role, f.finding.kind) for f in findings] == [("validation", "rudder-sign")]


def test_a_clean_trial_is_not_spoken_of(sail):
    fit = shipid.identify("norrbin", [sail("norrbin", "zeefakkel")], ship="zeefakkel", starts=1)
    fit = shipid.assess(fit, bands=False)
    assert fit.assessment.findings == () and "check" not in fit.text()
    assert fit.to_dict()["warnings"] == []


def test_it_can_be_left_out(mirrored):
    fit = shipid.identify("norrbin", [mirrored], ship="zeefakkel", starts=1)
    for unasked in (fit, shipid.assess(fit, bands=False, findings=False)):
        assert not unasked.to_dict()["checked"] and "\n  check " not in unasked.text()


def test_a_kind_found_many_times_takes_one_line():
    def finding(trial, kind, channel):
        return TrialFinding(
            trial, "fitted", Finding(kind, channel, (0, 9), (0.0, 9.0), 3, 0.9, "", "", "3 samples", spoils=False)
        )

    many = [finding(trial, "missing", channel) for trial in ("a", "b") for channel in ("r", "psi")]
    lines = lines_of([many[0], finding("a", "hole", "u"), *many[1:]])
    assert lines == [
        "a: missing (r, 90 %, 0 to 9 s): 3 samples; and 3 more of this kind in 2 trials (psi, r)",
        "a: hole (u, 90 %, 0 to 9 s): 3 samples",
    ]
    assert lines_of(many[:2]) == [str(f) for f in many[:2]]
