"""Course of the track against the heading: positions that cannot belong to it, and speeds that cannot belong to the track."""

from __future__ import annotations

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.numbers import brief
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.motion.way import VectorFit, Way, vector_fit, way_made_good
from shipid.trials.doctor.working_copy import WorkingCopy

_STRONGEST = 0.35
"""A current beyond this share of the speed is not taken for one."""
_DRIFTING = np.radians(30)
"""A ship in a turn makes good a course up to this far off its heading; a strong current does, too."""
_HARMFUL = np.radians(15)
_TOLD = np.radians(8)
"""A track that is turned by less in a turning circle may be the sway of its beginning."""


def examine_course(p: WorkingCopy) -> None:
    """Find positions that are exchanged, mirrored or turned against the heading, and a speed that stands near zero.

    Parameters
    ----------
    p : WorkingCopy
        The record, its heading in order.
    """
    if not p.has("psi"):
        return
    way = way_made_good(p, "psi")
    if way is None:
        return
    heads = np.exp(1j * p["psi"])
    ahead = way.integral(p.t, heads)
    if _speed_stands(p, way, ahead):
        return
    speed = p.speed
    sailed = (
        ahead * (float(np.median(np.abs(way.made) / way.dt)))
        if speed is None
        else way.integral(p.t, np.abs(speed) * heads)
    )
    if not float(np.median(np.abs(sailed))) > 0:
        return
    # Body axes do not matter: the size of the speed is the same in all of them.
    varied = _varied(p, way)
    fits = [vector_fit(way, one, varied) for one in (sailed, np.conj(sailed))]
    fits = [_without_torrent(way, one, fit) for one, fit in zip((sailed, np.conj(sailed)), fits)]
    plain, mirrored = fits
    if plain is None or mirrored is None:
        return
    usual = float(np.median(np.abs(way.made)))
    floor = 2 * way.rough + 1e-3 * usual
    ratio = max(plain.misfit, floor) / max(mirrored.misfit, floor)
    names = "x,y" if p.has("x", "y") else "COG"
    if varied and ratio > 1.6 and mirrored.misfit < 0.3 * usual:
        _mirrored(p, names, mirrored, ratio)
    elif plain.misfit < 0.2 * usual + 3 * way.rough:
        if p.has("u", "v"):
            # In body axes the sway says how far the course is off the heading.
            body = vector_fit(way, way.integral(p.t, (p["u"] + 1j * p["v"]) * heads), varied)
            plain = body if body is not None and abs(np.angle(body.factor)) < abs(np.angle(plain.factor)) else plain
        _turned(p, names, way, plain, varied, sailed)


def _varied(p: WorkingCopy, way: Way) -> bool:
    """Whether the heading varies enough to tell a turned track from a current."""
    mean = np.exp(1j * p["psi"][way.at[:-1]])[way.kept]
    return bool(abs(np.mean(mean)) < np.cos(np.radians(8)))


def _without_torrent(way: Way, sailed: np.ndarray, fit: VectorFit | None) -> VectorFit | None:
    """Return a fit without a drift where the drift that was found is no current any more."""
    strongest = _STRONGEST * float(np.median(np.abs(way.made) / way.dt))
    return vector_fit(way, sailed, False) if fit is None or abs(fit.flow) > strongest else fit


def _speed_stands(p: WorkingCopy, way: Way, ahead: np.ndarray) -> bool:
    """Find a speed near zero while the track goes on along the heading."""
    names = [c for c in ("u", "U") if p.has(c)]
    if not names and p.has("SOG", "x", "y"):
        names = ["SOG"]
    if not names:
        return False
    speed = np.hypot(p["u"], p["v"]) if p.has("u", "v") else np.abs(p[names[0]])
    said = float(np.median(np.abs(way.integral(p.t, speed)) / way.dt))
    made = float(np.median(np.abs(way.made) / way.dt))
    if said > 0.1 * made or made < 10 * way.rough / float(np.median(way.dt)):
        return False
    fit = vector_fit(way, ahead, _varied(p, way))
    along = 0.0 if fit is None else abs(fit.factor) / made
    # A ship that drifts with the current makes way, too, but not the way its heading points.
    p.add(
        "speed-stands", ",".join(names), 0.97 if along > 0.5 and _varied(p, way) else 0.7,
        f"{names[0]} stands near {brief(said, 2)} m/s while the track makes {brief(made)} m/s",
        "Everything that is made dimensionless with the speed, the rudder's force first, is meaningless.",
        "Leave the speed out, or find the column that holds it: the log was not working, or was switched off.",
    )  # fmt: skip
    return True


