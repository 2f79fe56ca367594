"""Measure a zig-zag: executes, overshoot angles, period, reach, initial turning."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from shipid.trials.errors import NotAManoeuvreError
from shipid.trials.measuring.executes import convention, first_execute, leaves
from shipid.trials.measuring.measures import ZigZag
from shipid.trials.measuring.track import speed
from shipid.trials.signals import series
from shipid.trials.signals.plates import plates, regular
from shipid.trials.trial import Trial

_WIDTH = 0.03
"""Local fits and averages span this share of the time between two reversals, on either side."""


def overshoots_of(
    t: np.ndarray,
    psi: np.ndarray,
    executes: Sequence[float],
    *,
    side: int | None = None,
    end: float | None = None,
) -> tuple[float | None, ...]:
    """Return the overshoot angle after each execute: how far the heading goes on beyond its value there.

    With the executes of a measured trial and a predicted heading, these are the predicted overshoots.

    Parameters
    ----------
    t, psi : array_like, shape (n,)
        Time [s] and heading, unwrapped [rad].
    executes : sequence of float, length m
        Times of the rudder reversals [s]: the second execute and on.
    side : {1, -1}, optional
        Side to which the heading overshoots after the first of them (1 is starboard); None reads it from the
        heading.
    end : float, optional
        When the last swing ends [s]; the end of the record by default.

    Returns
    -------
    tuple of float or None, length m
        Overshoot angles [rad]; None where the record ends before the heading turns back.
    """
    t, psi = np.asarray(t, dtype=float), np.asarray(psi, dtype=float)
    return tuple(swing[0] for swing in swings(t, psi, executes, side=side, end=end))


def swings(
    t: np.ndarray, psi: np.ndarray, executes: Sequence[float], *, side: int | None, end: float | None
) -> list[tuple[float | None, float | None, float]]:
    """Return overshoot [rad], time of the extreme heading [s] and heading at the execute [rad], a reversal each.

    Parameters
    ----------
    t, psi, executes, side, end
        As for `overshoots_of`.
    """
    if not len(executes):
        return []
    stop = float(t[-1]) if end is None else end
    bounds = [*(float(e) for e in executes), stop]
    half = _WIDTH * _half_period(bounds)
    at = [series.value_at(t, psi, when, half, 1) for when in bounds[:-1]]
    first = side or _first_side(t, psi, at, bounds[0])
    result: list[tuple[float | None, float | None, float]] = []
    for k, (start, finish) in enumerate(pairwise(bounds)):
        sign = first * (-1) ** k
        a, b = np.searchsorted(t, [start, finish], side="left")
        stretch = slice(int(a), min(int(b) + 1, len(t)))
        top = series.maximum(t[stretch], sign * psi[stretch], half)
        if top is None:
            result.append((None, None, at[k]))
        else:
            result.append((max(0.0, top[1] - sign * at[k]), top[0], at[k]))
    return result


def _half_period(bounds: Sequence[float]) -> float:
    # The last bound is the end of the record, not a reversal; alone it still gives the order of magnitude.
    steps = np.diff(bounds[:-1]) if len(bounds) > 2 else np.diff(bounds)
    return max(float(np.median(steps)), 0.0)


def _first_side(t: np.ndarray, psi: np.ndarray, at: Sequence[float], start: float) -> int:
    """The side the heading has gone to by the first reversal."""
    if len(at) > 1:
        signs = (-1.0) ** np.arange(len(at))
        return 1 if float(signs @ (np.array(at) - np.mean(at))) >= 0 else -1
    before = psi[t <= start]
    return 1 if not before.size or at[0] >= before[0] else -1


def measure_zigzag(trial: Trial, execute: str | None, length: float | None) -> ZigZag:
    """Measure a zig-zag (see `shipid.trials.measure`).

    Parameters
    ----------
    trial : Trial
        The trial, or a window of it, with heading and rudder.
    execute : {"moved", "order"} or None
        How the execute is read.
    length : float or None
        Ship length [m].

    Returns
    -------
    ZigZag

    Raises
    ------
    NotAManoeuvreError
        If the rudder never goes from one plate to the opposite one.
    """
    execute, rudder = convention(trial, execute)
    t, psi = trial["t"], trial["psi"]
    held = regular(plates(rudder))
    if len(held) < 2:
        raise NotAManoeuvreError(
            f"trial '{trial.name}' is no zig-zag: the rudder does not go from one held angle to the opposite one. "
            "Choose the window of the manoeuvre (FILE@start:end), or state its kind."
        )
    executes = [leaves(t, rudder, plate, execute) for plate in held[:-1]]
    side = held[0].side
    end = float(t[min(held[-1].last, len(t) - 1)])
    found = swings(t, psi, executes, side=side, end=end)
    at = np.array([heading for _, _, heading in found])
    start = first_execute(t, rudder, held[0], execute)
    if start is not None and (held[0].first == 0 or start[0] >= executes[0]):
        start = None
    course = _course(t, psi, at, side, start[0] if start else None)
    signs = side * (-1.0) ** np.arange(len(at))
    change = float(np.median(signs * (at - course)))
    # The nominal heading is the one at the order: in slow steering gear the ship turns on while the rudder moves.
    ordered = [float(np.interp(leaves(t, rudder, plate, "order"), t, psi)) for plate in held[:-1]]
    switch = float(np.median(signs * (np.array(ordered) - course)))
    angle = float(np.median([abs(plate.angle) for plate in held]))
    first = start[0] if start else None
    moving = speed(trial)
    distance = None
    if first is not None and moving is not None:
        during = (t >= first) & (t <= executes[0])
        if during.sum() > 1:
            distance = float(np.trapezoid(moving[during], t[during]))
    cycles = [b - a for a, b in zip(executes, executes[2:])]
    half = _WIDTH * _half_period([*executes, end])
    return ZigZag(
        trial=trial.name,
        execute=execute,
        nominal=f"{_nominal(max(abs(plate.angle) for plate in held))}/{_nominal(switch)}",
        first_side="starboard" if side > 0 else "port",
        rudder=angle,
        heading=change,
        course=course,
        approach_speed=None if moving is None or first is None else series.value_at(t, moving, first, half, 1),
        first_execute=first,
        executes=tuple(executes),
        execute_headings=tuple(float(v) for v in at - course),
        overshoots=tuple(swing[0] for swing in found),
        extreme_headings=tuple(
            None if swing[0] is None else float(swing[2] + s * swing[0] - course) for swing, s in zip(found, signs)
        ),
        times_to_check_yaw=tuple(None if w is None else w - e for (_, w, _), e in zip(found, executes)),
        period=float(np.mean(cycles)) if cycles else None,
        reach=_reach(t, psi, course, side, first, executes[0]),
        initial_turning_time=None if first is None else executes[0] - first,
        initial_turning_distance=distance,
        initial_turning_ratio=None if distance is None or length is None else distance / length,
    )


def _course(t: np.ndarray, psi: np.ndarray, at: np.ndarray, side: int, first: float | None) -> float:
    """The initial course: the heading at the first execute if that fits the reversals, else their middle."""
    if len(at) < 2:
        return float(np.interp(first, t, psi)) if first is not None else float(psi[0])
    middle = 0.5 * float(np.median(at[0::2]) + np.median(at[1::2]))
    if first is None:
        return middle
    before = float(np.interp(first, t, psi))
    # Hand steering before the zig-zag leaves the ship off the course that the reversals are steered about.
    swing = 0.5 * abs(float(np.median(at[0::2]) - np.median(at[1::2])))
    return before if abs(before - middle) < 0.15 * swing else middle


def _nominal(angle: float) -> int:
    degrees = float(np.degrees(angle))
    return max(5 * round(degrees / 5), 5) if degrees >= 2.5 else round(degrees)


def _reach(
    t: np.ndarray, psi: np.ndarray, course: float, side: int, first: float | None, second: float
) -> float | None:
    if first is None:
        return None
    after = t > second
    back = series.crossing(t[after], -side * (psi[after] - course), 0.0)
    return None if back is None else back - first
