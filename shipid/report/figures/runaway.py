"""Whether a prediction runs away, and where its curves end."""

from __future__ import annotations

import numpy as np

from shipid.identification.validation.comparison import Comparison
from shipid.trials.trial import Trial

#: A prediction this many spans of the measured signal away from it has run away.
_FAR = 10.0


def good_samples(comparison: Comparison) -> int:
    """Return how many samples the prediction stays finite and within ten spans of the record.

    Parameters
    ----------
    comparison : Comparison
        The trial and its prediction.
    """
    trial, lost = comparison.trial, np.zeros(len(comparison.trial), dtype=bool)
    for name, values in comparison.predicted.items():
        lost |= ~np.isfinite(values)
        if not trial.has(name):
            continue
        with np.errstate(invalid="ignore", over="ignore"):
            lost |= np.abs(values - trial[name]) > _FAR * _span(trial, name)
    return int(np.argmax(lost)) if lost.any() else len(lost)


def runaway(comparison: Comparison) -> float | None:
    """Return the time in s at which a prediction runs away, or None.

    Parameters
    ----------
    comparison : Comparison
        The trial and its prediction.
    """
    count = good_samples(comparison)
    return float(comparison.trial["t"][count]) if count < len(comparison.trial) else None


def _span(trial: Trial, name: str) -> float:
    span = _reach(trial, name)
    if name == "psi":
        return max(span, np.pi)
    if name in ("u", "v", "U"):
        speeds = [float(np.nanmax(np.abs(trial[n]), initial=0.0)) for n in ("u", "U", "v") if trial.has(n)]
        return max(span, *speeds)
    if name in ("x", "y") and trial.has("x", "y"):
        return max(_reach(trial, "x"), _reach(trial, "y"))
    return span


def _reach(trial: Trial, name: str) -> float:
    """From the lowest to the highest sample that is there; zero where there is none."""
    there = trial[name][np.isfinite(trial[name])]
    return float(np.ptp(there)) if there.size else 0.0
