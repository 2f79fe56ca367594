"""What a file of S-57 says of itself: whether it holds the records that it states, and which updates lie beside it.

GDAL draws what is left of a cell that was cut between two records, and passes over updates that it cannot use, without a word.
"""

from __future__ import annotations

import struct
from collections import Counter
from pathlib import Path

from shipid.foundation.notices import Notice
from shipid.prediction.charts.errors import ChartFileError

#: Bytes of a leader, and the tags of records of features and of geometry (ISO/IEC 8211, S-57 part 3).
_LEADER, _COUNTED = 24, (b"FRID", b"VRID")
#: The data structure field: three kinds and the counts of meta, cartographic, geographic and collection records, then of nodes,
#: connected nodes, edges and faces.
_STRUCTURE = struct.Struct("<3B8I")
#: Highest number of an update.
_LAST = 999


def is_s57(data: bytes) -> bool:
    """Return whether a file begins with the leader of ISO/IEC 8211: its length in five digits, and an interchange level.

    Parameters
    ----------
    data : bytes
        Its beginning.
    """
    return data[:5].isdigit() and data[5:7] in (b"3L", b"2L", b"1L", b" L")


def check_records(data: bytes, where: str) -> None:
    """Check that a cell or an update holds what it says that it holds.

    Parameters
    ----------
    data : bytes
        The file.
    where : str
        What it is called in messages.

    Raises
    ------
    ChartFileError
        If it is damaged, or holds fewer records than it states.
    """
    try:
        counted, stated = _counts(data)
    except (ValueError, IndexError, struct.error):
        raise ChartFileError(f"{where} is damaged. Check that it was copied completely.") from None
    # Some makers state no counts: all are zero then.
    features, geometry = (counted[tag] for tag in _COUNTED)
    for number, least, what in ((features, sum(stated[:4]), "features"), (geometry, sum(stated[4:]), "geometries")):
        if number < least:
            raise ChartFileError(
                f"{where} is not complete: it states {least} {what}, and holds {number}. Check that it was copied completely."
            )


def _counts(data: bytes) -> tuple[Counter[bytes], tuple[int, ...]]:
    """How many records of each tag there are, and how many the file states."""
    counted: Counter[bytes] = Counter()
    stated: tuple[int, ...] = (0,) * 8
    at = 0
    while at < len(data):
        leader = data[at : at + _LEADER]
        base, width = int(leader[12:17]), [int(leader[k : k + 1]) for k in (20, 21, 23)]
        directory = data[at + _LEADER : at + base - 1]
        step = sum(width)
        tags = [directory[k : k + width[2]] for k in range(0, len(directory), step)]
        counted.update(t for t in tags[1:2] if t in _COUNTED)
        if b"DSSI" in tags and at:
            entry = directory[step * tags.index(b"DSSI") + width[2] :]
            stated = _STRUCTURE.unpack_from(data, at + base + int(entry[width[0] : width[0] + width[1]]))[3:]
        # A record that is too long for five digits says 0.
        length = int(leader[:5]) or base + sum(
            int(directory[k + width[2] : k + width[2] + width[0]]) for k in range(0, len(directory), step)
        )
        if (
            leader[6:7] == b"R"
        ):  # a directory for all records to come, which no maker is known to use: nothing is counted
            return Counter(), (0,) * 8
        if not _LEADER < base <= length or at + length > len(data):
            raise ValueError
        at += length
    return counted, stated


def updates_of(file: Path) -> tuple[list[Path], list[Notice]]:
    """Return the updates that are applied to a cell, and what is told of those that are not.

    Parameters
    ----------
    file : Path
        The cell, ``.000``.
    """
    if file.suffix != ".000":
        return [], []
    beside = {int(f.suffix[1:]): f for f in file.parent.glob(f"{_literal(file.stem)}.[0-9][0-9][0-9]")}
    applied: list[Path] = []
    for number in range(1, _LAST + 1):
        update = beside.get(number)
        if update is None or not _begins_well(update):
            break
        applied.append(update)
    left = sorted(n for n in beside if n > len(applied))
    if not left:
        return applied, []
    wanted = len(applied) + 1
    said = "is no update of S-57" if wanted in beside else "is missing"
    return applied, [
        Notice(
            f"the chart is out of date: update {file.stem}.{wanted:03d} {said}, so that {len(left)} updates that lie beside the cell "
            "are not applied.",
            "chart-not-updated",
        )
    ]


def _literal(stem: str) -> str:
    """A stem whose brackets and stars are no pattern."""
    return "".join(f"[{c}]" if c in "*?[" else c for c in stem)


def _begins_well(update: Path) -> bool:
    try:
        with update.open("rb") as stream:
            return is_s57(stream.read(_LEADER))
    except OSError:
        return False
