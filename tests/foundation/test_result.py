from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
import pytest

from shipid.foundation.notices import Notice
from shipid.foundation.result import LINES, WIDTH, Printed, Result, described, shortened, table


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


def test_a_short_text_stays_and_a_long_line_is_cut():
    assert shortened("one\ntwo", (Notice("w", serious=True),)) == "one\ntwo"
    assert shortened("y" * 500) == "y" * (WIDTH - 1) + "…"


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (None, "None"),
        (True, "True"),
        (1234567.0, "1.23457e+06"),
        ([1, 2], "1, 2"),
        (tuple(range(12)), "0, 1, 2, 3, 4, 5, 6, 7, 8, 9 and 2 more"),
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
    assert "<td>1.235 ± 0.012</td>" in found and "<th>std</th>" not in found and "1.21046, 1.25868" in found
    assert "<details><summary>In words</summary><pre>  line 1" in found
    plain = Made()._repr_html_()
    assert "<pre>  t " in plain and "<details>" not in plain


def test_a_table_without_rows_keeps_its_columns():
    empty = table([], "name", ("value",))
    assert list(empty.columns) == ["value"] and empty.index.name == "name" and empty.empty


def test_what_is_no_result_is_shown_as_it_prints():
    class Tool(Printed):
        def __repr__(self):
            return "<a tool of 'x & y'>"

    assert Tool()._repr_html_().endswith("a tool of &#x27;x &amp; y&#x27;</pre>")
