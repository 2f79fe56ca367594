from __future__ import annotations

import dataclasses
import os
import re
from datetime import date
from pathlib import Path

import casadi
import numpy as np
import pytest

import shipid
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import MissingFileError, OverwriteError, UsageError
from shipid.foundation.numbers import number
from shipid.identification.uncertainty.posterior import Posterior
from shipid.report import write_report as report
from shipid.report.figures import svg
from shipid.report.write_report import render, write_report

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT.parent / "shared" / "data" / "kvlcc2-marin"
SECTIONS = ("coefficients", "equations", "trials", "criteria", "correlation", "noise", "provenance")


DAY = date(2026, 5, 4)


class OnThatDay(date):
    """A calendar that shows it."""

    @classmethod
    def today(cls):
        return DAY


@pytest.fixture(scope="module")
def text(fit, criteria):
    return render(fit, criteria=criteria)


@pytest.fixture(scope="module")
def plain(fit):
    """The page without the criteria."""
    return render(fit, made=DAY)


@pytest.fixture(scope="module")
def without_criteria(fit):
    """The page that says why there are no criteria."""
    return render(fit, criteria="the ship runs away.")


@pytest.fixture(scope="module")
def runaway(diverged):
    """The page of the fit that did not converge, and why there are no criteria."""
    return render(diverged, criteria="the ship runs away.")


def test_the_page_is_whole_and_well_formed(text, read_page):
    page = read_page(text)
    assert page.open == []
    assert text.startswith("<!DOCTYPE html>")
    ids = [v for n, v in page.attributes if n == "id"]
    assert len(ids) == len(set(ids)), "ids of the figures collide"
    targets = {v[1:] for n, v in page.attributes if n == "href"} | set(re.findall(r"url\(#([^)]+)\)", text))
    assert targets <= set(ids)


def test_it_needs_nothing_from_outside(text):
    assert re.findall(r"https?:|//[a-z]|@import|<link|<script|<img|xlink", text) == []
    assert set(re.findall(r"url\((.)", text)) <= {"#"}


@pytest.mark.parametrize(("which", "rendered"), [("fit", "without_criteria"), ("diverged", "runaway")])
def test_every_section_and_trial_is_there(which, rendered, request, read_page):
    fit = request.getfixturevalue(which)
    page = read_page(request.getfixturevalue(rendered))
    ids = [v for n, v in page.attributes if n == "id"]
    for section in SECTIONS:
        assert section in ids
    for c in (*fit.fitted, *fit.validation):
        assert page.text.count(c.trial.name) >= 3
    # Heading and track of each trial first; histories, residuals and their correlation in its details. Residuals that run away
    # have no correlation.
    assert page.tags.count("svg") == (10 if which == "fit" else 9)
    for name in fit.parameters:
        assert name in page.text
    for fixed in fit.fixed:
        assert fixed in page.text
    assert ("The search did not converge: the search gave up." in page.text) is (which == "diverged")


def test_the_answer_comes_first_in_words(fit, text, read_page):
    lead = read_page(text).text
    rms = np.rad2deg(fit.validation[0].rmse["psi"])
    assert f"{number(rms, 2)} deg rms (second)" in lead[: lead.index("Coefficients")]
    assert "The search converged" in lead
    assert 'class="box warning"' not in text


def test_simulated_trials_are_labelled(text):
    assert text.count("simulated, not measured</span>") == 6
    assert "one simulated trial" in text


def test_a_diverged_prediction_is_said_in_words(runaway, read_page):
    page = read_page(runaway)
    assert "did not converge" in page.text
    assert "the search gave up." in page.text
    assert "The prediction of second runs away at t = " in page.text
    assert "runs to infinity" in page.text
    assert "ran away" in page.text


def test_neither_nan_nor_infinity_reaches_the_page(plain, runaway):
    for rendered in (plain, runaway):
        page = re.sub(r"<style>.*?</style>", "", rendered, flags=re.DOTALL)
        assert re.findall(r"(?i)(?<![a-z])(?:nan|inf|infinity)(?![a-z])", page.replace("to infinity", "")) == []
        assert re.findall(r"\bNone\b", page) == []


