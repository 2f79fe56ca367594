"""Date and time as text: what stands in a cell, before it is decided which number is the day and which the month."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shipid.trials.logs.clocks.settings import offset_seconds

_MONTHS = {
    name: number
    for number, names in enumerate(
        (
            "jan january januar janv janvier ene enero januari", "feb february februar fev fevrier febrero februari",
            "mar march mrz maerz marz mars marzo maart mrt", "apr april avr avril abr abril",
            "may mai mayo mei maj", "jun june juni juin junio", "jul july juli juil juillet julio",
            "aug august aout ago agosto augustus", "sep sept september septembre septiembre",
            "oct october okt oktober octobre octubre", "nov november novembre noviembre",
            "dec december dez dezember des desember decembre dic diciembre",
        ),
        start=1,
    )
    for name in names.split()
}  # fmt: skip
_PLAIN = str.maketrans("äéûôóáöü", "aeuooaou")

_NAME = r"[^\W\d_]{3,10}"
_GAP = r"(?:[-/. ,]+|(?<=\d)(?=[^\W\d_])|(?<=[^\W\d_])(?=\d))"
_WEEKDAY = r"(?:[^\W\d_]{2,10}\.?,?\s+)?"
_TIME = r"(?P<H>\d{1,3}):(?P<M>\d{2})(?::(?P<S>\d{2})(?:[.,:](?P<F>\d+))?)?\s*(?P<p>[AaPp]\.?[Mm]\.?(?![A-Za-z]))?"
_ZONE = r"\s*\(?(?P<z>[A-Za-z]{1,5})?\)?\s*(?P<o>[+-]\d{1,2}(?::?\d{2})?)?\s*(?:\[[\w/+-]+\])?"
_DATED = re.compile(
    rf"{_WEEKDAY}(?P<a>\d{{4}}|\d{{1,2}}|{_NAME}){_GAP}(?P<b>\d{{1,2}}|{_NAME}){_GAP}(?P<c>\d{{4}}|\d{{1,2}})"
    rf"(?:\s*[Tt_,;: -]\s*{_TIME})?{_ZONE}"
)
_TIME_ONLY = re.compile(_TIME + _ZONE)
#: As C, Python's ctime and the command date write it: the year stands behind the time.
_YEAR_LAST = re.compile(
    rf"{_WEEKDAY}(?P<a>{_NAME})\s+(?P<b>\d{{1,2}})\s+{_TIME}\s+(?P<z>(?!\d)[A-Za-z]{{1,5}})?(?P<o>(?!))?\s*(?P<c>\d{{4}})"
)
#: A duration as pandas and Python write it: ``0 days 00:01:20.5``, ``1 day, 0:01:20``.
_DAYS = re.compile(r"(?P<days>\d{1,2}) days?,? \+?(?P<hours>\d{1,2})(?P<rest>:\d{2}:\d{2}(?:\.\d+)?)")
_COMPACT = re.compile(
    r"(?P<a>\d{4})(?P<b>\d{2})(?P<c>\d{2})(?:[Tt_ -]?(?P<H>\d{2}):?(?P<M>\d{2})(?::?(?P<S>\d{2})(?:[.,](?P<F>\d+))?)?)?"
    rf"(?P<p>(?!))?{_ZONE}"
)
_MINUTES = re.compile(r"(?P<M>\d{1,4}):(?P<S>\d{2})[.,](?P<F>\d+)")
#: Chinese and Japanese write the units behind the numbers, and so do French (23h58m20s).
_BEHIND = str.maketrans({"年": "-", "月": "-", "日": " ", "时": ":", "時": ":", "分": ":", "秒": None})
_HOURS = re.compile(r"\b(\d{1,2}) ?h ?(\d{2})(?: ?(?:min|mn|m)? ?(\d{2}(?:[.,]\d+)?) ?s?)?(?: ?(?:min|mn|m))?$")
_GROUPS = ("a", "b", "c", "H", "M", "S", "F", "p", "z", "o")


@dataclass(frozen=True, eq=False)
class Stamps:
    """The cells of a column of dates and times.

    Attributes
    ----------
    date : ndarray, shape (n, 3)
        The three numbers of a date in the order in which they stand; NaN where there is no date.
    year, month : int or None
        Which of the three has four digits; which is a name.
    points : bool
        Whether points stand between them.
    time : ndarray, shape (n,)
        Time of day [s], 0 where there is only a date, NaN where there is nothing; a leap second counts 60.
    timed, seconds : bool
        Whether cells have a time of day, and one with seconds.
    leap : ndarray of bool, shape (n,)
        Leap seconds, such as 23:59:60.
    offset : ndarray, shape (n,)
        Seconds ahead of UTC; NaN where a cell says none.
    zone : str
        Name of the zone where the cells say one instead, such as ``CEST``.
    bad : ndarray of bool, shape (n,)
        Cells that are neither empty nor a date or time.
    """

    date: np.ndarray
    year: int | None
    month: int | None
    points: bool
    time: np.ndarray
    timed: bool
    seconds: bool
    leap: np.ndarray
    offset: np.ndarray
    zone: str
    bad: np.ndarray

    @property
    def dated(self) -> bool:
        """Whether the cells have a date."""
        return bool(np.isfinite(self.date).any())


def is_stamp(cell: str) -> bool:
    """Return whether a text is a date, a time of day, or both.

    Parameters
    ----------
    cell : str
        The text.
    """
    stamps = read_stamps([cell])
    return bool(cell.strip()) and not stamps.bad[0]


def read_stamps(cells: Sequence[str]) -> Stamps:
    """Take dates and times of day apart.

    Parameters
    ----------
    cells : sequence of str, length n
        Text; an empty one holds nothing.

    Returns
    -------
    Stamps
    """
    texts = [cell.strip() for cell in cells]
    columns: dict[str, tuple[str, ...]] = dict.fromkeys(_GROUPS, ())
    columns |= zip(_GROUPS, zip(*map(_groups, texts)))
    empty = np.array([not text for text in texts], dtype=bool)
    year = next((k for k, name in enumerate("abc") if any(len(t) == 4 and t.isdigit() for t in columns[name])), None)
    month = next((k for k, name in enumerate("ab") if any(t[:1].isalpha() for t in columns[name])), None)
    if month is not None:
        columns["abc"[month]] = tuple(map(_month_number, columns["abc"[month]]))
    date = np.column_stack([_numbers(columns[name]) for name in "abc"])
    hour, minute, second = (_numbers(columns[name]) for name in "HMS")
    halves = np.array([half[:1].lower() for half in columns["p"]], dtype="U1")
    halved = halves != ""
    timed = np.isfinite(minute)
    dated = np.isfinite(date).all(axis=1)
    bad = ~empty & ~timed & ~dated
    bad |= (halved & ~((hour >= 1) & (hour <= 12))) | ((minute > 59) & np.isfinite(hour)) | (second > 60)
    bad |= (dated & (hour > 24)) | (np.isfinite(date).any(axis=1) & ~dated)
    hour = np.where(halved, hour % 12 + 12 * (halves == "p"), hour)
    fraction = _numbers(["0." + digits for digits in columns["F"]])
    time = np.nan_to_num(hour) * 3600 + np.nan_to_num(minute) * 60 + np.nan_to_num(second) + fraction
    offset, zone, other = _zones(columns["z"], columns["o"], ~bad)
    bad |= other
    return Stamps(
        np.where(bad[:, None], np.nan, date),
        year,
        month,
        bool(re.match(r"\d+\.\d+\.\d", next(filter(None, texts), ""))),
        np.where(bad | empty, np.nan, time),
        bool(timed.any()),
        bool(np.isfinite(second).any()),
        (second == 60) & ~bad,
        offset,
        zone,
        bad,
    )


def _groups(cell: str) -> tuple[str, ...]:
    """The parts of a cell, empty where it lacks them."""
    if "day" in cell and (match := _DAYS.fullmatch(cell)) is not None:
        cell = f"{24 * int(match['days']) + int(match['hours'])}{match['rest']}"
    if not cell.isascii():
        cell = cell.translate(_BEHIND).strip(" :")
    elif "h" in cell:
        cell = _HOURS.sub(lambda found: ":".join(filter(None, found.groups())), cell)
    match = _DATED.fullmatch(cell) or _COMPACT.fullmatch(cell) or _YEAR_LAST.fullmatch(cell)
    if match is not None:
        return _filled(match.group(*_GROUPS))
    match = _TIME_ONLY.fullmatch(cell)
    if match is not None:
        return ("", "", "", *_filled(match.group(*_GROUPS[3:])))
    match = _MINUTES.fullmatch(cell)
    return ("", "", "", "", *match.groups(""), "", "", "") if match is not None else ("",) * len(_GROUPS)


def _filled(parts: tuple[str | None, ...]) -> tuple[str, ...]:
    return tuple([part or "" for part in parts])


def _numbers(texts: Sequence[str]) -> np.ndarray:
    return np.array([text or "nan" for text in texts], dtype=object).astype(float)


@functools.cache
def _month_number(word: str) -> str:
    return str(_MONTHS.get(word.lower().translate(_PLAIN), "")) if word[:1].isalpha() else ""


#: Zones that cells name instead of an offset; other names mean several places.
_NAMED = {
    "Z": 0, "UTC": 0, "GMT": 0, "WET": 0, "WEST": 1, "BST": 1, "CET": 1, "CEST": 2, "MEZ": 1, "MESZ": 2, "EET": 2, "EEST": 3,
}  # fmt: skip


def _zones(names: Sequence[str], offsets: Sequence[str], sound: np.ndarray) -> tuple[np.ndarray, str, np.ndarray]:
    """Seconds ahead of UTC, NaN where a cell says none; else the name that all cells give; cells with another one."""
    pairs = list(zip(names, offsets))
    ahead = {pair: _ahead(*pair) for pair in set(pairs)}
    seconds = np.array([ahead[pair] for pair in pairs], dtype=float)
    named = sorted({name for name, _ in ahead if name and np.isnan(ahead[name, _])})
    nothing = np.zeros(len(pairs), dtype=bool)
    if not named:
        return seconds, "", nothing
    if len(named) == 1 and np.isnan(seconds).all():
        return seconds, named[0], nothing
    return seconds, "", np.array([name in named for name in names], dtype=bool) & sound


def _ahead(name: str, offset: str) -> float:
    """Seconds ahead of UTC that a cell says; NaN where it says nothing that is known."""
    known = _NAMED.get(name.upper(), math.nan) if name else 0
    if not name and not offset:
        return math.nan
    seconds = offset_seconds(offset) if offset else 0.0
    return math.nan if seconds is None else seconds + 3600.0 * known
