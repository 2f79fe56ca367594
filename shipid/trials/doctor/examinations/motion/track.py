"""Positions against speeds: frames, knots, factors, currents, by comparison with the distance made good."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.numbers import brief, counted
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.motion.way import Way, vector_fit, way_made_good
from shipid.trials.doctor.working_copy import WorkingCopy

_KNOT = 1852 / 3600
_STRONGEST = 0.35
"""A current beyond this share of the speed is an error in the speeds."""
_PLAIN = 0.02
"""A factor that is further from one is one that would be repaired."""
_MISTAKEN_KNOT = 1.9834 / 1.9438
#: Way made good over logged speed: what that means.
UNITS_OF_SPEED = (
    (_KNOT, "knots"), (1 / 3.6, "km/h"), (1 / _KNOT, "m/s that were converted from knots"), (3.6, "m/s that were converted from km/h"),
)  # fmt: skip

#: Units of length in m: positions in them move that much slower than the speeds say.
_LENGTHS = ((0.3048, "feet"), (1852.0, "nautical miles"), (1000.0, "km"))
#: A factor is that of a unit up to this share, more where it is not known as well.
_NEAR = 0.012
#: Factors further from one than this, as a logarithm, are no error of a log.
_FAR = 0.3


@dataclass(frozen=True)
class _Fit:
    """One reading of the speeds against the track."""

    scale: float
    std: float
    flow: tuple[float, float]
    flow_std: float
    sigma: float


def examine_track(p: WorkingCopy) -> None:
    """Compare the track with speeds and heading; put frame, labels and factors right.

    Parameters
    ----------
    p : WorkingCopy
        The record, its heading in order; positions, or speed and course over ground where there are none.
    """
    if p.has("x", "y"):
        _jumps(p)
    if p.speed is None:
        return
    if not p.has("psi") or len(p) < 60 or p.found("clock-scale"):
        return
    needed = [c for c in ("psi", "u", "v", "U") if p.has(c)]
    way = way_made_good(p, *needed)
    if way is None:
        if not p.has("x", "y"):
            _frame_alone(p)
        return
    if p.found("speed-stands"):
        return
    askew = p.found("track-direction") and not any(f.repaired for f in p.findings if f.kind == "track-direction")
    if p.has("u", "v") and not askew:
        _frame(p, way)
    # Northward speed of a ship that sails south is no speed astern.
    if p.has("u") and not askew and not p.found("earth-fixed-velocity"):
        _astern(p, way)
    lengths = _lengths(p, way)
    if lengths is not None and askew:
        _scale(p, way, lengths, lengths)
    elif lengths is not None and (fit := _compare(p, way)) is not None:
        _scale(p, way, fit, lengths)


def _jumps(p: WorkingCopy) -> None:
    """Find positions that jump farther than the ship can go."""
    step = np.hypot(np.diff(p["x"]), np.diff(p["y"]))
    speed = p.speed if p.speed is not None else _made_good(p)
    rough = max(p.noise("x"), p.noise("y"))
    grid = max(float(np.quantile(np.abs(np.diff(p[n])), 0.99)) for n in ("x", "y"))
    fast = float(np.quantile(np.abs(speed), 0.99)) * np.diff(p.t)
    far = np.flatnonzero(step > np.maximum(3 * fast + 12 * rough, 2.5 * grid))
    if len(far) and len(far) < 0.02 * len(p):
        total = float(np.sum(step[far]))
        p.add(
            "position-jump", "x,y", robust.confidence_of(float(np.max(step[far] / (fast[far] + 4 * rough))), 2, 4),
            f"the positions jump {counted(len(far), 'time')}, by {brief(total, 4)} m together, farther than the ship can sail",
            "The position fix was lost for a while, or its clock lagged: tracks and speeds from positions are wrong there.",
            "Fit heading, rate and speed, and leave the positions out around the jump.", at=far, spoils=False,
        )  # fmt: skip


def _made_good(p: WorkingCopy) -> np.ndarray:
    """Speed over the ground by positions many samples apart [m/s]: their noise is little of it, and a jump is in few of them."""
    apart = max(1, len(p) // 60)
    way = np.hypot(*(p[c][apart:] - p[c][:-apart] for c in ("x", "y"))) / (p.t[apart:] - p.t[:-apart])
    return np.asarray(np.minimum(way, 1.2 * np.quantile(way, 0.9)))


def _knots_mistaken(p: WorkingCopy, way: Way) -> float | None:
    """Way made good over logged way on the whole, where it is the ratio of a knot taken wrongly (1.9834 for 1.9438).

    Positions whose clock wanders disagree with the speeds from block to block; over the whole record that cancels.
    """
    if float(np.ptp(p["psi"])) < np.pi or not p.has("u", "x", "y") or not way.kept.all():
        return None
    middle = 0.5 * (p["psi"][1:] + p["psi"][:-1])
    along = float(np.sum((np.diff(p["x"] + 1j * p["y"]) * np.exp(-1j * middle)).real))
    logged = float(robust.integral(p.t, p["u"])[-1])
    if logged <= 0 or 5 * way.rough > 0.002 * logged:
        return None
    return along / logged if abs(along / logged - _MISTAKEN_KNOT) < 0.005 else None


def _misfit(way: Way, sailed: np.ndarray, allowed: float) -> float:
    """Robust misfit of a way sailed to the way made good, a factor and a current estimated."""
    target = np.concatenate([way.made.real, way.made.imag])
    zero = np.zeros_like(way.dt)
    design = np.column_stack([
        np.concatenate([sailed.real, sailed.imag]), np.concatenate([way.dt, zero]), np.concatenate([zero, way.dt])
    ])  # fmt: skip
    found = robust.regress(design, target)
    if found is None or found.value[0] <= 0.05:
        return np.inf
    if float(np.hypot(*found.value[1:])) > allowed:
        design = design[:, :1]
        found = robust.regress(design, target)
        if found is None or found.value[0] <= 0.05:
            return np.inf
    rest = target - design @ found.value
    return float(np.sqrt(np.mean(np.sort(rest**2)[: int(0.9 * len(rest))])))


def _astern(p: WorkingCopy, way: Way) -> None:
    """Find out whether u is counted the other way round: the ship goes ahead where it says astern, and astern where it says ahead."""
    ahead = np.real(way.made * np.exp(-1j * np.angle(way.integral(p.t, np.exp(1j * p["psi"])))))
    found = robust.regress(way.integral(p.t, p["u"])[:, None], ahead)
    if found is None or not -2 < found.value[0] < -0.5 or found.std[0] > 0.1 * abs(found.value[0]):
        return
    applied = p.add(
        "speed-sign", "u", robust.confidence_of(abs(float(found.value[0] / found.std[0])), 10, 40),
        f"along the heading the positions go {found.value[0]:.2f} times as far as u says: u is counted the other way round",
        "The ship seems to go astern: nothing that depends on its speed can be identified or judged.",
        "Change the sign of u; in a format file: sign = -1.", fix={"action": "scale", "column": "u", "factor": -1.0},
    )  # fmt: skip
    if applied:
        p["u"] = -p["u"]


def _frame(p: WorkingCopy, way: Way) -> None:
    """Find out in which frame u and v are: the ship's, the earth's, or exchanged."""
    heads = np.exp(1j * p["psi"])
    u, v = p["u"], p["v"]
    readings = {
        "body": (u + 1j * v) * heads,
        "earth": u + 1j * v,
        "exchanged": (v + 1j * u) * heads,
        "port": (u - 1j * v) * heads,
        "astern": (-u + 1j * v) * heads,
    }
    allowed = _STRONGEST * float(np.mean(np.abs(way.integral(p.t, np.hypot(u, v))) / way.dt))
    misfit = {name: _misfit(way, way.integral(p.t, velocity), allowed) for name, velocity in readings.items()}
    best = min(misfit, key=lambda name: misfit[name])
    if best == "astern":  # `_astern` says so, also where no sway is logged
        return
    c, s = heads.real, heads.imag
    floor = 1e-5 * float(np.sum(np.abs(way.made))) + 1e-9
    if best != "body" and misfit["body"] > 1.5 * max(misfit[best], floor) and np.isfinite(misfit[best]):
        ratio = misfit["body"] / max(misfit[best], floor)
        if best == "earth":
            applied = p.add(
                "earth-fixed-velocity", "u,v", robust.confidence_of(ratio, 1.3, 2.2),
                f"u and v are velocities north and east: turned by the heading they miss the track by {ratio:.1f} times "
                "as much",
                "The ship seems to slow down and slip whenever it turns: sway and surge coefficients are those of the "
                "rotation.",
                'Rotate them with psi; in a format file: frame = "earth" at both.', fix={"action": "rotate"},
            )  # fmt: skip
            if applied:
                p["u"], p["v"] = u * c + v * s, v * c - u * s
        elif best == "exchanged":
            applied = p.add(
                "mislabelled", "u,v", robust.confidence_of(ratio, 1.3, 2.2),
                "u and v fit the track when their names are exchanged",
                "The ship seems to sail sideways.", "Exchange the names u and v.",
                fix={"action": "relabel", "from": "v", "to": "u"},
            )  # fmt: skip
            if applied:
                p.exchange("u", "v")
        else:
            applied = p.add(
                "sway-sign", "v", robust.confidence_of(ratio, 1.3, 2.5),
                "v fits the track when it is counted the other way round",
                "Drift and sway forces change sign: the ship would slip into its turns.",
                "Change the sign of v; in a format file: sign = -1.", fix={"action": "scale", "column": "v", "factor": -1.0},
            )  # fmt: skip
            if applied:
                p["v"] = -v


def _compare(p: WorkingCopy, way: Way) -> _Fit | None:
    """Fit factor and current to the way along the ship (and across it, where v is there)."""
    heads = np.exp(1j * p["psi"])
    middle = 0.5 * (p["psi"][1:] + p["psi"][:-1])
    place = p["x"] + 1j * p["y"] if p.has("x", "y") else robust.integral(p.t, p["SOG"] * np.exp(1j * p["COG"]))
    steps = np.diff(place) * np.exp(-1j * middle)
    ship = np.diff(np.concatenate(([0j], np.cumsum(steps)))[way.at])[way.kept]
    c, s = way.integral(p.t, heads.real), way.integral(p.t, heads.imag)
    speed = p["u"] if p.has("u") else p["U"]
    sailed = way.integral(p.t, speed)
    rows = [np.column_stack([sailed, c, s])]
    target = [ship.real]
    if p.has("u", "v"):
        rows.append(np.column_stack([way.integral(p.t, p["v"]), -s, c]))
        target.append(ship.imag)
    design, wanted = np.concatenate(rows), np.concatenate(target)
    alone = robust.regress(design[:, :1], wanted)
    if alone is None or alone.value[0] <= 0 or alone.std[0] > 0.1 * alone.value[0]:
        return None
    both = robust.regress(design, wanted)
    mean = float(np.mean(np.abs(sailed / way.dt)))
    weak = both is not None and float(np.hypot(*both.value[1:])) < _STRONGEST * mean
    told = both is not None and weak and both.std[0] < 0.02 and float(np.max(both.std[1:])) < 0.05 * mean
    if both is None or not told:
        return _Fit(float(alone.value[0]), float(alone.std[0]), (0.0, 0.0), np.inf, alone.sigma)
    flow = (float(both.value[1]), float(both.value[2]))
    if float(np.hypot(*flow)) < 4 * float(np.max(both.std[1:])) and float(alone.std[0]) < float(both.std[0]):
        return _Fit(float(alone.value[0]), float(alone.std[0]), (0.0, 0.0), np.inf, alone.sigma)
    return _Fit(float(both.value[0]), float(both.std[0]), flow, float(np.max(both.std[1:])), both.sigma)


def _lengths(p: WorkingCopy, way: Way) -> _Fit | None:
    """Compare the length of the track with the way the speed says, whatever their directions."""
    speed = p.speed
    if speed is None:
        return None
    # In a turn the way made good of a block is the chord of what is sailed.
    chord = np.abs(way.integral(p.t, np.exp(1j * p["psi"]))) / way.dt
    found = robust.regress((way.integral(p.t, np.abs(speed)) * chord)[:, None], np.abs(way.made))
    if found is None or found.value[0] <= 0:
        return None
    return _Fit(float(found.value[0]), float(found.std[0]), (0.0, 0.0), np.inf, found.sigma)


def _over_ground(p: WorkingCopy, way: Way, fit: _Fit, lengths: _Fit) -> bool:
    """Whether the speed is the one over ground: it follows the length of the track, which is not along the heading."""
    rough = way.rough + 1e-3 * float(np.median(np.abs(way.made)))
    # A steady circle is fitted by a factor and a current as well; the length of the track then says that no factor is missing.
    missing = abs(fit.scale - 1) > _PLAIN
    exact = missing and lengths.sigma <= rough and abs(lengths.scale - 1) < 0.2 * abs(fit.scale - 1)
    return exact or max(lengths.sigma, rough) < 0.6 * max(fit.sigma, rough)


def _scale(p: WorkingCopy, way: Way, fit: _Fit, lengths: _Fit) -> None:
    columns = [n for n in ("u", "v", "U") if p.has(n)]
    names = ",".join(columns)
    mean = float(np.median(np.abs(way.made) / way.dt)) or 1.0
    ground = fit is not lengths and _over_ground(p, way, fit, lengths)
    if ground:
        _ground_speed(p, way, names, lengths)
        fit = lengths
    whole = None
    if not ground and abs(fit.scale - 1) <= max(7 * fit.std, 0.01) and fit.std > 5e-4:
        whole = _knots_mistaken(p, way)
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
    limit = max(7 * fit.std, 0.01, 0.05 if drift_only or fit is lengths else 0.0)
    current = float(np.hypot(*fit.flow))
    if abs(fit.scale - 1) > limit:
        _wrong_scale(p, columns, fit, limit, ground)
    flow_limit = max(7 * fit.flow_std, 0.01 * mean)
    if current > flow_limit:
        to = angle(float(np.arctan2(fit.flow[1], fit.flow[0])) % (2 * np.pi), 3)
        p.add(
            "track-inconsistent", "x,y," + names, robust.confidence_of(current / flow_limit, 1, 2.5),
            f"the positions drift by {brief(current, 3)} m/s to {to} against the speeds: a current, or a log that is off",
            "Speeds through the water and over the ground differ: advance and tactical diameter from positions are those "
            "of ship and current together.",
            "State the current, or fit heading, rate and speed and leave the positions out.", spoils=False,
        )  # fmt: skip
        return
    rough = max(way.rough, 1e-3 * mean * p.sampling)
    grid = max(robust.resolution(p.measured("x"))[0], robust.resolution(p.measured("y"))[0]) if p.has("x", "y") else 0.0
    if not ground and fit.sigma > 12 * (rough + grid) and fit.sigma > 0.1 * mean * float(np.ptp(p.t)) / 80:
        p.add(
            "track-inconsistent", "x,y," + names, robust.confidence_of(fit.sigma / (rough + grid), 12, 40),
            f"positions and speeds disagree by {brief(fit.sigma, 3)} m from block to block, far beyond their noise",
            "One of the two is wrong; a fit to both describes neither.",
            "Find out which is right, and leave the other out.", spoils=False,
        )  # fmt: skip


def _wrong_scale(p: WorkingCopy, columns: list[str], fit: _Fit, limit: float, ground: bool) -> None:
    names = ",".join(columns)
    if _units_of_positions(p, names, fit):
        return
    near = min(0.03, max(_NEAR, 3 * fit.std))
    unit = next((u for f, u in UNITS_OF_SPEED if abs(np.log(fit.scale / f)) < near), None)
    factor = next((f for f, u in UNITS_OF_SPEED if u == unit), fit.scale)
    knots = " (the knot taken as 1.9834 instead of 1.9438)" if abs(fit.scale - 1.020372) < 0.004 else ""
    # A current along a straight course looks like a factor; only where it is told apart is the factor certain.
    told = np.isfinite(fit.flow_std) or ground
    sure = robust.confidence_of(abs(fit.scale - 1) / limit, 1, 1.8)
    # No log is off by half: where no rate of turn tells the two apart, the clock may be.
    clock = not p.has("r") and abs(np.log(fit.scale)) > _FAR
    causes = [] if told else ["a current along the course"]
    maybe = not told and not unit and abs(fit.scale - 1) < _STRONGEST
    causes += ["a clock that runs at another speed"] if clock else []
    applied = p.add(
        "unit" if unit else "speed-scale", names, sure if unit or (told and not clock) else min(sure, 0.85),
        f"the positions move {brief(fit.scale, 4)} times as fast as the speeds say{knots}"
        + (f": {names} are {unit}" if unit else f": a factor, or {' or '.join(causes)}" if causes else ""),
        "Every coefficient made dimensionless with the speed is off by this factor, those of the rudder by its "
        "square.",
        f"Multiply {names} by {factor:.6g}; in a format file: scale = {factor:.6g}, or the true unit.",
        fix={"action": "scale", "column": names, "factor": float(factor)}, spoils=not maybe,
    )  # fmt: skip
    if applied:
        for name in columns:
            p[name] = p[name] * factor


def _units_of_positions(p: WorkingCopy, names: str, fit: _Fit) -> bool:
    """Find positions in another unit than metres; whether they are."""
    if not p.has("x", "y"):
        return False
    metres, unit = next(
        ((m, u) for m, u in _LENGTHS if abs(np.log(fit.scale * m)) < max(_NEAR, 3 * fit.std)), (0.0, "")
    )
    if not unit:
        return False
    applied = p.add(
        "unit", "x,y", 0.95, f"the positions move {brief(fit.scale, 4)} times as fast as {names} says: x and y are in {unit}",
        "Advance, transfer and tactical diameter come out wrong by this factor, and so does every speed that is derived from the positions.",
        f"Multiply x and y by {metres:g}, or write their true unit in the header.",
        fix={"action": "scale", "column": "x,y", "factor": metres},
    )  # fmt: skip
    if applied:
        for name in ("x", "y"):
            p[name] = p[name] * metres
    return True


def _ground_speed(p: WorkingCopy, way: Way, names: str, lengths: _Fit) -> None:
    """Say that the speeds are over ground, and what current drives the ship off its heading."""
    ahead = way.integral(p.t, np.exp(1j * p["psi"]))
    found = vector_fit(way, ahead)
    drift = ""
    if found is not None and abs(found.flow) > 5 * found.flow_std and abs(found.flow) < _STRONGEST * abs(found.factor):
        drift = f": a current of about {brief(abs(found.flow), 2)} m/s to {angle(float(np.angle(found.flow)) % (2 * np.pi), 3)}"
    p.add(
        "ground-speed", names, robust.confidence_of(lengths.std and 2.0, 0.5, 2.5),
        f"{names} follow the length of the track and not the way ahead: the speed over ground, and the ship is set off its heading"
        + drift,
        "The force of the rudder follows the speed through the water: coefficients and their symmetry are those of ship and "
        "current together.",
        "Call the column SOG, and take the speed through the water for u; nothing is scaled.", spoils=False,
    )  # fmt: skip


def _frame_alone(p: WorkingCopy) -> None:
    """Without positions: velocities that follow the sine of the heading are the earth's."""
    if not p.has("u", "v") or float(np.ptp(p["psi"])) < np.radians(15):
        return
    speed = np.hypot(p["u"], p["v"])
    if float(np.median(speed)) <= 5 * p.noise("v"):
        return
    found = robust.regress(np.column_stack([speed * np.sin(p["psi"]), speed * np.cos(p["psi"])]), p["v"])
    other = robust.regress(np.column_stack([speed * np.cos(p["psi"]), speed * np.sin(p["psi"])]), p["u"])
    if found is None or other is None:
        return
    slopes = float(found.value[0]), float(other.value[0])
    if all(0.7 < slope < 1.3 for slope in slopes) and found.explained > 0.7 and other.explained > 0.9:
        applied = p.add(
            "earth-fixed-velocity", "u,v", 0.92 if found.explained > 0.9 else 0.85, "v follows the sine of the heading, u its cosine",
            "The ship seems to slow down and slip whenever it turns.",
            'Rotate them with psi; in a format file: frame = "earth" at both.', fix={"action": "rotate"},
        )  # fmt: skip
        if not applied:
            return
        c, s = np.cos(p["psi"]), np.sin(p["psi"])
        p["u"], p["v"] = p["u"] * c + p["v"] * s, p["v"] * c - p["u"] * s
