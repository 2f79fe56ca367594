"""A model run along the distance sailed: one node every so many metres, with or without the spread of what is not known.

In the distance domain a track does not depend on the speed (Passenier 1989, section 3.2): the tracks of ships that are not sure
of their speed are compared at the same distance, and a covariance of positions at equal distance is one of tracks.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import Literal

import casadi as ca
import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.declaration.quantity import derived, given, state
from shipid.foundation.aliases import Expression
from shipid.generation.loop import Loop, make_loop
from shipid.generation.step import make_step
from shipid.generation.system import System, generate
from shipid.parts.manoeuvring_range import LEAST_SPEED
from shipid.parts.rudder_delay import recorded_rudder

#: What is recorded at every node.
NODE = ("track_s", "track_t", "x", "y", "psi", "r", "u", "track_v", "track_rudder")
#: Below this share of the cruising speed a step is one in time: a ship that stops never covers the next distance.
LEAST_SHARE = LEAST_SPEED
#: How the spread is carried: not at all, by its covariance, or by draws of the noise.
Spread = Literal["none", "covariance", "drawn"]


class TrackClock(Component):
    """Distance sailed through the water and time elapsed since the prediction began."""

    u = given("m/s", "forward speed through the water")
    v = given("m/s", "sway speed through the water, positive to starboard", default=0.0)
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    track_s = state("m", "distance sailed ahead through the water", nominal=100.0)
    track_t = state("s", "time elapsed", nominal=100.0)
    track_v = derived("m/s", "sway speed through the water, positive to starboard")
    track_rudder = derived("rad", "rudder angle, positive turns to starboard")

    @track_s.rate
    def distance(self) -> Expression:
        """Passenier (1989), eq. (3.9): ds = u dt."""
        return self.u + 0.0

    @track_t.rate
    def time(self) -> Expression:
        """The time as a function of the distance."""
        return 1.0

    @track_v.equals
    def sway(self) -> Expression:
        """As the model states it; zero where it states none."""
        return self.v + 0.0

    @track_rudder.equals
    def rudder(self) -> Expression:
        """As the steering machine states it."""
        return self.delta + 0.0


@dataclass(frozen=True, eq=False)
class DistanceLoop:
    """A step over a distance, run over the nodes of a track; made by `make_distance_loop`.

    The coefficients of the loop are those of the model, its inputs, the least speed in m/s and, with a spread, the noise of each
    uncertain quantity. The control of a node is the distance to the next in m and, with drawn noise, one number a driven state, or the
    rudder order in rad where that comes with each node.

    Attributes
    ----------
    system : System
        The equations, the track's own clock among them.
    extra : tuple of str
        Uncertain quantities that are no states: coefficients and inputs.
    spread : {"none", "covariance", "drawn"}
        How the spread is carried.
    loop : Loop
        The compiled loop.
    """

    system: System
    extra: tuple[str, ...]
    spread: Spread
    loop: Loop = field(repr=False)

    @property
    def shown(self) -> int:
        """How many columns come before those of the spread: `NODE`, and the margins of the guards."""
        return len(NODE) + len(self.system.model.guards)

    @property
    def uncertain(self) -> tuple[str, ...]:
        """Names along covariance and noise: the states, then `extra`."""
        return self.system.states + self.extra

    def coefficients(
        self, p: np.ndarray, inputs: np.ndarray, least: float, noise: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the coefficients of the loop.

        Parameters
        ----------
        p : ndarray, shape (coefficients,)
            Of the model.
        inputs : ndarray, shape (inputs,)
            Held along the track.
        least : float
            Speed in m/s below which a step is one in time.
        noise : ndarray, shape (uncertain,), optional
            Per root second, SI; with a spread only.
        """
        return np.concatenate([p, inputs, [least], *(() if noise is None else (noise,))])

    def carried(self, x0: np.ndarray, covariance: np.ndarray | None = None) -> np.ndarray:
        """Return what the loop carries into the first node.

        Parameters
        ----------
        x0 : ndarray, shape (states,)
            States.
        covariance : ndarray, shape (uncertain, uncertain), optional
            With a spread by covariance only.
        """
        return x0 if covariance is None else np.concatenate([x0, covariance[np.triu_indices(len(covariance))]])


def with_clock(model: Model) -> Model:
    """Return a model with the clock of a track.

    Parameters
    ----------
    model : Model
        A ship under an order.
    """
    return join(f"{model.name}-track", model, TrackClock)


