"""Speed and course over ground against positions, rate of turn and log: a late course, and a log that is off without a compass."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shipid.foundation.numbers import brief, percent
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.motion.track import UNITS_OF_SPEED
from shipid.trials.doctor.examinations.motion.way import vector_fit, way_made_good
from shipid.trials.doctor.working_copy import WorkingCopy

_LONGEST = 20.0
"""Longest delay that is looked for [s]."""
_TRIED = 100
"""So many delays are tried."""
_MOST = 4000
"""Delays are looked for with at most so many samples."""
_LEAST_TURN = np.radians(30)
"""A ship that turns less does not show a delay of its course."""
_LONGEST_DRIFT = 0.6
"""In ship lengths sailed: the course of a drifting ship follows its heading this late at most."""
_WIDEST_DRIFT = np.radians(25)
"""Largest drift angle of a ship in a turn."""
_SAME_UNIT = 0.03
"""A factor is that of a unit where it is no further from it than this, as a logarithm."""
_OFF = 0.1
"""A log that is off by less may be a matter of its place on the hull."""


def examine_over_ground(p: WorkingCopy) -> None:
    """Find a course over ground that comes late, and where no heading is logged a speed that does not fit the track.

    Parameters
    ----------
    p : WorkingCopy
        The record, its heading and rate in order.
    """
    if len(p) < 60 or p.found("clock-scale"):
        return
    if p.has("SOG", "x", "y"):
        _unit_of_speed(p)
    heading = robust.integral(p.t, p["r"]) if p.has("r") else None
    if p.has("SOG", "COG"):
        heading = _late_course(p)
    if heading is not None and p.has("u") and not p.has("psi"):
        _speed_without_heading(p, heading)


def _unit_of_speed(p: WorkingCopy) -> None:
    """Find a speed over ground in another unit than its header says, by the length of the track."""
    way = way_made_good(p, "SOG")
    if way is None or p.found("speed-stands"):
        return
    heading = p["psi"] if p.has("psi") else None
    # In a turn the way made good of a block is the chord of what is sailed.
    chord = 1.0 if heading is None else np.abs(way.integral(p.t, np.exp(1j * heading))) / way.dt
    found = robust.regress((way.integral(p.t, np.abs(p["SOG"])) * chord)[:, None], np.abs(way.made))
    if found is None or found.value[0] <= 0 or found.std[0] > 0.01 * found.value[0]:
        return
    factor = float(found.value[0])
    unit, exact = next(((u, f) for f, u in UNITS_OF_SPEED if abs(np.log(factor / f)) < _SAME_UNIT), ("", 1.0))
    if not unit:
        if abs(np.log(factor)) > _OFF:
            p.add(
                "speed-scale", "SOG", robust.confidence_of(abs(np.log(factor)) / _OFF, 0.5, 1.5),
                f"the positions move {brief(factor, 4)} times as fast as SOG says, and no current comes between the two",
                "Every speed and distance that is read from it is off by this factor.",
                "Find out where it comes from; the speed over ground follows from the positions.",
            )  # fmt: skip
        return
    applied = p.add(
        "unit", "SOG", 0.95, f"the positions move {brief(factor, 4)} times as fast as SOG says: SOG is {unit}",
        "Every speed and distance that is read from it is off by this factor.",
        f"Multiply SOG by {exact:.6g}, or write its true unit in the header.",
        fix={"action": "scale", "column": "SOG", "factor": float(exact)},
    )  # fmt: skip
    if applied:
        p["SOG"] = p["SOG"] * exact


def _late_course(p: WorkingCopy) -> np.ndarray | None:
    """Say how late the course is against positions and heading; return the heading, as late, its drift taken off [rad]."""
    usual = p.interval("COG")
    turning = next((c for c in ("psi", "r") if p.has(c)), None)
    step = max(usual / 4, float(np.ptp(p.t)) / _MOST)
    t = np.arange(p.t[0], p.t[-1], step)
    course = np.interp(t, p.t[p.own("COG")], np.unwrap(p.measured("COG")))
    reach = min(_LONGEST, float(np.ptp(p.t)) / 6)
    delays = np.linspace(0, reach, _TRIED + 1)
    of_track, gain = _behind_track(p, t, course, delays)
    of_heading, better, heading = 0.0, 1.0, None
    if turning is not None:
        own = p["psi"] if turning == "psi" else robust.integral(p.t, p["r"])
        of_heading, better, heading = _behind_heading(t, course, np.interp(t, p.t, own), delays)
        if float(np.ptp(own)) < _LEAST_TURN or better < 1.3:
            of_heading = 0.0
    than = "the heading" if turning == "psi" else "the integral of r"
    limit = max(2 * usual, 2 * float(delays[1]), 1.0)
    effect = "A drift angle of course and heading is that of the delay, and a fit to COG takes it for a slower ship."
    repair = f"Leave COG out of a fit, or shift it by {brief(-(of_track or of_heading), 3)} s; heading and rate of turn are quicker."
    if of_track >= limit and gain > 1.1:
        also = (
            f", and {brief(of_heading, 2)} s after {than} (the drift of the ship is in that)"
            if of_heading >= limit
            else ""
        )
        p.add(
            "latency", "COG", min(robust.confidence_of(of_track / limit, 0.8, 1.6), robust.confidence_of(gain, 1.05, 1.8)),
            f"COG comes about {brief(of_track, 2)} s after the course that the positions make{also}: the receiver smooths it",
            effect, repair, spoils=False,
        )  # fmt: skip
    elif heading is not None and of_heading >= limit and not p.has("x", "y"):
        # A ship that drifts outwards makes good a course that is late, too: with its length, or the angle at which it slips.
        rate = float(np.quantile(np.abs(np.gradient(heading, step)), 0.9))
        ratio = of_heading * rate / _WIDEST_DRIFT
        if p.length is not None:
            sailed = of_heading * float(np.median(np.abs(p["SOG"])))
            ratio = max(ratio, sailed / (_LONGEST_DRIFT * p.length))
        p.add(
            "latency", "COG", min(robust.confidence_of(ratio, 1, 2), robust.confidence_of(better, 1.3, 2)) if ratio > 1 else 0.0,
            f"COG comes about {brief(of_heading, 2)} s after {than}, more than the drift of a ship makes: the receiver smooths it",
            effect, repair, spoils=False,
        )  # fmt: skip
    return None if heading is None else np.interp(p.t, t, heading)


def _behind_track(p: WorkingCopy, t: np.ndarray, course: np.ndarray, delays: np.ndarray) -> tuple[float, float]:
    """How late the course is against the positions [s], and by how much the misfit is the smaller for it."""
    if not p.has("x", "y"):
        return 0.0, 1.0
    way = way_made_good(p, "SOG", "COG")
    if way is None:
        return 0.0, 1.0
    speed = np.interp(t, p.t, p["SOG"])
    begin, end = p.t[way.at[:-1]][way.kept], p.t[way.at[1:]][way.kept]
    use = end + delays[-1] <= t[-1]
    if use.sum() < 8:
        return 0.0, 1.0
    begin, end, made = begin[use], end[use], way.made[use]
    # The speed is smoothed by the same receiver, and comes as late.
    place = robust.integral(t, speed * np.exp(1j * course))

    def misfit(delay: float) -> float:
        rest = made - (np.interp(end + delay, t, place) - np.interp(begin + delay, t, place))
        return float(np.sqrt(np.mean(np.sort(np.abs(rest))[: max(8, int(0.9 * len(rest)))] ** 2)))

    return _best(delays, misfit)


def _behind_heading(
    t: np.ndarray, course: np.ndarray, heading: np.ndarray, delays: np.ndarray
) -> tuple[float, float, np.ndarray]:
    """How late the course is against a heading [s], by how much the misfit is the smaller for it, and the heading in its terms."""
    trend = np.column_stack([np.ones_like(t), (t - t[0]) / (t[-1] - t[0])])
    use = t - delays[-1] >= t[0]

    def behind(delay: float) -> np.ndarray:
        shifted = np.interp(t - delay, t, heading)
        # A compass has a deviation, and an integrated rate drifts.
        off = np.linalg.lstsq(trend[use], (course - shifted)[use], rcond=None)[0]
        return np.asarray(shifted + trend @ off)

    delay, better = _best(delays, lambda delay: float(np.std((course - behind(delay))[use])))
    return delay, better, behind(delay)


def _best(delays: np.ndarray, misfit: Callable[[float], float]) -> tuple[float, float]:
    """The delay of least misfit [s], and by how much it is the smaller; 1 where longer delays would fit better still."""
    left = np.array([misfit(delay) for delay in delays])
    best = int(np.argmin(left))
    better = 1.0 if best == len(delays) - 1 else float(left[0] / max(left[best], 1e-9))
    return float(delays[best]), better


def _speed_without_heading(p: WorkingCopy, heading: np.ndarray) -> None:
    """Compare the log with the way made good along the integral of r, turned as a whole, with a current."""
    way = way_made_good(p, "u", "r")
    if way is None:
        return
    heads = np.exp(1j * heading)
    if abs(np.mean(heads)) > 0.7:
        # A current along one course looks like a factor.
        return
    fit = vector_fit(way, way.integral(p.t, p["u"] * heads))
    if fit is None or fit.std > 0.03:
        return
    scale, limit = abs(fit.factor), max(_OFF, 7 * fit.std)
    if abs(scale - 1) > limit:
        word = "low" if scale > 1 else "high"
        p.add(
            "speed-scale", "u", min(robust.confidence_of(abs(scale - 1) / limit, 0.8, 1.8), 0.89),
            f"the track is {brief(scale, 3)} times as long as u says, a current of {brief(abs(fit.flow), 2)} m/s taken off: the log reads "
            f"{percent(abs(1 - 1 / scale))} {word}",
            "Every coefficient made dimensionless with the speed is off by this factor, those of the rudder by its square.",
            f"Multiply u by {scale:.4g}, in a format file: scale = {scale:.4g}, where other records of the ship say the same.",
            fix={"action": "scale", "column": "u", "factor": float(scale)},
        )  # fmt: skip
