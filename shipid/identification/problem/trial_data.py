"""Trials as a model reads them: inputs, measured signals, and a first guess of the initial state."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.declaration.model import Model
from shipid.generation.simulator import input_rows
from shipid.generation.system import generate
from shipid.identification.problem.first_guess import first_guess
from shipid.trials.filling import interpolated, usual_interval
from shipid.trials.fitness import check_column_units
from shipid.trials.speed import PUT_OVER, check_ahead, check_way, recorded_speed, speed_before_in
from shipid.trials.stretches import stretches_of
from shipid.trials.trial import Trial

#: The first seconds of a trial, in L/U, from which an initial state may be taken.
WARM_UP = 0.25
#: Inputs that a trial gives as one number: the speed before the manoeuvre.
_ONE_NUMBER = ("u", "cruise")
#: Samples of a slow signal that thinning leaves, where it has as many.
_FEW = 50


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
        The fitted signals; NaN where a sample is missing.
    start, start_std : mapping of str to float
        A first guess of each initial state, SI, and the standard error that sensor noise gives it.
    cruise_std : float
        Standard error of the speed before the manoeuvre by sensor noise, in m/s.
    approached : bool
        Whether that speed was measured on a steady course, rudder amidships: of a stretch, at the beginning of its record.
    speed : float
        Median speed in m/s (1 where neither trial nor ship states it).
    settled : bool
        Whether it begins on a steady course, rudder amidships: then states that are not measured begin near zero.
    sampled : ndarray of bool, shape (inputs, N), or None
        Where each input has a sample of its own; between them it is filled. None where all are whole.
    unsure : ndarray, shape (errors, inputs, N), or None
        What is left unknown of the inputs between their samples: independent errors, one standard deviation of each, those of all
        trials in the same order. None where nothing is.
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
    approached: bool = True
    sampled: np.ndarray | None = None
    unsure: np.ndarray | None = None

    @functools.cached_property
    def there(self) -> np.ndarray:
        """Which samples of the fitted signals are there, shape (signals, N)."""
        return np.asarray(np.isfinite(self.measured))

    @functools.cached_property
    def regular(self) -> bool:
        """Whether no sample is missing and the clock has no gap."""
        steps = self.intervals[:-1]
        return bool(self.there.all()) and (not steps.size or bool(steps.max() <= 1.5 * np.median(steps)))

    @property
    def step(self) -> float:
        """Usual time between two samples of a signal, in s."""
        if self.regular:
            return float(np.median(self.intervals[:-1])) if self.intervals.size > 1 else 0.0
        return float(self.t[-1] / max(1.0, self.there.sum(axis=1).mean() - 1.0))

    def step_of(self, signal: int) -> float:
        """Return the usual time between two samples of one signal, in s.

        Parameters
        ----------
        signal : int
            Which signal.
        """
        return self._steps[signal]

    @functools.cached_property
    def _steps(self) -> tuple[float, ...]:
        if self.regular:
            return (self.step,) * len(self.measured)
        own = [usual_interval(self.t, row) for row in self.measured]
        return tuple(step if np.isfinite(step) else self.step for step in own)

    @functools.cached_property
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
        kept = np.zeros(self.intervals.size, dtype=bool)
        kept[::n] = True
        for there in self.there:
            # The samples of a signal with a clock of its own may all lie between those that are kept.
            count = int(there.sum())
            if there[kept].sum() < min(count, max(0.5 * count / n, _FEW)):
                kept[np.flatnonzero(there)[:: max(1, min(n, count // _FEW))]] = True
        t = self.t[kept]
        return replace(
            self, intervals=np.diff(t, append=t[-1]), inputs=self.inputs[:, kept], measured=self.measured[:, kept],
            sampled=None, unsure=None,
        )  # fmt: skip

    def shows(self, name: str) -> bool:
        """Return whether the trial holds a sample of a column.

        Parameters
        ----------
        name : str
            The column.
        """
        return name in self._shown

    @functools.cached_property
    def _shown(self) -> frozenset[str]:
        return frozenset(n for n in self.trial.table.columns if np.isfinite(self.trial[n]).any())

    def column(self, name: str, at: np.ndarray | None = None) -> np.ndarray:
        """Return a column of the trial in straight lines between its own samples, for a start of a search, shape (N,).

        Parameters
        ----------
        name : str
            The column; the first and the last sample stand before and behind it.
        at : ndarray, shape (N,), optional
            Times from zero in s; those of the samples that are left by default.
        """
        t, values = self.trial["t"], self.trial[name]
        there = np.isfinite(values)
        return np.asarray(np.interp(t[0] + (self.t if at is None else at), t[there], values[there]))

    def known(self, name: str, at: np.ndarray) -> np.ndarray:
        """Return where a column of the trial lies between samples that are close to each other, shape (N,).

        Parameters
        ----------
        name : str
            The column.
        at : ndarray, shape (N,)
            Times from zero in s.
        """
        t = self.trial["t"]
        return np.asarray(np.isfinite(interpolated(t, self.trial[name], t[0] + at)))

    def head(self, count: int) -> TrialData:
        """Return the first samples.

        Parameters
        ----------
        count : int
            How many.
        """
        return replace(
            self, intervals=self.intervals[:count], inputs=self.inputs[:, :count], measured=self.measured[:, :count],
            sampled=None, unsure=None,
        )  # fmt: skip

    def beginning(self, count: int) -> TrialData:
        """Return the first rows, and of a signal that comes later its first four samples.

        Parameters
        ----------
        count : int
            How many rows.
        """
        nth = np.cumsum(self.there, axis=1)
        taken = self.there & ((np.arange(self.intervals.size) < count) | (nth <= min(4, count)))
        rows = max(count, int(np.flatnonzero(taken.any(axis=0)).max(initial=0)) + 1)
        return replace(self, measured=np.where(taken, self.measured, np.nan)).head(rows)


def warm_up_samples(trial: Trial, unit_time: float) -> int:
    """Return how many samples make the first seconds: a quarter of L/U, at least ten samples.

    Parameters
    ----------
    trial : Trial
        The trial.
    unit_time : float
        L/U in s.
    """
    t = trial["t"]
    # Rows of several signals on their own clocks are closer together than the samples of one.
    rows = max(np.ceil(WARM_UP * unit_time / trial.sampling), np.searchsorted(t, t[0] + WARM_UP * unit_time))
    return int(np.clip(rows, 10, len(trial)))


def recorded_inputs(model: Model, trial: Trial, signals: Sequence[str]) -> tuple[str, ...]:
    """Return the inputs that a trial records sample by sample and that have an influence on the signals.

    Parameters
    ----------
    model : Model
        The model.
    trial : Trial
        The trial.
    signals : sequence of str
        The fitted signals.
    """
    return tuple(n for n in generate(model).inputs_behind(signals) if trial.has(n) and n not in _ONE_NUMBER)


def with_whole_inputs(model: Model, trial: Trial, signals: Sequence[str], unit_time: float) -> tuple[Trial, ...]:
    """Return the stretches of a trial over which the model can be run: its inputs are filled where the rule reaches.

    Parameters
    ----------
    model : Model
        The model.
    trial : Trial
        The trial.
    signals : sequence of str
        The fitted signals.
    unit_time : float
        L/U in s. Where holes split the record, a stretch of less is left out: the initial state of its own takes what it holds.

    Returns
    -------
    tuple of Trial
        See `shipid.trials.stretches.stretches_of`.

    Raises
    ------
    NoStretchError
        If no stretch is long enough.
    """
    inputs = recorded_inputs(model, trial, signals)
    # A whole trial that is too short is refused with a message of its own.
    least = min(unit_time, 0.5 * trial.duration)
    return stretches_of(trial, inputs, least=least, unit_time=unit_time)


def prepare(
    model: Model,
    trial: Trial,
    signals: Sequence[str],
    own_speed: float | None,
    unit_time: float | None = None,
    recorded_in: Trial | None = None,
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
    recorded_in : Trial, optional
        The trial of which it is a stretch with filled inputs.

    Returns
    -------
    TrialData

    Raises
    ------
    UnstatedInputError
        If the trial lacks an input that has an influence on the signals and declares no default.
    ColumnUnitError
        If a column has another unit than the quantity of the model.
    NotAheadError
        If the ship does not go ahead, and the speed stands in the model.
    """
    check_column_units(trial, model)
    t, columns = trial["t"], {n: trial[n] for n in trial.table.columns}
    first = max(3, int(0.02 * t.size)) if unit_time is None else warm_up_samples(trial, unit_time)
    whole = trial if recorded_in is None else recorded_in
    recorded = recorded_speed(columns)
    measured = speed_before_in(columns if whole is trial else {n: whole[n] for n in whole.table.columns}, unit_time)
    # A model that takes the speed as given gets that before the manoeuvre: the measured one is part of the ship's response.
    before = own_speed if measured is None else measured.value
    if "cruise" in columns:
        # Stated: a stretch between holes begins in the middle of a manoeuvre.
        before = float(np.nanmedian(columns["cruise"]))
    needed = generate(model).inputs_behind(signals)
    if {"u", "cruise"} & {*needed, *model.states}:
        check_ahead(before, trial.name, model.name)
    if model.guards:
        check_way(columns, trial.name, model.name)
    given: dict[str, float | np.ndarray] = {
        **trial.source.conditions.loading,
        **{n: _everywhere(t, columns[n]) for n in model.inputs if n in columns and n not in _ONE_NUMBER},
    }
    for name in _ONE_NUMBER:
        if before is not None:
            given[name] = before
        elif name not in needed:
            given[name] = 1.0  # without influence on what is fitted, and a speed of zero divides
    usual = measured is not None and measured.source == "usual speed"
    start = {n: first_guess(model, trial, whole, n, before, first) for n in model.states}
    return TrialData(
        trial,
        np.diff(t, append=t[-1]),
        input_rows(model, given, t.size, f"trial {trial.name}", needed),
        np.array([columns[s] for s in signals]),
        {n: value for n, (value, _) in start.items()},
        {n: std for n, (_, std) in start.items()},
        0.0 if measured is None else measured.std,
        (own_speed if recorded is None else float(np.nanmedian(recorded))) or 1.0,
        not usual and _settled(trial, min(first, 10)),
        not usual and _settled(whole, min(first, 10)),
        None if recorded_in is None else _sampled(model, trial, recorded_in),
    )


