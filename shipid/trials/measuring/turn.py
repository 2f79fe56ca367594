"""Measure a turning circle and its pull-out."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import brief, moment
from shipid.trials.errors import NotAManoeuvreError
from shipid.trials.measuring.current import drift_of, still_water
from shipid.trials.measuring.faults import Faults
from shipid.trials.measuring.results.turning_circle import TurningCircle
from shipid.trials.measuring.rudder.executes import LEFT, first_execute
from shipid.trials.measuring.rudder.late import in_words, not_told, turn_by_clock, turn_notes, turn_setting_out
from shipid.trials.measuring.rudder.steering import Steering, rate_of, steering_of
from shipid.trials.measuring.track import (
    TurnTrack,
    drift,
    driven_until,
    over_ground_notes,
    speed_channel,
    track_channels,
    turning_width,
)
from shipid.trials.measuring.uncertainty import distance_uncertainties
from shipid.trials.signals import series
from shipid.trials.signals.channel import Channel, channel_of
from shipid.trials.signals.course_change import ends_on_course
from shipid.trials.signals.plates import Plate, held_angle, plates
from shipid.trials.trial import Trial

MOVED = np.radians(3.0)
"""In the reading "moved" the rudder of a turn counts as moved when it is this far from midships: that of the published circle."""

_DISTANCES = ("advance", "transfer", "tactical_diameter")
_STEADY_TURN = ("steady_rate", "steady_speed", "steady_drift", "speed_loss")
_SLOWER = 0.5
"""A ship that turns at the end by less than this share of the rate between 90 and 270 deg is in no steady turn."""
_QUARTERS = (pi / 2, pi, 1.5 * pi, 2 * pi)
_BRIDGED = 0.05
"""Holes up to this share of the turn's first 90 deg are bridged."""
_LEFT_THERE = np.radians(1.0)
"""In a pull-out the rudder stays within this, or a twentieth of its plate if that is more, of where it was put."""
_STEADY = 0.05
"""A ship that turns at the execute by more than this share of the steady rate was on no steady course."""
_NO_COURSE = 0.3
"""One that turns by more than this share of it was on no course at all."""

_GATHERS = 0.05
"""A ship whose speed changes before the order so fast that it would by this share during the first 90 deg was at no steady speed."""

_INEXACT = 0.015
"""An advance that may be off by more than this share of it is said to be."""

_ACROSS = 0.05
"""A track that leads to the other side by more than this share of the advance is not that of the turn."""


def turning_plate(steering: Steering, psi: Channel) -> Plate | None:
    """Return the stretch at one rudder angle during which the heading changes most, if it changes by 90 deg or more.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    psi : Channel
        The heading.
    """
    best, most = None, pi / 2
    rudder, t = steering.channel.y, steering.channel.t
    for plate in plates(rudder):
        part = plate.side * rudder[plate.first : plate.last]
        # Hand steering to the same side before the turn is a stretch of its own: the rudder is less than half over between.
        over = np.concatenate(([False], part >= 0.5 * abs(plate.angle), [False]))
        edges = np.flatnonzero(np.diff(over))
        for first, last in zip(edges[0::2], edges[1::2]):
            begin, end = plate.first + int(first), plate.first + int(last)
            one, two = np.interp([t[begin], t[end] if end < len(t) else steering.end], psi.t, psi.y)
            if plate.side * (two - one) > most:
                most = plate.side * float(two - one)
                held = held_angle(plate.side * rudder[begin:end])
                best = Plate(begin, end, plate.side * held, plate.dwell)
    return best


