"""Trackers of another ship that several studies share, and the measures by which the papers compare them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid import InteractingMultipleModel, Mode
from shipid.models import constant_velocity, turning_at_unknown_rate

Numbers = np.ndarray
DEG = np.pi / 180


def own_tracker(measured: dict[str, str]) -> InteractingMultipleModel:
    """Return our tracker: a course kept for long, a straight course for now, and turns to both sides at an unknown rate.

    A turn begins at 4.5 ± 1.5 deg/s. The first mode is left once in 1000 s, and taken up again once in 300 s, so that a long straight
    course is averaged over its whole length; the second one recovers from turns.
    """

    def shaken(level: float) -> dict[str, str]:
        return dict.fromkeys(("ax", "ay"), f"{level} m/s^2*s^0.5")

    turn = Mode(turning_at_unknown_rate, noise=shaken(0.3) | {"omega": "0.3 deg/s/s^0.5"})
    modes = {
        "keeping": Mode(constant_velocity, noise=shaken(0.001)),
        "straight": Mode(constant_velocity, noise=shaken(0.3)),
        "port": turn,
        "starboard": turn,
    }
    leave, resume, begin, end = 1 / 1000, 1 / 300, 1 / 30, 1 / 60
    transition = [
        [1 - leave, leave / 2, leave / 4, leave / 4],
        [resume, 1 - resume - begin, begin / 2, begin / 2],
        [0, end, 1 - end, 0],
        [0, end, 0, 1 - end],
    ]
    sides = {"port": "-4.5 deg/s", "starboard": "4.5 deg/s"}
    maps = {(s, t): {"omega": (sides[t], "1.5 deg/s")} for s in ("keeping", "straight") for t in sides}
    return InteractingMultipleModel(
        modes,
        transition,
        measured=measured,
        per="1 s",
        maps=maps,
        probabilities=[0.97, 0.01, 0.01, 0.01],
        correlated=True,
        model_noise=False,
    )


def rms(errors: Numbers) -> Numbers:
    """Return the root mean square over the runs (the first axis)."""
    return np.asarray(np.sqrt((errors**2).mean(axis=0)))


def nees(errors: Numbers, covariance: Numbers) -> Numbers:
    """Return the squared errors in terms of their covariance, shape (runs, samples)."""
    return np.asarray((errors * np.linalg.solve(covariance, errors[..., None])[..., 0]).sum(axis=-1))


def mean_and_spread(rows: Sequence[dict[str, float]]) -> dict[str, tuple[float, float]]:
    """Return mean and standard deviation of each number over several batches."""
    spread = {n: np.array([r[n] for r in rows]) for n in rows[0]}
    return {
        n: (float(v.mean()), float(v.std(ddof=1)) if v.size > 1 and np.isfinite(v).all() else 0.0)
        for n, v in spread.items()
    }
