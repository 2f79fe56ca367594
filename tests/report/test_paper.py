"""Pages on paper, as a reader holds them: figures that are legible, with their captions and numbers; and a matrix on a phone."""

from __future__ import annotations

import dataclasses
import io

import jinja2
import pypdf
import pytest

from shipid.report.write_report import render

#: Width of a sheet between its margins, in the pixels of a browser.
SHEET = 680


@pytest.fixture(scope="module")
def page_of_fit(fit):
    return render(fit)


@pytest.fixture
def sheets(browser):
    """From the template of a body to the text of each sheet."""
    environment = jinja2.Environment(loader=jinja2.PackageLoader("shipid.report"), autoescape=True)
    styles = '<!DOCTYPE html><title>t</title><style>{% include "report.css" %}{% include "paper.css" %}</style>'

    def printed(body, **view):
        page = browser.new_page()
        page.set_content(environment.from_string(styles + body).render(**view))
        pdf = pypdf.PdfReader(io.BytesIO(page.pdf(prefer_css_page_size=True)))
        page.close()
        return [p.extract_text() for p in pdf.pages]

    return printed


@pytest.fixture
def on_paper(browser):
    """Open a page as it is laid out between the margins of a sheet."""
    opened = []

    def laid_out(text):
        page = browser.new_page(viewport={"width": SHEET, "height": 960})
        page.set_content(text)
        page.emulate_media(media="print")
        opened.append(page)
        return page

    yield laid_out
    for page in opened:
        page.close()


def test_the_words_of_many_panels_are_legible_on_paper(fit, on_paper):
    """Eight panels were shrunk to 112 mm, and their words to 3 points, above an empty half of the sheet."""
    trial = fit.fitted[0].trial
    table = trial.table.assign(**{f"pressure {k}": trial.table["psi"] for k in range(4)})
    units = {**trial.units, **{f"pressure {k}": "rad" for k in range(4)}}
    page = on_paper(render(dataclasses.replace(trial, table=table, units=units)))
    assert page.evaluate("document.querySelectorAll('figure svg')[0].querySelectorAll('text').length") > 30
    least = page.evaluate(
        "Math.min(...[...document.querySelectorAll('figure svg text')].map(t => t.getBoundingClientRect().height))"
    )
    assert least > 7, "pixels of 1/96 inch"


def test_a_caption_stands_on_the_sheet_of_its_figures(sheets):
    body = (
        '{% from "macros.html" import figures %}<div style="height: 100mm"></div><p>Above.</p>'
        "{{ figures([drawing, drawing], 'Estimates against time.') }}"
    )
    # A figure that just fits on the rest of the first sheet, and its caption not.
    for height in (130, 150, 152, 154, 156, 158):
        drawing = jinja2.filters.Markup(
            f'<svg viewBox="0 0 80 {height}" style="height: {height}mm; max-height: none"><text y="9">drawn</text></svg>'
        )
        printed = sheets(body, drawing=drawing)
        (caption,) = [k for k, text in enumerate(printed) if "Estimates" in text]
        assert "drawn" in printed[caption], height


def test_the_errors_of_a_trial_stand_below_its_heading_on_paper(page_of_fit, sheets):
    """The table of the second trial stood alone on the next sheet, and nothing said of which trial."""
    assert page_of_fit.count('<div class="figures pair">') == 2
    body = (
        '{% from "macros.html" import figure, table %}<div style="height: 190mm"></div><div class="figures pair"><div>'
        "{{ figure(drawing, 'Heading.') }}{{ table([('Signal', 'what'), ('Fit', 'fit', 'n')], rows) }}</div></div>"
    )
    drawing = jinja2.filters.Markup('<svg viewBox="0 0 80 50"><text y="9">drawn</text></svg>')
    rows = [{"what": f"row{k}.", "fit": "99 %"} for k in range(5)]
    first, second = sheets(body, drawing=drawing, rows=rows)
    assert "drawn" not in first and "drawn" in second and "row0." in second


def test_two_trials_stand_on_the_first_sheet(page_of_fit, browser):
    page = browser.new_page()
    page.set_content(page_of_fit)
    pdf = pypdf.PdfReader(io.BytesIO(page.pdf(prefer_css_page_size=True)))
    page.close()
    assert pdf.pages[0].extract_text().count("Position east") == 2


def test_the_third_figure_of_a_trial_stands_at_the_left_of_a_sheet(page_of_fit, on_paper):
    """It stood below the second one, and at the top of the next sheet with nothing beside it."""
    page = on_paper(page_of_fit)
    page.evaluate("document.querySelectorAll('details').forEach(d => d.open = true)")
    left = page.evaluate(
        "[...document.querySelectorAll('.three')[0].querySelectorAll('figure')].map(f => f.offsetLeft)"
    )
    assert left[0] == left[2] < left[1]


@pytest.mark.parametrize("speeds", [3, 6])
def test_a_course_change_is_read_on_one_line_on_paper(on_paper, speeds):
    environment = jinja2.Environment(loader=jinja2.PackageLoader("shipid.report"), autoescape=True)
    columns = [(f"{k + 4}.75 m/s", f"c{k}", "n") for k in range(speeds)]
    rows = [{"change": "10", **{f"c{k}": "0.72 / 411" for k in range(speeds)}}]
    figure = jinja2.filters.Markup('<svg viewBox="0 0 80 50"></svg>')
    styles = '<!DOCTYPE html><title>t</title><style>{% include "report.css" %}{% include "paper.css" %}</style>'
    page = on_paper(
        environment.from_string(styles + '{% include "tuning/steps.html" %}').render(
            view={"columns": columns, "rows": rows, "figure": figure}
        )
    )
    lines = page.evaluate(
        "[...document.querySelectorAll('td')].map(d => { const r = document.createRange(); r.selectNode(d.firstChild);"
        "return r.getClientRects().length })"
    )
    assert set(lines) == {1} or speeds > 4
    assert page.evaluate("document.querySelector('table').getBoundingClientRect().right") <= SHEET


def test_a_matrix_of_six_coefficients_is_seen_whole_on_a_phone(fit, page_of_fit, browser):
    page = browser.new_page(viewport={"width": 390, "height": 844})
    page.set_content(page_of_fit)
    page.evaluate("document.querySelectorAll('details').forEach(d => d.open = true)")
    hidden = page.evaluate("(d => d.scrollWidth - d.clientWidth)(document.querySelector('.correlation').parentElement)")
    page.close()
    assert len(fit.estimated) == 6 and hidden <= 0
