"""The rudder: unit, sign, order for feedback, delay, offset, whether it moves at all."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from shipid.declaration.vocabulary import angle, shown
from shipid.foundation.numbers import brief
from shipid.trials import checks
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.signals.order import LATE, LATE_SAMPLES, lag_behind_order, order_against_feedback
from shipid.trials.signals.series import smoothed

_CALM = 0.01
"""Share of the record over which the rate of turn is averaged, where it is taken from the heading."""


def examine_movement(p: WorkingCopy) -> None:
    """Examine the unit of the rudder, and whether it moves.

    Parameters
    ----------
    p : WorkingCopy
        The record, heading and rate of turn put right.
    """
    name = p.rudder
    if name is None or len(p) < 30:
        return
    for column in ("delta", "delta_order"):
        if p.has(column):
            _unit(p, column)
    _moves(p, name)


def examine_sign(p: WorkingCopy) -> None:
    """Examine the sign of the rudder.

    Parameters
    ----------
    p : WorkingCopy
        The record; whether a helm law drives the rudder has been looked at.
    """
    name = p.rudder
    if name is None or len(p) < 30 or not (p.has("r") or p.has("psi")) or p.found("no-rudder-movement"):
        return
    if _sign(p, name) and p.has("delta", "delta_order"):
        _sign(p, "delta_order", say=False)


def _unit(p: WorkingCopy, name: str) -> None:
    delta = p[name]
    said = p.record.stated.get(name, "?")
    largest = float(np.quantile(np.abs(delta), 0.99))
    peak = float(np.abs(delta).max())
    factor, real = 1.0, ""
    # A few marks of missing samples are no unit.
    usual = float(np.quantile(np.abs(delta), 0.9))
    if peak > np.radians(90) and usual > np.radians(60):
        factor, real = np.pi / 180, "degrees"
    elif (
        np.radians(0.05) < largest < np.radians(0.9)
        and "deg" in said
        and p.has("psi")
        and float(np.ptp(p["psi"])) > 20 * largest
    ):
        factor, real = 180 / np.pi, "radians"
    if factor == 1.0:
        return
    p.add(
        "unit", name, 0.97 if factor < 1 else 0.88,
        f"{name} says {said} and reaches {angle(largest)}: it is in {real}",
        "The gain of the rudder comes out wrong by a factor of 57.", f"Multiply {name} by {factor:.6g}, or write its true "
        "unit.", fix={"action": "scale", "column": name, "factor": factor},
    )  # fmt: skip
    p[name] = delta * factor


def _moves(p: WorkingCopy, name: str) -> None:
    delta = p[name]
    quiet = 8 * robust.noise(delta)
    reach = float(np.ptp(np.quantile(delta, [0.005, 0.995])))
    if reach > max(checks.STEADY_RUDDER, quiet):
        return
    p.add(
        "no-rudder-movement", name, 0.97, f"{name} stays within {angle(reach, 2)}",
        "There is no response to identify: any gain explains the record as well as any other.",
        "Use a stretch with a manoeuvre in it, or find the column that holds the rudder.",
    )  # fmt: skip


def response(t: np.ndarray, delta: np.ndarray, r: np.ndarray) -> robust.RobustLine | None:
    """Regress ``r' = a delta - b r - b3 r^3 + c``, integrated over blocks.

    Parameters
    ----------
    t, delta, r : ndarray, shape (n,)
        Time [s], rudder angle [rad], rate of turn [rad/s].

    Returns
    -------
    RobustLine or None
        Coefficients a, -b, -b3, c.
    """
    found = []
    whole = [robust.integral(t, y) for y in (delta, r, r**3)]
    for count in (300, 120, 60):
        # Short blocks follow the steering, long ones average the noise: the surest reading of the gain counts.
        at = robust.edges(len(t), min(count, len(t) // 3))
        sound = robust.whole(t, at)
        design = np.column_stack([*(np.diff(y[at]) for y in whole), np.diff(t[at])])
        one = robust.regress(design[sound], np.diff(r[at])[sound])
        if one is not None:
            found.append(one)
    return min(found, key=lambda one: float(one.std[0] / abs(one.value[0] or 1e-300)), default=None)


def _sign(p: WorkingCopy, name: str, say: bool = True) -> bool:
    """Find a rudder that counts to port; whether the sign was changed."""
    rate = p["r"] if p.has("r") else smoothed(p.t, np.gradient(p["psi"], p.t), _CALM * float(np.ptp(p.t)))
    known = ~p.blind(name, "r" if p.has("r") else "psi")
    t, delta, r = p.t[known], p[name][known], rate[known]
    fitted, seen = checks.turns_to_port(t, delta, r), _answers_to_port(p, name, rate)
    if not (fitted or seen):
        return False
    if not say:
        p[name] = -p[name]
        return True
    # A rudder under an autopilot answers the ship as the ship answers the rudder: the sign of that is not the ship's.
    sure = 0.6 if p.found("closed-loop") else 0.97 if seen or _in_every_part(t, delta, r) else 0.85
    applied = p.add(
        "rudder-sign", name, sure, f"positive {name} turns the ship to port",
        "The gain comes out negative, or, where it is held positive, as zero with a rudder offset instead.",
        f"Change the sign of {name}; in a format file: sign = -1.", fix={"action": "scale", "column": name, "factor": -1.0},
    )  # fmt: skip
    if applied:
        p[name] = -p[name]
    return applied


def _in_every_part(t: np.ndarray, delta: np.ndarray, r: np.ndarray) -> bool:
    """Whether the sign stays the same when any fifth of the record is left out."""
    parts = np.array_split(np.arange(len(t)), 5)
    for part in parts:
        rest = np.delete(np.arange(len(t)), part)
        found = response(t[rest], delta[rest], r[rest])
        if found is None or not found.value[0] < 0:
            return False
    return True


def _answers_to_port(p: WorkingCopy, name: str, r: np.ndarray) -> bool:
    """Whether the ship, at the end of a stretch of rudder, turns to the other side, at nearly all stretches."""
    delta = p[name]
    high = 0.3 * float(np.quantile(np.abs(delta), 0.95))
    ends = [robust.runs(side * delta > high) for side in (1, -1)]
    index = np.concatenate([e[:, 1] - 1 for e in ends])
    long = np.concatenate([e[:, 1] - e[:, 0] for e in ends])
    if not len(index):
        return False
    held = index[long >= 0.3 * float(np.median(long))]
    answer = np.sign(delta[held]) * r[held]
    clear = np.abs(answer) > max(0.2 * float(np.quantile(np.abs(r), 0.9)), 4 * (p.noise("r") if p.has("r") else 0.0))
    against = int(np.sum(answer[clear] < 0))
    far = False
    if p.has("psi"):
        begin = index - long + 1
        turned = np.sign(delta[index]) * (p["psi"][index] - p["psi"][begin])
        far = bool(np.any(turned < -np.pi / 2)) and not np.any(turned > np.pi / 2)
    return against >= (1 if far else 4) and against >= 0.9 * int(clear.sum())


def executes(delta: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Return where the rudder is put over: the first samples, how many samples it takes, and the range.

    Parameters
    ----------
    delta : ndarray, shape (n,)
        Rudder angle [rad].

    Returns
    -------
    start : ndarray of int
        Last sample before each large movement.
    length : ndarray of int
        Samples from there until the movement ends.
    reach : float
        The rudder's range [rad].
    """
    reach = float(np.ptp(np.quantile(delta, [0.005, 0.995])))
    step = np.abs(np.diff(delta))
    # However finely it is sampled, a rudder that is put over moves at about the rate of its gear.
    moving = step > max(0.3 * float(np.sort(step)[-2]), 0.001 * reach, 4 * robust.noise(delta))
    moving = ndimage.binary_closing(np.pad(moving, 3), np.ones(4))[3:-3]
    found = robust.runs(moving)
    if not len(found):
        return np.empty(0, int), np.empty(0, int), reach
    travel = np.abs(delta[found[:, 1]] - delta[found[:, 0]])
    large = found[travel > 0.3 * reach]
    return large[:, 0], large[:, 1] - large[:, 0], reach


