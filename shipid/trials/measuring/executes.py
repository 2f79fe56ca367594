"""Executes, read from the record of the rudder: the moments at which it leaves one plate for the next.

Where the order is recorded the execute is its step. Where only the rudder's own angle is, two readings are offered:

- ``"moved"``: the last sample at which the rudder is still within 15 % of its plate (in a turn: within 3 deg of
  midships). It is what can be seen in a record without assuming how the steering gear works.
- ``"order"``: the ramp of the rudder, extended back to the plate it leaves; where the record steps, the sample that
  carries the new angle. It is the nearest to the order, as ITTC 7.5-04-02-01 and IMO MSC.137(76) mean it. Overshoots
  come out larger than in the other reading, by the rate of turn times the time the rudder needs for these 15 %.
"""

from __future__ import annotations

import numpy as np

from shipid.foundation.errors import UsageError
from shipid.trials.errors import UnknownColumnError
from shipid.trials.signals.plates import Plate, held_angle
from shipid.trials.trial import Trial

LEFT = 0.15
"""Share of the plate's angle by which the rudder has left it."""

HALFWAY = 0.5
"""Share at which the ramp is read again, to extend it back to the order."""


def convention(trial: Trial, execute: str | None) -> tuple[str, np.ndarray]:
    """Choose the reading of the execute and the rudder signal it is read from.

    Parameters
    ----------
    trial : Trial
        The trial.
    execute : {"moved", "order"} or None
        None is "order" where the order is recorded or the record is a simulation, else "moved".

    Returns
    -------
    execute : str
        The reading.
    rudder : ndarray, shape (n,)
        Rudder angle or order [rad].

    Raises
    ------
    UsageError
        If there is no such reading.
    UnknownColumnError
        If the trial has no rudder.
    """
    if execute not in (None, "moved", "order"):
        raise UsageError(f"execute is '{execute}'. Write 'moved' (the rudder has left its plate) or 'order'.")
    ordered = trial.has("delta_order") and (not trial.has("delta") or float(np.ptp(trial["delta_order"])) > 0)
    if execute != "moved" and ordered:
        return "order", trial["delta_order"]
    if not trial.has("delta"):
        if not ordered:
            raise UnknownColumnError(
                f"trial '{trial.name}' has no rudder angle, neither 'delta' nor 'delta_order': a manoeuvre cannot "
                "be measured without the moment of the order."
            )
        return "moved", trial["delta_order"]
    return execute or ("order" if trial.source.simulated else "moved"), trial["delta"]


def leaves(t: np.ndarray, rudder: np.ndarray, plate: Plate, execute: str) -> float:
    """Return the time at which the rudder leaves a plate for the other side [s].

    Parameters
    ----------
    t, rudder : ndarray, shape (n,)
        Time [s] and rudder angle [rad].
    plate : Plate
        The plate that is left; it must not be the last.
    execute : {"moved", "order"}
        The reading.

    Returns
    -------
    float
    """
    # The plate and the ramp after it; a long record has hundreds of plates.
    near = slice(plate.first, min(len(t), 2 * plate.last - plate.first + 1))
    return _put_over(t[near], plate.side * rudder[near], plate.last - plate.first, abs(plate.angle), 0.0, execute)


def _put_over(t: np.ndarray, y: np.ndarray, end: int, held: float, towards: float, execute: str) -> float:
    """Time at which `y`, held until somewhere before sample `end`, sets out for `towards` (downwards)."""
    size = held - towards
    on = np.flatnonzero(y[:end] >= held - LEFT * size)
    k = int(on[-1]) if on.size else 0
    if k + 1 >= len(y):
        return float(t[k])
    if execute == "moved":
        return float(t[k])
    if y[k] - y[k + 1] > 0.5 * size:
        return float(t[k + 1])
    left = float(np.interp(-(held - LEFT * size), -y[[k, k + 1]], t[[k, k + 1]]))
    off = k + 1 + np.flatnonzero(y[k + 1 :] <= held - HALFWAY * size)
    if not off.size:
        return left
    m = int(off[0])
    halfway = float(np.interp(-(held - HALFWAY * size), -y[[m - 1, m]], t[[m - 1, m]]))
    return max(float(t[0]), left - (halfway - left) * LEFT / (HALFWAY - LEFT))


def first_execute(
    t: np.ndarray, rudder: np.ndarray, plate: Plate, execute: str, moved: float | None = None
) -> tuple[float, float] | None:
    """Return the time the rudder sets out for its first plate [s], and the angle it leaves [rad].

    Parameters
    ----------
    t, rudder : ndarray, shape (n,)
        Time [s] and rudder angle [rad].
    plate : Plate
        The plate it goes to.
    execute : {"moved", "order"}
        The reading.
    moved : float, optional
        Rudder angle from midships that counts as moved [rad], instead of 15 % of the way.

    Returns
    -------
    tuple of float, or None
        None where the record begins with the rudder over already.
    """
    before = plate.side * rudder[: plate.first]
    way = abs(plate.angle)
    calm = np.flatnonzero(np.abs(before) < 0.3 * way)
    if not calm.size:
        return None
    # The neutral angle: where the rudder stays before, over a stretch no longer than the plate is held.
    neutral = held_angle(before[calm[-max(5, plate.last - plate.first) :]])
    y = -plate.side * rudder
    share = plate.first + 1
    if moved is None or execute == "order":
        return _put_over(t, y, share, -neutral, -way, execute), plate.side * neutral
    # From midships, unless the helm carried more than that before.
    still = np.flatnonzero(y[:share] > -(moved if neutral < moved else neutral + moved))
    return float(t[int(still[-1])]), plate.side * neutral
