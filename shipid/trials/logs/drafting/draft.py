"""Draft a format file for a log: separator, header, clock, and for each column what it is, with the reason."""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import MissingFileError
from shipid.foundation.numbers import brief
from shipid.trials import columns as spelling
from shipid.trials.errors import ColumnUnitError, HeaderError, NoTableError, RaggedRowError, TrialError
from shipid.trials.logs.clocks.headers import NAMES, find_clock, short, unit_of_time
from shipid.trials.logs.clocks.reading import read_clock
from shipid.trials.logs.drafting.names import meaning_of
from shipid.trials.logs.format import DECIMALS, SEPARATORS, TrialFormat
from shipid.trials.logs.nmea.opening import is_nmea
from shipid.trials.logs.reading import split_window
from shipid.trials.logs.tables.numerals import read_numbers
from shipid.trials.logs.tables.reading import read_table
from shipid.trials.logs.tables.table import RawTable

#: Lines that may stand above the samples of a table without a header.
_MOST_HEADER_LINES = 30
#: Angles that fields of the wind are logged as: where it comes from.
_FROM = ("wind_direction", "wind_direction_relative")


@dataclass(frozen=True)
class DraftedFormat:
    """The draft of a format file.

    Attributes
    ----------
    text : str
        In TOML.
    columns : dict of str to str
        Headers by field.
    open : tuple of str
        Fields whose unit is to be filled in.
    unused : tuple of str
        Headers that nothing explains, or that would be a second column of one field.
    undecided : tuple of str
        Headers among them that can be one of several fields, of which somebody has to choose.
    """

    text: str
    columns: dict[str, str]
    open: tuple[str, ...]
    unused: tuple[str, ...]
    undecided: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, object]:
        """Return the draft as plain values."""
        return {
            "text": self.text,
            "columns": self.columns,
            "open": list(self.open),
            "unused": list(self.unused),
            "undecided": list(self.undecided),
        }


def draft_format(path: str | Path, part: str | None = None) -> DraftedFormat:
    """Draft a format file for a log.

    Parameters
    ----------
    path : str or Path
        The log: any table that `shipid.read_trial` reads.
    part : str, optional
        The sheet, struct or group of a file of several tables.

    Returns
    -------
    DraftedFormat
        Units that nothing says are left open: `shipid.trials.logs.format.read_format` refuses the file until they are filled in.

    Raises
    ------
    MissingFileError
        If there is no such file.
    NoTableError
        If it is an NMEA log.
    TrialError
        If it cannot be read as a table.
    """
    file, sheet, _ = split_window(path)
    part = part or sheet
    if not file.is_file():
        raise MissingFileError(f"there is no file '{file}'. Check the path.")
    if is_nmea(file, part):
        raise NoTableError(
            f"'{file}' is an NMEA log, which needs no format file: leave --format out, or write one with [nmea] for what the "
            "sentences leave open."
        )
    return _Draft(_table(file, part), file.name, part).whole()


def _table(file: Path, part: str | None) -> RawTable:
    """Read a table; one whose header does not name its columns is read without."""
    try:
        return read_table(file, None, part)
    except (HeaderError, RaggedRowError) as error:
        for skip, separator in itertools.product(range(_MOST_HEADER_LINES), SEPARATORS.values()):
            try:
                raw = read_table(file, TrialFormat("draft", {}, header_lines=skip, separator=separator), part)
            except TrialError:
                continue
            if all(column.dtype.kind in "fiu" for column in raw.columns):
                return replace(
                    raw, headers=(), units=(None,) * len(raw.columns), skip=skip, notes=(*raw.notes, str(error))
                )
        raise


