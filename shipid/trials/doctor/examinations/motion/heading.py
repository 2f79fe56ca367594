"""The heading: wrapped, interpolated across 0/360, glitching, set to another value."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter

from shipid.declaration.vocabulary import angle
from shipid.foundation.numbers import counted, moment
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.motion.clock_scale import clock_factor
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.logs.conversion import GLITCH_WINDOW

_PERIODS = (2 * np.pi, 360.0, np.radians(2 * np.pi))
"""A full turn in a column read rightly, in degrees called radians, and in radians called degrees."""

_SMALL = np.radians(0.25)
"""Glitches below this are no matter of concern."""

_STEP, _AROUND = np.radians(1.0), 7
"""A heading that is set to a value nearer than this is none of concern; samples on either side that show that it stays."""


def examine_wrap(p: WorkingCopy) -> None:
    """Unwrap the heading in whatever unit it has.

    Parameters
    ----------
    p : WorkingCopy
        The record, in the units of its header.
    """
    if not p.has("psi") or len(p) < 3:
        return
    index = np.flatnonzero(np.isfinite(p["psi"]))
    psi = p["psi"][index]
    if len(psi) < 3:
        return
    d = np.diff(psi)
    for period in _PERIODS:
        jumps = np.flatnonzero(np.abs(np.abs(d) - period) < 0.12 * period)
        usual = float(np.quantile(np.abs(d), 0.9))
        # A wrap jumps by a full turn between two ordinary steps, inside one turn's range.
        if jumps.size and usual < 0.05 * period and float(np.ptp(psi)) < 1.05 * period:
            p.add(
                "heading-wrap", "psi", 0.99, f"the heading jumps by a full turn {counted(len(jumps), 'time')}",
                "None in shipid, which unwraps headings; without that, the ship seems to turn in a circle at each of them.",
                "Unwrap the heading.", at=index[jumps + 1], fix={"action": "unwrap"}, spoils=False,
            )  # fmt: skip
            p["psi"] = p["psi"].copy()
            p["psi"][index] = np.unwrap(psi, period=period)
            return


def examine_heading(p: WorkingCopy) -> None:
    """Find heading samples that disagree with the rate of turn, and bridge them by its integral.

    Parameters
    ----------
    p : WorkingCopy
        The record, the rate of turn in the heading's unit and sign.
    """
    if not p.has("psi", "r"):
        return
    index = p.own("psi")
    if len(index) < 30:
        return
    t, psi = p.t[index], p["psi"][index]
    turned = clock_factor(p) * robust.integral(p.t, p["r"])[index]
    unknown = p.blind("r")[index]
    rest = np.exp(1j * (psi - turned))
    size = max(7, round(GLITCH_WINDOW / max(p.interval("psi"), 1e-9))) | 1
    size = min(size, (len(psi) // 4) | 1)
    middle = np.angle(
        median_filter(rest.real, size, mode="mirror") + 1j * median_filter(rest.imag, size, mode="mirror")
    )
    off = np.angle(rest * np.exp(-1j * middle))
    grid, still = robust.resolution(psi)
    # What may pass: noise of compass and gyro, resolution, and the lag of one behind the other in a window.
    inertia = float(np.quantile(np.abs(np.gradient(p["r"], p.t)), 0.99)) * p.interval("r") * 2 * p.interval("r")
    usual = max(robust.spread(off), robust.noise(psi))
    near = 1.4826 * median_filter(np.abs(off), min(max(51, 4 * size | 1), (len(psi) // 2) | 1), mode="mirror")
    threshold = np.maximum(7 * np.maximum(usual, near), 2 * inertia + (2 * grid if still > 0.2 else 0.0))
    threshold = np.maximum(threshold, max(_SMALL, 2e-3 * float(np.ptp(turned))))
    bad = (np.abs(off) > threshold) & ~unknown
    if not bad.any() or bad.mean() > 0.3:
        return
    bad = _widened(bad, (np.abs(off) > 0.4 * threshold) & ~unknown)
    logged = p.record.values["psi"][p.rows[index]]
    across = np.zeros(len(psi), dtype=bool)
    for a, b in robust.runs(bad):
        before, after = logged[max(a - 1, 0)], logged[min(b, len(psi) - 1)]
        full = 2 * np.pi if abs(before - after) < 7 else 360.0
        if abs(abs(before - after) - full) < 0.25 * full:
            across[a:b] = True
    applied = False
    for kind, mask in (("heading-interpolated", across), ("heading-glitch", bad & ~across)):
        if mask.any():
            ratio = float(np.max(np.abs(off[mask]) / threshold[mask]))
            one, several = ("lies", "lie") if kind == "heading-interpolated" else ("disagrees", "disagree")
            verb = one if mask.sum() == 1 else several
            what = (
                "between 0 and 360 where the heading was interpolated across the wrap"
                if kind == "heading-interpolated" else "with the rate of turn"
            )  # fmt: skip
            applied |= p.add(
                kind, "psi", robust.confidence_of(ratio, 0.9, 1.8),
                f"{counted(int(mask.sum()), 'heading sample')} {verb} {what}, by up to {angle(float(np.abs(off[mask]).max()), 3)}",
                "No ship makes such jumps: residuals, noise levels and intervals become too large, and the fit follows the "
                "jumps.",
                "Replace them by the integral of r between good neighbours; in a format file: "
                "[repairs] heading_glitches = true.",
                at=index[mask], fix={"action": "mend-heading"},
            )  # fmt: skip
    if not applied:
        return
    good = ~bad
    slow = np.unwrap(np.angle(rest[good]))
    slow += psi[good][0] - turned[good][0] - slow[0]
    mended = p["psi"].copy()
    mended[index] = turned + np.interp(t, t[good], slow)
    p["psi"] = mended
    p.void("psi", np.zeros(len(p), dtype=bool))


def examine_heading_step(p: WorkingCopy) -> None:
    """Find where the heading is set to another value and goes on from there: a compass that slipped or was set, a second source.

    Parameters
    ----------
    p : WorkingCopy
        The record, the rate of turn in the heading's unit and sign, single wild headings mended.
    """
    if not p.has("psi") or p.found("resampled"):
        return
    index = p.own("psi")
    if len(index) < 60:
        return
    t, psi = p.t[index], p["psi"][index]
    sound = p.has("r") and not p.found("frozen")
    rest = psi - clock_factor(p) * robust.integral(p.t, p["r"])[index] if sound else psi
    step, usual = np.diff(rest), np.diff(t) < 1.5 * p.interval("psi")
    off = step - median_filter(step, 9, mode="mirror")
    grid, still = robust.resolution(psi)
    # A ship's rate of turn changes little within a sample; coarse digits step by themselves.
    limit = max(8 * robust.spread(off), 6 * robust.noise(rest), 4 * float(np.quantile(np.abs(off), 0.98)), _STEP)
    limit += 2 * grid if still > 0.2 else 0.0
    found = []
    for k in np.flatnonzero((np.abs(off) > limit) & usual):
        before, after = rest[max(k - _AROUND, 0) : k + 1], rest[k + 1 : k + 1 + _AROUND]
        if min(len(before), len(after)) < 4 or psi[k] == psi[k - 1]:
            continue
        # It stays: the motion on either side, continued to the step, lies that far apart.
        gap = _at_step(after, 1) - _at_step(before, -1)
        if abs(gap - off[k]) < 0.3 * abs(off[k]) and abs(gap) > 0.7 * limit:
            found.append(k)
    if not found or len(found) > max(3, 0.005 * len(psi)):
        return
    largest = max(found, key=lambda k: abs(off[k]))
    p.add(
        "heading-step", "psi", robust.confidence_of(float(np.abs(off[largest])) / limit, 0.9, 1.5),
        f"the heading is set to another value {len(found)} time{'s' * (len(found) > 1)}, by {angle(float(off[largest]), 3)} at "
        f"{moment(t[largest + 1])} s within a sample, and goes on from there",
        "Headings on either side cannot be compared: an overshoot or an advance across it is wrong by as much, and so are "
        "residuals.",
        "Use the stretches on either side (FILE@A:B), or another source of the heading.", at=index[np.array(found) + 1],
    )  # fmt: skip


def _at_step(values: np.ndarray, side: int) -> float:
    """The value at the step, half a sample before the first or behind the last, on a straight line through the samples of one side."""
    if side < 0:
        values = values[::-1]
    x = np.arange(len(values)) + 0.5
    slope = float(np.median(np.diff(values)))
    return float(np.median(values - slope * x))


def _widened(core: np.ndarray, skirt: np.ndarray) -> np.ndarray:
    """Return the runs of `skirt` that touch `core`."""
    label = np.cumsum(np.diff(skirt.astype(int), prepend=0) == 1) * skirt
    touched = np.unique(label[core & skirt])
    return core | (skirt & np.isin(label, touched))