def measure_turn(trial: Trial, execute: str | None, length: float | None, faults: Faults) -> TurningCircle:
    """Measure a turning circle (see `shipid.trials.measuring.measure.measure`).

    Parameters
    ----------
    trial : Trial
        The trial, or a window of it, with heading and rudder.
    execute : {"order", "moved"} or None
        How the execute is read; "moved" is 3 deg of rudder here.
    length : float or None
        Ship length [m].
    faults : Faults
        What the doctor found.

    Returns
    -------
    TurningCircle

    Raises
    ------
    NotAManoeuvreError
        If the heading never changes by 90 deg on one rudder, or the record begins in the turn.
    """
    steering = steering_of(trial, execute, wrong=faults.wrong.get("delta"))
    psi = channel_of(trial, "psi", faults.wrong.get("psi"))
    plate = turning_plate(steering, psi)
    if plate is None:
        raise NotAManoeuvreError(
            f"trial '{trial.name}' is no turning circle: the heading does not change by 90 deg on one rudder angle. "
            "Choose the window of the manoeuvre (FILE@start:end), or state its kind."
        )
    steering = rate_of(steering, [plate])
    start = first_execute(steering, plate, moved=MOVED)
    if start is None:
        raise NotAManoeuvreError(
            f"trial '{trial.name}' begins with the rudder over already, so the moment of the order is not in it. "
            "Widen the window to hold a stretch before the rudder moves."
        )
    side, when = plate.side, start[0].time
    off = min(_released(steering, plate), driven_until(trial, when))
    calm = turning_width(psi.interval, off - when)
    psi = psi.bridged(_BRIDGED * (off - when) * pi / 2 / max(_turned(psi, when, off), pi / 2))
    reasons: dict[str, str] = {}
    # The course before the order: the ship turns after it, so nothing of that may be averaged in.
    before = slice(int(np.searchsorted(psi.t, when - 2 * calm)), int(np.searchsorted(psi.t, when, side="right")))
    course = series.value_at(psi.t[before], psi.y[before], when, 2.1 * calm, 1) if before.stop > before.start else None
    if course is None or psi.hole(when) is not None:
        course = float(np.interp(when, psi.t, psi.y))
        reasons["course"] = faults.hole("psi", psi.hole(when) or (when, when))
    turned = side * (psi.y - course)
    running = slice(int(np.searchsorted(psi.t, when)), int(np.searchsorted(psi.t, off, side="right")))
    if running.stop - running.start < 2:
        raise NotAManoeuvreError(
            f"trial '{trial.name}' has no heading while the rudder is over, from {moment(when)} to {moment(off)} s: the turn cannot be measured."
        )
    smooth = series.smoothed(psi.t, turned, calm)[running]
    quarters: list[float | None] = [series.crossing(psi.t[running], smooth, q) for q in _QUARTERS]
    for k, quarter in enumerate(quarters, start=1):
        # The heading is averaged over that width.
        hole = None if quarter is None else psi.hole(quarter - calm, quarter + calm)
        if hole is not None or (quarter is not None and "course" in reasons):
            reasons[f"times[{k}]"] = reasons[f"speeds[{k}]"] = faults.hole(
                "psi", hole or psi.hole(when) or (when, when)
            )
            quarters[k - 1] = None
    moving = speed_channel(trial, faults.wrong)
    for k, quarter in enumerate(quarters, start=1):
        if moving is not None and quarter is not None and (hole := moving.hole(quarter)) is not None:
            reasons[f"speeds[{k}]"] = faults.hole(moving.name, hole)
    found: dict[str, Plain] = {}
    track = track_channels(trial, faults.wrong)
    notes: list[str] = []
    late, beside, way = turn_setting_out(steering, side, when), {}, None
    moves = when if late is None else late.times[0]
    clock, apart = turn_by_clock(steering, psi, side, moves), ""
    misplaced = faults.misplaced() if track is not None and track[2] == "positions" else None
    if misplaced is not None:
        reasons |= dict.fromkeys(_DISTANCES, str(misplaced))
        clock = None
    elif track is not None:
        way = TurnTrack(track[0], track[1], course, side, when, calm, faults)
        found |= way.distances(quarters, reasons)
        if late is not None:
            beside = TurnTrack(track[0], track[1], course, side, late.times[0], calm, faults).distances(quarters, {})
        if clock is not None:
            other = TurnTrack(track[0], track[1], course, side, when + clock.times[0] - moves, calm, faults)
            shifted = [None if q is None else q - clock.times[0] + moves for q in quarters]
            apart = (
                f"counted from where it acts: {in_words(other.distances(quarters, {}))}; "
                f"if it is the heading: {in_words(way.distances(shifted, {}))}"
            )
        if track[2] == "positions":
            why = faults.step(when, off) or way.jump(off)
            at = psi.t[running], psi.y[running], turned[running]
            drifting = None if why else drift_of(track[0], track[1], *at, way.speed(quarters))
            values, unknown, said = still_water(way, found, quarters, drifting, float(turned[running].max()), why)
            found, reasons, notes = found | values, reasons | unknown, [*notes, *said]
    if (why := _other_way(found)) is not None:
        for name in (
            *_DISTANCES,
            *(f"{name}_still_water" for name in _DISTANCES),
            "drift_speed",
            "drift_uncertainty",
            "drift_direction",
        ):
            if found.pop(name, None) is not None or name in reasons:
                reasons[name] = why
        beside, clock, notes = {}, None, []
    found |= _steady(trial, psi, turned, quarters, running, moving, calm)
    swerved, no_course = _approach(psi, when, calm, found.get("steady_rate") or float(smooth[-1]) / (off - when))
    if no_course:
        for name in ("course", *_DISTANCES, *(f"{name}_still_water" for name in _DISTANCES)):
            if found.pop(name, None) is not None or name in {"course", *reasons}:
                reasons[name] = no_course
        beside, clock, notes = {}, None, []
    approach = None if moving is None else series.value_at(moving.t, moving.y, when, calm, 1)
    if moving is not None and (hole := moving.hole(when)) is not None:
        approach, reasons["approach_speed"] = None, faults.hole(moving.name, hole)
    steady_speed, rate = found.get("steady_speed"), found.get("steady_rate")
    over_ground = over_ground_notes(trial)
    if steady_speed is not None and approach and not over_ground:
        found["speed_loss"] = 1 - steady_speed / approach
    if steady_speed is not None and rate:
        earlier = pi / (quarters[2] - quarters[0]) if quarters[0] and quarters[2] else 0.0
        if rate < _SLOWER * earlier:
            why = f"at the end the ship turned at {angle(rate, 3)}/s, less than half of the {angle(earlier, 3)}/s before: no steady turn"
            reasons |= {name: why for name in _STEADY_TURN if found.pop(name, None) is not None}
        else:
            found["steady_diameter"] = 2 * steady_speed / rate
    if length is not None:
        names = (*_DISTANCES, "steady_diameter", *(f"{n}_still_water" for n in _DISTANCES))
        found |= {f"{n}_ratio": value / length for n in names if (value := found.get(n)) is not None}
    if moving is not None and approach:
        notes += _unsteady(moving, when, calm, (quarters[0] or off) - when, approach)
    rudder, over = steering.channel, int(np.searchsorted(steering.channel.t, off)) + 1
    if ends_on_course(rudder.t, rudder.y, np.interp(rudder.t, psi.t, psi.y), plate.first, over):
        notes.append("the turn ends on a course: it is a change of course, and of a turning circle only its beginning")
    notes += [*swerved, *over_ground, *turn_notes(late, beside, steering, approach or 0.0)]
    notes += [] if clock is None else [clock.notice(apart or "the times count from another moment, too")]
    notes += _inexact(start[0].within, approach or 0.0, found.get("advance"))
    if track is not None and "without drift" in track[2]:
        notes.append(
            "neither positions nor a drift angle are logged: advance, transfer and diameter are reckoned along the heading, as if the "
            "ship did not drift in the turn"
        )
    measured_on = ("x", "y") if track is not None and track[2] == "positions" else ("u", "v")
    if way is not None and measured_on == ("x", "y"):
        found |= distance_uncertainties(way, psi, quarters, start[0].within, found)
    return TurningCircle(
        trial=trial.name,
        execute=steering.reading,
        read_from=_words(steering),
        side="starboard" if side > 0 else "port",
        track="" if track is None else track[2],
        rudder=plate.angle,
        rudder_rate=steering.rate,
        approach_speed=approach,
        first_execute=when if start[0].hole is None else None,
        execute_within=start[0].within,
        course=None if "course" in reasons else course,
        times=tuple(None if q is None else q - when for q in quarters),
        speeds=None if moving is None else tuple(_speed_at(moving, q, calm) for q in quarters),
        pull_out_rate=_pull_out(steering, psi, plate, off),
        reasons=reasons | ({} if start[0].hole is None else {"first_execute": faults.hole("delta", start[0].hole)}),
        notes=(
            *notes,
            *not_told(faults.notes(("psi", steering.channel.name, *measured_on)), late or clock, steering.channel.name),
        ),
        **found,
    )


