"""The design of a filter: its settings, read and checked once, and the functions that are generated from them.

A design never changes. The filter, its results, the smoother, the likelihood and the saved state of an online filter all
read it.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.delays import delays_in, refuse_estimated_delay
from shipid.declaration.joining.augment import augment
from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import shown
from shipid.estimation.recursion.backward import make_backward_step
from shipid.estimation.recursion.equations import Equations, make_equations
from shipid.estimation.recursion.gate import Gate
from shipid.estimation.recursion.gramian import make_gramian_step
from shipid.estimation.recursion.layout import FORMS, Form, StepLayout, StepSettings
from shipid.estimation.recursion.quantity import make_quantity
from shipid.estimation.recursion.score import Unknown, bare, make_score_step
from shipid.estimation.recursion.step import make_filter_step
from shipid.estimation.settings.initial import (
    FirstEstimates,
    drifting,
    log_scaled,
    parameter_starts,
    read_deviations,
    read_states,
    state_bounds,
)
from shipid.estimation.settings.instruments import (
    Amount,
    Instruments,
    read_inputs,
    read_lost,
    read_ranges,
    read_rates,
)
from shipid.estimation.settings.noise import NoiseSource, declared_noise, process_sources, sensor_levels
from shipid.foundation.aliases import CasadiFunction
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.generation.loop import Loop, make_loop
from shipid.generation.system import System
from shipid.parameters.catalogue import model_of, ship_of
from shipid.parameters.parameter_set import ParameterSet, missing_values


@dataclass(frozen=True)
class FilterSettings:
    """The settings of a filter; `shipid.estimation.kalman.ExtendedKalmanFilter` explains each of them.

    Attributes
    ----------
    values, measured, estimated, noise, initial, start, rates, inputs, lost, ranges, gate, patience, log
        Coefficients, sensors, estimated parameters, noise, first estimates, and the treatment of samples.
    shared_noise, model_noise, switchable : bool
        How noise of inputs, of the model and of held parameters is taken.
    method, hold, substeps, form, compiled, single
        How it is computed.
    """

    values: Mapping[str, float] | None = None
    measured: Mapping[str, Amount | None] | None = None
    estimated: Sequence[str] | None = None
    noise: Mapping[str, Amount] | None = None
    initial: Mapping[str, Amount] | None = None
    start: Mapping[str, Amount] | None = None
    rates: Mapping[str, Amount] | None = None
    inputs: Mapping[str, Amount] | None = None
    lost: Mapping[str, Amount] | None = None
    ranges: Mapping[str, tuple[Amount, Amount]] | None = None
    gate: float | None = 5.0
    patience: Amount = "10 s"
    log: Sequence[str] | None = None
    shared_noise: bool = True
    model_noise: bool = True
    switchable: bool = False
    method: str = "rk4"
    hold: str = "linear"
    substeps: int = 1
    form: Form = "covariance"
    compiled: bool = True
    single: bool = False


@dataclass(frozen=True, eq=False, repr=False)
class FilterDesign:
    """A filter as its settings define it, SI; made by `design_filter`.

    Attributes
    ----------
    base, model : Model
        The ship without and with the estimated parameters among its states.
    ship : ParameterSet
        Its coefficients and particulars.
    parameters : mapping of str to str
        The state of each estimated parameter: its own name, or ``log_NAME`` where its logarithm is estimated.
    instruments : Instruments
        Sensors and inputs.
    sources : tuple of NoiseSource
        The noise of states and inputs.
    first : FirstEstimates
        First estimates of states and parameters.
    equations : Equations
        One sampling interval as expressions.
    step_settings : StepSettings
        What the generated step does.
    p, q, r : ndarray
        Coefficients, noise levels and sensor levels, in the order the step takes them.
    integration : tuple
        Method, hold, substeps, and whether noise that sensors show is shared.
    compiled, single : bool
        Whether to compile, and whether to compute in single precision.
    """

    base: Model
    model: Model
    ship: ParameterSet
    parameters: Mapping[str, str]
    instruments: Instruments
    sources: tuple[NoiseSource, ...]
    first: FirstEstimates
    equations: Equations
    step_settings: StepSettings
    p: np.ndarray
    q: np.ndarray
    r: np.ndarray
    integration: tuple[str, str, int, bool]
    compiled: bool
    single: bool
    _loops: dict[object, Loop] = field(default_factory=dict)
    _quantities: dict[str, CasadiFunction] = field(default_factory=dict)

    def __repr__(self) -> str:
        kind = "Kalman filter" if self.linear else "extended Kalman filter"
        sensors = ", ".join(
            f"{n} ({shown(level, self.model[n].quantity.measures or n, self.model[n].unit, digits=3)})"
            for n, level in zip(self.measured, self.r)
        )
        driven = ", ".join(f"{s.name}{' (default)' if s.assumed else ''}" for s in self.sources) or "nothing"
        return (
            f"<{kind} of {self.base.name!r}, ship {self.ship.name}: states {', '.join(self.model.states)}; sensors {sensors}; "
            f"noise on {driven}>"
        )

    @property
    def measured(self) -> tuple[str, ...]:
        """The measured quantities, in the order of the sensors."""
        return self.instruments.sensors

    @property
    def system(self) -> System:
        """The equations of the model with the estimated parameters among its states."""
        return self.equations.system

    @functools.cached_property
    def linear(self) -> bool:
        """Whether neither Jacobian depends on the estimate: then this is the plain Kalman filter, and exact."""
        return self.equations.linear

    @functools.cached_property
    def layout(self) -> StepLayout:
        """Where everything stands in the vectors of the step."""
        return StepLayout(self.equations, self.step_settings)

    @property
    def gate(self) -> Gate | None:
        """When samples are rejected; None where every sample is accepted."""
        return self.step_settings.gate

    @property
    def form(self) -> Form:
        """The form in which the covariance is carried."""
        return self.step_settings.form

    @property
    def switchable(self) -> bool:
        """Whether adaptation can be switched off sample by sample."""
        return self.step_settings.switchable

    @functools.cached_property
    def constants(self) -> np.ndarray:
        """Coefficients, noise levels and sensor levels, SI, in the order the step takes them."""
        return np.concatenate([self.p, self.q, self.r])

    def step(self, full: bool = False, gated: bool = True) -> CasadiFunction:
        """Return the generated step ``(carried, control, constants) -> (carried, outputs)``.

        Parameters
        ----------
        full : bool
            Whether it returns covariances and predicted values as well.
        gated : bool
            Whether samples pass the gate, where the filter has one.
        """
        settings = self.step_settings if gated else replace(self.step_settings, gate=None)
        return make_filter_step(self.equations, settings, full)

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

    def quantity(self, name: str) -> CasadiFunction:
        """Return the generated function of a quantity and its variance, see `shipid.estimation.recursion.quantity`.

        Parameters
        ----------
        name : str
            A state, input, parameter, derived quantity or sensor.
        """
        if name not in self._quantities:
            self._quantities[name] = make_quantity(self.equations, name)
        return self._quantities[name]

    @functools.cached_property
    def backward(self) -> Loop:
        """The backward recursion of the smoother, compiled once."""
        return make_loop(make_backward_step(self.equations, self.step_settings), self.compiled)

    @functools.cached_property
    def gramian(self) -> Loop:
        """The loop that sums the observability Gramian, compiled once."""
        return make_loop(make_gramian_step(self.equations), self.compiled)

    def score(self, unknowns: tuple[Unknown, ...], innovations: bool = False) -> Loop:
        """Return the loop of the likelihood with its derivatives, compiled once for each choice of unknowns.

        Parameters
        ----------
        unknowns : tuple of Unknown
            What the likelihood is differentiated by.
        innovations : bool
            Whether it returns the innovations and their derivatives.
        """
        key = (unknowns, innovations)
        if key not in self._loops:
            step = make_score_step(self.equations, bare(self.step_settings), unknowns, innovations)
            self._loops[key] = make_loop(step, self.compiled)
        return self._loops[key]

    @functools.cached_property
    def fingerprint(self) -> str:
        """A hash of all that two filters must have in common to be the same."""
        settings, instruments = self.step_settings, self.instruments
        parts = (
            self.system.digest,
            self.measured,
            self.sources,
            [float(v).hex() for v in self.constants],
            settings.form,
            settings.gate,
            settings.switchable,
            self.single,
            self.integration,
            sorted(self.parameters.items()),
            *(
                sorted(each.items())
                for each in (
                    instruments.rates,
                    instruments.ranges,
                    instruments.inputs,
                    instruments.lost,
                    instruments.biases,
                )
            ),
        )
        return hashlib.sha256(repr(parts).encode()).hexdigest()


def design_filter(
    model: Model | type[Component] | str,
    ship: ParameterSet | str | None = None,
    settings: FilterSettings | None = None,
) -> FilterDesign:
    """Return the design of an extended Kalman filter.

    Parameters
    ----------
    model : Model, component class or str
        The ship.
    ship : ParameterSet or str, optional
        Coefficients and particulars.
    settings : FilterSettings, optional
        Sensors, noise and options.

    Returns
    -------
    FilterDesign

    Raises
    ------
    ShipidError
        For names, units and levels that do not fit.
    UnknownNameError
        If there is no such form of the covariance.
    UsageError
        If gate, patience or form do not fit.
    """
    given = settings or FilterSettings()
    gate = _gate(given)
    base, ship = model_of(model), ship_of(ship)
    estimated = drifting(base) if given.estimated is None else given.estimated
    refuse_estimated_delay(base, estimated, "A filter")
    scale = Scale(ship.particular("L", "m"), ship.particular("speed", "m/s"))
    known = ship.values(base, speed=scale.speed) | dict(given.values or {})
    initial, starts = given.initial or {}, dict(given.start or {})
    begin = parameter_starts(base, tuple(estimated), ship, known, starts, scale, initial)
    whole = augment(base, estimated, log_scaled(base, begin, given.log)) if estimated else base
    parameters = {n: n if n in whole.states else f"log_{n}" for n in estimated}
    levels = sensor_levels(whole, given.measured if given.measured is not None else dict.fromkeys(whole.outputs))
    states = read_states(whole, {n: v for n, v in starts.items() if n not in estimated}, parameters)
    first = FirstEstimates(
        states,
        begin,
        read_deviations(whole, initial, parameters),
    )
    lost = read_lost(whole, given.lost or {})
    noise = dict(given.noise or {})
    noise = {n: q for n, q in declared_noise(base, whole, parameters).items() if n not in noise} | noise
    in_log = {n: first.parameters[n][0] for n, s in parameters.items() if s != n}
    sources = process_sources(whole, noise, parameters, in_log, scale, given.model_noise, lost)
    equations = make_equations(
        whole, tuple(levels), sources, given.method, given.hold, given.substeps, given.shared_noise
    )
    system = equations.system
    held = {n: v for n, v in known.items() if n not in estimated}
    held |= {n: 1.0 for n in whole.constants if n.startswith("unit_") and n not in held}
    lacking = missing_values(whole, held, f"ship {ship.name}")
    if lacking:
        raise lacking
    shown = [whole[whole[n].quantity.measures or n] for n in levels]
    return FilterDesign(
        base,
        whole,
        ship,
        parameters,
        Instruments(
            whole,
            tuple(levels),
            system.inputs_behind([*whole.states, *levels]),
            read_inputs(whole, given.inputs or {}),
            read_rates(tuple(levels), given.rates or {}),
            read_ranges(whole, tuple(levels), given.ranges or {}),
            lost,
            scale,
            delays=delays_in(whole, held),
        ),
        sources,
        first,
        equations,
        StepSettings(
            given.form,
            gate,
            np.array([e.quantity.wraps for e in shown], dtype=bool),
            *state_bounds(base, whole, parameters, scale),
            np.array([s not in parameters.values() for s in whole.states]),
            given.switchable,
        ),
        system.vector(system.coefficients, held),
        np.array([s.level for s in sources]),
        np.array(list(levels.values())),
        (given.method, given.hold, given.substeps, given.shared_noise),
        given.compiled,
        given.single,
    )


def _gate(given: FilterSettings) -> Gate | None:
    """Return the gate of the settings; raise an error for a form or a gate that does not fit."""
    if given.form not in FORMS:
        raise UnknownNameError("form of the filter", given.form, FORMS)
    if given.switchable and given.form != "covariance":
        raise UsageError("adaptation that can be switched off needs the covariance form.")
    if given.gate is None:
        return None
    if not given.gate > 0:
        raise UsageError(
            f"a gate of {given.gate:g} standard deviations rejects every sample; give one greater than zero, or None."
        )
    patience = to_si(given.patience, "s", "the patience")
    if patience < 0:
        raise UsageError(f"a patience of {given.patience} is negative; give '0 s' or more.")
    return Gate(given.gate, patience)
