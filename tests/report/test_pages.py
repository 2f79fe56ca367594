"""Every kind of page, as a reader meets it: valid, small, no digits without a meaning, and in a browser readable everywhere."""

from __future__ import annotations

import dataclasses
import re
import shutil

import html5lib
import jinja2
import numpy as np
import pandas as pd
import pypdf
import pytest

import shipid
from shipid.campaign.fleet_result import FleetResult, Scatter
from shipid.criteria.measured.trial_sheet import trial_sheet
from shipid.foundation.errors import UsageError
from shipid.identification.choice.choosing import Rank
from shipid.identification.choice.ranking import Ranking
from shipid.report.figures.comparisons import heading_drawing
from shipid.report.pdf import write_pdf
from shipid.report.write_report import render, write_report
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.findings import not_read

#: `diverged` has the elements of `fit`.
SCREENS = ("fit", "filter", "ranking", "plan", "criteria", "check", "sheet", "fleet")
KINDS = ("fit", "diverged", "filter", "ranking", "plan", "criteria", "check", "sheet", "fleet")


@pytest.fixture(scope="module")
def results(fit, diverged, criteria):
    """One result of each kind, by name."""
    trial = fit.fitted[0].trial
    ekf = shipid.ExtendedKalmanFilter(
        shipid.find_model("de-keizer"), "soesterberg", measured={"psi": "0.2 deg", "r": "0.02 deg/s"}, estimated=["K"]
    )
    table = trial.table.copy()
    table["delta"] *= -1
    mirrored = dataclasses.replace(trial, name="mirrored", table=table)
    ranks = [
        Rank(name, 6, 6, 1, score, 0.01, (score,), {"rate": 0.01}, {}, predictions=fit.validation)
        for name, score in (("de-keizer", 0.1), ("a model with a long name", 0.5))
    ]
    ranking = Ranking(tuple(ranks), ("second",))
    return {
        "fit": fit,
        "diverged": diverged,
        "filter": ekf.filter(trial),
        "ranking": ranking,
        "plan": shipid.plan_trials("nomoto", "soesterberg", "15 min", draws=0),
        "criteria": criteria,
        "check": (check_trial(trial), check_trial(mirrored, fit.ship), not_read("x.csv", "no column is a time.")),
        "sheet": trial_sheet([trial], length=226.0),
        "fleet": fleet_of(),
    }


def fleet_of():
    """Four trials: two determine K, one says that it is small, and the check of another found something serious."""
    rows = {
        "trial": np.array(["a.csv", "b.csv", "c.csv", "d.csv"]),
        "outcome": np.array(["identified", "identified", "not identified", "identified"]),
        "doctor": np.array(["", "rudder-sign", "", ""]),
        "message": np.array(["", "", "no column is a time.", ""]),
        "K": np.array([0.0142, 0.0143, np.nan, 0.0001]),
        "K_std": np.array([0.0001, 0.0002, np.nan, 0.0002]),
        "K_standing": np.array(["determined", "determined", "", "not distinguishable from zero"]),
    }
    scatter = Scatter("K", "1/s", "yaw gain", 2, 0.01422, 0.00009, 0.00007, 0.6)
    return FleetResult("nomoto", "soesterberg", rows, {}, {"K": scatter}, {"versions": {"shipid": "1"}})


@pytest.fixture(scope="module")
def pages(results, criteria):
    return {n: render(r, **({"criteria": criteria} if n == "fit" else {})) for n, r in results.items()}


@pytest.mark.parametrize("kind", KINDS)
def test_a_page_is_valid_and_small(pages, kind):
    text = pages[kind]
    html5lib.HTMLParser(strict=True).parse(text)
    assert len(text.encode()) < 1_000_000
    ids = re.findall(r"\sid=\"([^\"]*)\"", text)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r"href=\"#([^\"]*)\"", text)) <= set(ids)


@pytest.mark.parametrize("kind", KINDS)
def test_numbers_are_for_people(pages, kind, read_page):
    words = read_page(pages[kind]).text
    assert re.findall(r"\d\.\d{9,}", words) == []
    assert re.findall(r"(?<![\w.])[-−]0(?:\.0+)?(?![\d.]*[1-9.])(?!\d)", words.replace(" to -0", " to 0")) == []
    assert re.findall(r"ftol|xtol|gtol|max_nfev|termination condition|nan\b", words) == []
    assert re.findall(r"rotate\(-0|[\" ]-0[\" ]", pages[kind]) == []


