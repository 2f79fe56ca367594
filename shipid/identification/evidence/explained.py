"""Whether a model explains anything of how a ship moved: where it does not, no coefficient of its fit is determined."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief, moment, percent
from shipid.identification.validation.comparison import Comparison
from shipid.parameters.catalogue import in_wind
from shipid.trials.speed import astern_from

#: Error of a motion, in shares of its standard deviation, from which a prediction explains nothing: more than 60 % of the power is left.
NOTHING_EXPLAINED = 0.8
#: Why no coefficient of a fit is determined.
UNEXPLAINED = "the model explains nothing of how the ship moved in these trials."
COURSE_KEPT = "the course is kept in these trials: nothing but disturbances moves the rudder, and no method tells what it does from what they do."
#: A motion that changes by so many times the noise of its mean over L/U is one that a model has to explain.
_MOVES = 5.0
#: Kinds of the notices.
NOT_DETERMINED, MOSTLY_DISTURBED, ASTERN = "not-determined", "mostly-disturbances", "goes-astern"
MOTION_UNEXPLAINED, WIND_UNREAD = "motion-unexplained", "wind-unread"
#: A wind that is slower than this share of the ship's speed is hardly felt beside her own.
_FELT = 0.5
#: Motions that are looked at. A heading without a pattern is explained by a rudder bias, which makes a straight line of it.
_MOTIONS = ("r", "u", "v")


def least_unexplained(comparisons: Sequence[Comparison], unit_time: float) -> float | None:
    """Return the error of the motion that is explained best, in shares of its size; None where none was fitted.

    The rate of turn counts sample by sample and as its mean over L/U, in which waves and sensor noise average out. Where only the
    heading is recorded, its change over L/U stands for it.

    Parameters
    ----------
    comparisons : sequence of Comparison
        Trials beside what a model makes of them.
    unit_time : float
        L/U in s.
    """
    shares = [s for c in comparisons for s in _shares(c, unit_time)]
    return min(shares, default=None)


def nothing_explained(least: float | None) -> bool:
    """Return whether a model explains nothing.

    Parameters
    ----------
    least : float or None
        Error of the motion that is explained best, in shares of its size; None where none is known.
    """
    return least is not None and least >= NOTHING_EXPLAINED


def not_determined(who: str, least: float) -> Notice:
    """Return the notice that no coefficient is determined.

    Parameters
    ----------
    who : str
        Who explains nothing of what, as in "no candidate explains how the ship turned".
    least : float
        Error of the best, in shares of the motion.
    """
    return Notice(
        f"Not determined: {who} (the error of the best is {percent(least)} of the rate of turn itself). No coefficient is to be used: "
        "see what check finds in the record, or sail a zig-zag.",
        NOT_DETERMINED,
        serious=True,
    )


def unexplained_notices(fitted: Sequence[Comparison], unit_time: float, withheld: str | None) -> list[Notice]:
    """Return what has to be said where a run with the recorded rudder explains nothing, or the course is kept; else empty.

    Parameters
    ----------
    fitted : sequence of Comparison
        The fitted trials.
    unit_time : float
        L/U in s.
    withheld : str or None
        Why the coefficients are withheld, where they are.
    """
    if withheld == COURSE_KEPT:
        words = (
            f"Not determined: {COURSE_KEPT} Change the course a few times, by 10 degrees and more, or sail a zig-zag."
        )
        return [Notice(words, NOT_DETERMINED, serious=True)]
    least = least_unexplained(fitted, unit_time)
    if least is None or not nothing_explained(least):
        return unexplained_motions(fitted, unit_time)
    what = "the model explains nothing of how the ship turned in these trials"
    return [not_determined(what, least) if withheld else mostly_disturbed(least)]


def unexplained_motions(fitted: Sequence[Comparison], unit_time: float) -> list[Notice]:
    """Return what has to be said of each motion that a model misses by as much as the motion changes, where it explains another.

    Noise is no motion: the means over L/U count, and only where they change by more than noise from sample to sample does.

    Parameters
    ----------
    fitted : sequence of Comparison
        The fitted trials.
    unit_time : float
        L/U in s.
    """
    found = []
    for name in _MOTIONS:
        share = _share_of_all([c for c in fitted if name in c.rmse], name, unit_time)
        if share is not None and nothing_explained(share):
            found.append(
                Notice(
                    f"The model explains nothing of the {FIELDS[name].label.lower()} (its error is {percent(share)} of how that changes in "
                    "the fitted trials): something acts on the ship that the model does not know, such as wind, current or an order to "
                    "the engine. No coefficient is to be used as it is: take a model that knows it and a log that holds it, a window "
                    "without it, or leave the signal out (--signals).",
                    MOTION_UNEXPLAINED,
                    serious=True,
                )
            )
    return found


def _share_of_all(comparisons: Sequence[Comparison], name: str, unit_time: float) -> float | None:
    """Error over size of a motion in all trials together, means over L/U; None where it hardly changes beside its noise."""
    error = size = noise = count = 0.0
    for c in comparisons:
        there, t = np.isfinite(c.trial[name]), c.trial["t"]
        measured, predicted = c.trial[name][there], c.predicted[name][there]
        means = [_turned(t[there], series, "r", unit_time) / unit_time for series in (measured, predicted)]
        if means[0].size < 2:
            continue
        with np.errstate(over="ignore", invalid="ignore"):
            error += float(np.sum((means[1] - means[0]) ** 2))
        size += float(np.sum((means[0] - means[0].mean()) ** 2))
        averaged = max(1.0, unit_time / float(np.median(np.diff(t[there]))))
        noise += means[0].size * float(np.var(np.diff(measured))) / 2 / averaged
        count += means[0].size
    if not count or size <= _MOVES**2 * noise:
        return None
    return float(np.sqrt(error / size)) if np.isfinite(error) else float("inf")


def mostly_disturbed(least: float) -> Notice:
    """Return the notice that disturbances moved the ship more than her rudder did.

    Parameters
    ----------
    least : float
        Error of the run with the recorded rudder alone, in shares of the motion.
    """
    return Notice(
        f"Disturbances turned the ship more than her rudder did: a run with the recorded rudder alone misses {percent(least)} of the rate "
        "of turn. The coefficients are as sure as their intervals say, and a zig-zag would make them surer.",
        MOSTLY_DISTURBED,
    )


def astern_notices(model: Model, comparisons: Sequence[Comparison]) -> list[Notice]:
    """Return what has to be said of trials in which the ship goes astern, for a model that knows one speed ahead.

    Parameters
    ----------
    model : Model
        The model; one that states the forward speed itself may know better.
    comparisons : sequence of Comparison
        The trials.
    """
    if "u" in model.states:
        return []
    first = {
        c.trial.name: astern_from({n: c.trial[n] for n in ("t", "u") if n == "t" or c.trial.has(n)})
        for c in comparisons
    }
    return [
        Notice(
            f"{name}: the ship goes astern from {moment(t)} s on, and {model.name} knows one speed ahead: use the part before, FILE@0:{moment(t)}.",
            ASTERN,
            serious=True,
            trial=name,
        )
        for name, t in first.items()
        if t is not None
    ]


def unread_wind_notices(model: Model, comparisons: Sequence[Comparison], speed: float | None) -> list[Notice]:
    """Return what has to be said of trials whose log holds a wind that the model does not read, though one exists that does.

    Parameters
    ----------
    model : Model
        The model.
    comparisons : sequence of Comparison
        The fitted trials.
    speed : float or None
        Of the ship before the manoeuvres, m/s.
    """
    reader = in_wind(model)
    if reader is model:
        return []
    logged = {c.trial.name: c.trial["wind_speed"] for c in comparisons if c.trial.has("wind_speed", "wind_direction")}
    winds = {name: float(np.nanmedian(speeds)) for name, speeds in logged.items() if np.isfinite(speeds).any()}
    return [
        Notice(
            f"{name}: the log holds a wind of {brief(wind)} m/s, and {model.name} does not read it: what it did to the ship is taken for her own, "
            f"and no interval contains that. Take {reader.name}, or a trial in less wind.",
            WIND_UNREAD,
            trial=name,
        )
        for name, wind in winds.items()
        if wind > _FELT * (speed or 0.0)
    ]


def _shares(c: Comparison, unit_time: float) -> list[float]:
    """Error over size of each motion of one trial."""
    found = [_share(c.trial[n], c.predicted[n]) for n in _MOTIONS if n in c.rmse]
    turning = next((n for n in ("r", "psi") if n in c.rmse), None)
    if turning is not None:
        there, t = np.isfinite(c.trial[turning]), c.trial["t"]
        pair = (
            _turned(t[there], series[there], turning, unit_time) for series in (c.trial[turning], c.predicted[turning])
        )
        found.append(_share(*pair))
    return [s for s in found if s is not None]


def _turned(t: np.ndarray, values: np.ndarray, name: str, over: float) -> np.ndarray:
    """By how much the ship turned in each stretch of so many seconds, from each sample on."""
    if not t.size:
        return values
    with np.errstate(over="ignore", invalid="ignore"):
        if name == "r":
            values = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t) * (values[1:] + values[:-1]))])
        begins = t[t + over <= t[-1]]
        return np.asarray(np.interp(begins + over, t, values) - np.interp(begins, t, values))


def _share(measured: np.ndarray, predicted: np.ndarray) -> float | None:
    """Root-mean-square error over standard deviation; None for a motion that does not change."""
    there = np.isfinite(measured)
    size = float(np.std(measured[there])) if there.sum() > 1 else 0.0
    if size <= 0:
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        error = float(np.sqrt(np.mean((predicted - measured)[there] ** 2)))
    return error / size if np.isfinite(error) else float("inf")
