"""The closed loop of an autopilot: as a model like any other, linearised at a speed, and for python-control."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Literal, Protocol, cast, get_args

import numpy as np

from shipid.autopilot.design.control_law import (
    CourseController,
    IntegralCourseController,
    Measured,
    RateController,
)
from shipid.autopilot.design.placement import closed_poles
from shipid.autopilot.design.plant import Plant, linear_plant, ship_plants
from shipid.autopilot.design.schedule import Schedule
from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.generation.linearisation import linearise
from shipid.generation.system import generate
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.ship_coefficients import coefficients_at

if TYPE_CHECKING:
    import control

#: What python-control may be given of an autopilot.
Part = Literal["loop", "controller", "ship"]
PARTS: tuple[Part, ...] = get_args(Part)


class Piloted(Protocol):
    """A ship with the gains that steer her: what `shipid.autopilot.design.autopilot.Autopilot` holds and a loop is made of."""

    @property
    def model(self) -> Model:
        """The ship's model."""

    @property
    def ships(self) -> tuple[ParameterSet, ...]:
        """The ship, once for each load condition."""

    @property
    def actuator(self) -> type[Component]:
        """The steering machine between order and rudder."""

    @property
    def mode(self) -> str:
        """Whether it holds a course or a rate of turn."""

    @property
    def request(self) -> Mapping[str, float]:
        """What the design was asked for, SI."""

    @property
    def service_speed(self) -> float:
        """In m/s."""

    @property
    def rudder_limit(self) -> float:
        """Largest rudder angle it orders, in rad."""

    @property
    def limits(self) -> Mapping[str, float]:
        """Constants of the steering machine, SI."""

    @property
    def schedule(self) -> Schedule:
        """Speeds and gains."""


def control_law(pilot: Piloted) -> type[Component]:
    """Return the control law of an autopilot, by its mode and its gains.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    """
    if pilot.mode == "rate":
        return RateController
    return IntegralCourseController if "Ki" in pilot.schedule.gains else CourseController


def closed_loop(pilot: Piloted, *parts: type[Component], measured: type[Component] = Measured) -> Model:
    """Return ship, steering machine, measurement and law as one declared model.

    Its input is ``psi_order`` [rad], or ``r_order`` [rad/s] where the autopilot holds a rate of turn.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    *parts : type[Component]
        More components to join: wind, waves, measures.
    measured : type[Component]
        The component that states ``psi_seen``, ``r_seen`` and ``speed_seen``: the instruments, or a filter.
    """
    name = f"{pilot.model.name}-autopilot"
    return join(name, pilot.model, pilot.actuator, measured, control_law(pilot), pilot.schedule.component, *parts)


def steered_ship(pilot: Piloted) -> Model:
    """Return the ship with its steering machine; its input is ``delta_order``.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    """
    return _steered(pilot.model, cast("Hashable", pilot.actuator))


@lru_cache(maxsize=32)
def _steered(model: Model, actuator: type[Component]) -> Model:
    """The ship and its steering machine, which every prediction asks for."""
    return join(f"{model.name}-steered", model, actuator)


def coefficients_of(pilot: Piloted, model: Model, speed: float, condition: int = 0) -> dict[str, float]:
    """Return the coefficients of a model that holds the ship of an autopilot, at a speed, SI.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    model : Model
        The ship's own model, `closed_loop`, or another one it was joined into.
    speed : float
        In m/s.
    condition : int
        Which load condition.
    """
    ship, own = pilot.ships[condition], coefficients_at(pilot.model, pilot.ships[condition], speed).values
    known: dict[str, float] = {}
    for name in model.parameters + model.constants:
        found, default = ship.find(model, name), model[name].number("default")
        if name in own:
            known[name] = own[name]
        elif name in pilot.limits:
            known[name] = pilot.limits[name]
        elif found is not None and not found.speed:
            known[name] = found.at(None, model[name].unit, f"ship {ship.name}")
        elif default is not None:
            known[name] = default
    return known | ({"rudder_limit": pilot.rudder_limit} if "rudder_limit" in model else {})


def linear_ship(
    pilot: Piloted, speeds: Sequence[float] | np.ndarray, condition: int = 0, steered: bool = False
) -> Plant:
    """Return the linear ship at several speeds, with or without its steering machine.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    speeds : sequence of float, shape (n,)
        In m/s.
    condition : int
        Which load condition.
    steered : bool
        Whether the input is the rudder order, through the steering machine.
    """
    model, speeds = steered_ship(pilot) if steered else pilot.model, np.atleast_1d(np.asarray(speeds, dtype=float))
    system = generate(model)
    p = [system.vector(system.coefficients, coefficients_of(pilot, model, float(v), condition)) for v in speeds]
    return linear_plant(model, speeds, np.stack(p, axis=1), "delta_order" if steered else "delta")


