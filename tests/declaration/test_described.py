"""A model as a terminal and a notebook show it."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import pytest

from shipid.declaration.described import model_html
from shipid.declaration.quantity import state
from shipid.parameters.catalogue import find_model


@pytest.mark.parametrize("name", ["nomoto", "mmg", "own-ship-filter"])
def test_a_model_prints_in_ten_lines(name: str) -> None:
    lines = repr(find_model(name)).splitlines()
    assert len(lines) <= 10 and max(map(len, lines)) <= 160
    assert lines[0].startswith(f"Model {name}: ") and "[rad/s]" in lines[1]


def test_what_does_not_fit_in_a_line_is_counted() -> None:
    model = find_model("mmg")
    line = next(one for one in repr(model).splitlines() if one.strip().startswith("parameters"))
    named, _, rest = line.rpartition(" and ")
    assert len(named.split(", ")) + int(rest.split()[0]) == len(model.parameters)


def test_a_notebook_shows_equations_and_units() -> None:
    model = find_model("nomoto")
    shown = model._repr_html_()
    root = ET.fromstring(shown.replace("<br>", "<br/>"))
    assert len(root.findall("./ul/li")) == len([e for e in model.entries.values() if e.equation])
    assert all(li.find(".//math") is not None for li in root.iter("li"))
    rows = {cells[1]: cells for row in root.iter("tr") if len(cells := ["".join(c.itertext()) for c in row]) == 4}
    assert rows["K"][2:] == ["1/s", "rate of turn per rudder angle"]
    assert rows["delta"][0] == "inputs" and rows["delta"][2] == "rad"


def test_words_of_a_declaration_are_no_markup() -> None:
    declared = state("m/s", "speed <of> the ship")
    assert "speed &lt;of&gt; the ship" in model_html("a<b", ["C"], [declared], [])
    assert "a&lt;b" in model_html("a<b", ["C"], [declared], [])
