"""A finding as plain values."""

from __future__ import annotations

from shipid.trials.doctor.findings import Finding


def test_the_confidence_is_given_in_tenths_of_a_percent():
    finding = Finding("gap", "t", (3, 4), (1.5, 2.0), 2, 0.12345, "effect", "repair", "message")
    assert finding.to_dict()["confidence"] == 0.123
