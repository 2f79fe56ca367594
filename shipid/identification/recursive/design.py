"""The design of a recursion: its settings, read and checked once, and the functions that are generated from them.

A design never changes. The identifier, its results and the saved state of an online recursion all read it.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.declaration.units import to_si
from shipid.estimation.errors import NoiseLevelError
from shipid.estimation.records.derived import published
from shipid.estimation.records.triangles import diagonal_of
from shipid.estimation.recursion.layout import total
from shipid.estimation.settings.initial import parameter_starts, read_deviations
from shipid.estimation.settings.instruments import Amount, Instruments, read_inputs
from shipid.estimation.settings.noise import process_sources
from shipid.foundation.aliases import CasadiFunction
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.generation.loop import Loop, make_loop
from shipid.generation.system import generate
from shipid.identification.recursive.errors import ForgettingError
from shipid.identification.recursive.methods import Method, find_method
from shipid.identification.recursive.noise_level import noise_of, read_sensor
from shipid.identification.recursive.published import along, make_published
from shipid.identification.recursive.recursion import RecursionLayout, make_recursion
from shipid.identification.recursive.regression import StateRegression, make_regression
from shipid.parameters.catalogue import model_of, ship_of
from shipid.parameters.parameter_set import ParameterSet, missing_values


@dataclass(frozen=True)
class RecursiveSettings:
    """The settings of a recursion; `shipid.identification.recursive.identifier.RecursiveIdentifier` explains each of them.

    Attributes
    ----------
    method, forgetting
        Which member of the family.
    estimate, measured, noise, initial, start, inputs
        Parameters, the measured state, noise, first estimates and constant inputs.
    integration, hold, compiled
        How it is computed.
    """

    method: str = "combined"
    estimate: Sequence[str] | None = None
    measured: Mapping[str, Amount | None] | None = None
    noise: Mapping[str, Amount] | None = None
    initial: Mapping[str, Amount] | None = None
    start: Mapping[str, Amount] | None = None
    inputs: Mapping[str, Amount] | None = None
    forgetting: float = 1.0
    integration: str = "rk4"
    hold: str = "linear"
    compiled: bool = True


@dataclass(frozen=True, eq=False, repr=False)
class RecursiveDesign:
    """A recursion as its settings define it, SI; n parameters. Made by `design_recursion`.

    Attributes
    ----------
    method : Method
        Which member of the family.
    ship : ParameterSet
        Particulars and known coefficients.
    regression : StateRegression
        The regression of the measured state.
    instruments : Instruments
        The sensor and the inputs.
    level : float or None
        Standard deviation of a sample of the measured state; None where it is estimated from the record.
    forgetting : float
        Factor on the weight of samples, for each sample of age.
    first_output : float or None
        First estimate of the measured state; None where it is the first sample.
    output_deviation : float or None
        Its standard deviation; None for that of a sample.
    theta, deviation : ndarray, shape (n,)
        First estimates of the parameters and their standard deviations.
    known : mapping of str to float
        The other coefficients.
    p : ndarray, shape (coefficients,)
        Coefficients of the regression.
    q, q_density : ndarray, shape (1 + n,)
        Variances that a sample, and a second, add to the measured state and to the parameters.
    compiled : bool
        Whether to compile.
    """

    method: Method
    ship: ParameterSet
    regression: StateRegression
    instruments: Instruments
    level: float | None
    forgetting: float
    first_output: float | None
    output_deviation: float | None
    theta: np.ndarray
    deviation: np.ndarray
    known: Mapping[str, float]
    p: np.ndarray
    q: np.ndarray
    q_density: np.ndarray
    compiled: bool

    def __repr__(self) -> str:
        return (
            f"{self.method.name} of {', '.join(self.names)} in the equation of '{self.output}' of {self.model.name!r}, "
            f"ship {self.ship.name}"
        )

    @property
    def model(self) -> Model:
        """The whole model."""
        return self.regression.model

    @property
    def names(self) -> tuple[str, ...]:
        """The estimated parameters."""
        return self.regression.names

    @property
    def output(self) -> str:
        """The measured state."""
        return self.regression.output

    @property
    def sensor(self) -> str:
        """The sensor or state that is measured."""
        return self.instruments.sensors[0]

    @functools.cached_property
    def layout(self) -> RecursionLayout:
        """Where everything stands in the vectors of the recursion."""
        system = self.regression.system
        return RecursionLayout(len(self.names), system.u.shape[0], system.p.shape[0])

    @functools.cached_property
    def loop(self) -> Loop:
        """The recursion with the loop over samples, compiled once."""
        return make_loop(make_recursion(self.regression, self.method, self.layout), self.compiled)

    @functools.cached_property
    def published_names(self) -> tuple[str, ...]:
        """Published coefficients that the estimated parameters determine."""
        return published(self.model, self.names)

    @functools.cached_property
    def _published(self) -> CasadiFunction:
        return make_published(self.model, self.names, self.published_names)

    def published_along(self, theta: np.ndarray, covariance: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Return the published coefficients along a record: values and standard deviations, SI, each of shape (N,).

        Parameters
        ----------
        theta : ndarray, shape (N, n)
            Estimates.
        covariance : ndarray, shape (N, n, n)
            Their covariance.
        """
        if not self.published_names:
            return {}
        system = generate(self.model)
        known = {**dict.fromkeys(self.names, 0.0), **self.known}
        p = np.tile(system.vector(system.coefficients, known, default=0.0), (len(theta), 1))
        p[:, [system.coefficients.index(n) for n in self.names]] = theta
        return dict(zip(self.published_names, zip(*along(self._published, p, covariance))))

    @property
    def first_gain(self) -> np.ndarray:
        """First variances of the parameters as used by the gains, shape (n,)."""
        return self.deviation**2 * self.method.first_factor

    @property
    def starts_at_sample(self) -> bool:
        """Whether the measured state starts at the first sample, which then gives no innovation."""
        return self.first_output is None

    def level_of(self, samples: np.ndarray | None = None, t: np.ndarray | None = None) -> float:
        """Return the noise level of the measured state, SI: as given, or from a record of it.

        Parameters
        ----------
        samples : ndarray, optional
            The record.
        t : ndarray, optional
            Their times in s; they are evenly sampled by default.

        Raises
        ------
        NoiseLevelError
            If it is not given and there is no record.
        """
        if self.level is not None:
            return self.level
        if samples is None:
            unit = self.model[self.output].unit.replace("rad", "deg")
            raise NoiseLevelError(
                f"samples of '{self.sensor}' that arrive one by one have no known noise level: give the standard deviation "
                f"of one, as in measured={{'{self.sensor}': '0.02 {unit}'}}."
            )
        return noise_of(samples, t)

    def constants(self, level: float) -> np.ndarray:
        """Return coefficients, noise, first uncertainty, forgetting and start in the order the recursion takes them.

        Parameters
        ----------
        level : float
            Standard deviation of a sample of the measured state, SI.
        """
        last = [level**2, self.forgetting, self.starts_at_sample]
        return np.concatenate([self.p, self.q, self.q_density, self.first_gain, last])

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
        places = self.layout.carried
        z = np.zeros(total(places))
        own = level if self.output_deviation is None else self.output_deviation
        z[places["y"]] = z[places["y_aux"]] = first if self.first_output is None else self.first_output
        z[places["theta"]] = z[places["theta_aux"]] = self.theta
        z[places["u"]] = inputs
        z[places["P"]] = np.diag(self.first_gain).ravel()
        z[places["P_y"]] = own**2
        z[places["joint"]][diagonal_of(self.layout.n + 1)] = np.concatenate([[own**2], self.deviation**2])
        return z

    @functools.cached_property
    def fingerprint(self) -> str:
        """A hash of everything that a saved state depends on."""
        parts = (
            self.method.name,
            self.names,
            self.output,
            self.sensor,
            self.regression.system.digest,
            self.regression.integration,
            sorted(self.instruments.inputs.items()),
            self.constants(self.level_of()).tolist(),
        )
        return hashlib.sha256(repr(parts).encode()).hexdigest()