def test_the_identification_report_is_read_in_order(pages, read_page):
    titles = [
        "Measured and predicted", "What the check of the trials found", "What may be believed, and how far", "Coefficients",
        "Manoeuvring criteria", "Trials in detail", "Equations of model", "Provenance",
    ]  # fmt: skip
    text = pages["fit"]
    places = [re.search(rf"<h2[^>]*>{title}", text).start() for title in titles]
    assert places == sorted(places)
    folded = [text.rfind("<details>", 0, p) > text.rfind("<section>", 0, p) for p in places]
    assert folded == [False] * 5 + [True] * 3
    assert text.index("<svg") < places[1], "the picture comes first"


def test_the_fit_in_percent_stands_on_page_terminal_and_json(fit, pages):
    kept = fit.validation[0]
    measured, predicted = kept.trial["psi"], kept.predicted["psi"]
    percent = 100 * (1 - np.linalg.norm(measured - predicted) / np.linalg.norm(measured - measured.mean()))
    assert kept.fit_percent["psi"] == pytest.approx(percent, rel=1e-9)
    assert f"{percent:.1f} %" in pages["fit"]
    assert f"(fit {percent:.1f} %)" in fit.text()
    assert fit.to_dict()["validation"]["second"]["psi"]["fit_percent"] == pytest.approx(percent)


def test_verdicts_and_the_command_are_on_the_page(results, pages, read_page):
    assert "would spoil an identification" in read_page(pages["check"]).text
    assert "no column is a time." in read_page(pages["check"]).text
    assert "One file could not be read." in read_page(pages["check"]).text
    # A file without rows has no time axis, no manoeuvres and no rows to tell of.
    assert pages["check"].count("<svg") == 2 and "0 rows read" not in pages["check"]
    assert "The model to take is" in read_page(pages["ranking"]).text
    assert "0.100 ± 0.010" in read_page(pages["ranking"]).text, "the decimals of the terminal"
    assert re.search(
        r"the standard deviation of coefficient K is [\d.]+ times (smaller|larger)", read_page(pages["plan"]).text
    )
    # At the helm an order is a line, on a phone too; a condition has a column where there is one.
    orders = pages["plan"][pages["plan"].index(">At [min:s]<") - 200 :]
    assert '<table class="stack' not in orders[:220]
    assert "The trials agree on K." in read_page(pages["fleet"]).text
    near_zero = "(1.0 ± 2.0) × 10⁻⁴, not distinguishable from zero"
    assert near_zero in read_page(pages["fleet"]).text.replace(" ,", ","), (
        "the words of the report of an identification"
    )
    assert pages["ranking"].count("<svg") == 2
    criteria = read_page(pages["criteria"])
    assert "Within the limit: " in criteria.text and "<nav" not in pages["criteria"]
    command = "shipid plan nomoto --ship 'my ship' --time <20>"
    said = read_page(render(results["plan"], command=command))
    assert f"by {command}" in said.text


def test_a_rudder_bias_has_its_standard_deviation(fit, pages, read_page):
    std = np.sqrt(
        fit.identified.covariance.matrix[(at := len(fit.parameters) + len(fit.identified.problem.initial)), at]
    )
    assert fit.fitted[0].bias_std == fit.validation[0].bias_std == pytest.approx(std) and std > 0
    told = fit.to_dict()
    assert told["rudder_bias"]["first"]["std"] == pytest.approx(std)
    assert told["rudder_bias_refitted"]["second"]["std"] == pytest.approx(fit.validation[0].refitted_bias_std)
    assert (
        len(re.findall(r"(?:bias|record:?) −?\d\.\d+ ± 0\.\d+ deg", read_page(pages["fit"]).text.replace("this ", "")))
        == 3
    )


