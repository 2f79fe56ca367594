"""What filling the inputs between their samples, and the mean of a noisy log, may have done to the outputs: errors behind the coefficients.

A rudder that sets out or stops between two samples is not on the straight line between them. How far inputs are off such lines
is seen where they do have samples: each is left out in turn and interpolated from its neighbours. Errors of that size are drawn
for the gaps, and the model is run with them. A model that takes the speed as given has it as one number, the mean before the manoeuvre: its
standard error is drawn as well.
"""

from __future__ import annotations

import numpy as np

from shipid.generation.ensemble import run_many
from shipid.generation.record import make_record
from shipid.generation.simulator import coefficient_vector, initial_state
from shipid.generation.system import generate
from shipid.identification.problem.output_error import Problem
from shipid.parameters.draws import normal_draws
from shipid.trials.filling import usual_interval

#: Draws: enough for a variance to be known to a fifth, a standard deviation to a tenth.
_DRAWS = 64


def effects_of(problem: Problem, q: np.ndarray, index: int) -> np.ndarray | None:
    """Return changes of the weighted residuals of one trial by errors of its filled inputs and of its one number for the speed.

    Parameters
    ----------
    problem : Problem
        The problem.
    q : ndarray, shape (unknowns,)
        Its unknowns.
    index : int
        Which trial.

    Returns
    -------
    ndarray, shape (draws, signals, N), or None
        None where every input is whole and sure and no row is missing, or the model runs away.
    """
    data, model = problem.trials[index], problem.model
    between = _between_rows(data.t)
    given_speed = "u" in model.inputs and "u" in generate(model).inputs_behind(problem.signals)
    unsure = data.cruise_std if given_speed else 0.0
    if data.sampled is None and not between.size and unsure <= 0:
        return None
    t = np.sort(np.concatenate([data.t, between]))
    rows = np.searchsorted(t, data.t)
    recorded = np.array([np.interp(t, data.t, row) for row in data.inputs])
    errors = np.zeros((_DRAWS, *recorded.shape))
    for k, values in enumerate(recorded):
        sampled = np.zeros(t.size, dtype=bool)
        sampled[rows] = True if data.sampled is None else data.sampled[k]
        if np.ptp(values) > 0 and _has_gaps(t[sampled]):
            errors[:, k] = errors_between(t, values, sampled, seed=k)
    if unsure > 0:
        errors[:, model.inputs.index("u")] += unsure * normal_draws(1, _DRAWS, len(recorded))
    if not errors.any():
        return None
    return _changes(problem, q, index, t, recorded, errors, rows)


def changes_by(problem: Problem, q: np.ndarray, index: int, errors: np.ndarray) -> np.ndarray | None:
    """Return changes of the weighted residuals of one trial by errors in the samples of its inputs.

    Parameters
    ----------
    problem : Problem
        The problem.
    q : ndarray, shape (unknowns,)
        Its unknowns.
    index : int
        Which trial.
    errors : ndarray, shape (errors, inputs, N)
        The errors.

    Returns
    -------
    ndarray, shape (errors, signals, N), or None
        None where the model runs away.
    """
    data = problem.trials[index]
    return _changes(problem, q, index, data.t, data.inputs, errors, np.arange(data.t.size))


def _changes(
    problem: Problem, q: np.ndarray, index: int, t: np.ndarray, inputs: np.ndarray, errors: np.ndarray, rows: np.ndarray
) -> np.ndarray | None:
    """Changes of the weighted residuals, at the rows of the trial, by errors of the inputs at some times."""
    data, model = problem.trials[index], problem.model
    record = make_record(model, problem.shown)
    x0 = initial_state(model, problem.start(q, index))
    p, bias = coefficient_vector(model, problem.values(q)), problem.bias_vector(q[problem.own(index)])
    # An error of another trial, or of an input that nothing shown depends on, changes nothing: it needs no run.
    read = [model.inputs.index(name) for name in generate(model).inputs_behind(problem.shown)]
    acting = np.flatnonzero(errors[:, read].any(axis=(1, 2)))
    # The first run is without errors.
    every = np.concatenate([inputs[None], inputs + errors[acting]])
    x0, p, bias = (np.broadcast_to(v, (len(every), v.size)) for v in (x0, p, bias))
    y = run_many(record, x0, every, np.diff(t, append=t[-1]), p, bias)[0][:, :, rows]
    if not np.isfinite(y).all():
        return None
    change = np.zeros((len(errors), *y.shape[1:]))
    change[acting] = np.where(data.there, (y[1:] - y[0]) / problem.sigma[:, None], 0.0)
    if problem.weights is not None:
        change = change * np.sqrt(problem.weights[index])
    return np.asarray(change)


