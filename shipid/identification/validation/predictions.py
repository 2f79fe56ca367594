"""Predictions beside trials: those that were fitted, and those that were not.

For a trial that was not fitted only the initial state may come from its first seconds; parameters and rudder bias come
from the fitted trials. Reported apart: the same with rudder bias and initial state refitted on the whole record, which is no
prediction but shows what knowing them would give.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from shipid.generation.record import make_record
from shipid.identification.fit import Comparison, Fit
from shipid.identification.problem.output_error import Prior, Problem, make_problem
from shipid.identification.problem.prior import prior_of
from shipid.identification.problem.scale import unit_time_of
from shipid.identification.problem.trial_data import Sailed, prepare
from shipid.identification.search.least_squares import Box, minimise
from shipid.trials.errors import TrialError
from shipid.trials.fitness import check_regular
from shipid.trials.measuring.measure import measure
from shipid.trials.measuring.measures import ZigZag
from shipid.trials.measuring.zigzag import overshoots_of
from shipid.trials.trial import Trial

#: The first seconds of a trial, in ship lengths' time L/U: what an initial state may be taken from.
WARM_UP = 0.25
_EMPTY = Box(np.zeros(0), np.zeros(0), np.zeros(0))


def predictions(fit: Fit, trials: Sequence[Trial]) -> tuple[tuple[Comparison, ...], dict[str, Any]]:
    """Return trials that were not fitted beside their predictions, and where they came from (see `Fit.validate`).

    Parameters
    ----------
    fit : Fit
        The identified model.
    trials : sequence of Trial
        What it is to predict.
    """
    for trial in trials:
        check_regular(trial)
    records = {t.name: {**t.source.to_dict(), "samples": len(t)} for t in trials}
    return tuple(_predict(fit, t) for t in trials), records


def warm_up_samples(trial: Trial, unit_time: float) -> int:
    """Return how many samples make the first seconds: a quarter of L/U, at least ten samples."""
    return int(np.clip(np.ceil(WARM_UP * unit_time / trial.sampling), 10, len(trial)))


def _problem_of(fit: Fit, trial: Trial, biases: tuple[str, ...], offset: Mapping[str, float], first: int) -> Problem:
    """The problem of a trial whose parameters are known and only whose own unknowns are not."""
    known: Problem = fit._problem
    sailed = prepare(known.model, trial, known.signals, fit.ship.particular("speed", "m/s"), first)
    values = {**known.fixed, **dict(zip(known.estimated, fit._solution.q))}
    return make_problem(known.model, [sailed], known.signals, (), values, known.sigma, biases, offset)


def mean_biases(fit: Fit) -> dict[str, float]:
    """Return the mean biases of the fitted trials, SI, by input; the cruising speed is each trial's own."""
    names = [n for n in fit._problem.biases if n != "cruise"]
    return {n: float(np.mean([c.biases.get(n, 0.0) for c in fit.fitted])) for n in names}


def _predict(fit: Fit, trial: Trial) -> Comparison:
    biases, unit_time = fit._problem.biases, unit_time_of(fit.ship, [trial])
    count = warm_up_samples(trial, unit_time)
    ahead = _problem_of(fit, trial, (), mean_biases(fit), count)
    # What the first seconds do not show of the state stays near its first guess.
    belief = prior_of(ahead.model, ahead.initial, (), ahead.sailed[0], unit_time)
    head = replace(ahead, sailed=(ahead.sailed[0].head(count),), prior=belief)
    start = minimise(head, head.first_guess(np.zeros(0)), _EMPTY, most=50).q
    predicted = compare(ahead, start, 0)
    if "delta" not in biases:
        return predicted
    free = _problem_of(fit, trial, biases, {}, count)
    q0 = free.first_guess(np.zeros(0))
    q0[: len(ahead.initial)] = start[: len(ahead.initial)]
    again = compare(free, minimise(free, q0, _EMPTY, most=50).q, 0)
    warm = _warmed_up(free, q0, prior_of(free.model, free.initial, biases, free.sailed[0], unit_time))
    return replace(predicted, refitted=again.rmse, refitted_bias=again.bias, warm=warm)


