"""A noise level estimated online: a declared recursion, run beside the filter whose noise it sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from shipid.declaration.component import Component, slug
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.records.arrangement import FilterRecord, columns_of
from shipid.estimation.settings.inputs import hold_last, input_table
from shipid.estimation.settings.instruments import Instruments
from shipid.foundation.aliases import CasadiFunction, Plain
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.foundation.numbers import brief
from shipid.foundation.result import Result
from shipid.generation.loop import Loop, Stepper, make_loop
from shipid.generation.simulator import coefficient_vector, initial_state
from shipid.generation.step import make_step
from shipid.generation.system import generate
from shipid.parameters.catalogue import ship_of
from shipid.parameters.parameter_set import ParameterSet, missing_values

if TYPE_CHECKING:
    import pandas as pd


class LevelEstimator:
    """A level along a record, or sample by sample, by the equations of a declared model.

    Parameters
    ----------
    model : Model or component class
        A model whose inputs a record holds, such as the component ``WaveLevel``.
    level : str
        The derived quantity that is the level.
    ship : ParameterSet or str, optional
        Constants that replace the declared ones.
    inputs : mapping of str to float, optional
        Constant inputs, SI.

    Raises
    ------
    UnknownNameError
        If the model has no such quantity.
    """

    def __init__(
        self,
        model: Model | type[Component],
        level: str = "sigma_w",
        ship: ParameterSet | str | None = None,
        inputs: Mapping[str, float] | None = None,
    ) -> None:
        model = model if isinstance(model, Model) else join(slug(model), model)
        if level not in (*model.derived, *model.states):
            raise UnknownNameError(f"level of model {model.name} called", level, (*model.derived, *model.states))
        self.model, self.level, self.unit = model, level, model[level].unit
        self.instruments = Instruments(model, (), generate(model).inputs_behind([level]), dict(inputs or {}))
        known = ship_of(ship).values(model)
        lacking = missing_values(model, known, "it")
        if lacking:
            raise lacking
        self.coefficients = coefficient_vector(model, known)
        self.loop: Loop = make_loop(_level_step(model, level))

    def carried(self, inputs: np.ndarray) -> np.ndarray:
        """Return what is carried into the first sample: the declared start and the inputs there.

        Parameters
        ----------
        inputs : ndarray, shape (inputs,)
            The inputs of the first sample, SI.
        """
        return np.concatenate([initial_state(self.model), inputs])

    def estimate(self, record: FilterRecord) -> LevelRun:
        """Return the level along a record.

        Parameters
        ----------
        record : Trial or mapping of str to ndarray
            SI columns with ``t``; where a sample is missing the last one stands in.

        Raises
        ------
        UsageError
            If its time decreases.
        """
        columns, name = columns_of(record)
        table = hold_last(input_table(self.instruments, columns, name))
        intervals = np.diff(columns["t"], prepend=columns["t"][0])
        if (intervals < 0).any():
            raise UsageError(f"the time of record {name} decreases; a level is estimated forward in time.")
        _, out = self.loop(self.carried(table[0]), np.column_stack([table, intervals]), self.coefficients)
        return LevelRun(columns["t"], out[:, 0], self.level, self.unit)

    def start(self) -> OnlineLevel:
        """Return the recursion for samples that arrive one by one."""
        return OnlineLevel(self)


@dataclass(frozen=True, eq=False, repr=False)
class LevelRun(Result):
    """A level along a record; N samples.

    Attributes
    ----------
    t : ndarray, shape (N,)
        In s.
    values : ndarray, shape (N,)
        The level, SI; a sample counts from the next on.
    name, unit : str
        What it is.
    """

    t: np.ndarray
    values: np.ndarray
    name: str
    unit: str

    def scale(
        self, kalman: ExtendedKalmanFilter, source: str = "wave_noise", least: float = 0.05
    ) -> dict[str, np.ndarray]:
        """Return what ``filter(record, scale=...)`` takes, so that a noise of the filter is this level.

        Parameters
        ----------
        kalman : ExtendedKalmanFilter
            The filter; the noise it was given is the level until there is an estimate.
        source : str
            The noise of the filter.
        least : float
            Smallest factor on it, so that the noise never becomes zero in a calm sea.
        """
        return {source: factor_of(self.values, _given_level(kalman, source), least)}

    def to_dict(self) -> dict[str, Plain]:
        """Return the level at the end as plain values."""
        return {"name": self.name, "unit": self.unit, "value": float(self.values[-1]), "samples": int(self.t.size)}

    def text(self) -> str:
        """Return the result in lines of text."""
        return f"{self.name} over {self.t.size} samples: {brief(self.values[-1], 4)} {self.unit} at the end"

    def to_frame(self) -> pd.DataFrame:
        """Return the level against time as a pandas table, units in the headers."""
        import pandas as pd

        return pd.DataFrame({"t [s]": self.t, f"{self.name} [{self.unit}]": self.values})


@dataclass(eq=False)
class OnlineLevel:
    """A level recursion between two samples; made by `LevelEstimator.start`.

    Attributes
    ----------
    estimator : LevelEstimator
        Which recursion.
    t : float or None
        Time of the last sample in s.
    """

    estimator: LevelEstimator
    t: float | None = None
    _stepper: Stepper | None = field(default=None, repr=False)
    _held: dict[str, float] = field(default_factory=dict, repr=False)

    def update(self, sample: Mapping[str, float]) -> float:
        """Process one sample and return the level after it, SI; one that is not later than the last changes nothing.

        Parameters
        ----------
        sample : mapping of str to float
            Time ``t`` and inputs, SI; an input that is missing keeps its value.

        Returns
        -------
        float

        Raises
        ------
        UsageError
            If the sample has no time.
        """
        made, t = self.estimator, float(sample.get("t", np.nan))
        if not np.isfinite(t):
            raise UsageError("a sample needs its time 't' in s, a finite number.")
        self._held |= {n: float(v) for n, v in sample.items() if np.isfinite(v)}
        columns = {n: np.array([v]) for n, v in self._held.items()}
        inputs = input_table(made.instruments, columns | {"t": np.array([t])}, "of samples")[0]
        if self._stepper is None:
            self._stepper = made.loop.one_at_a_time(made.carried(inputs), made.coefficients)
        if self.t is None or t > self.t:
            self._stepper.control[:-1] = inputs
            self._stepper.control[-1] = 0.0 if self.t is None else t - self.t
            self._stepper.step()
            self.t = t
        return float(self._stepper.out[0])

    def scale(self, kalman: ExtendedKalmanFilter, source: str = "wave_noise", least: float = 0.05) -> dict[str, float]:
        """Return what ``update(sample, scale=...)`` of an online filter takes; see `LevelRun.scale`.

        Parameters
        ----------
        kalman, source, least
            See `LevelRun.scale`.
        """
        value = 0.0 if self._stepper is None else float(self._stepper.out[0])
        return {source: float(factor_of(np.array(value), _given_level(kalman, source), least))}


def factor_of(level: np.ndarray, given: float, least: float) -> np.ndarray:
    """Return the factor that makes a given noise an estimated level; 1 while there is no estimate.

    Parameters
    ----------
    level : ndarray
        The estimate; 0 where there is none yet.
    given : float
        The noise the filter was given.
    least : float
        Smallest factor.
    """
    result: np.ndarray = np.where(level > 0, np.maximum(level / given, least), 1.0)
    return result


def _given_level(kalman: ExtendedKalmanFilter, source: str) -> float:
    levels = {s.name: s for s in kalman.design.sources}
    if source not in levels:
        raise UnknownNameError("noise of the filter called", source, levels)
    if levels[source].density:
        raise UsageError(
            f"the noise '{source}' of the filter is a density; a level is that of one sample. Give it per sample."
        )
    return levels[source].level


def _level_step(model: Model, level: str) -> CasadiFunction:
    """One sample: ``(states and last inputs, inputs and interval, coefficients) -> (..., level)``."""
    system = generate(model)
    step = make_step(system, "rk4", "linear").function
    x, last, now = system.x, ca.SX.sym("last", system.u.shape[0]), system.u
    following = step(x, last, now, system.p, system.T)
    shown = ca.substitute(system.expression([level]), x, following)
    return ca.Function(
        "level",
        [ca.vertcat(x, last), ca.vertcat(now, system.T), system.p],
        [ca.densify(ca.vertcat(following, now)), ca.densify(shown)],
    )
