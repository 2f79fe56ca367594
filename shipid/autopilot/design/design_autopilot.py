"""The design: from a ship to a gain-scheduled autopilot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import get_args

import numpy as np

from shipid.autopilot.design.autopilot import Autopilot, Design, Mode
from shipid.autopilot.design.closed_loop import schedule_poles
from shipid.autopilot.design.design_warnings import design_warnings
from shipid.autopilot.design.gain_design import DEAD_ANGLE, GainDesign, dead_time_of, read_request
from shipid.autopilot.design.placement import Gains, closed_poles
from shipid.autopilot.design.plant import check_carries_delay, check_steerable
from shipid.autopilot.design.schedule import Schedule
from shipid.autopilot.design.speeds import MOST_SPEEDS, parse_speeds
from shipid.autopilot.errors import DesignRequestError
from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import angle, shown
from shipid.foundation.errors import ParameterSetError, UnknownNameError
from shipid.foundation.numbers import brief, percent
from shipid.parameters.catalogue import known_component, model_of, ship_of
from shipid.parameters.parameter_set import ParameterSet
from shipid.parts.helm import DirectRudder
from shipid.parts.rudder_delay import LateDirectRudder, actuator_of
from shipid.parts.steering_machine import SteeringMachine

DESIGNS: tuple[Design, ...] = get_args(Design)
MODES: tuple[Mode, ...] = get_args(Mode)
#: The third pole, that of the integral, over the natural frequency: slow against the course change, fast against the weather;
#: and the weight of the rudder squared against the heading error squared.
INTEGRAL, RUDDER_WEIGHT = 0.15, 1.0
#: How far a pole between two speeds of the schedule may lie from the requested one, over its size.
TOLERANCE = 0.05
#: Where between two speeds the poles are compared with those requested.
_BETWEEN = (0.25, 0.5, 0.75)
#: Assumed where a ship states none: 35 deg, and the 65 deg in 28 s of SOLAS II-1/29.
_LIMITS = {"delta_max": np.deg2rad(35.0), "delta_rate": np.deg2rad(65.0 / 28.0)}


def design_autopilot(
    model: Model | type[Component] | str,
    ship: ParameterSet | str | Sequence[ParameterSet | str],
    *,
    actuator: type[Component] | str | None = SteeringMachine,
    speeds: str | Sequence[float] | None = None,
    design: Design | None = None,
    mode: Mode = "course",
    omega_n: str | float | None = None,
    damping: float | None = None,
    integral: float = INTEGRAL,
    rudder_weight: float = RUDDER_WEIGHT,
    rudder_limit: str | float = "15 deg",
) -> Autopilot:
    """Design a gain-scheduled autopilot from a declared ship, linearised exactly at each speed.

    The gains of heading and rate of turn are found at each speed, and more speeds are taken in until the poles of the loop
    stay within 5 % of those requested at every speed between.

    Parameters
    ----------
    model : Model, component class or str
        The ship's model; a component is joined with planar motion, a name is looked up.
    ship : ParameterSet, str, or sequence of them
        The ship; several are load conditions of one ship, between which the schedule is linear.
    actuator : component class, str or None
        The steering machine, by default `shipid.parts.steering_machine.SteeringMachine`; None for a rudder that is where it is ordered.
        The gains are those of the ship alone, as published; the judgement includes the machine, and a dead time of the rudder.
    speeds : str or sequence of float, optional
        ``"4:12:1 m/s"``, ``"8,12,16 kn"``, or numbers in m/s; by default 0.5 to 1.2 of
        the ship's own speed, by tenths of it.
    design : {"pid", "pole", "lqr"}, optional
        Poles placed with an integral for a steady moment, the default for a course; poles placed, the default for a rate of turn,
        whose control has an integral of its own; the least cost of heading error and rudder.
    mode : {"course", "rate"}
        What is held: a course, or a rate of turn, as in a bend; the gains of the rate error and its integral are those of rate
        and heading.
    omega_n : str or float, optional
        Natural frequency of the heading in rad/s at the ship's own speed, or with a unit; it follows u/L. By default the one
        at which the rudder angle equals the heading error, or that of the ship itself where that is faster; less where a dead time of
        the rudder bears no more.
    damping : float, optional
        Damping ratio of the heading; 0.9 by default.
    integral : float
        For ``"pid"``: the third pole over `omega_n`.
    rudder_weight : float
        For ``"lqr"``: weight of the rudder squared against the heading error squared.
    rudder_limit : str or float
        Largest rudder angle the autopilot orders, in rad or with a unit.

    Returns
    -------
    Autopilot

    Raises
    ------
    NotSteerableError
        If the model has no rudder, heading or rate of turn, or is uncontrollable at a speed.
    UnstableDesignError
        If the request leaves the loop unstable.
    DesignRequestError, UnknownNameError
        If the request is out of range, or a name is not known.
    UnstatedInputError
        If the model reads an input that a straight course does not state and that declares no default.
    """
    design = design or default_design(mode)
    if design not in DESIGNS:
        raise UnknownNameError("design", design, DESIGNS)
    if mode not in MODES:
        raise UnknownNameError("mode", mode, MODES)
    if mode == "rate" and design == "pid":
        raise DesignRequestError("the mode rate has an integral of its own, and takes no design pid. Take pole or lqr.")
    whole = model_of(model)
    check_steerable(whole)
    given = list(ship) if isinstance(ship, Sequence) and not isinstance(ship, str) else [ship]
    if not given:
        raise DesignRequestError("an autopilot needs a ship: give one, or one for each load condition.")
    ships = tuple(ship_of(s) for s in given)
    own = _own_speed(ships[0])
    grid = parse_speeds(speeds, own)
    service = own if own is not None else float(np.median(grid))
    machine = known_component(actuator) if isinstance(actuator, str) else DirectRudder if actuator is None else actuator
    machine = actuator_of(whole, machine)
    check_carries_delay(whole, machine)
    limits, warnings = _limits(ships[0], machine)
    limit = to_si(rudder_limit, "rad", "the rudder limit") if isinstance(rudder_limit, str) else float(rudder_limit)
    if not 0 < limit <= np.pi / 2:
        raise DesignRequestError(
            f"a rudder limit of {angle(limit, 6)} is out of range: give one above zero, to 90 deg."
        )
    if limit > limits["delta_max"]:
        limit = limits["delta_max"]
        warnings.append(f"rudder limit: the rudder itself stops at {angle(limit, 3)}, which is used.")
    request = read_request(whole, ships, service, design, omega_n, damping, integral, rudder_weight)
    problem = GainDesign(whole, ships, design, request, service)
    schedule = _refined(problem, grid)
    warnings += design_warnings(problem, schedule, limit, limits)
    dead_time = dead_time_of(whole, ships[0], service)
    if omega_n is None and request.get("omega_n", 0.0) * dead_time > 0.999 * DEAD_ANGLE:
        warnings.append(
            f"dead time: the rudder acts {brief(dead_time)} s late, by which the natural frequency was chosen, {brief(request['omega_n'])} rad/s; a "
            "gear without it bears a faster one."
        )
    if mode == "rate":
        warnings.append(
            "rate of turn: the heading is not fed back, so that it drifts with the bias of the rate gyro; the course changes of "
            "the judgement have a gyro without bias."
        )
    poles = schedule_poles(whole, ships, schedule)
    return Autopilot(
        whole, ships, machine, design, mode, request, service, limit, limits, schedule, poles, tuple(warnings)
    )


def default_design(mode: Mode) -> Design:
    """Return how gains are found where nothing is asked for: with an integral, as wind turns a ship off its course for good.

    Parameters
    ----------
    mode : {"course", "rate"}
        What the autopilot holds.
    """
    return "pole" if mode == "rate" else "pid"


def _refined(problem: GainDesign, grid: np.ndarray) -> Schedule:
    """The schedule, with speeds added until the poles between them are those requested."""
    known: dict[float, list[Gains]] = {}
    while True:
        fresh = np.array([v for v in grid if v not in known])
        for condition in range(len(problem.ships)):
            plants = problem.plants(fresh, condition)
            for i, speed in enumerate(fresh):
                known.setdefault(float(speed), []).append(problem.gains(plants.at(i), float(speed)))
        names = ("Kp", "Kd", "Ki") if problem.design == "pid" else ("Kp", "Kd")
        gains = {
            n: np.array([[getattr(known[float(v)][j], n) for v in grid] for j in range(len(problem.ships))])
            for n in names
        }
        schedule = Schedule(grid, gains)
        coarse = _coarse(problem, schedule)
        if not coarse:
            return schedule
        if len(grid) + len(coarse) > MOST_SPEEDS:
            raise DesignRequestError(
                f"between {brief(coarse[0])} m/s and its neighbours no schedule of {MOST_SPEEDS} speeds keeps the poles within "
                f"{percent(TOLERANCE)} of those requested. Begin at a higher speed, or request poles that this ship can have there."
            )
        grid = np.sort(np.concatenate([grid, coarse]))


def _coarse(problem: GainDesign, schedule: Schedule) -> list[float]:
    """Middles of the intervals between two speeds in which the poles are off by more than the tolerance."""
    grid = schedule.speeds
    if len(grid) < 2:
        return []
    between = (grid[:-1, None] + np.diff(grid)[:, None] * np.array(_BETWEEN)).ravel()
    off = np.zeros(len(between), dtype=bool)
    for condition in range(len(problem.ships)):
        plants = problem.plants(between, condition)
        for i, speed in enumerate(between):
            plant = plants.at(i)
            asked = problem.wanted_poles(plant, float(speed))
            found = closed_poles(plant, schedule.gains_at(float(speed), condition))
            away = np.abs(found[:, None] - asked[None, :]).min(axis=0) / np.abs(asked)
            off[i] |= bool(away.max() > TOLERANCE or found.real.max() >= 0)
    return list(0.5 * (grid[:-1] + grid[1:])[off.reshape(-1, len(_BETWEEN)).any(axis=1)])


def _own_speed(ship: ParameterSet) -> float | None:
    own = ship.particular("speed", "m/s")
    if own is not None and not own > 0:
        raise ParameterSetError(
            f"the speed of ship {ship.name} is {own:g} m/s; an autopilot needs a speed greater than zero."
        )
    return own


def _limits(ship: ParameterSet, machine: type[Component]) -> tuple[dict[str, float], list[str]]:
    found, assumed = {}, []
    for name, (unit, words) in {"delta_max": ("rad", "rudder angle"), "delta_rate": ("rad/s", "rudder rate")}.items():
        own = ship.particular(name, unit)
        found[name] = _LIMITS[name] if own is None else own
        if not found[name] > 0:
            raise ParameterSetError(f"the largest {words} of ship {ship.name} is {found[name]:g}: give one above zero.")
        if own is None and (name == "delta_max" or machine not in (DirectRudder, LateDirectRudder)):
            assumed.append(
                f"assumed: the largest {words} of ship {ship.name} is not known; {shown(found[name], name, unit, 3)} is taken."
            )
    if ship.particular("L", "m") is None:
        assumed.append(
            f"assumed: the length of ship {ship.name} is not known; the distance it covers in a second is used instead, "
            "and the weather it is judged in is of that size."
        )
    lag = ship.particular("tau_delta", "s")
    return found | ({} if lag is None else {"tau_delta": lag}), assumed