@functools.lru_cache(maxsize=64)
def make_distance_loop(
    model: Model,
    extra: tuple[str, ...] = (),
    spread: Spread = "none",
    substeps: int = 1,
    driven: tuple[int, ...] = (),
    steered: bool = False,
) -> DistanceLoop:
    """Generate and compile the step over a distance.

    Parameters
    ----------
    model : Model
        From `with_clock`.
    extra : tuple of str
        Coefficients and inputs that are uncertain, besides the states.
    spread : {"none", "covariance", "drawn"}
        How the spread is carried.
    substeps : int
        Integration steps between two nodes.
    driven : tuple of int
        With drawn noise: places of the states that it drives.
    steered : bool
        Whether the rudder order comes with each node, and not once for all; with a spread by covariance only.

    Returns
    -------
    DistanceLoop

    Notes
    -----
    With A the Jacobian of the step over a given distance by everything that is uncertain, the covariance goes on by
    ``A P A' + Q T``: since the duration T of the step follows from the speed, P is that of tracks at equal distance.
    """
    system = generate(model)
    # Heun's method with the servo's step differs from Runge and Kutta's by less than 1e-4 ship lengths, at half the cost.
    step = make_step(system, "heun", "zero", substeps)
    distance, least = ca.SX.sym("ds"), ca.SX.sym("least")
    # As in a record: a rudder that acts behind a dead time is shown where it is.
    shown = (recorded_rudder(model) if n == "track_rudder" and "delta_recorded" in model else n for n in NODE)
    interval = distance / ca.fmax(system.values["u"], least)
    x_next, out = ca.substitute([step.x_next, system.expression((*shown, *model.guards))], [system.T], [interval])
    control = distance
    if steered:
        rudder = ca.SX.sym("rudder")
        x_next, out = ca.substitute([x_next, out], [system.values["delta_order"]], [rudder])
        control = ca.vertcat(distance, rudder)
    p = ca.vertcat(system.p, system.u, least)
    if spread == "none":
        return DistanceLoop(system, (), spread, _loop([system.x, distance, p], [x_next, out]))
    unknown = ca.vertcat(*(system.values[n] for n in extra))
    count = len(system.states) + len(extra)
    noise = ca.SX.sym("noise", count)
    p = ca.vertcat(p, noise)
    if spread == "drawn":
        draws = ca.SX.sym("w", len(driven))
        moved, size = x_next + 0, ca.sqrt(interval)
        for k, place in enumerate(driven):
            moved[place] += noise[place] * draws[k] * size
        # What is uncertain and no state keeps its drawn value: a random walk of it within one track is small beside that.
        return DistanceLoop(system, extra, spread, _loop([system.x, ca.vertcat(distance, draws), p], [moved, out]))
    lower = ca.SX.sym("P", ca.Sparsity.lower(count))
    covariance = ca.tril2symm(lower)
    by = ca.vertcat(system.x, unknown) if extra else system.x
    step_by, out_by = ca.jacobian(x_next, by), ca.jacobian(system.expression(SHOWN), by)
    rest = ca.horzcat(ca.SX(len(extra), len(system.states)), ca.SX.eye(len(extra)))
    A = ca.vertcat(step_by, rest) if extra else step_by
    following = A @ covariance @ A.T + ca.diag(noise**2) * interval
    shown = out_by @ covariance @ out_by.T
    carried = ca.vertcat(system.x, _packed(lower))
    loop = _loop(
        [carried, control, p],
        [ca.vertcat(x_next, _packed(ca.tril(following))), ca.vertcat(out, _packed(ca.tril(shown)))],
    )
    return DistanceLoop(system, extra, spread, loop)


def _loop(arguments: list[Expression], results: list[Expression]) -> Loop:
    """The loop over a step; what its expressions share, as the schedule of two gains does, is computed once."""
    return make_loop(ca.Function("node", arguments, [ca.densify(e) for e in ca.cse(results)]))


#: What a covariance is shown of, at every node.
SHOWN = ("x", "y", "psi", "track_t")


def _packed(lower: Expression) -> Expression:
    """The lower triangle, column by column, zeros included."""
    count = lower.shape[0]
    return ca.vertcat(*(lower[j:, j] for j in range(count)))


def unpacked_spread(rows: np.ndarray) -> np.ndarray:
    """Return the covariances of `SHOWN`, shape (N, 4, 4), from the packed columns of the loop.

    Parameters
    ----------
    rows : ndarray, shape (N, 10)
        What follows `NODE` in the loop's outputs.
    """
    count = len(SHOWN)
    full = np.zeros((len(rows), count, count))
    i, j = np.triu_indices(count)
    full[:, i, j] = full[:, j, i] = rows
    return full
