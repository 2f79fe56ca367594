"""Which columns of a table are the clock: by the names in use, where the contents are a clock for certain."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
import pandas as pd

from shipid.trials import columns
from shipid.trials.logs.clocks.numbers import DAYS_OF_YEAR, layout_of_numbers
from shipid.trials.logs.clocks.stamps import is_stamp, read_stamps

#: Names of a clock in small letters, without blanks and signs: the surer ones first.
NAMES = (
    "t", "time", "datetime", "timestamp", "timestamps", "dateandtime", "datetimeutc", "utcdatetime", "utc", "utctime", "timeutc",
    "zeitstempel", "datumzeit", "datumuhrzeit", "zeit", "uhrzeit", "localtime", "timelocal", "lokaltid", "ortszeit", "gpstime",
    "timegps", "gpsutc", "epoch", "epochtime", "unix", "unixtime", "posixtime", "unixtimestamp", "tvec", "elapsed", "elapsedtime",
    "时间", "時間", "时刻", "時刻", "시간", "время", "czas", "zaman", "aika", "seconds", "timeofday", "tod", "hhmmss", "clock", "ts", "ros time".replace(" ", ""), "stamp", "tid", "tijd", "tijdstip", "tijdstempel", "datumtijd", "looptijd", "klokkeslett", "tidspunkt", "tidsstempel", "tiempo", "horalocal", "horautc",
    "horodatage", "dateheure", "heurelocale", "messzeit", "laufzeit", "heure", "hora",
    "tempo", "temps", "fechahora", "tow", "itow", "gpstow", "timeofweek", "gpstimeofweek", "datetimestamp", "timestamputc",
    "sow", "gpssow", "secondsofweek", "gpssecondsofweek", "secofweek", "gpsweekseconds", "weekseconds", *DAYS_OF_YEAR[:6],
    "decimalday", "decimaldoy", "fractionalday", "jd", "juliandate", "julianday", "mjd", "modifiedjuliandate", "modifiedjulianday", "datenum", "matlabtime", "datetimenum",
    "recordtime", "logtime", "systemtime", "date", "datum", "dato", "fecha", "day", "datetimelocal", "index",
)  # fmt: skip
#: What a cell without a value holds as text.
NOTHING = frozenset({"", "nan", "NaN", "NaT", "None", "<NA>", "null", "NULL", "-", "--"})
_DATES = ("date", "datum", "dato", "fecha", "day", "utcdate", "dateutc", "localdate", "gpsdate", "tag")
_ANY = frozenset((*NAMES, *_DATES))
_TIMES_OF_WEEK = (
    "tow", "itow", "gpstow", "timeofweek", "gpstimeofweek", "sow", "gpssow", "secondsofweek", "gpssecondsofweek", "secofweek",
    "gpsweekseconds", "weekseconds",
)  # fmt: skip
_WEEKS = ("week", "gpsweek", "wn", "gpsweeknumber", "weeknumber")
#: Names that say the unit themselves, where a header has no brackets: ``t_s``, ``time_ms``.
_SUFFIXED = re.compile(
    r"^(t|time|elapsed|elapsed[_ ]?time|uptime|epoch|timestamp)_(s|sec|secs|seconds|ms|msec|us|usec|ns|min|h)$",
    re.IGNORECASE,
)
#: A zone before or behind the name of a clock: ``Heure UTC``, ``GMT Time``.
_ZONE = re.compile(r"^(utc|gmt|tu|local)|(utc|gmt|tu|local|locale)$")
_TIME_UNIT = re.compile(
    r"^(s|sec|secs|second|seconds|sek|ms|msec|us|µs|usec|ns|min|h|hr|hours?|d|days?)$", re.IGNORECASE
)


def short(header: str) -> str:
    """Return a header in small letters, without its unit, blanks and signs, and without a zone that a name of a clock carries.

    Parameters
    ----------
    header : str
        As it stands in the table.
    """
    whole = _whole(header)
    bare = _ZONE.sub("", whole)
    return bare if whole not in _ANY and bare in _ANY else whole


def _whole(header: str) -> str:
    name = columns.split_header(header)[0].lower()
    suffixed = _SUFFIXED.match(name)
    return re.sub(r"[\W_]", "", suffixed[1] if suffixed else name)


def unit_of_time(header: str) -> str | None:
    """Return the unit of time that a header says, or None where it says none or another word.

    Parameters
    ----------
    header : str
        As it stands in the table: ``t [s]``, ``Time (ms)``, ``Time [UTC]``.
    """
    name, unit = columns.split_header(header)
    if unit is None and (suffixed := _SUFFIXED.match(name)) is not None:
        return suffixed[2].lower()
    return unit if unit and _TIME_UNIT.match(unit) else None


def hints(names: tuple[str, ...]) -> tuple[str, str]:
    """Return what headers say of the order of a date, and of the zone.

    Parameters
    ----------
    names : tuple of str
        The headers: ``Date (dd/mm/yyyy)``, ``Time [UTC]``, ``time_utc``.

    Returns
    -------
    order : str
        ``dmy``, ``mdy``, ``ymd`` or nothing.
    zone : str
        ``UTC``, ``+02:00`` or nothing.
    """
    order = zone = ""
    for name in names:
        text = name.lower()
        found = re.search(r"\b(d{1,2}|m{1,3}|y{2,4})[-/. ]?(d{1,2}|m{1,3}|y{2,4})[-/. ]?(d{1,2}|y{2,4})\b", text)
        letters = "".join(part[0] for part in found.groups()) if found else ""
        order = letters if letters in ("dmy", "mdy", "ymd") else order
        stated = re.search(r"(?:\b|_)(utc|gmt)\s*([+-]\d{1,2}(?::?\d{2})?)?", text)
        if stated or _whole(name).endswith("utc") or _whole(name).startswith("utc"):
            zone = (stated[2] if stated and stated[2] else "") or "UTC"
    return order, zone


def find_clock(table: Mapping[str, pd.Series]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the headers of the columns that are the clock.

    Parameters
    ----------
    table : Mapping of str to pandas.Series
        Columns by header, as printed: text, numbers, or time stamps.

    Returns
    -------
    clock : tuple of str
        One; or that of a date and that of a time of day; or that of the number of a GPS week and that of the time in it.
        Nothing, where no column is a clock for certain.
    others : tuple of str
        Columns that are dates or times of day as well.
    """
    named = {header: short(header) for header in table}
    kinds = {h: _content(column) for h, column in table.items() if named[h] in _ANY or column.dtype.kind in "OmMTU"}
    clock = _choose(table, named, kinds)
    times = [h for h, kind in kinds.items() if kind in ("moment", "date", "time of day")]
    times += [h for h in table if named[h] in _DATES and _is_six_digits(table[h])]
    return clock, tuple(h for h in times if h not in clock) if clock else ()