def test_a_recorded_signal_has_a_label_and_few_digits(read_page):
    t = np.arange(0.0, 100.0)
    table = {"t [s]": t, "psi [deg]": 1e-3 * np.sin(t), "delta [deg]": 0 * t, "psi_order [deg]": 40 + 0 * t}
    trial = shipid.Trial.from_frame(pd.DataFrame(table), name="small")
    trial = dataclasses.replace(trial, source=dataclasses.replace(trial.source, simulated=True))
    words = read_page(render(trial)).text
    assert "Heading [10⁻³ deg]" in words and "Ordered heading [deg]" in words
    assert "simulated" in words and "measured" not in words.replace("not measured", "")


def test_what_limits_the_criteria_comes_before_them(pages):
    page = pages["criteria"]
    assert 0 < page.index("The values for 35 deg of rudder are extrapolated.") < page.index("<main")


def test_a_simulated_trial_is_no_measurement(results, pages):
    assert any(n.kind == "simulated" and "first" in n for n in results["sheet"].warnings)
    assert ">simulated, not measured</span>" in pages["sheet"]
    # The length that was given stands in the record of the trial too.
    assert results["sheet"].conditions.number("length") == 226.0


def test_an_overshoot_has_the_digits_of_its_uncertainty(results, pages, read_page):
    for words in (read_page(pages["sheet"]).text, results["sheet"].text()):
        found = re.findall(r"(\d+\.\d+) ± (\d+\.\d+) deg", words)
        assert found and all(len(a.partition(".")[2]) == len(b.partition(".")[2]) for a, b in found)


def test_a_fleet_is_drawn_with_short_labels(pages, read_page):
    page = pages["fleet"]
    assert page.count("<svg") == 1 and "K [10⁻² 1/s]" in page
    assert "Check: rudder-sign." in read_page(page).text and "3 of 4 were identified" in read_page(page).text


def test_a_turn_has_its_rudder_below_its_heading(fit):
    """Through 600 degrees on one axis, 35 degrees of rudder are a flat line."""
    kept = fit.validation[0]
    table = kept.trial.table.copy()
    table["psi"] = np.linspace(0.0, np.deg2rad(600.0), len(table))
    turned = dataclasses.replace(kept, trial=dataclasses.replace(kept.trial, table=table))
    assert [len(heading_drawing({"a": c}).figure().axes) for c in (kept, turned)] == [1, 2]


def test_a_report_asks_for_a_kind_it_knows(results):
    with pytest.raises(UsageError, match="no report for a list"):
        render([])
    with pytest.raises(UsageError, match="no report for several int"):
        render([1, 2])


@pytest.mark.parametrize("kind", SCREENS)
def test_a_page_is_readable_on_every_screen(browser, pages, kind):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe-playwright-python is not installed")
    context = browser.new_context(viewport={"width": 390, "height": 844})
    page = context.new_page()
    page.set_content(pages[kind])
    page.evaluate("document.querySelectorAll('details').forEach(d => d.open = true)")
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    # A verdict is seen without scrolling its table sideways.
    hidden = "[...document.querySelectorAll('.stack td')].filter(d => d.getBoundingClientRect().right > 390).length"
    assert page.evaluate(hidden) == 0
    for mode in ("light", "dark") if kind in ("fit", "check") else ("dark",):
        page.emulate_media(color_scheme=mode)
        found = axe.Axe().run(page).response["violations"]
        assert [(fault["id"], [node["target"] for node in fault["nodes"]]) for fault in found] == [], mode
    context.close()


def test_a_report_is_printed(fit, criteria, tmp_path):
    if shutil.which("chromium") is None:
        pytest.skip("no Chromium on this machine")
    path = write_report(fit, tmp_path / "fit.pdf", criteria=criteria, command="shipid identify x.csv")
    printed = pypdf.PdfReader(path)
    assert len(printed.pages) <= 12
    last = printed.pages[-1].extract_text()
    assert f"{len(printed.pages)} / {len(printed.pages)}" in last
    assert re.search(r"\d+ \w+ 20\d\d", printed.pages[0].extract_text().splitlines()[-1] + last)
    whole = " ".join(p.extract_text() for p in printed.pages)
    assert "Ljung and Box" in whole, "what is folded on a screen is open on paper"
    assert [p.name for p in tmp_path.iterdir()] == ["fit.pdf"]