def _mirrored(p: WorkingCopy, names: str, fit: VectorFit, ratio: float) -> None:
    sure = robust.confidence_of(ratio, 1.4, 3.0)
    turn = float(np.degrees(np.angle(fit.factor)))
    agree = f"the lengths agree within {brief(100 * abs(abs(fit.factor) - 1), 2)} %"
    effect = "The ship seems to sail to one side of its heading, or astern: tracks, drift, currents and sway come out wrong, and a " \
        "fit to positions means nothing."  # fmt: skip
    if names == "x,y" and abs(turn - 90) < 8:
        applied = p.add(
            "track-direction", names, sure, f"x and y fit heading and speed when their names are exchanged ({agree})",
            effect, "Exchange the names: x is north, y is east.", fix={"action": "relabel", "from": "y", "to": "x"},
        )  # fmt: skip
        if applied:
            p.exchange("y", "x")
        return
    which = (
        "x counts to the south"
        if abs(abs(turn) - 180) < 8
        else "y counts to the west"
        if abs(turn) < 8
        else "they are mirrored"
    )
    p.add(
        "track-direction", names, sure,
        f"the positions turn to port where the heading turns to starboard: {which}, or the heading counts the other way ({agree})",
        effect, "Find out which of the two is right; a sign is stated in a format file: sign = -1.",
    )  # fmt: skip


def _beside_sway(way: Way, sailed: np.ndarray, heads: np.ndarray) -> VectorFit | None:
    """Fit the way made good by the way sailed, a sway in proportion to the rate of turn, and a drift."""
    # The integral of i r exp(i psi) is exp(i psi).
    sway = np.diff(heads[way.at])[way.kept]
    zero, one = np.zeros_like(way.dt), way.dt
    real = [sailed.real, -sailed.imag, sway.real, -sway.imag, one, zero]
    imaginary = [sailed.imag, sailed.real, sway.imag, sway.real, zero, one]
    target = np.concatenate([way.made.real, way.made.imag])
    found = robust.regress(np.column_stack([np.concatenate(pair) for pair in zip(real, imaginary)]), target)
    if found is None:
        return None
    factor = complex(*found.value[:2])
    std = float(np.max(found.std[:2])) / max(abs(factor), 1e-12)
    return VectorFit(factor, std, complex(*found.value[4:]), float(np.max(found.std[4:])), found.sigma)


def _turned(p: WorkingCopy, names: str, way: Way, fit: VectorFit, varied: bool, sailed: np.ndarray) -> None:
    turn, heads = float(np.angle(fit.factor)), np.exp(1j * p["psi"])
    astern = p.has("u") and float(np.median(p["u"])) < 0 and abs(turn) > np.radians(150)
    psi = p["psi"][way.at]
    steady_turn = abs(float(psi[-1] - psi[0])) > np.pi
    limit = max(5 * fit.std, np.radians(4.0), _DRIFTING if steady_turn or not varied else 0.0)
    own = _beside_sway(way, sailed, heads) if steady_turn and varied else None
    if own is not None and max(5 * own.std, _TOLD) < limit:
        # The approach, on which a ship does not slip, tells a turned track from the drift angle of the turn.
        fit, turn, limit = own, float(np.angle(own.factor)), max(5 * own.std, _TOLD)
    if abs(turn) < limit or astern:
        return
    side = "starboard" if turn > 0 else "port"
    p.add(
        "track-direction", names, robust.confidence_of(abs(turn) / limit, 0.9, 1.5),
        f"the track is turned by {angle(abs(turn), 3)} to {side} of the heading throughout, and its length is "
        f"{brief(abs(fit.factor), 4)} times what the speed says",
        "The ship seems to slip sideways all the time: drift, currents and sway come out wrong.",
        "Find out whether positions or compass are turned: axes that are not north and east, or an error of the compass. The "
        "speed is judged by the length of the track.", spoils=abs(turn) > _HARMFUL,
    )  # fmt: skip
