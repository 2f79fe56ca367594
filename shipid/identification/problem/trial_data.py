"""Trials as a model reads them: inputs, measured signals, and a first guess of the initial state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.declaration.model import Model
from shipid.generation.simulator import input_rows
from shipid.generation.system import generate
from shipid.identification.problem.ship_scale import recorded_speed
from shipid.trials.trial import Trial

#: Rudder movement in rad at which a manoeuvre has begun.
_MOVED = np.deg2rad(3.0)


@dataclass(frozen=True, eq=False)
class TrialData:
    """A trial as a model reads it.

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
    start, start_std : mapping of str to float
        A first guess of each initial state, SI, and the standard error that sensor noise gives it.
    cruise_std : float
        Standard error of the speed before the manoeuvre by sensor noise, in m/s.
    speed : float
        Median speed in m/s (1 where neither trial nor ship knows it).
    settled : bool
        Whether it begins on a steady course, rudder amidships: then states that nobody measures begin near zero.
    """

    trial: Trial
    intervals: np.ndarray
    inputs: np.ndarray
    measured: np.ndarray
    start: Mapping[str, float]
    start_std: Mapping[str, float]
    cruise_std: float
    speed: float
    settled: bool = True

    @property
    def t(self) -> np.ndarray:
        """Times of the samples in s, from zero, shape (N,)."""
        return np.concatenate([[0.0], np.cumsum(self.intervals[:-1])])

    def thinned(self, most: int) -> TrialData:
        """Return every n-th sample, so that at most about `most` are left.

        Parameters
        ----------
        most : int
            How many samples.
        """
        n = max(1, self.intervals.size // most)
        if n == 1:
            return self
        t = self.t[::n]
        return replace(
            self, intervals=np.diff(t, append=t[-1]), inputs=self.inputs[:, ::n], measured=self.measured[:, ::n]
        )

    def column(self, name: str) -> np.ndarray:
        """Return a column of the trial at the samples that are left, shape (N,).

        Parameters
        ----------
        name : str
            The column.
        """
        t = self.trial["t"]
        return np.asarray(np.interp(t[0] + self.t, t, self.trial[name]))

    def head(self, count: int) -> TrialData:
        """Return the first samples.

        Parameters
        ----------
        count : int
            How many.
        """
        return replace(
            self, intervals=self.intervals[:count], inputs=self.inputs[:, :count], measured=self.measured[:, :count]
        )


def prepare(
    model: Model, trial: Trial, signals: Sequence[str], own_speed: float | None, first: int | None = None
) -> TrialData:
    """Return a trial as a model reads it.

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

    Returns
    -------
    TrialData

    Raises
    ------
    UnstatedInputError
        If the trial lacks an input that has an influence on the signals and declares no default.
    """
    t = trial["t"]
    recorded = recorded_speed(trial)
    speed = float(np.median(recorded)) if recorded is not None else own_speed
    first = first or max(3, int(0.02 * t.size))
    approach, cruise_std = (own_speed, 0.0) if recorded is None else _approach_speed(trial, recorded, first)
    # A model that takes the speed as given keeps that of the approach: the measured one would be a hidden answer. A
    # ship that still gathers speed has no approach; its usual speed stands in.
    gathering = approach is not None and speed is not None and approach < 0.9 * speed
    before = speed if gathering else approach
    needed = generate(model).inputs_behind(signals)
    given: dict[str, float | np.ndarray] = {n: trial[n] for n in model.inputs if trial.has(n)}
    for name in ("u", "cruise"):
        given.pop(name, None)
        if before is not None:
            given[name] = before
        elif name not in needed:
            given[name] = 1.0  # without influence on what is fitted, and a speed of zero divides
    start = {n: _initial(model, trial, n, before, first) for n in model.states}
    return TrialData(
        trial,
        np.diff(t, append=t[-1]),
        input_rows(model, given, t.size, f"trial {trial.name}", needed),
        np.array([trial[s] for s in signals]),
        {n: value for n, (value, _) in start.items()},
        {n: std for n, (_, std) in start.items()},
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


def _initial(model: Model, trial: Trial, name: str, before: float | None, first: int) -> tuple[float, float]:
    """A first guess of one initial state and its standard error: a straight line through the first samples."""
    if trial.has(name):
        t, column = trial["t"][:first], trial[name][:first]
        if len(t) < 4:
            return float(column[0]), 0.0
        design = np.column_stack([np.ones(len(t)), t - t[0]])
        found, *_ = np.linalg.lstsq(design, column, rcond=None)
        scatter = float(np.std(column - design @ found)) * np.sqrt(len(t) / (len(t) - 2))
        return float(found[0]), float(scatter * np.sqrt(np.linalg.inv(design.T @ design)[0, 0]))
    if name == "u" and before is not None:
        return before, 0.0
    return model[name].number("start") or 0.0, 0.0
