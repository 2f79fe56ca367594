"""Measure a spiral: the steady rate of turn against the rudder angle, and the loop of a ship that is not course-stable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.trials.errors import NotAManoeuvreError
from shipid.trials.measuring.faults import Faults
from shipid.trials.measuring.results.measures import Measures, quantity, words
from shipid.trials.measuring.rudder.steering import steering_of
from shipid.trials.signals import series
from shipid.trials.signals.channel import Channel, channel_of
from shipid.trials.trial import Trial

_FEWEST = 50
"""Samples below which a record shows no stages."""
_LEAST = 6
"""A spiral has this many stages at least."""
_SHORTEST = 0.015
"""A stage takes this share of the record at least."""
_LEVEL = 0.02
"""Within a stage the level stays within this share of its range."""
_MOST = 0.6
"""More than this share of the stages of a spiral last long enough for a rate: a helm that rests here and there is none."""
_LOOP = 0.05
"""A loop lower than this share of the largest rate is none."""
_SETTLED = 0.03
"""A rate that still changes by more than this share of the largest, over the last third of a stage, has not settled."""


@dataclass(frozen=True, repr=False, kw_only=True)
class MeasuredSpiral(Measures):
    """A spiral, in the terms of ITTC 7.5-04-02-01: direct (Dieudonne) or reversed (Bech).

    Attributes
    ----------
    kind : str
        ``"spiral"``.
    part, columns
        The table of the stages, see `Measures`.
    method : {"direct", "reversed"}
        Whether the rudder was held until the rate was steady, or the rate was held by the rudder.
    rudders, rates, ends : tuple of float
        Rudder angle and steady rate of turn of each stage, and when it ended.
    loop_width, loop_height, slope : float or None
        See the meaning of each in `quantities`; None where the stages do not show it.
    """

    kind: ClassVar[str] = "spiral"
    part: ClassVar[str] = "stage"
    columns: ClassVar[Mapping[str, tuple[str, int]]] = {
        "ends": ("end", 1),
        "rudders": ("rudder", 2),
        "rates": ("rate of turn", 3),
    }
    method: str = words()
    rudders: tuple[float | None, ...] | None = quantity("rad", "rudder angle of each stage, mean")
    rates: tuple[float | None, ...] | None = quantity("rad/s", "steady rate of turn of each stage")
    ends: tuple[float | None, ...] | None = quantity("s", "end of each stage")
    loop_width: float | None = quantity("rad", "rudder angles between which the ship may turn either way")
    loop_height: float | None = quantity("rad/s", "difference of the two steady rates of turn at midships")
    slope: float | None = quantity(
        "1/s", "rate of turn a unit of rudder at midships; negative where the ship is unstable"
    )

    @property
    def title(self) -> str:
        """What the manoeuvre is called, such as ``direct spiral``."""
        return f"{self.method} spiral"

    @property
    def no_loop(self) -> str:
        """Why what width and height say is no loop, in words; empty where it is one, or where they say nothing."""
        largest = max((abs(rate) for rate in self.rates or () if rate is not None), default=0.0)
        height = self.loop_height
        if self.method != "direct" or height is None or not (height or self.loop_width) or height > _LOOP * largest:
            return ""
        low = f"its height is less than {100 * _LOOP:.0f} % of the largest rate of turn"
        return f"no loop: {low}, as stages leave that are not quite settled"


@dataclass(frozen=True)
class _Stage:
    """A stretch at one level: from when to when, and the level."""

    start: float
    end: float
    level: float


def is_spiral(trial: Trial, faults: Faults) -> bool:
    """Return whether the rudder, or the rate of turn, goes down and up in stages that last long enough to show a rate.

    Parameters
    ----------
    trial : Trial
        The trial.
    faults : Faults
        What the doctor found.
    """
    stages = _stages(trial, faults)[1]
    psi = channel_of(trial, "psi", faults.wrong.get("psi"))
    shown = [bool(np.isfinite(_rate(psi, stage)[0])) for stage in stages]
    return sum(shown) > _MOST * len(shown)


def measure_spiral(trial: Trial, execute: str | None, length: float | None, faults: Faults) -> MeasuredSpiral:
    """Measure a spiral (see `shipid.trials.measuring.measure.measure`).

    Parameters
    ----------
    trial : Trial
        The trial, or a window of it, with heading and rudder.
    execute, length
        Not needed here.
    faults : Faults
        What the doctor found.

    Returns
    -------
    MeasuredSpiral

    Raises
    ------
    NotAManoeuvreError
        If neither rudder nor rate of turn goes through stages.
    """
    method, stages = _stages(trial, faults)
    if not stages:
        raise NotAManoeuvreError(
            f"trial '{trial.name}' is no spiral: neither the rudder nor the rate of turn goes down or up through "
            f"{_LEAST} held stages. Choose the window of the manoeuvre (FILE@start:end), or state its kind."
        )
    steering = steering_of(trial, "order", wrong=faults.wrong.get("delta"))
    if trial.has("delta"):
        steering = steering_of(trial, "order", "delta", faults.wrong.get("delta"))
    psi = channel_of(trial, "psi", faults.wrong.get("psi"))
    reasons: dict[str, str] = {}
    notes: list[str] = []
    unsettled: list[int] = []
    rudders = np.array([_mean(steering.channel, s) for s in stages])
    read = [_rate(psi, s) for s in stages]
    rates = np.array([rate for rate, _ in read])
    largest = float(np.nanmax(np.abs(rates)))
    for k, (stage, (_, change)) in enumerate(zip(stages, read), start=1):
        hole = psi.hole(stage.start + 0.6 * (stage.end - stage.start), stage.end, 0.1 * (stage.end - stage.start))
        if hole is not None or not np.isfinite(rates[k - 1]):
            reasons[f"rates[{k}]"] = faults.hole("psi", hole or (stage.start, stage.end))
            rates[k - 1] = np.nan
        elif abs(change) > _SETTLED * largest:
            unsettled.append(k - 1)
            notes.append(
                f"stage {k} ({angle(rudders[k - 1], 3)}): the rate of turn had not settled, it changed by "
                f"{angle(change, 2)}/s over the last third"
            )
    width, height, slope = (_direct_loop if method == "direct" else _reversed_loop)(rudders, rates)
    why_width = why_height = "the stages do not go from one side to the other and back"
    if method == "direct" and (inside := [k for k in unsettled if _beside_zero(k, rudders)]):
        height, why_height = None, _not_settled(inside)
    # The width is read where the rate of turn goes through zero, and counts as one only beside the height.
    if method == "direct" and (inside := [k for k in unsettled if _beside_zero(k, rates) or _beside_zero(k, rudders)]):
        width, slope, why_width = None, None, _not_settled(inside)
        known = np.setdiff1d(np.arange(len(rates)), unsettled)
        notes += _bracket(rudders[known], rates[known])
    reasons |= {} if width is not None else {"loop_width": why_width}
    reasons |= {} if height is not None else {"loop_height": why_height}
    if width and height and method == "direct" and height > _LOOP * largest:
        notes += _bracket(rudders, rates)
    found = MeasuredSpiral(
        trial=trial.name,
        execute="order",
        read_from="",
        method=method,
        rudders=tuple(float(v) for v in rudders),
        rates=tuple(float(v) if np.isfinite(v) else None for v in rates),
        ends=tuple(s.end for s in stages),
        loop_width=width,
        loop_height=height,
        slope=slope,
        reasons=reasons,
    )
    notes += [found.no_loop] if found.no_loop else []
    return replace(found, notes=(*notes, *faults.notes(("psi", steering.channel.name))))


def _stages(trial: Trial, faults: Faults) -> tuple[str, list[_Stage]]:
    """The stages of a spiral, by the rudder or by the rate of turn; none where there is no spiral."""
    channel = steering_of(trial, "order", wrong=faults.wrong.get("delta")).channel
    rudder = _once(channel.t, channel.y)
    by_rudder = _held(*rudder)
    psi = channel_of(trial, "psi", faults.wrong.get("psi"))
    t, y = _once(psi.t, psi.y)
    if min(len(t), len(rudder[0])) >= _FEWEST:
        width = 0.3 * _SHORTEST * float(t[-1] - t[0])
        rate = series.smoothed(t, np.gradient(series.smoothed(t, y, width), t), width)
        # What is held is at its level first: the rudder in a direct spiral, the rate of turn in a reversed one.
        if np.mean(_still(t, rate)) > np.mean(_still(*rudder)):
            by_rate = _held(t, rate)
            if _goes_through(by_rate):
                return "reversed", by_rate
    return "direct", by_rudder if _goes_through(by_rudder) else []


def _held(t: np.ndarray, y: np.ndarray) -> list[_Stage]:
    """Stretches at one level."""
    if len(t) < _FEWEST:
        return []
    least = _SHORTEST * float(t[-1] - t[0])
    span = _span(y)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], _still(t, y), [False]))))
    result: list[_Stage] = []
    for first, last in zip(edges[0::2], edges[1::2] - 1):
        level = float(np.median(y[first : last + 1]))
        if result and abs(level - result[-1].level) < _LEVEL * span:
            result[-1] = _Stage(result[-1].start, float(t[last]), result[-1].level)
        elif t[last] - t[first] >= least:
            result.append(_Stage(float(t[first]), float(t[last]), level))
    return result


def _span(y: np.ndarray) -> float:
    return float(np.quantile(y, 0.98) - np.quantile(y, 0.02))


def _still(t: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Whether each sample stands at a level; nowhere where the record has none but one."""
    least = _SHORTEST * float(t[-1] - t[0])
    calm = series.smoothed(t, y, 0.3 * least)
    still: np.ndarray = np.abs(np.gradient(calm, t)) < _LEVEL * _span(y) / least
    return still


