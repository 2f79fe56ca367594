"""The output-error problem: trials, a model and the unknowns, as one vector of residuals with its exact Jacobian.

Unknowns are the estimated parameters, shared by all trials, and for each trial its initial states and the constant biases
of the rudder (and of the speed before the manoeuvre, where the model reads it):
``q = [parameters, trial 1, trial 2, ...]``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from shipid.declaration.model import Model
from shipid.generation.record import Record, make_record
from shipid.generation.simulator import coefficient_vector, initial_state
from shipid.generation.system import generate
from shipid.identification.problem.prior import Prior
from shipid.identification.problem.trial_data import TrialData
from shipid.parts.sensors import shown_by

#: Weighted residual of a sample at which the model has run away.
RUNAWAY = 1e6
#: How much wider the prior of the speed before the manoeuvre, and of a state that is not measured, is where a trial begins in the
#: middle of a manoeuvre.
_UNSETTLED = 20.0
#: Slope beyond which squares would overflow.
_STEEP = 1e30


@dataclass(frozen=True, eq=False)
class Problem:
    """Residuals and Jacobian of trials under a model.

    Attributes
    ----------
    model : Model
        The model.
    trials : tuple of TrialData
        The trials.
    signals : tuple of str
        Fitted signals.
    estimated : tuple of str
        Parameters shared by all trials; may be empty.
    initial, biases : tuple of str
        States and inputs with an unknown of their own in each trial.
    fixed : mapping of str to float
        Values of all other coefficients.
    sigma : ndarray, shape (signals,)
        Standard deviation by which each signal is weighted.
    bias_offset : mapping of str to float
        Biases that are known beforehand, by input.
    prior : Prior or None
        Prior of biases and initial states; None where they are free.
    loss : str
        How residuals count (`shipid.identification.problem.losses`).
    weights : tuple of ndarray or None
        Weight of each squared residual under a robust loss, by trial, shapes (signals, N).
    """

    model: Model
    trials: tuple[TrialData, ...]
    signals: tuple[str, ...]
    estimated: tuple[str, ...]
    initial: tuple[str, ...]
    biases: tuple[str, ...]
    fixed: Mapping[str, float]
    sigma: np.ndarray
    bias_offset: Mapping[str, float]
    prior: Prior | None = None
    loss: str = "linear"
    weights: tuple[np.ndarray, ...] | None = None

    @property
    def record(self) -> Record:
        """The generated record function."""
        return make_record(self.model, self.shown, self.estimated, self.initial, self.biases)

    @property
    def shown(self) -> tuple[str, ...]:
        """What the log shows of the fitted signals (`shown_by`)."""
        return shown_by(self.model, self.signals)

    @property
    def per_trial(self) -> int:
        """Number of unknowns each trial has of its own."""
        return len(self.initial) + len(self.biases)

    @property
    def missing(self) -> int:
        """Number of samples that are missing: residuals that do not count."""
        return sum(int(np.count_nonzero(~data.there)) for data in self.trials)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.estimated) + len(self.trials) * self.per_trial

    def own(self, index: int) -> slice:
        """Return where the unknowns of one trial stand in q.

        Parameters
        ----------
        index : int
            Which trial.
        """
        begin = len(self.estimated) + index * self.per_trial
        return slice(begin, begin + self.per_trial)

    def first_guess(self, parameters: np.ndarray) -> np.ndarray:
        """Return q with these parameters, initial states as measured, and no further bias.

        Parameters
        ----------
        parameters : ndarray, shape (parameters,)
            Values, SI.
        """
        own = [[*(t.start[n] for n in self.initial), *(0.0 for _ in self.biases)] for t in self.trials]
        return np.concatenate([parameters, *own])

    def values(self, q: np.ndarray) -> dict[str, float]:
        """Return the values of all coefficients, SI, by name.

        Parameters
        ----------
        q : ndarray, shape (unknowns,)
            The unknowns; those of the trials are not used.
        """
        return {**self.fixed, **dict(zip(self.estimated, q.tolist()))}

    def start(self, q: np.ndarray, index: int) -> dict[str, float]:
        """Return the initial states of one trial, SI, by name.

        Parameters
        ----------
        q : ndarray, shape (unknowns,)
            The unknowns.
        index : int
            Which trial.
        """
        return {**self.trials[index].start, **dict(zip(self.initial, q[self.own(index)].tolist()))}

    def named_biases(self, q: np.ndarray, index: int) -> dict[str, float]:
        """Return the biases of one trial that are not zero, SI, by input; those known beforehand are included.

        Parameters
        ----------
        q : ndarray, shape (unknowns,)
            The unknowns.
        index : int
            Which trial.
        """
        bias = self.bias_vector(q[self.own(index)])
        return {n: float(b) for n, b in zip(self.model.inputs, bias) if b}

    def bias_vector(self, own: np.ndarray) -> np.ndarray:
        """Return the bias of every input, SI, shape (inputs,).

        Parameters
        ----------
        own : ndarray, shape (unknowns of a trial,)
            One trial's own unknowns.
        """
        inputs = self.model.inputs
        bias = np.array([self.bias_offset.get(n, 0.0) for n in inputs])
        for name, value in zip(self.biases, own[len(self.initial) :]):
            bias[inputs.index(name)] += value
        return bias

    def run(self, q: np.ndarray, index: int, record: Record | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Run one trial.

        Parameters
        ----------
        q : ndarray, shape (unknowns,)
            The unknowns.
        index : int
            Which trial.
        record : Record, optional
            A record function of the same model with other outputs; that of the fitted signals by default.

        Returns
        -------
        y : ndarray, shape (signals, N)
            Outputs.
        dy : ndarray, shape (signals, unknowns of the record, N)
            Their derivatives.
        """
        y, dy, _ = self.guarded_run(q, index, record or self.record)
        return y, dy

    def guarded_run(
        self, q: np.ndarray, index: int, record: Record
    ) -> tuple[np.ndarray, np.ndarray, Mapping[str, np.ndarray]]:
        """Run one trial, and return the margins of the guards of a record that computes them as well.

        Parameters
        ----------
        q, index, record
            See `run`.

        Returns
        -------
        y, dy : ndarray
            See `run`.
        margins : mapping of str to ndarray, shape (N,)
            By guard; negative where the model is not valid.
        """
        data = self.trials[index]
        y, dy, margins = record.run(
            initial_state(self.model, self.start(q, index)),
            data.inputs,
            data.intervals,
            coefficient_vector(self.model, self.values(q)),
            self.bias_vector(q[self.own(index)]),
        )
        return y, dy, dict(zip(record.guards, margins))

    def residuals(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return weighted residuals, shape (M,), and their Jacobian, shape (M, unknowns).

        Where the model runs away the residual is a large constant with no slope: the search steps back. Where a sample is
        missing both are zero.

        Parameters
        ----------
        q : ndarray, shape (unknowns,)
            The unknowns.
        """
        rows, blocks = [], []
        for residual, slope, columns in self.blocks(q):
            block = np.zeros((residual.size, self.size))
            block[:, columns] = slope
            rows.append(residual)
            blocks.append(block)
        return np.concatenate(rows), np.concatenate(blocks)

    def blocks(self, q: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Yield the weighted residuals of each trial, their Jacobian, and the unknowns it is by; those of the prior last.

        A trial depends on the parameters and on its own unknowns alone.

        Parameters
        ----------
        q : ndarray, shape (unknowns,)
            The unknowns.
        """
        shared = np.arange(len(self.estimated))
        for i, data in enumerate(self.trials):
            y, dy = self.run(q, i)
            with np.errstate(over="ignore", invalid="ignore"):
                residual = (y - data.measured) / self.sigma[:, None]
                slope = dy / self.sigma[:, None, None]
                if self.weights is not None:
                    root = np.sqrt(self.weights[i])
                    residual, slope = residual * root, slope * root[:, None, :]
                # NaN compares as false, so values that are not finite are excluded as well.
                good = (np.abs(residual) < RUNAWAY) & (np.abs(slope) < _STEEP).all(axis=1)
            # A sample that is missing has no residual.
            residual = np.where(data.there, np.where(good, residual, RUNAWAY), 0.0)
            slope = np.where((good & data.there)[:, None, :], slope, 0.0)
            flat = slope.transpose(0, 2, 1).reshape(-1, slope.shape[1])
            own = self.own(i)
            yield residual.ravel(), flat, np.concatenate([shared, np.arange(own.start, own.stop)])
        if self.prior is not None:
            yield *self.prior_residuals(q, self.prior), np.arange(self.size)

    def prior_residuals(self, q: np.ndarray, prior: Prior) -> tuple[np.ndarray, np.ndarray]:
        """Return residuals of the prior and their Jacobian: biases about their mean, that about zero, initial states.

        Parameters
        ----------
        q : ndarray, shape (unknowns,)
            The unknowns.
        prior : Prior
            The prior.

        Returns
        -------
        residual : ndarray, shape (terms,)
            Distance from the mean in standard deviations, times the root of the strength.
        slope : ndarray, shape (terms, unknowns)
            Its Jacobian.
        """
        count = len(self.trials)
        slopes, offsets = [], []
        # Sensor noise is not correlated: its part of the variance of a first guess counts sample by sample.
        noise = np.sqrt(prior.strength)

        def add(weights: Mapping[int, float], target: float, deviation: float) -> None:
            row = np.zeros(self.size)
            for column, weight in weights.items():
                row[column] = weight / deviation
            slopes.append(row)
            offsets.append(target / deviation)

        for k, name in enumerate(self.biases, start=len(self.initial)):
            columns = [self.own(i).start + k for i in range(count)]
            if name in prior.mean_biases:
                add(dict.fromkeys(columns, 1 / count), 0.0, prior.mean_biases[name])
            if name in prior.biases and count > 1:
                for i in columns:
                    add({c: float(c == i) - 1 / count for c in columns}, 0.0, prior.biases[name])
            if name in prior.own:
                for c, data in zip(columns, self.trials):
                    deviation = prior.own[name] * (1.0 if data.approached else _UNSETTLED)
                    add({c: 1.0}, 0.0, np.hypot(deviation, noise * data.cruise_std))
        for k, name in enumerate(self.initial):
            if name in prior.initial:
                for i, data in enumerate(self.trials):
                    # In the middle of a manoeuvre a state that is not measured is unknown.
                    known = data.settled or data.shows(name)
                    deviation = prior.initial[name] * (1.0 if known else _UNSETTLED)
                    parts = (deviation, noise * data.start_std[name], prior.lasting.get(name, 0.0))
                    deviation = float(np.linalg.norm(parts))
                    add({self.own(i).start + k: 1.0}, data.start[name], deviation)
        for k, name in enumerate(self.estimated):
            if name in prior.parameters:
                mean, deviation = prior.parameters[name]
                add({k: 1.0}, mean, deviation)
        if not slopes:
            return np.zeros(0), np.zeros((0, self.size))
        slope = np.array(slopes) * np.sqrt(prior.strength)
        return slope @ q - np.array(offsets) * np.sqrt(prior.strength), slope

    @property
    def rows(self) -> tuple[slice, ...]:
        """Rows of a residual vector that belong to each trial, signal by signal, and at last those of the prior."""
        ends = np.cumsum([data.intervals.size * len(self.signals) for data in self.trials]).tolist()
        return tuple(slice(first, last) for first, last in zip([0, *ends], [*ends, None]))

    def by_signal(self, residual: np.ndarray) -> list[list[np.ndarray]]:
        """Return a residual vector split: for each trial, for each signal; those of the prior at its end are left out.

        Residuals of samples that are missing are NaN.

        Parameters
        ----------
        residual : ndarray, shape (M,)
            Residuals of all trials.
        """
        out = []
        for data, own in zip(self.trials, self.rows):
            rows = residual[own].reshape(len(self.signals), -1)
            out.append(list(rows if data.there.all() else np.where(data.there, rows, np.nan)))
        return out


def make_problem(
    model: Model,
    trials: Sequence[TrialData],
    signals: tuple[str, ...],
    estimated: tuple[str, ...],
    fixed: Mapping[str, float],
    sigma: np.ndarray,
    biases: tuple[str, ...],
    bias_offset: Mapping[str, float] | None = None,
) -> Problem:
    """Return the problem of some trials: which states have unknowns of their own follows from the model.

    Parameters
    ----------
    model, trials, signals, estimated, fixed, sigma, biases
        See `Problem`.
    bias_offset : mapping, optional
        Biases that are known beforehand, by input.
    """
    behind = generate(model).states_behind(shown_by(model, signals))
    levels = np.asarray(sigma, dtype=float)
    return Problem(
        model, tuple(trials), signals, estimated, behind, biases, dict(fixed), levels, dict(bias_offset or {})
    )
