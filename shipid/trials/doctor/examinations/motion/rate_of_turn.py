"""Heading against rate of turn: labels, units, signs, lag and drift, by comparison with the slope of the heading."""

from __future__ import annotations

from copy import copy
from math import log, pi

import numpy as np

from shipid.declaration.vocabulary import shown
from shipid.foundation.numbers import brief, percent
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.motion.clock_scale import examine_clock_scale
from shipid.trials.doctor.examinations.steering.delay import SINE, answer_to
from shipid.trials.doctor.working_copy import WorkingCopy

_DEG = 180 / pi
#: Part of a delay to which two readings of it have to agree.
_NEAR = 0.3
#: Factor on the heading's slope over the rate: which column is what, by the unit it says ("" any), most likely first.
_HYPOTHESES: tuple[tuple[str, str, float, str], ...] = (
    ("r", "deg/s", 1 / 60, "deg/min"),
    ("r", "deg/s", _DEG, "rad/s"),
    ("r", "rad/s", 1 / _DEG, "deg/s"),
    ("r", "rad/s", 1 / (60 * _DEG), "deg/min"),
    ("r", "deg/min", 60.0, "deg/s"),
    ("r", "deg/min", 60 * _DEG, "rad/s"),
    ("psi", "rad", _DEG, "deg"),
    ("psi", "deg", 1 / _DEG, "rad"),
    ("r", "", 1 / 60, "a sixtieth of what it says (per minute)"),
    ("r", "", 60.0, "sixty times what it says (per second)"),
    ("r", "", _DEG, "rad/s"),
    ("r", "", 1 / _DEG, "deg/s"),
)


def relation(t: np.ndarray, psi: np.ndarray, rate: np.ndarray, count: int = 300) -> robust.RobustLine | None:
    """Regress heading changes on the integral of a rate, time, and changes of the rate.

    Parameters
    ----------
    t, psi, rate : ndarray, shape (n,)
        Time [s], heading [rad], rate of turn [rad/s].
    count : int
        Number of blocks.

    Returns
    -------
    RobustLine or None
        Coefficients: scale (1 where they agree), drift [rad/s], lag of the rate behind the heading [s].
    """
    at = _edges(psi, count)
    turned = robust.integral(t, rate)
    design = np.column_stack([np.diff(turned[at]), np.diff(t[at]), np.diff(rate[at])])
    sound = robust.whole(t, at)
    return robust.regress(design[sound], np.diff(psi[at])[sound])


