"""Manoeuvres in an unsegmented log: zig-zags, turns, pull-outs, steady and irregular stretches, from rudder and heading."""

from __future__ import annotations

import numpy as np

from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.findings import Stretch
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.filling import GAP
from shipid.trials.signals.course_change import ends_on_course
from shipid.trials.signals.plates import Plate, reached_angle
from shipid.trials.signals.series import smoothed

_LEAST = np.radians(1.5)
"""Rudder angles below this are course keeping."""

_LEAST_SWING = np.radians(0.7)
"""A rudder that is reversed nearer to the course than this keeps it."""

_LARGEST = np.radians(60.0)
"""Heading at which the rudder of a zig-zag is reversed, at the most."""

_ALIKE = 0.3
"""Orders are given at one heading where they are this share of it apart."""

_TURNED_BACK = 0.4
"""A rudder that comes this far on its way to its first plate, at least, is reversed on it."""

_TIP = 0.3
"""Share of such a stretch at which the rudder is near its largest angle: 0.4 of two ramps."""

_STRAIGHT = 0.1
"""Shares of a plate's angle by which a rudder on its way to the other side stays near a straight line, however slow its gear."""


def find_manoeuvres(p: WorkingCopy) -> list[Stretch]:
    """Find the manoeuvres of a record.

    Parameters
    ----------
    p : WorkingCopy
        The record, everything put right.

    Returns
    -------
    list of Stretch
        In order of time, without gaps.
    """
    ordered = p.has("delta_order") and np.ptp(p["delta_order"]) > 0 and not p.found("order-late")
    name = "delta_order" if ordered else p.rudder
    if name is None or not p.has("psi") or len(p) < 30:
        return []
    delta = p[name] - _offset(p[name])
    held = _held(p.t, delta)
    taken: list[tuple[int, int, Stretch]] = []
    for chain in _chains(held, p.t, delta):
        taken += _zigzags(p, delta, chain)
    used = [(a, b) for a, b, _ in taken]
    for plate in held:
        if any(a < plate.last and plate.first < b for a, b in used):
            continue
        turn = _turn(p, delta, plate)
        if turn is not None:
            taken += turn
    taken.sort(key=lambda item: item[0])
    return _filled(p, delta, taken)


def _offset(delta: np.ndarray) -> float:
    """Middle between two plates the rudder goes to and fro between; 0 where it does not."""
    low, high = np.quantile(delta, [0.04, 0.96])
    middle, half = 0.5 * float(low + high), 0.5 * float(high - low)
    both = low < 0 < high and min(-low, high) > 0.25 * max(-low, high)
    if not both or abs(middle) < 0.1 * half:
        return 0.0
    over = np.where(delta > middle + 0.5 * half, 1, np.where(delta < middle - 0.5 * half, -1, 0))
    sides = over[over != 0]
    held = float(np.mean(np.abs(np.abs(delta - middle) - half) < 0.15 * half))
    return middle if int(np.sum(np.diff(sides) != 0)) >= 2 and held > 0.5 else 0.0


def _held(t: np.ndarray, delta: np.ndarray) -> list[Plate]:
    """Split the rudder into stretches on one side, each with the angle it is held at."""
    size = float(np.quantile(np.abs(delta), 0.98))
    least = max(min(_LEAST, 0.3 * size), 5 * robust.noise(delta))
    result: list[Plate] = []
    for sign in (1, -1):
        for a, b in robust.runs(sign * delta > least):
            if b - a < 3:
                continue
            level = sign * delta[a:b]
            angle = reached_angle(level[level >= 0.5 * level.max()])
            # The stretch proper: where the rudder is at least half over.
            over = np.flatnonzero(level >= 0.5 * angle)
            first, last = int(a + over[0]), int(a + over[-1]) + 1
            part = sign * delta[first:last]
            dwell = float(np.mean(np.abs(part - angle) <= max(0.2 * angle, np.radians(0.7))))
            result.append(Plate(first, last, sign * angle, dwell))
    return sorted(result, key=lambda plate: plate.first)


