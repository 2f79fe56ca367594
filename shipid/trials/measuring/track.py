"""Track and speed of a trial: from positions where they are recorded, else from speeds and heading."""

from __future__ import annotations

import numpy as np
from scipy.integrate import cumulative_trapezoid

from shipid.trials.trial import Trial


def speed(trial: Trial) -> np.ndarray | None:
    """Return the speed over all [m/s], shape (n,), or None where the trial has no speed.

    Parameters
    ----------
    trial : Trial
        With ``u`` and ``v``, ``U``, or ``u`` alone.
    """
    if trial.has("u", "v"):
        return np.asarray(np.hypot(trial["u"], trial["v"]))
    if trial.has("U"):
        return trial["U"]
    return np.abs(trial["u"]) if trial.has("u") else None


def drift(trial: Trial) -> np.ndarray | None:
    """Return the drift angle [rad], shape (n,), positive when the flow comes from port, or None.

    Parameters
    ----------
    trial : Trial
        With ``beta``, or ``u`` and ``v``.
    """
    if trial.has("beta"):
        return trial["beta"]
    return np.arctan2(-trial["v"], trial["u"]) if trial.has("u", "v") else None


def track(trial: Trial) -> tuple[np.ndarray, np.ndarray, str] | None:
    """Return north and east [m], shape (n,), and where they come from; None where nothing gives them.

    Parameters
    ----------
    trial : Trial
        With ``x`` and ``y``; or ``psi`` and a speed, with drift where it is known.
    """
    if trial.has("x", "y"):
        return trial["x"], trial["y"], "positions"
    moving = speed(trial)
    if moving is None or not trial.has("psi"):
        return None
    sideways = drift(trial)
    along = trial["psi"] - (0.0 if sideways is None else sideways)
    t = trial["t"]
    north = cumulative_trapezoid(moving * np.cos(along), t, initial=0.0)
    east = cumulative_trapezoid(moving * np.sin(along), t, initial=0.0)
    return north, east, "speeds and heading" if sideways is not None else "speed and heading, without drift"
