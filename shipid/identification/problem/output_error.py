"""The output-error problem: trials, a model and the unknowns, as one vector of residuals with its exact Jacobian.

Unknowns are the estimated parameters, shared by all trials, and for each trial its initial states and the constant biases
of the rudder (and of the cruising speed, where the model reads it): ``q = [parameters, trial 1, trial 2, ...]``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from shipid.declaration.model import Model
from shipid.generation.record import Record, make_record
from shipid.generation.system import generate
from shipid.identification.problem.trial_data import Sailed

#: Weighted residual of a sample at which the model has run away.
RUNAWAY = 1e6
#: How much less is believed of the cruising speed, and of a state nobody measures, where a trial begins in the middle of a
#: manoeuvre.
_UNSETTLED = 20.0
#: Slope beyond which squares would overflow.
_STEEP = 1e30


@dataclass(frozen=True)
class Prior:
    """What is believed of the unknowns of each trial before it is fitted.

    Attributes
    ----------
    biases : mapping of str to float
        Standard deviation of a trial's bias about the mean of all trials, SI, by input.
    mean_biases : mapping of str to float
        Standard deviation of that mean about zero.
    own : mapping of str to float
        Standard deviation of a bias that trials do not share about zero, SI, by input: the cruising speed.
    initial : mapping of str to float
        Standard deviation of an initial state about its first guess, SI, by state.
    parameters : mapping of str to tuple of float
        Mean and standard deviation of a shared parameter, SI.
    strength : float
        How many samples of the record one belief is worth: residuals are correlated, so that a belief would be
        outvoted by samples that repeat each other.
    """

    biases: Mapping[str, float]
    mean_biases: Mapping[str, float]
    own: Mapping[str, float]
    initial: Mapping[str, float]
    parameters: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    strength: float = 1.0


@dataclass(frozen=True, eq=False)
class Problem:
    """Residuals and Jacobian of trials under a model.

    Attributes
    ----------
    model : Model
        The model.
    sailed : tuple of Sailed
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
        What is believed of biases and initial states; None where they are free.
    loss : str
        How residuals count (`shipid.identification.problem.losses`).
    weights : tuple of ndarray or None
        Weight of each squared residual under a robust loss, by trial, shapes (signals, N).
    """

    model: Model
    sailed: tuple[Sailed, ...]
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
        return make_record(self.model, self.signals, self.estimated, self.initial, self.biases)

    @property
    def per_trial(self) -> int:
        """Number of unknowns each trial has of its own."""
        return len(self.initial) + len(self.biases)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.estimated) + len(self.sailed) * self.per_trial

    def own(self, index: int) -> slice:
        """Where the unknowns of one trial stand in q."""
        begin = len(self.estimated) + index * self.per_trial
        return slice(begin, begin + self.per_trial)

    def first_guess(self, parameters: np.ndarray) -> np.ndarray:
        """Return q with these parameters, initial states as measured, and no further bias."""
        states = self.record.system.states
        q = np.zeros(self.size)
        q[: len(self.estimated)] = parameters
        for i, s in enumerate(self.sailed):
            q[self.own(i)] = [*(s.x0[states.index(n)] for n in self.initial), *(0.0 for _ in self.biases)]
        return q

    def run(self, q: np.ndarray, index: int, sailed: Sailed | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Run one trial: outputs (signals, N) and their derivatives (signals, unknowns of the record, N)."""
        s = sailed or self.sailed[index]
        record = self.record
        own = q[self.own(index)]
        x0 = s.x0.copy()
        x0[[record.system.states.index(n) for n in self.initial]] = own[: len(self.initial)]
        values = {**self.fixed, **dict(zip(self.estimated, q))}
        p = record.system.vector(record.system.coefficients, values)
        return record(x0, s.inputs, s.intervals, p, self.bias_vector(own))

    def named_biases(self, own: np.ndarray) -> dict[str, float]:
        """Return the biases of one trial by input, those known beforehand included."""
        return {n: float(b) for n, b in zip(self.record.system.inputs, self.bias_vector(own)) if b}

    def bias_vector(self, own: np.ndarray) -> np.ndarray:
        """Return the bias of every input for one trial's own unknowns."""
        inputs = self.record.system.inputs
        bias = np.array([self.bias_offset.get(n, 0.0) for n in inputs])
        for name, value in zip(self.biases, own[len(self.initial) :]):
            bias[inputs.index(name)] += value
        return bias

    def residuals(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return weighted residuals, shape (M,), and their Jacobian, shape (M, unknowns).

        Where the model runs away the residual is a large constant with no slope: the search steps back.
        """
        shared = len(self.estimated)
        rows, blocks = [], []
        for i, s in enumerate(self.sailed):
            y, dy = self.run(q, i)
            with np.errstate(over="ignore", invalid="ignore"):
                residual = (y - s.measured) / self.sigma[:, None]
                slope = dy / self.sigma[:, None, None]
                if self.weights is not None:
                    root = np.sqrt(self.weights[i])
                    residual, slope = residual * root, slope * root[:, None, :]
                # NaN compares as false, so what is not finite is not good either.
                good = (np.abs(residual) < RUNAWAY) & (np.abs(slope) < _STEEP).all(axis=1)
            residual = np.where(good, residual, RUNAWAY)
            slope = np.where(good[:, None, :], slope, 0.0)
            flat = slope.transpose(0, 2, 1).reshape(-1, slope.shape[1])
            block = np.zeros((flat.shape[0], self.size))
            block[:, :shared] = flat[:, :shared]
            block[:, self.own(i)] = flat[:, shared:]
            rows.append(residual.ravel())
            blocks.append(block)
        if self.prior is not None:
            believed, slope = self.beliefs(q, self.prior)
            rows.append(believed)
            blocks.append(slope)
        return np.concatenate(rows), np.concatenate(blocks)

    def beliefs(self, q: np.ndarray, prior: Prior) -> tuple[np.ndarray, np.ndarray]:
        """Return residuals of the prior and their Jacobian: biases about their mean, that about zero, initial states."""
        count, states = len(self.sailed), self.record.system.states
        slopes, offsets = [], []
        # Sensor noise is not correlated: what it adds to a guess counts sample by sample.
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
                for c, sailed in zip(columns, self.sailed):
                    deviation = prior.own[name] * (1.0 if sailed.settled else _UNSETTLED)
                    add({c: 1.0}, 0.0, np.hypot(deviation, noise * sailed.cruise_std))
        for k, name in enumerate(self.initial):
            if name in prior.initial:
                for i, sailed in enumerate(self.sailed):
                    # In the middle of a manoeuvre nobody knows what is not measured.
                    known = sailed.settled or sailed.trial.has(name)
                    deviation = prior.initial[name] * (1.0 if known else _UNSETTLED)
                    at = states.index(name)
                    deviation = float(np.hypot(deviation, noise * sailed.x0_std[at]))
                    add({self.own(i).start + k: 1.0}, sailed.x0[at], deviation)
        for k, name in enumerate(self.estimated):
            if name in prior.parameters:
                mean, deviation = prior.parameters[name]
                add({k: 1.0}, mean, deviation)
        if not slopes:
            return np.zeros(0), np.zeros((0, self.size))
        slope = np.array(slopes) * np.sqrt(prior.strength)
        return slope @ q - np.array(offsets) * np.sqrt(prior.strength), slope

    def by_signal(self, residual: np.ndarray) -> list[list[np.ndarray]]:
        """Split a residual vector: for each trial, for each signal; the beliefs at its end are left out."""
        out, at = [], 0
        for s in self.sailed:
            n = s.intervals.size
            out.append([residual[at + j * n : at + (j + 1) * n] for j in range(len(self.signals))])
            at += n * len(self.signals)
        return out


def make_problem(
    model: Model,
    sailed: Sequence[Sailed],
    signals: tuple[str, ...],
    estimated: tuple[str, ...],
    fixed: Mapping[str, float],
    sigma: np.ndarray,
    biases: tuple[str, ...],
    bias_offset: Mapping[str, float] | None = None,
) -> Problem:
    """Put a problem together: which states have unknowns of their own follows from the model.

    Parameters
    ----------
    model, sailed, signals, estimated, fixed, sigma, biases
        See `Problem`.
    bias_offset : mapping, optional
        Biases that are known beforehand, by input.
    """
    behind = generate(model).states_behind(signals)
    levels = np.asarray(sigma, dtype=float)
    return Problem(
        model, tuple(sailed), signals, estimated, behind, biases, dict(fixed), levels, dict(bias_offset or {})
    )