def examine_order(p: WorkingCopy) -> None:
    """Find a rudder column that holds the order, and one that is shifted in time.

    Parameters
    ----------
    p : WorkingCopy
        The record, signs put right.
    """
    if not p.has("delta") or p.found("no-rudder-movement") or len(p) < 40:
        return
    delta = p["delta"]
    if p.has("delta_order"):
        _order_beside(p)
    if p.has("delta_order") and float(np.abs(delta - p["delta_order"]).max()) <= 1e-9 and np.ptp(delta) > 0:
        _order(p, 0.95, "delta equals delta_order in every sample", np.arange(len(p)))
    else:
        start, length, _reach = executes(delta)
        # Across a gap the rudder has had the time it needed.
        across = (np.diff(p.t) > 1.5 * p.sampling) | p.blind("delta")[1:] | p.blind("delta")[:-1]
        seen = np.array([not across[a : a + n].any() for a, n in zip(start, length)], dtype=bool)
        start, length = start[seen], length[seen]
        if len(start):
            step = np.abs(np.diff(delta))
            # One sample carries nearly the whole movement.
            travel = np.abs(delta[start + length] - delta[start])
            biggest = np.array([step[a : a + n].max() for a, n in zip(start, length)])
            at_once = biggest > 0.85 * travel
            rate = float(np.median(biggest)) / p.sampling
            fastest = fastest_gear(p)
            if at_once.mean() > 0.7 and rate > fastest:
                _order(
                    p, robust.confidence_of(rate / fastest, 1, 2),
                    f"the rudder is put over within one sample at {int(at_once.sum())} of {len(start)} executes, at "
                    f"{shown(rate, 'r', digits=3)}, faster than the {shown(fastest, 'r', digits=3)} of a fast steering gear",
                    start,
                )  # fmt: skip


