"""Trial format files: what a logger's columns are, in TOML, so that a campaign is described once.

A format file says how the text is laid out and, for each column of the vocabulary, where it is found, in which
unit and sign, and what has to be put right::

    title = "Free-running zig-zags"
    separator = "tab"          # comma, semicolon, tab or space
    header_lines = 3

    [columns.delta]
    index = 9                  # counted from 0; or column = "rudder angle"
    unit = "deg"
    sign = -1                  # this log turns to port with positive rudder
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from shipid.declaration import units
from shipid.foundation.errors import MissingFileError, UnitError, nearest
from shipid.trials.errors import FormatFileError

SEPARATORS = {"comma": ",", "semicolon": ";", "tab": "\t", "space": r"\s+"}
DECIMALS = {"point": ".", "comma": ","}

_TOP = (
    "title", "source", "ship", "separator", "header_lines", "encoding", "comment", "decimal",
    "columns", "clock", "windows", "repairs",
)  # fmt: skip
_COLUMN = ("column", "index", "unit", "sign", "scale", "frame", "note")
_REPAIRS = ("heading_glitches", "trailing")
_FRAMES = {"earth": ("u", "v"), "from": ("wind_direction", "wind_direction_relative")}


@dataclass(frozen=True)
class ColumnFormat:
    """Where one column is found and how it is converted: ``inside = sign * scale * factor(unit) * value``."""

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
    """A named stretch of the record [s, the record's own clock], and what happens in it."""

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
    windows : Mapping of str to Window
        Named stretches of the record.
    glitch_threshold : float or None
        Heading glitches above this are repaired [rad]; None repairs nothing.
    drop_trailing : bool
        Whether empty rows at the end are dropped.
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
    windows: Mapping[str, Window] = field(default_factory=dict)
    glitch_threshold: float | None = None
    drop_trailing: bool = False
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
    path = Path(path)
    if not path.is_file():
        raise MissingFileError(f"there is no trial format file '{path}'. Check the path; a format is a TOML file.")
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FormatFileError(f"the format file '{path}' is not readable TOML: {error}.") from None
    return _Parser(path).parse(content)


class _Parser:
    """Turns the content of a format file into a `TrialFormat`; every complaint names file and key."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def fail(self, message: str) -> FormatFileError:
        return FormatFileError(f"format file '{self.path}': {message}")

    def check_keys(self, table: Any, known: Iterable[str], where: str) -> None:
        if not isinstance(table, dict):
            raise self.fail(f"{where} is {table!r}, and must be a table with keys {', '.join(known)}.")
        for key in table:
            if key not in known:
                raise self.fail(f"{where} has no key '{key}'. {nearest(key, known)}".rstrip())

    def typed(self, table: dict[str, Any], key: str, kind: type | tuple[type, ...], where: str, default: Any) -> Any:
        value = table.get(key, default)
        wrong = not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool)
        if key in table and wrong:
            expected = {str: "text", int: "a whole number", bool: "true or false"}.get(kind, "a number")  # type: ignore[arg-type]
            raise self.fail(f"{where}{key} is {value!r}, and must be {expected}.")
        return value

    def choice(self, content: dict[str, Any], key: str, choices: Mapping[str, str]) -> str | None:
        value = self.typed(content, key, str, "", None)
        if value is not None and value not in choices:
            raise self.fail(f"{key} is '{value}'. Write one of {', '.join(choices)}.")
        return None if value is None else choices[value]

    def quantity(self, value: Any, wanted: str, what: str) -> float:
        if not isinstance(value, (str, int, float)) or isinstance(value, bool):
            raise self.fail(f"{what} is {value!r}. Write a value with its unit, as text.")
        try:
            result = units.to_si(value, wanted, what)
        except UnitError as error:
            raise self.fail(str(error)) from None
        if not result > 0:
            raise self.fail(f"{what} is {value!r}, and must be positive.")
        return result

    def parse(self, content: dict[str, Any]) -> TrialFormat:
        self.check_keys(content, _TOP, "the file")
        columns = {name: self.column(name, table) for name, table in self.section(content, "columns").items()}
        if not columns:
            raise self.fail(
                "it names no columns. Write a table [columns.psi] with column or index, and unit, for each."
            )
        clock = self.section(content, "clock")
        self.check_keys(clock, ("interval", "note"), "[clock]")
        interval = self.quantity(clock["interval"], "s", "clock.interval") if "interval" in clock else None
        if interval is None and "t" not in columns:
            raise self.fail("it has no clock. Write [columns.t], or [clock] with interval = '0.1 s'.")
        if ("u" in columns) != ("v" in columns) and any(c.frame == "earth" for c in columns.values()):
            raise self.fail('frame = "earth" needs both velocities, [columns.u] and [columns.v].')
        earth = {c.frame for name, c in columns.items() if name in _FRAMES["earth"]}
        if "earth" in earth and (len(earth) > 1 or "psi" not in columns):
            raise self.fail('frame = "earth" must stand at both u and v, and needs [columns.psi] to rotate them.')
        repairs = self.section(content, "repairs")
        self.check_keys(repairs, _REPAIRS, "[repairs]")
        if repairs.get("trailing", "drop") != "drop":
            raise self.fail(f"repairs.trailing is {repairs['trailing']!r}. Write 'drop', or leave it out.")
        threshold = self.threshold(repairs.get("heading_glitches", False))
        if threshold is not None and not {"psi", "r"} <= set(columns):
            raise self.fail(
                "repairs.heading_glitches integrates the rate of turn: it needs [columns.psi] and [columns.r]."
            )
        header_lines = self.typed(content, "header_lines", int, "", None)
        if header_lines is not None and header_lines < 0:
            raise self.fail(f"header_lines is {header_lines}, and cannot be negative.")
        return TrialFormat(
            name=self.path.stem,
            columns=columns,
            separator=self.choice(content, "separator", SEPARATORS),
            decimal=self.choice(content, "decimal", DECIMALS),
            header_lines=header_lines,
            encoding=self.encoding(self.typed(content, "encoding", str, "", None)),
            comment=self.comment(self.typed(content, "comment", str, "", "#")),
            interval=interval,
            windows={name: self.window(name, value) for name, value in self.section(content, "windows").items()},
            glitch_threshold=threshold,
            drop_trailing="trailing" in repairs,
            **{key: self.typed(content, key, str, "", None) for key in ("ship", "source", "title")},
        )

    def section(self, content: dict[str, Any], key: str) -> dict[str, Any]:
        value = content.get(key, {})
        if not isinstance(value, dict):
            raise self.fail(f"{key} is {value!r}, and must be a table [{key}].")
        return value

    def column(self, name: str, table: Any) -> ColumnFormat:
        where = f"[columns.{name}]"
        self.check_keys(table, _COLUMN, where)
        if ("column" in table) == ("index" in table):
            raise self.fail(f'{where} needs either column = "header name" or index = 3 (counted from 0).')
        header = self.typed(table, "column", str, where + " ", None)
        index = self.typed(table, "index", int, where + " ", None)
        if index is not None and index < 0:
            raise self.fail(f"{where} index is {index}: columns are counted from 0.")
        sign = self.typed(table, "sign", int, where + " ", 1)
        if sign not in (1, -1):
            raise self.fail(f"{where} sign is {sign}, and must be 1 or -1. A factor is written as scale.")
        scale = float(self.typed(table, "scale", (int, float), where + " ", 1.0))
        if not math.isfinite(scale) or scale <= 0:
            raise self.fail(f"{where} scale is {scale:g}, and must be a positive number.")
        frame = self.typed(table, "frame", str, where + " ", None)
        if frame is not None and name not in _FRAMES.get(frame, ()):
            takes = {name: key for key, names in _FRAMES.items() for name in names}
            known = f'The frame of {name} can be "{takes[name]}".' if name in takes else f"{name} takes no frame."
            raise self.fail(f"{where} frame is '{frame}'. {known}")
        unit = self.typed(table, "unit", str, where + " ", None)
        if name == "n" and unit is not None and unit.replace(" ", "") in ("1/s", "Hz", "1/min"):
            # Propeller revolutions are counted in 1/s in most of the field's files; here the file says so itself.
            unit = "rpm" if unit.endswith("min") else "rps"
        note = self.typed(table, "note", str, where + " ", "")
        return ColumnFormat(name, header, index, unit, sign, scale, frame, note)

    def window(self, name: str, value: Any) -> Window:
        meaning = ""
        if isinstance(value, dict):
            self.check_keys(value, ("span", "meaning"), f"[windows.{name}]")
            meaning, value = self.typed(value, "meaning", str, f"windows.{name}.", ""), value.get("span")
        numbers = isinstance(value, list) and len(value) == 2 and all(type(v) in (int, float) for v in value)
        if not numbers or not value[0] < value[1]:
            raise self.fail(f"windows.{name} must be [start, end] in seconds with start before end, not {value!r}.")
        return Window(float(value[0]), float(value[1]), meaning)

    def threshold(self, value: Any) -> float | None:
        if value is False:
            return None
        return math.radians(1.0) if value is True else self.quantity(value, "rad", "repairs.heading_glitches")

    def encoding(self, value: str | None) -> str | None:
        if value is not None:
            try:
                "".encode(value)
            except LookupError:
                raise self.fail(f"encoding '{value}' is not known. Write utf-8, cp1252 or latin-1.") from None
        return value

    def comment(self, value: str) -> str:
        if len(value) != 1:
            raise self.fail(f"comment is {value!r}, and must be one character such as '#'.")
        return value