def _choose(table: Mapping[str, pd.Series], named: Mapping[str, str], kinds: Mapping[str, str]) -> tuple[str, ...]:
    ranked = sorted((h for h in named if named[h] in NAMES), key=lambda h: NAMES.index(named[h]))
    sure = [h for h in ranked if (unit_of_time(h) and kinds[h] in ("number", "digits")) or kinds[h] == "duration"]
    if sure and named[sure[0]] == "t":
        return (sure[0],)
    moments = [h for h in ranked if kinds[h] == "moment"] or [h for h in kinds if kinds[h] == "moment"][:1]
    if moments:
        return (moments[0],)
    date = next((h for h in named if named[h] in _DATES and kinds[h] in ("date", "digits")), None)
    for h in ranked:
        if kinds[h] == "time of day":
            return (h,) if date is None else (date, h)
    week = next((w for w in named if named[w] in _WEEKS), None)
    if sure:
        in_week = week is not None and named[sure[0]] in _TIMES_OF_WEEK
        return (str(week), sure[0]) if in_week else (sure[0],)
    for h in ranked:
        layout = layout_of_numbers(_numbers(table[h]), named[h]) if kinds[h] in ("number", "digits") else None
        if layout == "hhmmss" and date is not None:
            return (date, h)
        if layout is not None:
            return (h,) if week is None or not layout.startswith("gps") else (week, h)
    return tuple(h for h in kinds if kinds[h] == "duration")[:1]


def _is_six_digits(column: pd.Series) -> bool:
    """Whether a column holds dates of two digits a part, in an order that nothing tells: 040526."""
    known = _numbers(column)[:2000]
    known = known[np.isfinite(known)]
    pairs = np.column_stack((known // 10000, known // 100 % 100, known % 100))
    return bool(
        known.size
        and (known % 1 == 0).all()
        and ((known >= 10101) & (known < 1e6)).all()
        and (pairs[:, 1] >= 1).all()
        and (pairs[:, 1] <= 12).all()
        and np.unique(known).size <= 3
    )


def could_be_clock(header: str, cell: str) -> bool:
    """Return whether a column has to be left as text for `find_clock`: its first cell is a date or a time of day.

    Parameters
    ----------
    header : str
        Its header.
    cell : str
        Its first cell that is not empty.
    """
    return (short(header) in NAMES or short(header) in _DATES) and is_stamp(cell)


def _numbers(column: pd.Series) -> np.ndarray:
    return np.asarray(pd.to_numeric(column, errors="coerce").to_numpy(dtype=float, na_value=np.nan))


def is_number(column: pd.Series) -> bool:
    """Return whether a column holds numbers.

    Parameters
    ----------
    column : pandas.Series
        As printed.
    """
    return _content(column) in ("number", "digits")


def _content(column: pd.Series) -> str:
    """What a column holds: moment, date, time of day, duration, digits (a date as a number), number, or nothing known."""
    if column.dtype.kind == "M":
        whole = column.dropna()
        return "date" if whole.size and bool((whole == whole.dt.normalize()).all()) else "moment"
    if column.dtype.kind == "m":
        return "duration"
    cells = column.head(2000).dropna()
    if not pd.api.types.is_numeric_dtype(column.dtype):
        cells = cells.map(str).str.strip()
        cells = cells[~cells.isin(NOTHING)]
    if cells.empty:
        return "number" if pd.api.types.is_numeric_dtype(column.dtype) else "nothing"
    values = pd.to_numeric(cells, errors="coerce").astype(float)
    if values.notna().mean() > 0.5:
        dates = values.between(19900101, 20401231) & (values % 1 == 0) & (values % 100).between(1, 31)
        return "digits" if len(values) and dates.all() else "number"
    stamps = read_stamps(cells.head(50).tolist())
    if stamps.bad.mean() > 0.5:
        return "nothing"
    return "time of day" if not stamps.dated else "moment" if stamps.timed else "date"
