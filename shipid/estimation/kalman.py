"""The extended Kalman filter of a declared model: a list of sensors is all it takes."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from shipid.declaration.augment import augment
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.estimation.errors import FilterDivergedError
from shipid.estimation.records.arrangement import Arrangement, arrange
from shipid.estimation.records.run import FilterRun
from shipid.estimation.records.vectors import carried_vector, columns_of, controls_of, first_sample
from shipid.estimation.recursion.equations import make_equations
from shipid.estimation.recursion.step import FORMS, Gate, Layout, make_filter_step
from shipid.estimation.settings.initial import bounds_of, parameter_starts, read_deviations, walking
from shipid.estimation.settings.noise import Source, process_sources, sensor_levels
from shipid.estimation.settings.sensors import read_inputs, read_lost, read_ranges, read_rates
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.generation.loop import Loop, make_loop
from shipid.parameters.catalogue import find_ship, whole_ship
from shipid.parameters.parameter_set import ParameterSet, missing_values
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    from shipid.estimation.records.likelihood import Likelihood


class ExtendedKalmanFilter:
    """An extended Kalman filter, generated from a model with exact Jacobians.

    The state is predicted by the model's own generated step and linearised at the estimate after the last sample; sensors
    are linearised at the predicted state and taken one after the other. A model that is linear in its states runs through
    the same code, which is then the plain Kalman filter (`linear`).

    Parameters
    ----------
    model : Model or component class
        The ship. What a sensor shows is a state, a derived quantity, or the output of a sensor component.
    ship : ParameterSet or str, optional
        Coefficients and particulars.
    values : mapping of str to float, optional
        Coefficients that go before the ship's, SI: those of a fit.
    measured : mapping of str to str or None, optional
        Standard deviation of one sample of each sensor, with units: ``{"psi": "0.2 deg"}``; None takes what a declared
        output says. By default every declared output.
    estimated : sequence of str, optional
        Parameters that walk at random, positive ones by their logarithm; by default those that declare how.
    noise : mapping of str to str, optional
        What drives states, inputs and estimated parameters. In the quantity's own unit it is the standard deviation of one
        sample; per root second (``"0.01 deg/s^1.5"`` on a rate of turn) a density, of an input times root second. What the
        declaration says holds where nothing is given.
    initial : mapping of str to str, optional
        Standard deviations of the first estimates, with units.
    start : mapping of str to str, optional
        First estimates of states and parameters, with units; otherwise the first samples and the ship's values.
    rates : mapping of str to str, optional
        How often a sensor is read, ``"2 s"`` or ``"0.5 Hz"``, where it is less often than the record is sampled.
    inputs : mapping of str to str, optional
        Constant inputs with units, such as the cruising speed.
    lost : mapping of str to str, optional
        Standard deviation of an input while it is missing; its last value stands in.
    ranges : mapping of str to tuple of str, optional
        Smallest and largest value a sensor can show, with units; samples outside are left out and counted.
    gate : float or None
        Samples whose innovation exceeds so many standard deviations are rejected and counted; None takes in all.
    patience : str
        After so long a sensor that keeps being rejected, and whose value changes, is believed again.
    log : sequence of str, optional
        Which estimated parameters are positive and estimated by their logarithm; by default those whose lower bound is
        zero or more. ``()`` estimates all as they are, within their declared bounds.
    shared_noise : bool
        Whether noise of an input that a sensor shows as well is one noise for both (exact), or counted as two that know
        nothing of each other.
    model_noise : bool
        Whether states that nothing drives get a small default noise: no model of low order is exact.
    switchable : bool
        Whether adaptation can be switched off sample by sample (`filter`, `update`). The gain is then not the optimal
        one, and the covariance takes Joseph's form.
    method, hold, substeps
        Integration of the model, see `shipid.generation.step.make_step`.
    form : {"covariance", "square-root"}
        What is carried; the square root stays positive in single precision.
    compiled, single : bool
        Whether to compile, and whether to compute in single precision.

    Attributes
    ----------
    parameters : mapping of str to str
        The state of each estimated parameter.

    Raises
    ------
    ShipidError
        For names, units and levels that do not fit.

    Notes
    -----
    Gelb (1974), sections 4.2 and 6.1; sequential updates: Bierman (1977), chapter II.
    """

    def __init__(
        self,
        model: Model | Any,
        ship: ParameterSet | str | None = None,
        *,
        values: Mapping[str, float] | None = None,
        measured: Mapping[str, Any] | None = None,
        estimated: Sequence[str] | None = None,
        noise: Mapping[str, Any] | None = None,
        initial: Mapping[str, str | float] | None = None,
        start: Mapping[str, str | float] | None = None,
        rates: Mapping[str, str | float] | None = None,
        inputs: Mapping[str, str | float] | None = None,
        lost: Mapping[str, str | float] | None = None,
        ranges: Mapping[str, tuple[str, str]] | None = None,
        gate: float | None = 5.0,
        patience: str = "10 s",
        log: Sequence[str] | None = None,
        shared_noise: bool = True,
        model_noise: bool = True,
        switchable: bool = False,
        method: str = "rk4",
        hold: str = "linear",
        substeps: int = 1,
        form: str = "covariance",
        compiled: bool = True,
        single: bool = False,
    ) -> None:
        if form not in FORMS:
            raise UnknownNameError("form of the filter", form, FORMS)
        if switchable and form != "covariance":
            raise UsageError("adaptation that can be switched off needs the covariance form.")
        if gate is not None and not gate > 0:
            raise UsageError(
                f"a gate of {gate:g} standard deviations lets nothing in; give one greater than zero, or None."
            )
        self.base = model if isinstance(model, Model) else whole_ship(model)
        self.ship = find_ship(ship) if isinstance(ship, str) else ship or ParameterSet("unnamed")
        estimated = walking(self.base) if estimated is None else estimated
        self.model = augment(self.base, estimated, log) if estimated else self.base
        self.parameters = {n: n if n in self.model.states else f"log_{n}" for n in estimated}
        self._speed, self._length = (self.ship.particular(*n) for n in (("speed", "m/s"), ("L", "m")))
        measured = measured if measured is not None else {n: None for n in self.model.outputs}
        levels = sensor_levels(self.model, measured)
        self.measured = tuple(levels)

        known = self.ship.values(self.base, speed=self._speed) | dict(values or {})
        starts = dict(start or {})
        self._given_starts = self._read_starts({n: v for n, v in starts.items() if n not in estimated})
        self._estimates = parameter_starts(
            self.base, tuple(estimated), self.ship, known, starts, self._length, self._speed, initial or {}
        )
        in_log = {n: self._estimates[n][0] for n, s in self.parameters.items() if s != n}
        self.lost = read_lost(self.model, lost or {})
        declared = {
            n: e.quantity.noise
            for n, e in self.model.entries.items()
            if e.quantity.noise and e.quantity.kind in ("state", "given") and n not in (noise or {})
        }
        declared |= {n: q for n in estimated if (q := self.base[n].quantity.noise) and n not in (noise or {})}
        self.sources = process_sources(
            self.model, {**declared, **(noise or {})}, self.parameters, in_log, self._length, self._speed, model_noise
        )
        driven = {s.name for s in self.sources}
        self.sources += tuple(Source(n, v, "input", False) for n, v in self.lost.items() if n not in driven)

        self.equations = make_equations(self.model, self.measured, self.sources, method, hold, substeps, shared_noise)
        self.system = self.equations.system
        held = {n: v for n, v in known.items() if n not in estimated}
        held |= {n: 1.0 for n in self.model.constants if n.startswith("unit_") and n not in held}
        lacking = missing_values(self.model, held, f"ship {self.ship.name}")
        if lacking:
            raise lacking
        self._p = self.system.vector(self.system.coefficients, held)
        self._q = np.array([s.level for s in self.sources])
        self._r = np.array(list(levels.values()))
        self._deviations = read_deviations(self.model, initial or {}, self.parameters)
        self.rates = read_rates(self.model, self.measured, rates or {})
        self.inputs = read_inputs(self.model, inputs or {})
        self.ranges = read_ranges(self.model, self.measured, ranges or {})
        self.gate = None if gate is None else Gate(gate, to_si(patience, "s", "the patience"))
        if self.gate is not None and self.gate.patience < 0:
            raise UsageError(f"a patience of {patience} is over before it begins; give '0 s' or more.")
        self.form, self.switchable, self.compiled, self.single = form, switchable, compiled, single
        self.layout = Layout(self.equations, form, self.gate is not None, switchable)
        self._integration = (method, hold, substeps, shared_noise)
        self._loops: dict[tuple[bool, bool], Loop] = {}

    def __hash__(self) -> int:
        return id(self)

    def __repr__(self) -> str:
        kind = "Kalman filter" if self.linear else "extended Kalman filter"
        sensors = ", ".join(f"{n} ({level:.3g} {self.model[n].unit})" for n, level in zip(self.measured, self._r))
        driven = ", ".join(f"{s.name}{' (default)' if s.assumed else ''}" for s in self.sources) or "nothing"
        return (
            f"<{kind} of {self.base.name!r}, ship {self.ship.name}: states {', '.join(self.model.states)}; sensors {sensors}; "
            f"noise on {driven}>"
        )

    @property
    def linear(self) -> bool:
        """Whether neither Jacobian depends on the estimate: then this is the plain Kalman filter, and exact."""
        return self.equations.linear

    @property
    def wraps(self) -> np.ndarray:
        """Which sensors show an angle that wraps, shape (sensors,)."""
        shown = (self.model[self.model[n].quantity.measures or n] for n in self.measured)
        return np.array([e.quantity.wraps for e in shown], dtype=bool)

    @functools.cached_property
    def adapting(self) -> np.ndarray | None:
        """Which states stop where adaptation is switched off; None where it cannot be."""
        return ~self.leaping if self.switchable else None

    @functools.cached_property
    def leaping(self) -> np.ndarray:
        """Which states leap to a sensor that insists on something else: all but parameters, shape (states,)."""
        return np.array([s not in self.parameters.values() for s in self.model.states])

    def step(self, full: bool = False, gated: bool = True) -> Any:
        """Return the generated step ``(carried, control, constants) -> (carried, outputs)``; see `shipid.estimation.recursion.step`.

        Parameters
        ----------
        full : bool
            Whether it returns covariances and predicted values as well.
        gated : bool
            Whether samples are judged, where the filter has a gate.
        """
        gate = self.gate if gated else None
        return make_filter_step(
            self.equations,
            Layout(self.equations, self.form, gate is not None, self.switchable),
            self.form,
            gate,
            self.wraps,
            *bounds_of(self.base, self.model, self.parameters, self._length, self._speed),
            self.adapting,
            self.leaping,
            full,
        )

    def loop(self, full: bool = False, gated: bool = True) -> Loop:
        """Return the step with the loop over samples, compiled once.

        Parameters
        ----------
        full, gated : bool
            See `step`.
        """
        if (full, gated) not in self._loops:
            self._loops[full, gated] = make_loop(self.step(full, gated), self.compiled, self.single)
        return self._loops[full, gated]

    @functools.cached_property
    def backward(self) -> Loop:
        """The backward recursion of the smoother, compiled once."""
        from shipid.estimation.records.smoother import make_backward

        return make_backward(self)

    @functools.cached_property
    def gramian(self) -> Loop:
        """The loop that adds up what the samples tell of the first state, compiled once."""
        from shipid.estimation.records.observability import make_gramian

        return make_gramian(self)

    @property
    def constants(self) -> np.ndarray:
        """Coefficients, noise levels and sensor levels, SI, in the order the step takes them."""
        return np.concatenate([self._p, self._q, self._r])

    def _read_starts(self, given: Mapping[str, str | float]) -> dict[str, float]:
        for name in given:
            if name not in self.model.states:
                raise UnknownNameError(
                    f"state of model {self.model.name} to start called", name, [*self.model.states, *self.parameters]
                )
        return {n: to_si(v, self.model[n].unit, f"start of '{n}'") for n, v in given.items()}

    def arrangement(self, record: Trial | Mapping[str, np.ndarray]) -> Arrangement:
        """Return a record as the filter takes it.

        Parameters
        ----------
        record : Trial or mapping of str to ndarray
            SI columns with ``t``; a mapping may hold NaN where a sample is missing.
        """
        columns, name = columns_of(record)
        fixed = (self.measured, self.inputs, self.needed_inputs, self.rates, self.ranges, self._speed)
        return arrange(self.model, columns, name, *fixed)

    @functools.cached_property
    def needed_inputs(self) -> tuple[str, ...]:
        """Inputs that have an influence on the states and the sensors."""
        return self.system.inputs_behind([*self.model.states, *self.measured])

    def filter(
        self,
        record: Trial | Mapping[str, np.ndarray],
        *,
        adapt: np.ndarray | bool = True,
        scale: Mapping[str, np.ndarray | float] | None = None,
    ) -> FilterRun:
        """Filter a whole record.

        Parameters
        ----------
        record : Trial or mapping of str to ndarray
            SI columns with ``t``; a mapping may hold NaN where a sample is missing.
        adapt : bool or ndarray of bool, shape (samples,)
            Where parameters adapt (needs ``switchable=True``).
        scale : mapping of str to float or ndarray, optional
            Factors on the noise of states and inputs, for every sample.

        Returns
        -------
        FilterRun

        Raises
        ------
        FilterDivergedError
            If the estimate runs away.
        NotMeasurableError
            If the record lacks a sensor or an input.
        """
        if adapt is not True and not self.switchable:
            raise UsageError("adaptation is to be switched off, and the filter was made without switchable=True.")
        arranged = self.arrangement(record)
        control = controls_of(self, arranged, adapt, scale)
        z0 = carried_vector(self, first_sample(self, record), arranged.inputs[0])
        _, out = self.loop(full=True)(z0, control, self.constants)
        self._check_finite(out, arranged)
        return FilterRun(self, columns_of(record)[1], arranged, control, z0, np.asarray(out, dtype=float))

    def _check_finite(self, out: np.ndarray, arranged: Arrangement) -> None:
        good = np.isfinite(out[:, : self.layout.full["var"].stop]).all(axis=1)
        if not good.all():
            raise FilterDivergedError(
                f"the filter of model {self.base.name} runs away {arranged.t[np.argmin(good)]:.5g} s into the record. Start "
                "nearer to the truth (start, initial), let the states be driven by more noise, or estimate fewer parameters."
            )

    def likelihood(self, record: Trial | Mapping[str, np.ndarray], unknowns: Sequence[str]) -> Likelihood:
        """Return the likelihood of a record as a function of unknowns, with its exact gradient.

        Parameters
        ----------
        record : Trial or mapping of str to ndarray
            What was measured.
        unknowns : sequence of str
            Coefficients by name, ``noise:NAME`` and ``sensor:NAME`` (logarithms of levels), ``x0:STATE``, ``bias:INPUT``.
        """
        from shipid.estimation.records.likelihood import make_likelihood

        return make_likelihood(self, record, unknowns)

    def start(self, lag: str | float | None = None) -> Any:
        """Return the filter for samples that arrive one by one.

        Parameters
        ----------
        lag : str, optional
            Fixed lag, ``"10 s"``: estimates so long ago are smoothed by what came since.

        Returns
        -------
        OnlineFilter
            With ``update(sample)``; see `shipid.estimation.online.online_filter`.
        """
        from shipid.estimation.online.online_filter import OnlineFilter

        return OnlineFilter(self, None if lag is None else to_si(lag, "s", "the lag"))

    def restore(self, path: str | Path) -> Any:
        """Return an online filter as `OnlineFilter.save` left it.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        SavedStateError
            If the file cannot be read, or belongs to a filter of another model, with other sensors or noise.
        """
        from shipid.estimation.online.saving import restore_state

        return restore_state(self, Path(path))
