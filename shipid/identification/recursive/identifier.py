"""The verb: a model and a record in, parameters along the record out; and the same for samples that arrive one by one."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.scale import prime_factor
from shipid.declaration.units import to_si
from shipid.estimation.errors import NoiseLevelError, NotMeasurableError
from shipid.estimation.records.arrangement import Arrangement, arrange, column_of
from shipid.estimation.records.vectors import columns_of
from shipid.estimation.settings.initial import parameter_starts, read_deviations
from shipid.estimation.settings.noise import process_sources
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.generation.loop import Loop, make_loop
from shipid.identification.recursive.errors import ForgettingError
from shipid.identification.recursive.methods import find_method
from shipid.identification.recursive.noise_level import noise_of, read_sensor
from shipid.identification.recursive.recursion import Layout, length, make_recursion
from shipid.identification.recursive.regression import Regression, make_regression
from shipid.identification.recursive.result import RecursiveIdentification
from shipid.parameters.catalogue import find_model, find_ship, whole_ship
from shipid.parameters.parameter_set import ParameterSet, missing_values
from shipid.trials.trial import Trial

Record = Trial | Mapping[str, np.ndarray]


@dataclass(frozen=True, eq=False)
class _Prepared:
    """A record as the loop takes it."""

    record: str
    arranged: Arrangement
    carried: np.ndarray
    control: np.ndarray
    constants: np.ndarray
    level: float


class RecursiveIdentifier:
    """One member of the family of recursive identification, for one state of a declared model.

    Parameters
    ----------
    model : Model, component class or str
        What is identified.
    ship : ParameterSet or str, optional
        Particulars, and coefficients that are known or where the search starts.
    method : str
        A key of `shipid.identification.recursive.methods.METHODS`.
    estimate : sequence of str, optional
        Parameters to estimate; by default all that are declared as estimated and enter the equation of the measured state.
    measured : mapping of str to str or None, optional
        The one measured state (or the output of a sensor that measures it), with the standard deviation of a sample:
        ``{"r": "0.02 deg/s"}``. With None the level comes from the record (`noise_of`).
    noise : mapping of str to str, optional
        What lets parameters wander, and what drives the measured state: per sample or per root second, as for a filter. What
        the declaration says holds where nothing is given, for the methods that believe noise levels.
    initial : mapping of str to str, optional
        Standard deviations of the first estimates, with units.
    start : mapping of str to str, optional
        First estimates, with units; otherwise the ship's values, then the declared ones; of the state the first sample.
    inputs : mapping of str to str, optional
        Constant inputs with units, such as the cruising speed.
    forgetting : float
        Factor on the weight of what is a sample older, for the methods that forget; 1 forgets nothing.
    integration, hold : str
        See `shipid.generation.step.make_step`.
    compiled : bool
        Whether to compile.

    Attributes
    ----------
    regression : Regression
        What is predicted, from what.

    Raises
    ------
    ShipidError
        For names, units and levels that do not fit, and for parameters that enter nonlinearly.

    Notes
    -----
    A first uncertainty is best about as large as the distance to the truth may be. Much larger, the extended Kalman filter
    loses its way now and then; least squares and MRAS do not mind (``studies/passenier_ch4.py`` counts both).
    """

    def __init__(
        self,
        model: Model | str | Any,
        ship: ParameterSet | str | None = None,
        *,
        method: str = "combined",
        estimate: Sequence[str] | None = None,
        measured: Mapping[str, str | float | None] | None = None,
        noise: Mapping[str, str | float] | None = None,
        initial: Mapping[str, str | float] | None = None,
        start: Mapping[str, str | float] | None = None,
        inputs: Mapping[str, str | float] | None = None,
        forgetting: float = 1.0,
        integration: str = "rk4",
        hold: str = "linear",
        compiled: bool = True,
    ) -> None:
        self.method = find_method(method)
        if not 0 < forgetting <= 1:
            raise ForgettingError(
                f"a forgetting factor lies above 0 and is at most 1 (0.995, say), and got {forgetting:g}."
            )
        if forgetting != 1 and not self.method.forgets:
            raise ForgettingError(
                f"method {method} takes no forgetting factor: parameters that wander are let do so by noise, as in "
                "noise={'a': '0.001'}."
            )
        whole = (
            find_model(model) if isinstance(model, str) else model if isinstance(model, Model) else whole_ship(model)
        )
        self.ship = find_ship(ship) if isinstance(ship, str) else ship or ParameterSet("unnamed")
        sensor, level, output = read_sensor(whole, measured)
        self.regression: Regression = make_regression(
            whole, output, estimate, linear=self.method.linear, integration=integration, hold=hold
        )
        self.model, self.names, self.output = whole, self.regression.names, self.regression.output
        self.sensor: str = sensor or self.output
        self._level = level
        self.forgetting, self.compiled = float(forgetting), compiled
        length_, speed = (self.ship.particular(*n) for n in (("L", "m"), ("speed", "m/s")))
        self._read(noise or {}, initial or {}, dict(start or {}), length_, speed)
        self.inputs = {n: to_si(v, whole[n].unit, f"input '{n}'") for n, v in (inputs or {}).items()}
        system = self.regression.system
        self.layout = Layout(len(self.names), system.u.shape[0], system.p.shape[0])

    def __hash__(self) -> int:
        return id(self)

    def __repr__(self) -> str:
        return (
            f"<{self.method.name} of {', '.join(self.names)} in the equation of '{self.output}' of {self.model.name!r}, "
            f"ship {self.ship.name}>"
        )

    def _read(
        self,
        noise: Mapping[str, str | float],
        initial: Mapping[str, str | float],
        start: dict[str, str | float],
        ship_length: float | None,
        speed: float | None,
    ) -> None:
        model, system = self.model, self.regression.system
        known = self.ship.values(model, speed=speed)
        for name in start:
            if name not in (self.output, *self.names):
                raise UnknownNameError(f"first estimate of model {model.name} called", name, (self.output, *self.names))
        given = start.pop(self.output, None)
        self._first = None if given is None else to_si(given, model[self.output].unit, f"start of '{self.output}'")
        starts = parameter_starts(model, self.names, self.ship, known, start, ship_length, speed)
        own = {n: n for n in self.names}
        deviations = {n: s for n, (_, s) in starts.items()} | read_deviations(system.model, initial, own)
        self._theta = np.array([starts[n][0] for n in self.names])
        self._deviation = np.array([deviations[n] for n in self.names])
        self._output_deviation = deviations.get(self.output)
        if self.method.believes_noise:
            declared = {n: model[n].quantity.noise for n in (self.output, *self.names)}
            noise = {n: q for n, q in declared.items() if q} | dict(noise)
        sources = process_sources(system.model, noise, own, {}, ship_length, speed, model_noise=False)
        order = [self.output, *self.names]
        self._q, self._q_density = np.zeros(len(order)), np.zeros(len(order))
        for s in sources:
            if s.place != "state":
                raise UsageError(
                    f"noise is given for the input '{s.name}'. A recursion takes it on the measured state '{self.output}' and on "
                    "the parameters; for noisy inputs take the extended Kalman filter."
                )
            (self._q_density if s.density else self._q)[order.index(s.name)] += s.level**2
        lacking = [n for n in self.regression.coefficients if n not in known]
        if lacking:
            rest = {n: 0.0 for n in model.parameters + model.constants if n not in lacking}
            error = missing_values(model, rest, f"ship {self.ship.name}")
            assert error is not None
            raise error
        self.known = {n: v for n, v in known.items() if n not in self.names}
        self._scale = (ship_length, speed)
        # What the equation does not read may stay unknown.
        self._p = system.vector(system.coefficients, self.known, default=0.0)

    def bound(self, name: str, side: str) -> float | None:
        """Return the lower or upper bound a parameter is declared with, SI; None where there is none.

        Parameters
        ----------
        name : str
            The parameter.
        side : {"low", "high"}
            Which.
        """
        entry = self.model[name]
        bound = entry.number(side)
        if bound is None or not entry.quantity.prime:
            return bound
        length_, speed = self._scale
        return bound * prime_factor(entry.unit, length_, speed) if length_ and speed else None

    @functools.cached_property
    def loop(self) -> Loop:
        """The recursion with the loop over samples, compiled once."""
        return make_loop(make_recursion(self.regression, self.method, self.layout), self.compiled)

    def constants(self, level: float) -> np.ndarray:
        """Return coefficients, noise, first uncertainty, forgetting and start in the order the recursion takes them.

        Parameters
        ----------
        level : float
            Standard deviation of a sample of the measured state, SI.
        """
        return np.concatenate(
            [self._p, self._q, self._q_density, self._first_gain, [level**2, self.forgetting, self.starts_at_sample]]
        )

    def carried(self, first: float, inputs: np.ndarray, level: float) -> np.ndarray:
        """Return what is carried into the first sample.

        Parameters
        ----------
        first : float
            First sample of the measured state, SI.
        inputs : ndarray, shape (inputs,)
            The inputs there.
        level : float
            Standard deviation of a sample of the measured state, SI.
        """
        z, places, n = np.zeros(length(self.layout.carried)), self.layout.carried, self.layout.n
        own = level if self._output_deviation is None else self._output_deviation
        z[places["y"]] = z[places["y_aux"]] = first if self._first is None else self._first
        z[places["theta"]] = z[places["theta_aux"]] = self._theta
        z[places["u"]] = inputs
        z[places["P"]] = np.diag(self._first_gain).ravel()
        z[places["P_y"]] = own**2
        diagonal = np.cumsum(np.arange(1, n + 2)) - 1
        z[places["joint"]][diagonal] = np.concatenate([[own**2], self._deviation**2])
        return z

    @property
    def _first_gain(self) -> np.ndarray:
        """First variances of the parameters as the gains count them."""
        return self._deviation**2 * self.method.first_factor

    @property
    def starts_at_sample(self) -> bool:
        """Whether the first sample is where the state starts; it then tells nothing else."""
        return self._first is None

    def level_of(self, sensor: np.ndarray | None = None) -> float:
        """Return the noise level of the measured state, SI: as given, or from a record of it.

        Parameters
        ----------
        sensor : ndarray, optional
            The record.

        Raises
        ------
        NoiseLevelError
            If it is not given and there is no record.
        """
        if self._level is not None:
            return self._level
        if sensor is None:
            unit = self.model[self.output].unit.replace("rad", "deg")
            raise NoiseLevelError(
                f"samples of '{self.sensor}' that arrive one by one do not say how noisy they are: give the standard deviation "
                f"of one, as in measured={{'{self.sensor}': '0.02 {unit}'}}."
            )
        return noise_of(sensor)

    def _prepare(self, record: Record) -> _Prepared:
        columns, name = columns_of(record)
        model = self.regression.system.model
        arranged = arrange(model, columns, name, (self.sensor,), self.inputs, self.regression.needed, {}, {})
        there = np.flatnonzero(arranged.there[:, 0])
        if not there.size:
            column = column_of(model, self.sensor, columns)
            raise NotMeasurableError(f"column '{column}' of record {name} holds no sample that is a number.")
        level = self.level_of(arranged.z[there, 0])
        control = np.zeros((arranged.t.size, length(self.layout.control)))
        places = self.layout.control
        control[:, places["u"]] = arranged.inputs
        control[:, places["T"]] = arranged.intervals[:, None]
        control[:, places["z"]] = arranged.z
        control[:, places["there"]] = arranged.there
        carried = self.carried(float(arranged.z[there[0], 0]), arranged.inputs[0], level)
        return _Prepared(name, arranged, carried, control, self.constants(level), level)

    def identify(self, record: Record) -> RecursiveIdentification:
        """Run a whole record.

        Parameters
        ----------
        record : Trial or mapping of str to ndarray
            SI columns with ``t``; a mapping may hold NaN where a sample is missing.

        Returns
        -------
        RecursiveIdentification

        Raises
        ------
        NotMeasurableError
            If the record lacks the measured state or an input.
        """
        return self.identify_all([record])[0]

    def identify_all(self, records: Sequence[Record], threads: int | None = None) -> list[RecursiveIdentification]:
        """Run many records side by side.

        Parameters
        ----------
        records : sequence of Trial or mapping
            As for `identify`; each starts anew.
        threads : int, optional
            How many; by default one for each processor.
        """
        made = [self._prepare(r) for r in records]
        done = self.loop.map([m.carried for m in made], [m.control for m in made], [m.constants for m in made], threads)
        return [RecursiveIdentification(self, m.record, m.arranged, m.level, out) for m, (_, out) in zip(made, done)]

    def start(self) -> Any:
        """Return the recursion for samples that arrive one by one; see `shipid.identification.recursive.online`."""
        from shipid.identification.recursive.online import OnlineIdentifier

        return OnlineIdentifier(self)

    def restore(self, path: str | Path) -> Any:
        """Return an online recursion as `OnlineIdentifier.save` left it.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        SavedStateError
            If the file cannot be read, or belongs to another recursion.
        """
        from shipid.identification.recursive.online import OnlineIdentifier

        return OnlineIdentifier.restored(self, Path(path))


def identify_recursively(
    model: Model | str | Any,
    trial: Record | Sequence[Record],
    *,
    method: str = "combined",
    ship: ParameterSet | str | None = None,
    **options: Any,
) -> RecursiveIdentification | list[RecursiveIdentification]:
    """Identify parameters sample by sample.

    Parameters
    ----------
    model : Model, component class or str
        What is identified; one state of it, linear in the parameters.
    trial : Trial, mapping, or a sequence of them
        Records of that state and of what its equation reads.
    method : str
        ``"ekf"``, ``"rls"``, ``"series-parallel"``, ``"mras-parallel"``, ``"minimum-variance"``, ``"combined"``,
        ``"combined-heuristic"`` or ``"instrumental-variables"``.
    ship : ParameterSet or str, optional
        Particulars, and coefficients that are known or where the search starts.
    **options
        See `RecursiveIdentifier`.

    Returns
    -------
    RecursiveIdentification
        Or a list of them for a sequence of records.
    """
    identifier = RecursiveIdentifier(model, ship, method=method, **options)
    if isinstance(trial, Trial | Mapping):
        return identifier.identify(trial)
    return identifier.identify_all(list(trial))
