"""The output-error problem: trials, a model and the unknowns, as one vector of residuals with its exact Jacobian.

Unknowns are the estimated parameters, shared by all trials, and for each trial its initial states and the constant biases
of the rudder (and of the cruising speed, where the model reads it): ``q = [parameters, trial 1, trial 2, ...]``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.declaration.errors import UnknownNameError
from shipid.declaration.model import Model
from shipid.generation.record import Record, make_record
from shipid.generation.system import generate
from shipid.identification.errors import NoAnswerError, NothingToFitError
from shipid.trials.trial import Trial

#: Signals that are fitted where the trial measures them and the model predicts them.
SIGNALS = ("psi", "r", "u", "v")
#: Signals that are fitted where the sway speed is predicted and not measured.
TRACK = ("x", "y")
#: Rudder movement in rad at which a manoeuvre has begun.
_MOVED = np.deg2rad(3.0)
#: Weighted residual of a sample at which the model has run away.
RUNAWAY = 1e6
#: Slope beyond which squares would overflow.
_STEEP = 1e30


@dataclass(frozen=True, eq=False)
class Sailed:
    """A trial as the model sees it.

    Attributes
    ----------
    trial : Trial
        Where it came from.
    intervals : ndarray, shape (N,)
        Time to the next sample in s; the last is zero.
    inputs : ndarray, shape (inputs, N)
        Inputs of the model.
    measured : ndarray, shape (signals, N)
        The fitted signals.
    x0 : ndarray, shape (states,)
        A first guess of the initial states.
    speed : float
        Median speed in m/s (1 where neither trial nor ship knows it).
    """

    trial: Trial
    intervals: np.ndarray
    inputs: np.ndarray
    measured: np.ndarray
    x0: np.ndarray
    speed: float

    def thinned(self, most: int) -> Sailed:
        """Return every n-th sample, so that at most about `most` are left."""
        n = max(1, self.intervals.size // most)
        if n == 1:
            return self
        t = self.trial["t"][::n]
        return replace(
            self, intervals=np.diff(t, append=t[-1]), inputs=self.inputs[:, ::n], measured=self.measured[:, ::n]
        )

    def head(self, count: int) -> Sailed:
        """Return the first `count` samples."""
        return replace(
            self, intervals=self.intervals[:count], inputs=self.inputs[:, :count], measured=self.measured[:, :count]
        )


def fitted_signals(model: Model, trials: Sequence[Trial], wanted: Sequence[str] | None = None) -> tuple[str, ...]:
    """Return the signals that every trial measures and the model predicts.

    Raises
    ------
    UnknownNameError
        If a signal asked for is none the model predicts.
    NothingToFitError
        If there is none, or a trial does not measure a signal asked for.
    """
    predicted = [n for n in model.entries if model[n].quantity.kind in ("state", "derived", "output")]
    for name in wanted or ():
        if name not in predicted:
            raise UnknownNameError(f"signal that model {model.name} predicts called", name, predicted)
        for trial in trials:
            if not trial.has(name):
                raise NothingToFitError(
                    f"the signal '{name}' is to be fitted, and trial {trial.name} does not have it. Its columns: "
                    f"{', '.join(trial.table.columns)}."
                )
    found = tuple(n for n in dict.fromkeys(wanted or SIGNALS) if n in predicted and all(t.has(n) for t in trials))
    if wanted is None and "v" in predicted and "v" not in found and all(t.has("x", "y") for t in trials):
        # Nothing else shows the drift: fit the track, with a constant current of its own in each trial.
        found += tuple(n for n in TRACK if n in predicted)
    if not found:
        raise NothingToFitError(
            f"no trial measures what model {model.name} predicts. It predicts {', '.join(predicted)}; the first trial has "
            f"{', '.join(trials[0].table.columns)}."
        )
    return found


def check_answer(trial: Trial, signals: Sequence[str]) -> None:
    """Refuse a trial whose heading or rate of turn never changes: the ship did not answer, or the sensor stood still.

    Raises
    ------
    NoAnswerError
        With the column and the value it keeps.
    """
    for name in ("psi", "r"):
        if name in signals and np.ptp(trial[name]) == 0:
            raise NoAnswerError(
                f"trial {trial.name}, column '{name}': it stays at {trial[name][0]:.6g} {trial.unit(name)} throughout, "
                "while the rudder moves. Check the sensor and the column, or fit other signals (--signals)."
            )


def prepare(
    model: Model, trial: Trial, signals: Sequence[str], own_speed: float | None, first: int | None = None
) -> Sailed:
    """Return a trial as the model sees it.

    Parameters
    ----------
    model : Model
        The model.
    trial : Trial
        The record; an input the model reads and the trial lacks takes its declared default.
    signals : sequence of str
        What is fitted.
    own_speed : float or None
        Speed of the ship in m/s, for trials that do not record it.
    first : int, optional
        How many samples the first guess of the initial state may use; by default 2 % of the record.

    Raises
    ------
    NothingToFitError
        If the trial lacks an input that has no default.
    """
    t = trial["t"]
    recorded = next((trial[n] for n in ("u", "U") if trial.has(n)), None)
    speed = float(np.median(recorded)) if recorded is not None else own_speed
    first = first or max(3, int(0.02 * t.size))
    approach = own_speed if recorded is None else _approach_speed(trial, recorded, first)
    # A model that takes the speed as given keeps that of the approach: the measured one would be a hidden answer. A
    # trial that begins at rest has no approach; its usual speed stands in.
    from_rest = approach is not None and speed is not None and approach < 0.5 * speed
    known = {"u": speed if from_rest else approach, "cruise": approach}
    needed = generate(model).inputs_behind(signals)
    inputs = np.empty((len(model.inputs), t.size))
    for i, name in enumerate(model.inputs):
        value = known.get(name) if name in known else trial[name] if trial.has(name) else model[name].number("default")
        if value is None and name not in needed:
            value = 1.0 if name in known else 0.0
        if value is None:
            raise NothingToFitError(
                f"model {model.name} reads '{name}' ({model[name].quantity.meaning}), which trial {trial.name} does not "
                f"record. Its columns: {', '.join(trial.table.columns)}."
            )
        inputs[i] = value
    x0 = np.array([_initial(model, trial, s, known, first) for s in model.states])
    measured = np.array([trial[s] for s in signals])
    return Sailed(trial, np.diff(t, append=t[-1]), inputs, measured, x0, speed or 1.0)


def _approach_speed(trial: Trial, speed: np.ndarray, least: int) -> float:
    """Median speed before the rudder first moves, over at least so many samples."""
    count = least
    if trial.has("delta"):
        moved = np.abs(trial["delta"] - np.median(trial["delta"][:least])) > _MOVED
        count = max(least, int(np.argmax(moved)) if moved.any() else 0)
    return float(np.median(speed[:count]))


def _initial(model: Model, trial: Trial, name: str, known: Mapping[str, float | None], first: int) -> float:
    if trial.has(name):
        column = trial[name]
        return float(column[0] if name in ("x", "y", "psi") else np.median(column[:first]))
    if name == "u" and known["cruise"] is not None:
        return float(known["cruise"])
    return model[name].number("start") or 0.0


@dataclass(frozen=True)
class Prior:
    """What is believed of the unknowns of each trial before it is fitted.

    Attributes
    ----------
    biases : mapping of str to float
        Standard deviation of a trial's bias about the mean of all trials, SI, by input.
    mean_biases : mapping of str to float
        Standard deviation of that mean about zero.
    initial : mapping of str to float
        Standard deviation of an initial state about its first guess, SI, by state.
    strength : float
        How many samples of the record one belief is worth: residuals are correlated, so that a belief would be
        outvoted by samples that repeat each other.
    """

    biases: Mapping[str, float]
    mean_biases: Mapping[str, float]
    initial: Mapping[str, float]
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
            believed, slope = self._beliefs(q, self.prior)
            rows.append(believed)
            blocks.append(slope)
        return np.concatenate(rows), np.concatenate(blocks)

    def _beliefs(self, q: np.ndarray, prior: Prior) -> tuple[np.ndarray, np.ndarray]:
        """Residuals of the prior and their Jacobian: biases about their mean, the mean about zero, initial states."""
        count, states = len(self.sailed), self.record.system.states
        slopes, offsets = [], []

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
        for k, name in enumerate(self.initial):
            if name in prior.initial:
                for i, sailed in enumerate(self.sailed):
                    add({self.own(i).start + k: 1.0}, sailed.x0[states.index(name)], prior.initial[name])
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


def unknown_biases(model: Model, signals: Sequence[str], rudder_bias: bool = True) -> tuple[str, ...]:
    """Return the inputs whose constant bias is unknown in each trial.

    The rudder; the cruising speed, where a fitted speed shows it; the current, where a fitted track shows it.
    """
    wanted = ["delta"] if rudder_bias else []
    wanted += ["cruise"] if "u" in signals else []
    wanted += ["current_north", "current_east"] if set(TRACK) & set(signals) else []
    return tuple(n for n in wanted if n in model.inputs)


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
