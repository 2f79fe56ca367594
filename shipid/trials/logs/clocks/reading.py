"""Read the clock of a log, however it is written: seconds since the first stamp, the moment that is, and how it was read."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from shipid.foundation.numbers import brief
from shipid.trials import columns as headers
from shipid.trials.errors import ClockError, TrialError
from shipid.trials.logs.clocks import course
from shipid.trials.logs.clocks.calendar import DAY
from shipid.trials.logs.clocks.headers import NAMES, find_clock, is_number, short, unit_of_time
from shipid.trials.logs.clocks.kinds import Place, Reading, by_pattern, joined, of_numbers, of_stamps, of_text, texts_of
from shipid.trials.logs.clocks.numbers import (
    ALL_DIGITS,
    DAYS_OF_YEAR,
    IN_WEEK,
    WEEK,
    epoch_in,
    layout_of_numbers,
    read_numbers,
)
from shipid.trials.logs.clocks.parts import of_parts, with_thousandths
from shipid.trials.logs.clocks.settings import DATE_ORDERS, TIMES, ClockFormat, moment_text

_WEEK_UNITS = {1.0: "gps week s", 1e-3: "gps week ms"}
_YEAR = 367.0
#: Samples nearer to each other than this are none of seconds [s]: 10 kHz.
_SHORTEST = 1e-4
#: Units that microcontrollers count in [s].
_COUNTED = (1e-3, 1e-6)
_EPOCH_UNITS = {1.0: "epoch s", 1e-3: "epoch ms", 1e-6: "epoch us", 1e-9: "epoch ns"}


@dataclass(frozen=True, eq=False)
class Clock:
    """A clock that was read.

    Attributes
    ----------
    seconds : ndarray, shape (n,)
        Since the first stamp; NaN where a row has none.
    start : str or None
        The moment of the first stamp, in ISO 8601, with its zone where one is known; None where no date is known.
    notes : tuple of str
        How it was read, and what t = 0 is.
    faults : tuple of TrialError
        What a trial may not have, with the row.
    """

    seconds: np.ndarray
    start: str | None
    notes: tuple[str, ...]
    faults: tuple[TrialError, ...] = ()


@dataclass(frozen=True, eq=False)
class ClockedTable:
    """A table with its clock first.

    Attributes
    ----------
    columns : dict of str to pandas.Series
        By header. The clock is ``t [s]``, or ``t`` in the unit that its plain numbers state; where no column is a clock for
        certain, the table is unchanged.
    start : str or None
        See `Clock`.
    notes : tuple of str
        How it was read, and which other clocks were left out.
    faults : tuple of TrialError
        See `Clock`.
    """

    columns: dict[str, pd.Series]
    start: str | None = None
    notes: tuple[str, ...] = ()
    faults: tuple[TrialError, ...] = ()


def same_row(row: int) -> int:
    """Return the row itself.

    Parameters
    ----------
    row : int
        Sample, counted from 0.
    """
    return row


def read_clock(
    columns: Mapping[str, pd.Series],
    where: str,
    stated: ClockFormat | None = None,
    line: Callable[[int], int] = same_row,
    twice: np.ndarray | None = None,
) -> Clock | None:
    """Read a clock.

    Parameters
    ----------
    columns : Mapping of str to pandas.Series
        The columns by header, as printed (text, numbers, or time stamps of pandas): one, or a date and a time of day, or
        the number of a GPS week and the time in it.
    where : str
        File or table, for messages.
    stated : ClockFormat, optional
        What a format file says of it.
    line : callable
        Gives the row number to name for a sample.
    twice : ndarray of bool, shape (n,), optional
        Rows whose samples are those of the row before: written twice, they have a right to the same stamp.

    Returns
    -------
    Clock or None
        None for plain numbers that count from a beginning of their own: they keep their unit.

    Raises
    ------
    ClockError
        If no cell has a time.
    """
    stated = stated or ClockFormat()
    *first, (header, main) = columns.items()
    beside, place = (first[0][1] if first else None), Place(where, tuple(columns), line)
    if main.dtype.kind == "m":
        return None
    if main.dtype.kind == "M":
        return _running(of_stamps(main), place, twice)
    layout, numeric = stated.layout, is_number(main)
    if layout is not None and "%" in layout:
        return _running(
            by_pattern(texts_of(main) if beside is None else joined(beside, main), stated, place), place, twice
        )
    values = pd.to_numeric(main, errors="coerce").to_numpy(dtype=float, na_value=np.nan)
    if layout is None and numeric:
        layout = layout_of(header, values)
        if layout is None and beside is None:
            return None
    if layout is not None and layout not in (*DATE_ORDERS, *TIMES, ALL_DIGITS):
        return _running(of_numbers(values, layout, beside, stated, place), place, twice)
    return _running(of_text(texts_of(main) if beside is None else joined(beside, main), stated, place), place, twice)


def with_clock(
    table: Mapping[str, pd.Series],
    where: str,
    stated: ClockFormat | None = None,
    line: Callable[[int], int] = same_row,
) -> ClockedTable:
    """Put the clock of a table first, as one column ``t [s]`` in place of those it is written in.

    Parameters
    ----------
    table : Mapping of str to pandas.Series
        Columns by header, as printed.
    where, stated, line
        As for `read_clock`.

    Returns
    -------
    ClockedTable

    Raises
    ------
    ClockError
        If no cell of the clock has a time.
    """
    found, others = find_clock(table)
    parts = of_parts(table)
    if parts is not None and (not found or found[-1] in parts[2]):
        name, column, used = parts
        table = {name: column, **{header: other for header, other in table.items() if header not in used}}
        found, others = (name,), find_clock(table)[1]
    if not found:
        _check_days(table, where)
        return ClockedTable(dict(table))
    fraction = with_thousandths(table[found[-1]], table)
    if fraction is not None:
        table = {header: column for header, column in table.items() if header != fraction[1]} | {found[-1]: fraction[0]}
    rest = {header: column for header, column in table.items() if header not in found + others}
    beside = " and ".join(f"'{name}'" for name in others)
    notes = (f"Not used beside the clock '{found[-1]}': {beside}.",) if others else ()
    main = table[found[-1]]
    clock = read_clock({header: table[header] for header in found}, where, stated, line, written_twice(rest.values()))
    if clock is not None:
        t = pd.Series(clock.seconds, index=main.index)
        return ClockedTable({"t [s]": t, **rest}, clock.start, (*clock.notes, *notes), clock.faults)
    if main.dtype.kind == "m":
        return ClockedTable({"t [s]": main.dt.total_seconds(), **rest}, None, notes)
    unit = unit_of_time(found[-1]) or ""
    main, midnight = _over_midnight(main, unit)
    return ClockedTable({headers.header("t", unit): main, **rest}, None, (*midnight, *notes))


def _check_days(table: Mapping[str, pd.Series], where: str) -> None:
    """Refuse days without a unit, which no name and no size tells: as seconds their samples would be microseconds apart."""
    for header, column in table.items():
        if short(header) not in NAMES or unit_of_time(header) is not None or not is_number(column):
            continue
        known = pd.to_numeric(column, errors="coerce").dropna().to_numpy(dtype=float)
        steps = np.diff(known)
        if known.size > 2 and known.min() > 0 and known.max() < _YEAR and 0 < float(np.median(steps)) < _SHORTEST:
            raise ClockError(
                f"{where}, column '{header}': from sample to sample the clock goes on by {brief(float(np.median(steps)), 2)}, so its numbers look like "
                f"days. Write '{header} [d]', or for days of a year layout = \"day of year\" in [clock] of a format file whose [columns.t] "
                f"names '{header}' (shipid format drafts one)."
            )


def _over_midnight(column: pd.Series, unit: str) -> tuple[pd.Series, tuple[str, ...]]:
    """Let a clock of plain numbers run on that counts from midnight, or in 32 bits, and begins again there."""
    if not unit or not is_number(column):
        return column, ()
    factor = headers.to_inside("t", unit)
    seconds = pd.to_numeric(column, errors="coerce").to_numpy(dtype=float, na_value=np.nan) * factor
    at = np.flatnonzero(np.isfinite(seconds))
    step = np.diff(seconds[at])
    back = np.flatnonzero(step < 0)
    if not back.size or not (step > 0).any():
        return column, ()
    near = max(60.0, 10 * float(np.median(step[step > 0])))
    before, after = seconds[at[back]], seconds[at[back + 1]]
    # The counter of a microcontroller has 32 bits: its milliseconds begin again after 50 days, its microseconds after 72 minutes.
    periods = {DAY: "The clock passes midnight", 2**32 * factor: "The counter of the clock begins again after 32 bits"}
    for period, what in periods.items():
        if period != DAY and factor not in _COUNTED:
            continue
        if ((before > period - near) & (before < period) & (after >= 0) & (after < near)).all():
            running, count = course.unrolled(seconds, period)
            many = "once" if count == 1 else f"{count} times"
            return pd.Series(running / factor, index=column.index), (f"{what} {many}.",)
    return column, ()


def written_twice(columns: Iterable[pd.Series]) -> np.ndarray | None:
    """Return which rows hold the samples of the row before; None where there are no columns.

    Parameters
    ----------
    columns : iterable of pandas.Series
        Those beside the clock.
    """
    same = [(column == column.shift()).to_numpy(dtype=bool, na_value=False) for column in columns]
    return np.all(same, axis=0) if same else None


def layout_of(header: str, values: np.ndarray) -> str | None:
    """Return the layout of numbers, by their unit or their size; None for seconds that count from a beginning of their own.

    Parameters
    ----------
    header : str
        Of the column.
    values : ndarray, shape (n,)
        As printed.
    """
    unit = unit_of_time(header)
    if unit is None:
        return layout_of_numbers(values, short(header))
    factor = headers.to_inside("t", unit)
    if factor in _WEEK_UNITS and any(word in short(header) for word in IN_WEEK):
        return _WEEK_UNITS[factor]
    if factor == DAY and short(header) in DAYS_OF_YEAR:
        return layout_of_numbers(values, short(header))
    if factor == DAY:
        return next((name for name in ("excel", "matlab") if epoch_in(read_numbers(values, name).seconds)), None)
    name = next((word for size, word in _EPOCH_UNITS.items() if np.isclose(size, factor, rtol=1e-9)), None)
    return name if name is not None and epoch_in(values * factor) else None


def _running(reading: Reading, place: Place, twice: np.ndarray | None) -> Clock:
    """Let a clock run on from its first stamp."""
    seconds, notes, faults = reading.seconds, list(reading.notes), list(reading.faults)
    at = np.flatnonzero(np.isfinite(seconds))
    if not at.size:
        if faults:
            return Clock(seconds, None, tuple(notes), tuple(faults))
        raise ClockError(
            f"{place.where}, column {place.shown}: no row has a time. Check that the log was written and copied completely."
        )
    origin, start = float(seconds[at[0]]), None
    if reading.period is not None:
        seconds, count = course.unrolled(seconds, reading.period)
        again = {DAY: "midnight", WEEK: "the end of the GPS week"}.get(reading.period, "the full hour")
        again = "the end of the year" if reading.of_year else again
        notes += [f"The clock passes {again} {'once' if count == 1 else f'{count} times'}."] if count else []
        told = f"{origin:.3f} s of a GPS week" if reading.period == WEEK else _time_of_day(origin)
        told += " that nothing names" if reading.period == WEEK else " of a day that nothing names"
        if reading.of_year:
            told = f"{_time_of_day(origin)} on day {origin // DAY + 1:.0f} of a year that nothing names"
    elif reading.zone.undecided:
        told = f"{_time_of_day(origin)} of a day that is not decided"
    else:
        start = told = reading.zone.moment(origin, int(at[0]))
    seconds, summer, fault = _hour_back(seconds, reading, place)
    faults += fault
    seconds, resolution = course.spread(np.round(seconds - origin, 6), twice)
    shared = []
    if resolution is not None:
        shared = [
            f"Several samples share a time stamp of {resolution:g} s: they were spread evenly over it, so times are right to "
            f"about {resolution:g} s."
        ]
    how = f"The clock is {place.shown} ({reading.how}); t = 0 is {told}{reading.zone.remark}."
    return Clock(seconds, start, (how, *notes, *summer, *shared), tuple(faults))


def _time_of_day(seconds: float) -> str:
    return moment_text(seconds % DAY).partition("T")[2]


def _hour_back(seconds: np.ndarray, reading: Reading, place: Place) -> tuple[np.ndarray, list[str], list[TrialError]]:
    """A clock that jumps back by an hour: summer time ends, or nobody knows; what to note and what to refuse."""
    local = reading.period is None and not reading.zone.converted
    k = course.hour_back(seconds)
    if k is None:
        return (*_hour_on(seconds, place), []) if local else (seconds, [], [])
    before = float(seconds[:k][np.isfinite(seconds[:k])][-1])
    if local and course.ends_summer(before):
        later = np.arange(len(seconds)) >= k
        note = (
            f"WARNING: the clock goes back by an hour at row {place.line(k)} ({moment_text(before)}), where summer time ends: it "
            "was let run on. State its zone in [clock] of a format file to be sure."
        )
        return np.where(later, seconds + course.HOUR, seconds), [note], []
    stamp = moment_text(before) if reading.period is None else _time_of_day(before)
    return (
        seconds,
        [],
        [
            ClockError(
                f"{place.where}, column {place.shown}: the clock jumps back by an hour at row {place.line(k)}, after {stamp}. If "
                "summer time ends there, state zone = 'Europe/Oslo' or the like in [clock] of a format file; otherwise cut the "
                "log there."
            )
        ],
    )


def _hour_on(seconds: np.ndarray, place: Place) -> tuple[np.ndarray, list[str]]:
    """A clock that jumps on by an hour at the full hour, where summer time can begin; what to note."""
    k = course.hour_on(seconds)
    before = np.nan if k is None else float(seconds[:k][np.isfinite(seconds[:k])][-1])
    if k is None or not course.ends_summer(before):
        return seconds, []
    note = (
        f"WARNING: the clock goes on by an hour at row {place.line(k)} ({moment_text(before)}), where summer time begins: the hour was "
        "taken out. State its zone in [clock] of a format file to be sure."
    )
    return np.where(np.arange(len(seconds)) >= k, seconds - course.HOUR, seconds), [note]
