"""Positions against speeds: frames, knots, factors, currents, by comparison with the distance made good."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.working_copy import WorkingCopy

_KNOT = 1852 / 3600
_STRONGEST = 0.35
"""A current beyond this share of the speed is an error in the speeds."""
_MISTAKEN_KNOT = 1.9834 / 1.9438
#: Way made good over logged speed: what that means.
_UNITS = (
    (_KNOT, "knots"), (1 / 3.6, "km/h"), (1 / _KNOT, "m/s where the header says knots"),
    (3.6, "m/s where the header says km/h"),
)  # fmt: skip


@dataclass(frozen=True)
class _Fit:
    """One reading of the speeds against the track."""

    scale: float
    std: float
    flow: tuple[float, float]
    flow_std: float
    sigma: float


def examine_track(p: WorkingCopy) -> None:
    """Compare positions with speeds and heading; put frame, labels and factors right.

    Parameters
    ----------
    p : WorkingCopy
        The record, its heading in order.
    """
    if not p.has("psi") or len(p) < 60 or not (p.has("u") or p.has("U")):
        return
    if not p.has("x", "y"):
        _frame_alone(p)
        return
    if p.has("u", "v"):
        _frame(p)
    _jumps(p)
    fit = _compare(p)
    if fit is not None:
        _scale(p, fit)


def _jumps(p: WorkingCopy) -> None:
    """Find positions that jump farther than the ship can go."""
    speed = np.hypot(p["u"], p["v"]) if p.has("u", "v") else p["u"] if p.has("u") else p["U"]
    step = np.hypot(np.diff(p["x"]), np.diff(p["y"]))
    rough = max(robust.noise(p["x"]), robust.noise(p["y"]))
    grid = max(float(np.quantile(np.abs(np.diff(p[n])), 0.99)) for n in ("x", "y"))
    fast = float(np.quantile(np.abs(speed), 0.99)) * np.diff(p.t)
    far = np.flatnonzero(step > np.maximum(3 * fast + 12 * rough, 2.5 * grid))
    if len(far) and len(far) < 0.02 * len(p):
        total = float(np.sum(step[far]))
        p.add(
            "position-jump", "x,y", robust.confidence_of(float(np.max(step[far] / (fast[far] + 4 * rough))), 2.5, 6),
            f"the positions jump {len(far)} times, by {total:.4g} m together, farther than the ship can sail",
            "The position fix was lost for a while, or its clock lagged: tracks and speeds from positions are wrong there.",
            "Fit heading, rate and speed, and leave the positions out around the jump.", at=far, spoils=False,
        )  # fmt: skip


def _knots_mistaken(p: WorkingCopy) -> float | None:
    """Way made good over logged way on the whole, where it is the ratio of a knot taken wrongly (1.9834 for 1.9438).

    Positions whose clock wanders disagree with the speeds from block to block; over the whole record that cancels.
    """
    if float(np.ptp(p["psi"])) < np.pi or not p.has("u"):
        return None
    along = float(np.sum(_steps(p, np.array([0, len(p) - 1]))[0]))
    way = float(robust.integral(p.t, p["u"])[-1])
    rough = 10 * max(robust.noise(p["x"]), robust.noise(p["y"]))
    if way <= 0 or rough > 0.002 * way:
        return None
    return along / way if abs(along / way - _MISTAKEN_KNOT) < 0.005 else None


def _blocks(p: WorkingCopy) -> np.ndarray:
    """Edges of blocks in which the ship makes far more way than the positions are noisy."""
    way = float(np.sum(np.hypot(np.diff(p["x"][:: max(1, len(p) // 60)]), np.diff(p["y"][:: max(1, len(p) // 60)]))))
    rough = robust.noise(p["x"]) + robust.noise(p["y"]) + 1e-12
    count = int(np.clip(way / (30 * rough), 16, 80))
    return robust.edges(len(p), count)


def _steps(p: WorkingCopy, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Way made good along and across the ship, block by block [m]."""
    middle = 0.5 * (p["psi"][1:] + p["psi"][:-1])
    north, east = np.diff(p["x"]), np.diff(p["y"])
    c, s = np.cos(middle), np.sin(middle)
    along = np.concatenate(([0.0], np.cumsum(north * c + east * s)))
    across = np.concatenate(([0.0], np.cumsum(east * c - north * s)))
    return np.diff(along[at]), np.diff(across[at])


