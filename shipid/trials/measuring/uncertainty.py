"""Uncertainty of an overshoot: when the execute was, the scatter of the heading, and how densely it is sampled."""

from __future__ import annotations

import numpy as np

from shipid.trials.measuring.rudder.executes import Execute
from shipid.trials.signals.channel import Channel


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
    scatter = _scatter(logged.y)
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
    step = logged.digit or logged.grain
    if step is not None:
        # Two headings, each off by up to half a digit: 95 % of their difference lies within 0.78 of one.
        parts.append(0.78 * step)
    return float(np.sqrt(np.sum(np.square(parts))))


def _scatter(y: np.ndarray) -> float:
    """Scatter from sample to sample: the median of the third differences, which motion leaves small."""
    if len(y) < 8:
        return 0.0
    return float(1.4826 * np.median(np.abs(np.diff(y, 3))) / np.sqrt(20))


def _curvature(psi: Channel, when: float) -> float:
    """What a straight line between two samples misses of the parabola through three."""
    k = int(np.clip(np.searchsorted(psi.t, when), 1, len(psi.t) - 2))
    return abs(float(psi.y[k - 1] - 2 * psi.y[k] + psi.y[k + 1])) / 8
