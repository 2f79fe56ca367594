"""Predictions beside trials: those that were fitted, and those that were not.

For a trial that was not fitted only the initial state may come from its first seconds; parameters and rudder bias come
from the fitted trials. Reported apart: the same with rudder bias and initial state refitted on the whole record, which is no
prediction: it shows the error that is left when both are known.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from shipid.declaration.vocabulary import FIELDS
from shipid.generation.departure import first_departure
from shipid.generation.record import make_record
from shipid.identification.identified import Identified
from shipid.identification.problem.box import EMPTY
from shipid.identification.problem.output_error import Problem, make_problem
from shipid.identification.problem.prior import Prior, prior_of
from shipid.identification.problem.ship_scale import scale_before
from shipid.identification.problem.signals import SHOWN
from shipid.identification.problem.trial_data import prepare, warm_up_samples, with_whole_inputs
from shipid.identification.search.least_squares import minimise
from shipid.identification.uncertainty.covariance import covariance_of
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.trial_measures import TrialMeasures, examined, measured_circle, measures_of
from shipid.parts.sensors import shown_by
from shipid.trials.filling import samples_of
from shipid.trials.measuring.results.turning_circle import TurningCircle
from shipid.trials.measuring.zigzags.swings import overshoots_of
from shipid.trials.stretches import is_note
from shipid.trials.trial import Trial

_NONE = np.zeros(0)


def fitted_comparisons(
    problem: Problem, q: np.ndarray, records: Sequence[Trial], length: float | None, covariance: np.ndarray
) -> tuple[Comparison, ...]:
    """Return the trials of a problem beside what the model makes of them.

    Parameters
    ----------
    problem : Problem
        The problem.
    q : ndarray, shape (unknowns,)
        Its unknowns.
    records : sequence of Trial
        The record of which each trial is a stretch, or which it is.
    length : float or None
        Length of the ship in m, where it is known.
    covariance : ndarray, shape (unknowns, unknowns)
        Of the unknowns.
    """
    said = {id(record): examined(record) for record in {id(r): r for r in records}.values()}
    measured = [measures_of(data.trial, said[id(r)], length) for data, r in zip(problem.trials, records, strict=True)]
    return tuple(
        replace(compare(problem, q, i, one, length), bias_std=_bias_std(problem, covariance, [i]))
        for i, one in enumerate(measured)
    )


def _bias_std(problem: Problem, covariance: np.ndarray, trials: Sequence[int]) -> float | None:
    """Standard deviation of the mean rudder bias of some trials in rad; None where it is not estimated, or not determined."""
    if "delta" not in problem.biases or covariance.shape[0] < problem.size:
        return None
    place = len(problem.initial) + problem.biases.index("delta")
    at = [problem.own(i).start + place for i in trials]
    variance = float(covariance[np.ix_(at, at)].mean())
    return float(np.sqrt(variance)) if 0 < variance < np.inf else None


def predictions(identified: Identified, trials: Sequence[Trial]) -> tuple[Comparison, ...]:
    """Return trials that were not fitted beside their predictions.

    Parameters
    ----------
    identified : Identified
        What was identified.
    trials : sequence of Trial
        What it is to predict.

    Raises
    ------
    NoStretchError
        If what drives the model has so many holes that no stretch of a trial is long enough.
    """
    signals, length = identified.problem.signals, identified.ship.particular("L", "m")
    found: list[Comparison] = []
    for trial in trials:
        unit_time = scale_before(identified.ship, trial).unit_time
        stretches = with_whole_inputs(identified.model, trial, signals, unit_time)
        said = examined(trial)
        found += [predict(identified, s, measures_of(s, said, length), trial) for s in stretches]
    return tuple(found)


def _problem_of(
    identified: Identified,
    trial: Trial,
    record: Trial | None,
    biases: tuple[str, ...],
    offset: Mapping[str, float],
    unit_time: float,
) -> Problem:
    """The problem of a trial whose parameters are known and only whose own unknowns are not."""
    known = identified.problem
    data = prepare(known.model, trial, known.signals, identified.ship.particular("speed", "m/s"), unit_time, record)
    return make_problem(known.model, [data], known.signals, (), identified.values, identified.noise, biases, offset)


def mean_biases(identified: Identified) -> dict[str, float]:
    """Return the mean biases of the fitted trials, SI, by input; the speed before the manoeuvre is each trial's own.

    Parameters
    ----------
    identified : Identified
        What was identified.
    """
    problem, q = identified.problem, identified.solution.q
    each = [problem.named_biases(q, i) for i in range(len(problem.trials))]
    return {n: float(np.mean([b.get(n, 0.0) for b in each])) for n in problem.biases if n != "cruise"}


def predict(identified: Identified, trial: Trial, measures: TrialMeasures, record: Trial | None = None) -> Comparison:
    """Return a trial, or a stretch of one, that was not fitted beside its prediction.

    Parameters
    ----------
    identified : Identified
        What was identified.
    trial : Trial
        The trial, its inputs whole.
    measures : TrialMeasures
        Its manoeuvre, measured.
    record : Trial, optional
        The trial of which it is a stretch.
    """
    biases, unit_time = identified.problem.biases, scale_before(identified.ship, trial).unit_time
    length, count = identified.ship.particular("L", "m"), warm_up_samples(trial, unit_time)
    mean = mean_biases(identified)
    ahead = _problem_of(identified, trial, record, (), mean, unit_time)
    # What the first seconds do not show of the state stays near its first guess.
    prior = prior_of(ahead.model, ahead.initial, (), ahead.trials[0], unit_time)
    head = replace(ahead, trials=(ahead.trials[0].beginning(count),), prior=prior)
    start = minimise(head, head.first_guess(_NONE), EMPTY, most=50).q
    fitted = identified.problem
    std = _bias_std(fitted, identified.covariance.matrix, range(len(fitted.trials)))
    predicted = replace(compare(ahead, start, 0, measures, length), bias_std=std)
    if "delta" not in biases:
        return predicted
    free = _problem_of(identified, trial, record, biases, {}, unit_time)
    q0 = free.first_guess(_NONE)
    q0[: len(ahead.initial)] = start[: len(ahead.initial)]
    found = minimise(free, q0, EMPTY, most=50)
    again = found.q
    # A bias of this trial as the fitted ones know it: about their mean, within their spread.
    prior = prior_of(free.model, free.initial, biases, free.trials[0], unit_time)
    spread = np.hypot((fitted.prior or prior).biases["delta"], prior.mean_biases["delta"] if std is None else std)
    prior = replace(prior, mean_biases={"delta": float(spread)})
    return replace(
        predicted,
        refitted=_errors(free, free.run(again, 0)[0]),
        refitted_bias=free.named_biases(again, 0).get("delta", 0.0),
        refitted_bias_std=_bias_std(free, covariance_of(found).matrix, [0]),
        warm=_warmed_up(replace(free, bias_offset=mean), q0, prior, measures),
    )


def _warmed_up(free: Problem, q0: np.ndarray, prior: Prior, measures: TrialMeasures) -> dict[str, float]:
    """Errors after the first reversal of the rudder, with bias and initial state from the record before it."""
    data, zigzag = free.trials[0], measures.zigzag
    reversal = zigzag.executes[0] if zigzag is not None and zigzag.executes else None
    count = int(np.searchsorted(data.trial["t"], reversal)) if reversal is not None else 0
    if count < 10 or count > data.intervals.size - 10:
        return {}
    before = replace(free, trials=(data.beginning(count),), prior=prior)
    q = minimise(before, q0, EMPTY, most=50).q
    return _errors(free, free.run(q, 0)[0], count)


def shown_outputs(problem: Problem) -> tuple[str, ...]:
    """Return the fitted signals, then the other signals and the track as far as the model has them.

    Parameters
    ----------
    problem : Problem
        The problem.
    """
    return tuple(dict.fromkeys((*problem.signals, *(n for n in SHOWN if n in problem.model))))


def compare(problem: Problem, q: np.ndarray, index: int, measures: TrialMeasures, length: float | None) -> Comparison:
    """Return one trial of a problem beside its prediction.

    Parameters
    ----------
    problem : Problem
        The problem.
    q : ndarray, shape (unknowns,)
        Its unknowns.
    index : int
        Which trial.
    measures : TrialMeasures
        The manoeuvre of the trial, measured.
    length : float or None
        Length of the ship in m, where it is known.

    Returns
    -------
    Comparison
    """
    trial = problem.trials[index].trial
    shown = shown_outputs(problem)
    y, _, margins = problem.guarded_run(
        q, index, make_record(problem.model, shown_by(problem.model, shown), guarded=True)
    )
    predicted = dict(zip(shown, y))
    overshoots, foreseen = _overshoots(trial, measures, predicted.get("psi"))
    left = first_departure(problem.model, trial["t"], margins)
    if left is not None:
        foreseen = (None,) * len(foreseen)
    return Comparison(
        trial,
        predicted,
        _errors(problem, y[: len(problem.signals)], index=index),
        measures,
        biases=problem.named_biases(q, index),
        overshoots=overshoots,
        predicted_overshoots=foreseen,
        predicted_circle=None if left is not None else _predicted_circle(trial, measures, predicted, length),
        initial=dict(zip(problem.initial, q[problem.own(index)].tolist())),
        samples={s: samples_of(trial["t"], trial[s]) for s in problem.signals},
        notes=tuple(n for n in trial.source.notes if is_note(n)),
        departure=left,
    )


def _errors(problem: Problem, y: np.ndarray, first: int = 0, index: int = 0) -> dict[str, float]:
    """Root-mean-square errors of the fitted signals from a row on, SI; infinite where the model runs away."""
    with np.errstate(over="ignore", invalid="ignore"):
        data = problem.trials[index]
        there = data.there[:, first:]
        squares = np.where(there, (y - data.measured)[:, first:] ** 2, 0.0)
        errors = np.sqrt(squares.sum(axis=1) / np.maximum(there.sum(axis=1), 1))
    return {
        s: float(e) if np.isfinite(e) else float("inf") for s, e, t in zip(problem.signals, errors, there) if t.any()
    }


def _overshoots(
    trial: Trial, measures: TrialMeasures, psi: np.ndarray | None
) -> tuple[tuple[float, ...], tuple[float | None, ...]]:
    """Overshoots measured, and of the predicted heading at the same executes; empty where it is no zig-zag."""
    zigzag = measures.zigzag
    if zigzag is None or psi is None or not np.isfinite(psi).all():
        return (), ()
    side = 1 if zigzag.first_side == "starboard" else -1
    kept = zigzag.leading_overshoots
    return kept, overshoots_of(trial["t"], psi, zigzag.leading_executes, side=side)[: len(kept)]


def _predicted_circle(
    trial: Trial, measures: TrialMeasures, predicted: Mapping[str, np.ndarray], length: float | None
) -> TurningCircle | None:
    if measures.circle is None or not all(np.isfinite(row).all() for row in predicted.values()):
        return None
    kept = {n: trial[n] for n in ("t", "delta", "delta_order") if trial.has(n)}
    table = pd.DataFrame({**kept, **{n: row for n, row in predicted.items() if n in FIELDS}})
    return measured_circle(Trial(trial.name, table), f"{length!r} m" if length else None)