def _order_beside(p: WorkingCopy) -> None:
    """Find an order that cannot be the one the rudder followed: of the other sign, later than the rudder, or one that never moves."""
    order, delta = p["delta_order"], p["delta"]
    effect = "What is steered by it, and what is measured from it, is not what the ship did."
    if float(np.ptp(order)) == 0:
        p.add(
            "order-stands", "delta_order", 0.95,
            f"delta_order stays at {angle(float(order[0]), 3)} while the rudder moves by {angle(float(np.ptp(delta)), 3)}",
            effect, "Leave the column out: the executes are read back from the ramp of the rudder.", spoils=False,
        )  # fmt: skip
        return
    known = ~p.blind("delta", "delta_order")
    why = order_against_feedback(p.t[known], order[known], delta[known])
    if "other side" in why:
        if p.add(
            "rudder-sign", "delta_order", 0.97, f"{why}, whose sign is the ship's", effect,
            "Change the sign of delta_order; in a format file: sign = -1.",
            fix={"action": "scale", "column": "delta_order", "factor": -1.0},
        ):  # fmt: skip
            p["delta_order"] = -order
    elif "after the rudder" in why:
        p.add(
            "order-late", "delta_order", 0.95, why, effect,
            "Take the rudder angle: the executes are read back from its ramp.",
        )  # fmt: skip
    elif not why:
        _order_early(p, known)


def _order_early(p: WorkingCopy, known: np.ndarray) -> None:
    """Find an order that the rudder follows only after a while."""
    lag = lag_behind_order(p.t[known], p["delta_order"][known], p["delta"][known])
    limit = max(LATE, LATE_SAMPLES * p.sampling)
    if lag is not None and lag > limit:
        p.add(
            "order-early", "delta_order", robust.confidence_of(lag / limit, 0.8, 1.6),
            f"the rudder sets out {brief(lag)} s after delta_order: the steering gear has a dead time, or the order is stamped early",
            "Overshoots counted from the order are too large, by the heading turned in that time, if the stamps are wrong; the time is taken "
            "for the ship's where a model is steered by the order.",
            f"Find out which it is; shift delta_order by {lag:+.3g} s if its stamps are early.",
        )  # fmt: skip


def _order(p: WorkingCopy, confidence: float, message: str, at: np.ndarray) -> None:
    p.add(
        "order-not-feedback", "delta", confidence, message,
        "The time the steering gear takes is taken for the ship's: time constants come out too long by about half the "
        "time of putting over, overshoots are blamed on the hull.",
        "Call the column delta_order and identify with a steering machine, or take the feedback.", at=at, spoils=False,
    )  # fmt: skip


def fastest_gear(p: WorkingCopy) -> float:
    """Return a rudder rate no usual steering gear exceeds [rad/s]: 12 deg/s at 40 m, by Froude's law for smaller ships.

    Parameters
    ----------
    p : WorkingCopy
        The record.
    """
    length = p.length
    if length is None and p.has("r"):
        speed = p["U"] if p.has("U") else p["u"] if p.has("u") else None
        if speed is not None:
            # A ship under hard rudder turns at about r L/U = 0.4.
            length = 0.4 * float(np.median(np.abs(speed))) / max(float(np.quantile(np.abs(p["r"]), 0.95)), 1e-9)
    length = 40.0 if length is None else max(length, 0.5)
    return float(np.radians(12.0) * np.sqrt(40.0 / min(length, 40.0)))
