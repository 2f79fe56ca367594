"""Uncertainty of an overshoot and of the distances of a turn: when the execute was, and the scatter of heading and positions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from shipid.foundation.statistics import NORMAL_95
from shipid.trials.measuring.rudder.executes import Execute
from shipid.trials.measuring.track import TurnTrack
from shipid.trials.signals.channel import Channel

_PEAKS = (10 / 3, 5.0)
"""Half the widths of heading about a peak whose shape is looked at, in those over which it is averaged."""

_SMOOTH = 0.003
"""Share of the overshoot by which a polynomial of degree four misses the heading about a peak, at the most, however fast the gear."""

_WHOLE = 0.02
"""Distances of values that are whole numbers of steps are so within this share of one."""

_AMISS = 10.0
"""A heading that stands still near its peak hides up to so many times what the polynomial misses; scanned are stops of 6 to 12 s."""


_SWINGS = 10.0
"""Ten samples about an execute show a glitch where they take no longer than this many half widths: a third of a swing."""

_SHARE, _FAR = 0.45, 4.0
"""Two wild samples leave this share of their error in a cubic through ten, and no scatter reaches so many times its size."""


def overshoot_uncertainty(psi: Channel, logged: Channel, execute: Execute, top: float | None, half: float) -> float:
    """Return the 95 % uncertainty of an overshoot [rad].

    The execute is anywhere in its interval, and the heading runs on meanwhile. The heading there and at the top is a mean of
    the samples around, each with its scatter; between samples that are far apart the parabola through three of them says how
    much a straight line misses.

    Parameters
    ----------
    psi, logged : Channel
        The heading, short holes bridged, and as logged.
    execute : Execute
        The execute.
    top : float or None
        Time of the extreme heading [s].
    half : float
        Half the width over which the heading is averaged [s].
    """
    k = int(np.clip(np.searchsorted(psi.t, execute.time), 1, len(psi.t) - 1))
    near = slice(max(0, k - 2), min(len(psi.t), k + 2))
    slope = float(np.polyfit(psi.t[near] - psi.t[k], psi.y[near], 1)[0])
    parts = [abs(slope) * execute.within]
    scatter = scatter_of(logged.y)
    averaged = max(1, int(np.sum(np.abs(psi.t - execute.time) <= half)))
    parts.append(2 * scatter * np.sqrt(2 / averaged))
    for when in (execute.time, top):
        if when is None:
            continue
        if np.sum(np.abs(psi.t - when) <= half) < 5:
            parts.append(_curvature(psi, when))
        hole = logged.hole(when)
        if hole is not None:
            # Bridged: a cubic through both sides; what a parabola would make of it is the size of what it can miss.
            parts.append(0.1 * _curvature(psi, when) * ((hole[1] - hole[0]) / psi.interval) ** 2 / 4)
    if top is not None:
        parts.append(_amiss(logged, top, half, max(scatter, 0.3 * (logged.digit or logged.grain or 0.0)), execute.time))
    parts.append(_astray(logged, execute.time, half, scatter))
    for when in (execute.time, top):
        # Two headings, each off by up to half a digit: 95 % of their difference lies within 0.78 of one.
        local = 0.0 if when is None else _step_at(logged, when, half)
        parts.append(0.78 / np.sqrt(2) * max(logged.digit or logged.grain or 0.0, local))
    return float(np.sqrt(np.sum(np.square(parts))))


def distance_uncertainties(
    way: TurnTrack, psi: Channel, quarters: Sequence[float | None], within: float, found: Mapping[str, float | None]
) -> dict[str, float]:
    """Return the 95 % uncertainties of the distances of a turn that are known [m].

    Each is a difference of two averaged positions along or across the course before the order, until the heading has changed by 90 or
    180 deg: both are uncertain by the scatter of the heading. The advance counts from an order that is anywhere in its interval.
    A fault that lasts as long as the turn, of the receiver or of the compass, is not in it.

    Parameters
    ----------
    way : TurnTrack
        The track, from positions.
    psi : Channel
        The heading, short holes bridged.
    quarters : sequence of float or None
        When the heading has changed by 90, 180 deg and so on [s].
    within : float
        The order is within this time of the one stated, before or after it [s].
    found : mapping of str to float or None
        What the circle measures, by name, SI.

    Returns
    -------
    dict of str to float
        By names such as ``advance_uncertainty`` and ``advance_still_water_uncertainty``.
    """
    fixes = NORMAL_95 * np.sqrt(2) * way.scatter()
    heading = NORMAL_95 * scatter_of(psi.y)
    averaged = max(1.0, float(np.sum(np.abs(psi.t - way.when) <= way.calm)))
    # At the end of a straight line through as many samples its variance is four times that of their mean.
    course, turned = 2 * heading / np.sqrt(averaged), heading / np.sqrt(max(1.0, 0.5 * averaged))
    known: dict[str, float] = {}
    for name, quarter, axis in (
        ("advance", quarters[0], 0),
        ("transfer", quarters[0], 1),
        ("tactical_diameter", quarters[1], 1),
    ):
        if quarter is None or found.get(name) is None:
            continue
        before, after = np.interp([quarter - way.calm, quarter + way.calm], psi.t, psi.y)
        sailed = np.subtract(way.moved(quarter + way.calm), way.moved(quarter - way.calm))
        # By which way the distance grows while the heading changes by so much; nothing is told of a heading that stands still there.
        later = float(sailed[axis] / abs(after - before)) if after != before else 0.0
        # Another course turns the axes, and moves the moment as well.
        along, across = way.moved(quarter)
        parts = [fixes, course * ((across if axis == 0 else -along) + later), turned * later]
        if axis == 0:
            parts.append(within * way.moved(way.when + way.calm)[0] / way.calm)
        known[f"{name}_uncertainty"] = float(np.sqrt(np.sum(np.square(parts))))
        if found.get(f"{name}_still_water") is not None:
            drifted = (found.get("drift_uncertainty") or 0.0) * (quarter - way.when)
            known[f"{name}_still_water_uncertainty"] = float(np.hypot(known[f"{name}_uncertainty"], drifted))
    return known


def scatter_of(y: np.ndarray) -> float:
    """Return the scatter from sample to sample: by the median of the third differences, which motion leaves small.

    Parameters
    ----------
    y : ndarray, shape (n,)
        The series.
    """
    if len(y) < 8:
        return 0.0
    return float(1.4826 * np.median(np.abs(np.diff(y, 3))) / np.sqrt(20))


def _amiss(psi: Channel, top: float, half: float, scatter: float, execute: float) -> float:
    """What may be wrong with a peak that is no smooth swing: the heading stood still, or leapt, or waves yaw the ship."""
    most, beyond = 0.0, abs(float(np.diff(np.interp([execute, top], psi.t, psi.y))[0]))
    for width in _PEAKS:
        near = np.abs(psi.t - top) <= width * half
        count = int(near.sum())
        if count < 10:
            continue
        at = (psi.t[near] - top) / (width * half)
        rest = psi.y[near] - np.polynomial.polynomial.polyval(at, np.polynomial.polynomial.polyfit(at, psi.y[near], 4))
        missed = (
            float(rest @ rest) / (count - 5) - scatter**2 * (1 + 4 * np.sqrt(2 / (count - 5))) - (_SMOOTH * beyond) ** 2
        )
        most = max(most, missed)
    return _AMISS * float(np.sqrt(most))


def _astray(psi: Channel, execute: float, half: float, scatter: float) -> float:
    """What may be wrong with the heading at the execute: one of the samples it is read from is off the curve through ten."""
    k = int(np.searchsorted(psi.t, execute))
    near = slice(k - 5, k + 5)
    if near.start < 0 or near.stop > len(psi.t) or psi.t[near.stop - 1] - psi.t[near.start] > _SWINGS * half:
        return 0.0
    at = psi.t[near] - execute
    rest = psi.y[near] - np.polynomial.polynomial.polyval(at, np.polynomial.polynomial.polyfit(at, psi.y[near], 3))
    most = float(np.abs(rest[3:7]).max())
    return most / _SHARE if most > _FAR * scatter + 0.5 * (psi.digit or psi.grain or 0.0) else 0.0


def _step_at(psi: Channel, when: float, half: float) -> float:
    """The step of the digits about an instant, where the values are whole numbers of it; a log of three digits has several."""
    for width in (half, 2 * half, 4 * half, 8 * half):
        values = psi.y[np.abs(psi.t - when) <= width]
        apart = np.diff(np.unique(values))
        if apart.size > 2:
            count = apart / apart.min()
            repeats = apart.size < 0.75 * values.size
            return float(apart.min()) if repeats and np.all(np.abs(count - np.round(count)) < _WHOLE) else 0.0
    return 0.0


def _curvature(psi: Channel, when: float) -> float:
    """What a straight line between two samples misses of the parabola through three."""
    k = int(np.clip(np.searchsorted(psi.t, when), 1, len(psi.t) - 2))
    return abs(float(psi.y[k - 1] - 2 * psi.y[k] + psi.y[k + 1])) / 8
