"""Sampling and resolution: resampled records, coarse intervals, coarse digits, records too short."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from shipid.declaration.vocabulary import angle, shown
from shipid.foundation.numbers import brief, percent
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.steering import rudder as steering
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.signals.coarse import ramps_of, threshold_of

_SMOOTH = ("psi", "r", "x", "y", "u", "v", "U")
#: Where the slope of a channel changes by fewer digits from sample to sample, equal steps are no sign of interpolation.
_FEW_DIGITS = 3
#: Thresholds below this share of the range are no matter, those above the other one spoil what is identified.
_FINE, _SPOILING = 0.003, 0.008


def examine_resampling(p: WorkingCopy) -> None:
    """Find channels whose samples lie on lines between the samples of a slower record, or repeat them.

    Parameters
    ----------
    p : WorkingCopy
        The record, its clock in order.
    """
    seen: dict[str, float] = {}
    for name in _SMOOTH:
        if p.has(name) and (share := _made_up(p.measured(name))) > 0.25:
            seen[name] = share
    if not seen:
        return
    worst = max(seen, key=lambda name: seen[name])
    share = seen[worst]
    p.add(
        "resampled", ",".join(seen), robust.confidence_of(share, 0.37, 0.47),
        f"{percent(share)} of the samples of {worst} were not measured: they lie on a line between two others, or repeat one",
        "There is less information than samples: intervals come out too narrow by the square root of the ratio, and "
        "corners of the interpolation look like accelerations.",
        f"Keep about one sample in {brief(1 / (1 - share), 2)}, or weigh the record by the number of samples that were measured.", spoils=False,
    )  # fmt: skip


def _made_up(values: np.ndarray) -> float:
    """Share of the samples that follow from their neighbours, in a record that is not one straight line."""
    if len(values) < 60:
        return 0.0
    d1, d2 = np.diff(values), np.diff(values, 2)
    size = float(np.quantile(np.abs(d1), 0.9))
    if size == 0:
        return 0.0
    tiny = 1e-6 * size + 4e-15 * float(np.abs(values).max())
    knot = np.abs(d2) > tiny
    held = np.abs(d1) <= tiny
    under_way = _dilated(np.abs(d1) > 0.05 * size, 8)
    index = np.flatnonzero(knot & under_way[1:])
    if len(index) < 12:
        return 0.0
    # Only between knots that follow one another closely: a straight course is a long line of its own.
    apart = np.diff(index)
    close = apart[apart <= 24]
    line = float((close - 1).sum() / max(close.sum(), 1)) if len(close) > 0.5 * len(apart) and len(close) > 10 else 0.0
    grid, still = robust.resolution(values)
    held_share = float(np.mean(held[under_way]))
    if held_share > 0.3:
        # Held samples of a slower sensor come at its beat; a printed resolution repeats as the slope has it.
        steps = np.diff(np.flatnonzero(~held & under_way))
        steps = steps[steps <= 3 * np.median(steps)]
        beat = float(np.mean(np.abs(steps - np.median(steps)) <= 0.5)) if len(steps) else 0.0
        moves = np.abs(d1[~held & under_way])
        ragged = robust.spread(moves) > 0.2 * float(np.median(moves))
        return held_share if np.median(steps) >= 2 and beat > 0.85 and ragged else 0.0
    # Where the slope changes by a digit or two, steps are often equal, and three samples on a line say nothing.
    steps = (values - values[0]) / grid if grid > 0 else values
    bends = float(np.median(np.abs(d2[index])))
    printed = grid > 0 and float(np.abs(steps - np.round(steps)).max()) < 0.01 and bends < _FEW_DIGITS * grid
    return line if not printed and not (grid > 0 and still > 0.1) else 0.0


def _dilated(mask: np.ndarray, width: int) -> np.ndarray:
    return np.convolve(mask.astype(float), np.ones(2 * width + 1), "same") > 0.5


def examine_resolution(p: WorkingCopy) -> None:
    """Find channels that are printed, measured or written more coarsely than they move from sample to sample.

    Parameters
    ----------
    p : WorkingCopy
        The record, its clock in order.
    """
    held = {c for f in p.findings if f.kind == "resampled" for c in f.channel.split(",")}
    for name in (*_SMOOTH, "delta"):
        if name in held or not p.has(name) or len(p.own(name)) < 60:
            continue
        reach = float(np.ptp(p.measured(name)))
        if reach > 0 and not _written_on_change(p, name, reach):
            (_coarse_rudder if name == "delta" else _coarse)(p, name, reach)


def _written_on_change(p: WorkingCopy, name: str, reach: float) -> bool:
    """Find a channel that is written again only when it has moved by more than a threshold; whether it is one."""
    threshold = threshold_of(p.measured(name), p.own(name))
    if threshold is None:
        return False
    share = threshold / reach
    # Of a trial that was read the repeated values are left out already.
    still = 1 - float(np.count_nonzero(np.diff(p.measured(name)))) / len(p)
    if share > _FINE:
        p.add(
            "written-on-change", name, robust.confidence_of(share, 0.0, 2 * _FINE),
            f"{name} is written again only when it has moved by more than {shown(threshold, name, digits=2)}: it repeats its last "
            f"value at {percent(still)} of the samples",
            f"Repeated values are old: they lie up to {shown(threshold, name, digits=2)} behind, always to the side {name} came from, so "
            "that gains and time constants are biased and intervals are too narrow.",
            f"Set the logger to write every sample. From this record, leave the repeated values of {name} empty.",
            at=np.flatnonzero(np.diff(p[name]) == 0) + 1, spoils=share > _SPOILING,
        )  # fmt: skip
    return True


def _coarse_rudder(p: WorkingCopy, name: str, reach: float) -> None:
    """Find a rudder whose ramps come in steps of several samples each."""
    ramps = ramps_of(p.t[p.own(name)], p.measured(name))
    if ramps is None or ramps.step < 0.02 * reach:
        return
    share = ramps.step / reach
    p.add(
        "quantised", name, robust.confidence_of(share, 0.0, 0.05),
        f"{name} comes in steps of {angle(ramps.step, 2)}",
        f"The angle that is held is known to half a step: gains are off by up to {percent(share)}, and by more where the logger cuts digits off "
        "instead of rounding them.",
        f"Log {name} with more digits, or take it from another sensor.", spoils=share > 0.1,
    )  # fmt: skip


def _coarse(p: WorkingCopy, name: str, reach: float) -> None:
    grid, still = robust.resolution(p.measured(name))
    if grid == 0 or still < 0.3:
        return
    steps = np.abs(np.diff(p.measured(name)))
    share = float(np.quantile(steps[steps > 0], 0.8)) / reach
    if share > (0.004 if still < 0.6 else 0.0015):
        p.add(
            "quantised", name, min(robust.confidence_of(still, 0.25, 0.7), robust.confidence_of(share, 0.0015, 0.006)),
            f"{name} comes in steps of {brief(100 * share, 2)} % of its range and stands still at {percent(still)} of the samples",
            "The error is no white noise: differences are zero or far too large, and so is what is derived from them; "
            "weights from the residuals come out too large.",
            f"Take {name} from other channels where they give it, and derive nothing from its differences.",
            spoils=False,
        )  # fmt: skip


def unit_time(p: WorkingCopy) -> float | None:
    """Return the time the ship takes for its own length [s], from its particulars or from its helm.

    Parameters
    ----------
    p : WorkingCopy
        The record.
    """
    speed = p["U"] if p.has("U") else p["u"] if p.has("u") else None
    moving = None if speed is None else float(np.quantile(np.abs(speed), 0.9))
    if p.length is not None and (moving or p.cruise):
        return p.length / (moving or p.cruise or 1.0)
    name = p.rudder
    if name is None:
        return None
    start, _, _ = steering.executes(p[name])
    # Between two executes of a zig-zag a ship sails about five lengths.
    apart = np.diff(p.t[start])
    regular = len(apart) >= 3 and float(np.max(apart[1:])) < 1.6 * float(np.min(apart[1:]))
    return float(np.median(apart)) / 5 if regular else None


def examine_sampling(p: WorkingCopy) -> None:
    """Find records sampled too slowly for their ship.

    Parameters
    ----------
    p : WorkingCopy
        The record.
    """
    dt, unit = max(p.sampling, min((p.interval(c) for c in ("psi", "r") if p.has(c)), default=0.0)), unit_time(p)
    if unit is not None:
        limit = unit / 5 if p.length is not None else unit / 4
        if dt > 1.02 * limit:
            known = "" if p.length is not None else " (estimated from the executes)"
            p.add(
                "coarse-sampling", "t", robust.confidence_of(dt / limit, 0.9, 2.0),
                f"samples come every {brief(dt, 4)} s, and the ship takes {brief(unit, 4)} s for its own length{known}: fewer than five",
                "The moment of the execute is known to half an interval only; rudder ramps and the rise of the rate fall "
                "between samples, so that time constants are uncertain by as much.",
                "Log faster; from this record identify gains, not time constants.", spoils=dt > 3 * limit,
            )  # fmt: skip


def _levels_off(p: WorkingCopy) -> bool:
    """Whether the rate of turn has settled by the end of the record: gain and time constant are both seen then."""
    rate = p["r"] if p.has("r") else np.gradient(p["psi"], p.t)
    edges = np.linspace(0, len(rate), 13).astype(int)
    means = np.array([float(rate[a:b].mean()) for a, b in pairwise(edges)])
    reach = float(np.ptp(means))
    return reach > 8 * robust.noise(rate) and float(np.ptp(means[-3:])) < 0.1 * reach


def examine_length(p: WorkingCopy) -> None:
    """Find records that end before the ship has answered the rudder.

    Parameters
    ----------
    p : WorkingCopy
        The record.
    """
    n = len(p)
    if n < 30:
        p.add(
            "short", "t", 0.95 if n < 20 else 0.85, f"the record has {n} sample{'s' * (n != 1)}",
            "There are hardly more samples than unknowns.", "Use a longer record.", spoils=True,
        )  # fmt: skip
        return
    name = p.rudder
    if name is None or p.found("no-rudder-movement") or not p.has("psi"):
        return
    delta = p[name]
    reach = float(np.quantile(np.abs(delta), 0.995))
    over = np.abs(delta) > 0.5 * reach
    first = int(np.argmax(over))
    sides = np.sign(delta[over])
    reversals = int(np.sum(np.diff(sides) != 0))
    turned = float(np.abs(p["psi"][first:] - p["psi"][first]).max(initial=0.0))
    # Back amidships for good, and not on its way to the other side.
    last = int(np.flatnonzero(over)[-1])
    released = n - 1 - last > 0.5 * (last - first + 1)
    if reversals >= 2 or turned > np.pi / 2 or released:
        return
    if _levels_off(p):
        return
    back = reversals == 1 and turned > 0 and abs(p["psi"][-1] - p["psi"][first]) < 0.7 * turned
    if back:
        return
    begins = "its beginning, with the rudder over," if first < 3 else "the first execute,"
    p.add(
        "short", "t", 0.9 if reversals == 0 else 0.7,
        f"the record ends {brief(p.t[-1] - p.t[first], 4)} s after {begins} {angle(turned, 3)} into the turn"
        + (" and after one reversal" if reversals else ""),
        "Gain and time constant cannot be told apart from the beginning of a response: only their ratio is seen.",
        "Use a longer record: two reversals of a zig-zag, or a quarter of a turn.", spoils=reversals == 0,
    )  # fmt: skip
