"""The clock: unsorted, repeating, printed with too few digits, with gaps."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import maximum_filter1d

from shipid.trials import checks
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.working_copy import WorkingCopy

_WRONG_RATES = "Rates and accelerations taken between such stamps are wrong, and time constants with them."


def examine_clock(p: WorkingCopy) -> None:
    """Examine the time stamps and put the working copy in order.

    Parameters
    ----------
    p : WorkingCopy
        The record.
    """
    if len(p) < checks.FEWEST_SAMPLES:
        return
    if float(np.ptp(p.t)) == 0:
        p.add(
            "clock-repeats", "t", 0.99, f"all {len(p)} stamps are the same",
            "Without a clock there are no rates, and nothing can be identified.",
            "State the sampling interval in a format file: [clock] interval = '0.1 s'.",
        )  # fmt: skip
        p["t"] = np.arange(len(p), dtype=float)
        return
    _unsorted(p)
    _doubled_rows(p)
    if not _quantised(p):
        _repeats(p)
    _gaps(p)


def _unsorted(p: WorkingCopy) -> None:
    back = np.flatnonzero(np.diff(p.t) < 0)
    if not back.size:
        return
    order = np.argsort(p.t, kind="stable")
    # Sorting is right where it makes the channels smoother; a log that starts again is two logs.
    names = [n for n in ("psi", "x", "y", "r", "u") if p.has(n)]
    rough = sum(float(np.sum(np.abs(np.diff(p[n])))) / (float(np.ptp(p[n])) or 1.0) for n in names)
    smooth = sum(float(np.sum(np.abs(np.diff(p[n][order])))) / (float(np.ptp(p[n])) or 1.0) for n in names)
    safe = not names or smooth <= 1.02 * rough
    p.add(
        "clock-unsorted", "t", 0.99, f"the clock runs backwards at {len(back)} of {len(p) - 1} steps",
        f"A model cannot be run backwards. {_WRONG_RATES}",
        "Sort the rows by time." if safe else "The log starts again: cut it where the clock jumps back.",
        at=np.unique(np.concatenate([back, back + 1])), fix={"action": "sort"} if safe else None,
    )  # fmt: skip
    p.keep(order)


def _doubled_rows(p: WorkingCopy) -> None:
    same = np.diff(p.t) == 0
    for values in p.values.values():
        same &= np.diff(values) == 0
    if not same.any() or len(p.values) < 2 or same.mean() > 0.5:
        return
    index = np.flatnonzero(same) + 1
    p.add(
        "clock-repeats", "t", 0.99, f"{len(index)} rows are written twice, stamp and values",
        "An interval of zero divides by zero, and the doubled samples weigh twice.", "Drop the second of each pair.",
        at=index, fix={"action": "drop-duplicates"},
    )  # fmt: skip
    p.keep(~np.concatenate(([False], same)))


def printed_step(t: np.ndarray) -> float:
    """Return the coarsest decimal step that the stamps of the later half keep to [s]; 0 where there is none.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time stamps [s].
    """
    late = t[len(t) // 2 :]
    for exponent in range(3, -7, -1):
        for digit in (5, 2, 1):
            q = digit * 10.0**exponent
            off = np.abs(late / q - np.round(late / q))
            if np.mean(off < 1e-5 + 1e-9 * np.abs(late) / q) > 0.99:
                return q
    return 0.0


def _quantised(p: WorkingCopy) -> bool:
    t, n = p.t, len(p)
    d = np.diff(t)
    k = np.arange(n, dtype=float)
    slope, start = np.polyfit(k, t, 1)
    if slope <= 0 or np.mean(np.abs(d - slope) > 0.05 * slope) < 0.2:
        return False
    q = printed_step(t)
    # Significant digits get lost as the clock grows: the stamps weigh by the steps around them.
    size = maximum_filter1d(np.concatenate((d, d[-1:])), min(n, 2 * int(q / slope) + 3) if q else 3)
    slope, start = np.polyfit(k, t, 1, w=1 / np.maximum(size, 1e-12))
    off = np.abs(t - start - slope * k)
    if q == 0 or float(np.quantile(off, 0.99)) > 0.75 * q or q < 0.04 * slope:
        return False
    repeats = int(np.sum(d == 0))
    worth = "" if not repeats else f" and repeats at {repeats} of {n - 1} steps"
    fix = {"action": "rebuild-clock", "interval": float(slope), "start": float(start)}
    p.add(
        "clock-quantised", "t", 0.95,
        f"the clock is printed in steps of {q:g} s where samples come every {slope:.6g} s{worth}",
        f"{_WRONG_RATES} Where the clock stands still, nothing can be identified at all.",
        f"Rebuild it as n × {slope:.6g} s; in a format file: [clock] interval = '{slope:.6g} s'.",
        at=np.flatnonzero(np.abs(d - slope) > 0.05 * slope), fix=fix,
    )  # fmt: skip
    if repeats:
        p.add(
            "clock-repeats", "t", 0.95, f"{repeats} stamps repeat the one before, for want of digits",
            "An interval of zero divides by zero; shipid refuses the record.", "Rebuild the clock, as above.",
            at=np.flatnonzero(d == 0) + 1, fix=fix,
        )  # fmt: skip
    p["t"] = start + slope * k
    return True


def _repeats(p: WorkingCopy) -> None:
    same = np.diff(p.t) == 0
    if not same.any():
        return
    index = np.flatnonzero(same) + 1
    dt = float(np.median(np.diff(p.t)[~same]))
    stamp = p.t.copy()
    mask = np.concatenate(([False], same))
    spread = np.interp(np.arange(len(stamp)), np.flatnonzero(~mask), stamp[~mask])
    # The clock stood still and caught up: the stamps between can be told. It went on as if nothing was: rows too many.
    caught_up = bool(np.all(np.diff(spread) > 0.2 * dt)) and not mask[-1]
    fix = {"action": "spread-stamps" if caught_up else "drop-repeats"}
    p.add(
        "clock-repeats", "t", 0.99, f"{len(index)} stamps repeat the one before, with other values in the row",
        "An interval of zero divides by zero; shipid refuses the record.",
        "Spread the stamps between their neighbours: the clock stood still and caught up."
        if caught_up else "Keep the first row of each stamp.",
        at=index, fix=fix,
    )  # fmt: skip
    if caught_up:
        p["t"] = spread
    else:
        p.keep(~mask)


def _gaps(p: WorkingCopy) -> None:
    d = np.diff(p.t)
    dt = float(np.median(d))
    found = np.flatnonzero(d > 2.5 * dt)
    regular = robust.spread(d) < 0.2 * dt
    if not found.size or not regular:
        return
    longest = int(found[np.argmax(d[found])])
    lost = int(np.sum(np.round(d[found] / dt) - 1))
    p.add(
        "gap", "t", robust.confidence_of(float(d[longest]) / dt, 2, 5.5),
        f"{len(found)} gaps, about {lost} samples missing, the longest {d[longest]:.4g} s from {p.t[longest]:.6g} s",
        "What the rudder did meanwhile is unknown: a simulation through the gap starts the rest from a wrong state.",
        "Identify from the stretches on either side (FILE@A:B).", at=found,
    )  # fmt: skip
