"""A clock that is read row by row: the layout is decided by the first rows, and midnight and summer time as they pass."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from shipid.trials import columns as headers
from shipid.trials.errors import TrialError
from shipid.trials.filling import GAP
from shipid.trials.logs.clocks.calendar import DAY, read_dates
from shipid.trials.logs.clocks.course import HOUR, begins_summer, ends_summer
from shipid.trials.logs.clocks.headers import hints, is_number, unit_of_time
from shipid.trials.logs.clocks.kinds import Place, Reading, by_pattern, joined, of_numbers, of_text, texts_of
from shipid.trials.logs.clocks.numbers import ALL_DIGITS
from shipid.trials.logs.clocks.reading import layout_of, same_row
from shipid.trials.logs.clocks.settings import DATE_ORDERS, TIMES, ClockFormat
from shipid.trials.logs.clocks.stamps import read_stamps
from shipid.trials.logs.live.cells import plain_number

#: A clock that falls from within this of midnight to within this of it passes midnight [s].
_NEAR = 60.0


class RunningClock:
    """A clock that is read row by row.

    Parameters
    ----------
    first : Mapping of str to pandas.Series
        The columns of the clock by header, as printed, with the first rows: as for `shipid.trials.logs.clocks.reading.read_clock`.
    where : str
        The log, for messages.
    stated : ClockFormat
        What a format file says.
    unit : str or None
        Unit that a format file states for plain numbers.

    Attributes
    ----------
    notes : list of str
        What there is to tell of it since it was asked last.

    Raises
    ------
    TrialError
        If the first rows cannot be read as a clock.
    """

    def __init__(
        self, first: Mapping[str, pd.Series], where: str, stated: ClockFormat, unit: str | None = None
    ) -> None:
        self.notes: list[str] = []
        self._place, self._stated = Place(where, tuple(first), same_row), stated
        main = list(first.values())[-1]
        unit = unit or unit_of_time(self._place.names[-1])
        self._layout = stated.layout
        if self._layout is None and is_number(main):
            values = pd.to_numeric(main, errors="coerce").to_numpy(dtype=float, na_value=np.nan)
            self._layout = layout_of(
                headers.header(headers.split_header(self._place.names[-1])[0], unit) if unit else self._place.names[-1],
                values,
            )
        self._factor = None
        if self._layout is None and is_number(main) and len(first) == 1:
            if unit is None:
                raise headers.no_unit(self._place.names[-1], f"{where}, header: ", "t")
            self._factor = headers.to_inside("t", unit, f"{where}, header: ")
        self._day_open = False
        if self._layout is None and self._factor is None:
            self._decide_order(texts_of(main) if len(first) == 1 else joined(*first.values()))
        self._origin: float | None = None
        self._start: str | None = None
        self._last = self._stamp = float("nan")
        self._usual, self._added, self._count, self._group = 1.0, 0.0, 0, 1

    @property
    def start(self) -> str | None:
        """The moment of t = 0 in ISO 8601; None where no date is known, or no stamp has come."""
        return self._start

    def seconds(self, cells: Sequence[str]) -> float:
        """Return the seconds since the first stamp; NaN where the row has none.

        Parameters
        ----------
        cells : sequence of str
            Those of the clock, as the first rows were given.
        """
        if self._factor is not None:
            return self._over_midnight(plain_number(cells[-1]) * self._factor)
        reading = self._read(cells)
        stamp = float(reading.seconds[0]) if len(reading.seconds) else float("nan")
        if not np.isfinite(stamp):
            return float("nan")
        if self._origin is None:
            self._origin = self._stamp = stamp
            self._last = stamp
            if reading.period is None and not reading.zone.undecided:
                self._start = reading.zone.moment(stamp, 0)
            return 0.0
        return float(np.round(self._runs_on(stamp, reading) - self._origin, 6))

    def _over_midnight(self, stamp: float) -> float:
        """Let seconds run on that count from midnight, and begin again there."""
        if 0 <= stamp < _NEAR and DAY - _NEAR < self._stamp < DAY:
            self._added += DAY
            self.notes.append("The clock passes midnight.")
        if np.isfinite(stamp):
            self._stamp = stamp
        return stamp + self._added

    def _decide_order(self, cells: list[str]) -> None:
        """Fix the order of day and month by the first rows; where they leave it open, only the time of day is read."""
        stamps = read_stamps(cells)
        if not stamps.dated:
            return
        dates = read_dates(stamps, DATE_ORDERS.get(self._stated.layout or ""), hints(self._place.names)[0])
        self._day_open = len(dates.possible) > 1
        self._stated = ClockFormat(dates.possible[0], self._stated.zone, self._stated.date)

    def _read(self, cells: Sequence[str]) -> Reading:
        layout, beside = self._layout, pd.Series([cells[0]]) if len(cells) > 1 else None
        main = pd.Series([cells[-1]])
        text = texts_of(main) if beside is None else joined(beside, main)
        if layout is not None and "%" in layout:
            return by_pattern(text, self._stated, self._place)
        if layout is not None and layout not in (*DATE_ORDERS, *TIMES, ALL_DIGITS):
            return of_numbers(np.array([plain_number(cells[-1])]), layout, beside, self._stated, self._place)
        try:
            reading = of_text(text, self._stated, self._place)
        except TrialError:
            return Reading(np.array([np.nan]), "")
        if self._day_open:
            return Reading(np.mod(reading.seconds, DAY), reading.how, DAY)
        return reading

    def _runs_on(self, stamp: float, reading: Reading) -> float:
        period = reading.period
        if period is not None and stamp + self._added - self._stamp < -period / 2:
            self._added += period
            self.notes.append("The clock passes midnight." if period == DAY else "The clock begins again.")
        step = stamp + self._added - self._stamp
        local = period is None and not reading.zone.converted
        if reading.zone.assumed and step - HOUR >= 0:
            # The hour that summer time repeats is the first of the two as long as the clock has not gone back.
            stamp, step = stamp - HOUR, step - HOUR
        if local and begins_summer(np.floor(self._stamp - self._added), np.floor(stamp)) and ends_summer(self._stamp):
            self._added -= HOUR
            self.notes.append(
                "WARNING: the clock goes on by an hour, where summer time begins: the hour was taken out."
            )
        back = abs(step + HOUR - self._usual) <= max(GAP * self._usual, 1.0)
        if back and (reading.zone.assumed or (local and ends_summer(self._stamp))):
            self._added += HOUR
            self.notes.append("WARNING: the clock goes back by an hour, where summer time ends: it was let run on.")
        stamp += self._added
        if stamp == self._stamp and stamp == np.floor(stamp):
            # Whole seconds that several samples share: so many as in the second before.
            self._count += 1
            return stamp + self._count / max(self._group, self._count + 1)
        if stamp > self._stamp:
            self._usual, self._group, self._count = stamp - self._stamp, self._count + 1, 0
        self._stamp = stamp
        return stamp
