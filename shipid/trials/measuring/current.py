"""Drift of a turning circle over the ground, and what the circle measures in still water."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from scipy.integrate import cumulative_trapezoid

from shipid.declaration.vocabulary import angle, compass, shown
from shipid.foundation.numbers import last_place
from shipid.trials.measuring.track import TurnTrack
from shipid.trials.signals.channel import Channel

FROM = np.radians(359.0)
"""A circle that turns through this shows its drift: a full one, but for what rudder and heading round off."""

_PAIRS = 40
_LEAST = np.radians(15.0)
"""Headings over which pairs of positions are compared, at the least."""
_MOST = 2000
"""Positions that are fitted at most."""
_TURNING, _STEADY = 0.5 * pi, pi
"""Heading changes from which on a ship turns as the models of a slowing and of a steady turn say."""
_LATE = 3 * pi
"""The last heading change of a long circle that is fitted: what settled before is left out."""
_FLOOR = 0.01
"""A drift below this share of the ship's speed is none, and none is known better."""
_MODELS = (("speed", "rate", _TURNING), ("speed", "settling", _TURNING), ("rate", "", _STEADY), ("speed", "", _STEADY))


@dataclass(frozen=True)
class CircleDrift:
    """The drift of a circle.

    Attributes
    ----------
    north, east : float
        Velocity over the ground [m/s].
    within : float
        Its 95 % uncertainty [m/s], in any direction.
    """

    north: float
    east: float
    within: float

    @property
    def speed(self) -> float:
        """Speed of the drift [m/s]."""
        return float(np.hypot(self.north, self.east))

    @property
    def direction(self) -> float:
        """Direction it drifts to, clockwise from north, in [0, 2 pi) [rad]."""
        return float(np.arctan2(self.east, self.north) % (2 * pi))


def drift_of(
    x: Channel, y: Channel, t: np.ndarray, psi: np.ndarray, turned: np.ndarray, approach: float
) -> CircleDrift | None:
    """Return the drift of a circle that turns through 360 deg.

    A ship in a steady turn goes through the water in a direction that turns with its heading; what does not turn is the drift.
    How its speed settles is not known, so four models are fitted to the positions: a speed that is constant and in proportion
    to the rate of turn in parts, one that settles with the heading turned, both from 90 deg on, and a constant radius and a
    constant speed from 180 deg on. Their mean is the drift, and how far they are apart its uncertainty. From 555 deg on, pairs
    of positions at headings 360 deg apart (IMO MSC/Circ.1053, appendix) are one more, and of a long circle the last turns count.

    Parameters
    ----------
    x, y : Channel
        Positions, north and east [m].
    t, psi, turned : ndarray, shape (n,)
        Time [s], heading [rad] and heading change since the execute, positive into the turn [rad], while the rudder is over.
    approach : float
        Speed of the ship [m/s].

    Returns
    -------
    CircleDrift or None
        None where the circle does not turn through 360 deg, or positions are missing there.
    """
    rising = np.maximum.accumulate(turned)
    if float(rising[-1]) < FROM:
        return None
    found, spread = [], []
    for one, other, begin in _MODELS:
        inside = rising >= max(begin, float(rising[-1]) - _LATE)
        fit = _fitted(x, y, t[inside], psi[inside], turned[inside], (one, other) if other else (one,))
        if fit is None:
            return None
        found.append(fit[0])
        spread.append(fit[1])
    values = np.array(found)
    mean = complex(values.mean())
    pairs = _pairs(x, y, t, rising)
    if pairs is not None:
        # Over so long a turn it shows which models follow it: they count by what they leave, and as much as the pairs together.
        weights = 1 / np.maximum(spread, 1e-3 * approach) ** 2
        mean = 0.5 * (complex(np.sum(weights * values) / np.sum(weights)) + pairs)
        values = np.append(values, pairs)
    within = float(np.abs(values[:, None] - values).max())
    return CircleDrift(mean.real, mean.imag, within + 2 * max(spread) + _FLOOR * approach)


