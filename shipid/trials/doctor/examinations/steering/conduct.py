"""The conduct of the trial: started from rest, with a rudder offset, different to port and starboard."""

from __future__ import annotations

import itertools

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.numbers import brief, moment
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.steering import rudder as steering
from shipid.trials.doctor.findings import Stretch
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.signals.series import smoothed


def examine_start(p: WorkingCopy) -> None:
    """Find a ship that gathers speed at the beginning of the record.

    Parameters
    ----------
    p : WorkingCopy
        The record, its speeds in the ship's axes.
    """
    speed = p["U"] if p.has("U") else p["u"] if p.has("u") else None
    if speed is None and p.has("x", "y"):
        speed = np.hypot(np.gradient(p["x"], p.t), np.gradient(p["y"], p.t))
    n = len(p)
    if speed is None or n < 60:
        return
    calm = smoothed(p.t, speed, 0.03 * float(np.ptp(p.t)))
    first = min(max(5, n // 100), 15)
    early = float(np.median(speed[:first]))
    top = int(np.argmax(calm[: max(n // 2, 10)]))
    gain = float(calm[top]) - early
    error = 6 * robust.spread(speed - calm) / np.sqrt(first)
    if gain < max(0.25 * float(calm[top]), error) or top < 3:
        return
    settled = int(np.argmax(calm > early + 0.9 * gain))
    p.add(
        "accelerating", "u" if p.has("u") else "U" if p.has("U") else "x,y",
        robust.confidence_of(gain / max(float(calm[top]), 1e-12), 0.2, 0.5),
        f"the ship gathers speed from {brief(early)} to {brief(calm[top])} m/s during the first {brief(p.t[settled] - p.t[0], 4)} s",
        "The force of the rudder grows with the square of the speed: a model at constant speed explains the slow beginning "
        "by a small gain and a long time constant.",
        f"Begin at {moment(p.t[settled])} s (FILE@{moment(p.t[settled])}:), or fit a model with a surge equation and the propeller.",
        at=np.arange(settled + 1), spoils=False,
    )  # fmt: skip


def examine_neutral(p: WorkingCopy, stretches: list[Stretch]) -> None:
    """Find the rudder that keeps the ship straight, and swings that differ from side to side.

    Parameters
    ----------
    p : WorkingCopy
        The record, everything put right.
    stretches : list of Stretch
        Its manoeuvres.
    """
    name = p.rudder
    if name is None or not p.has("r", "psi"):
        return
    for stretch in stretches:
        if stretch.kind != "zigzag":
            continue
        inside = np.flatnonzero((p.t >= stretch.start) & (p.t <= stretch.end))
        if len(inside) < 40:
            continue
        _offset(p, name, inside)
        _sides(p, name, inside)


def _offset(p: WorkingCopy, name: str, inside: np.ndarray) -> None:
    t, delta, r = p.t[inside], p[name][inside], p["r"][inside]
    found = steering.response(t, delta, r)
    if found is None or found.value[0] <= 0 or found.explained < 0.2:
        return
    a, c = float(found.value[0]), float(found.value[3])
    offset = -c / a
    std = float(np.hypot(found.std[3], offset * found.std[0])) / a
    high = float(np.quantile(np.abs(delta), 0.9))
    limit = max(5 * std, 0.05 * high)
    if abs(offset) > limit:
        side = "starboard" if offset > 0 else "port"
        p.add(
            "bias", name, robust.confidence_of(abs(offset) / limit, 1, 2.5),
            f"the ship sails straight with {angle(abs(offset), 3)} of rudder to {side} (it is held at "
            f"{angle(high, 3)}): wind, current, propeller, or an offset of the sensor",
            "Without a term for it port and starboard gains are averaged wrongly: overshoots are missed by about the "
            "ratio of the offset to the angle held.",
            "Estimate a rudder bias in each trial (the default of shipid identify).", at=inside, spoils=False,
        )  # fmt: skip


def _sides(p: WorkingCopy, name: str, inside: np.ndarray) -> None:
    """Compare the swings to port with those to starboard, the first swing left out: it starts from straight."""
    delta, psi, t, r = p[name][inside], p["psi"][inside], p.t[inside], p["r"][inside]
    half = 0.5 * float(np.quantile(np.abs(delta), 0.9))
    side = np.where(delta > half, 1, np.where(delta < -half, -1, 0))
    over = np.flatnonzero(side)
    turns = over[1:][np.diff(side[over]) != 0]
    # A swing with a gap in it, or one whose execute falls into a gap, cannot be compared with the others.
    if len(turns) < 4 or not robust.whole(t, np.array([turns[0] - 1, len(t) - 1])).all():
        return
    cuts = [*turns.tolist(), len(t)]
    rate_peaks = np.array([np.quantile(np.abs(r[a:b]), 0.9) for a, b in itertools.pairwise(cuts) if b - a > 4])
    swings = np.array([np.ptp(psi[a:b]) for a, b in itertools.pairwise(cuts) if b - a > 4])[: len(turns) - 1]
    for what, values, noise in (
        ("rates of turn", rate_peaks[: len(turns) - 1], robust.noise(r)),
        ("swings of the heading", swings, 2 * robust.noise(psi)),
    ):
        if len(values) < 3:
            return
        # Alternating part: what is left when a slow trend (loss of speed) is taken off.
        alternate = (values[1:-1] - 0.5 * (values[:-2] + values[2:])) * (-1.0) ** np.arange(len(values) - 2) / 2
        size = abs(float(np.mean(alternate)))
        error = max(float(np.std(alternate)) / np.sqrt(len(alternate)), noise / np.sqrt(len(alternate)))
        mean = float(np.mean(values))
        limit = max(4 * error, 0.05 * mean * (1 + 2 / len(alternate)))
        if size > limit:
            p.add(
                "asymmetric", "r,psi", robust.confidence_of(size / limit, 1, 2.5),
                f"the {what} to one side are {brief(200 * size / mean)} % larger than to the other",
                "A symmetrical model averages the two sides and misses both: by half the difference in every swing.",
                "Estimate a rudder bias, sail both sides, and fit them together.", at=inside, spoils=False,
            )  # fmt: skip
            return
