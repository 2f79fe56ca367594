"""Names, units and samples of a table are found among titles, groups and remarks."""

import pytest

from shipid.trials.errors import HeaderError
from shipid.trials.logs.tables.header_rows import find_heading, sort_of

ROWS = [[f"{0.5 * k}", f"{10 + k}.25", "-5"] for k in range(12)]
NAMES, UNITS = ["t", "psi", "delta"], ["s", "deg", "deg"]


@pytest.mark.parametrize(
    ("above", "row", "units", "unused"),
    [
        ([NAMES], 0, (None, None, None), ()),
        ([NAMES, UNITS], 0, ("s", "deg", "deg"), ()),
        ([NAMES, ["[s]", "[deg]", "(°)"]], 0, ("s", "deg", "°"), ()),
        ([NAMES, ["s", "deg", "-"]], 0, ("s", "deg", "1"), ()),
        ([NAMES, ["hh:mm:ss", "deg", ""]], 0, (None, "deg", None), ()),
        ([["Clock", "Gyro", "Rudder"], NAMES, UNITS], 1, ("s", "deg", "deg"), (0,)),
        ([NAMES, ["time", "heading", "angle"], UNITS], 0, ("s", "deg", "deg"), (1,)),
        ([["time", "heading", "angle"], UNITS, ["Logger", "Gyro 1", "Feedback"]], 0, ("s", "deg", "deg"), (2,)),
        ([["time", "heading", "angle"], ["Logger", "Gyro", "Gyro"]], 0, (None, None, None), (1,)),
        ([["Sea trial"], ["Ship", "A"], ["Date", "2026-05-01", ""], NAMES], 3, (None, None, None), (0, 1, 2)),
        ([["Draught", "5.7", "6.1"], ["t [s]", "psi [deg]", "delta [deg]"]], 1, (None, None, None), (0,)),
    ],
)
def test_rows_above_the_samples(above, row, units, unused):
    heading = find_heading([*above, *ROWS], set(), "'log'")
    assert (heading.first, heading.width, heading.row) == (len(above), 3, row)
    assert heading.units == units and heading.unused == unused and heading.names[0].startswith("t")


def test_names_of_a_format_file_are_the_header():
    rows = [["Zeit", "Kurs", "Ruder"], ["Clock", "Gyro", "Angle"], *ROWS]
    assert find_heading(rows, {"Kurs"}, "'log'").row == 0
    assert find_heading(rows, set(), "'log'").row == 1


def test_a_bad_cell_in_the_first_sample_does_not_make_it_a_header():
    rows = [NAMES, ["0.0", "broken", "-5"], *ROWS]
    assert find_heading(rows, set(), "'log'").first == 1


def test_samples_may_begin_with_holes_and_have_texts_beside():
    rows = [[*NAMES, "remark"], ["0.0", "", "", "start"], *([*row, ""] for row in ROWS)]
    heading = find_heading(rows, set(), "'log'")
    assert heading.first == 1 and heading.width == 4


def test_a_unit_beside_the_name_and_another_below_it_are_refused():
    rows = [["t [s]", "psi [rad]", "delta"], UNITS, *ROWS]
    with pytest.raises(HeaderError, match="column 'psi' says the unit rad beside its name and deg in the row of units"):
        find_heading(rows, set(), "'log'")


def test_no_row_of_numbers():
    assert find_heading([NAMES, UNITS], set(), "'log'") is None
    assert find_heading([], set(), "'log'") is None
    assert find_heading(ROWS, set(), "'log'").row is None


@pytest.mark.parametrize(
    ("cell", "sort"),
    [
        ("1.002,5", "number"), (3, "number"), (None, "empty"), (" - ", "empty"), ("2026-05-01T12:00:00.5Z", "stamp"),
        ("01.05.2026 12:00", "stamp"), ("12:00:01", "stamp"), ("1-May-2026", "stamp"), ("psi", "text"), (True, "text"), ("1_000", "text"),
    ],
)  # fmt: skip
def test_what_a_cell_holds(cell, sort):
    assert sort_of(cell) == sort