def _words(steering: Steering) -> str:
    return "the rudder 3 deg from midships" if steering.reading == "moved" else steering.words


def _turned(psi: Channel, start: float, end: float) -> float:
    one, two = np.interp([start, end], psi.t, psi.y)
    return abs(float(two - one))


def _speed_at(moving: Channel | None, when: float | None, calm: float) -> float | None:
    if moving is None or when is None or moving.hole(when) is not None:
        return None
    return series.value_at(moving.t, moving.y, when, calm, 1)


def _approach(psi: Channel, when: float, calm: float, rate: float | None) -> tuple[list[str], str]:
    """Say so where the ship was on no steady course before the order, and why no course is known where it turned fast."""
    before = (psi.t >= when - 4 * calm) & (psi.t <= when)
    if before.sum() < 5 or not rate:
        return [], ""
    slope, _ = np.polyfit(psi.t[before] - when, psi.y[before], 1)
    scatter = float(np.std(psi.y[before])) / (4 * calm)
    if abs(slope) < max(_STEADY * rate, 3 * scatter):
        return [], ""
    words = f"the ship turned at {angle(float(slope), 3)}/s at the execute"
    if abs(slope) > _NO_COURSE * rate:
        return [], f"{words}: it was on no course, and distances along and across one say nothing"
    return [f"{words}: distances are along and across its heading there, not a steady course"], ""


