"""What a trial sheet is on paper: what stands on one sheet, and what is neither cut nor too small to read."""

from __future__ import annotations

import shutil

import jinja2
import pypdf
import pytest
from markupsafe import Markup

from shipid.report.pdf import write_pdf

STYLES = '<!DOCTYPE html><title>t</title><style>{% include "report.css" %}{% include "paper.css" %}</style>'


def page_of(body, **view):
    """Return a body with the styles of a report."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("shipid.report"), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    return environment.from_string(STYLES + body).render(**view)


@pytest.fixture
def sheets(tmp_path):
    """Print a body with the styles of a report, and return the text of each sheet."""
    if shutil.which("chromium") is None:
        pytest.skip("no Chromium on this machine")

    def printed(body, **view):
        (tmp_path / "page.html").write_text(page_of(body, **view), encoding="utf-8")
        write_pdf(tmp_path / "page.html", tmp_path / "page.pdf")
        return [p.extract_text() for p in pypdf.PdfReader(tmp_path / "page.pdf").pages]

    return printed


@pytest.fixture
def on_paper(browser):
    """Show a body with the styles of a report as on a sheet, and return what a script says of it."""

    def asked(script, body, **view):
        page = browser.new_page(viewport={"width": 680, "height": 960})  # the width of a sheet between its margins
        page.set_content(page_of(body, **view))
        page.emulate_media(media="print")
        told = page.evaluate(script)
        page.close()
        return told

    return asked


def figure_of(width, height):
    return Markup(f'<svg viewBox="0 0 {width} {height}"></svg>')


def manoeuvre(title, stages, rows, notes=()):
    """The view of a manoeuvre with a plot as high as that of a zig-zag, with these numbers of rows."""
    heads = ["Reversal", "Execute [s]", "Heading [deg]", "Overshoot [deg]", "± [deg]", "Extreme [deg]", "Check yaw [s]"]
    columns = [(head, head, "n" if k else "") for k, head in enumerate(heads)]
    return {
        "title": title,
        "trial": "zigzag-20-20",
        "simulated": True,
        "read_from": "the order, as logged every 0.2 s (between two samples, the ramp of the rudder)",
        "figure": figure_of(338, 216),
        "caption": "Heading and rudder; each overshoot is marked. The tables count time from the beginning of the record.",
        "columns": [("Quantity", "name"), ("Measured", "value", "n"), ("Meaning", "meaning", "wide")],
        "rows": [{"name": "Initial turning distance", "value": "425 m (1.88 L)", "meaning": "Track"}] * rows,
        "parts": {
            "columns": columns,
            "rows": [dict.fromkeys(heads, "−20.38") | {"Reversal": str(k + 1)} for k in range(stages)],
            "reasons": [],
        },
        "notes": list(notes),
    }


def test_two_zigzags_of_eight_reversals_stand_on_one_sheet(sheets):
    """Each stood on a sheet of its own, and left half of it empty."""
    view = {"manoeuvres": [manoeuvre(f"zig-zag {k}", 8, 11) for k in (1, 2)], "meanings": []}
    first = sheets(
        '<section class="sheet"><h2>Manoeuvres</h2>{% include "sheet/manoeuvres.html" %}</section>', view=view
    )[0]
    assert "zig-zag 1" in first and "zig-zag 2" in first


def test_what_is_said_below_a_manoeuvre_stays_with_it(sheets):
    """What is not known of a circle stood alone at the head of the next sheet."""
    cases = {k: manoeuvre(f"circle {k}.", 0, 14, [f"Not known of {k}"]) for k in range(12)}
    body = (
        '<section class="sheet">{% for k, m in cases.items() %}<div style="break-before: page; height: {{ 120 + 5 * k }}mm"></div>'
        '{% set view = {"manoeuvres": [m], "meanings": []} %}{% include "sheet/manoeuvres.html" %}{% endfor %}</section>'
    )
    printed = sheets(body, cases=cases)
    for k in cases:
        assert [f"Not known of {k}." in text for text in printed] == [f"circle {k}." in text for text in printed]


def test_a_table_beside_a_figure_is_whole_on_paper(on_paper):
    """The last column of the coefficients over several trials was cut off at the edge of the sheet."""
    columns = [("Coefficient", "what"), *((f"Number {k}", "value", "keep") for k in range(5))]
    body = '{% from "macros.html" import beside, table %}{% call beside(drawing, "Caption.") %}{{ table(columns, rows) }}{% endcall %}'
    right = on_paper(
        "[...document.querySelectorAll('table, svg')].map(t => t.getBoundingClientRect().right)",
        body,
        drawing=figure_of(338, 300),
        columns=columns,
        rows=[{"what": "K", "value": "1.61 ± 0.01"}] * 3,
    )
    assert max(right) <= 680 and right[0] < right[1], "the figure is smaller"


def test_the_last_sheet_holds_more_than_the_footer(sheets):
    """The versions of a study over several trials filled the first sheet, and the second had the command alone."""
    body = (
        '{% for k in range(12) %}<div style="break-before: page; height: {{ 224 + 2 * k }}mm"></div><section><h2>Provenance</h2>'
        '<div class="scroll"><table><tr><td>a</td></tr><tr><td>b</td></tr><tr><td>row {{ k }}.</td></tr></table></div></section><footer><p>end {{ k }}.</p></footer>{% endfor %}'
    )
    printed = sheets(body)
    for k in range(12):
        assert [f"end {k}." in text for text in printed] == [f"row {k}." in text for text in printed]


def test_what_the_numbers_mean_is_a_list_on_paper():
    view = {"manoeuvres": [], "meanings": ["Advance: along the course", "Advance in still water: the same"]}
    text = page_of('{% include "sheet/manoeuvres.html" %}', view=view)
    assert text.count("<li>") == 2 and "<li>Advance: along the course.</li>" in text