def _sampled(model: Model, stretch: Trial, whole: Trial) -> np.ndarray | None:
    """Where each input of a stretch has a sample of its own, or None where all do everywhere."""
    rows = np.searchsorted(whole["t"], stretch["t"])
    everywhere = np.ones(rows.size, dtype=bool)
    inputs = (n if whole.has(n) and n not in _ONE_NUMBER else None for n in model.inputs)
    found = np.array([everywhere if n is None else np.isfinite(whole[n][rows]) for n in inputs])
    return None if found.all() else found


def _everywhere(t: np.ndarray, column: np.ndarray) -> np.ndarray:
    """An input at every row. What has an influence is whole; another one is in straight lines over holes of any length."""
    there = np.isfinite(column)
    return column if there.all() else np.interp(t, t[there], column[there])


def _settled(trial: Trial, first: int) -> bool:
    """Whether the rudder is near amidships and the rate of turn is small compared with that of the later trial."""
    still = not trial.has("delta") or _largest(trial["delta"][:first]) < 1.5 * PUT_OVER
    if not trial.has("r"):
        return still
    rate = trial["r"]
    begins = rate[:first][np.isfinite(rate[:first])]
    if not begins.size:
        return still
    return still and abs(float(np.median(begins))) < 0.15 * _largest(rate)


def _largest(values: np.ndarray) -> float:
    """The largest size of the samples that are there."""
    return float(np.nanmax(np.abs(values), initial=0.0))
