"""A clock that runs too fast or too slow: every rate disagrees with heading and positions by one common factor."""

from __future__ import annotations

from math import log

import numpy as np

from shipid.foundation.numbers import brief
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.motion.way import way_made_good
from shipid.trials.doctor.working_copy import WorkingCopy

_AGREE = 0.06
"""Two factors are one up to this share: the speed of a log that has no sway misses a few per cent of the track."""
_SHARE_OF_FACTOR = 0.25
"""Factors near one have to agree to this share of their distance from one."""
#: Beyond these no ship turns, puts her rudder over, or sails [deg/s, deg/s, m/s]; models of a metre do not, either.
_FASTEST_TURN, _FASTEST_RUDDER, _FASTEST = 60.0, 150.0, 40.0
#: Slower than these under rudder, all of them, no ship is [deg/s, deg/s, m/s].
_SLOWEST_TURN, _SLOWEST_RUDDER, _SLOWEST = 0.05, 0.25, 0.02
_BLOCKS = 60
"""A ship turns and moves little in so many parts of a record."""
_PROPOSED = 0.85
"""The clock is the simplest explanation and not the only one: it is named, and never changed without being asked."""


def examine_clock_scale(p: WorkingCopy, scale: float, std: float) -> bool:
    """Name the clock where the speed disagrees with the positions by the factor of the rate of turn with the heading.

    Parameters
    ----------
    p : WorkingCopy
        The record, its heading unwrapped.
    scale : float
        How many times as fast as r says the heading changes.
    std : float
        Its standard deviation.

    Returns
    -------
    bool
        Whether the clock was named, so that neither rate of turn nor speed is to be scaled.
    """
    found = _way_scale(p)
    if found is None:
        return False
    along, rough = found
    uncertain = 3 * float(np.hypot(std / scale, rough / along))
    apart = abs(log(along / scale))
    if apart > max(min(_AGREE, _SHARE_OF_FACTOR * abs(log(scale))), min(uncertain, _AGREE)):
        return False
    if abs(along - 1) <= 5 * rough:
        return False
    speeds = ",".join(c for c in ("U", "u", "SOG") if p.has(c))
    p.add(
        "clock-scale", "t", _PROPOSED,
        f"the heading changes {brief(scale, 4)} times as fast as r says, and the positions move {brief(along, 4)} times as fast as "
        f"{speeds}: one factor for both, so that the clock runs {brief(1 / scale, 4)} times as fast as it should",
        "Times, time constants and every rate that is derived from heading or positions come out wrong by this factor.",
        f"Find out how the record was sampled. If r and {speeds} are right, multiply t by {brief(scale, 4)}; scale neither of them.",
        fix={"action": "scale", "column": "t", "factor": float(scale)},
    )  # fmt: skip
    return True


def examine_lone_clock(p: WorkingCopy) -> None:
    """Find a clock in another unit by what no ship does, where no two channels tell its speed; say so where that is all there is.

    Parameters
    ----------
    p : WorkingCopy
        The record, examined.
    """
    compared = p.has("r", "psi") or (p.has("x", "y") and (p.speed is not None or p.has("SOG")))
    if compared or not p.has("psi") or p.rudder is None or len(p) < 60 or p.found("clock-scale"):
        return
    # Over many samples: from one to the next a fast log moves by the noise of its sensors.
    apart = max(1, len(p) // _BLOCKS)
    lasts = p.t[apart:] - p.t[:-apart]
    turning = float(np.degrees(np.quantile(np.abs(p["psi"][apart:] - p["psi"][:-apart]) / lasts, 0.95)))
    rudder = float(np.degrees(_rate_on_ramps(p.t, p[p.rudder])))
    reach = float(np.degrees(np.ptp(np.quantile(p[p.rudder], [0.01, 0.99]))))
    told = [f"the ship turns by {brief(turning, 3)} deg/s"] + (
        [f"the rudder moves by {brief(rudder, 3)} deg/s"] if rudder else []
    )
    fast = turning > _FASTEST_TURN or rudder > _FASTEST_RUDDER
    slow = reach > 10 and 0 < turning < _SLOWEST_TURN and rudder < _SLOWEST_RUDDER
    if p.has("x", "y"):
        moved = (p[c][apart:] - p[c][:-apart] for c in ("x", "y"))
        speed = float(np.quantile(np.hypot(*moved) / lasts, 0.5))
        told.append(f"she makes {brief(speed, 3)} m/s")
        fast, slow = fast or speed > _FASTEST, slow or (reach > 10 and 0 < speed < _SLOWEST)
    if fast or slow:
        p.add(
            "clock-scale", "t", _PROPOSED, f"by this clock {', '.join(told)}: no ship is so {'fast' if fast else 'slow'}, so the clock counts in "
            "another unit",
            "Times, time constants and every rate that is derived from heading or positions come out wrong by this factor.",
            "State the unit of the clock, in the header or in a format file.",
        )  # fmt: skip
        return
    if p.record.source.start is None:
        p.not_known.append(
            "Not known: whether the clock runs at the right speed. Nothing is logged that could tell, such as a rate of turn beside the "
            "heading, or a speed beside positions: times, periods and time constants stand on the clock alone."
        )


def _rate_on_ramps(t: np.ndarray, rudder: np.ndarray) -> float:
    """Usual rate of the rudder where it moves on at about one rate for four samples; 0 where it does not."""
    rate = np.diff(rudder) / np.diff(t)
    size = np.abs(rate)
    moving = size > 0.3 * float(np.quantile(size, 0.995)) if size.any() else np.zeros(size.shape, dtype=bool)
    inner = (
        moving[1:-1]
        & moving[:-2]
        & moving[2:]
        & (np.sign(rate[1:-1]) == np.sign(rate[:-2]))
        & (np.sign(rate[1:-1]) == np.sign(rate[2:]))
    )
    return float(np.median(size[1:-1][inner])) if inner.any() else 0.0


def clock_factor(p: WorkingCopy) -> float:
    """Return what the integral of a rate is multiplied by to be compared with a heading, 1 where the clock is sound.

    Parameters
    ----------
    p : WorkingCopy
        The record; whether its clock is off has been looked at.
    """
    found = (f.fix["factor"] for f in p.findings if f.kind == "clock-scale" and f.fix is not None)
    return next((float(factor) for factor in found if isinstance(factor, float)), 1.0)


def _way_scale(p: WorkingCopy) -> tuple[float, float] | None:
    """Length of the track over the way that the speed says, with its standard deviation."""
    speed = p.speed if p.speed is not None else p["SOG"] if p.has("SOG") else None
    if speed is None or not p.has("x", "y", "psi"):
        return None
    way = way_made_good(p, *(c for c in ("psi", "u", "v", "U") if p.has(c)))
    if way is None:
        return None
    # In a turn the way made good of a block is the chord of what is sailed.
    chord = np.abs(way.integral(p.t, np.exp(1j * p["psi"]))) / way.dt
    found = robust.regress((way.integral(p.t, np.abs(speed)) * chord)[:, None], np.abs(way.made))
    if found is None or not found.value[0] > 0:
        return None
    return float(found.value[0]), float(found.std[0])
