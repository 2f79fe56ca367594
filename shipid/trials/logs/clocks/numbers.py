"""Clocks that are numbers: seconds since 1970, serial days of spreadsheets, time of the GPS week, digits of date and time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.trials.logs.clocks.settings import EPOCHS, GPS_WEEK, SERIAL_DAYS, YEAR_DAYS

DAY = 86400.0
WEEK = 7 * DAY
#: Year, month, day, hour, minute and second side by side: 20260504235820. Read as text.
ALL_DIGITS = "yyyymmddhhmmss"
#: Names of the day of the year, in small letters, without blanks and signs; many loggers call it the Julian day.
DAYS_OF_YEAR = (
    "doy",
    "dayofyear",
    "yearday",
    "yday",
    "jday",
    "julday",
    "julianday",
    "jd",
    "decimalday",
    "decimaldoy",
    "fractionalday",
)
#: What names of the time of a GPS week hold.
IN_WEEK = ("tow", "timeofweek", "secondsofweek", "secofweek", "weekseconds", "sow")
#: The GPS began to count weeks here [s since 1970].
GPS_START = 315964800.0
#: No log in digital form is older, none is to come for a while [s since 1970]: 1990 and 2041, when Excel's days
#: reach those of the modified Julian calendar.
_OLDEST, _LATEST = 631152000.0, 2243808000.0
#: Without a unit a number is the time since 1970 only if samples follow each other within this [s].
_SLOWEST = 10.0


@dataclass(frozen=True, eq=False)
class Moments:
    """Moments that numbers say.

    Attributes
    ----------
    seconds : ndarray, shape (n,)
        Since 1 January 1970, or since the beginning of a GPS week or of a year where `absolute` is False.
    layout : str
        As a format file states it.
    absolute : bool
        Whether they have a date.
    gps : bool
        Whether they count by the GPS, which knows no leap seconds.
    """

    seconds: np.ndarray
    layout: str
    absolute: bool = True
    gps: bool = False


def read_numbers(values: np.ndarray, layout: str, week: np.ndarray | None = None) -> Moments:
    """Read numbers by a layout that is known.

    Parameters
    ----------
    values : ndarray, shape (n,)
        As printed.
    layout : str
        One of `EPOCHS`, `SERIAL_DAYS`, `GPS_WEEK`, `YEAR_DAYS` or ``hhmmss``.
    week : ndarray, shape (n,), optional
        Number of the GPS week.

    Returns
    -------
    Moments
    """
    if layout in EPOCHS:
        return Moments(_scaled(values, EPOCHS[layout]), layout)
    if layout in SERIAL_DAYS:
        return Moments(np.round((values - SERIAL_DAYS[layout]) * DAY, 5), layout)  # a day in float64 is exact to 1e-6 s
    if layout in GPS_WEEK:
        seconds = values * GPS_WEEK[layout]
        if week is None:
            return Moments(seconds, layout, absolute=False, gps=True)
        return Moments(GPS_START + week * WEEK + seconds, layout, gps=True)
    if layout in YEAR_DAYS:
        return Moments(np.round((values - 1) * DAY, 5), layout, absolute=False)
    assert layout == "hhmmss"
    hours, rest = np.divmod(values, 10000)
    minutes, seconds = np.divmod(rest, 100)
    return Moments(hours * 3600 + minutes * 60 + np.round(seconds, 6), layout, absolute=False)


def _scaled(values: np.ndarray, unit: float) -> np.ndarray:
    """Seconds of large whole numbers, without what a float loses: 1e18 ns keeps its fraction of the second."""
    if unit == 1.0:
        return np.asarray(values, dtype=float)
    return np.asarray(values, dtype=float) / round(1 / unit)


def layout_of_numbers(values: np.ndarray, name: str) -> str | None:
    """Return the layout of a clock whose numbers leave no doubt, or None.

    Parameters
    ----------
    values : ndarray, shape (n,)
        As printed, without a unit.
    name : str
        The header in small letters, without blanks and signs.

    Returns
    -------
    str or None
        Numbers since 1970 and serial days have sizes that nothing else has, at the interval of a log.
    """
    known = values[np.isfinite(values)]
    if known.size < 2:
        return None
    low, high, step = float(known.min()), float(known.max()), float(np.median(np.abs(np.diff(known))))
    for layout, unit in EPOCHS.items():
        within = low * unit > _OLDEST and high * unit < _LATEST
        if within and (step * unit < _SLOWEST or "epoch" in name or "unix" in name):
            return layout
    for layout in ("excel", "matlab"):
        origin = SERIAL_DAYS[layout]
        if (low - origin) * DAY > _OLDEST and (high - origin) * DAY < _LATEST and 0 < step * DAY < _SLOWEST:
            return layout
    named = {"jd": "julian", "julian": "julian", "mjd": "modified julian", "modifiedjulian": "modified julian"}
    layout_named = named.get(name.removesuffix("date").removesuffix("day").removesuffix("utc"))
    if layout_named is not None:
        since = (known - SERIAL_DAYS[layout_named]) * DAY
        if since.min() > _OLDEST and since.max() < _LATEST:
            return layout_named
    if name in DAYS_OF_YEAR and low >= 0 and high < 367 and 0 < step * DAY < _SLOWEST:
        return YEAR_DAYS[0]
    if any(word in name for word in IN_WEEK):
        if high < WEEK and low >= 0 and not name.startswith("itow"):
            return "gps week s"
        if WEEK < high < WEEK * 1000 and step > 5:
            return "gps week ms"
    if low >= 19900101e6 and high < 20410101e6 and _is_hhmmss(known % 1e6, least=0, fewest=2):
        return ALL_DIGITS
    if name in ("utc", "utctime", "hhmmss", "timeutc", "time", "gpstime") and _is_hhmmss(known):
        return "hhmmss"
    return None


def _is_hhmmss(known: np.ndarray, least: float = 300, fewest: int = 20) -> bool:
    """Whether numbers are hours, minutes and seconds side by side: no count of seconds leaves out 60 to 99."""
    if known.min() < 0 or known.max() >= 240000 or np.ptp(known) < least or known.size < fewest:
        return False
    return bool((known % 100 < 60).all() and (known // 100 % 100 < 60).all())


def epoch_in(seconds: np.ndarray) -> bool:
    """Return whether seconds, by their stated unit, are the time since 1970.

    Parameters
    ----------
    seconds : ndarray, shape (n,)
        A clock [s].
    """
    known = seconds[np.isfinite(seconds)]
    return bool(known.size) and bool(known.min() > _OLDEST and known.max() < _LATEST)