def on_paper(folder, body):
    """Print a body with the styles of a report: from its rows to the text of each sheet."""
    environment = jinja2.Environment(loader=jinja2.PackageLoader("shipid.report"), autoescape=True)
    styles = '<!DOCTYPE html><title>t</title><style>{% include "report.css" %}{% include "paper.css" %}</style>'
    template = environment.from_string(styles + body)

    def printed(rows):
        (folder / "page.html").write_text(template.render(rows=rows), encoding="utf-8")
        write_pdf(folder / "page.html", folder / "page.pdf")
        return [p.extract_text() for p in pypdf.PdfReader(folder / "page.pdf").pages]

    return printed


def test_a_long_table_breaks_between_its_rows_and_a_short_one_stays_whole(tmp_path):
    if shutil.which("chromium") is None:
        pytest.skip("no Chromium on this machine")
    printed_with = on_paper(
        tmp_path,
        '{% from "macros.html" import table %}<div style="height: 200mm"></div><p>Above.</p>'
        '{{ table([("Finding", "what"), ("Meaning", "words", "wide"), ("Repair", "words", "wide")], rows) }}',
    )
    printed = {}
    for count in (4, 9):
        rows = [{"what": f"row{k}.", "words": " ".join(["Running text of a finding."] * 7)} for k in range(count)]
        printed[count] = printed_with(rows)
    assert "row0." not in printed[4][0] and "row3." in printed[4][1]
    first, second = printed[9]
    assert "row1." in first and "row8." in second
    for page in (first, second):
        assert "FindingMeaningRepair" in page.replace("\n", "").replace(" ", ""), "the head stands on both pages"


def test_no_table_of_a_trial_sheet_is_split(pages, tmp_path):
    """The limits of a day of many manoeuvres broke between their rows, as the findings of a log may."""
    assert set(re.findall("<section[^>]*>", pages["sheet"])) == {'<section class="sheet">'}
    if shutil.which("chromium") is None:
        pytest.skip("no Chromium on this machine")
    printed_with = on_paper(
        tmp_path,
        '{% from "macros.html" import table %}<section class="sheet"><div style="height: 160mm"></div><p>Above.</p>'
        '{{ table([("Quantity", "what"), ("Verdict", "verdict"), ("Limit", "limit")], rows) }}</section>',
    )
    rows = [{"what": f"row{k}.", "verdict": "within", "limit": "5 L"} for k in range(20)]
    first, second = printed_with(rows)
    assert "row" not in first and all(f"row{k}." in second for k in range(20))


def test_a_table_of_coefficients_leaves_no_third_of_a_sheet_empty(tmp_path):
    """Six coefficients below what may be believed stood on the next sheet, with their heading."""
    if shutil.which("chromium") is None:
        pytest.skip("no Chromium on this machine")
    printed_with = on_paper(
        tmp_path,
        '{% from "macros.html" import body, head, scroll %}<div style="height: 175mm"></div><p>Above.</p>'
        '{% set columns = [("Name", "what"), ("Meaning", "words", "wide")] %}'
        '{% call scroll("stack") %}{{ head(columns) }}{{ body(columns, rows, "Fitted") }}{% endcall %}',
    )
    printed = {}
    for count in (4, 6):
        rows = [{"what": f"row{k}.", "words": " ".join(["Meaning of a coefficient."] * 28)} for k in range(count)]
        rows[-2]["remark"] = "It is not distinguishable from zero."
        printed[count] = printed_with(rows)
    assert "row0." not in printed[4][0] and "row3." in printed[4][1], "a short one stays whole"
    first, second = printed[6]
    assert "Fitted" in first and "row1." in first and "row4." in second and "row5." in second
    assert all("Name" in page for page in (first, second)), "the head stands on both pages"


