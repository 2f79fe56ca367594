"""What a filter needs of a model, as expressions: the step with its noise, the sensors, and their exact Jacobians.

The noise of an input that a sensor shows as well (waves move the heading the compass reads) belongs to the sample and to
the step that follows it. It is carried as an unknown of its own from the one to the other, so that both use the same
noise; the joint vector is ``[x, w]``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from shipid.declaration.model import Model
from shipid.estimation.settings.noise import NoiseSource
from shipid.foundation.aliases import Expression
from shipid.generation.step import make_step
from shipid.generation.system import System, generate


@dataclass(frozen=True, eq=False)
class Equations:
    """Expressions of one sampling interval.

    Attributes
    ----------
    system : System
        The model.
    measured : tuple of str
        Quantities with a sensor.
    sources : tuple of NoiseSource
        What drives the states.
    carried : tuple of int
        Which sources are unknowns of the joint vector, by index.
    joint : casadi.SX
        ``[x, w]``.
    u0, u1, T, p, levels, scale : casadi.SX
        Inputs at both ends of the interval, its length, coefficients, noise levels, and factors on them.
    advanced, transition : casadi.SX
        States at the end of the interval, and their Jacobian by the joint vector.
    added : tuple of tuple
        ``(column, variance)`` of every noise that is added at the end: the column of its effect on the states.
    spread : casadi.SX
        Variance that white noise brings to each state over half the interval: it enters before and after the
        transition (trapezoidal rule).
    shown, sensitivity : casadi.SX
        Measured quantities at the end of the interval, in terms of the joint vector there and `u1`; their Jacobian.
    doubled : tuple of tuple
        ``(effect on the sensors, variance)`` of noise that sensors show and that is not carried: it is counted twice, as
        if the sensors and the step had noises of their own.
    """

    system: System
    measured: tuple[str, ...]
    sources: tuple[NoiseSource, ...]
    carried: tuple[int, ...]
    joint: Expression
    u0: Expression
    u1: Expression
    T: Expression
    p: Expression
    levels: Expression
    scale: Expression
    advanced: Expression
    transition: Expression
    added: tuple[tuple[Expression, Expression], ...]
    spread: Expression
    shown: Expression
    sensitivity: Expression
    doubled: tuple[tuple[Expression, Expression], ...] = ()

    @property
    def model(self) -> Model:
        """The model, estimated parameters among its states."""
        return self.system.model

    @property
    def sampled(self) -> bool:
        """Whether a state changes at a sample even when no time passes."""
        return bool(self.system.nexts)

    @property
    def linear(self) -> bool:
        """Whether neither Jacobian depends on the estimate, so that the plain Kalman filter is exact."""
        both = ca.vertcat(ca.vec(self.transition), ca.vec(self.sensitivity))
        return not ca.depends_on(both, self.joint)

    @property
    def carried_noise(self) -> Expression:
        """The carried noise as what it adds to each input at the end of the interval, casadi.SX, shape (inputs,)."""
        noise, states = ca.SX.zeros(self.system.u.shape[0]), self.system.x.shape[0]
        for k, i in enumerate(self.carried):
            noise[self.system.inputs.index(self.sources[i].name)] += self.joint[states + k]
        return noise

    def carried_variance(self) -> list[Expression]:
        """Return the variance of each carried noise in one sample."""
        return [self.variance_of(i) for i in self.carried]

    def sensor_variance(self, sensor: int, deviation: Expression) -> Expression:
        """Return the variance of what a sensor shows: its own noise, and noise of inputs that is not carried.

        Parameters
        ----------
        sensor : int
            Which sensor.
        deviation : casadi.SX, shape (sensors,)
            Standard deviations of the sensors.
        """
        return deviation[sensor] ** 2 + sum(effect[sensor] ** 2 * variance for effect, variance in self.doubled)

    def innovation(self, sensor: int, z: Expression, shown: Expression, wraps: bool) -> Expression:
        """Return what a sensor shows less what was predicted; of an angle that wraps the difference within half a turn.

        Parameters
        ----------
        sensor : int
            Which sensor.
        z, shown : casadi.SX, shape (sensors,)
            What the sensors show, and what was predicted.
        wraps : bool
            Whether the sensor shows an angle that wraps.
        """
        e = z[sensor] - shown[sensor]
        return e - 2 * np.pi * ca.floor(e / (2 * np.pi) + 0.5) if wraps else e

    def variance_of(self, index: int) -> Expression:
        """Return the variance that a noise source adds over the interval (to a state), or has in a sample (an input).

        Parameters
        ----------
        index : int
            Which source.
        """
        source = self.sources[index]
        power = (self.levels[index] * self.scale[index]) ** 2
        # With no time between two samples there is no step for the noise to enter.
        if not source.density:
            return power if source.place == "input" else power * (self.T > 0)
        return power / ca.if_else(self.T > 0, self.T, 1.0) if source.place == "input" else power * self.T


def make_equations(
    model: Model,
    measured: Mapping[str, float] | tuple[str, ...],
    sources: tuple[NoiseSource, ...],
    method: str,
    hold: str,
    substeps: int,
    shared: bool = True,
) -> Equations:
    """Generate the expressions of one interval.

    Parameters
    ----------
    model : Model
        With estimated parameters as states.
    measured : sequence of str
        Quantities with a sensor.
    sources : tuple of NoiseSource
        What drives the states.
    method, hold, substeps
        See `shipid.generation.step.make_step`.
    shared : bool
        Whether noise that drives a state and shows in a sensor is carried from the one to the other.

    Returns
    -------
    Equations
    """
    system = generate(model)
    names = tuple(measured)
    step = make_step(system, method, hold, substeps, delayed=True)
    n_u = system.u.shape[0]
    u0, u1 = ca.SX.sym("u0", n_u), ca.SX.sym("u1", n_u)
    shown = ca.densify(system.expression(names))
    read = ca.jacobian(shown, system.u).sparsity()
    columns = set(read.get_triplet()[1])
    inputs = [i for i, s in enumerate(sources) if s.place == "input"]
    seen = tuple(i for i in inputs if system.inputs.index(sources[i].name) in columns)
    carried = seen if shared else ()
    levels, scale = ca.SX.sym("q", len(sources)), ca.SX.sym("s", len(sources))
    w = ca.SX.sym("w", len(carried))
    other = [i for i in inputs if i not in carried]
    nudge = ca.SX.sym("e", len(other))

    # Noise on an input is held over the step, at both of its ends.
    moved = ca.SX.zeros(n_u)
    for symbol, chosen in ((w, carried), (nudge, other)):
        for k, i in enumerate(chosen):
            moved[system.inputs.index(sources[i].name)] += symbol[k]
    advanced = ca.densify(step.function(system.x, u0 + moved, u1 + moved, system.p, system.T))
    joint = ca.vertcat(system.x, w)
    still = [nudge, ca.SX.zeros(len(other))]
    transition = ca.substitute(ca.jacobian(advanced, joint), *still)
    effect = ca.substitute(ca.jacobian(advanced, nudge), *still)
    advanced = ca.substitute(advanced, *still)
    at_end: Expression = ca.SX.zeros(n_u)
    for k, i in enumerate(carried):
        at_end[system.inputs.index(sources[i].name)] += w[k]
    by_input = ca.substitute(ca.jacobian(shown, system.u), system.u, u1)
    shown = ca.substitute(shown, system.u, u1 + at_end)

    equations = Equations(
        system,
        names,
        sources,
        carried,
        joint,
        u0,
        u1,
        system.T,
        system.p,
        levels,
        scale,
        advanced,
        transition,
        (),
        ca.SX.zeros(system.x.shape[0]),
        shown,
        ca.jacobian(shown, joint),
    )
    added, spread = [], ca.SX.zeros(system.x.shape[0])
    for k, i in enumerate(other):
        added.append((effect[:, k], equations.variance_of(i)))
    for i, source in enumerate(sources):
        if source.place == "state":
            row = system.states.index(source.name)
            if source.density:
                spread[row] += equations.variance_of(i) / 2
            else:
                unit = ca.SX(system.x.shape[0], 1)
                unit[row] = 1
                added.append((unit, equations.variance_of(i)))
    doubled = [
        (by_input[:, system.inputs.index(sources[i].name)], equations.variance_of(i)) for i in seen if not shared
    ]
    return replace(equations, added=tuple(added), spread=spread, doubled=tuple(doubled))
