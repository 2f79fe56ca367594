"""The kinds of clocks, each read to seconds: time stamps of pandas, numbers, text."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from shipid.trials.errors import ClockError, DateOrderError, TextInColumnError, TrialError
from shipid.trials.logs.clocks.calendar import DAY, Dates, read_dates
from shipid.trials.logs.clocks.course import unrolled
from shipid.trials.logs.clocks.headers import NOTHING, hints
from shipid.trials.logs.clocks.numbers import WEEK, read_numbers
from shipid.trials.logs.clocks.settings import DATE_ORDERS, YEAR_DAYS, ClockFormat
from shipid.trials.logs.clocks.stamps import Stamps, read_stamps
from shipid.trials.logs.clocks.zones import Zone, to_utc

#: So many stamps have to say a zone before the others are read in it.
_FEWEST_ZONES = 10


@dataclass(frozen=True)
class Place:
    """Where a clock stands, for messages and for what its headers say.

    Attributes
    ----------
    where : str
        File or table.
    names : tuple of str
        Headers of the clock; the last is that of the time.
    line : callable
        Gives the row number to name for a sample.
    """

    where: str
    names: tuple[str, ...]
    line: Callable[[int], int]

    @property
    def shown(self) -> str:
        """The headers, for a sentence."""
        return " and ".join(f"'{name}'" for name in self.names)

    def no_stamp(self, bad: np.ndarray, cells: Sequence[str], how: str = "") -> list[TrialError]:
        """Return the fault of cells that are no date or time; nothing, where there is none.

        Parameters
        ----------
        bad : ndarray of bool, shape (n,)
            The cells.
        cells : sequence of str
            All cells.
        how : str
            By what they are none.
        """
        rows = np.flatnonzero(bad)
        if not rows.size:
            return []
        k, many = int(rows[0]), f"{rows.size} such cells" if rows.size > 1 else "one such cell"
        return [
            TextInColumnError(
                f"{self.where}, row {self.line(k)}, column '{self.names[-1]}': '{cells[k][:40]}' is no date or time{how} like "
                f"the others ({many}). Correct it, or remove the row."
            )
        ]


@dataclass(frozen=True, eq=False)
class Reading:
    """Seconds as the stamps say them.

    Attributes
    ----------
    seconds : ndarray, shape (n,)
        Since 1970, or since midnight or the beginning of a week; NaN where a row has no stamp.
    how : str
        How they were read, in words.
    period : float or None
        After which an undated clock begins again [s].
    zone : Zone
        Of dated stamps.
    notes : tuple of str
        What was decided.
    faults : tuple of TrialError
        What a trial may not have.
    of_year : bool
        Whether they count from the beginning of a year that nothing names.
    """

    seconds: np.ndarray
    how: str
    period: float | None = None
    zone: Zone = field(default_factory=Zone)
    notes: tuple[str, ...] = ()
    faults: tuple[TrialError, ...] = ()
    of_year: bool = False


def texts_of(column: pd.Series) -> list[str]:
    """Return the cells of a column as text, empty where there is nothing.

    Parameters
    ----------
    column : pandas.Series
        Any column.
    """
    texts = [f"{cell:.0f}" if isinstance(cell, float) and cell.is_integer() else str(cell).strip() for cell in column]
    return ["" if text in NOTHING else text for text in texts]


def of_stamps(column: pd.Series) -> Reading:
    """Read time stamps of pandas.

    Parameters
    ----------
    column : pandas.Series
        Of kind datetime64, with or without a zone.

    Returns
    -------
    Reading
    """
    zone = getattr(column.dtype, "tz", None)
    local = column.dt.tz_localize(None) if zone is not None else column
    moments = column.dt.tz_convert("UTC").dt.tz_localize(None) if zone is not None else column
    utc, at = (c.to_numpy(dtype="datetime64[ns]") for c in (moments, local))
    empty = np.isnat(utc)
    seconds = np.where(empty, np.nan, utc.astype("int64") / 1e9)
    ahead = np.where(empty, np.nan, (at - utc).astype("int64") / 1e9)
    return Reading(seconds, "time stamps", zone=Zone() if zone is None else Zone(str(zone), ahead, converted=True))


def of_numbers(values: np.ndarray, layout: str, beside: pd.Series | None, stated: ClockFormat, place: Place) -> Reading:
    """Read numbers by their layout.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The numbers.
    layout : str
        As a format file states it.
    beside : pandas.Series or None
        The number of the GPS week, or the date, in a column of its own.
    stated : ClockFormat
        What a format file says.
    place : Place
        Where they stand.

    Returns
    -------
    Reading
    """
    if layout == "hhmmss" and beside is not None:
        return of_text(joined(beside, pd.Series(values)), replace(stated, layout=None), place)
    week = None if beside is None else pd.to_numeric(beside, errors="coerce").to_numpy(dtype=float, na_value=np.nan)
    found = read_numbers(values, layout, week)
    how = f"{layout}, {'as the format file says' if stated.layout else 'by the size of its numbers'}"
    if layout.startswith("epoch"):
        return Reading(found.seconds, how, zone=Zone("UTC", np.zeros(len(values)), converted=True))
    if found.gps:
        zone = Zone("GPS, which leaves leap seconds out")
        if week is None or np.nanmax(week) > np.nanmin(week):
            return Reading(found.seconds, how, None if found.absolute else WEEK, zone)
        seconds, count = unrolled(found.seconds, WEEK)
        kept = "The number of the week stays the same when the week ends; the clock was let run on."
        return Reading(seconds, how, zone=zone, notes=(kept,) if count else ())
    if layout in YEAR_DAYS:
        # A year that ends in the log has as many days as its last number says.
        days = 366 if values[np.isfinite(values)].max(initial=0.0) >= 366 else 365
        return Reading(found.seconds, how, days * DAY, Zone(stated.zone or hints(place.names)[1]), of_year=True)
    if not found.absolute:
        return Reading(found.seconds, how, DAY, Zone(stated.zone or hints(place.names)[1]))
    seconds, zone, notes = to_utc(found.seconds, stated.zone or hints(place.names)[1])
    return Reading(seconds, how, zone=zone, notes=notes)


def joined(dates: pd.Series, times: pd.Series) -> list[str]:
    """Return date and time of day of each row as one text.

    Parameters
    ----------
    dates, times : pandas.Series
        The columns. The date of a spreadsheet is midnight of its day; a time may be the number hhmmss.

    Returns
    -------
    list of str
        Empty where one of them is.
    """
    days = [text.removesuffix(" 00:00:00").removesuffix("T00:00:00") for text in texts_of(dates)]
    return [f"{day} {_with_colons(time)}" if day and time else "" for day, time in zip(days, texts_of(times))]


def _with_colons(time: str) -> str:
    whole, point, fraction = time.partition(".")
    if not whole.isdigit():
        return time
    digits = f"{whole:0>6}"
    return f"{digits[:2]}:{digits[2:4]}:{digits[4:]}{point}{fraction}"


def by_pattern(cells: list[str], stated: ClockFormat, place: Place) -> Reading:
    """Read text by the pattern of a format file.

    Parameters
    ----------
    cells : list of str
        The text.
    stated : ClockFormat
        Its layout is a pattern with %.
    place : Place
        Where it stands.

    Returns
    -------
    Reading
    """
    texts, pattern = pd.Series(cells, dtype=object), stated.layout or ""
    parsed = pd.to_datetime(texts.where(texts != ""), format=pattern, errors="coerce", utc="%z" in pattern)
    bad = parsed.isna().to_numpy() & (texts != "").to_numpy()
    faults = tuple(place.no_stamp(bad, cells, f" by the layout '{pattern}' of the format file"))
    found, how = of_stamps(parsed), f"text by '{pattern}'"
    if not any(mark in pattern for mark in ("%d", "%j", "%D", "%x", "%c")):
        return Reading(np.mod(found.seconds, DAY), how, DAY, Zone(stated.zone or ""), faults=faults)
    if found.zone.converted:
        return replace(found, how=how, faults=faults)
    seconds, zone, notes = to_utc(found.seconds, stated.zone)
    return Reading(seconds, how, zone=zone, notes=notes, faults=faults)


def of_text(cells: list[str], stated: ClockFormat, place: Place) -> Reading:
    """Read dates and times of day as text.

    Parameters
    ----------
    cells : list of str
        The text.
    stated : ClockFormat
        Its layout is an order of the date, or of a time without one; None is found out.
    place : Place
        Where it stands.

    Returns
    -------
    Reading
    """
    stamps = read_stamps(cells)
    # Every stamp after a leap second is late by one second.
    after = stamps.leap[:-1] & ~stamps.leap[1:]
    time = stamps.time + np.concatenate((np.zeros(min(1, len(cells))), np.cumsum(after)))
    faults = place.no_stamp(stamps.bad, cells)
    if not stamps.dated:
        zone = Zone(stated.zone or stamps.zone or hints(place.names)[1])
        if stamps.seconds or not stamps.timed:
            return Reading(time, "time of day as text", DAY, zone, faults=tuple(faults))
        return _two_numbers(time, cells, stated, place, faults)
    dates = read_dates(stamps, DATE_ORDERS.get(stated.layout or ""), hints(place.names)[0])
    faults += place.no_stamp(np.isnan(dates.days) & np.isfinite(time), cells)
    seconds, notes = dates.days * DAY + time, [*dates.notes]
    known = dates.days[np.isfinite(dates.days)]
    if len(place.names) > 1 and known.size and np.ptp(known) == 0:
        seconds, count = unrolled(seconds, DAY)
        notes += ["The date stays the same when the clock passes midnight; the clock was let run on."] if count else []
    seconds, zone, more = _in_zone(seconds, stamps, stated, place)
    faults += place.no_stamp(np.isnan(seconds) & np.isfinite(dates.days), cells)
    if len(dates.possible) > 1:
        zone = replace(zone, undecided=True)
        faults += _undecided(dates, cells, place)
    return Reading(seconds, "date and time as text", zone=zone, notes=(*notes, *more), faults=tuple(faults))


def _in_zone(
    seconds: np.ndarray, stamps: Stamps, stated: ClockFormat, place: Place
) -> tuple[np.ndarray, Zone, tuple[str, ...]]:
    """Moments in UTC, where the cells, the format file or the header say the zone."""
    if np.isfinite(stamps.offset).any():
        offset, notes = _every_offset(seconds, stamps.offset)
        return seconds - offset, Zone("", offset, converted=True), notes
    return to_utc(seconds, stated.zone or stamps.zone or hints(place.names)[1])


def _every_offset(seconds: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    """Offsets of all stamps, where some say none and run on with those that do."""
    at = np.flatnonzero(np.isfinite(seconds))
    said = np.isfinite(offset[at])
    if said.all() or said.sum() < _FEWEST_ZONES or np.unique(offset[at][said]).size > 1:
        return offset, ()
    step, border = np.diff(seconds[at]), np.diff(said)
    usual = float(np.median(step))
    if not (usual > 0 and (step[border] > 0).all() and (step[border] <= 10 * usual).all()):
        return offset, ()
    note = f"{int((~said).sum())} stamps say no zone: they were read in that of the others, with which they run on."
    return np.full(offset.shape, float(offset[at][said][0])), (note,)


def _two_numbers(
    time: np.ndarray, cells: list[str], stated: ClockFormat, place: Place, faults: list[TrialError]
) -> Reading:
    """Times such as 12:34: hours and minutes, or minutes and seconds."""
    if stated.layout == "hh:mm":
        return Reading(time, "hours and minutes", DAY, Zone(stated.zone or ""), faults=tuple(faults))
    if stated.layout != "mm:ss" and not np.nanmax(time, initial=0.0) >= DAY:
        shown = next((cell for cell in cells if cell), "")
        faults.append(
            ClockError(
                f"{place.where}, column {place.shown}: '{shown}' can be hours and minutes or minutes and seconds. State "
                "layout = 'hh:mm' or 'mm:ss' in [clock] of a format file."
            )
        )
    return Reading(time / 60, "minutes and seconds", 3600.0, faults=tuple(faults))


def _undecided(dates: Dates, cells: list[str], place: Place) -> list[TrialError]:
    if dates.agree:
        return []
    shown, choice = next((cell for cell in cells if cell), ""), " or ".join(dates.possible)
    quoted = " or ".join(f"'{order}'" for order in dates.possible)
    return [
        DateOrderError(
            f"{place.where}, column {place.shown}: the date of '{shown}' can be read {choice}, and nothing in the log decides. "
            f"State layout = {quoted} in [clock] of a format file."
        )
    ]
