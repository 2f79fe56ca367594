"""Trials as a model reads them: inputs, measured signals, and a first guess of the initial state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.declaration.model import Model
from shipid.generation.simulator import input_rows
from shipid.generation.system import generate
from shipid.identification.problem.ship_scale import recorded_speed
from shipid.trials.speed import PUT_OVER, check_ahead, speed_before
from shipid.trials.trial import Trial

#: The first seconds of a trial, in L/U, from which an initial state may be taken.
WARM_UP = 0.25


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
        Median speed in m/s (1 where neither trial nor ship states it).
    settled : bool
        Whether it begins on a steady course, rudder amidships: then states that are not measured begin near zero.
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


def warm_up_samples(trial: Trial, unit_time: float) -> int:
    """Return how many samples make the first seconds: a quarter of L/U, at least ten samples.

    Parameters
    ----------
    trial : Trial
        The trial.
    unit_time : float
        L/U in s.
    """
    return int(np.clip(np.ceil(WARM_UP * unit_time / trial.sampling), 10, len(trial)))


def prepare(
    model: Model, trial: Trial, signals: Sequence[str], own_speed: float | None, unit_time: float | None = None
) -> TrialData:
    """Return a trial as a model reads it.

    Parameters
    ----------
    model : Model
        The model.
    trial : Trial
        The record; an input the model reads and the trial lacks takes its declared default.
    signals : sequence of str
        The fitted signals.
    own_speed : float or None
        Speed of the ship in m/s, for trials that do not record it.
    unit_time : float, optional
        L/U in s. The first guess of the initial state is taken from a quarter of it, by default from 2 % of the record.

    Returns
    -------
    TrialData

    Raises
    ------
    UnstatedInputError
        If the trial lacks an input that has an influence on the signals and declares no default.
    NotAheadError
        If the ship does not go ahead, and the speed stands in the model.
    """
    t, rudder = trial["t"], trial["delta"] if trial.has("delta") else None
    first = max(3, int(0.02 * t.size)) if unit_time is None else warm_up_samples(trial, unit_time)
    recorded = recorded_speed(trial)
    measured = None if recorded is None else speed_before(t, recorded, rudder, unit_time)
    # A model that takes the speed as given gets that before the manoeuvre: the measured one is part of the ship's response.
    before = own_speed if measured is None else measured.value
    needed = generate(model).inputs_behind(signals)
    if {"u", "cruise"} & {*needed, *model.states}:
        check_ahead(before, trial.name, model.name)
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
        0.0 if measured is None else measured.std,
        (own_speed if recorded is None else float(np.median(recorded))) or 1.0,
        (measured is None or measured.source != "usual speed") and _settled(trial, min(first, 10)),
    )


def _settled(trial: Trial, first: int) -> bool:
    """Whether the rudder is near amidships and the rate of turn is small compared with that of the later trial."""
    still = not trial.has("delta") or float(np.abs(trial["delta"][:first]).max()) < 1.5 * PUT_OVER
    if not trial.has("r"):
        return still
    rate = trial["r"]
    return still and abs(float(np.median(rate[:first]))) < 0.15 * float(np.abs(rate).max())


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