def test_bands_and_closed_loop_stand_beside_the_overshoots(fit, text, read_page):
    page = read_page(text)
    manoeuvre = fit.assessment.manoeuvres["second"]
    low, high = np.rad2deg(manoeuvre.band95[0])
    # Two digits of the standard deviation behind a band, and no more: here 2 deg.
    assert f"{low:.1f} to {high:.1f}" in page.text
    assert f"{np.rad2deg(manoeuvre.closed_loop[0]):.1f}" in page.text
    assert "Closed loop" in page.text


def test_criteria_are_evaluated_and_not_certified(text, read_page):
    page = read_page(text)
    assert "evaluated against MSC.137(76) 5.3" in page.text
    assert "compliant" not in page.text.lower()
    assert "ships of 100 m and longer" in page.text
    assert "at least 90 % of the speed at 85 %" in page.text
    for words in (
        "Advance",
        "Tactical diameter",
        "10/10 second overshoot",
        "Spiral: stable on a straight course, no loop",
    ):
        assert words in page.text


def test_criteria_that_are_not_there_are_left_out_or_said_why(plain, without_criteria, read_page):
    assert 'id="criteria"' not in plain
    assert "There are none: the ship runs away." in read_page(without_criteria).text


def test_directions_and_whiteness_are_said_in_words(fit, text, read_page):
    page = read_page(text)
    assert "There is no such direction: every" in page.text
    assert "Chi-square" in page.text and "Correlation time" in page.text
    # Beside the residuals of a trial that was not fitted, which are not.
    assert "The residuals of every signal of the fitted trials are white" in page.text
    blind = shipid.identify(
        "de-keizer",
        [dataclasses.replace(fit.fitted[0].trial)],
        ship="soesterberg",
        signals=["psi", "r"],
        estimate=["K", "tau", "gamma"],
        starts=1,
    )
    with svg.collected():
        words = read_page(render(shipid.assess(blind, bands=False))).text
    assert "gamma has no effect in one 20/20 zig-zag" in words


def test_text_from_files_is_escaped(fit, read_page):
    nasty = "<script>alert(1)</script>.csv"
    trial = fit.fitted[0].trial
    source = dataclasses.replace(
        trial.source, path=f"/some/where/{nasty}", notes=(nasty,), format=nasty, sha256='"><b>'
    )
    bad = dataclasses.replace(fit.fitted[0], trial=dataclasses.replace(trial, name=nasty, source=source, ship=nasty))
    text = render(dataclasses.replace(fit, fitted=(bad,), message=nasty))
    page = read_page(text)
    assert "script" not in page.tags
    assert "b" not in page.tags
    assert page.text.count(nasty) >= 7
    assert any(n == "aria-label" and nasty in v for n, v in page.attributes)
    assert "/some/where" not in text, "folders of the machine stay at home"


def test_the_same_result_gives_the_same_bytes(fit, plain, tmp_path, monkeypatch):
    monkeypatch.setattr(report, "date", OnThatDay)
    assert write_report(fit, tmp_path / "a.html").read_bytes() == plain.encode()


def test_the_user_s_matplotlib_settings_do_not_show(fit, criteria, text):
    import matplotlib

    with matplotlib.rc_context({"font.size": 30, "lines.linewidth": 9, "axes.facecolor": "red"}):
        assert render(fit, criteria=criteria) == text


def test_it_is_written_whole_or_not_at_all(fit, tmp_path, monkeypatch):
    path = tmp_path / "report.html"
    path.write_text("before")

    def fail(*_, **__):
        raise OSError("disk full")

    with monkeypatch.context() as patch:
        patch.setattr(report, "render", lambda *_, **__: "<!DOCTYPE html>")
        patch.setattr(os, "replace", fail)
        with pytest.raises(OSError, match="disk full"):
            write_report(fit, path)
    with monkeypatch.context() as patch:
        patch.setattr(report, "render", fail)
        with pytest.raises(OSError, match="disk full"):
            write_report(fit, path)
    assert path.read_text() == "before"
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]
    with svg.collected():
        assert write_report(fit, path) == path
    assert path.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


def test_what_cannot_be_written_is_said(fit, tmp_path):
    (tmp_path / "old.html").write_text("old")
    with pytest.raises(OverwriteError, match=r"old\.html"):
        write_report(fit, tmp_path / "old.html", overwrite=False)
    with pytest.raises(MissingFileError, match="no folder"):
        write_report(fit, tmp_path / "nowhere" / "a.html")
    with pytest.raises(MissingFileError, match="is a folder"):
        write_report(fit, tmp_path)
    with pytest.raises(UsageError, match="int"):
        write_report(3, tmp_path / "a.html")


