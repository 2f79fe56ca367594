"""Trial format files: what a logger's columns are, in TOML, so that a campaign is described once.

A format file says how the text is laid out and, for each column of the vocabulary, where it is found, in which
unit and sign, and what has to be put right::

    title = "Free-running zig-zags"
    separator = "tab"          # comma, semicolon, tab, space or bar (|)
    header_lines = 3

    [columns.delta]
    index = 9                  # counted from 0; or column = "rudder angle"
    unit = "deg"
    sign = -1                  # this log turns to port with positive rudder

In a file of several tables ``[table]`` names the one that is meant: ``sheet = "Run 2"`` in a workbook, ``struct`` in a MATLAB
file, ``group`` in an HDF5 file.

``[trial]`` states the conditions of the trial for its record: loading, depth, wind, who (`shipid.trials.conditions`); ``[trials."NAME"]``
those of one log or window, where they differ.

A clock that is a date or a time of day is found out by itself; ``[clock]`` says what is not (`shipid.trials.logs.clocks.settings`).
"""

from __future__ import annotations

import codecs
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from shipid.declaration.tables import Table, is_finite, read_table
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingFileError
from shipid.trials.columns import example_unit
from shipid.trials.conditions import Conditions, conditions_of
from shipid.trials.errors import FormatFileError
from shipid.trials.logs.clocks.settings import KEYS, ClockFormat, clock_format

SEPARATORS = {"comma": ",", "semicolon": ";", "tab": "\t", "space": r"\s+", "bar": "|"}
DECIMALS = {"point": ".", "comma": ","}

_TOP = (
    "title", "source", "ship", "separator", "header_lines", "encoding", "comment", "decimal",
    "columns", "clock", "windows", "repairs", "table", "trial", "trials",
)  # fmt: skip
#: Codecs of Python that no text file is written in.
_NO_ENCODINGS = ("punycode", "idna", "unicode_escape", "raw_unicode_escape", "undefined")
_COLUMN = ("column", "index", "unit", "sign", "scale", "frame", "note")
_PARTS = ("sheet", "struct", "group")
_REPAIRS = ("heading_glitches", "trailing")
_FRAMES = {"earth": ("u", "v"), "from": ("wind_direction", "wind_direction_relative")}


@dataclass(frozen=True)
class ColumnFormat:
    """Where one column is found and how it is converted: ``inside = sign * scale * factor(unit) * value``.

    Attributes
    ----------
    name : str
        Inside the trial.
    column, index : str or None, int or None
        Its header, or its place in the row, counted from 0.
    unit : str or None
        Its unit; None is the one in the header.
    sign : {1, -1}
        -1 where the log counts it positive the other way.
    scale : float
        Factor on the printed number.
    frame : {"earth", "from"} or None
        Velocities along the earth's axes; a wind direction that says where the wind comes from.
    note : str
        What the reader should know of it.
    """

    name: str
    column: str | None = None
    index: int | None = None
    unit: str | None = None
    sign: int = 1
    scale: float = 1.0
    frame: str | None = None
    note: str = ""


@dataclass(frozen=True)
class Window:
    """A named stretch of the record.

    Attributes
    ----------
    start, end : float
        In s, by the record's own clock.
    meaning : str
        What happens in it.
    """

    start: float
    end: float
    meaning: str = ""


@dataclass(frozen=True)
class TrialFormat:
    """A trial format file, read and checked.

    Attributes
    ----------
    name : str
        The file's stem.
    columns : Mapping of str to ColumnFormat
        By name inside the trial.
    separator, decimal : str or None
        Regular expression of the separator, and the decimal sign; None is detected.
    header_lines : int
        Lines before the first sample; the last of them names the columns.
    encoding : str or None
        Text encoding; None is UTF-8, or cp1252 where that fails.
    comment : str
        What starts a comment line.
    interval : float or None
        Constant sampling interval [s] that replaces a broken clock.
    clock : ClockFormat
        How the clock is written, and its zone.
    windows : Mapping of str to Window
        Named stretches of the record.
    glitch_threshold : float or None
        Heading glitches above this are repaired [rad]; None repairs nothing.
    drop_trailing : bool
        Whether empty rows at the end are dropped.
    table : str or None
        The sheet, struct or group that holds the log, in a file of several.
    conditions : Conditions
        What is stated of the trial beside its log.
    of_one : Mapping of str to Conditions
        What is stated of one log or window alone, by its name.
    ship, source, title : str or None
        Parameter set of the ship; where the data come from; what the campaign is.
    """

    name: str
    columns: Mapping[str, ColumnFormat]
    separator: str | None = None
    decimal: str | None = None
    header_lines: int | None = None
    encoding: str | None = None
    comment: str = "#"
    interval: float | None = None
    clock: ClockFormat = field(default_factory=ClockFormat)
    windows: Mapping[str, Window] = field(default_factory=dict)
    glitch_threshold: float | None = None
    drop_trailing: bool = False
    table: str | None = None
    conditions: Conditions = field(default_factory=Conditions)
    of_one: Mapping[str, Conditions] = field(default_factory=dict)
    ship: str | None = None
    source: str | None = None
    title: str | None = None

    @property
    def repairs(self) -> bool:
        """Whether it puts anything right besides units."""
        changed = [c.sign != 1 or c.scale != 1.0 or c.frame == "earth" for c in self.columns.values()]
        return any(changed) or self.interval is not None or self.glitch_threshold is not None or self.drop_trailing