def _chains(held: list[Plate], t: np.ndarray, delta: np.ndarray) -> list[list[Plate]]:
    """Join stretches of alternating sides that follow one another without a pause."""
    chains: list[list[Plate]] = []
    usual = float(np.median(np.diff(t)))
    for plate in held:
        if chains:
            before = chains[-1][-1]
            shorter = min(t[before.last - 1] - t[before.first], t[plate.last - 1] - t[plate.first])
            apart = np.diff(t[before.last - 1 : plate.first + 1])
            # What is not recorded is no pause, as long as no other plate fits into it.
            gap = float(apart.max()) if float(apart.max()) > GAP * usual else 0.0
            pause = t[plate.first] - t[before.last - 1] - (gap if gap < shorter + 2 * usual else 0.0)
            # Before its first plate is reached, slow gear may be reversed already.
            least = _TURNED_BACK if len(chains[-1]) == 1 else 0.6
            alike = least < abs(before.angle / plate.angle) < 1.7
            # Slow gear takes long from one side to the other, and does not rest amidships.
            over = slice(before.last - 1, plate.first + 1)
            off = delta[over] - np.interp(t[over], t[over][[0, -1]], delta[over][[0, -1]])
            crossing = len(off) > 5 and float(np.abs(off).max()) < _STRAIGHT * abs(plate.angle)
            longest = max((2.0 if crossing else 0.5) * shorter, 3 * float(np.median(np.diff(t))))
            if plate.side != before.side and alike and pause <= longest:
                chains[-1].append(plate)
                continue
        chains.append([plate])
    return [chain for chain in chains if len(chain) >= 2]


def _zigzags(p: WorkingCopy, delta: np.ndarray, chain: list[Plate]) -> list[tuple[int, int, Stretch]]:
    """Return the zig-zag in a chain of plates, if it is one, without the plates at its ends that do not belong."""
    t, psi = p.t, p["psi"]
    lengths = np.array([t[plate.last - 1] - t[plate.first] for plate in chain])
    usual = float(np.median(lengths))
    angle = float(np.median([abs(plate.angle) for plate in chain]))
    good = [
        plate.dwell > 0.3 and 0.25 * usual < length < 4 * usual and 0.75 < abs(plate.angle) / angle < 1.35
        for plate, length in zip(chain, lengths)
    ]
    best = max(robust.runs(np.array(good)), key=lambda run: run[1] - run[0], default=None)
    if best is None or best[1] - best[0] < 2:
        return []
    if (
        tuple(map(int, best)) == (0, 2)
        and len(chain) == 3
        and 0.75 < abs(chain[2].angle) / angle < 1.35
        and chain[2].dwell > 0.3
    ):
        # The last plate is held for long; without it one reversal is left, which tells no heading.
        best = (0, 3)
    plates = chain[best[0] : best[1]]
    if best[0] == 1 and _turned_back(p, delta, chain[0], plates):
        plates = chain[: best[1]]
    at = np.array([psi[min(plate.last, len(psi) - 1)] for plate in plates[:-1]]) * plates[0].side
    out, back = at[0::2], at[1::2]
    if len(plates) == 2:
        # One reversal: the heading must go out and come back.
        course = psi[plates[0].first] * plates[0].side
        swing, spread = float(out[0] - course), 0.0
        if not swing > 0 or p["psi"][-1] * plates[0].side > out[0] + swing:
            return []
    else:
        swing = 0.5 * float(np.median(out) - np.median(back))
        spread = max(float(np.ptp(out)), float(np.ptp(back)))
    begin, end = _begin(delta, plates[0]), _end(delta, plates[-1])
    regular = swing > 0 and spread < 1.2 * swing and all(plate.dwell > 0.4 for plate in plates)
    if swing <= _LEAST_SWING or spread > 2.5 * swing:
        return []
    heading = _heading_change(p, delta, plates, swing)
    # In slow gear the ship turns far on while the rudder goes over: the heading at the order tells a zig-zag from circles.
    if swing > np.pi / 2 and not (len(plates) > 2 and heading < _LARGEST):
        return []
    nominal = _nominal(max(abs(plate.angle) for plate in plates))
    return [
        (
            begin, end,
            Stretch(
                "zigzag", float(t[begin]), float(t[end]), nominal, _nominal(heading),
                "starboard" if plates[0].side > 0 else "port", bool(regular),
            ),
        )
    ]  # fmt: skip


def _turned_back(p: WorkingCopy, delta: np.ndarray, first: Plate, plates: list[Plate]) -> bool:
    """Whether a rudder that came short of its first plate was reversed at the heading at which it is reversed from the others."""
    if len(plates) < 3 or first.dwell < _TIP:
        return False
    at = np.interp([_leaves(p.t, delta, plate) for plate in (first, *plates[:-1])], p.t, p["psi"]) * first.side
    swing = 0.5 * float(at[0] - at[1])
    return swing > 0 and max(float(np.ptp(at[0::2])), float(np.ptp(at[1::2]))) < _ALIKE * swing


def _heading_change(p: WorkingCopy, delta: np.ndarray, plates: list[Plate], swing: float) -> float:
    """Heading change at the order: where the rudder begins to leave its plate, and not where it is half over."""
    t, psi = p.t, p["psi"]
    at = np.interp([_leaves(t, delta, plate) for plate in plates[:-1]], t, psi) * plates[0].side
    if len(at) < 2:
        return float(at[0] - psi[plates[0].first] * plates[0].side)
    value = 0.5 * float(np.median(at[0::2]) - np.median(at[1::2]))
    alike = max(float(np.ptp(at[0::2])), float(np.ptp(at[1::2]))) < _ALIKE * value
    return value if value > 0.3 * swing or (len(at) > 2 and alike) else swing