def _earth(p: WorkingCopy, at: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Integrals of two velocities, block by block, in one column."""
    return np.concatenate([np.diff(robust.integral(p.t, u)[at]), np.diff(robust.integral(p.t, v)[at])])


def _misfit(p: WorkingCopy, at: np.ndarray, u: np.ndarray, v: np.ndarray, free: bool = True) -> float:
    """Robust misfit of velocities (north, east) to the track, a factor and a current estimated."""
    target = np.concatenate([np.diff(p["x"][at]), np.diff(p["y"][at])])
    way = _earth(p, at, u, v)
    dt = np.diff(p.t[at])
    zero = np.zeros_like(dt)
    design = np.column_stack([way, np.concatenate([dt, zero]), np.concatenate([zero, dt])])
    found = robust.regress(design, target)
    if found is None or (found.value[0] <= 0.05 and free):
        return np.inf
    if float(np.hypot(*found.value[1:])) > _STRONGEST * float(np.mean(np.hypot(*way.reshape(2, -1)) / dt)):
        found = robust.regress(design[:, :1], target)
        if found is None or (found.value[0] <= 0.05 and free):
            return np.inf
        design = design[:, :1]
    rest = target - design @ found.value
    return float(np.sqrt(np.mean(np.sort(rest**2)[: int(0.9 * len(rest))])))


def _frame(p: WorkingCopy) -> None:
    """Find out in which frame u and v are: the ship's, the earth's, or exchanged."""
    at = _blocks(p)
    c, s = np.cos(p["psi"]), np.sin(p["psi"])
    u, v = p["u"], p["v"]
    readings = {
        "body": (u * c - v * s, u * s + v * c),
        "earth": (u, v),
        "exchanged": (v * c - u * s, v * s + u * c),
        "port": (u * c + v * s, u * s - v * c),
    }
    misfit = {name: _misfit(p, at, *velocity) for name, velocity in readings.items()}
    best = min(misfit, key=lambda name: misfit[name])
    floor = 1e-5 * float(np.ptp(p["x"]) + np.ptp(p["y"])) + 1e-9
    if best != "body" and misfit["body"] > 1.5 * max(misfit[best], floor) and np.isfinite(misfit[best]):
        ratio = misfit["body"] / max(misfit[best], floor)
        if best == "earth":
            p.add(
                "earth-fixed-velocity", "u,v", robust.confidence_of(ratio, 1.3, 2.2),
                f"u and v are velocities north and east: turned by the heading they miss the track by {ratio:.1f} times "
                "as much",
                "The ship seems to slow down and slip whenever it turns: sway and surge coefficients are those of the "
                "rotation.",
                'Rotate them with psi; in a format file: frame = "earth" at both.', fix={"action": "rotate"},
            )  # fmt: skip
            p["u"], p["v"] = u * c + v * s, v * c - u * s
        elif best == "exchanged":
            p.add(
                "mislabelled", "u,v", robust.confidence_of(ratio, 1.3, 2.2),
                "u and v fit the track when their names are exchanged",
                "The ship seems to sail sideways.", "Exchange the names u and v.",
                fix={"action": "relabel", "from": "v", "to": "u"},
            )  # fmt: skip
            p["u"], p["v"] = v, u
        else:
            p.add(
                "sway-sign", "v", robust.confidence_of(ratio, 1.3, 2.5),
                "v fits the track when it is counted the other way round",
                "Drift and sway forces change sign: the ship would slip into its turns.",
                "Change the sign of v; in a format file: sign = -1.", fix={"action": "scale", "column": "v", "factor": -1.0},
            )  # fmt: skip
            p["v"] = -v
        return
    swapped = _swapped(p, at, readings["body"])
    if swapped < misfit["body"] / 2 and misfit["body"] > 3 * floor:
        p.add(
            "mislabelled", "x,y", robust.confidence_of(misfit["body"] / max(swapped, floor), 2, 4),
            "x and y fit heading and speed when their names are exchanged: x is north, y is east",
            "Tracks, drift angles and currents come out mirrored.", "Exchange the names x and y.",
            fix={"action": "relabel", "from": "y", "to": "x"},
        )  # fmt: skip
        p["x"], p["y"] = p["y"], p["x"]


def _swapped(p: WorkingCopy, at: np.ndarray, velocity: tuple[np.ndarray, np.ndarray]) -> float:
    p["x"], p["y"] = p["y"], p["x"]
    try:
        return _misfit(p, at, *velocity)
    finally:
        p["x"], p["y"] = p["y"], p["x"]


def _compare(p: WorkingCopy) -> _Fit | None:
    """Fit factor and current to the way along the ship (and across it, where v is there)."""
    at = _blocks(p)
    along, across = _steps(p, at)
    dt = np.diff(p.t[at])
    c, s = (np.diff(robust.integral(p.t, f(p["psi"]))[at]) for f in (np.cos, np.sin))
    speed = p["u"] if p.has("u") else p["U"]
    way = np.diff(robust.integral(p.t, speed)[at])
    rows = [np.column_stack([way, c, s])]
    target = [along]
    if p.has("u", "v"):
        rows.append(np.column_stack([np.diff(robust.integral(p.t, p["v"])[at]), -s, c]))
        target.append(across)
    design, wanted = np.concatenate(rows), np.concatenate(target)
    alone = robust.regress(design[:, :1], wanted)
    if alone is None or alone.value[0] <= 0 or alone.std[0] > 0.1 * alone.value[0]:
        return None
    both = robust.regress(design, wanted)
    mean = float(np.mean(np.abs(way / dt)))
    weak = both is not None and float(np.hypot(*both.value[1:])) < _STRONGEST * mean
    told = both is not None and weak and both.std[0] < 0.02 and float(np.max(both.std[1:])) < 0.05 * mean
    if both is None or not told:
        return _Fit(float(alone.value[0]), float(alone.std[0]), (0.0, 0.0), np.inf, alone.sigma)
    flow = (float(both.value[1]), float(both.value[2]))
    if float(np.hypot(*flow)) < 4 * float(np.max(both.std[1:])) and float(alone.std[0]) < float(both.std[0]):
        return _Fit(float(alone.value[0]), float(alone.std[0]), (0.0, 0.0), np.inf, alone.sigma)
    return _Fit(float(both.value[0]), float(both.std[0]), flow, float(np.max(both.std[1:])), both.sigma)


def _scale(p: WorkingCopy, fit: _Fit) -> None:
    names = ",".join(n for n in ("u", "v", "U") if p.has(n))
    columns = [n for n in ("u", "v", "U") if p.has(n)]
    speed = p["u"] if p.has("u") else p["U"]
    mean = float(np.median(np.abs(speed))) or 1.0
    whole = _knots_mistaken(p) if abs(fit.scale - 1) <= max(7 * fit.std, 0.01) and fit.std > 5e-4 else None
    if whole is not None:
        p.add(
            "speed-scale", names, 0.6,
            f"over the whole record the positions go {whole:.4f} times as far as the speeds say: the knot taken as "
            "1.9834 instead of 1.9438 makes 1.0204",
            "Every coefficient made dimensionless with the speed is off by this factor, those of the rudder by its "
            "square.",
            f"Multiply {names} by {_MISTAKEN_KNOT:.6g}; in a format file: scale = {_MISTAKEN_KNOT:.6g}.", spoils=True,
        )  # fmt: skip
    drift_only = not p.has("v") and p.has("U") and not p.has("u")
    limit = max(7 * fit.std, 0.01, 0.05 if drift_only else 0.0)
    current = float(np.hypot(*fit.flow))
    if abs(fit.scale - 1) > limit:
        unit = next((u for f, u in _UNITS if abs(np.log(fit.scale / f)) < max(0.05, 3 * fit.std)), None)
        factor = next((f for f, u in _UNITS if u == unit), fit.scale)
        knots = " (the knot taken as 1.9834 instead of 1.9438)" if abs(fit.scale - 1.020372) < 0.004 else ""
        p.add(
            "unit" if unit else "speed-scale", names, robust.confidence_of(abs(fit.scale - 1) / limit, 1, 1.8),
            f"the positions move {fit.scale:.4f} times as fast as the speeds say{knots}"
            + (f": {names} are {unit}" if unit else ""),
            "Every coefficient made dimensionless with the speed is off by this factor, those of the rudder by its "
            "square.",
            f"Multiply {names} by {factor:.6g}; in a format file: scale = {factor:.6g}, or the true unit.",
            fix={"action": "scale", "column": names, "factor": float(factor)},
        )  # fmt: skip
        for name in columns:
            p[name] = p[name] * factor
    flow_limit = max(7 * fit.flow_std, 0.01 * mean)
    if current > flow_limit:
        to = angle(float(np.arctan2(fit.flow[1], fit.flow[0])) % (2 * np.pi), 3)
        p.add(
            "track-inconsistent", "x,y," + names, robust.confidence_of(current / flow_limit, 1, 2.5),
            f"the positions drift by {current:.3g} m/s to {to} against the speeds: a current, or a log that is off",
            "Speeds through the water and over the ground differ: advance and tactical diameter from positions are those "
            "of ship and current together.",
            "State the current, or fit heading, rate and speed and leave the positions out.", spoils=False,
        )  # fmt: skip
        return
    rough = max(robust.noise(p["x"]), robust.noise(p["y"]), 1e-3 * mean * p.sampling)
    grid = max(robust.resolution(p["x"])[0], robust.resolution(p["y"])[0])
    if fit.sigma > 12 * (rough + grid) and fit.sigma > 0.1 * mean * float(np.ptp(p.t)) / 80:
        p.add(
            "track-inconsistent", "x,y," + names, robust.confidence_of(fit.sigma / (rough + grid), 12, 40),
            f"positions and speeds disagree by {fit.sigma:.3g} m from block to block, far beyond their noise",
            "One of the two is wrong; a fit to both describes neither.",
            "Find out which is right, and leave the other out.", spoils=False,
        )  # fmt: skip


def _frame_alone(p: WorkingCopy) -> None:
    """Without positions: velocities that follow the sine of the heading are the earth's."""
    if not p.has("u", "v") or float(np.ptp(p["psi"])) < np.radians(15):
        return
    speed = np.hypot(p["u"], p["v"])
    if float(np.median(speed)) <= 5 * robust.noise(p["v"]):
        return
    found = robust.regress(np.column_stack([speed * np.sin(p["psi"]), speed * np.cos(p["psi"])]), p["v"])
    other = robust.regress(np.column_stack([speed * np.cos(p["psi"]), speed * np.sin(p["psi"])]), p["u"])
    if found is None or other is None:
        return
    slopes = float(found.value[0]), float(other.value[0])
    if all(0.7 < slope < 1.3 for slope in slopes) and found.explained > 0.7 and other.explained > 0.9:
        p.add(
            "earth-fixed-velocity", "u,v", 0.85, "v follows the sine of the heading, u its cosine",
            "The ship seems to slow down and slip whenever it turns.",
            'Rotate them with psi; in a format file: frame = "earth" at both.', fix={"action": "rotate"},
        )  # fmt: skip
        c, s = np.cos(p["psi"]), np.sin(p["psi"])
        p["u"], p["v"] = p["u"] * c + p["v"] * s, p["v"] * c - p["u"] * s
