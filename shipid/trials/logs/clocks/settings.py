"""What a format file says about the clock: ``[clock]``.

    [clock]
    layout = "day first"        # or "month first", "epoch ms", "excel", "day of year", "%d.%m.%Y %H:%M:%S"
    zone = "Europe/Oslo"        # or "UTC", "+02:00"
    date = "Date"               # the header of a column with the date, beside the one with the time of day

A layout with % is that of C's strptime, as pandas reads it.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, timezone, tzinfo
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from shipid.declaration.tables import Table
from shipid.foundation.aliases import Plain

#: Layouts of text: the order of a date, or of a time without one.
DATE_ORDERS = {"year first": "ymd", "day first": "dmy", "month first": "mdy"}
TIMES = ("hh:mm", "mm:ss")
#: Layouts of numbers: seconds a unit.
EPOCHS = {"epoch s": 1.0, "epoch ms": 1e-3, "epoch us": 1e-6, "epoch ns": 1e-9}
#: Days counted from a day of the calendar: the number that 1 January 1970 has.
SERIAL_DAYS = {
    "excel": 25569.0,
    "excel 1904": 24107.0,
    "matlab": 719529.0,
    "julian": 2440587.5,
    "modified julian": 40587.0,
}
#: Seconds of the GPS week: seconds a unit.
GPS_WEEK = {"gps week s": 1.0, "gps week ms": 1e-3}
#: Days of a year, with their fraction: 1 January begins at 1.
YEAR_DAYS = ("day of year",)
#: Time of day as a number.
DIGITS = ("hhmmss",)

LAYOUTS = (*DATE_ORDERS, *TIMES, *EPOCHS, *SERIAL_DAYS, *GPS_WEEK, *YEAR_DAYS, *DIGITS)
KEYS = ("interval", "note", "layout", "zone", "date")


@dataclass(frozen=True)
class ClockFormat:
    """What is known of a clock beside its cells.

    Attributes
    ----------
    layout : str or None
        One of `LAYOUTS`, or a pattern with % as in ``%d.%m.%Y %H:%M:%S``; None is found out.
    zone : str or None
        Where the clock stands: ``UTC``, ``+02:00`` or a name such as ``Europe/Oslo``.
    date : str or None
        Header of the column with the date, where it stands beside the time of day.
    """

    layout: str | None = None
    zone: str | None = None
    date: str | None = None


def clock_format(table: Table) -> ClockFormat:
    """Read ``[clock]`` of a format file.

    Parameters
    ----------
    table : Table
        The table; its entries `interval` and `note` are read elsewhere.

    Returns
    -------
    ClockFormat

    Raises
    ------
    FormatFileError
        If a layout or a zone is not known.
    """
    layout, zone = table.value("layout", str), table.value("zone", str)
    if layout is not None and layout not in LAYOUTS and "%" not in layout:
        raise table.fail(
            f"'layout' is '{layout}'. Write one of {', '.join(LAYOUTS)}, or a pattern such as '%d.%m.%Y %H:%M:%S'."
        )
    if zone is not None and zone_of(zone) is None:
        raise table.fail(f"'zone' is '{zone}', which is not known. Write 'UTC', '+02:00' or a name as 'Europe/Oslo'.")
    return ClockFormat(layout, zone, table.value("date", str))


def zone_of(name: str) -> tzinfo | None:
    """Return a time zone by its name, or None where there is no such zone.

    Parameters
    ----------
    name : str
        ``UTC``, ``+02:00``, ``UTC+2`` or a name of the zone data base such as ``Europe/Oslo``.
    """
    text = name.strip()
    for word in ("UTC", "GMT"):
        if text.upper().startswith(word):
            text = text[3:].strip() or "Z"
    if text in ("Z", "z"):
        return UTC
    if text[:1] in "+-" and text[1:]:
        seconds = offset_seconds(text)
        return None if seconds is None else timezone(timedelta(seconds=seconds))
    try:
        return ZoneInfo(text)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        return None


def offset_seconds(text: str) -> float | None:
    """Return the seconds that a zone is ahead of UTC, or None where the text is no such offset.

    Parameters
    ----------
    text : str
        ``+02:00``, ``+0200``, ``-5``.
    """
    digits = text[1:].replace(":", "")
    if text[:1] not in "+-" or not digits.isascii() or not digits.isdigit() or len(digits) > 4:
        return None
    hours, minutes = (int(digits[:-2]), int(digits[-2:])) if len(digits) > 2 else (int(digits), 0)
    if hours > 15 or minutes > 59:
        return None
    return (-1 if text[0] == "-" else 1) * (hours * 3600.0 + minutes * 60.0)


def moment_text(seconds: float, zone: Plain = None) -> str:
    """Return a moment as ISO 8601 writes it, to the microsecond where it has fractions.

    Parameters
    ----------
    seconds : float
        Since 1 January 1970, by the clock that `zone` names.
    zone : str or None
        What stands behind it: ``Z``, ``+02:00``; nothing where no zone is known.
    """
    moment = datetime(1970, 1, 1) + timedelta(seconds=round(seconds, 6))
    return moment.isoformat(timespec="microseconds" if moment.microsecond else "seconds") + (zone or "")
