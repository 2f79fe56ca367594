"""Findings as plain values, and what of a diagnosis concerns a stretch."""

from __future__ import annotations

import numpy as np
import pandas as pd

import shipid
from shipid.trials.doctor.findings import Diagnosis, Finding, Stretch
from shipid.trials.trial import Trial


def test_the_confidence_is_given_in_tenths_of_a_percent():
    finding = Finding("gap", "t", (3, 4), (1.5, 2.0), 2, 0.12345, "effect", "repair", "message")
    assert finding.to_dict()["confidence"] == 0.123


def test_what_concerns_a_stretch_of_a_record():
    def found(kind, start, end):
        return Finding(kind, "psi", (0, 1), (start, end), 2, 0.95, "effect", "repair", "message")

    whole = Diagnosis(
        "log",
        (found("gap", 10.0, 20.0), found("heading-glitch", 40.0, 40.0), found("offset", 0.0, 100.0)),
        (Stretch("zigzag", 5.0, 60.0), Stretch("steady", 60.0, 80.0), Stretch("turn", 80.0, 100.0)),
    )
    part = whole.within(30.0, 90.0)
    assert part.kinds == ("heading-glitch", "offset") and part.trial == "log"
    assert [(m.kind, m.start, m.end) for m in part.manoeuvres] == [
        ("zigzag", 30.0, 60.0), ("steady", 60.0, 80.0), ("turn", 80.0, 90.0),
    ]  # fmt: skip
    assert whole.within(0.0, 100.0) == whole


def test_a_finding_at_one_sample_says_one_place():
    one = Finding("outlier", "x", (700, 700), (140.0, 140.0), 1, 0.99, "effect", "repair", "message")
    assert (one.in_rows, one.when) == ("row 700", "140 s") and "[row 700, 140 s]" in str(one)
    several = Finding("hole", "psi", (3, 9), (1.2, 3.6), 7, 0.99, "effect", "repair", "message")
    assert "[rows 3-9, 1.2 to 3.6 s]" in str(several)


def test_an_outlier_beside_no_noise_is_no_millions_of_times_as_large():
    t, speed = np.arange(200.0), np.full(200, 4.0)
    speed[[60, 120]] = 51.0
    psi = 0.3 * np.sin(t / 15)
    table = pd.DataFrame(
        {"t": t, "psi": psi, "r": np.gradient(psi), "delta": 0.2 * np.sign(np.cos(t / 15)), "u": speed}
    )
    (found,) = (f for f in shipid.check_trial(Trial("log", table)).findings if f.kind == "outlier")
    assert "2 samples of u" in str(found) and "by more than 1000 times the noise" in str(found)