def read_format(path: str | Path) -> TrialFormat:
    """Read a trial format file.

    Parameters
    ----------
    path : str or Path
        The TOML file.

    Returns
    -------
    TrialFormat

    Raises
    ------
    MissingFileError
        If the file is not there.
    FormatFileError
        If it is not TOML, has a key that is not known, or a value that cannot be meant.
    """
    return parse_format(read_format_table(path), Path(path).stem)


def read_format_table(path: str | Path) -> Table:
    """Read the table of a trial format file, whatever it holds.

    Parameters
    ----------
    path : str or Path
        The TOML file.

    Returns
    -------
    Table

    Raises
    ------
    MissingFileError
        If the file is not there.
    """
    if not Path(path).is_file():
        raise MissingFileError(f"there is no trial format file '{path}'. Check the path; a format is a TOML file.")
    return read_table(Path(path), "format file", FormatFileError)


def parse_format(table: Table, name: str) -> TrialFormat:
    """Return the format that a table states.

    Parameters
    ----------
    table : Table
        The content of a format file without ``[nmea]``.
    name : str
        Of the format.

    Returns
    -------
    TrialFormat

    Raises
    ------
    FormatFileError
        If it has a key that is not known, or a value that cannot be meant.
    """
    table.check_keys(_TOP)
    columns = {key: _column(key, inside) for key, inside in table.table("columns").tables()}
    if not columns:
        raise table.fail("it names no columns. Write a table [columns.psi] with column or index, and unit, for each.")
    clock, repairs = table.table("clock"), table.table("repairs")
    clock.check_keys(KEYS)
    repairs.check_keys(_REPAIRS)
    interval = clock.quantity("interval", "s", positive=True)
    if interval is None and "t" not in columns:
        raise table.fail("it has no clock. Write [columns.t], or [clock] with interval = '0.1 s'.")
    _check_frames(table, columns)
    threshold = _threshold(repairs)
    if threshold is not None and not {"psi", "r"} <= set(columns):
        raise repairs.fail("'heading_glitches' integrates the rate of turn: it needs [columns.psi] and [columns.r].")
    header_lines = table.value("header_lines", int)
    if header_lines is not None and header_lines < 0:
        raise table.fail(f"'header_lines' is {header_lines}, and cannot be negative.")
    separator, decimal = table.choice("separator", SEPARATORS), table.choice("decimal", DECIMALS)
    return TrialFormat(
        name=name,
        columns=columns,
        separator=SEPARATORS[separator] if separator else None,
        decimal=DECIMALS[decimal] if decimal else None,
        header_lines=header_lines,
        interval=interval,
        clock=clock_format(clock),
        glitch_threshold=threshold,
        table=_part(table.table("table")),
        drop_trailing=repairs.choice("trailing", ("drop",)) is not None,
        **common_entries(table),
    )


def common_entries(table: Table) -> dict[str, Plain]:
    """Return the entries that every format file may have, by the attributes of `TrialFormat`.

    Parameters
    ----------
    table : Table
        The content of a format file.

    Returns
    -------
    dict of str to Plain

    Raises
    ------
    FormatFileError
        If one has a value that cannot be meant.
    """
    encoding, comment = table.value("encoding", str), table.value("comment", str, "#")
    if encoding is not None:
        try:
            known = "t".encode(encoding) and codecs.lookup(encoding).name not in _NO_ENCODINGS
        except (LookupError, ValueError):
            known = False
        if not known:
            raise table.fail(f"'encoding' is '{encoding}', which is not known. Write utf-8, cp1252 or latin-1.")
    if len(comment) != 1:
        raise table.fail(f"'comment' is {comment!r}, and has to be one character such as '#'.")
    windows = table.table("windows")
    return {
        "encoding": encoding,
        "comment": comment,
        "windows": {key: _window(windows, key) for key in windows},
        "conditions": conditions_of(table.table("trial")),
        "of_one": {name: conditions_of(one) for name, one in table.table("trials").tables()},
        **{key: table.value(key, str) for key in ("ship", "source", "title")},
    }


