"""What a record is that holds neither a zig-zag nor a turning circle: said beside the refusal to measure it."""

from __future__ import annotations

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.trials.checks import STEADY_RUDDER
from shipid.trials.measuring.rudder.steering import Steering
from shipid.trials.signals.channel import Channel
from shipid.trials.signals.series import smoothed
from shipid.trials.trial import Trial

_SLOW = 0.15
"""A ship that turns at less than this share of its fast turning is on a course."""
_LONG = 0.05
"""A course is kept for this share of the record at least."""
_APART = np.radians(4.0)


def instead_of_manoeuvre(trial: Trial, steering: Steering, psi: Channel) -> str:
    """Return one or two sentences that say what the record shows.

    Parameters
    ----------
    trial : Trial
        The trial.
    steering : Steering
        The record of the rudder.
    psi : Channel
        The heading.
    """
    rudder = steering.channel.y
    if rudder.size == 0 or psi.y.size < 3 or float(np.ptp(rudder)) <= STEADY_RUDDER:
        return "The rudder stays where it is: nothing is steered in it."
    said = [words for words in (_courses(psi), propeller_words(trial)) if words]
    if not said:
        size = float(np.quantile(np.abs(rudder), 0.98))
        said = [f"The rudder goes up to {angle(size, 2)} at no regular headings."]
    return " ".join(said)


def _courses(psi: Channel) -> str:
    """Name a record of courses kept and changed, if it is one."""
    t, y = psi.t, psi.y
    rate = np.abs(smoothed(t, np.gradient(y, t), 0.01 * float(t[-1] - t[0])))
    slow = np.concatenate(([False], rate < _SLOW * float(np.quantile(rate, 0.98)), [False]))
    edges = np.flatnonzero(np.diff(slow))
    kept: list[float] = []
    share = 0.0
    for first, last in zip(edges[0::2], edges[1::2] - 1):
        if t[last] - t[first] < _LONG * (t[-1] - t[0]):
            continue
        share += float((t[last] - t[first]) / (t[-1] - t[0]))
        course = float(np.median(y[first : last + 1]))
        if not kept or abs(course - kept[-1]) > _APART:
            kept.append(course)
    if share < 0.3 or not kept:
        return ""
    if len(kept) == 1:
        return f"It is a record of course keeping about {angle(kept[0] % (2 * np.pi), 3)}."
    largest = float(np.abs(np.diff(kept)).max())
    return (
        f"It is a record of courses kept and changed: {len(kept) - 1} changes of up to {angle(largest, 2)}; the rudder "
        "follows the heading there (a closed loop)."
    )


def propeller_words(trial: Trial, start: float | None = None, end: float | None = None) -> str:
    """Return a sentence where the propeller is stopped or reversed: no standard manoeuvre does that.

    Parameters
    ----------
    trial : Trial
        The trial.
    start, end : float, optional
        From when to when [s]; the whole record by default.
    """
    if not trial.has("n"):
        return ""
    t, n = trial["t"], trial["n"]
    inside = np.isfinite(n) & (t >= (t[0] if start is None else start)) & (t <= (t[-1] if end is None else end))
    if inside.sum() < 5:
        return ""
    when, turns = t[inside], n[inside]
    usual = float(np.quantile(np.abs(turns), 0.9))
    running = np.flatnonzero(np.abs(turns) > 0.5 * usual)
    if usual <= 0 or not running.size:
        return ""
    # From where it runs: a ship may start from rest.
    when, turns = when[running[0] :], turns[running[0] :]
    sense = float(np.sign(turns[0])) * turns / usual
    for what, low in (("reversed", sense < -0.2), ("stopped", sense < 0.05)):
        # For three samples in a row, so that a single wild one does not count.
        lasting = low[:-2] & low[1:-1] & low[2:]
        if lasting.any():
            return f"The propeller is {what} at {when[int(np.argmax(lasting))]:.4g} s."
    return ""