def _warmed_up(free: Problem, q0: np.ndarray, prior: Prior) -> dict[str, float]:
    """Errors after the first reversal of the rudder, with bias and initial state from the record before it."""
    sailed = free.sailed[0]
    reversal = _first_reversal(sailed.trial)
    count = int(np.searchsorted(sailed.trial["t"], reversal)) if reversal is not None else 0
    if count < 10 or count > sailed.intervals.size - 10:
        return {}
    before = replace(free, sailed=(sailed.head(count),), prior=prior)
    q = minimise(before, q0, _EMPTY, most=50).q
    y, _ = free.run(q, 0)
    rest = slice(count, None)
    return {s: _rms(y[j, rest] - sailed.measured[j, rest]) for j, s in enumerate(free.signals)}


def _first_reversal(trial: Trial) -> float | None:
    measured = _zigzag(trial)
    return measured.executes[0] if measured is not None and measured.executes else None


def _x0(problem: Problem, q: np.ndarray, sailed: Sailed) -> np.ndarray:
    x0 = sailed.x0.copy()
    states = problem.record.system.states
    for name, value in zip(problem.initial, q):
        x0[states.index(name)] = value
    return x0


def compare(problem: Problem, q: np.ndarray, index: int) -> Comparison:
    """Return one trial of a problem beside its prediction.

    Parameters
    ----------
    problem : Problem
        The problem.
    q : ndarray, shape (unknowns,)
        Its unknowns.
    index : int
        Which trial.
    """
    sailed = problem.sailed[index]
    trial = sailed.trial
    own = q[problem.own(index)]
    predicted = _signals(problem, q, sailed, own)
    measured = dict(zip(problem.signals, sailed.measured))
    errors = {s: _rms(predicted[s] - m) for s, m in measured.items()}
    overshoots, foreseen = _overshoots(trial, predicted.get("psi"))
    return Comparison(
        trial,
        predicted,
        errors,
        biases=problem.named_biases(own),
        overshoots=overshoots,
        predicted_overshoots=foreseen,
        initial=dict(zip(problem.initial, own.tolist())),
    )


def _signals(problem: Problem, q: np.ndarray, sailed: Sailed, own: np.ndarray) -> dict[str, np.ndarray]:
    shown = tuple(n for n in ("psi", "r", "u", "v", "x", "y") if n in problem.model)
    shown = tuple(dict.fromkeys((*problem.signals, *shown)))
    record = make_record(problem.model, shown)
    values: Mapping[str, float] = {**problem.fixed, **dict(zip(problem.estimated, q))}
    x0 = _x0(problem, own, sailed)
    y, _ = record(
        x0,
        sailed.inputs,
        sailed.intervals,
        record.system.vector(record.system.coefficients, values),
        problem.bias_vector(own),
    )
    return dict(zip(shown, y))


def _rms(error: np.ndarray) -> float:
    with np.errstate(over="ignore", invalid="ignore"):
        value = float(np.sqrt(np.mean(error**2)))
    return value if np.isfinite(value) else float("inf")


def _overshoots(trial: Trial, psi: np.ndarray | None) -> tuple[tuple[float, ...], tuple[float | None, ...]]:
    """Overshoots measured, and of the predicted heading at the same executes; empty where it is no zig-zag."""
    if psi is None or not trial.has("psi") or not np.isfinite(psi).all():
        return (), ()
    measured = _zigzag(trial)
    if measured is None:
        return (), ()
    executes = tuple(e for e in measured.executes or () if e is not None)
    side = 1 if measured.first_side == "starboard" else -1
    kept = tuple(o for o in measured.overshoots or () if o is not None)
    return kept, overshoots_of(trial["t"], psi, executes, side=side)[: len(kept)]


def _zigzag(trial: Trial) -> ZigZag | None:
    """The trial measured as a zig-zag, or None where it is none."""
    try:
        measured = measure(trial, kind="zig-zag")
    except TrialError:
        return None
    assert isinstance(measured, ZigZag)
    return measured
