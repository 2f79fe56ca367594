"""A rudder angle that stands still while the rudder moves: it catches up in one leap, or the ship turns back under it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from shipid.foundation.numbers import brief
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.working_copy import WorkingCopy

#: A leap is so many times what the rudder covers in a sample on its ramps, and this share of its range.
_LEAP, _SHARE = 2.2, 0.15
#: Repeats of one value that are looked at, and those before a leap.
_LONG, _BRIEF = 8, 5
#: Samples on ramps from which on the rate of the rudder is known.
_FEWEST = 8
#: The ship turns to the other side than the rudder that stands, by this share of her usual rate, and was turning to its side before by that.
_BACK, _BEFORE = 0.25, 0.5
#: A ship that turns to the other side so many times as often as her rudder goes there, and these, yaws in waves.
_YAWS, _FEW = 2, 4
#: And one that turns back by less than so many times the scatter of her heading about a curve with so many bends.
_YAW, _BENDS = 4.0, 5
#: The rudder that stands lies over by this share of its range.
_OVER = 0.25


def examine_standing_rudder(p: WorkingCopy) -> None:
    """Find stretches in which the rudder angle repeats one value although the rudder moves.

    Parameters
    ----------
    p : WorkingCopy
        The record, signs put right.
    """
    name = "delta"
    if not p.has(name) or len(p.own(name)) < 30 or p.found("no-rudder-movement"):
        return
    if any(f.kind == "written-on-change" and name in f.channels for f in p.findings):
        return
    index = p.own(name)
    t, values = p.t[index], p[name][index]
    stands = robust.runs(np.diff(values) == 0)
    leaps, rate = _leaps(t, values)
    leaps = np.append(leaps, False)
    lasts = stands[:, 1] - stands[:, 0]
    stands = stands[(lasts >= _LONG) | ((lasts >= _BRIEF) & leaps[stands[:, 1]])]
    if not len(stands):
        return
    rattles = robust.never_repeats(values, stands)
    # An autopilot may put the rudder as far over as it is allowed, and there it stands: no sample lies beyond.
    ends = float(values.min()), float(values.max())
    found = [
        (_since(t, values, a, b, rate) if leaps[b] and not rattles else a, b)
        for a, b in stands
        if (rattles and values[a] not in ends) or leaps[b] or _turns_back(p, index[a], index[b])
    ]
    if not found:
        return
    longest = max(float(t[b] - t[a]) for a, b in found)
    often = "" if len(found) == 1 else f" {len(found)} times, at the longest"
    why = (
        "its other samples scatter, and none of them repeats"
        if rattles
        else "then it leaps, or the ship turns to the other side"
    )
    p.add(
        "frozen", name, 0.95,
        f"{name} stands at one value{often} for {brief(longest, 4)} s while the rudder moves: {why}",
        "The model is fitted to a rudder that did not stand: gain and time constant come out wrong, and executes in there are not seen.",
        "What the rudder did meanwhile is unknown: use the stretches on either side (FILE@A:B), or the order if it is logged.",
        at=np.concatenate([index[a : b + 1] for a, b in found]),
    )  # fmt: skip


def _since(t: np.ndarray, values: np.ndarray, a: int, b: int, rate: float) -> int:
    """From when on the rudder stood that leaps after sample `b`: on its way it was at least as long as the leap takes.

    Where it goes on moving after the leap it has just come so far; where it stands again it may have moved at any time before.
    """
    leap = float(values[b + 1] - values[b])
    on = np.diff(values[b + 1 : b + 4])
    if on.size < 2 or not np.all(on * np.sign(leap) > 0):
        return a
    return int(np.clip(np.searchsorted(t, t[b + 1] - abs(leap) / rate), a, b))


def _leaps(t: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, float]:
    """Steps from one sample to the next that are far beyond what the rudder covers on its ramps, and its rate there [rad/s]."""
    step = np.abs(np.diff(values))
    reach = float(np.ptp(np.quantile(values, [0.005, 0.995])))
    least = max(5 * robust.noise(values), 0.005 * reach)
    moving = step > least
    # On a ramp the next step is to the same side.
    ramp = moving[1:] & moving[:-1] & (np.sign(np.diff(values)[1:]) == np.sign(np.diff(values)[:-1]))
    if int(ramp.sum()) < _FEWEST or float(step[1:][ramp].sum()) < float(step.sum()) / 3:
        return np.zeros(len(step), dtype=bool), np.inf
    rate = float(np.quantile((step / np.diff(t))[1:][ramp], 0.9))
    return (step > _LEAP * rate * np.diff(t)) & (step > _SHARE * reach), rate


def _turns_back(p: WorkingCopy, a: int, b: int) -> bool:
    """Whether the ship turns with a rudder that stands, and then against it, as no constant rudder makes her turn."""
    delta, t = p["delta"], p.t
    reach = float(np.ptp(np.quantile(delta, [0.005, 0.995])))
    if abs(delta[a]) < _OVER * reach or not (p.has("r") or p.has("psi")):
        return False
    if p.blind("r" if p.has("r") else "psi")[a : b + 1].any():
        return False
    rate = p["r"] if p.has("r") else np.gradient(p["psi"], t)
    size = max(1, (b + 1 - a) // 8)
    smooth = np.convolve(rate, np.ones(size) / size, "same")
    usual = float(np.quantile(np.abs(rate), 0.9))
    if _sides(smooth, _BACK * usual) > _YAWS * _sides(delta, _OVER * reach) + _FEW:
        return False
    turned = np.sign(delta[a]) * robust.integral(t[a : b + 1], rate[a : b + 1])
    share = np.linspace(-1, 1, len(turned))
    yaw = float(np.std(turned - np.polynomial.Polynomial.fit(share, turned, _BENDS)(share)))
    if float((np.maximum.accumulate(turned) - turned).max()) < _YAW * yaw:
        return False
    # Means over eighths of the stretch: waves and noise are no turning back.
    edges = np.linspace(a, b + 1, 9).astype(int)
    means = np.sign(delta[a]) * np.array([float(rate[i:j].mean()) for i, j in pairwise(edges) if j > i])
    before = np.maximum.accumulate(means)
    return bool(np.any((means < -_BACK * usual) & (before > _BEFORE * usual)))


def _sides(values: np.ndarray, least: float) -> int:
    """How often values go from one side to the other, by more than some size."""
    over = np.sign(values[np.abs(values) > least])
    return int(np.count_nonzero(np.diff(over)))
