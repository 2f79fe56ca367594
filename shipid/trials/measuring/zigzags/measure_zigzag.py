"""Measure a zig-zag: executes, overshoot angles, period, reach, initial turning."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.notices import Notice
from shipid.trials.errors import NotAManoeuvreError
from shipid.trials.measuring.faults import Faults
from shipid.trials.measuring.instead import propeller_doubts, slowed_down, steered_by_hand
from shipid.trials.measuring.results.zigzag import ZigZag
from shipid.trials.measuring.rudder.doubts import bridges, left_out, others_than, silent_in
from shipid.trials.measuring.rudder.ends import begins_on_its_way, goes_on_from, turned_back, without_keeping
from shipid.trials.measuring.rudder.executes import Execute, first_execute, leaves
from shipid.trials.measuring.rudder.late import SettingOut, late_notes, not_told, setting_out, unseen_by, widened
from shipid.trials.measuring.rudder.steering import Steering, rate_of, steering_of
from shipid.trials.measuring.track import over_ground_notes
from shipid.trials.measuring.uncertainty import overshoot_uncertainty
from shipid.trials.measuring.zigzags.beginning import Swing, in_lengths, measure_beginning
from shipid.trials.measuring.zigzags.swings import WIDTH, half_period_of, swings
from shipid.trials.signals import series
from shipid.trials.signals.channel import Channel, channel_of
from shipid.trials.signals.plates import plates, regular
from shipid.trials.trial import Trial

_BRIDGED = 0.1
"""Holes up to this share of the time between two reversals are bridged: a cubic through the samples on both sides is off by
less than 0.1 deg there, at the top of a swing and where the rudder is reversed."""


def measure_zigzag(trial: Trial, execute: str | None, length: float | None, faults: Faults) -> ZigZag:
    """Measure a zig-zag (see `shipid.trials.measuring.measure.measure`).

    Parameters
    ----------
    trial : Trial
        The trial, or a window of it, with heading and rudder.
    execute : {"order", "moved"} or None
        How the execute is read.
    length : float or None
        Ship length [m].
    faults : Faults
        What the doctor found.

    Returns
    -------
    ZigZag

    Raises
    ------
    NotAManoeuvreError
        If the rudder never goes from one plate to the opposite one.
    """
    steering = steering_of(trial, execute, wrong=_wrong_rudder(trial, faults))
    everything = plates(steering.channel.y)
    held = regular(everything)
    if len(held) < 2:
        raise NotAManoeuvreError(
            f"trial '{trial.name}' is no zig-zag: the rudder does not go from one held angle to the opposite one. "
            "Choose the window of the manoeuvre (FILE@start:end), or state its kind."
        )
    steering = rate_of(steering, held)
    logged = channel_of(trial, "psi", faults.wrong.get("psi"))
    held = without_keeping(steering, logged, held)
    short = turned_back(steering, logged, everything, held)
    everything, held = [*(plate for plate in short if plate not in everything), *everything], [*short, *held]
    executes = [leaves(steering, plate) for plate in held[:-1]]
    if begins_on_its_way(steering, held[0]) or executes[0].time - executes[0].within <= steering.channel.t[0]:
        # The record begins with the rudder on its way: the order was before it.
        held, executes = held[1:], executes[1:]
        if not executes:
            raise NotAManoeuvreError(
                f"trial '{trial.name}' begins with the rudder on its way from the only angle it holds, so the moment of the order is not in it. "
                "Widen the window to hold a stretch before the rudder moves."
            )
    when = [e.time for e in executes]
    end = steering.after(held[-1])
    half_period = half_period_of([*when, end])
    psi = logged.bridged(_BRIDGED * half_period)
    side = held[0].side
    found = swings(psi.t, psi.y, when, side=side, end=end)
    start = first_execute(steering, held[0])
    if start is not None and (
        held[0].first == 0 or start[0].time >= when[0] or goes_on_from(steering, everything, held)
    ):
        start = None
    at = np.array([heading for _, _, heading in found])
    course, notes = _course(psi, at, side, None if start is None else start[0].time)
    notes = [*notes, *over_ground_notes(trial)]
    reasons: dict[str, str] = {}
    known = [_unknown(steering, psi, executes, k, end, faults, reasons, found[k][1]) for k in range(len(executes))]
    signs = side * (-1.0) ** np.arange(len(at))
    # The nominal heading is the one at the order: in slow steering gear the ship turns on while the rudder moves.
    ordered = at
    late = setting_out(trial, steering, when, faults)
    slope = np.gradient(psi.y, psi.t)
    turning = float(np.median(np.abs(np.interp(when, psi.t, slope))))
    if steering.reading == "moved":
        by_order = replace(steering, reading="order")
        ordered = np.array([_at(psi, leaves(by_order, plate).time) for plate in held[:-1]])
    beyond_moved = None
    if steering.reading == "order" and not steering.logged and steering.rate is not None:
        by_rudder = replace(steering, reading="moved")
        later = [
            series.value_at(psi.t, psi.y, leaves(by_rudder, plate).time, WIDTH * half_period, 1) for plate in held[:-1]
        ]
        beyond_moved = tuple(
            None if swing[0] is None or not ok else max(0.0, float(swing[0] + s * (h - v)))
            for swing, s, h, v, ok in zip(found, signs, at, later, known)
        )
    overshoots = tuple(swing[0] if ok else None for swing, ok in zip(found, known))
    beside = _from_setting_out(late, psi, side, end, known)
    tops = tuple(swing[1] if ok else None for swing, ok in zip(found, known))
    first = start[0] if start is not None else None
    half = WIDTH * half_period
    stated = tuple(
        None if beyond is None else overshoot_uncertainty(psi, logged, e, top, half)
        for beyond, top, e in zip(overshoots, tops, executes)
    )
    # In a long hole of the rudder on its first plate it may have gone to the other side and back.
    silent = None if first is None else steering.channel.hole(first.time, executes[0].time, 0.5 * half_period)
    shown = [e.time if e.hole is None else None for e in executes]
    cycles = [b - a for a, b in zip(shown, shown[2:]) if a is not None and b is not None]
    angle_held = float(np.median([abs(plate.angle) for plate in held]))
    # The middle between the sides: a rudder that reads some degrees to one side was ordered alike to both.
    ordered_angle = 0.5 * sum(max(abs(plate.angle) for plate in held if plate.side == sign) for sign in (1, -1))
    switch = float(np.median(signs * (ordered - course)))
    apart = 0.0
    if late is not None and late.doubtful:
        apart = (1 + late.about) * abs(float(np.median(np.subtract(late.times, when))))
        # Stamps that are early show headings that were not ordered.
        there = float(np.median(signs * (np.interp(late.times, psi.t, psi.y) - course)))
        switch = min(switch, there, key=lambda one: abs(np.degrees(one) - _nominal(one)))
    swing = Swing(psi, course, side, float(np.radians(_nominal(switch))), half, apart)
    beginning = measure_beginning(trial, swing, first, executes[0], faults, reasons, silent)
    doubt = steered_by_hand(
        [
            None if f"execute_headings[{k}]" in reasons else float(v)
            for k, v in enumerate(signs * (ordered - course), 1)
        ],
        others_than(held, everything),
    )
    slowed = slowed_down(trial, faults.wrong, beginning["approach_speed"], when[0], end, half)
    return ZigZag(
        trial=trial.name,
        execute=steering.reading,
        read_from=steering.words,
        nominal=f"{_nominal(ordered_angle)}/{_nominal(switch)}",
        first_side="starboard" if side > 0 else "port",
        doubt=doubt,
        rudder=angle_held,
        rudder_rate=steering.rate,
        heading=float(np.median(signs * (at - course))),
        course=course,
        executes=tuple(shown),
        execute_within=max(e.within for e in (*executes, *([] if start is None else [start[0]]))),
        execute_headings=tuple(
            float(v) if f"execute_headings[{k}]" not in reasons else None for k, v in enumerate(at - course, start=1)
        ),
        overshoots=overshoots,
        overshoot_uncertainties=stated if late is None or not late.doubtful else widened(stated, overshoots, beside or (), late.about),
        overshoots_set_out=beside,
        overshoots_moved=beyond_moved,
        extreme_headings=tuple(
            None if beyond is None else float(swing[2] + s * beyond - course)
            for swing, beyond, s in zip(found, overshoots, signs)
        ),
        times_to_check_yaw=tuple(None if top is None else top - e for top, e in zip(tops, when)),
        period=float(np.mean(cycles)) if cycles else None,
        **in_lengths(beginning, length),
        reasons=reasons,
        notes=(*notes, *([Notice(f"it may be no zig-zag: {doubt}", "no-zigzag", serious=True)] if doubt else []), *slowed,
               *late_notes(late, beside, unseen_by(trial, steering), turning), *silent_in(steering, held, faults),
               *propeller_doubts(trial, None if first is None else first.time, end), *left_out(logged), *left_out(steering.channel),
               *bridges(logged, psi, when, faults),
               *not_told(faults.notes(("psi", steering.channel.name, "u", "U")), late, steering.channel.name)),
        **beginning,
    )  # fmt: skip


def _wrong_rudder(trial: Trial, faults: Faults) -> np.ndarray | None:
    """Samples of the rudder that count as missing, of whichever column is read."""
    name = "delta_order" if trial.has("delta_order") and not trial.has("delta") else "delta"
    return faults.wrong.get(name)


def _at(psi: Channel, when: float) -> float:
    return float(np.interp(when, psi.t, psi.y))


def _unknown(
    steering: Steering,
    psi: Channel,
    executes: Sequence[Execute],
    k: int,
    end: float,
    faults: Faults,
    reasons: dict[str, str],
    top: float | None,
) -> bool:
    """Whether the overshoot after reversal `k` is known; writes the reasons where something is not."""
    one, then, hole = executes[k], executes[k + 1].time if k + 1 < len(executes) else end, executes[k].hole
    place, why = f"[{k + 1}]", None
    if hole is not None:
        why = faults.hole(steering.channel.name, hole)
        reasons["executes" + place] = why
    elif (hole := psi.hole(one.time)) is not None:
        why = faults.hole("psi", hole)
    if why is not None:
        reasons["execute_headings" + place] = why
    else:
        for a, b in psi.holes:
            if a < then and b > one.time and _turns_back(psi, a, b, end):
                why = faults.hole("psi", (a, b))
                break
    why = why or faults.step(one.time, then if top is None else top)
    if top is None and steering.silence:
        why = why or faults.hole(steering.channel.name, steering.silence)
    if why is None:
        return True
    for name in ("overshoots", "extreme_headings", "times_to_check_yaw"):
        reasons[name + place] = why
    return False


def _turns_back(psi: Channel, a: float, b: float, end: float) -> bool:
    """Whether the heading turns back inside a hole, or may: the slopes on both sides differ in sign."""
    before = np.flatnonzero(psi.t <= a + 1e-9)[-5:]
    after = np.flatnonzero((psi.t >= b - 1e-9) & (psi.t <= end))[:5]
    if before.size < 2 or after.size < 2:
        return True
    one, two = (float(np.polyfit(psi.t[part] - psi.t[part][0], psi.y[part], 1)[0]) for part in (before, after))
    return one * two <= 0


def _course(psi: Channel, at: np.ndarray, side: int, first: float | None) -> tuple[float, list[str]]:
    """The initial course, and what to say of it: the heading at the first execute, or the middle of the reversals."""
    if len(at) < 2:
        if first is not None:
            return _at(psi, first), []
        return float(psi.y[0]), ["course: the record does not show the approach; its first heading is taken"]
    middle = 0.5 * float(np.median(at[0::2]) + np.median(at[1::2]))
    if first is None:
        return middle, ["course: the record does not show the approach; the middle of the reversals is taken"]
    before = _at(psi, first)
    # Hand steering before the zig-zag leaves the ship off the course that the reversals are steered about.
    swing = 0.5 * abs(float(np.median(at[0::2]) - np.median(at[1::2])))
    if abs(before - middle) < 0.15 * swing:
        return before, []
    return middle, [
        f"course: the heading at the first execute was {angle(before)}, and the reversals are steered about "
        f"{angle(middle)}; the latter is taken"
    ]


def _nominal(angle: float) -> int:
    degrees = float(np.degrees(angle))
    return max(5 * round(degrees / 5), 5) if degrees >= 2.5 else round(degrees)


def _from_setting_out(
    late: SettingOut | None, psi: Channel, side: int, end: float, known: Sequence[bool]
) -> tuple[float | None, ...] | None:
    """The overshoots from where the rudder sets out, where that is after the order."""
    if late is None:
        return None
    found = swings(psi.t, psi.y, late.times, side=side, end=end)
    return tuple(one[0] if ok else None for one, ok in zip(found, known))
