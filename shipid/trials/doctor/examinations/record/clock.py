"""The clock: unsorted, repeating, printed with too few digits, with gaps."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import maximum_filter1d

from shipid.foundation.numbers import brief, counted, moment, percent
from shipid.trials import checks
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.record.clock_set import examine_clock_set
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.filling import GAP

_WRONG_RATES = "Rates and accelerations taken between such stamps are wrong, and time constants with them."

#: Rows may be written several times; a clock that stands still for a larger share of a log has stopped.
_DOUBLED = 0.9
#: A clock that starts again more often than that is no sequence of runs.
_MOST_RUNS = 20
#: The later half of a clock that is printed coarsely makes so many steps at least.
_LEAST_STEPS = 3
#: Samples from which on the scatter of a clock is told, and how much smoother a channel is by the regular one.
_LEAST_JITTER, _SMOOTHER = 100, 1.3


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
        p["t"], p.clockless = np.arange(len(p), dtype=float), True
        return
    examine_clock_set(p)
    _unsorted(p)
    _doubled_rows(p)
    _several_sensors(p)
    if not _quantised(p):
        _repeats(p)
        _jitter(p)
    _gaps(p)


def _unsorted(p: WorkingCopy) -> None:
    back = np.flatnonzero(np.diff(p.t) < 0)
    if not back.size:
        return
    order = np.argsort(p.t, kind="stable")
    # Sorting is right where it makes the channels smoother; a log that starts again is two logs.
    names = [n for n in ("psi", "x", "y", "r", "u") if p.has(n)]
    rough, smooth = (sum(_roughness(p[n][way]) for n in names) for way in (slice(None), order))
    safe = not names or smooth <= 1.02 * rough
    p.add(
        "clock-unsorted", "t", 0.99, f"the clock runs backwards at {len(back)} of {len(p) - 1} steps",
        f"A model cannot be run backwards. {_WRONG_RATES}",
        "Sort the rows by time." if safe else "The log starts again: cut it where the clock jumps back.",
        at=np.unique(np.concatenate([back, back + 1])), fix={"action": "sort"} if safe else None,
    )  # fmt: skip
    if safe or len(back) > _MOST_RUNS:
        p.keep(order)
        return
    # Two runs mixed by their stamps are no run: the longest one goes on being examined.
    ends = np.concatenate(([0], back + 1, [len(p)]))
    longest = int(np.argmax(np.diff(ends)))
    rows = np.arange(len(p))
    p.keep((rows >= ends[longest]) & (rows < ends[longest + 1]), "rows of other runs: the clock starts again there")


def _roughness(values: np.ndarray) -> float:
    """Sum of the steps of a channel over its range, missing samples left out."""
    there = values[np.isfinite(values)]
    reach = float(np.ptp(there)) if there.size else 0.0
    return float(np.sum(np.abs(np.diff(there)))) / reach if reach > 0 else 0.0


def _doubled_rows(p: WorkingCopy) -> None:
    same = np.diff(p.t) == 0
    for values in p.values.values():
        same &= (np.diff(values) == 0) | (np.isnan(values[1:]) & np.isnan(values[:-1]))
    if not same.any() or len(p.values) < 2 or same.mean() > _DOUBLED:
        return
    index = np.flatnonzero(same) + 1
    p.add(
        "clock-repeats", "t", 0.99, f"{counted(len(index), 'row is', 'rows are')} written twice, stamp and values",
        "An interval of zero divides by zero, and the doubled samples weigh twice.", "Drop the second of each pair.",
        at=index, fix={"action": "drop-duplicates"},
    )  # fmt: skip
    p.keep(~np.concatenate(([False], same)), "rows written twice, stamp and values")


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
    if np.count_nonzero(d[n // 2 :]) < _LEAST_STEPS:
        return False  # a clock that stopped has no steps whose length could be told
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
        f"the clock is printed in steps of {q:g} s where samples come every {brief(slope, 6)} s{worth}",
        f"{_WRONG_RATES} Where the clock stands still, nothing can be identified at all.",
        f"Rebuild it as n × {slope:.6g} s; in a format file: [clock] interval = '{slope:.6g} s'.",
        at=np.flatnonzero(np.abs(d - slope) > 0.05 * slope), fix=fix,
    )  # fmt: skip
    if repeats:
        p.add(
            "clock-repeats", "t", 0.95, f"{counted(repeats, 'stamp repeats', 'stamps repeat')} the one before, for want of digits",
            "An interval of zero divides by zero; shipid refuses the record.", "Rebuild the clock, as above.",
            at=np.flatnonzero(d == 0) + 1, fix=fix,
        )  # fmt: skip
    p["t"] = start + slope * k
    return True


def _jitter(p: WorkingCopy) -> None:
    """Find stamps that scatter about a regular clock, by which the motion is smoother than by the stamps."""
    t, n = p.t, len(p)
    if n < _LEAST_JITTER:
        return
    k = np.arange(n, dtype=float)
    interval, start = np.polyfit(k, t, 1)
    off = t - start - interval * k
    scatter = float(np.std(off))
    # Stamps of a regular logger that are late or early by themselves: bounded, and each by its own amount.
    alone = abs(float(np.mean(off[1:] * off[:-1]))) < 0.2 * scatter**2
    if not 0.03 * interval < scatter or float(np.abs(off).max()) > interval or not alone:
        return
    rated = [
        (robust.divided_noise(t, p[name]) / max(robust.divided_noise(k * interval, p[name]), 1e-300), name)
        for name in ("psi", "x", "y", "r") if p.has(name) and np.isfinite(p[name]).all() and np.ptp(p[name]) > 0
    ]  # fmt: skip
    smoother = max(rated, default=(0.0, ""))
    if smoother[0] > _SMOOTHER:
        p.add(
            "clock-jitter", "t", robust.confidence_of(smoother[0], 1.1, 1.8),
            f"the stamps scatter by {brief(scatter, 2)} s about a clock that ticks every {brief(interval, 4)} s, and {smoother[1]} is {brief(smoother[0], 2)} times "
            "as smooth by that clock",
            f"{_WRONG_RATES} A heading is off by the rate of turn times the scatter.",
            f"Rebuild the clock as n × {interval:.6g} s; in a format file: [clock] interval = '{interval:.6g} s'.",
            fix={"action": "rebuild-clock", "interval": float(interval), "start": float(start)},
        )  # fmt: skip
        p["t"] = start + interval * k


def _several_sensors(p: WorkingCopy) -> None:
    """Make one row of those that share a stamp and have no channel in common: each sensor wrote its own."""
    mask = np.concatenate(([False], np.diff(p.t) == 0))
    if mask.any() and _complementary(p, mask):
        index = np.flatnonzero(mask)
        applied = p.add(
            "clock-repeats", "t", 0.97, f"{counted(len(index), 'row shares its', 'rows share their')} stamp with the row before, and the channels of the two complete one another",
            "None in shipid once they are one row: each sensor wrote a row of its own.",
            "Make one row of those with one stamp.", at=index, fix={"action": "merge-rows"}, spoils=False,
        )  # fmt: skip
        if applied:
            _merge(p, mask)


def _repeats(p: WorkingCopy) -> None:
    same = np.diff(p.t) == 0
    if not same.any():
        return
    index = np.flatnonzero(same) + 1
    mask = np.concatenate(([False], same))
    stamp = p.t.copy()
    dt = float(np.median(np.diff(stamp)[~same]))
    spread = np.interp(np.arange(len(stamp)), np.flatnonzero(~mask), stamp[~mask])
    # The clock stood still and caught up: the stamps between can be told. It went on as if nothing was: rows too many.
    caught_up = bool(np.all(np.diff(spread) > 0.2 * dt)) and not mask[-1]
    p.add(
        "clock-repeats", "t", 0.99, f"{counted(len(index), 'stamp repeats', 'stamps repeat')} the one before, with other values in the row",
        "An interval of zero divides by zero; shipid refuses the record.",
        "Spread the stamps between their neighbours: the clock stood still and caught up." if caught_up
        else "Find out which of the rows is right, or state [clock] interval in a format file.",
        at=index, fix={"action": "spread-stamps"} if caught_up else None,
    )  # fmt: skip
    if caught_up:
        p["t"] = spread
    else:
        p.keep(~mask, "rows with the stamp of the row before and other values")


def _complementary(p: WorkingCopy, mask: np.ndarray) -> bool:
    """Whether no channel has two samples at one stamp."""
    group = np.cumsum(~mask)
    channels = [np.isfinite(values) for name, values in p.values.items() if name != "t"]
    return len(channels) > 1 and all(bool(np.bincount(group[there]).max(initial=0) <= 1) for there in channels)


def _merge(p: WorkingCopy, mask: np.ndarray) -> None:
    group = np.cumsum(~mask) - 1
    merged = {}
    for name, values in p.values.items():
        if name != "t":
            there = np.isfinite(values)
            merged[name] = np.full(int(group[-1]) + 1, np.nan)
            merged[name][group[there]] = values[there]
    p.keep(~mask, "rows joined with the row of the same stamp, none of their samples lost")
    for name, values in merged.items():
        p[name] = values


def _usual(p: WorkingCopy) -> tuple[float, float]:
    """Median interval of the clock, and from which length on an interval is a gap, signals with clocks of their own considered [s]."""
    d = np.diff(p.t)
    dt = float(np.median(d))
    own = [np.diff(p.t[np.isfinite(values)]) for name, values in p.values.items() if name != "t"]
    usual = min((float(np.median(steps)) for steps in own if steps.size > 3), default=dt)
    if robust.spread(d) < 0.2 * dt and usual < 1.5 * dt:
        return dt, 2.5 * dt
    return max(usual, dt), GAP * max(usual, dt, float(np.quantile(d, 0.9)))


def _gaps(p: WorkingCopy) -> None:
    d = np.diff(p.t)
    if not d.size:
        return
    dt, limit = _usual(p)
    found = np.flatnonzero(d > limit)
    if not found.size:
        return
    longest = int(found[np.argmax(d[found])])
    lost = int(np.sum(np.round(d[found] / dt) - 1))
    missed = max(
        (_bend(p, name, int(k)) for k in found[np.argsort(d[found])[-10:]] for name in ("psi", "delta", "r")),
        default=0.0,
    )
    share = lost / (lost + len(p))
    meanwhile = (
        f"; the motion bends meanwhile, and a line across misses about {percent(missed)} of its range"
        if missed > 0.05
        else ""
    )
    p.add(
        "gap", "t", robust.confidence_of(float(d[longest]) / limit, 0.8, 2.2),
        f"{counted(len(found), 'gap')}, about {counted(lost, 'sample')} missing, the longest {brief(d[longest], 4)} s from {moment(p.t[longest])} s{meanwhile}",
        "What ship and rudder did meanwhile is unknown: nothing is measured across a gap, and no simulation runs through it.",
        "Use the stretches on either side (FILE@A:B).", at=np.unique(np.r_[found, found + 1]),
        spoils=missed > 0.05 or share > 0.3,
    )  # fmt: skip


def _bend(p: WorkingCopy, name: str, k: int) -> float:
    """By how much of its range a line across the gap behind sample `k` may miss a channel."""
    if not p.has(name):
        return 0.0
    there = np.isfinite(p[name])
    before, after = (
        np.flatnonzero(there[part]) + part.start for part in (slice(max(k - 7, 0), k + 1), slice(k + 1, k + 9))
    )
    reach = float(np.ptp(p[name][there])) if there.any() else 0.0
    if min(len(before), len(after)) < 3 or reach == 0:
        return 0.0
    values, t = p[name], p.t
    length = float(t[after[0]] - t[before[-1]])
    line = float(values[after[0]] - values[before[-1]]) / length
    slopes = [np.polyfit(t[part] - t[part[0]], values[part], 1)[0] for part in (before, after)]
    # The slope through six samples is known to their noise only.
    unsure = 3 * robust.noise(values[there]) / (4.2 * p.sampling)
    bend = 4 / 27 * max(0.0, max(abs(float(slope) - line) for slope in slopes) - unsure) * length / reach
    return max(bend, abs(line) * length / reach if name == "delta" and abs(line) * length > 0.2 * reach else 0.0)