def _has_gaps(own: np.ndarray) -> bool:
    """Whether samples of an input are missing: of one that is regular on a clock of its own none is, however slow it is."""
    steps = np.diff(own)
    return steps.size > 0 and bool(steps.max() > 1.5 * np.median(steps))


def _between_rows(t: np.ndarray) -> np.ndarray:
    """Times in the middle of the intervals in which rows are missing."""
    steps = np.diff(t)
    if not steps.size:
        return steps
    usual, median = usual_interval(t), float(np.median(steps))
    # Rows of several sensors come close to each other: the interval of one of them counts.
    long = steps > 1.5 * (usual if usual > 3 * median else median)
    return np.asarray((t[:-1] + 0.5 * steps)[long])


def errors_between(t: np.ndarray, values: np.ndarray, sampled: np.ndarray, seed: int = 0) -> np.ndarray:
    """Return draws of the error of an input between its samples, shape (draws, N).

    Parameters
    ----------
    t : ndarray, shape (N,)
        Times in s.
    values : ndarray, shape (N,)
        The input, interpolated between its samples.
    sampled : ndarray of bool, shape (N,)
        Where it has a sample.
    seed : int
        Of the draws.

    Returns
    -------
    ndarray, shape (draws, N)
        Zero at the samples. In a gap it rises to the middle and falls; gaps are independent.
    """
    gap, ends, shape = gap_errors(t, values, sampled)
    size = np.sqrt(0.5 * (ends**2).sum(axis=0))
    return (
        np.asarray(normal_draws(size.size, _DRAWS, seed)[:, gap] * size[gap] * shape)
        if size.size
        else np.zeros((_DRAWS, t.size))
    )


def gap_errors(t: np.ndarray, values: np.ndarray, sampled: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return how large the errors of an input are between its samples.

    Parameters
    ----------
    t, values, sampled
        See `errors_between`.

    Returns
    -------
    gap : ndarray of int, shape (N,)
        The interval between two samples in which each time lies.
    ends : ndarray, shape (2, intervals)
        Error in the middle of each interval by the bend of the input at its beginning and at its end; without intervals where three
        samples are not there.
    shape : ndarray, shape (N,)
        The error in shares of that: zero at the samples, one in the middle.
    """
    own = np.flatnonzero(sampled)
    if own.size < 3:
        return np.zeros(t.size, dtype=int), np.zeros((2, 0)), np.zeros(t.size)
    when, shown = t[own], values[own]
    # Each sample left out, against the line between its neighbours.
    span = when[2:] - when[:-2]
    share = (when[1:-1] - when[:-2]) / span
    missed = shown[1:-1] - (1 - share) * shown[:-2] - share * shown[2:]
    # A parabola through the same three points is this high above the line in the middle of a gap of unit length.
    bend = np.pad(missed / (4 * share * (1 - share)) / span, 1, mode="edge")
    length = np.diff(when)
    ends = length * np.array([bend[:-1], bend[1:]])
    gap = np.clip(np.searchsorted(own, np.arange(t.size), side="right") - 1, 0, length.size - 1)
    at = np.clip((t - when[gap]) / length[gap], 0.0, 1.0)
    return gap, ends, np.where(sampled, 0.0, 2 * np.minimum(at, 1 - at))