def _edges(psi: np.ndarray, count: int) -> np.ndarray:
    """Edges of blocks long enough for a heading in coarse steps to change within most of them."""
    at = robust.edges(len(psi), min(count, len(psi) // 4))
    while len(at) > 24 and float(np.mean(np.diff(psi[at]) == 0)) > 0.3:
        at = robust.edges(len(psi), len(at) // 2)
    return at


def _agreement(p: WorkingCopy, name: str) -> tuple[float, float]:
    """Scale and explained share of one rate channel, from its integral alone."""
    at = _edges(p["psi"], 120)
    sound = robust.whole(p.t, at)
    turned = np.diff(robust.integral(p.t, p[name])[at])[sound]
    step, took = np.diff(p["psi"][at])[sound], np.diff(p.t[at])[sound]
    if not len(step) or float(np.ptp(p[name])) == 0 or float(np.ptp(step)) == 0:
        return 0.0, 0.0
    found = robust.regress(np.column_stack([turned, took]), step)
    if found is None:
        return 0.0, 0.0
    own = found.value[0] * (turned - turned.mean())
    rest = step - np.column_stack([turned, took]) @ found.value
    part = float(np.var(own)) / (float(np.var(own)) + robust.spread(rest) ** 2 + 1e-300)
    return float(found.value[0]), part


def examine_label(p: WorkingCopy) -> None:
    """Find the rate channel that is the slope of the heading, whatever it is called.

    Parameters
    ----------
    p : WorkingCopy
        The record, its heading unwrapped.
    """
    if not p.has("psi") or len(p) < 40:
        return
    _exchanged(p)
    rates = [c for c in p.values if c in ("r", "p") or p.unit(c) == "rad/s"]
    rated = {c: _agreement(p, c) for c in rates}
    mine = rated.get("r", (0.0, 0.0))[1]
    others = {c: v for c, v in rated.items() if c != "r" and 0.4 < abs(v[0]) < 2.5}
    if not others:
        return
    best = max(others, key=lambda c: others[c][1])
    if others[best][1] > 0.9 and mine < 0.6:
        has = "r" in rated
        p.add(
            "mislabelled", "r", robust.confidence_of(others[best][1] - mine, 0.3, 0.6),
            f"the column called {best} is the slope of the heading ({percent(others[best][1], 1)} of it explained)"
            + (f", the one called r is not ({percent(mine, 1)})" if has else "; there is no r"),
            "A fit to that r has nothing to do with the rudder: gain and damping are noise.",
            f"Exchange the names {best} and r." if has else f"Rename {best} to r.",
            fix={"action": "relabel", "from": best, "to": "r"},
        )  # fmt: skip
        p.values["r"], old = p.values[best], p.values.get("r")
        if old is None:
            del p.values[best]
        else:
            p.values[best] = old


def _exchanged(p: WorkingCopy) -> None:
    """Find heading and rudder under each other's name: the rate of turn is the slope of the one that is called delta."""
    if not p.has("delta", "r"):
        return
    other = copy(p)
    other.values = {**p.values, "psi": p["delta"], "delta": p["psi"]}
    mine, found = _agreement(p, "r"), _agreement(other, "r")
    if not (found[1] > 0.9 and 0.8 < found[0] < 1.25 and mine[1] < 0.6):
        return
    p.add(
        "mislabelled", "psi,delta", robust.confidence_of(found[1] - mine[1], 0.3, 0.6),
        f"r is the slope of the column called delta ({percent(found[1], 1)} of it explained), and not of the one called psi "
        f"({percent(mine[1], 1)})",
        "Heading and rudder stand for each other: whatever is fitted to them is no ship.",
        "Exchange the names psi and delta.", fix={"action": "relabel", "from": "delta", "to": "psi"},
    )  # fmt: skip
    p.exchange("psi", "delta")


def course_scale(p: WorkingCopy) -> float | None:
    """Return the slope of the course over ground on the heading; None where the positions are too few or too noisy.

    Parameters
    ----------
    p : WorkingCopy
        The record.
    """
    if not p.has("x", "y", "psi"):
        return None
    n = len(p)
    at = robust.edges(n, 60)
    north, east = np.diff(p["x"][at]), np.diff(p["y"][at])
    way = np.hypot(north, east)
    rough = 3 * max(robust.noise(p["x"]), robust.noise(p["y"]))
    if float(np.median(way)) <= max(2 * rough, 1e-9):
        return None
    course = np.unwrap(np.arctan2(east, north))
    middle = 0.5 * (p["psi"][at][1:] + p["psi"][at][:-1])
    found = robust.regress(np.column_stack([middle - middle.mean(), np.ones(len(middle))]), course)
    if found is None or found.explained < 0.3 or abs(found.value[0]) < 5 * found.std[0]:
        return None
    return float(found.value[0])


def examine_rate(p: WorkingCopy) -> None:
    """Find wrong units, factors and signs between heading and rate of turn.

    Parameters
    ----------
    p : WorkingCopy
        The record, its heading unwrapped and its rate found.
    """
    if not p.has("psi", "r") or len(p) < 40:
        return
    scale, part = _agreement(p, "r")
    if part < 0.3 or scale == 0:
        return
    if scale < 0:
        _sign(p, part)
        scale = abs(scale)
    found = relation(p.t, p["psi"], p["r"])
    if found is not None and found.value[0] > 0:
        scale = float(found.value[0])
    if scale < 1e-6:
        return
    std = float(found.std[0]) if found is not None else 1.0
    far = scale > 3 or scale < 1 / 3
    if far and ((factor := _clock_factor(p, scale)) is not None or not examine_clock_scale(p, scale, std)):
        _unit(p, scale, factor)
    if far:
        return
    alone = abs(_agreement(p, "r")[0])
    limit = max(0.04, 8 * std)
    # In a steady turn a factor and a drift look alike: both estimates have to show it.
    off = min(abs(scale - 1), abs(alone - 1))
    if off > limit and (scale > 1) == (alone > 1) and not examine_clock_scale(p, scale, std):
        p.add(
            "rate-scale",
            "r",
            robust.confidence_of(off / limit, 1, 2),
            f"the heading changes {brief(scale, 4)} times as fast as r says",
            "Gain and damping scale with the rate; heading and rate cannot both be fitted.",
            f"Multiply r by {scale:.4g}: the heading is read from a compass card, the rate from a calibration.",
            fix={"action": "scale", "column": "r", "factor": scale},
        )
        p["r"] = p["r"] * scale


def _sign(p: WorkingCopy, part: float) -> None:
    course = course_scale(p)
    name = "psi" if course is not None and course < 0 else "r"
    p.add(
        "rate-sign" if name == "r" else "heading-sign", name, 0.7 + 0.29 * min(1.0, part / 0.8),
        f"{name} is counted positive to port: the heading falls where r says it rises",
        "Heading and rate ask for gains of opposite sign; the residuals stay as large as the signal.",
        f"Change the sign of {name}; in a format file: sign = -1.",
        fix={"action": "scale", "column": name, "factor": -1.0},
    )  # fmt: skip
    p[name] = -p[name]


def _stated(p: WorkingCopy, name: str) -> str:
    unit = p.record.stated.get(name, "").replace("°", "deg").replace(" ", "").lower()
    return "deg/min" if unit in ("deg/min", "deg/minute") else unit


def _unit(p: WorkingCopy, scale: float, clock: float | None) -> None:
    if clock is not None:
        p.add(
            "unit", "t", 0.95, f"rate of turn and speed both show that one unit of the clock is {clock:g} s",
            "Time constants come out in another unit, and gains with them.", f"Multiply t by {clock:.4g}.",
            fix={"action": "scale", "column": "t", "factor": clock},
        )  # fmt: skip
        p["t"] = p["t"] * clock
        return
    course = course_scale(p)
    guilty = None
    if course is not None:
        guilty = "r" if 0.3 < abs(course) < 3 else "psi"
    elif (
        float(np.ptp(p["psi"])) > 30 * pi
        or (p.found("heading-wrap") and float(np.ptp(p.record.values["psi"])) > 300)
        or float(np.ptp(p["psi"])) < np.radians(3)
    ):
        guilty = "psi"
    options = [
        (abs(log(scale / factor)) + (0.0 if unit else 0.02) + (0.5 if guilty not in (None, name) else 0.0), k)
        for k, (name, unit, factor, _) in enumerate(_HYPOTHESES)
        if unit in ("", _stated(p, name))
    ]
    off, k = min(options)
    name, _, factor, real = _HYPOTHESES[k]
    said = p.record.stated.get(name, "?")
    exact = off < 0.15
    value = (1 / factor if name == "psi" else factor) if exact else (1 / scale if name == "psi" else scale)
    p.add(
        "unit", name, 0.97 if exact else 0.85,
        f"the heading changes {brief(scale, 4)} times as fast as r says: {name} says {said} and is "
        + (real if exact else "something else"),
        "Gains come out wrong by the same factor, nonlinear damping by its square; the rudder seems to have no "
        "effect, or far too much.",
        f"Multiply {name} by {value:.6g}, or write its true unit in the header or the format file.",
        fix={"action": "scale", "column": name, "factor": float(value)},
    )  # fmt: skip
    p[name] = p[name] * value


def _clock_factor(p: WorkingCopy, scale: float) -> float | None:
    """The factor on the clock, where positions and speeds ask for the same one as heading and rate."""
    plain = min((0.001, 1 / 60, 60.0, 1000.0, 3600.0), key=lambda f: abs(log(scale / f)))
    if abs(log(scale / plain)) > 0.05:
        return None
    speed = p["U"] if p.has("U") else np.hypot(p["u"], p["v"]) if p.has("u", "v") else p["u"] if p.has("u") else None
    if speed is None or not p.has("x", "y"):
        return plain if plain in (0.001, 1000.0, 3600.0) else None
    at = robust.edges(len(p), 40)
    way = np.hypot(np.diff(p["x"][at]), np.diff(p["y"][at]))
    said = np.diff(robust.integral(p.t, np.abs(speed))[at])
    ratio = float(np.median(way) / max(float(np.median(said)), 1e-300))
    return plain if 0.5 < ratio / plain < 2 else None


def _drift_and_lag(p: WorkingCopy) -> robust.RobustLine | None:
    """Regress what is left of the heading changes when the integral of r is taken off on time and changes of r."""
    whole = relation(p.t, p["psi"], p["r"])
    if whole is None or whole.explained < 0.5:
        return None
    turned = robust.integral(p.t, p["r"])
    found = []
    for count in (300, 120, 50):
        # Short blocks see the lag in a quiet record, long ones in a noisy one: the surest counts.
        at = _edges(p["psi"], count)
        design = np.column_stack([np.diff(p.t[at]), np.diff(p["r"][at])])
        sound = robust.whole(p.t, at)
        one = robust.least_squares(design[sound], (np.diff(p["psi"][at]) - np.diff(turned[at]))[sound])
        if one is not None:
            found.append(one)
    return min(found, key=lambda one: float(one.std[1]), default=None)


def examine_lag(p: WorkingCopy) -> None:
    """Find a drift of the gyro and a shift in time between rate and heading.

    Parameters
    ----------
    p : WorkingCopy
        The record, units and signs put right.
    """
    if not p.has("psi", "r") or len(p) < 60 or p.found("clock-scale"):
        return
    found = _drift_and_lag(p)
    if found is None:
        return
    drift, lag = float(found.value[0]), float(found.value[1])
    high = float(np.quantile(np.abs(p["r"]), 0.9))
    drift_limit = max(7 * float(found.std[0]), 0.01 * high, 1e-7)
    if abs(drift) > drift_limit:
        p.add(
            "bias", "r", robust.confidence_of(abs(drift) / drift_limit, 1, 3),
            f"r differs from the slope of the heading by {shown(drift, 'r')} throughout (gyro bias)",
            "The model takes the bias for a rudder that is not amidships: the neutral angle and the damping of slow "
            "turns come out wrong.",
            f"Add {shown(drift, 'r')} to r, or estimate a bias of r in each trial.",
            fix={"action": "add", "column": "r", "value": drift}, spoils=abs(drift) > 0.1 * high,
        )  # fmt: skip
        p["r"] = p["r"] + drift
    dt = p.sampling
    limit = max(5.5 * float(found.std[1]), 0.6 * dt)
    if lag < -limit and (side := _beside_rudder(p, -lag)) != "psi":
        # No sensor is early by itself: where the rudder does not decide it is the heading that is late.
        told = ", which answers the rudder as it is logged" if side == "r" else " (or the rate is early)"
        p.add(
            "latency", "psi", robust.confidence_of(-lag / limit, 1, 2.5),
            f"the heading runs {brief(-lag, 3)} s ({-lag / dt:.1f} samples) behind the rate of turn{told}",
            "The delay is taken for a slower ship: time constants come out wrong by about as much, and executes are read at headings that "
            "nobody ordered.",
            f"Shift psi by {lag:+.3g} s.", fix={"action": "shift", "column": "psi", "seconds": -lag}, spoils=-lag > 2 * dt,
        )  # fmt: skip
        p.shift("psi", -lag)
    elif abs(lag) > limit:
        which = "behind" if lag > 0 else "ahead of"
        p.add(
            "latency", "r", robust.confidence_of(abs(lag) / limit, 1, 2.5),
            f"r runs {brief(abs(lag), 3)} s ({abs(lag) / dt:.1f} samples) {which} the slope of the heading",
            "The delay is taken for a slower ship: time constants come out wrong by about as much.",
            f"Shift r by {-lag:+.3g} s.", fix={"action": "shift", "column": "r", "seconds": lag}, spoils=abs(lag) > 2 * dt,
        )  # fmt: skip
        p["r"] = np.interp(p.t + lag, p.t, p["r"])


def _beside_rudder(p: WorkingCopy, late: float) -> str | None:
    """Which of rate and heading answers the rudder at once, where they are so many seconds apart; None where that does not show."""
    if not p.has("delta"):
        return None
    with_heading = copy(p)
    with_heading.values = {**p.values, "r": np.interp(p.t - late, p.t, p["r"])}
    answers = [answer_to(one, "delta") for one in (p, with_heading)]
    if any(a is None or a.explained < 0.5 or a.single > SINE for a in answers):
        return None
    by_rate, by_heading = (a.delay for a in answers if a is not None)
    if abs(by_heading - by_rate - late) > _NEAR * late:
        return None
    return "r" if abs(by_rate) < _NEAR * late else "psi" if abs(by_heading) < _NEAR * late else None
