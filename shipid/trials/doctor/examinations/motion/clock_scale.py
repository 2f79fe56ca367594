"""A clock that runs too fast or too slow: every rate disagrees with heading and positions by one common factor."""

from __future__ import annotations

from math import log

import numpy as np

from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.motion.way import way_made_good
from shipid.trials.doctor.working_copy import WorkingCopy

_AGREE = 0.06
"""Two factors are one up to this share: the speed of a log that has no sway misses a few per cent of the track."""
_SHARE_OF_FACTOR = 0.25
"""Factors near one have to agree to this share of their distance from one."""
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
        f"the heading changes {scale:.4g} times as fast as r says, and the positions move {along:.4g} times as fast as "
        f"{speeds}: one factor for both, so that the clock runs {1 / scale:.4g} times as fast as it should",
        "Times, time constants and every rate that is derived from heading or positions come out wrong by this factor.",
        f"Find out how the record was sampled. If r and {speeds} are right, multiply t by {scale:.4g}; scale neither of them.",
        fix={"action": "scale", "column": "t", "factor": float(scale)},
    )  # fmt: skip
    return True


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
