"""Positions on another clock than speeds and heading: the track is late or early, which in a turn is a shift across it."""

from __future__ import annotations

import numpy as np

from shipid.foundation.numbers import brief
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.motion.way import way_made_good
from shipid.trials.doctor.working_copy import WorkingCopy

#: What hides a delay, or is hidden by one.
_HIDE = ("clock-scale", "speed-stands", "track-direction", "position-jump", "unit", "sway-sign")
#: Delays below this are those of any receiver [s]; beyond this share of the record they are none.
_LEAST, _MOST = 1.0, 0.1
_ROUNDS = 6


def examine_late_positions(p: WorkingCopy) -> None:
    """Find positions that are late or early beside the track by speeds and heading.

    Parameters
    ----------
    p : WorkingCopy
        The record, its speeds in order. Without a sway a delay looks like the drift angle of a turn, and nothing is said.
    """
    if not p.has("x", "y", "u", "v", "psi") or len(p) < 60 or any(p.found(kind) for kind in _HIDE):
        return
    if np.ptp(p["v"]) == 0:  # a sway that nobody measured
        return
    way = way_made_good(p, "psi", "u", "v")
    if way is None or float(np.ptp(p["psi"])) < np.radians(60):
        return
    velocity = (p["u"] + 1j * p["v"]) * np.exp(1j * p["psi"])
    delay, found = 0.0, None
    for _ in range(_ROUNDS):
        shifted = np.interp(p.t - delay, p.t, velocity)
        sailed, bent = way.integral(p.t, shifted), np.diff(shifted[way.at])[way.kept]
        zero = np.zeros_like(way.dt)
        real = [-bent.real, sailed.real, -sailed.imag, way.dt, zero]
        across = [-bent.imag, sailed.imag, sailed.real, zero, way.dt]
        design = np.column_stack([np.concatenate(pair) for pair in zip(real, across)])
        found = robust.regress(design, np.concatenate([way.made.real, way.made.imag]))
        if found is None or abs(delay + found.value[0]) > _MOST * float(np.ptp(p.t)):
            return
        delay += float(found.value[0])
    assert found is not None
    limit = max(6 * float(found.std[0]), _LEAST, p.sampling)
    late, side = ("late", "astern") if delay > 0 else ("early", "ahead")
    apart = abs(delay) * float(np.median(np.hypot(p["u"], p["v"])))
    p.add(
        "latency", "x,y", robust.confidence_of(abs(delay) / limit, 1, 1.6),
        f"the positions are {brief(abs(delay), 2)} s {late} beside the track by speeds and heading, or those of an aerial some {brief(apart, 2)} m {side} of "
        "where u and v hold",
        "In a turn such a track is shifted: advance, transfer and every drift angle from positions come out wrong.",
        "Put the positions on the clock and the place of the speeds, or leave them out: speeds and heading give the track.",
    )  # fmt: skip
