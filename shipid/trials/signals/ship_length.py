"""Whether a ship of a stated length can turn as the record of a trial shows: a length in other units, or another ship's, is told."""

from __future__ import annotations

import numpy as np

from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief
from shipid.trials.trial import Trial

#: The notice.
SHIP_LENGTH = "ship-length"
#: Change of the rate of turn in L^2/U^2 by the range of the rudder angle. It is about K'/T' of Nomoto's model; the zig-zags and turns of tankers,
#: a research vessel and free models lie from 0.35 to 2.8, a berthing at 8. A length that is ten times as large makes it a hundred times as large.
_LEAST, _MOST, _SHIPS = 0.05, 20.0, "0.3 to 3"
#: What a change of the rate of turn does to the heading, rad, shows where it is larger than this: a noise of 0.3 deg does not reach it.
_SHOWS = np.deg2rad(2.0)
#: Without this range of the rudder angle, rad, it is not the rudder that turns the ship.
_RUDDER = np.deg2rad(5.0)
#: Windows with way on, at least; the largest changes count from this one on.
_ENOUGH, _LARGEST = 12, 3


def length_notice(trial: Trial, length: float | None) -> Notice | None:
    """Return a serious notice where no ship of this length turns as the trial shows; None where one may, or nothing tells.

    Parameters
    ----------
    trial : Trial
        With rudder and speed, and the rate of turn or the heading.
    length : float or None
        Of the ship, m.
    """
    speed = next((n for n in ("u", "U", "SOG") if trial.has(n)), None)
    turn = next((n for n in ("r", "psi") if trial.has(n)), None)
    if not length or length <= 0 or speed is None or turn is None or not trial.has("delta"):
        return None
    t, delta = trial["t"], trial["delta"][np.isfinite(trial["delta"])]
    known = np.isfinite(trial[turn])
    way = np.abs(trial[speed][np.isfinite(trial[speed])])
    usual = float(np.median(way)) if way.size else 0.0
    if delta.size < _ENOUGH or known.sum() < _ENOUGH or usual <= 0:
        return None
    rudder = float(np.ptp(np.quantile(delta, (0.002, 0.998))))
    if rudder < _RUDDER:
        return None
    heading = trial["psi"][known] if turn == "psi" else _integral(t[known], trial["r"][known])
    found = _turning(t[known], heading)
    if found is None:
        return None
    least, most = (change * (length / usual) ** 2 / rudder for change in found)
    if least > _LEAST and most < _MOST:
        return None
    value = most if most >= _MOST else least
    return Notice(
        f"the length of {brief(length, 3)} m does not fit trial '{trial.name}': a ship of that length does not turn like this at {brief(usual, 3)} "
        f"m/s. What the rudder does to her rate of turn is {brief(value, 2)} in L and U, and {_SHIPS} for ships. Check both numbers, "
        "and whether log and length are both of the ship or both of the model; what is scaled by the length is not to be used.",
        SHIP_LENGTH,
        serious=True,
        trial=trial.name,
        length=length,
        value=value,
    )


def _turning(t: np.ndarray, heading: np.ndarray) -> tuple[float, float] | None:
    """The largest changes of the rate of turn, rad/s^2, and those that few exceed, over times in which they show; None where they never do."""
    window = 2.0 * float(np.median(np.diff(t)))
    while (t[-1] - t[0]) > _ENOUGH * window > 0:
        changes = np.sort(np.abs(np.diff(np.interp(np.arange(t[0], t[-1], window), t, heading), 2)))
        usual = float(np.quantile(changes, 0.98))
        if usual > _SHOWS:
            return float(changes[-_LARGEST]) / window**2, usual / window**2
        window *= 1.5
    return None


def _integral(t: np.ndarray, r: np.ndarray) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(np.diff(t) * (r[1:] + r[:-1]) / 2)])