def _leaves(t: np.ndarray, delta: np.ndarray, plate: Plate) -> float:
    """When the rudder leaves a plate [s]: the ramp between 0.85 and half of its angle, extended back to the plate."""
    share = plate.side * delta[plate.first : plate.last + 1]
    # Of a short plate between slow ramps the middle of the third at the top is not the top.
    angle = max(abs(plate.angle), float(np.quantile(share, 0.9)))
    near = np.flatnonzero(share >= 0.85 * angle)
    if not near.size:
        return float(t[plate.last - 1])
    k = plate.first + int(near[-1])
    end = min(plate.last, len(t) - 1)
    fall = plate.side * float(delta[k] - delta[end])
    if end - k < 2 or fall < 0.2 * angle:
        return float(t[k])
    return float(t[k] - max(angle - plate.side * float(delta[k]), 0.0) / fall * (t[end] - t[k]))


def _nominal(angle: float) -> float:
    degrees = float(np.degrees(angle))
    return float(max(5 * round(degrees / 5), 5)) if degrees >= 2.5 else float(round(degrees, 1))


def _begin(delta: np.ndarray, plate: Plate) -> int:
    """The sample at which the rudder sets out for its plate."""
    before = plate.side * delta[: plate.first + 1]
    calm = np.flatnonzero(before < 0.15 * abs(plate.angle))
    return int(calm[-1]) if calm.size else 0


def _end(delta: np.ndarray, plate: Plate) -> int:
    return min(plate.last, len(delta) - 1)


def _turn(p: WorkingCopy, delta: np.ndarray, plate: Plate) -> list[tuple[int, int, Stretch]] | None:
    """Return the turn sailed on one plate, and the pull-out after it."""
    t, psi = p.t, p["psi"]
    begin, end = _begin(delta, plate), _end(delta, plate)
    turned = plate.side * float(psi[end] - psi[begin])
    if turned < np.radians(80) or plate.dwell < 0.5:
        return None
    side = "starboard" if plate.side > 0 else "port"
    angle = abs(plate.angle)
    found = [
        (
            begin, end,
            Stretch(
                "turn", float(t[begin]), float(t[end]), _nominal(angle), round(float(np.degrees(turned)), 1), side,
                plate.dwell > 0.7 and not ends_on_course(t, delta, psi, plate.first, end),
            ),
        )
    ]  # fmt: skip
    after = np.flatnonzero(np.abs(delta[end:]) > 0.25 * angle)
    # The rudder may still be on its way back; put over to the other side it is not.
    stop = len(t) - 1
    beyond = after[(after > 0.05 * (end - begin)) | (plate.side * delta[end + after] < 0)]
    if beyond.size:
        stop = end + int(beyond[0])
    if end + 5 < stop:
        rate = smoothed(t, np.gradient(psi, t), 0.02 * float(t[end] - t[begin]) + 3 * p.sampling)
        settled = np.flatnonzero(np.abs(rate[end:stop]) < 0.08 * float(np.quantile(np.abs(rate[begin:end]), 0.5)))
        last = end + int(settled[0]) if settled.size else stop
        if t[last] - t[end] > 3 * p.sampling:
            found.append((end, last, Stretch("pull-out", float(t[end]), float(t[last]), 0.0, None, side)))
    return found


def _filled(p: WorkingCopy, delta: np.ndarray, taken: list[tuple[int, int, Stretch]]) -> list[Stretch]:
    """Name what lies between the manoeuvres: steady or irregular."""
    t = p.t
    result: list[Stretch] = []
    rudder = float(np.quantile(np.abs(delta), 0.95))
    rate = np.abs(np.gradient(p["psi"], t)) if not p.has("r") else np.abs(p["r"])
    high = float(np.quantile(rate, 0.95))
    cursor = 0
    for begin, end, stretch in [*taken, (len(t) - 1, len(t) - 1, None)]:
        if begin - cursor > max(5, 0.003 * len(t)) or (stretch is None and not result and begin > cursor):
            part = slice(cursor, begin)
            still = float(np.quantile(np.abs(delta[part] - np.median(delta[part])), 0.95)) < max(0.15 * rudder, 0.02)
            slow = float(np.quantile(rate[part], 0.9)) < max(0.25 * high, 4 * robust.noise(rate))
            kind = "steady" if still and slow else "irregular"
            result.append(Stretch(kind, float(t[cursor]), float(t[begin]), regular=kind == "steady"))
        if stretch is not None:
            result.append(stretch)
            cursor = max(cursor, end)
    return result
