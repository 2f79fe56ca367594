"""What the manoeuvre of one trial is run with: its record, and the prediction and the draws of the unknowns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from shipid.generation.simulator import coefficient_vector, initial_state
from shipid.identification.identified import Identified
from shipid.identification.problem.ship_scale import scale_before
from shipid.identification.problem.trial_data import TrialData, prepare
from shipid.identification.validation.closed_loop import Swings, ZigzagSimulator, helmsman_of, zigzag_simulator
from shipid.identification.validation.comparison import Comparison
from shipid.trials.measuring.results.zigzag import ZigZag

#: Initial state, coefficients and input biases of one run.
Run = tuple[np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class Runs:
    """The runs of one trial.

    Attributes
    ----------
    data : TrialData
        Its record.
    point : tuple of ndarray
        What the prediction runs with: initial state, coefficients and input biases.
    drawn : list of tuple of ndarray
        The same for each draw.
    """

    data: TrialData
    point: Run
    drawn: list[Run]

    def __iter__(self) -> Iterator[Run]:
        return iter((self.point, *self.drawn))


def runs_of(identified: Identified, comparison: Comparison, drawn: Iterable[np.ndarray], index: int | None) -> Runs:
    """Return the runs of a fitted trial by its place in the problem, or of one that was not fitted.

    Parameters
    ----------
    identified : Identified
        What was identified.
    comparison : Comparison
        The trial beside its prediction.
    drawn : iterable of ndarray, shape (unknowns,)
        Unknowns drawn from the covariance.
    index : int or None
        The place of a fitted trial; None for one that was not fitted.
    """
    problem, q, model = identified.problem, identified.solution.q, identified.model
    trial, inputs, biases = comparison.trial, identified.model.inputs, comparison.biases
    if index is None:
        unit_time = scale_before(identified.ship, trial).unit_time
        data = prepare(model, trial, problem.signals, identified.ship.particular("speed", "m/s"), unit_time)
    else:
        data = problem.trials[index]
    start = {**data.start, **comparison.initial}

    def run(unknowns: np.ndarray) -> Run:
        """The same moved as far as a draw is from the estimate."""
        if index is not None:
            away = (unknowns - q)[problem.own(index)]
            moved = {n: start[n] + a for n, a in zip(problem.initial, away)}
        else:
            away = np.mean([(unknowns - q)[problem.own(i)] for i in range(len(problem.trials))], axis=0)
            moved = {}
        # The speed before the manoeuvre is each trial's own.
        shared = [n for n in problem.biases if index is not None or n != "cruise"]
        by = dict(zip(problem.biases, away[len(problem.initial) :]))
        bias = np.array([biases.get(n, 0.0) + (by[n] if n in shared else 0.0) for n in inputs])
        return initial_state(model, start | moved), coefficient_vector(model, problem.values(unknowns)), bias

    return Runs(data, run(q), [run(unknowns) for unknowns in drawn])


def simulator_of(identified: Identified, data: TrialData, measured: ZigZag) -> ZigzagSimulator | None:
    """Return the simulator of a zig-zag in closed loop, or None where its helmsman cannot be read.

    Parameters
    ----------
    identified : Identified
        What was identified.
    data : TrialData
        The record.
    measured : ZigZag
        The same, measured.
    """
    helmsman = helmsman_of(data.trial, measured)
    if helmsman is None:
        return None
    unit_time = scale_before(identified.ship, data.trial).unit_time
    return zigzag_simulator(identified.model, data.trial, data.inputs, helmsman, unit_time)


def swings_of(identified: Identified, comparison: Comparison) -> Swings | None:
    """Return the zig-zag of a trial that was not fitted in closed loop; None where it is no zig-zag.

    Parameters
    ----------
    identified : Identified
        What was identified.
    comparison : Comparison
        The trial beside its prediction.
    """
    zigzag = comparison.measures.zigzag
    if zigzag is None or not comparison.overshoots:
        return None
    runs = runs_of(identified, comparison, (), None)
    simulator = simulator_of(identified, runs.data, zigzag)
    return None if simulator is None else simulator(*runs.point)
