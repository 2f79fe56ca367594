"""Rows and cells of a log: text, marks of a missing sample, empty columns, rows without samples or without a time."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.numbers import brief, counted
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.missing_marks import LARGEST

#: From this share on, cells that hold no number spoil the column.
_MANY = 0.3


def examine_rows(p: WorkingCopy) -> None:
    """Find cells that hold text, columns that hold nothing, and rows without samples or without a time.

    Parameters
    ----------
    p : WorkingCopy
        The record as logged.
    """
    _words(p)
    # Beyond any number an instrument writes: infinities were counted as missing by the reader of the log.
    for name, values in p.values.items():
        with np.errstate(invalid="ignore"):
            p[name] = np.where(np.abs(values) <= LARGEST, values, np.nan)
    sound = {name: np.isfinite(values) for name, values in p.values.items()}
    silent = [name for name, mask in sound.items() if not mask.any() and name != "t"]
    # A column of text that may be data is no empty one: nothing of it is thrown away.
    unread = {f.channel for f in p.findings if f.kind == "text" and f.fix is None}
    empty = [name for name in silent if name not in unread]
    if empty:
        names = ", ".join(empty[:10]) + (f" and {len(empty) - 10} more" if len(empty) > 10 else "")
        p.add(
            "empty-column", ",".join(empty[:10]), 0.99, f"the column{'s' * (len(empty) > 1)} {names} hold no number at all",
            "Nothing can be told of what was not measured.", "Leave the column out.",
            fix={"action": "drop-column", "column": ",".join(empty)}, spoils=False,
        )  # fmt: skip
    for name in silent:
        del p.values[name], sound[name]
    _trailing(p)
    _unstamped(p)


def _words(p: WorkingCopy) -> None:
    """Cells that hold text: no numbers, and not empty either."""
    for name, cells in p.record.words.items():
        if name not in p.values or not cells:
            continue
        index = np.array(sorted(cells))
        examples = list(dict.fromkeys(cells[int(k)][:20] for k in index[:50]))[:3]
        share = len(index) / len(p)
        words = {text.strip().casefold() for text in cells.values()}
        # A mark of a missing sample is one word or two; more of them in a whole column say something.
        meant = any(c.isdigit() for text in words for c in text) or (share > _MANY and len(words) > 2)
        p.add(
            "text", name, 0.99,
            f"{len(index)} of {len(p)} cells of {name} hold text that is no number: "
            + ", ".join(repr(text) for text in examples) + f"; the first in row {p.record.line(int(index[0]))}",
            "read_trial refuses the record: the numbers that were meant are not known." if meant
            else "read_trial refuses the record: text is neither a measurement nor a missing one.",
            "Write the numbers that are meant, or state how they are written in a format file." if meant
            else "Empty these cells: nothing was measured.",
            at=index, fix=None if meant else {"action": "empty", "column": name}, spoils=meant or share > _MANY,
        )  # fmt: skip


def _trailing(p: WorkingCopy) -> None:
    n = len(p)
    filled = np.any(
        [np.isfinite(values) for name, values in p.values.items() if name != "t"] or [np.ones(n, bool)], axis=0
    )
    keep = int(np.flatnonzero(filled)[-1]) + 1 if filled.any() else 0
    if not 0 < keep < n:
        return
    p.add(
        "trailing-empty", "t", 0.99, f"the last {n - keep} rows hold no sample",
        "None: these rows say nothing.", "Leave the rows out; in a format file: [repairs] trailing = 'drop'.",
        at=np.arange(keep, n), fix={"action": "drop-trailing", "rows": n - keep}, spoils=False,
    )  # fmt: skip
    p.keep(np.arange(n) < keep, "rows at the end without any sample")


def _unstamped(p: WorkingCopy) -> None:
    """Rows with samples and no time: their time is told by the rows around them, or unknown."""
    t = p.t
    lost = ~np.isfinite(t)
    if not lost.any():
        return
    blank = lost & ~np.any(
        [np.isfinite(v) for c, v in p.values.items() if c != "t"] or [np.zeros(len(p), bool)], axis=0
    )
    if blank.any():
        p.keep(~blank, "rows without time and samples")
        t, lost = p.t, lost[~blank]
    if not lost.any() or lost.all():
        if lost.any():
            p.add(
                "no-time", "t", 0.99, "no row has a time", "Without a clock there are no rates.",
                "State the sampling interval in a format file: [clock] interval = '0.1 s'.",
            )  # fmt: skip
            p["t"], p.clockless = np.arange(len(p), dtype=float), True
        return
    index, known = np.arange(len(p)), np.flatnonzero(~lost)
    step = np.diff(t[known]) / np.diff(known)
    usual = float(np.median(step)) if step.size else 0.0
    told = np.interp(index, known, t[known])
    # The rows between two stamps are as many as the interval between them has room for.
    across = np.flatnonzero(np.diff(known) > 1)
    even = bool(usual > 0 and np.all(np.abs(step[across] - usual) < 0.1 * usual) and not lost[0] and not lost[-1])
    applied = p.add(
        "no-time", "t", 0.97 if even else 0.99, f"{counted(int(lost.sum()), 'row has', 'rows have')} samples and no time",
        "The time of these rows is unknown.",
        f"Give them the time between their neighbours: samples come every {brief(usual, 4)} s." if even
        else "Complete the clock or remove the rows; in a format file: [clock] interval.",
        at=np.flatnonzero(lost), fix={"action": "fill-stamps"} if even else None,
    )  # fmt: skip
    if applied:
        p["t"] = told
    else:
        p.keep(~lost, "rows with samples and no time")


def examine_marks(p: WorkingCopy, marks: Mapping[str, Mapping[int, float]]) -> None:
    """Say which numbers stand for a missing sample.

    Parameters
    ----------
    p : WorkingCopy
        The record as logged, NaN at these samples.
    marks : Mapping of str to Mapping of int to float
        By column and row the number that was printed.
    """
    for name, cells in marks.items():
        if name not in FIELDS or not cells:
            continue
        shown = ", ".join(f"{value:g}" for value in sorted(set(cells.values()))[:3])
        p.add(
            "sentinel", name, 0.97,
            f"{counted(len(cells), 'sample')} of {name} {'is' if len(cells) == 1 else 'are'} {shown}: no sensor shows that, it stands for a missing sample",
            "Taken for measurements, one of them outweighs the whole record.",
            "Empty these cells: shipid reads them as missing.", at=np.array(sorted(cells)),
            fix={"action": "empty", "column": name}, spoils=False,
        )  # fmt: skip