def _other_way(found: Mapping[str, float | None]) -> str | None:
    """Why the track is no track of this turn: it leads to the other side, as no ship's and no current's does; None where it does not."""
    across = [found.get("transfer") or 0.0, found.get("tactical_diameter") or 0.0]
    if min(across) > -_ACROSS * abs(found.get("advance") or np.inf):
        return None
    return "the track turns to the other side than the heading: x and y may be exchanged, or one of them counted the other way round"


def _unsteady(moving: Channel, when: float, calm: float, way: float, approach: float) -> list[str]:
    """Say so where the speed rose or fell before the order: the distances are not those from a steady approach."""
    before = (moving.t >= when - max(way, 4 * calm)) & (moving.t <= when)
    # A heading that jumps by a quarter of a turn at the order leaves no way.
    if before.sum() < 8 or way <= 0:
        return []
    t, y = moving.t[before] - when, moving.y[before]
    if (-t[0] < 2 * calm) or moving.hole(when - 2 * calm, when) is not None:
        return []
    slope, level = np.polyfit(t, y, 1)
    scatter = float(np.std(y - level - slope * t)) / (float(np.std(t)) * np.sqrt(len(t)))
    if abs(slope) < max(_GATHERS * approach / way, 4 * scatter):
        return []
    verb = "rose" if slope > 0 else "fell"
    return [
        f"the speed {verb} by {brief(abs(slope) * -t[0], 2)} m/s in the {brief(-t[0], 3)} s before the order: advance, transfer and diameter are not those "
        "of a ship at a steady approach speed"
    ]