def _once(t: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """One value a moment, the last: an order that steps has two at the moment of the step."""
    after = np.append(np.diff(t) > 1e-9, np.ones(min(len(t), 1), dtype=bool))
    return t[after], y[after]


def _goes_through(stages: list[_Stage]) -> bool:
    """Whether the levels go through both sides in steps, with at most two turns on the way."""
    if len(stages) < _LEAST:
        return False
    levels = np.array([s.level for s in stages])
    steps = np.diff(levels)
    span = float(np.ptp(levels))
    turns = int(np.sum(np.diff(np.sign(steps)) != 0))
    # The first stage may be the straight approach, and the last the way back to midships.
    inner = np.sort(np.abs(steps[1:-1] if abs(levels[-1]) < 0.1 * span else steps))
    usual = (inner[-1] if abs(levels[-1]) < 0.1 * span else inner[-2]) if len(inner) > 1 else 0.0
    both = float(levels.min()) < -0.2 * span and float(levels.max()) > 0.2 * span
    return both and turns <= 3 and float(usual) < 0.45 * span


def _mean(channel: Channel, stage: _Stage) -> float:
    late = (channel.t >= stage.start + 0.6 * (stage.end - stage.start)) & (channel.t <= stage.end)
    if late.any():
        return float(np.mean(channel.y[late]))
    return float(np.interp(stage.end, channel.t, channel.y))


def _rate(psi: Channel, stage: _Stage) -> tuple[float, float]:
    """Rate of turn over the last third of a stage, and how much it changed within."""
    late = (psi.t >= stage.start + (stage.end - stage.start) * 2 / 3) & (psi.t <= stage.end)
    if late.sum() < 6:
        return float("nan"), 0.0
    t, y = psi.t[late], psi.y[late]
    x = (t - t.mean()) / np.ptp(t)
    fit = np.polynomial.polynomial.polyfit(x, y, 2)
    return float(fit[1] / np.ptp(t)), float(2 * fit[2] / np.ptp(t))


def _branches(rudders: np.ndarray, rates: np.ndarray, key: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Rudder and rate of the longest way down and the longest way up, each in rising order of `key`."""
    result = []
    for sign in (-1.0, 1.0):
        best: list[int] = []
        run = [0]
        for k in range(1, len(key)):
            run = [*run, k] if sign * (key[k] - key[k - 1]) > 0 else [k]
            best = run if len(run) > len(best) else best
        chosen = np.array(best if sign > 0 else best[::-1], dtype=int)
        good = chosen[np.isfinite(rates[chosen])] if chosen.size else chosen
        result.append((rudders[good], rates[good]))
    return result


def _direct_loop(rudders: np.ndarray, rates: np.ndarray) -> tuple[float | None, float | None, float | None]:
    """Width, height and slope from a way down and a way up at held rudder."""
    down, up = _branches(rudders, rates, rudders)
    if min(len(down[0]), len(up[0])) < 4 or any(b[0][0] >= 0 or b[0][-1] <= 0 for b in (down, up)):
        return None, None, None
    at_zero = [float(np.interp(0.0, *branch)) for branch in (down, up)]
    crossed = [_zero(rate, rudder) for rudder, rate in (down, up)]
    height = max(at_zero[0] - at_zero[1], 0.0)
    width = None if None in crossed else max(float(crossed[1] or 0.0) - float(crossed[0] or 0.0), 0.0)
    loop = height > _LOOP * float(np.nanmax(np.abs(rates)))
    slope = None if loop else float(np.mean([_slope(*branch) for branch in (down, up)]))
    return width, height, slope


def _bracket(rudders: np.ndarray, rates: np.ndarray) -> list[str]:
    """Say between which stages the rate of turn changes sides, and what that leaves of the width; nothing where it does not."""
    one, two = (
        next(((r[k], r[k + 1]) for k in range(len(r) - 1) if y[k] < 0 <= y[k + 1]), None)
        for r, y in _branches(rudders, rates, rudders)
    )
    if one is None or two is None:
        return []
    least, most = max(two[0] - one[1], 0.0), two[1] - one[0]
    return [
        f"the rate of turn changes sides between the stages at {angle(one[1], 3)} and {angle(one[0], 3)} on the way down, at "
        f"{angle(two[0], 3)} and {angle(two[1], 3)} on the way up: the loop is {angle(least, 3)} to {angle(most, 3)} wide"
    ]


def _beside_zero(k: int, values: np.ndarray) -> bool:
    """Whether the rudder, or the rate of turn, goes through zero in a stage or next to it."""
    return bool(np.ptp(np.sign(values[max(0, k - 1) : k + 2])) > 0)


def _not_settled(stages: list[int]) -> str:
    numbers = ", ".join(str(k + 1) for k in stages)
    return f"the rate of turn had not settled in stage {numbers}; hold the rudder longer there"


def _reversed_loop(rudders: np.ndarray, rates: np.ndarray) -> tuple[float | None, float | None, float | None]:
    """Width, height and slope from the curve of the rudder that holds each rate."""
    down, up = _branches(rudders, rates, rates)
    if min(len(down[1]), len(up[1])) < 4 or any(b[1][0] >= 0 or b[1][-1] <= 0 for b in (down, up)):
        return None, None, None
    rate = np.union1d(down[1], up[1])
    rudder = 0.5 * (np.interp(rate, down[1], down[0]) + np.interp(rate, up[1], up[0]))
    width = max(float(rudder[rate < 0].max() - rudder[rate > 0].min()), 0.0)
    outer = np.flatnonzero(np.diff(np.sign(rudder)) > 0)
    height = 0.0
    if width > 0 and outer.size:
        ends = [float(np.interp(0.0, rudder[[k, k + 1]], rate[[k, k + 1]])) for k in (outer[0], outer[-1])]
        height = max(ends[1] - ends[0], 0.0)
    gradient = _slope(rate, rudder)
    return width, height, None if gradient == 0 else 1 / gradient


def _zero(y: np.ndarray, x: np.ndarray) -> float | None:
    """Where `y` goes through zero from below."""
    rising = np.flatnonzero((y[:-1] < 0) & (y[1:] >= 0))
    return float(np.interp(0.0, y[[rising[0], rising[0] + 1]], x[[rising[0], rising[0] + 1]])) if rising.size else None


def _slope(x: np.ndarray, y: np.ndarray) -> float:
    """Slope of y over x around x = 0."""
    near = np.argsort(np.abs(x))[:3]
    return float(np.polyfit(x[near], y[near], 1)[0])