def design_recursion(
    model: Model | type[Component] | str,
    ship: ParameterSet | str | None = None,
    settings: RecursiveSettings | None = None,
) -> RecursiveDesign:
    """Return the design of a recursive identification.

    Parameters
    ----------
    model : Model, component class or str
        What is identified.
    ship : ParameterSet or str, optional
        Particulars, and coefficients that are known or where the search starts.
    settings : RecursiveSettings, optional
        Method, parameters, noise and options.

    Returns
    -------
    RecursiveDesign

    Raises
    ------
    ShipidError
        For names, units and levels that do not fit, and for parameters that enter nonlinearly.
    UnknownNameError
        If a first estimate is given for another quantity.
    """
    given = settings or RecursiveSettings()
    method = _method(given)
    model, ship = model_of(model), ship_of(ship)
    sensor, level, output = read_sensor(model, given.measured)
    regression = make_regression(
        model, output, given.estimate, linear=method.linear, integration=given.integration, hold=given.hold
    )
    names, output, system = regression.names, regression.output, regression.system
    scale = Scale(ship.particular("L", "m"), ship.particular("speed", "m/s"))
    known = ship.values(model, speed=scale.speed)
    start = dict(given.start or {})
    for name in start:
        if name not in (output, *names):
            raise UnknownNameError(f"first estimate of model {model.name} called", name, (output, *names))
    first = start.pop(output, None)
    starts = parameter_starts(model, names, ship, known, start, scale)
    own = {n: n for n in names}
    deviations = {n: s for n, (_, s) in starts.items()} | read_deviations(system.model, given.initial or {}, own)
    q, q_density = _noise(regression, given, method, scale)
    lacking = [n for n in regression.coefficients if n not in known]
    if lacking:
        rest = {n: 0.0 for n in model.parameters + model.constants if n not in lacking}
        error = missing_values(model, rest, f"ship {ship.name}")
        assert error is not None
        raise error
    known = {n: v for n, v in known.items() if n not in names}
    return RecursiveDesign(
        method,
        ship,
        regression,
        Instruments(
            system.model,
            (sensor or output,),
            regression.needed,
            read_inputs(system.model, given.inputs or {}),
            scale=scale,
        ),
        level,
        float(given.forgetting),
        None if first is None else to_si(first, model[output].unit, f"start of '{output}'"),
        deviations.get(output),
        np.array([starts[n][0] for n in names]),
        np.array([deviations[n] for n in names]),
        known,
        # Coefficients that the equation does not read may stay unknown.
        system.vector(system.coefficients, known, default=0.0),
        q,
        q_density,
        given.compiled,
    )


