"""Plates of the rudder: stretches at one angle, which a zig-zag or a turn is steered in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.trials.checks import STEADY_RUDDER

DWELL = 0.15
"""A plate on which the rudder spends less of its stretch than this is hand steering."""

IDLE = 0.3
"""A plate with more of its stretch amidships than this is no part of a zig-zag: the rudder was not reversed, but let go."""

_LET_GO = 0.5
"""A rudder that is less than half over for this share of the usual plate was let go: what follows is another plate."""


_TIP = 0.35
"""A rudder that is within 10 % of its plate for less than this share of the time it is half over only touches it: 0.2 of two ramps."""

_MOST = 0.6
"""Share of the time on plates that is spent on those of one angle a side, where the two sides differ: no hand steering."""

_LOPSIDED = 0.6
"""Plates of the two sides of a zig-zag, the smaller over the larger, at least: a reading that is off by a quarter of the plate."""


@dataclass(frozen=True)
class Plate:
    """A stretch at one rudder angle.

    Attributes
    ----------
    first, last : int
        Samples from where the rudder is half over to this side, to where it is half over to the other.
    angle : float
        The rudder angle held, with its sign [rad].
    dwell : float
        Share of the stretch, as long as the rudder is over, that it stays within 20 % of that angle.
    idle : float
        Share of the stretch that the rudder lies within 15 % of that angle from midships.
    """

    first: int
    last: int
    angle: float
    dwell: float
    idle: float = 0.0

    @property
    def side(self) -> int:
        """1 for starboard, -1 for port."""
        return 1 if self.angle > 0 else -1


def plates(rudder: np.ndarray) -> list[Plate]:
    """Split a rudder record into plates: at every change of side, and where the rudder was let go for long in between.

    Parameters
    ----------
    rudder : ndarray, shape (n,)
        Rudder angle [rad].

    Returns
    -------
    list of Plate
        In order of time; empty where the rudder stays within 0.5 deg of midships.
    """
    size = float(np.quantile(np.abs(rudder), 0.9))
    if size < STEADY_RUDDER:
        return []
    over = np.where(rudder > size / 2, 1, np.where(rudder < -size / 2, -1, 0))
    held = np.flatnonzero(over)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], over, [0]))) != 0)
    runs = np.diff(edges)[over[edges[:-1]] != 0]
    let_go = np.diff(held) > max(4.0, _LET_GO * float(np.median(runs)))
    starts = [int(held[0]), *(int(k) for k in held[1:][(np.diff(over[held]) != 0) | let_go])]
    result = []
    for first, last in zip(starts, [*starts[1:], len(rudder)]):
        stretch = np.abs(rudder[first:last])
        over_half = stretch[stretch >= 0.5 * stretch.max()]
        angle = reached_angle(over_half)
        # After the last plate the rudder may lie amidships for long.
        put = stretch[: int(np.flatnonzero(stretch >= 0.5 * angle)[-1]) + 1]
        dwell = float(np.mean(np.abs(put - angle) <= 0.2 * angle))
        idle = float(np.mean(stretch < 0.15 * angle))
        result.append(Plate(first, last, float(over[first]) * angle, dwell, idle))
    return result


def held_angle(values: np.ndarray) -> float:
    """Return the value at which a rudder stays: the middle of the narrowest interval with a third of the samples.

    A median would be drawn down by the ramps of a short plate, a maximum up by an order that overshoots.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Rudder angles [rad], in any order.
    """
    ordered = np.sort(values)
    count = max(1, -(-len(ordered) // 3))
    widths = ordered[count - 1 :] - ordered[: len(ordered) - count + 1]
    k = int(np.argmin(widths))
    return float(np.median(ordered[k : k + count]))


def reached_angle(values: np.ndarray) -> float:
    """Return the value at which a rudder stays, or the one at which slow gear turns back as soon as it is there.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Rudder angles of one side [rad], those of half of the largest and beyond.
    """
    angle = held_angle(values)
    # The plate may be the tip of two ramps.
    return float(np.quantile(values, 0.97)) if float(np.mean(np.abs(values - angle) <= 0.1 * angle)) < _TIP else angle


def regular(found: list[Plate]) -> list[Plate]:
    """Return the longest run of plates of about the same angle, each held and reversed: the zig-zag without hand steering.

    A rudder that reads some degrees to one side throughout makes the plates of one side larger than those of the other.

    Parameters
    ----------
    found : list of Plate
        All plates of a record.

    Returns
    -------
    list of Plate
    """
    steady = [plate for plate in found if plate.dwell >= DWELL]
    if not steady:
        return []
    nominal = _middle(steady)
    sides = {side: _middle([plate for plate in steady if plate.side == side]) or nominal for side in (1, -1)}
    alike = np.array([abs(abs(p.angle) - sides[p.side]) <= 0.1 * sides[p.side] for p in steady])
    weights = np.array([_weight(p) for p in steady])
    if min(sides.values()) < _LOPSIDED * max(sides.values()) or float(weights @ alike) < _MOST * float(weights.sum()):
        sides = dict.fromkeys(sides, nominal)
    best: list[Plate] = []
    run: list[Plate] = []
    for plate in found:
        fits = plate.dwell >= DWELL and abs(abs(plate.angle) - sides[plate.side]) <= 0.25 * sides[plate.side]
        reversed_from = bool(run) and run[-1].idle <= IDLE and run[-1].side != plate.side
        run = [] if not fits else [*run, plate] if reversed_from else [plate]
        best = run if len(run) > len(best) else best
    return best


def _weight(plate: Plate) -> float:
    """For how many samples a plate is held; what lies amidships behind the last one of a record counts for nothing."""
    return (plate.last - plate.first) * (1 - plate.idle) * plate.dwell


def _middle(steady: list[Plate]) -> float:
    """Median angle of plates, each with the weight of how long it is held [rad]; 0 of none."""
    if not steady:
        return 0.0
    weights = np.array([_weight(p) for p in steady])
    angles = np.array([abs(p.angle) for p in steady])
    order = np.argsort(angles)
    middle = np.searchsorted(np.cumsum(weights[order]), 0.5 * weights.sum())
    return float(angles[order][middle])
