"""A table as it is written: the header is read as that of a whole log, and then every row by itself."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from shipid.declaration.vocabulary import FIELDS
from shipid.trials import columns as headers
from shipid.trials.errors import EmptyFileError, TrialError
from shipid.trials.logs.clocks.formatted import clock_columns
from shipid.trials.logs.clocks.settings import ClockFormat
from shipid.trials.logs.format import SEPARATORS, TrialFormat
from shipid.trials.logs.geodesy import to_local
from shipid.trials.logs.live.cells import LetteredCells, clock_columns_of, plain_number
from shipid.trials.logs.live.clock import RunningClock
from shipid.trials.logs.naming import by_format, by_header
from shipid.trials.logs.positions import pair_of, with_degrees
from shipid.trials.logs.tables.cell_units import number_and_unit, same_unit, stated_units, unit_of_cell
from shipid.trials.logs.tables.files.text_fields import fields
from shipid.trials.logs.tables.files.text_layout import TextLayout, lay_out
from shipid.trials.logs.tables.header_rows import is_sample_row
from shipid.trials.logs.tables.lettered import may_be_lettered, read_lettered
from shipid.trials.logs.tables.numerals import Decimal, certain_sign, is_missing, read_numbers
from shipid.trials.missing_marks import LARGEST

#: So many lines may stand before the first sample.
_HEAD = 200
#: So many samples may be needed to know what kind of clock a log has.
_FIRST = 3
#: Numbers that need no second look, by the decimal sign.
_PLAIN = {sign: re.compile(rf"[-+]?[0-9]+(\{sign}[0-9]*)?([eE][-+]?[0-9]{{1,3}})?") for sign in (".", ",")}


class LiveSample(NamedTuple):
    """A sample, SI.

    Attributes
    ----------
    line : int
        Where it stands.
    values : dict of str to float
        ``t`` and the channels; NaN where one is missing.
    """

    line: int
    values: dict[str, float]


class LiveTable:
    """A table as it is written.

    Parameters
    ----------
    fmt : TrialFormat or None
        What is known of its columns.
    where : str
        The log, for messages.
    tell : callable
        Takes what there is to say of a line.

    Attributes
    ----------
    names : tuple of str
        The channels, once the header was read.
    units : dict of str to str
        The unit in which the log holds a channel.
    """

    def __init__(self, fmt: TrialFormat | None, where: str, tell: Callable[[str], None]) -> None:
        self.names: tuple[str, ...] = ()
        self.units: dict[str, str] = {}
        self._fmt, self._where, self._tell = fmt, where, tell
        self._comment = fmt.comment if fmt else "#"
        self._head: list[str] = []
        self._waiting: list[tuple[int, list[str]]] = []
        self._layout: TextLayout | None = None
        self._clock: RunningClock | None = None
        self._clock_at: tuple[int, ...] = ()
        self._join: Callable[[Sequence[str]], list[str]] = list
        self._letters: dict[int, LetteredCells] = {}
        self._headers: tuple[str, ...] = ()
        self._units_of_cells: dict[int, str] = {}
        self._sign: Decimal | None = None
        sign = re.escape(self._comment)
        self._remark = re.compile(rf"(?:^|\s){sign}(?![A-Z0]+[/!?]|NA|NV).*")  # #N/A, #DIV/0! are cells
        self._channels: dict[str, tuple[int, float]] = {}
        self._pair: tuple[str, ...] = ()
        self._origin: tuple[float, float] | None = None
        self._before: list[str] = []
        self._count = self._tried = 0

    def take(self, number: int, line: str) -> Iterator[LiveSample]:
        """Yield the samples that a line completes.

        Parameters
        ----------
        number : int
            Of the line, counted from 1.
        line : str
            The line.

        Yields
        ------
        LiveSample

        Raises
        ------
        TrialError
            If the header cannot be read as that of a log.
        """
        if self._layout is None:
            self._head.append(line.rstrip("\r\n"))
            if not self._head_is_whole():
                return
            self._tried += 1
            try:
                self._layout = self._lay_out()
            except TrialError:  # one sample may be too few to tell a header from a row of units
                if self._tried >= _FIRST:
                    raise
                return
            for k, text in enumerate(self._head[self._layout.skip :], start=self._layout.skip + 1):
                yield from self._row(k, text)
            return
        yield from self._row(number, line)

    def end(self) -> Iterator[LiveSample]:
        """Yield the samples that were held back until more was known.

        Yields
        ------
        LiveSample

        Raises
        ------
        EmptyFileError
            If the log has ended before its header was read.
        TrialError
            If the header cannot be read.
        """
        if self._layout is None:
            if not any(line.strip() and not self._is_comment(line) for line in self._head):
                raise EmptyFileError(
                    f"{self._where} holds no header. Write one with units first: 't [s], psi [deg], delta [deg]'."
                )
            self._layout = self._lay_out()
        if self._waiting:
            yield from self._begin(last=True)

    def _is_comment(self, line: str) -> bool:
        return line.lstrip().startswith(self._comment)

    def _head_is_whole(self) -> bool:
        """Whether the first sample has come: a row with numbers or a time in it."""
        if len(self._head) >= _HEAD:
            return True
        skip = self._fmt.header_lines if self._fmt is not None else None
        if skip is not None:
            return len(self._head) > skip and bool(self._head[-1].strip()) and not self._is_comment(self._head[-1])
        lines = [line for line in self._head if line.strip() and not self._is_comment(line)]
        # NumPy writes the header as a comment.
        needed = (
            1
            if len(lines) < len([line for line in self._head if line.strip()])
            and bool(lines)
            and is_sample_line(lines[-1])
            else 2
        )
        return len(lines) >= needed and bool(lines) and is_sample_line(lines[-1])

    def _lay_out(self) -> TextLayout:
        """Lay out the head as that of a file."""
        layout = lay_out("\n".join(self._head).encode("utf-8", "replace"), Path(self._where), self._fmt)
        self._sign = layout.decimal
        if layout.headers and any(layout.units):
            pairs = zip(layout.headers, layout.units)
            self._headers = tuple(headers.header(name, unit) if name and unit else name for name, unit in pairs)
        else:
            self._headers = layout.headers
        first = next((line for line in self._head[layout.skip :] if line.strip() and not self._is_comment(line)), "")
        self._take_units(fields(first, layout.separator))
        return layout

    def _take_units(self, first: list[str]) -> None:
        """Take the unit of a column from its first cell, where neither header nor format says one."""
        of_format = stated_units(self._fmt)
        for k, cell in enumerate(first):
            header = self._headers[k] if k < len(self._headers) else ""
            name, unit = headers.split_header(header)
            unit = of_format.get(k) or of_format.get(name) or of_format.get(header) or unit
            unit_of_first = unit_of_cell(cell)
            if unit is None and unit_of_first and name:
                unit = unit_of_first
                self._headers = (*self._headers[:k], headers.header(name, unit), *self._headers[k + 1 :])
            if unit:
                self._units_of_cells[k] = unit

    def _bare(self, k: int, cell: str) -> str:
        """A cell without the unit behind its number, where that is the unit of its column."""
        if cell[-1:].isdigit():
            return cell
        apart, unit = number_and_unit(cell), self._units_of_cells.get(k)
        return apart[0] if apart and unit and same_unit(apart[1], unit) else cell

    def _row(self, number: int, line: str) -> Iterator[LiveSample]:
        assert self._layout is not None
        if not line.strip() or self._is_comment(line):
            return
        cells = fields(self._remark.sub("", line.rstrip("\r\n")), self._layout.separator)
        width = self._layout.width
        if len(cells) == width - 1 and self._layout.headers and self._layout.headers[-1] == "":
            cells.append("")
        if len(cells) != width:
            self._tell(f"{self._where}, line {number}: {len(cells)} fields where the header has {width}; left out.")
            return
        if cells == self._before and any(cells):
            self._tell(f"{self._where}, line {number}: the same as the line before; left out.")
            return
        self._before = cells
        cells = [self._bare(k, cell) for k, cell in enumerate(cells)]
        if self._clock is None and not (self._fmt is not None and self._fmt.interval is not None and self._channels):
            self._waiting.append((number, cells))
            yield from self._begin(last=len(self._waiting) >= _FIRST)
            return
        yield from self._sample(number, cells)

    def _begin(self, last: bool) -> Iterator[LiveSample]:
        """Find clock and channels by the first rows; wait for more where they do not say the clock."""
        assert self._layout is not None
        layout, fmt = self._layout, self._fmt
        rows = [cells for _, cells in self._waiting]
        if self._sign is None:  # a cell behind the clock may tell what the clock leaves open
            self._sign = next((sign for row in rows for cell in row if (sign := certain_sign(cell)) is not None), None)
        columns = [pd.Series([self._plain(row[k]) for row in rows], dtype=object) for k in range(layout.width)]
        if fmt is None:
            table = {header: columns[k] for k, header in enumerate(self._headers) if header}
            at_clock = clock_columns_of(table)
            clock = at_clock.headers
            if not clock and not last:
                return
            others = (h for h in table if h not in clock + at_clock.others)
            numbers = {h: self._numbers(self._headers.index(h), table[h]) for h in others}
            kept = {h: column for h, column in numbers.items() if column.notna().any() or _says_what_it_is(h)}
            full, notes = with_degrees(kept)
            for note in notes:
                self._tell(f"{self._where}: {note}")
            at = {h: self._headers.index(old) for h, old in zip(full, kept)}
            place = f"{self._where}, line {layout.row}"
            found, stated, faults = by_header(at | ({"t [s]": -1} if clock else {}), {}, place)
            for fault in faults:
                raise fault
            unit = None
            if not clock:  # a unit of its own, as in t [cs]
                clock, unit = (self._headers[found["t"]],), stated["t"]
            self._clock_at = tuple(self._headers.index(header) for header in clock)
            self._join = at_clock.cells
            written = at_clock.written or {header: table[header] for header in clock}
            self._clock = RunningClock(written, self._where, ClockFormat(), unit)
        else:
            found, stated = by_format(fmt, self._headers, layout.width, self._where, {})
            self._clock_at = clock_columns(fmt, found, self._headers, self._where) if fmt.interval is None else ()
            if self._clock_at:
                names = [self._headers[k] if k < len(self._headers) else f"number {k}" for k in self._clock_at]
                written = {name: columns[k] for name, k in zip(names, self._clock_at)}
                self._clock = RunningClock(written, self._where, fmt.clock, stated.get("t"))
        self._channels = {}
        for name, k in found.items():
            if name != "t":
                factor = headers.to_inside(name, stated[name], f"{self._where}, header: ")
                self.units[name] = stated[name]
                known = fmt.columns[name] if fmt is not None else None
                self._channels[name] = (k, factor * (known.sign * known.scale if known else 1.0))
        pair = pair_of(self._channels)
        if (
            pair is not None
            and not {"x", "y"} & set(self._channels)
            and headers.inside_unit(pair[0], stated[pair[0]]) == "rad"
        ):
            self._pair = pair
        channels = [name for name in self._channels if name not in self._pair]
        self.names = ("t", *channels, *(("x", "y") if self._pair else ()))
        waiting, self._waiting = self._waiting, []
        for number, cells in waiting:
            yield from self._sample(number, cells)

    def _plain(self, cell: str) -> str:
        """A cell of the clock with a decimal point; a date or a time of day as it is."""
        if _PLAIN["."].fullmatch(cell) or ":" in cell or "/" in cell:
            return cell
        value = self._number(cell)
        return cell if np.isnan(value) else repr(value)

    def _number(self, cell: str) -> float:
        """The number in a cell; NaN where it is none."""
        if _PLAIN[self._sign or "."].fullmatch(cell):
            return float(cell.replace(",", "."))
        if self._sign is None:
            self._sign = certain_sign(cell)
        return float(read_numbers(pd.Series([cell], dtype="str"), self._sign or ".")[0][0])

    def _sample(self, number: int, cells: list[str]) -> Iterator[LiveSample]:
        if self._clock is None:
            assert self._fmt is not None and self._fmt.interval is not None
            t = self._count * self._fmt.interval
        else:
            t = self._clock.seconds(self._join([self._plain(cells[k]) for k in self._clock_at]))
            for note in self._clock.notes:
                self._tell(f"{self._where}, line {number}: {note}")
            self._clock.notes.clear()
        if not abs(t) <= LARGEST:
            self._tell(f"{self._where}, line {number}: no time 't'; left out.")
            return
        self._count += 1
        values = {"t": t}
        for name, (k, factor) in self._channels.items():
            values[name] = self._value(number, name, k, cells[k]) * factor
        yield LiveSample(number, self._put_right(values))

    def _numbers(self, k: int, column: pd.Series) -> pd.Series:
        """The first cells of a column as numbers, NaN where one is none."""
        found = column.map(plain_number).astype(float)
        if found.isna().all() and self._may_be_lettered(k):
            lettered = read_lettered(column)
            return found if lettered is None else pd.Series(lettered[0])
        return found

    def _may_be_lettered(self, k: int) -> bool:
        return may_be_lettered(headers.split_header(self._headers[k])[1] if k < len(self._headers) else None)

    def _value(self, number: int, name: str, k: int, cell: str) -> float:
        if is_missing(cell):
            return np.nan
        value = self._number(cell)
        letters = self._letters.get(k)
        if abs(value) <= LARGEST and (letters is None or letters.fits(value)):
            return value
        if not np.isfinite(value) and self._may_be_lettered(k):
            letters = self._letters.setdefault(k, LetteredCells())
            before, value = letters.said, letters.read(cell)
            if letters.said and letters.said != before:
                self._tell(
                    f"{self._where}, line {number}: column '{self._headers[k] if self._headers else k}': {letters.said}."
                )
            if abs(value) <= LARGEST:
                return value
        self._tell(f"{self._where}, line {number}: {name} is no number there; it counts as missing.")
        return np.nan

    def _put_right(self, values: dict[str, float]) -> dict[str, float]:
        """Turn latitude and longitude, and what a format file says: winds by where they come from, speeds along the earth's axes."""
        if self._pair:
            values |= self._metres(*(values.pop(name) for name in self._pair))
        if self._fmt is None:
            return values
        frames = {name: column.frame for name, column in self._fmt.columns.items()}
        for name in (n for n, frame in frames.items() if frame == "from"):
            values[name] = (values[name] + np.pi) % (2 * np.pi)
        if "earth" in frames.values():
            c, s = np.cos(values["psi"]), np.sin(values["psi"])
            north, east = values["u"], values["v"]
            values["u"], values["v"] = north * c + east * s, east * c - north * s
        return values

    def _metres(self, lat: float, lon: float) -> dict[str, float]:
        """North and east of the first fix; NaN where there is none."""
        if not (abs(lat) <= np.pi / 2 and abs(lon) <= 2 * np.pi) or lat == lon == 0:
            return {"x": np.nan, "y": np.nan}
        self._origin = self._origin or (lat, lon)
        north, east = to_local(lat, lon, self._origin)
        return {"x": float(north), "y": float(east)}


def is_sample_line(line: str) -> bool:
    """Return whether a line of a table is a sample: more numbers and times than text.

    Parameters
    ----------
    line : str
        The line.
    """
    rows = (fields(line, separator) for separator in SEPARATORS.values())
    return any(len(row) > 1 and is_sample_row(row) for row in rows)


def _says_what_it_is(header: str) -> bool:
    """Whether a column without a number is one that is wanted: a field of the vocabulary, or one with a unit."""
    name, unit = headers.split_header(header)
    return name in FIELDS or unit is not None
