"""Columns that follow from others of the same log: speeds along the ship from speed and drift angle, true wind from relative wind.

Signs are those of the vocabulary: the drift angle is positive when the flow comes from port, ``beta = atan2(-v, u)``; winds are
given by the direction they blow TO, the relative one counted from the bow, the true one from north.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.trials.filling import interpolated
from shipid.trials.logs.conversion import unwrapped


@dataclass(frozen=True, eq=False)
class Followed:
    """Columns of a log with those that follow from them.

    Attributes
    ----------
    values : dict of str to ndarray, shape (n,)
        By name, SI; NaN where a sample is missing.
    notes : tuple of str
        What was worked out, and from what.
    """

    values: dict[str, np.ndarray]
    notes: tuple[str, ...]


def with_following(values: dict[str, np.ndarray]) -> Followed:
    """Add the forward and sway speed and the true wind, where a log holds only what they follow from.

    Parameters
    ----------
    values : dict of str to ndarray, shape (n,)
        Columns with ``t``, in the units inside a trial; the heading is unwrapped. A column that is there is never replaced.

    Returns
    -------
    Followed
    """
    speeds = with_speeds(values)
    wind = with_true_wind(speeds.values)
    return Followed(wind.values, (*speeds.notes, *wind.notes))


def with_speeds(values: dict[str, np.ndarray]) -> Followed:
    """Add the forward and sway speed that follow from the drift angle.

    Parameters
    ----------
    values : dict of str to ndarray, shape (n,)
        As for `with_following`.

    Returns
    -------
    Followed
    """
    found, notes = dict(values), []
    for name, column, note in _speeds(values):
        found[name] = column
        notes.append(note)
    if "U" in found and not {"u", "beta"} & found.keys():
        notes.append(
            "The log holds the speed U and no drift angle beta: u and v do not follow from it, and are not used."
        )
    return Followed(found, tuple(notes))


def with_true_wind(values: dict[str, np.ndarray]) -> Followed:
    """Add the true wind that follows from the relative one.

    Parameters
    ----------
    values : dict of str to ndarray, shape (n,)
        As for `with_following`.

    Returns
    -------
    Followed
    """
    wind, said = _true_wind(values)
    return Followed(values | wind, said)


def _speeds(values: dict[str, np.ndarray]) -> list[tuple[str, np.ndarray, str]]:
    """Forward and sway speed from the drift angle; where either sample is missing, so is what follows."""
    if "beta" not in values:
        return []
    beta, whole = values["beta"], values.get("U")
    ways = []
    if whole is not None:
        ways = [("u", whole * np.cos(beta), "U cos(beta)"), ("v", -whole * np.sin(beta), "-U sin(beta)")]
    elif "u" in values:
        ways = [("v", -values["u"] * np.tan(beta), "-u tan(beta)")]
    return [
        (name, column, f"{name} was worked out as {how}: the log does not hold it.")
        for name, column, how in ways
        if name not in values and np.isfinite(column).any()
    ]


def _true_wind(values: dict[str, np.ndarray]) -> tuple[dict[str, np.ndarray], tuple[str, ...]]:
    """The true wind: the relative one plus the ship's own velocity, over the ground where that is measured."""
    if not {"wind_speed_relative", "wind_direction_relative"} <= values.keys() or "wind_speed" in values:
        return {}, ()
    velocity, how = _velocity(values)
    if velocity is None:
        return {}, (f"WARNING: the true wind is not known, because the log holds the relative one and no {how}.",)
    psi = interpolated(values["t"], values["psi"])
    speed, angle = values["wind_speed_relative"], values["wind_direction_relative"] + psi
    north, east = speed * np.cos(angle) + velocity[0], speed * np.sin(angle) + velocity[1]
    true = {"wind_speed": np.hypot(north, east), "wind_direction": unwrapped(np.arctan2(east, north))}
    return true, (f"wind_speed and wind_direction were worked out from the relative wind, the heading and {how}.",)


def _velocity(values: dict[str, np.ndarray]) -> tuple[tuple[np.ndarray, np.ndarray] | None, str]:
    """The ship's velocity to the north and to the east, and what it is, or what is lacking."""
    if "psi" not in values or not np.isfinite(values["psi"]).any():
        return None, "heading"
    t = values["t"]
    if {"SOG", "COG"} <= values.keys() and np.isfinite(values["SOG"] * values["COG"]).any():
        # Components have no jump where the course passes north.
        parts = (values["SOG"] * np.cos(values["COG"]), values["SOG"] * np.sin(values["COG"]))
        return (interpolated(t, parts[0]), interpolated(t, parts[1])), "the velocity over the ground (SOG, COG)"
    ahead = next((n for n in ("u", "U", "SOG") if n in values and np.isfinite(values[n]).any()), None)
    if ahead is None:
        return None, "speed of the ship"
    psi, u = interpolated(t, values["psi"]), interpolated(t, values[ahead])
    v = interpolated(t, values["v"]) if "v" in values and ahead == "u" else np.zeros(t.size)
    how = f"the speed {ahead}" + (" and v" if "v" in values and ahead == "u" else ", without drift")
    how += "" if ahead == "SOG" else " through the water: where a current sets, the wind over the water"
    return (u * np.cos(psi) - v * np.sin(psi), u * np.sin(psi) + v * np.cos(psi)), how