def test_three_long_noisy_trials_stay_small(fit, tmp_path):
    rng = np.random.default_rng(1)

    def long(c, k):
        n, t = 10_000, c.trial["t"]
        at = np.linspace(t[0], t[-1], n)
        table = {
            m: np.interp(at, t, c.trial[m]) + 0.1 * np.std(c.trial[m]) * rng.standard_normal(n) for m in c.trial.table
        }
        table["t"] = at
        frame = type(c.trial.table)(table)
        predicted = {m: np.interp(at, t, p) for m, p in c.predicted.items()}
        return dataclasses.replace(
            c, trial=dataclasses.replace(c.trial, name=f"long {k}", table=frame), predicted=predicted
        )

    c = fit.fitted[0]
    result = dataclasses.replace(fit, fitted=(long(c, 1), long(c, 2)), validation=(long(fit.validation[0], 3),))
    path = write_report(result, tmp_path / "long.html")
    assert path.stat().st_size < 1_000_000


def test_real_trials_with_a_turning_circle(read_page):
    if not DATA.exists():
        pytest.skip("the trial data of kvlcc2-marin are not on this machine")
    form = ROOT / "studies" / "formats" / "kvlcc2-marin.toml"
    names = ("zz_20_m", "zz_10_m", "tc_35_m")
    trials = [shipid.read_trial(DATA / f"MARIN_FREE_KVLCC2_{n}.dat", form) for n in names]
    fit = shipid.identify("norrbin", trials[:1], ship="kvlcc2", validate=trials[1:], starts=1)
    text = render(fit)
    page = read_page(text)
    assert "Turning circle to port" in page.text
    assert "Tactical diameter" in page.text
    assert "The rudder goes to 35 deg" in page.text
    assert "simulated" not in page.text
    for trial in trials:
        assert trial.source.sha256 in text
        assert trial.name in page.text
    assert len(text) < 1_000_000


def test_what_was_tried_and_found_is_on_the_page(fit, text, read_page):
    page = read_page(text)
    assert "What was tried" in page.text and "instrumental-variables" in page.text
    assert "Nothing was found in the records" in page.text
    assert "Sampled posterior" not in page.text
    bare = dataclasses.replace(fit, loss="huber", assessment=dataclasses.replace(fit.assessment, findings=None))
    with svg.collected():
        said = read_page(render(bare)).text
    assert "Check of the trials" not in said and "Huber's loss" in said


def test_a_page_works_nothing_out_and_says_what_was_not_asked_for(fit, criteria, text, read_page, monkeypatch):
    """No function of CasADi is evaluated for a page; what was not asked for is said."""

    def called(*_, **__):
        raise AssertionError("a page evaluates a model")

    monkeypatch.setattr(casadi.Function, "__call__", called)
    monkeypatch.setattr(casadi.Function, "buffer", called)
    assert render(fit, criteria=criteria) == text
    said = read_page(render(dataclasses.replace(fit, assessment=None))).text
    assert "The fit was not assessed" in said and "was not assessed" not in read_page(text).text
    assert "Check of the trials" not in said and "Directions in which coefficients" not in said


def test_no_raw_backticks_and_typeset_equations(text, read_page):
    page = read_page(text)
    assert "`" not in text
    assert page.tags.count("math") > 10 and "mfrac" in page.tags and "msubsup" in page.tags
    labels = [v for n, v in page.attributes if n == "aria-label"]
    assert any(v.startswith("dr/dt = ") for v in labels)


def test_findings_and_a_posterior_on_the_page(fit, read_page):
    table = fit.fitted[0].trial.table.copy()
    table["delta"] *= -1
    units = {n: FIELDS[n].unit for n in table.columns}
    trial = shipid.Trial.from_frame(table, name="<mirrored>", units=units)
    wrong = dataclasses.replace(fit, fitted=(dataclasses.replace(fit.fitted[0], trial=trial),))
    k, n = len(fit.estimated), 4
    drawn = Posterior(fit.estimated, ("1",) * k, np.ones((n, k)), np.ones((5, k)), np.ones(k), 2, 0.5, (None,) * k)
    text = render(dataclasses.replace(shipid.assess(wrong, bands=False), posterior=drawn))
    said = read_page(text).text
    assert "rudder-sign" in said and "Nothing was repaired" in said and "<mirrored>" not in text
    assert "Sampled posterior" in said and "4 draws of 2 walkers" in said
