"""The linear ship from rudder to heading and rate of turn, linearised exactly at each speed.

Everything here works on many conditions at once: speeds of a grid, or samples of the coefficients.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from shipid.autopilot.errors import NoStraightCourseError, NotSteerableError
from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.foundation.aliases import CasadiFunction
from shipid.foundation.numbers import brief
from shipid.generation.straight_course import straight_course
from shipid.generation.system import generate
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.ship_coefficients import coefficients_at
from shipid.parts.rudder_delay import LateRudder, not_steered, steered_by

#: What an autopilot measures.
MEASURED = ("psi", "r")
#: Largest rates at which a ship counts as on a straight course: the change of a state within a ship length, in its own size.
_STRAIGHT = 1e-9


@dataclass(frozen=True, eq=False)
class Plant:
    """Transfers from one input to heading and rate of turn, over any number of conditions.

    Attributes
    ----------
    states : tuple of str
        States that depend on the input and act on heading or rate of turn; the others are left out.
    A : ndarray, shape (..., n, n)
        Exact Jacobian.
    B : ndarray, shape (..., n)
        By the input.
    C : ndarray, shape (..., 2, n)
        Heading and rate of turn.
    denominator : ndarray, shape (..., n + 1)
        Characteristic polynomial, highest power first.
    numerators : ndarray, shape (..., 2, n)
        Of heading and rate of turn, highest power first.
    """

    states: tuple[str, ...]
    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    denominator: np.ndarray
    numerators: np.ndarray

    def at(self, index: int | slice | np.ndarray) -> Plant:
        """Return one condition, or some of them.

        Parameters
        ----------
        index : int, slice or ndarray
            Of the conditions.
        """
        return Plant(
            self.states,
            self.A[index],
            self.B[index],
            self.C[index],
            self.denominator[index],
            self.numerators[index],
        )


def check_steerable(model: Model) -> None:
    """Raise an error for a model that an autopilot cannot steer.

    Parameters
    ----------
    model : Model
        A ship model.

    Raises
    ------
    NotSteerableError
        If it has no heading, no rate of turn, or reads no rudder.
    """
    if "psi" not in model.states:
        raise NotSteerableError(f"model {model.name} has no heading 'psi' among its states: join it with PlanarMotion.")
    sampled = [s for s in model.states if model[s].equation is not None and model[s].equation.kind == "next"]  # type: ignore[union-attr]
    if sampled:
        raise NotSteerableError(
            f"model {model.name} is sampled ({', '.join(sampled)}): an autopilot is designed for a ship that moves in continuous "
            "time. Take the continuous model of the same ship."
        )
    if "r" not in model or model["r"].quantity.kind == "given":
        raise NotSteerableError(
            f"model {model.name} states no rate of turn 'r', which an autopilot feeds back. State it, derived or as a state."
        )
    if steered_by(model) is None:
        raise NotSteerableError(not_steered(model))
    if "delta" not in model.inputs:
        machine = model["delta"].owner.__name__
        raise NotSteerableError(
            f"model {model.name} has the steering machine {machine} in it, and an autopilot is designed for the ship behind one: take the model "
            f"without it. A steering machine is joined then; in Python yours with design_autopilot(..., actuator={machine})."
        )


def check_carries_delay(model: Model, actuator: type[Component]) -> None:
    """Raise an error for an actuator that does not know of a dead time of the rudder, where the model has one.

    Parameters
    ----------
    model : Model
        A ship model.
    actuator : type[Component]
        What turns an order into its rudder angle.

    Raises
    ------
    NotSteerableError
        If the rudder acts behind a dead time, and the actuator states where it is without one.
    """
    if "delta" in model.delays and not issubclass(actuator, LateRudder):
        raise NotSteerableError(
            f"model {model.name} has a dead time of the rudder, '{model.delays['delta']}', and the actuator {actuator.__name__} has none: the "
            "autopilot would be judged without it. Take the actuator SteeringMachine or None, which have one then, or derive yours from "
            "LateRudder as LateSteeringMachine does."
        )


@functools.lru_cache(maxsize=64)
def _linear(model: Model, by: str) -> CasadiFunction:
    """The CasADi function (x, u, p) -> rates and the Jacobians by the states and by one input."""
    system = generate(model)
    column = system.inputs.index(by)
    rates, y = (system.at_an_instant(e) for e in (system.rates, system.expression(MEASURED)))
    return ca.Function(
        "linear",
        [system.x, system.u, system.p],
        [
            ca.densify(rates),
            ca.densify(ca.jacobian(rates, system.x)),
            ca.densify(ca.jacobian(rates, system.u)[:, column]),
            ca.densify(ca.jacobian(y, system.x)),
        ],
    )


def linear_plant(model: Model, speeds: np.ndarray, p: np.ndarray, by: str = "delta") -> Plant:
    """Linearise a ship on a straight course, at many conditions in one call.

    Parameters
    ----------
    model : Model
        A ship model, or one joined with its steering machine.
    speeds : ndarray, shape (n,)
        In m/s.
    p : ndarray, shape (coefficients, n)
        Coefficients in the order of the model's system.
    by : str
        The input: ``"delta"``, or ``"delta_order"`` with a steering machine.

    Returns
    -------
    Plant
        With n conditions.

    Raises
    ------
    NoStraightCourseError
        If a state other than position and heading changes on a straight course with the rudder amidships.
    NotSteerableError
        If the rudder does not move the heading.
    UnstatedInputError
        If the model reads an input that a straight course does not state and that declares no default.
    """
    system = generate(model)
    _ = system.right_hand_side  # refuses a sampled model, with its reason
    x, u = straight_course(model, speeds)
    count = x.shape[1]
    function = _linear(model, by)
    rates, a, b, c = (np.asarray(m.full()) for m in function.map(count)(x, u, p))
    n = len(system.states)
    A = a.reshape(n, count, n).transpose(1, 0, 2)
    B, C = b.T, c.reshape(2, count, n).transpose(1, 0, 2)
    kept = _between(A, B, C)
    names = tuple(s for s, k in zip(system.states, kept) if k)
    _check_straight(model, system.states, rates, speeds, kept)
    if "psi" not in names:
        raise NotSteerableError(
            f"the rudder of model {model.name} does not move its heading at {brief(float(np.min(speeds)))} m/s: the "
            "linearisation is uncontrollable. Check the coefficient of the rudder, and whether a dead band stands before it."
        )
    A, B, C = A[:, kept][:, :, kept], B[:, kept], C[:, :, kept]
    if not C[:, 1].any():
        raise NotSteerableError(
            f"the rate of turn of model {model.name} follows the rudder at once, without a state: its yaw has no dynamics to control."
        )
    heading = names.index("psi")
    free = not A[:, :, heading].any() and not np.delete(C[:, 0], heading, axis=1).any() and not C[:, 1, heading].any()
    denominator, numerators = _integrated(A, B, C, heading) if free else transfer(A, B, C)
    return Plant(names, A, B, C, denominator, numerators)


def ship_plants(model: Model, ship: ParameterSet, speeds: np.ndarray) -> Plant:
    """Return the linear ship without its steering machine, at several speeds.

    Parameters
    ----------
    model : Model
        The ship's model.
    ship : ParameterSet
        The ship.
    speeds : ndarray, shape (n,)
        In m/s.
    """
    system = generate(model)
    p = [system.vector(system.coefficients, coefficients_at(model, ship, float(v)).values) for v in speeds]
    return linear_plant(model, speeds, np.stack(p, axis=1))


def _integrated(A: np.ndarray, B: np.ndarray, C: np.ndarray, heading: int) -> tuple[np.ndarray, np.ndarray]:
    """The polynomials of a ship that does not depend on the heading: its integrator is a root at exactly zero."""
    rest = np.delete(np.arange(A.shape[-1]), heading)
    rows = np.stack([A[:, heading][:, rest], C[:, 1][:, rest]], axis=1)
    denominator, numerators = transfer(A[:, rest][:, :, rest], B[:, rest], rows)
    zero = np.zeros((*denominator.shape[:-1], 1))
    turning = np.concatenate([zero, numerators[:, 0]], axis=-1) + B[:, [heading]] * denominator
    rate = np.concatenate([numerators[:, 1], zero], axis=-1)
    return np.concatenate([denominator, zero], axis=-1), np.stack([turning, rate], axis=1)


def _between(A: np.ndarray, B: np.ndarray, C: np.ndarray) -> np.ndarray:
    """Which states lie between the input and the measurements: they depend on the one and act on the other."""
    links = (A != 0).any(axis=0)
    moved, felt = (B != 0).any(axis=0), (C != 0).any(axis=(0, 1))
    for _ in range(len(moved)):
        moved = moved | links[:, moved].any(axis=1)
        felt = felt | links[felt].any(axis=0)
    return np.asarray(moved & felt)


def _check_straight(
    model: Model, states: Sequence[str], rates: np.ndarray, speeds: np.ndarray, kept: np.ndarray
) -> None:
    if not np.isfinite(rates).all():
        raise NoStraightCourseError(f"the equations of model {model.name} give no finite number on a straight course.")
    for i, name in enumerate(states):
        if kept[i] and np.abs(rates[i]).max() > _STRAIGHT * (model[name].number("nominal") or 1.0):
            worst = int(np.abs(rates[i]).argmax())
            raise NoStraightCourseError(
                f"model {model.name} does not go straight with its rudder amidships: at {brief(np.atleast_1d(speeds)[worst])} "
                f"m/s its '{name}' changes by {brief(rates[i][worst])} in a second. Take the bias out of the coefficients."
            )


def transfer(A: np.ndarray, B: np.ndarray, C: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the polynomials of ``C (sI - A)^-1 B``: the denominator, and a numerator for each row of C.

    Faddeev and Leverrier's recursion, over any number of conditions; for the few states of a ship's yaw it is exact to
    rounding.

    Parameters
    ----------
    A : ndarray, shape (..., n, n)
    B : ndarray, shape (..., n)
    C : ndarray, shape (..., k, n)
        As in `Plant`.

    Returns
    -------
    denominator : ndarray, shape (..., n + 1)
    numerators : ndarray, shape (..., k, n)
    """
    n = A.shape[-1]
    unit = np.broadcast_to(np.eye(n), A.shape)
    adjoint, denominator, numerators = unit, [np.ones(A.shape[:-2])], []
    for k in range(1, n + 1):
        numerators.append(np.einsum("...ij,...jk,...k->...i", C, adjoint, B))
        product = A @ adjoint
        coefficient = -np.trace(product, axis1=-2, axis2=-1) / k
        denominator.append(coefficient)
        adjoint = product + coefficient[..., None, None] * unit
    return np.stack(denominator, axis=-1), np.stack(numerators, axis=-1)