def _fitted(
    x: Channel, y: Channel, t: np.ndarray, psi: np.ndarray, turned: np.ndarray, model: tuple[str, ...]
) -> tuple[complex, float] | None:
    """The drift that a model of the turn leaves of the positions, north + i east, and its standard deviation [m/s]."""
    if t.size < 10:
        return None
    ahead = np.exp(1j * psi)
    ways = {
        "speed": cumulative_trapezoid(ahead, t, initial=0.0),
        "rate": -1j * ahead,
        "settling": cumulative_trapezoid(ahead * np.exp(turned[0] - turned), t, initial=0.0),
    }
    seen = x.t[(x.t >= t[0]) & (x.t <= t[-1])]
    seen = seen[np.linspace(0, seen.size - 1, min(seen.size, _MOST)).astype(int)] if seen.size else seen
    # A hole in the middle is bridged by the model; half of the turn has to be seen.
    steps = np.diff(seen)
    if seen.size < 10 or float(np.sum(np.minimum(steps, 5 * np.median(steps)))) < 0.5 * (t[-1] - t[0]):
        return None
    place = np.interp(seen, x.t, x.y) + 1j * np.interp(seen, y.t, y.y)
    columns = [np.ones_like(seen), seen - seen[0]]
    columns += [np.interp(seen, t, ways[name].real) + 1j * np.interp(seen, t, ways[name].imag) for name in model]
    design = np.column_stack(columns).astype(complex)
    size = np.abs(design).max(axis=0)
    design = design / size
    solved = np.linalg.lstsq(design, place - place[0], rcond=1e-6)[0]
    rest = place - place[0] - design @ solved
    freedom = max(seen.size - design.shape[1], 1)
    # What is left is no noise from sample to sample: it counts as often as it changes its sign.
    changes = 1 + sum(int(np.sum(np.diff(np.sign(part)) != 0)) for part in (rest.real, rest.imag))
    scatter = np.sum(np.abs(rest) ** 2) / freedom * seen.size / min(changes, seen.size)
    inverse = np.linalg.pinv(design.conj().T @ design)[1, 1].real
    return complex(solved[1] / size[1]), float(np.sqrt(scatter * max(inverse, 0.0)) / size[1])


def _pairs(x: Channel, y: Channel, t: np.ndarray, rising: np.ndarray) -> complex | None:
    """The mean of pairs of positions 360 deg apart, north + i east, from 180 deg on [m/s]."""
    final = float(rising[-1])
    if final < 3 * pi + _LEAST:
        return None
    at = np.linspace(max(pi, final - 4 * pi), final - 2 * pi, _PAIRS)
    keep = np.concatenate(([True], np.diff(rising) > 0))
    one, two = np.interp(at, rising[keep], t[keep]), np.interp(at + 2 * pi, rising[keep], t[keep])
    good = np.array([not any(c.hole(when) for c in (x, y) for when in pair) for pair in zip(one, two)])
    if good.sum() < 0.5 * _PAIRS:
        return None
    one, two = one[good], two[good]
    north, east = ((np.interp(two, c.t, c.y) - np.interp(one, c.t, c.y)) / (two - one) for c in (x, y))
    return complex(north.mean(), east.mean())


def still_water(
    way: TurnTrack,
    found: dict[str, float | None],
    quarters: list[float | None],
    drifting: CircleDrift | None,
    turned: float,
    why: str | None,
) -> tuple[dict[str, float | None], dict[str, str], list[str]]:
    """Return advance, transfer and tactical diameter with the drift of the circle taken off, and that drift.

    Parameters
    ----------
    way : TurnTrack
        The track from the execute on.
    found : dict of str to float or None
        The distances over the ground [m].
    quarters : list of float or None
        When the heading has changed by 90, 180 deg and so on [s].
    drifting : CircleDrift or None
        The drift.
    turned : float
        Heading change of the whole circle [rad].
    why : str or None
        Why the drift is not known, where something else than the heading change is the reason.

    Returns
    -------
    values : dict of str to float or None
        In SI units.
    reasons : dict of str to str
        Why a value is not known.
    notes : list of str
        What to say of the drift.
    """
    names = ("advance", "transfer", "tactical_diameter")
    known = [name for name in names if found.get(name) is not None]
    if drifting is None:
        short = f"the circle turns through {angle(turned, 3)} only, and its drift shows from 360 deg on"
        why = why or (short if turned < FROM else "positions are missing where the drift is read")
        return {}, {f"{name}_still_water": why for name in known}, []
    values: dict[str, float | None] = {"drift_speed": drifting.speed, "drift_uncertainty": drifting.within}
    if drifting.speed < drifting.within:
        words = "the drift of the circle is not beyond its uncertainty"
        return values, {"drift_direction": words} | {f"{name}_still_water": words for name in known}, []
    values["drift_direction"] = drifting.direction
    off = []
    for name, quarter in zip(names, (quarters[0], quarters[0], quarters[1])):
        if quarter is not None and name in known:
            along, across = way.moved(quarter, (drifting.north, drifting.east))
            values[f"{name}_still_water"] = along if name == "advance" else across
            off.append(
                f"{name.replace('_', ' ')} within {shown(drifting.within * (quarter - way.when), 'x', digits=2)}"
            )
    place = max(0, last_place(drifting.within))
    note = (
        f"over the ground the circle drifts at {drifting.speed:.{place}f} m/s to {compass(drifting.direction, 0)} deg "
        f"(within {drifting.within:.{place}f} m/s): current, and what wind and waves add; the still-water values have "
        f"it taken off ({', '.join(off)})"
    )
    return values, {}, [note]
