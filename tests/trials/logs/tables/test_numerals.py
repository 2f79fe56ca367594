"""Numbers as people write them: read in the one way that is possible, or refused."""

import numpy as np
import pandas as pd
import pytest

from shipid.trials.errors import AmbiguousNumberError
from shipid.trials.logs.tables.numerals import is_missing, is_number, read_numbers, sign_of_file


def values(*cells: str | None, seen=None):
    column = pd.Series(cells, name="x [m]")
    numbers, strange = read_numbers(column, sign_of_file([column], seen, "'log.csv'"))
    return numbers.tolist(), strange.tolist()


@pytest.mark.parametrize(
    ("cells", "numbers"),
    [
        (("1.002,564", "998,5", "-0,25"), (1002.564, 998.5, -0.25)),
        (("1,002.56", "998.5", "-1,234,567.0"), (1002.56, 998.5, -1234567.0)),
        (("1'002.5", "998.5"), (1002.5, 998.5)),
        (("1’002,5", "998,5"), (1002.5, 998.5)),
        (("1 002,5", "1\u00a0002,5", "1\u202f002,5", "998,5"), (1002.5, 1002.5, 1002.5, 998.5)),
        (("1.5D+03", "-2.0d-1", "3.0E2", "1.5-101", "4D0"), (1500.0, -0.2, 300.0, 1.5e-101, 4.0)),
        (("\u22123.5", "+4.25", " 5. ", ".5"), (-3.5, 4.25, 5.0, 0.5)),
        (("1.234.567", "998"), (1234567.0, 998.0)),
        (("0,6", "1,234"), (0.6, 1.234)),
        (("1,002.5", "1,234"), (1002.5, 1234.0)),
        (("1.000", "1.500"), (1.0, 1.5)),
    ],
)
def test_one_way_to_read_them(cells, numbers):
    found, strange = values(*cells)
    assert found == pytest.approx(numbers, rel=1e-12) and not any(strange)


@pytest.mark.parametrize("cells", [("1,234",), ("1,234", "998"), ("1.002", "998", "1.010"), ("12,500", "12,600")])
def test_two_ways_to_read_them_are_refused(cells):
    with pytest.raises(AmbiguousNumberError, match=r"'x \[m\]'.*can be .*State decimal = 'comma' or decimal = 'point'"):
        values(*cells)


def test_a_sign_that_is_known_decides():
    assert values("1,234", "998", seen=".")[0] == [1234.0, 998.0]
    assert values("1,234", "998", seen=",")[0] == [1.234, 998.0]


def test_a_column_of_thousands_only_is_refused_even_beside_numbers_with_a_sign():
    with pytest.raises(AmbiguousNumberError, match=r"'59.123' can be 59123 or 59.123"):
        values("59.123", "59.124", seen=",")


@pytest.mark.parametrize(
    "cell",
    [
        "1_000",
        "0x1f",
        "１２",
        "1.2.3",
        "12,34,56",
        "1.5.",
        "--5",
        "5-",
        "1e",
        "eleven",
        "12:30",
        "#####",
        "**",
        "1 2",
        "0 350",
        "True",
    ],
)
def test_what_is_no_number(cell):
    assert not is_number(cell)
    found, strange = values("0.5", cell)
    assert strange == [False, True] and np.isnan(found[1])


@pytest.mark.parametrize(
    "cell", ["", " ", "-", "--", "NaN", "nan", "NA", "N/A", "#N/A", "null", "NULL", "None", "#DIV/0!", "<NA>", "ovf"]
)
def test_marks_of_a_missing_sample(cell):
    assert is_missing(cell)
    found, strange = values("0.5", cell)
    assert strange == [False, False] and np.isnan(found[1])


def test_a_typing_error_is_no_thousand():
    """A comma for a point in a column that writes decimals and no thousands, or thousands without a sign."""
    assert values("35.25", "35,012", "36.1")[1] == [False, True, False]
    assert values("1234.5", "1,235", "0.5")[1] == [False, True, False]
    assert values("1,002.56", "35,012", "998.1")[0] == [1002.56, 35012.0, 998.1]


def test_the_many_decide_where_both_signs_are_there():
    found, strange = values("350.1", "350,2", "350.3")
    assert strange == [False, True, False] and found[::2] == [350.1, 350.3]


def test_numbers_without_end():
    # Older pandas reads the first as no number; either is a missing sample later.
    first, second, third = values("1e400", "-inf", "0.5")[0]
    assert not np.isfinite(first) and second == -np.inf and third == 0.5
