from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
import pandas as pd
import pytest

from shipid.foundation.notices import Notice
from shipid.foundation.result import LINES, WIDTH, Printed, Result, csv_of, described, rested, shortened, table


@dataclass(frozen=True, eq=False, repr=False)
class Made(Result):
    """A result without words of its own."""

    t: np.ndarray = field(default_factory=lambda: np.zeros((2000, 3)))
    few: np.ndarray = field(default_factory=lambda: np.array([1.0, 0.25]))
    known: Mapping[str, float] = field(default_factory=lambda: {"K": 1.5})
    inner: Result | None = None
    warnings: tuple[Notice, ...] = ()


class Told(Made):
    """A result with words and a table."""

    def text(self) -> str:
        return "\n".join(["a <b> & c", *(f"  line {k}" for k in range(1, 40)), "x" * 500])

    def to_frame(self) -> pd.DataFrame:
        return table(
            [{"name": "K", "value": 1.23456, "std": 0.0123, "unit": "1", "interval_95": (1.2104567, 1.2586789)}], "name"
        )


def test_a_result_without_words_describes_its_fields():
    lines = repr(Made(inner=Told())).splitlines()
    assert lines[0] == "Made"
    assert lines[1].split(maxsplit=1) == ["t", "array of shape (2000, 3)"]
    assert lines[2].split(maxsplit=1) == ["few", "1, 0.25"]
    assert lines[3].split(maxsplit=1) == ["known", "K 1.5"]
    assert lines[4].split(maxsplit=1) == ["inner", "a <b> & c"]


def test_ten_lines_are_printed_and_the_rest_is_counted():
    lines = repr(Told()).splitlines()
    assert len(lines) == LINES and lines[0] == "a <b> & c" and lines[8] == "  line 8"
    assert lines[9] == "  … 32 more lines: print(….text())"
    assert Told().text().splitlines()[9 : 9 + 32] == Told().text().splitlines()[9:]
    assert str(Told()) == repr(Told())


def test_serious_warnings_are_printed_where_lines_are_left_out():
    serious = Notice("the search did not converge", "not-converged", serious=True)
    lines = repr(Told(warnings=(Notice("a remark"), serious))).splitlines()
    assert len(lines) == LINES and lines[1] == "  WARNING   the search did not converge" and lines[2] == "  line 1"
    assert lines[-1] == "  … 33 more lines: print(….text())"
    many = shortened(Told().text(), (serious,) * 30).splitlines()
    assert len(many) == LINES and sum("WARNING" in line for line in many) == LINES - 4
    said_twice = shortened(f"{Told().text()}\n  warning   {serious}", (serious,)).splitlines()
    assert sum(str(serious) in line for line in said_twice) == 1 and "33 more" in said_twice[-1]


def test_a_short_text_stays_and_a_long_line_is_cut():
    assert shortened("one\ntwo", (Notice("w", serious=True),)) == "one\ntwo"
    assert shortened("y" * 500) == "y" * (WIDTH - 1) + "…"


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (None, "None"),
        (True, "True"),
        (1234567.0, "1234570"),
        (1234567, "1234567"),
        (1.5e-7, "1.5 × 10⁻⁷"),
        ([1, 2], "1, 2"),
        (tuple(range(12)), "0, 1, 2, 3, 4, 5, 6, 7, 8, 9 and 2 more"),
        (0.25 - 2j, "0.25-2j"),
        (-0.25 + 0j, "-0.25"),
        (object(), "object"),
        ({"a": (0.5, "b")}, "a 0.5, b"),
    ],
)
def test_values_in_a_few_words(value, words):
    assert described(value) == words


def test_a_notebook_shows_warnings_the_table_and_the_rest_folded():
    serious = Notice("do not use <it>", "doubtful", serious=True)
    found = Told(warnings=(serious,))._repr_html_()
    assert "<strong>a &lt;b&gt; &amp; c</strong>" in found and "<li>do not use &lt;it&gt;</li>" in found
    # The value with the digits that its standard deviation allows; the deviation stands beside it.
    assert "<td>1.235 ± 0.012</td>" in found and "<th>std</th>" not in found and "1.210 to 1.259" in found
    assert "<details><summary>In words</summary><pre>  line 1" in found
    # Where the table is made of the fields as the text is, the text is not repeated.
    plain = Made()._repr_html_()
    assert "<th>few</th>" in plain and "<pre>" not in plain and "<details>" not in plain


