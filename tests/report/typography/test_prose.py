"""What stands between backticks is set as code."""

from __future__ import annotations

import pytest
from markupsafe import Markup

from shipid.report.typography.prose import prose


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("rows of `t` and ``psi``.", "rows of <code>t</code> and <code>psi</code>."),
        ("`a < b` & c", "<code>a &lt; b</code> &amp; c"),
        ("over `two\nlines`", "over <code>two\nlines</code>"),
        ("one ` alone", "one ‘ alone"),
    ],
)
def test_backticks_become_code(text: str, shown: str) -> None:
    assert prose(text) == Markup(shown)


@pytest.mark.parametrize("value", ["plain <b>", Markup("<b>`kept`</b>"), 3, None])
def test_everything_else_is_left_alone(value: object) -> None:
    assert prose(value) is value


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("its interval, -0.031 to 0.072", "its interval, −0.031 to 0.072"),
        ("-5", "−5"),
        ("(-1 or ± -2)", "(−1 or ± −2)"),
        ("container-10-10 and zigzag:-20/20, 2026-05-12", "container-10-10 and zigzag:-20/20, 2026-05-12"),
        ("in a format file: sign = -1.", "in a format file: sign = -1."),
        ("tune -o x --fix a=-1", "tune -o x --fix a=-1"),
    ],
)
def test_a_minus_sign_is_one(text: str, shown: str) -> None:
    assert prose(text) == shown
