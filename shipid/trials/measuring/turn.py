"""Measure a turning circle and its pull-out."""

from __future__ import annotations

from math import pi

import numpy as np

from shipid.trials.errors import NotAManoeuvreError
from shipid.trials.measuring.executes import LEFT, convention, first_execute
from shipid.trials.measuring.measures import TurningCircle
from shipid.trials.measuring.track import drift, speed, track
from shipid.trials.signals import series
from shipid.trials.signals.plates import Plate, plates
from shipid.trials.trial import Trial

MOVED = np.radians(3.0)
"""In a turn the rudder counts as moved when it is this far from midships: the reading of the published circle."""

_QUARTERS = (pi / 2, pi, 1.5 * pi, 2 * pi)


def turning_plate(trial: Trial, rudder: np.ndarray) -> Plate | None:
    """Return the plate during which the heading changes most, if it changes by 90 deg or more.

    Parameters
    ----------
    trial : Trial
        The trial.
    rudder : ndarray, shape (n,)
        Rudder angle [rad].
    """
    psi = trial["psi"]
    best = max(
        plates(rudder), key=lambda p: p.side * (psi[p.last - 1] - psi[p.first]), default=None
    )  # fmt: skip
    if best is None or best.side * (psi[best.last - 1] - psi[best.first]) < pi / 2:
        return None
    return best


def measure_turn(trial: Trial, execute: str | None, length: float | None) -> TurningCircle:
    """Measure a turning circle (see `shipid.trials.measure`).

    Parameters
    ----------
    trial : Trial
        The trial, or a window of it, with heading and rudder.
    execute : {"moved", "order"} or None
        How the execute is read; "moved" is 3 deg of rudder here.
    length : float or None
        Ship length [m].

    Returns
    -------
    TurningCircle

    Raises
    ------
    NotAManoeuvreError
        If the heading never changes by 90 deg on one rudder, or the record begins in the turn.
    """
    execute, rudder = convention(trial, execute)
    t, psi = trial["t"], trial["psi"]
    plate = turning_plate(trial, rudder)
    if plate is None:
        raise NotAManoeuvreError(
            f"trial '{trial.name}' is no turning circle: the heading does not change by 90 deg on one rudder angle. "
            "Choose the window of the manoeuvre (FILE@start:end), or state its kind."
        )
    start = first_execute(t, rudder, plate, execute, moved=MOVED)
    if start is None:
        raise NotAManoeuvreError(
            f"trial '{trial.name}' begins with the rudder over already, so the moment of the order is not in it. "
            "Widen the window to hold a stretch before the rudder moves."
        )
    side, when = plate.side, start[0]
    released = _released(rudder, plate)
    calm = max(5 * trial.sampling, 0.01 * (t[released - 1] - when))
    # The course before the order: the ship turns after it, so nothing of that may be averaged in.
    before = slice(int(np.searchsorted(t, when - 2 * calm)), int(np.searchsorted(t, when, side="right")))
    course = series.value_at(t[before], psi[before], when, 2.1 * calm, 1)
    turned = side * (psi - course)
    running = slice(int(np.searchsorted(t, when)), released)
    quarters = [series.crossing(t[running], series.smoothed(t, turned, calm)[running], q) for q in _QUARTERS]
    moving = speed(trial)
    found: dict[str, float | None] = {}
    path = track(trial)
    if path is not None:
        found |= _distances(t, path[0], path[1], course, side, when, quarters, calm)
    found |= _steady(trial, turned, quarters, running, moving, calm)
    approach = None if moving is None else series.value_at(t, moving, when, calm, 1)
    steady_speed, rate = found.get("steady_speed"), found.get("steady_rate")
    if steady_speed is not None and approach:
        found["speed_loss"] = 1 - steady_speed / approach
    if steady_speed is not None and rate:
        found["steady_diameter"] = 2 * steady_speed / rate
    if length is not None:
        names = ("advance", "transfer", "tactical_diameter", "steady_diameter")
        found |= {f"{n}_ratio": value / length for n in names if (value := found.get(n)) is not None}
    return TurningCircle(
        trial=trial.name,
        execute=execute,
        side="starboard" if side > 0 else "port",
        track="" if path is None else path[2],
        rudder=plate.angle,
        approach_speed=approach,
        first_execute=when,
        course=course,
        times=tuple(None if q is None else q - when for q in quarters),
        speeds=tuple(None if q is None or moving is None else series.value_at(t, moving, q, calm, 1) for q in quarters),
        pull_out_rate=_pull_out(trial, rudder, plate, released),
        **found,
    )


