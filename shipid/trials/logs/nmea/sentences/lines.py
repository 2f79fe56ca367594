"""One line of a log: what stands in front, the sentence, its checksum."""

from __future__ import annotations

import re
from collections.abc import Callable
from datetime import datetime
from functools import lru_cache, reduce
from operator import xor
from typing import NamedTuple

DAY = 86400.0

# Possessive (+), so that a broken checksum does not make the fields before it a sentence of its own. Some loggers keep the
# star and lose the checksum. Talkers with digits are those of test sets and simulators.
_SENTENCE = re.compile(
    r"[$!]([A-Z0-9]{3,15}|(?<=\$)[a-z0-9]{3,15})((?:,[^*\x00-\x1f\x7f-\U0010ffff]*+)?+)(?:\*([0-9A-Fa-f]{2})(?![0-9A-Za-z])|\*?\s*$)"
)
# Behind a checksum, where another sentence follows; that of a TAG block belongs to the sentence behind it.
_NEXT = re.compile(r"(?<=\*[0-9A-Fa-f]{2})(?!\\[$!\\])(?=[^$!]*[$!])")
_TAG = re.compile(r"\\([^\\]*)\*([0-9A-Fa-f]{2})\\")
_TAG_TIME = re.compile(r"(?:^|,)c:(\d{1,18}(?:\.\d{1,9})?)")
_TAG_SOURCE = re.compile(r"(?:^|,)s:([A-Za-z0-9_-]{1,15})")

_CLOCK = r"(?P<hour>\d{1,2}):(?P<minute>\d\d):(?P<second>\d\d(?:[.,]\d+)?)"
_ISO = re.compile(
    r"(?P<year>\d{4})[-/](?P<month>\d\d)[-/](?P<day>\d\d)(?:[T ,;_-]+)" + _CLOCK + r"\s?(?P<zone>Z|[+-]\d\d:?\d\d)?"
)
_TIME = re.compile(r"(?<![\d:])" + _CLOCK)
_EPOCH = re.compile(r"(?<![\d.])(?P<whole>\d{9,10}|\d{13}|\d{16})(?P<part>\.\d+)?(?![\d.])")
_NUMBER = re.compile(r"(?<![\d.])(\d{1,15}(?:\.\d{1,9})?)(?![\d.])")

_DIRECTIVES = {
    "Y": r"\d{4}", "m": r"\d{1,2}", "d": r"\d{1,2}", "H": r"\d{1,2}", "I": r"\d{1,2}", "M": r"\d{1,2}",
    "S": r"\d{1,2}", "f": r"\d{1,6}", "j": r"\d{1,3}", "y": r"\d\d", "b": r"[A-Za-z]+", "B": r"[A-Za-z]+",
    "p": r"[APap][Mm]", "z": r"(?:Z|[+-]\d\d:?\d\d)", "%": "%",
}  # fmt: skip


class Stamp(NamedTuple):
    """A logger's time stamp.

    Attributes
    ----------
    time : float
        Seconds since 1970, or since midnight, or since the logger began.
    dated : bool
        Whether it counts from 1970.
    exact : bool
        Whether it shows parts of a second.
    """

    time: float
    dated: bool
    exact: bool


class Sentence(NamedTuple):
    """A sentence as it stands in a line: address (``HEHDT``), text from ``$`` to before ``*``, checksum or None.

    Address and text are in capitals where the address had small letters, and `whole` says whether the checksum agrees.
    """

    address: str
    text: str
    checksum: str | None
    front: str
    whole: bool


def checksum(text: str) -> str:
    """Return the checksum of a sentence: the exclusive or of its bytes, two hexadecimal digits.

    Parameters
    ----------
    text : str
        What stands between ``$`` and ``*``.
    """
    return f"{reduce(xor, text.encode('latin-1', 'replace'), 0):02X}"


def split_line(line: str) -> Sentence | None:
    """Return the sentence in a line; None where there is none that is whole.

    Parameters
    ----------
    line : str
        One line of the log, without its end. Where a line was lost and the next one written onto it, the last sentence
        counts.
    """
    at = max(line.rfind("$"), line.rfind("!"))
    if at < 0:
        return None
    match = _SENTENCE.match(line, at)
    if match is None:
        return None
    text = line[at : match.end(2)]
    if match[3] is None and line[:at].endswith('"'):
        text = text.rstrip('"')  # a cell of a table in quotes
    if match[3] is None:
        text = text.rstrip()
    address, summed = match[1], match[3]
    whole = summed is None or checksum(text[1:]) == summed.upper()
    if address != address.upper():
        if summed is None:
            return None  # nothing says that it is one
        # Some devices send small letters and some loggers make them: the checksum is of the one or of the other.
        address, text = address.upper(), text.upper()
        whole = whole or checksum(text[1:]) == summed.upper()
    return Sentence(address, text, summed, line[:at], whole)


def sentences_of(line: str) -> list[str]:
    """Return the sentences of a line that holds several whole ones, one behind the other, as logs do that lost their line ends.

    Parameters
    ----------
    line : str
        One line of the log.

    Returns
    -------
    list of str
        Each with what stands before it: a stamp, a TAG block.
    """
    return _NEXT.split(line) if line.count("$") + line.count("!") > 1 else [line]


