"""The verb: find the smallest alteration of course that keeps clear, along the tracks that own ship can sail."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.declaration.units import to_si
from shipid.encounter.avoidance import Avoidance, OtherShip, Passing
from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.ship_domain import ShipDomain
from shipid.foundation.numbers import brief
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.predicted_track import PredictedTrack
from shipid.prediction.tracks.track_predictor import TrackPredictor

#: Nodes of a track between which motion is taken as straight.
_POINTS = 400
#: Alterations to a side that are tried at most.
_MOST_STEPS = 720
#: Digits of a share of a domain that tell two courses apart.
_SAME = 9


def avoid(
    predictor: TrackPredictor,
    situation: Situation,
    others: Sequence[OtherShip],
    domain: ShipDomain,
    *,
    heading: str | float | None = None,
    ahead: str | float = "20 min",
    step: str | float = "5 deg",
    widest: str | float = "90 deg",
    starboard_only: bool = False,
) -> Avoidance:
    """Find the smallest alteration of course that keeps out of the domains of other ships.

    Own ship turns as her identified model and her autopilot turn her; the others keep course and speed. Of two equal
    alterations the one to starboard is taken. Where no course keeps clear, the one that keeps the largest share of the domains.

    Parameters
    ----------
    predictor : TrackPredictor
        Own ship with her autopilot.
    situation : Situation
        Own ship now.
    others : sequence of OtherShip
        The other ships at the same instant, in the same frame.
    domain : ShipDomain
        Of every other ship, along her course over the ground.
    heading : str or float, optional
        The wanted heading, with a unit or in rad; the present one by default.
    ahead : str or float
        How far ahead clearance is asked for, with a unit or in s.
    step, widest : str or float
        Alterations that are tried: multiples of the step up to the widest, with a unit or in rad.
    starboard_only : bool
        Whether alterations to port are left out.

    Returns
    -------
    Avoidance

    Raises
    ------
    EncounterRequestError
        If the time or the alterations are out of range or too many, or own ship cannot be predicted on any heading.
    """
    wanted = situation.values["psi"] if heading is None else _si(heading, "rad", "the heading")
    seconds = _si(ahead, "s", "the time ahead")
    fine, far = _si(step, "rad", "the step"), _si(widest, "rad", "the widest alteration")
    if not (seconds > 0 and 0 < fine <= far <= np.pi):
        raise EncounterRequestError(
            f"alterations in steps of {np.rad2deg(fine):g} deg up to {np.rad2deg(far):g} deg over {seconds:g} s are none; "
            "give a step above zero, a widest alteration up to 180 deg, and a time above zero."
        )
    count = int(np.floor(far / fine + 1e-9))
    if count > _MOST_STEPS:
        raise EncounterRequestError(
            f"alterations in steps of {brief(float(np.rad2deg(fine)))} deg up to {np.rad2deg(far):g} deg are {count} to a side, and at most "
            f"{_MOST_STEPS} are tried. Give a larger step."
        )
    others = [others] if isinstance(others, OtherShip) else list(others)
    sides = [1.0] if starboard_only else [1.0, -1.0]
    alterations = np.array([0.0, *(s * k * fine for k in range(1, count + 1) for s in sides)])
    lengths = 1.2 * seconds * max(situation.values["u"], np.hypot(*situation.ground_velocity)) / predictor.length
    tracks = predictor.fan(situation, [float(wanted + a) for a in alterations], horizon=lengths, points=_POINTS)
    motions = np.array([o.motion for o in others], float).reshape(len(others), 4)
    tried, refused, kept = {}, {}, {}
    for alteration, track in zip(alterations, tracks):
        if track.ended:
            refused[float(wanted + alteration)] = track.ended
            continue
        passings = _passings(track, seconds, motions, others, domain)
        share = min((p.share for p in passings), default=np.inf)
        tried[float(wanted + alteration)] = share
        kept[float(alteration)] = (share, track, passings)
    if not kept:
        raise EncounterRequestError(
            f"own ship cannot be predicted on any of the {len(tracks)} headings: {tracks[0].ended}. Ask for a shorter time ahead."
        )
    clear = [a for a, (share, *_) in kept.items() if share >= 1]
    # Rounded: shares that differ by nothing do not decide on a side.
    best = clear[0] if clear else max(kept, key=lambda a: round(kept[a][0], _SAME))
    _, track, passings = kept[best]
    if situation.uncertain:
        track = predictor.predict(situation, heading=float(wanted + best), horizon=lengths, points=_POINTS)
    return Avoidance(
        float(wanted + best),
        best,
        bool(clear),
        track,
        tuple(_with_std(p, o, track) for p, o in zip(passings, others)),
        tried,
        _at_once(situation, wanted + best, seconds, motions, domain),
        refused,
    )


def _si(value: str | float, unit: str, what: str) -> float:
    return to_si(value, unit, what) if isinstance(value, str) else float(value)


def _passings(
    track: PredictedTrack, seconds: float, motions: np.ndarray, others: Sequence[OtherShip], domain: ShipDomain
) -> list[Passing]:
    """The nearest instant to each other ship, found between the nodes of the track too."""
    t = track.t - track.t[0]
    used = np.flatnonzero(t <= seconds)
    last = min(used[-1] + 1, len(t) - 1)
    t, own = t[: last + 1], np.stack([track.x, track.y], axis=-1)[: last + 1]
    found = []
    for other, motion in zip(others, motions):
        apart = motion[:2] + t[:, None] * motion[2:] - own
        # From node to node in one unit of time, so that one horizon holds for all steps.
        steps = np.concatenate([apart[:-1], np.diff(apart, axis=0)], axis=1)
        course = np.full(len(steps), np.arctan2(motion[3], motion[2]))
        share = domain.nearest(steps, course, 1.0)
        squared = np.sum(steps[:, 2:] ** 2, axis=1)
        when = np.clip(-np.sum(steps[:, :2] * steps[:, 2:], axis=1) / np.maximum(squared, 1e-12), 0.0, 1.0)
        distance = np.hypot(*(steps[:, :2] + when[:, None] * steps[:, 2:]).T)
        k = int(np.argmin(distance))
        instant = float(t[k] + when[k] * (t[k + 1] - t[k]))
        found.append(Passing(other.name, float(distance[k]), instant, float(share.min())))
    return found


def _with_std(passing: Passing, other: OtherShip, track: PredictedTrack) -> Passing:
    """The standard deviation of the distance at the nearest instant, by first order."""
    if other.covariance is None and track.covariance is None:
        return passing
    t = track.t - track.t[0]
    own = np.array([np.interp(passing.t, t, track.x), np.interp(passing.t, t, track.y)])
    apart = other.motion[:2] + passing.t * other.motion[2:] - own
    normal = apart / max(float(np.hypot(*apart)), 1e-9)
    variance = 0.0
    if other.covariance is not None:
        moved = np.hstack([np.eye(2), passing.t * np.eye(2)])
        variance += float(normal @ moved @ other.covariance @ moved.T @ normal)
    if track.covariance is not None:
        spread = track.covariance[int(np.argmin(np.abs(t - passing.t)))]
        variance += float(normal @ spread @ normal)
    return Passing(passing.name, passing.distance, passing.t, passing.share, float(np.sqrt(variance)))


def _at_once(situation: Situation, heading: float, seconds: float, motions: np.ndarray, domain: ShipDomain) -> float:
    """The share of the domains that a ship without inertia would keep on a heading."""
    if not len(motions):
        return np.inf
    speed = float(np.hypot(situation.values["u"], situation.values.get("v", 0.0)))
    north, east = situation.current
    own = np.array(
        [
            situation.values.get("x", 0.0),
            situation.values.get("y", 0.0),
            speed * np.cos(heading) + north,
            speed * np.sin(heading) + east,
        ]
    )
    return float(domain.nearest(motions - own, np.arctan2(motions[:, 3], motions[:, 2]), seconds).min())