def _released(rudder: np.ndarray, plate: Plate) -> int:
    """The sample at which the rudder comes off its plate for good, the end of the record at the latest."""
    on = np.flatnonzero(plate.side * rudder[: plate.last] >= (1 - LEFT) * abs(plate.angle))
    return int(on[-1]) + 1


def _distances(
    t: np.ndarray,
    north: np.ndarray,
    east: np.ndarray,
    course: float,
    side: int,
    when: float,
    quarters: list[float | None],
    calm: float,
) -> dict[str, float | None]:
    """Advance, transfer and tactical diameter, along and across the initial course."""
    c, s = np.cos(course), np.sin(course)
    along, across = c * north + s * east, side * (c * east - s * north)

    def travelled(y: np.ndarray, at: float | None) -> float | None:
        return None if at is None else series.value_at(t, y, at, calm) - series.value_at(t, y, when, calm)

    return {
        "advance": travelled(along, quarters[0]),
        "transfer": travelled(across, quarters[0]),
        "tactical_diameter": travelled(across, quarters[1]),
    }


def _steady(
    trial: Trial,
    turned: np.ndarray,
    quarters: list[float | None],
    running: slice,
    moving: np.ndarray | None,
    calm: float,
) -> dict[str, float | None]:
    """Rate, speed and drift angle of the steady turn: its last quarter, where it goes beyond 270 deg."""
    t = trial["t"]
    if quarters[2] is None:
        return {}
    end = t[running.stop - 1]
    begin = max(quarters[2], end - 0.25 * (end - t[running.start]))
    stretch = slice(int(np.searchsorted(t, begin)), running.stop)
    if stretch.stop - stretch.start < 5 or t[stretch.stop - 1] - t[stretch.start] < 2 * calm:
        return {}
    if trial.has("r"):
        rate = abs(float(np.mean(trial["r"][stretch])))
    else:
        rate = float(np.polynomial.polynomial.polyfit(t[stretch] - t[stretch.start], turned[stretch], 1)[1])
    sideways = drift(trial)
    return {
        "steady_rate": rate,
        "steady_speed": None if moving is None else float(np.mean(moving[stretch])),
        "steady_drift": None if sideways is None else abs(float(np.mean(sideways[stretch]))),
    }


def _pull_out(trial: Trial, rudder: np.ndarray, plate: Plate, released: int) -> float | None:
    """Rate of turn left when the rudder has been midships for a while: the last fifth of what is recorded of it."""
    t = trial["t"]
    after = np.flatnonzero(np.abs(rudder[released:]) < 0.1 * abs(plate.angle))
    if not after.size:
        return None
    begin = released + int(after[0])
    # The rate takes about as long to settle as the ship takes to turn by some 60 deg.
    settled = t[-1] - t[begin] > 0.1 * (t[released - 1] - t[plate.first]) and len(t) - begin >= 10
    if np.any(np.abs(rudder[begin:]) >= 0.2 * abs(plate.angle)) or not settled:
        return None
    last = t >= t[-1] - 0.2 * (t[-1] - t[begin])
    return float(np.polynomial.polynomial.polyfit(t[last] - t[-1], trial["psi"][last], 1)[1])