def _inexact(within: float, approach: float, advance: float | None) -> list[str]:
    """Say so where the moment of the order is not known well enough for the advance."""
    off = within * approach
    if advance is None or off < _INEXACT * advance:
        return []
    return [
        f"the order is known to {brief(within, 2)} s only: the advance lies within {brief(off, 3)} m of what is stated"
    ]


def _released(steering: Steering, plate: Plate) -> float:
    """When the rudder comes off its plate for good, the end of the record at the latest [s]."""
    if plate.last >= len(steering.channel.t):
        return steering.end
    on = np.flatnonzero(plate.side * steering.channel.y[: plate.last] >= (1 - LEFT) * abs(plate.angle))
    return float(steering.channel.t[int(on[-1])])


def _steady(
    trial: Trial,
    psi: Channel,
    turned: np.ndarray,
    quarters: list[float | None],
    running: slice,
    moving: Channel | None,
    calm: float,
) -> dict[str, float | None]:
    """Rate, speed and drift angle of the steady turn: its last quarter, where it goes beyond 270 deg."""
    if quarters[2] is None:
        return {}
    end = float(psi.t[running.stop - 1])
    begin = max(quarters[2], end - 0.25 * (end - float(psi.t[running.start])))
    stretch = slice(int(np.searchsorted(psi.t, begin)), running.stop)
    if stretch.stop - stretch.start < 5 or psi.t[stretch.stop - 1] - psi.t[stretch.start] < 2 * calm:
        return {}
    t = trial["t"]
    inside = (t >= begin) & (t <= end)

    def mean(values: np.ndarray | None) -> float | None:
        there = None if values is None else values[inside & np.isfinite(values)]
        return None if there is None or not there.size else float(np.mean(there))

    rate = mean(trial["r"]) if trial.has("r") else None
    if rate is None:
        x = psi.t[stretch] - psi.t[stretch.start]
        rate = float(np.polynomial.polynomial.polyfit(x, turned[stretch], 1)[1])
    fast = None
    if moving is not None:
        part = (moving.t >= begin) & (moving.t <= end)
        fast = float(np.mean(moving.y[part])) if part.any() else None
    sideways = mean(drift(trial))
    return {
        "steady_rate": abs(rate),
        "steady_speed": fast,
        "steady_drift": None if sideways is None else abs(sideways),
    }


def _pull_out(steering: Steering, psi: Channel, plate: Plate, off: float) -> float | None:
    """Rate of turn left when the rudder has been midships for a while: the last fifth of what is recorded of it."""
    t, rudder = steering.channel.t, steering.channel.y
    released = int(np.searchsorted(t, off, side="right"))
    after = np.flatnonzero(np.abs(rudder[released:]) < 0.1 * abs(plate.angle))
    if not after.size:
        return None
    begin = released + int(after[0])
    # As long as the rudder is left where it was put.
    lies = float(np.median(rudder[begin : begin + max(5, (len(t) - begin) // 10)]))
    near = np.abs(rudder[begin:] - lies) <= max(0.05 * abs(plate.angle), _LEFT_THERE)
    begin += int(np.argmax(near))
    moved = np.flatnonzero(~near[int(np.argmax(near)) :])
    end = float(t[begin + int(moved[0])]) if moved.size else steering.end
    part = (psi.t >= end - 0.2 * (end - t[begin])) & (psi.t <= end)
    # The rate takes about as long to settle as the ship takes to turn by some 60 deg.
    if (
        end - t[begin] <= 0.1 * (off - t[plate.first])
        or part.sum() < 3
        or psi.hole(float(psi.t[part][0]), end) is not None
    ):
        return None
    return float(np.polynomial.polynomial.polyfit(psi.t[part] - end, psi.y[part], 1)[1])
