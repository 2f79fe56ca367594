"""The report of a filtered record: one file, no NaN, everything that went wrong said in words."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import casadi
import numpy as np
import pytest

import shipid
from shipid.estimation.records.observability import observability
from shipid.foundation.notices import Notice
from shipid.report.figures.trials import Curve, Panel, histories_drawing
from shipid.report.views.words import past_north
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


@pytest.fixture(scope="module")
def page(run):
    return render(run)


@pytest.fixture(scope="module")
def seen(run):
    """With what the sensors show."""
    return observability(run)


@pytest.fixture(scope="module")
def page_of_seen(seen):
    return render(seen)


def test_the_page_stands_alone_and_holds_no_nan(run, page):
    assert "<svg" in page and "http" not in page.replace("http-equiv", "")
    words = page.lower()
    assert ">nan<" not in words and " nan " not in words and "inf " not in words
    assert page == render(run)


def test_a_page_works_nothing_out(seen, page_of_seen, monkeypatch):
    def called(*_, **__):
        raise AssertionError("a page evaluates a model")

    monkeypatch.setattr(casadi.Function, "__call__", called)
    monkeypatch.setattr(casadi.Function, "buffer", called)
    assert render(seen) == page_of_seen
    assert "`" not in page_of_seen and "<mfrac>" in page_of_seen


def test_what_went_wrong_is_said(run, page, page_of_seen):
    assert "5 of 738 samples of psi were outside the gate" in page_of_seen
    assert "x is not observable" in page_of_seen and "was not worked out" not in page_of_seen
    # What nobody asked for is not worked out for the page, and the page says so.
    assert "Whether the sensors show every state was not worked out" in page
    assert "The innovations of r are not white" in page_of_seen
    assert run.innovations["psi"].rejected == 5
    assert run.innovations["r"].t.size == 718


def test_parameters_and_levels_are_shown(page):
    for word in ("rate of turn per rudder angle", "default of the toolbox", "deg/s/√s", "95 % interval", "Nomoto.yaw"):
        assert word in page


@pytest.mark.usefixtures("undrawn")
def test_a_warning_that_ends_with_exit_code_5_stands_in_red(run):
    """The terminal says WARNING of it, and a note of another."""
    told = dataclasses.replace(run, warnings=(Notice("not to be used.", serious=True), Notice("to know about.")))
    page = render(told)
    assert page.count('class="box warning"') == 1
    assert page.index("not to be used.") < page.index('class="box caution"') < page.index("to know about.")


def test_a_parameter_that_is_not_determined_says_why(run, monkeypatch):
    """The words that the terminal prints beside it."""
    weak = dataclasses.replace(run.parameters["K"], standing="not determined", why="it is known from before.")
    monkeypatch.setattr(type(run), "parameters", property(lambda _: {"K": weak}))
    assert '<span class="no">Not determined:</span> it is known from before.' in render(run)


def test_innovations_between_the_extremes_are_drawn():
    """Twenty thousand normal ones: as many of the points drawn lie within one standard deviation as of a normal distribution."""
    values = np.random.default_rng(4).standard_normal(20_000)
    panel = Panel("Innovation", "deg", [Curve("innovation", np.arange(20_000.0), values)])
    drawing = histories_drawing([panel], "Innovations")
    (line,) = drawing.figure().axes[0].lines
    drawn = np.asarray(line.get_ydata())
    assert 100 < drawn.size <= 600 and np.mean(np.abs(drawn) < 1) == pytest.approx(0.683, abs=0.1)


def test_a_probability_is_drawn_from_zero_to_one():
    panel = Panel("probability", "1", [Curve("estimate", np.arange(3.0), np.array([0.5, 0.4, 0.6]))], span=(0.0, 1.0))
    low, high = histories_drawing([panel], "Probability").figure().axes[0].get_ylim()
    assert -0.1 < low <= 0 and 1 <= high < 1.1


@pytest.mark.usefixtures("undrawn")
def test_what_is_added_to_inputs_is_on_the_page(run):
    assert "Added to inputs" not in render(run)
    design = dataclasses.replace(
        run.design, instruments=dataclasses.replace(run.design.instruments, biases={"delta": 0.01})
    )
    page = render(dataclasses.replace(run, design=design))
    assert "Added to inputs" in page and re.search(
        r"<code>delta</code></th><td[^>]*>0\.57\d*</td><td[^>]*>deg</td>", page
    )


def test_an_axis_of_whole_numbers_has_no_half_of_one():
    t = np.arange(30.0)
    panel = Panel("Waypoint that is sailed to", "", (Curve("simulated", t, np.repeat([2.0, 3.0, 4.0], 10)),))
    figure = histories_drawing([panel], "Route").figure()
    figure.canvas.draw()
    ticks = figure.axes[0].get_yticks()
    assert len(ticks) >= 3 and np.array_equal(ticks, np.round(ticks))


@pytest.mark.usefixtures("undrawn")
def test_what_comes_from_the_record_is_said_with_its_doubt(run):
    """The terminal says both; so does the page."""
    doubt = "not distinguishable from zero: its 95 % interval, -1 to 1, holds zero."
    instruments = dataclasses.replace(run.design.instruments, biases={"delta": 0.0})
    design = dataclasses.replace(run.design, instruments=instruments)
    words = render(dataclasses.replace(run, design=design, learnt=("sensor:psi",), added={"delta": (0.01, doubt)}))
    assert words.count("found from the record") == 1
    assert "0.00 ± 0.57" in words and "Not distinguishable from zero: its 95 % interval" in words


def test_a_moving_mean_is_named_as_one(page):
    """The legend said "estimate" of the normalised innovations squared."""
    figure = page[page.index("Normalised innovations squared") :]
    words = re.findall(r"<text[^>]*>([^<]*)</text>", figure[: figure.index("</svg>")])
    assert "moving mean" in words and "estimate" not in words


def test_the_last_estimates_are_one_sentence(page, read_page):
    """Where each parameter had a sentence of its own, one called "a" read as an article."""
    text = read_page(page).text
    lead = text[: text.index("Parameters")]
    assert re.search(r"Estimates at the end: K = [\d.]+ ± [\d.]+ 1/s; tau = [\d.]+ ± [\d.]+ s\.", lead)


def test_a_heading_on_a_figure_and_in_the_table_are_one(run, page, read_page):
    """316.9 deg stood in the table beside a line that ends at -43."""
    last = np.degrees(run["psi"])
    assert last.min() < 0
    low = round(float(last.min()))
    assert f"The heading is drawn without a jump at north: −{-low} deg is {low % 360} deg." in read_page(page).text
    assert past_north(np.array([-0.2, 359.4])) == "" == past_north(np.array([np.nan]))
    assert past_north(np.array([10.0, 371.0])).endswith(" 371 deg is 11 deg.")


def test_a_band_that_widens_and_narrows_is_seen_whole():
    """Half of a band lay out of the panel: it was drawn up to its median."""
    t = np.linspace(0.0, 1.0, 400)
    std = 1.0 + 0.4 * np.sin(9 * t)
    line = 0.05 * np.sin(5 * t)
    panel = Panel(
        "Current", "m/s", [Curve("estimate", t, line), *(Curve("95 % band", t, line + s * std) for s in (-1, 1))]
    )
    low, high = histories_drawing([panel], "Band").figure().axes[0].get_ylim()
    assert low < (line - std).min() and high > (line + std).max()
    # One that begins a thousand times as wide does not flatten the rest.
    wide = np.where(t < 0.3, 1000.0, std)
    panel = Panel(
        "Current", "m/s", [Curve("estimate", t, line), *(Curve("95 % band", t, line + s * wide) for s in (-1, 1))]
    )
    low, high = histories_drawing([panel], "Band").figure().axes[0].get_ylim()
    assert high - low < 5


def test_a_recursion_has_no_column_without_numbers_and_its_settling_flattens_nothing(read_page):
    found = shipid.identify_recursively("yaw-filter", shipid.read_trial(TRIAL), ship="soesterberg", method="rls")
    page = read_page(render(found))
    assert "band that holds 95 % of such means" not in page.text and "NIS" in page.text
    axes = shipid.plot(found).axes
    for ax in axes:
        name = ax.get_title(loc="left")
        if name in found.parameters:
            low, high = ax.get_ylim()
            settled = found[name][int(0.25 * found.t.size) :]
            assert high - low < 4 * np.ptp(settled), name