def sign_of(table: Table) -> int:
    """Return the entry ``sign`` of a table: 1, the default, or -1.

    Parameters
    ----------
    table : Table
        The table.

    Returns
    -------
    int

    Raises
    ------
    FormatFileError
        If it is something else.
    """
    sign = int(table.value("sign", int, 1))
    if sign not in (1, -1):
        raise table.fail(f"'sign' is {sign}, and has to be 1 or -1. A factor is written as scale.")
    return sign


def _column(name: str, table: Table) -> ColumnFormat:
    table.check_keys(_COLUMN)
    if ("column" in table) == ("index" in table):
        raise table.fail('it needs either column = "header name" or index = 3 (counted from 0).')
    index = table.value("index", int)
    if index is not None and index < 0:
        raise table.fail(f"'index' is {index}: columns are counted from 0.")
    scale = table.value("scale", float, 1.0)
    if scale <= 0:
        raise table.fail(f"'scale' is {scale:g}, and has to be greater than zero.")
    frame = table.value("frame", str)
    if frame is not None and name not in _FRAMES.get(frame, ()):
        takes = {name: key for key, names in _FRAMES.items() for name in names}
        known = f'The frame of {name} can be "{takes[name]}".' if name in takes else f"{name} takes no frame."
        raise table.fail(f"'frame' is '{frame}'. {known}")
    unit = table.value("unit", str)
    if unit is not None and not unit.strip():
        raise table.fail(
            f"'unit' is empty{_line_of_unit(table)}. Fill in the unit of {name}, as in unit = '{example_unit(name)}'."
        )
    if name == "n" and unit is not None and unit.replace(" ", "") in ("1/s", "Hz", "1/min"):
        # Propeller revolutions are counted in 1/s in most of the field's files; here the file says so itself.
        unit = "rpm" if unit.endswith("min") else "rps"
    header, note = table.value("column", str), table.value("note", str, "")
    return ColumnFormat(name, header, index, unit, sign_of(table), scale, frame, note)


def _line_of_unit(table: Table) -> str:
    """Which line of the file holds the unit of a column, as far as the file is there and written a key a line."""
    try:
        lines = Path(table.file).read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError):
        return ""
    head = next((k for k, line in enumerate(lines) if line.strip().replace(" ", "") == f"[{table.name}]"), None)
    if head is None:
        return ""
    after = next((k for k, line in enumerate(lines[head:], start=head + 1) if line.lstrip().startswith("unit")), None)
    return "" if after is None else f" in line {after}"


def _part(table: Table) -> str | None:
    """Return which table of a file is meant: a sheet, a struct or a group."""
    table.check_keys(_PARTS)
    if len(table.content) > 1:
        raise table.fail(f"it names {' and '.join(table.content)}. Name one of them: the one that holds the log.")
    return next((str(table.value(key, str)) for key in table), None)


def _check_frames(table: Table, columns: Mapping[str, ColumnFormat]) -> None:
    earth = [columns[name].frame == "earth" for name in _FRAMES["earth"] if name in columns]
    if any(earth) and len(earth) < 2:
        raise table.fail('frame = "earth" needs both velocities, [columns.u] and [columns.v].')
    if any(earth) and not (all(earth) and "psi" in columns):
        raise table.fail('frame = "earth" has to stand at both u and v, and needs [columns.psi] to rotate them.')


def _window(windows: Table, name: str) -> Window:
    span, meaning = windows.content[name], ""
    if isinstance(span, Mapping):
        table = windows.table(name)
        table.check_keys(("span", "meaning"))
        span, meaning = table.content.get("span"), table.value("meaning", str, "")
    numbers = isinstance(span, list) and len(span) == 2 and all(is_finite(bound) for bound in span)
    if not numbers or not span[0] < span[1]:
        raise windows.fail(f"'{name}' has to be [start, end] in seconds with start before end, not {span!r}.")
    return Window(float(span[0]), float(span[1]), meaning)


def _threshold(repairs: Table) -> float | None:
    """Return the heading error that counts as a glitch [rad]; ``true`` stands for one degree."""
    value = repairs.content.get("heading_glitches", False)
    if isinstance(value, bool):
        return math.radians(1.0) if value else None
    return repairs.quantity("heading_glitches", "rad", positive=True)
