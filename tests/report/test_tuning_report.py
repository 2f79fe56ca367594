"""The tuning report: whole, self-contained, words first, and weak designs named in its summary."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import casadi
import numpy as np
import pytest

import shipid
from shipid.autopilot.judgement.compare_tunings import OVER_DRAWS, compare_tunings
from shipid.autopilot.judgement.judge import _about
from shipid.foundation.errors import UsageError
from shipid.report.write_report import render

SITE = Path(__file__).resolve().parents[2] / ".docs" / "reports"


@pytest.fixture(scope="module")
def judged():
    ship = shipid.find_ship("kvlcc2")  # it states standard deviations
    pilot = shipid.design_autopilot("norrbin", ship, design="pid", speeds=[6.0, 7.97])
    return shipid.judge(pilot, samples=20, on_board=shipid.run_on_board(pilot, "yaw-filter"))


@pytest.fixture(scope="module")
def weak():
    """Poles far too quick for the servo, a speed range beyond the table, and no uncertainty known."""
    return shipid.judge(shipid.design_autopilot("nomoto", "zeefakkel", omega_n=3.0, speeds="1:5:2 m/s"), samples=20)


@pytest.fixture(scope="module")
def pages(judged, weak):
    both = compare_tunings(judged, weak, ("A.toml", "B.toml"))
    return {"judged": render(judged), "weak": render(weak), "both": render(both)}


@pytest.mark.parametrize("which", ["judged", "weak", "both"])
def test_pages_are_whole_and_need_nothing(pages, which, read_page):
    text = pages[which]
    page = read_page(text)
    assert page.open == [] and len(page.ids) == len(set(page.ids))
    links = set(re.findall(r'href="#([^"]+)"', text)) | set(re.findall(r"url\(#([^)]+)\)", text))
    assert links <= set(page.ids)
    assert re.findall(r"https?:|//[a-z]|@import|<link|<script|<img|xlink", text) == []
    bare = re.sub(r"<style>.*?</style>", "", text, flags=re.DOTALL)
    assert re.findall(r"(?i)(?<![a-z])(?:nan|inf|infinity)(?![a-z])", bare) == []
    assert re.findall(r"\bNone\b", bare) == [] and "compliant" not in bare


def test_a_plot_of_a_judgement_is_the_first_figure_of_its_page(judged):
    titles = [ax.get_title(loc="left") for ax in shipid.plot(judged).axes]
    assert "Heading [deg]" in titles and "Rudder angle [deg]" in titles


def test_the_site_explains_the_sections_that_there_are(pages):
    explained = set(re.findall(r"\*\*(.+?)\*\*", (SITE / "tuning.md").read_text(encoding="utf-8")))
    there = {t for page in pages.values() for t in re.findall(r"<h2[^>]*>([^<]+)</h2>", page)}
    assert explained == there


def test_a_page_works_nothing_out(pages, judged, monkeypatch):
    def called(*_, **__):
        raise AssertionError("a page evaluates a model")

    monkeypatch.setattr(casadi.Function, "__call__", called)
    monkeypatch.setattr(casadi.Function, "buffer", called)
    assert render(judged) == pages["judged"]
    assert "`" not in pages["judged"]


def test_the_answer_comes_first(pages, judged, read_page):
    text = read_page(pages["judged"]).text
    lead = text[: text.index("Weak points")]
    assert "A heading autopilot for kvlcc2 from 6 to 7.97 m/s" in lead
    assert judged.weakest.sentence in lead and "the disk margin is never less than" in lead
    for part in ("Schedule", "Margins", "Robustness", "Course changes", "Wind, waves and current", "Keeping a course"):
        assert part in text


def test_a_weak_design_is_named_in_the_summary(pages, weak, read_page):
    text = read_page(pages["weak"]).text
    lead = text[: text.index("Weak points")]
    assert min(m.disk for m in weak.margins[0]) < 0.5
    assert "below 0.5" in lead and "Beyond that the model extrapolates" in lead and "Disk margin: the least" in lead
    assert "is not known" in lead
    # A box says "Warning" where the command ends with exit code 5, and nowhere else.
    serious = [w for w in weak.to_dict()["warnings"] if w["serious"]]
    assert pages["weak"].count('class="box warning"') == len(serious)
    assert pages["weak"].count('class="box caution"') == len(weak.warnings) - len(serious) >= 3


@pytest.mark.usefixtures("undrawn")
def test_draws_that_are_unstable_are_serious(judged):
    """A design that does not hold for ships that the trials allow: told in red, and the command ends with exit code 5."""
    robust = dataclasses.replace(judged.robust[0], unstable=3)
    words = _about(judged.pilot, robust, 0, judged.limits)[0]
    page = render(dataclasses.replace(judged, warnings=(words,)))
    assert words.serious and page.count('class="box warning"') == 1 and "3 of 20 draws" in words
    none = dataclasses.replace(robust, samples=0, unstable=1)
    assert any("is unstable at" in w and "draws" not in w for w in _about(judged.pilot, none, 0, judged.limits))


def test_tables_hold_the_numbers(pages, judged, read_page):
    text = read_page(pages["judged"]).text
    for speed in judged.pilot.speeds:
        assert f"{speed:.2f}" in text
    own = next(s for s in judged.steps if s.change_deg == 60 and s.speed == judged.pilot.speeds[-1])
    assert f"{own.overshoot_deg:.2f}" in text and f"{own.settling_s:.0f}" in text
    kept = [s for s in judged.in_weather if not s.change_deg]
    worst = {f: max(s.reversals for s in kept if s.sea_filter == f) for f in (True, False)}
    assert f"reverses {worst[False]:.1f} times a minute without the sea filter" in text and worst[True] < worst[False]
    assert "Bode diagram of the loop" in pages["judged"] and text.index("Course changes") < text.index("Weak points")
    for name, variant in judged.robust[0].variants.items():
        assert f"{name[0].upper()}{name[1:]} {variant['disk']:.2f} {variant['overshoot_deg']:.2f}" in text


def test_a_design_that_was_not_judged_says_so(judged, read_page):
    """Gains, poles and warnings of the design, a line that the judgement was not asked for, and nothing of a judgement."""
    text = render(judged.pilot)
    page = read_page(text)
    assert page.open == [] and "The design was not judged" in page.text and "Gains against the speed" in page.text
    for part in ("Weak points", "Margins", "Robustness", "On board"):
        assert part not in page.text
    links = set(re.findall(r'href="#([^"]+)"', text)) | set(re.findall(r"url\(#([^)]+)\)", text))
    assert links <= set(page.ids)


def test_runs_on_board_are_reported(pages, judged, read_page):
    text = read_page(pages["judged"]).text
    assert "and by the Kalman filter yaw-filter; the gains are those of the schedule" in text
    for run in judged.on_board.runs:
        assert f"{run.changes[-1].rms_rudder_deg:.2f}" in text
    assert "Kalman filter" not in read_page(pages["weak"]).text


def test_two_tunings_side_by_side(pages, judged, weak, read_page):
    found = compare_tunings(judged, weak, ("A.toml", "B.toml"))
    row = next(r for r in found.rows if r.what == "least disk margin")
    assert row.better == 0 and row.values[0] > row.values[1]
    assert any(w.startswith("two ships") for w in found.warnings)
    assert found.to_dict()["names"] == ["A.toml", "B.toml"]
    assert found.to_frame().shape == (len(found.rows), 2)
    assert "* the better one" in found.text()
    assert "Least disk margin" in read_page(pages["both"]).text


def test_a_run_that_never_settled_is_not_better(judged):
    """A number beats none, whichever side it stands on."""
    steps = tuple(dataclasses.replace(s, settling_s=None) for s in judged.steps)
    lost = dataclasses.replace(judged, steps=steps)
    for pair, better in (((judged, lost), 0), ((lost, judged), 1)):
        row = next(r for r in compare_tunings(*pair, ("a", "b")).rows if r.what == "settling, 60 deg")
        assert row.better == better and None in row.values


def test_on_a_phone_a_change_of_course_keeps_its_unit(pages):
    assert re.search(r'<th scope="row" class="n" data-label="Change \[deg\]">', pages["judged"])
    # The two tunings are compared within a row, which stands as a card.
    assert re.search(r'<table class="stack">\s*<thead><tr><th scope="col">Quantity', pages["both"])


def test_an_uncertainty_that_is_not_known_is_no_number(judged, read_page):
    """Without draws of the ship the least margin over them would be that of the nominal ship."""
    blind = dataclasses.replace(judged, robust=tuple(dataclasses.replace(r, samples=0) for r in judged.robust))
    found = compare_tunings(blind, judged, ("a", "b"))
    row = next(r for r in found.rows if r.what == OVER_DRAWS)
    assert row.values[0] is None and row.better is None
    assert "not known" in found.text()
    assert re.search(r"Least disk margin over the uncertainty\s+not known", read_page(render(found)).text)


def test_no_report_of_anything_else():
    with pytest.raises(UsageError, match="no report for a ndarray"):
        render(np.zeros(3))


def test_gains_read_the_same_on_the_terminal_and_on_the_page():
    pilot = shipid.design_autopilot("de-keizer", "soesterberg", speeds="8:10:1 m/s")
    page = render(pilot)
    rows = [line.split() for line in pilot.text().splitlines()[2:5]]
    assert [row[0] for row in rows] == ["8.00", "9.00", "10.00"]
    assert [cell for row in rows for cell in row if f">{cell}<" not in page] == []


@pytest.mark.usefixtures("pages", "undrawn")
def test_the_worst_overshoot_is_not_the_largest_and_the_page_says_why(pages, judged, read_page):
    """The course changes hold larger ones: the table of weak points seemed to contradict them."""
    largest = max(s.overshoot_deg for s in judged.steps if s.change_deg)
    worst = max((p for p in judged.points() if p.what == "overshoot"), key=lambda p: 1 / p.share)
    assert worst.value < largest
    text = read_page(pages["judged"]).text
    assert "An overshoot may be 10 % of its course change, and 1 deg in any case" in text
    strict = dataclasses.replace(judged, limits={**judged.limits, "overshoot": 0.05})
    assert "An overshoot may be 5 % of its course change" in read_page(render(strict)).text


def test_a_gain_has_its_power_of_ten_as_any_other_axis(pages):
    assert "[10⁻³ 1/s]" in pages["judged"] and "1/1000" not in pages["judged"]
