"""The report of a filtered record: one file, no NaN, everything that went wrong said in words."""

from __future__ import annotations

from pathlib import Path

import casadi
import numpy as np
import pytest

import shipid
from shipid.estimation.records.observability import observability
from shipid.report.write_report import render

TRIAL = Path(__file__).resolve().parents[2] / "studies" / "trials" / "container-20-20.csv"


@pytest.fixture(scope="module")
def run():
    trial = shipid.read_trial(TRIAL)
    record = {n: trial[n].copy() for n in ("t", "psi", "r", "delta", "u")}
    record["psi"][300:305] += 1.0
    record["r"][400:420] = np.nan
    kalman = shipid.ExtendedKalmanFilter(
        shipid.find_model("nomoto"),
        "soesterberg",
        measured={"psi": "0.2 deg", "r": "0.02 deg/s"},
        estimated=["K", "tau"],
    )
    return kalman.filter(record)


def test_the_page_stands_alone_and_holds_no_nan(run):
    page = render(run)
    assert "<svg" in page and "http" not in page.replace("http-equiv", "")
    words = page.lower()
    assert ">nan<" not in words and " nan " not in words and "inf " not in words
    assert page == render(run)


def test_a_page_works_nothing_out(run, monkeypatch):
    seen = observability(run)
    page = render(seen)

    def called(*_, **__):
        raise AssertionError("a page evaluates a model")

    monkeypatch.setattr(casadi.Function, "__call__", called)
    monkeypatch.setattr(casadi.Function, "buffer", called)
    assert render(seen) == page
    assert "`" not in page and "<mfrac>" in page


def test_what_went_wrong_is_said(run):
    page = render(observability(run))
    assert "5 of 738 samples of psi were outside the gate" in page
    assert "x is not observable" in page and "was not worked out" not in page
    # What nobody asked for is not worked out for the page, and the page says so.
    assert "Whether the sensors show every state was not worked out" in render(run)
    assert "The innovations of r are not white" in page
    assert run.innovations["psi"].rejected == 5
    assert run.innovations["r"].t.size == 718


def test_parameters_and_levels_are_shown(run):
    page = render(run)
    for word in ("rate of turn per rudder angle", "default of the toolbox", "deg/s/√s", "95 % interval", "Nomoto.yaw"):
        assert word in page