class _Draft:
    """Writes the draft of a table."""

    def __init__(self, raw: RawTable, name: str, part: str | None) -> None:
        self.raw, self.name, self.part = raw, name, part
        self.headers = raw.full_headers or tuple("" for _ in raw.columns)
        self.found: dict[str, str] = {}
        self.open: list[str] = []
        self.unused: list[str] = []
        self.undecided: list[str] = []

    def whole(self) -> DraftedFormat:
        clock, clock_at = self._clock()
        blocks: list[str] = []
        comments: list[str] = []
        # Surer names first, so that 'Heading' goes before 'Kurs'.
        order = sorted(range(len(self.headers)), key=lambda k: (self._doubt(k), k))
        written = {k: self._column(k) for k in order if k not in clock_at}
        for k in sorted(written):
            (blocks if written[k].startswith("[") else comments).append(written[k])
        text = "\n".join([*self._head(), "", *clock, *(f"{block}\n" for block in blocks), *comments])
        return DraftedFormat(
            text.rstrip("\n") + "\n", self.found, tuple(self.open), tuple(self.unused), tuple(self.undecided)
        )

    def _head(self) -> list[str]:
        raw = self.raw
        lines = [
            f"# Draft of a format file for {_shown(self.name)}. Check every column; rudder, rate of turn and v are positive to",
            "# starboard (sign = -1 turns one over), headings clockwise from north.",
        ]
        lines += [f"# To be filled in: the unit of {', '.join(self.open)}."] if self.open else []
        if raw.separator is not None:
            word = next((name for name, pattern in SEPARATORS.items() if pattern == raw.separator), None)
            lines += [f"separator = {json.dumps(word)}"] if word else []
            lines += [f"header_lines = {raw.skip}"] if raw.skip is not None else []
        if raw.decimal is not None and raw.separator is not None:
            lines.append(f"decimal = {json.dumps(next(w for w, sign in DECIMALS.items() if sign == raw.decimal))}")
        lines += [f"# {_shown(note)}" for note in raw.notes]
        if self.part is not None:
            lines += ["", "[table]", f"sheet = {json.dumps(self.part)}  # or struct, group"]
        return lines

    def _doubt(self, k: int) -> tuple[int, int]:
        """How much the name of a column leaves open, and how many fields it can be."""
        meaning = meaning_of(self.headers[k])
        return (0 if "the field itself" in meaning.reason else 1, len(meaning.fields) or 9)

    def _clock(self) -> tuple[list[str], tuple[int, ...]]:
        """The tables of the clock, and the columns it is written in."""
        table = {header: self._printed(k) for k, header in enumerate(self.headers) if header}
        found, others = find_clock(table)
        if not found:
            return self._no_clock()
        *beside, main = found
        at = self.headers.index(main)
        lines = ["[columns.t]", self._address(at)]
        clock: list[str] = []
        try:
            read = read_clock({header: table[header] for header in found}, self.raw.where)
        except TrialError as error:
            read = None
            clock = [f"# {_shown(str(error))}"]
        if read is None and not clock:
            unit = unit_of_time(main) or ("s" if table[main].dtype.kind == "m" else None)
            lines.append(_unit_line("t", unit, "the header says it"))
            self.open += [] if unit else ["t"]
        else:
            lines[-1] += "  # no unit: it is a date or a time"
            clock += [f"# {_shown(note)}" for note in (*read.notes, *map(str, read.faults))] if read else []
            clock += ["# zone = 'Europe/Oslo'  # where the clock is local time"]
        if beside:
            clock.append(f"date = {json.dumps(spelling.split_header(beside[0])[0])}")
        self.found["t"] = main
        self.unused += others
        tail = ["", "[clock]", *clock] if clock else []
        return [*lines, *tail, ""], tuple(self.headers.index(h) for h in (*found, *others))

    def _no_clock(self) -> tuple[list[str], tuple[int, ...]]:
        """The clock of plain numbers without a unit, by its name; or how to state one."""
        named = sorted(
            (k for k, h in enumerate(self.headers) if short(h) in NAMES),
            key=lambda k: NAMES.index(short(self.headers[k])),
        )
        self.open.append("t")
        if named:
            self.found["t"] = self.headers[named[0]]
            return [
                "[columns.t]",
                f"{self._address(named[0])}{self._range(named[0], '  # ')}",
                _unit_line("t", None, ""),
                "",
            ], (named[0],)
        return [
            "# No column is a clock for certain: name it and its unit here, or state the interval of the samples.",
            "# [columns.t]",
            '# column = "..."',
            '# unit = "s"',
            "# [clock]",
            "# interval = '0.1 s'",
            "",
        ], ()

    def _printed(self, k: int) -> pd.Series:
        """A column for the clock: numbers where its text is all numbers, however they are written."""
        column = self.raw.columns[k].reset_index(drop=True)
        if column.dtype.kind in "fiumM":
            return column
        values, strange = read_numbers(column, self.raw.decimal or ".")
        return column if strange.any() or not np.isfinite(values).any() else pd.Series(values)

    def _marked(self, k: int) -> bool:
        """Whether the cells of a column carry the sign of degrees."""
        cells = self.raw.columns[k].dropna().head(1)
        return bool(cells.astype("str").str.contains("°", regex=False).all()) and len(cells) == 1

    def _address(self, k: int) -> str:
        """Where a column is found: by its header where that names it alone, else by its place."""
        name = spelling.split_header(self.headers[k])[0]
        bare = [spelling.split_header(header)[0] for header in self.headers]
        return f"column = {json.dumps(name, ensure_ascii=False)}" if name and bare.count(name) == 1 else f"index = {k}"

    def _column(self, k: int) -> str:
        header = self.headers[k]
        name, stated = spelling.split_header(header)
        meaning, values = meaning_of(header), self._range(k)
        if not name:
            return f'# [columns.NAME]  # column {k} has no name{values}\n# index = {k}\n# unit = "..."'
        fitting = [f for f in meaning.fields if stated is None or self._fits(f, stated)] or list(meaning.fields)
        field = next((f for f in fitting if f not in self.found), None)
        if fitting and field is None:
            self.unused.append(header)
            return (
                f"# {_shown(header)} would be {fitting[0]} again, which is {_shown(self.found[fitting[0]])}: left out."
            )
        if len(fitting) > 1 or meaning.doubtful:
            self.unused.append(header)
            self.undecided.append(name)
            tables = [f"# [columns.{f}]" for f in fitting]
            said = [unit for unit in (stated, meaning.unit) if unit and any(self._fits(f, unit) for f in fitting)]
            written = json.dumps(said[0] if said else "...", ensure_ascii=False)
            return "\n".join(
                [
                    f"# {_shown(meaning.reason)}{values}: take the # away where it is.",
                    *tables,
                    f"# {self._address(k)}",
                    f"# unit = {written}",
                ]
            )
        if field is None and not (stated and self._fits(name, stated)):
            self.unused.append(header)
            return f"# {_shown(header) or f'column {k}'} is not used{values}. A field of its own is [columns.NAME], with a unit."
        field = field or name
        reason = meaning.reason or "a column of its own"
        self.found[field] = header
        if field in _FROM:
            reason += '; frame = "from" where it says where the wind comes from'
        fits = stated is not None and self._fits(field, stated)
        unit = stated if fits else meaning.unit if meaning.unit and self._fits(field, meaning.unit) else None
        why = "the header says it" if fits else "the name says it"
        if unit is None and self._fits(field, "deg") and self._marked(k):
            unit, why = "deg", "the cells say it"
        if unit is None:
            self.open.append(field)
        wrong = f" (not {_shown(stated)}, which does not fit)" if stated and not fits else ""
        lines = [
            f"[columns.{_key(field)}]",
            f"{self._address(k)}  # {_shown(reason)}{values}",
            _unit_line(field, unit, why, wrong),
        ]
        return "\n".join(lines)

    @staticmethod
    def _fits(name: str, unit: str) -> bool:
        try:
            return bool(spelling.to_inside(name, unit))
        except ColumnUnitError:
            return False

    def _range(self, k: int, before: str = ", ") -> str:
        """The values of a column of numbers, for a comment."""
        numbers = pd.to_numeric(self._printed(k), errors="coerce").to_numpy(dtype=float, na_value=np.nan)
        known = numbers[np.isfinite(numbers)]
        return f"{before}{brief(known.min(), 4)} to {brief(known.max(), 4)}" if known.size else ""


def _unit_line(field: str, unit: str | None, why: str, wrong: str = "") -> str:
    if unit is not None:
        return f"unit = {json.dumps(unit, ensure_ascii=False)}  # {why}"
    choices = (
        dict.fromkeys((FIELDS[field].display, FIELDS[field].unit)) if field in FIELDS else {"deg": None, "rad": None}
    )
    return f'unit = ""  # fill in: {" or ".join(choices)} or another; nothing says it{wrong}'


def _key(name: str) -> str:
    return (
        name
        if name.replace("_", "").replace("-", "").isalnum() and name.isascii()
        else json.dumps(name, ensure_ascii=False)
    )


def _shown(text: str) -> str:
    """Text for a comment of one line."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))
