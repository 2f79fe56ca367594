"""Trials as a model sees them: inputs, measured signals, and a first guess of the initial state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.errors import UnknownNameError
from shipid.generation.system import generate
from shipid.identification.errors import NoAnswerError, NothingToFitError
from shipid.trials.trial import Trial

#: Signals that are fitted where the trial measures them and the model predicts them.
SIGNALS = ("psi", "r", "u", "v")
#: Signals that are fitted where the sway speed is predicted and not measured.
TRACK = ("x", "y")
#: Rudder movement in rad at which a manoeuvre has begun.
_MOVED = np.deg2rad(3.0)


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
    x0, x0_std : ndarray, shape (states,)
        A first guess of the initial states, and how far sensor noise may have put it off.
    cruise_std : float
        How far sensor noise may have put off the speed of the approach, in m/s.
    speed : float
        Median speed in m/s (1 where neither trial nor ship knows it).
    settled : bool
        Whether it begins on a steady course, rudder amidships: then states that nobody measures begin near zero.
    """

    trial: Trial
    intervals: np.ndarray
    inputs: np.ndarray
    measured: np.ndarray
    x0: np.ndarray
    x0_std: np.ndarray
    cruise_std: float
    speed: float
    settled: bool = True

    def thinned(self, most: int) -> Sailed:
        """Return every n-th sample, so that at most about `most` are left."""
        n = max(1, self.intervals.size // most)
        if n == 1:
            return self
        t = np.concatenate([[0.0], np.cumsum(self.intervals[:-1])])[::n]
        return replace(
            self, intervals=np.diff(t, append=t[-1]), inputs=self.inputs[:, ::n], measured=self.measured[:, ::n]
        )

    def column(self, name: str) -> np.ndarray:
        """Return a column of the trial at the samples that are left."""
        t = self.trial["t"]
        return np.asarray(
            np.interp(t[0] + np.concatenate([[0.0], np.cumsum(self.intervals[:-1])]), t, self.trial[name])
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
    approach, cruise_std = (own_speed, 0.0) if recorded is None else _approach_speed(trial, recorded, first)
    # A model that takes the speed as given keeps that of the approach: the measured one would be a hidden answer. A
    # ship that still gathers speed has no approach; its usual speed stands in.
    gathering = approach is not None and speed is not None and approach < 0.9 * speed
    known = {"u": speed if gathering else approach, "cruise": speed if gathering else approach}
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
    x0, x0_std = (np.array(c) for c in zip(*(_initial(model, trial, s, known, first) for s in model.states)))
    measured = np.array([trial[s] for s in signals])
    return Sailed(
        trial,
        np.diff(t, append=t[-1]),
        inputs,
        measured,
        x0,
        x0_std,
        cruise_std,
        speed or 1.0,
        not gathering and _settled(trial, min(first, 10)),
    )


def _settled(trial: Trial, first: int) -> bool:
    """Whether the rudder rests near amidships and the rate of turn is small beside what the trial goes on to."""
    still = not trial.has("delta") or float(np.abs(trial["delta"][:first]).max()) < 1.5 * _MOVED
    if not trial.has("r"):
        return still
    rate = trial["r"]
    return still and abs(float(np.median(rate[:first]))) < 0.15 * float(np.abs(rate).max())


def _approach_speed(trial: Trial, speed: np.ndarray, least: int) -> tuple[float, float]:
    """Median speed before the rudder first moves, over at least so many samples, and its standard error."""
    count = least
    if trial.has("delta"):
        moved = np.abs(trial["delta"] - np.median(trial["delta"][:least])) > _MOVED
        count = max(least, int(np.argmax(moved)) if moved.any() else 0)
    taken = speed[:count]
    # The noise from sample to sample, not the drift of the speed itself; a median scatters 1.25 times as a mean.
    noise = float(np.std(np.diff(taken)) / np.sqrt(2)) if count > 2 else 0.0
    return float(np.median(taken)), 1.25 * noise / np.sqrt(count)


def _initial(
    model: Model, trial: Trial, name: str, known: Mapping[str, float | None], first: int
) -> tuple[float, float]:
    """A first guess of one initial state and its standard error: a straight line through the first samples."""
    if trial.has(name):
        t, column = trial["t"][:first], trial[name][:first]
        if len(t) < 4:
            return float(column[0]), 0.0
        design = np.column_stack([np.ones(len(t)), t - t[0]])
        found, *_ = np.linalg.lstsq(design, column, rcond=None)
        scatter = float(np.std(column - design @ found)) * np.sqrt(len(t) / (len(t) - 2))
        return float(found[0]), float(scatter * np.sqrt(np.linalg.inv(design.T @ design)[0, 0]))
    if name == "u" and known["cruise"] is not None:
        return float(known["cruise"]), 0.0
    return model[name].number("start") or 0.0, 0.0


def unknown_biases(model: Model, signals: Sequence[str], rudder_bias: bool = True) -> tuple[str, ...]:
    """Return the inputs whose constant bias is unknown in each trial.

    The rudder; the cruising speed, where a fitted speed shows it; the current, where a fitted track shows it.
    """
    wanted = ["delta"] if rudder_bias else []
    wanted += ["cruise"] if "u" in signals else []
    wanted += ["current_north", "current_east"] if set(TRACK) & set(signals) else []
    return tuple(n for n in wanted if n in model.inputs)