def tag_source(front: str) -> str:
    r"""Return the source that a TAG block names (IEC 61162-450), ``GP0001`` of ``\s:GP0001,c:1577836800*hh\``, or nothing.

    Parameters
    ----------
    front : str
        What stands before the sentence.
    """
    found = [match[1] for block, _ in _TAG.findall(front) if (match := _TAG_SOURCE.search(block))]
    return found[-1] if found else ""


def tag_time(front: str) -> tuple[Stamp | None, bool]:
    r"""Read the time of a TAG block (IEC 61162-450): ``\s:GP0001,c:1577836800*hh\``.

    Parameters
    ----------
    front : str
        What stands before the sentence.

    Returns
    -------
    stamp : Stamp or None
        None where the block says no time.
    sound : bool
        False where its checksum is wrong.
    """
    stamp = None
    for block, stated in _TAG.findall(front):
        if checksum(block) != stated.upper():
            return None, False
        if found := _TAG_TIME.search(block):
            stamp = Stamp(_since_1970(found[1]), True, "." in found[1] or len(found[1]) > 10)
    return stamp, True


def _since_1970(digits: str) -> float:
    """Seconds of a count since 1970 in seconds, milliseconds or microseconds: told apart by their size."""
    whole = len(digits.partition(".")[0])
    return float(digits) / (1e6 if whole >= 15 else 1e3 if whole >= 12 else 1.0)


@lru_cache(maxsize=64)
def _midnight(year: int, month: int, day: int) -> float:
    return (datetime(year, month, day) - datetime(1970, 1, 1)).total_seconds()


def _of_day(match: re.Match[str]) -> float | None:
    hour, minute, second = int(match["hour"]), int(match["minute"]), float(match["second"].replace(",", "."))
    return hour * 3600.0 + minute * 60.0 + second if hour < 24 and minute < 60 and second < 61 else None


def _last(pattern: re.Pattern[str], front: str) -> re.Match[str] | None:
    found = None
    for found in pattern.finditer(front):  # noqa: B007 - the last one belongs to the sentence
        pass
    return found


def _iso(front: str) -> Stamp | None:
    match = _last(_ISO, front)
    seconds = _of_day(match) if match else None
    if match is None or seconds is None:
        return None
    try:
        day = _midnight(int(match["year"]), int(match["month"]), int(match["day"]))
    except ValueError:
        return None
    if (zone := match["zone"]) and zone != "Z":
        hours, minutes = int(zone[1:3]), int(zone[-2:])
        seconds -= (hours * 3600 + minutes * 60) * (1 if zone[0] == "+" else -1)
    return Stamp(day + seconds, True, not match["second"].isdigit())


def _time(front: str) -> Stamp | None:
    match = _last(_TIME, front)
    seconds = _of_day(match) if match else None
    return None if match is None or seconds is None else Stamp(seconds, False, not match["second"].isdigit())


def _epoch(front: str) -> Stamp | None:
    match = _last(_EPOCH, front)
    if match is None:
        return None
    return Stamp(_since_1970(match[0]), True, bool(match["part"]) or len(match["whole"]) > 10)


def _counted(scale: float) -> Callable[[str], Stamp | None]:
    def read(front: str) -> Stamp | None:
        match = _last(_NUMBER, front)
        return None if match is None else Stamp(float(match[1]) * scale, True, "." in match[1] or scale < 1)

    return read


def _any(front: str) -> Stamp | None:
    return _iso(front) or _epoch(front) or _time(front)


#: Layouts of a logger's stamp with a name; any other is a strptime layout.
LAYOUTS: dict[str, Callable[[str], Stamp | None]] = {
    "auto": _any,
    "iso": _iso,
    "epoch": _epoch,
    "hh:mm:ss": _time,
    "seconds": _counted(1.0),
    "milliseconds": _counted(1e-3),
    "none": lambda front: None,
}


def stamp_reader(layout: str) -> Callable[[str], Stamp | None]:
    """Return the function that reads a logger's stamp from what stands before a sentence.

    Parameters
    ----------
    layout : str
        One of `LAYOUTS`, or a layout of `datetime.strptime` such as ``%m/%d/%Y,%H:%M:%S.%f``.

    Raises
    ------
    ValueError
        If the layout is none of these.
    """
    if layout in LAYOUTS:
        return LAYOUTS[layout]
    pieces = re.split(r"%(.)", layout)
    if len(pieces) < 3 or not {"H", "I"} & set(pieces[1::2]):
        raise ValueError("it has no directive for the hour such as %H")
    unknown = [p for p in pieces[1::2] if p not in _DIRECTIVES]
    if unknown:
        raise ValueError(f"it has the directive %{unknown[0]}, and {', '.join('%' + d for d in _DIRECTIVES)} are known")
    pattern = re.compile("".join(_DIRECTIVES[p] if k % 2 else re.escape(p) for k, p in enumerate(pieces)))
    dated = {"d", "j"} & set(pieces[1::2])

    def read(front: str) -> Stamp | None:
        match = _last(pattern, front)
        if match is None:
            return None
        try:
            moment = datetime.strptime(match[0], layout)
        except ValueError:
            return None
        offset = moment.utcoffset()
        seconds = (moment.replace(tzinfo=None) - datetime(1970, 1, 1)).total_seconds()
        seconds -= offset.total_seconds() if offset else 0.0
        return Stamp(seconds if dated else seconds % DAY, bool(dated), "f" in pieces[1::2])

    return read