def test_the_tables_of_a_manoeuvre_stand_beside_each_other_on_paper(browser):
    """Eight columns of reversals, where the rudder was read from its ramp, ran into the table of the quantities."""
    environment = jinja2.Environment(loader=jinja2.PackageLoader("shipid.report"), autoescape=True)
    columns = [
        (f"{what} [deg]", what, "n")
        for what in ["Reversal", "Execute", "Heading", "Overshoot", "Uncertain", "Moved", "Extreme", "Yaw"]
    ]
    page = browser.new_page(viewport={"width": 680, "height": 960})  # the width of a sheet between its margins
    page.set_content(
        environment.from_string(
            '<!DOCTYPE html><title>t</title><style>{% include "report.css" %}{% include "paper.css" %}</style>'
            '{% from "macros.html" import table %}<div class="figures measured"><div>{{ table(columns, rows) }}</div>'
            '<div>{{ table([("Quantity", "a"), ("Measured", "b", "n")], [{"a": "Tactical diameter in still water", "b": "6.91 m (2.30 L)"}]) }}'
            "</div></div>"
        ).render(columns=columns, rows=[{name: "−310.89" for _, name, _ in columns}] * 3)
    )
    page.emulate_media(media="print")
    lines = page.evaluate(
        "[...document.querySelectorAll('div + div td')].map(d => d.firstChild).map(words => {"
        "const r = document.createRange(); r.selectNode(words); return r.getClientRects().length})"
    )
    left, right = page.evaluate("[...document.querySelectorAll('table')].map(t => t.getBoundingClientRect().toJSON())")
    page.close()
    assert left["right"] > 410, "the table is wider than the place it usually has"
    assert left["right"] < right["left"] and right["right"] <= 680
    assert lines == [1], "a value stands on one line with its unit"


def test_a_card_that_only_a_number_names_says_what_the_number_counts():
    """On a phone the head of the table is not shown: '2' alone is nothing."""
    environment = jinja2.Environment(loader=jinja2.PackageLoader("shipid.report"), autoescape=True)
    text = environment.from_string(
        '{% from "macros.html" import table %}{{ table([("Reversal", "k"), ("Execute [s]", "t", "n"), ("±", "s", "n")], rows) }}'
    ).render(rows=[{"k": "2", "t": "180.00", "s": "0.20"}, {"k": "first", "t": "1.0", "s": "0.1"}])
    assert '<th scope="row" data-label="Reversal">2</th>' in text and '<th scope="row">first</th>' in text


def test_reversals_have_one_set_of_words_and_stand_with_their_plot(results, pages):
    measures = results["sheet"].manoeuvres[0].measures
    heads, rows = measures.table()
    page, text = pages["sheet"], measures.text()
    for head in heads:
        assert f">{head[:1].upper()}{head[1:]}</th>" in page and head in text
    assert all(cell in page and cell.replace("−", "-") in text for cell in rows[0])
    # Between the plot and the numbers of the whole zig-zag, in one block that paper does not split.
    block = page.index('<div class="figures measured">')
    assert (
        block
        < page.index("each overshoot is marked")
        < page.index(">Check yaw [s]</th>")
        < page.index(">Measured</th>", block)
    )


def test_a_lone_figure_has_something_beside_it(pages):
    assert '<div class="figures">\n<figure><svg' in pages["criteria"]


class Pitch(shipid.Component):
    """A propeller whose pitch follows its order."""

    PD = shipid.state("1", "pitch ratio of the propeller", start=0.8)
    draw = shipid.state("m", "draw of the shaft, to the stern", start=0.1)
    T_p = shipid.parameter("s", "time constant", start=4.0, low=0.3, high=60)

    @PD.rate
    def follow(self):
        """Declared for this test."""
        return (0.5 - self.PD) / self.T_p

    @draw.rate
    def give(self):
        """Declared for this test."""
        return -self.draw / self.T_p


def test_a_state_with_a_name_of_its_own_is_recorded_and_reported(read_page):
    model = shipid.join("pitch", Pitch, *(c for c in shipid.find_model("nomoto").components))
    ship = dataclasses.replace(shipid.find_ship("soesterberg"))
    noise = "psi=0.2 deg,r=0.02 deg/s,PD=0.01,draw=0.01 m"
    trial = shipid.simulate(model, ship, "zigzag:10/10", values={"T_p": "5 s"}, noise=noise, duration="200 s")
    assert trial.unit("PD") == "1" and trial.unit("draw") == "m" and "draw 0.01 m" in trial.source.comment
    levels = dict(part.split("=") for part in noise.split(","))
    fit = shipid.identify(model, [trial], ship=ship, starts=1, noise=levels)
    assert "draw 0.0" in fit.text() and " m (fit" in fit.text()
    assert "Pitch ratio of the propeller" in read_page(render(fit)).text