def poles_at(pilot: Piloted, speed: float, condition: int = 0) -> np.ndarray:
    """Return the poles of the loop in rad/s at a speed, the steering machine inside its limits left out.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    speed : float
        In m/s.
    condition : int
        Which load condition.
    """
    return closed_poles(linear_ship(pilot, [speed], condition).at(0), pilot.schedule.gains_at(speed, condition))


def schedule_poles(
    model: Model, ships: Sequence[ParameterSet], schedule: Schedule
) -> tuple[tuple[np.ndarray, ...], ...]:
    """Return the poles of the loop in rad/s at each speed of a schedule, for each load condition.

    Parameters
    ----------
    model : Model
        The ship's model.
    ships : sequence of ParameterSet
        The ship, once for each load condition.
    schedule : Schedule
        Speeds and gains.
    """
    return tuple(
        tuple(closed_poles(plants.at(i), schedule.gains_at(float(speed), j)) for i, speed in enumerate(schedule.speeds))
        for j, plants in enumerate(ship_plants(model, ship, schedule.speeds) for ship in ships)
    )


def heading_frequency(pilot: Piloted, speed: float) -> float:
    """Return the natural frequency of the heading in rad/s: the one requested, or that of the two slowest poles.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    speed : float
        In m/s.
    """
    if "omega_n" in pilot.request:
        return pilot.request["omega_n"] * speed / pilot.service_speed
    return float(np.sqrt(np.prod(np.sort(np.abs(poles_at(pilot, speed)))[:2])))


def to_control(
    pilot: Piloted, speed: float | None = None, condition: int = 0, nonlinear: bool = False, of: Part = "loop"
) -> control.StateSpace | control.NonlinearIOSystem:
    """Return the closed loop, or a part of it, for python-control, SI.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    speed : float, optional
        In m/s; the service speed by default.
    condition : int
        Which load condition.
    nonlinear : bool
        Whether it is the whole nonlinear system as an `nlsys` with every input of the model, or a `StateSpace`.
    of : {"loop", "controller", "ship"}
        The loop, from the order to ``psi``, ``r`` and ``delta``; the control law with its gains at this speed, from the order and what
        is measured to ``delta_order``; or the ship with her steering machine, from ``delta_order`` to ``psi``, ``r`` and ``delta``.
        The law and the ship, connected by their names, are the loop.
    """
    speed = pilot.service_speed if speed is None else speed
    order = "r_order" if pilot.mode == "rate" else "psi_order"
    if of == "controller":
        gains = pilot.schedule.component
        model = join(f"{pilot.model.name}-controller", Measured, control_law(pilot), gains)
        inputs, outputs = [order, *(("psi",) if pilot.mode == "course" else ()), "r"], ["delta_order"]
    else:
        model = closed_loop(pilot) if of == "loop" else steered_ship(pilot)
        inputs, outputs = [order if of == "loop" else "delta_order"], ["psi", "r", "delta"]
    known = coefficients_of(pilot, model, speed, condition)
    if nonlinear:
        return _nonlinear(model, known, outputs)
    known |= {"u": speed, "cruise": speed, "loading": float(condition)}
    if of == "controller":
        return linearise(model, known, None, inputs, outputs).to_state_space()
    system = generate(model)
    column = np.asarray(system.vector(system.coefficients, known))[:, None]
    plant = linear_plant(model, np.array([speed]), column, inputs[0])
    return linearise(model, known, plant.states, inputs, outputs).to_state_space()


def _nonlinear(model: Model, known: Mapping[str, float], outputs: list[str]) -> control.NonlinearIOSystem:
    import control

    system = generate(model)
    rates, shown = system.right_hand_side, system.function(outputs)
    p = system.vector(system.coefficients, known)

    def update(_t: float, x: np.ndarray, u: np.ndarray, _params: object) -> np.ndarray:
        return np.asarray(rates(x, u, p)).ravel()

    def output(_t: float, x: np.ndarray, u: np.ndarray, _params: object) -> np.ndarray:
        return np.asarray(shown(x, u, p)).ravel()

    return control.nlsys(
        update, output, inputs=list(system.inputs), outputs=outputs, states=list(system.states), name=model.name
    )