def _method(given: RecursiveSettings) -> Method:
    method = find_method(given.method)
    if not 0 < given.forgetting <= 1:
        raise ForgettingError(
            f"a forgetting factor must be above 0 and at most 1 (for example 0.995), and got {given.forgetting:g}."
        )
    if given.forgetting != 1 and not method.forgets:
        raise ForgettingError(
            f"method {given.method} takes no forgetting factor: parameters that change with time are given noise, as in "
            "noise={'a': '0.001'}."
        )
    return method


def _noise(
    regression: StateRegression, given: RecursiveSettings, method: Method, scale: Scale
) -> tuple[np.ndarray, np.ndarray]:
    """Variances that a sample, and a second, add to the measured state and to the parameters."""
    order = [regression.output, *regression.names]
    noise = dict(given.noise or {})
    if method.uses_noise_level:
        declared = {n: regression.model[n].quantity.noise for n in order}
        noise = {n: q for n, q in declared.items() if q} | noise
    own = {n: n for n in regression.names}
    q, q_density = np.zeros(len(order)), np.zeros(len(order))
    for s in process_sources(regression.system.model, noise, own, {}, scale, model_noise=False):
        if s.place != "state":
            raise UsageError(
                f"noise is given for the input '{s.name}'. A recursion takes it on the measured state '{regression.output}' and on "
                "the parameters; for noisy inputs take the extended Kalman filter."
            )
        (q_density if s.density else q)[order.index(s.name)] += s.level**2
    return q, q_density
