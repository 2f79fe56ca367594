"""What a record is that holds neither a zig-zag nor a turning circle: said beside the refusal to measure it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief, counted, moment
from shipid.trials.checks import STEADY_RUDDER
from shipid.trials.measuring.rudder.steering import Steering
from shipid.trials.measuring.track import speed_channel
from shipid.trials.signals import series
from shipid.trials.signals.channel import Channel
from shipid.trials.signals.series import smoothed
from shipid.trials.trial import Trial

_SLOW = 0.15
"""A ship that turns at less than this share of its fast turning is on a course."""
_LONG = 0.05
"""A course is kept for this share of the record at least."""
_APART = np.radians(4.0)
_KEPT = np.radians(0.7)
"""A rudder that is reversed nearer to the course than this keeps it."""
_SCATTER, _ODD = 0.6, 0.34
"""A reversal farther from the usual heading than this share of it is odd; a zig-zag has fewer odd ones than that share."""
_LOST = 0.25
"""Of her approach speed a ship keeps more than this in a zig-zag, however hard."""
_UNEVEN = 0.4
"""Of two reversals alone, the nearer to the course over the farther, at least."""


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
    said = (
        f"It is a record of courses kept and changed: {counted(len(kept) - 1, 'change')} of up to {angle(largest, 3)}"
    )
    # One change may be a turn that is broken off, with the rudder put over and back.
    return said + ("; the rudder follows the heading there (a closed loop)." if len(kept) > 2 else ".")


def steered_by_hand(headings: Sequence[float | None], others: int) -> str:
    """Return why reversals of the rudder are no zig-zag, in words: no one heading ordered them; empty where one did.

    Parameters
    ----------
    headings : sequence of float or None
        Heading at each reversal, from the initial course, positive to the side of the rudder before it [rad]; None where not known.
    others : int
        Stretches of the record in which the rudder is over as well, and that are no part of the zig-zag.
    """
    known = np.array([h for h in headings if h is not None], dtype=float)
    if not known.size:
        return ""
    usual = float(np.median(known))
    told = ", ".join(f"{np.degrees(h):.1f}" for h in known[:6]) + (", ..." if known.size > 6 else "")
    if usual < _KEPT:
        return f"the rudder is reversed at headings of {told} deg from the initial course to its side, and no heading ordered it"
    odd = float(np.mean(np.abs(known - usual) > _SCATTER * usual + _KEPT))
    uneven = known.size == 2 and float(known.min()) < _UNEVEN * float(known.max()) - _KEPT
    if odd > _ODD or uneven:
        return (
            f"the rudder is reversed at headings of {told} deg from the initial course to its side, at no one heading"
        )
    # Three reversals at one heading are no chance; before them the helm may have been steered by hand for long.
    if known.size < 3 and others > known.size:
        return f"the rudder is over {others} times more, and reversed at the same heading only {known.size} times"
    return ""


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
            return f"The propeller is {what} at {moment(when[int(np.argmax(lasting))])} s."
    return ""


def propeller_doubts(trial: Trial, start: float | None, end: float) -> list[Notice]:
    """Return a serious notice where the propeller is stopped or reversed in a zig-zag.

    Parameters
    ----------
    trial : Trial
        The trial.
    start, end : float or None
        From when to when [s]; from the beginning of the record where None.
    """
    said = propeller_words(trial, start, end)
    return [Notice(said.rstrip(".") + ": no zig-zag does that", "propeller", serious=True)] if said else []


def slowed_down(
    trial: Trial, wrong: Mapping[str, np.ndarray], approach: float | None, second: float, end: float, half: float
) -> list[Notice]:
    """Return a serious notice where the ship loses nearly all her way: a rudder alone does not brake her so far.

    Parameters
    ----------
    trial : Trial
        The trial.
    wrong : Mapping of str to ndarray of bool, shape (samples,)
        Samples that count as missing, by column.
    approach : float or None
        Speed at the first execute [m/s].
    second, end : float
        When the second execute is, and when the zig-zag ends [s].
    half : float
        Half the width over which speeds are averaged [s].
    """
    moving = speed_channel(trial, wrong)
    if moving is None or not end > second:
        return []
    before, last = (series.value_at(moving.t, moving.y, when, half, 1) for when in (second, end))
    before = before if approach is None else approach
    if before <= 0 or last > _LOST * before:
        return []
    words = f"the speed falls from {brief(before)} to {brief(last)} m/s: no rudder brakes a ship so far, the propeller is slowed or stopped"
    return [Notice(words, "propeller", serious=True)]