@pytest.mark.parametrize(("rows", "shown"), [(49, 49), (500, 20)])
def test_a_notebook_hides_the_middle_of_a_long_table_only(rows, shown):
    class Rows(Made):
        def to_frame(self):
            return pd.DataFrame({"x": np.arange(float(rows))})

    assert Rows()._repr_html_().count("<th>") - (rows > 60) == shown + 2


def test_a_table_without_rows_keeps_its_columns():
    empty = table([], "name", ("value",))
    assert list(empty.columns) == ["value"] and empty.index.name == "name" and empty.empty


@dataclass(frozen=True)
class Entry:
    """An entry of a result that is no result itself."""

    change_deg: float
    told: str = "a word"


@dataclass(frozen=True, eq=False, repr=False)
class Along(Result):
    """A result with a table along an array."""

    TABLE = "t"
    UNITS = MappingProxyType({"t": "s", "x": "m", "heading": "rad", "ends": "rad", "response": "1"})

    t: np.ndarray = field(default_factory=lambda: np.arange(3.0))
    x: np.ndarray = field(default_factory=lambda: np.ones((3, 2)))
    response: np.ndarray = field(default_factory=lambda: np.full(3, 1 + 2j))
    heading: float = np.pi / 2
    ends: tuple[tuple[float, float], ...] = ((0.0, np.pi),)
    entries: tuple[Entry, ...] = (Entry(20.0), Entry(-20.0))
    _inner: float = 1.0


class Listed(Along):
    """A result with a row for each entry."""

    TABLE = "entries"


class InFields(Along):
    """A result whose table has a row for each field."""

    TABLE = ""


def test_a_table_runs_along_an_array_along_entries_or_over_the_fields():
    along = Along().to_frame()
    assert list(along.columns) == [
        "t [s]", "x[0] [m]", "x[1] [m]", "real part of response [1]", "imaginary part of response [1]"
    ]  # fmt: skip
    assert along["imaginary part of response [1]"].tolist() == [2.0, 2.0, 2.0]
    listed = Listed().to_frame()
    assert listed["change_deg"].tolist() == [20.0, -20.0] and listed["told"].tolist() == ["a word"] * 2
    fields = InFields().to_frame()
    assert fields.loc["heading", "value"] == np.pi / 2 and fields.loc["heading", "unit"] == "rad"
    assert "_inner" not in fields.index
    # Nothing to list: the notebook shows the words instead of an empty table.
    assert Listed(entries=()).to_frame().empty and "<pre>  t " in Listed(entries=())._repr_html_()


def test_a_person_reads_angles_in_degrees_with_their_unit():
    lines = [" ".join(line.split()) for line in InFields().text().splitlines()]
    assert "heading 90 deg" in lines and "ends (0, 180) deg" in lines and "t 0, 1, 2 s" in lines


def test_what_is_no_result_is_shown_as_it_prints():
    class Tool(Printed):
        def __repr__(self):
            return "<a tool of 'x & y'>"

    assert Tool()._repr_html_().endswith("a tool of &#x27;x &amp; y&#x27;</pre>")


def test_what_a_decay_leaves_of_a_zero_is_written_as_zero():
    frame = pd.DataFrame({"r [deg/s]": [-0.0, 4.2e-318, -1e-31, 1e-9, np.nan], "mode": list("abcde"), "n": range(5)})
    assert rested(frame)["r [deg/s]"].tolist()[:4] == [0.0, 0.0, 0.0, 1e-9]
    head, *rows = csv_of(frame, 9).splitlines()
    assert head == "r [deg/s],mode,n"
    assert rows == ["0,a,0", "0,b,1", "0,c,2", "1e-09,d,3", ",e,4"]
    assert csv_of(frame).splitlines()[1:4] == ["0.0,a,0", "0.0,b,1", "0.0,c,2"]
    assert frame["r [deg/s]"][1] == 4.2e-318, "the table itself stays as it is"


def test_units_of_a_table_stand_in_the_headers_of_its_file():
    frame = pd.DataFrame({"track": [1], "COG": [0.5]})
    frame.attrs["units"] = {"track": "1", "COG": "rad", "SOG": "m/s"}
    assert csv_of(frame).splitlines()[0] == "track,COG [rad]" and list(frame.columns) == ["track", "COG"]
