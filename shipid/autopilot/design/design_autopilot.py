"""The verb: a ship in, a gain-scheduled autopilot out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.placement import (
    Gains,
    check_stable,
    closed_poles,
    lqr_gains,
    natural_frequency,
    place,
    pole_pair,
)
from shipid.autopilot.design.plant import Plant, check_steerable, coefficients_at, linear_plant
from shipid.autopilot.design.schedule import Schedule
from shipid.autopilot.errors import DesignRequestError
from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.units import factor, split, to_si
from shipid.foundation.errors import ParameterSetError, UnitError, UnknownNameError
from shipid.generation.system import generate
from shipid.parameters.catalogue import find_model, find_ship, known_component, whole_ship
from shipid.parameters.parameter_set import ParameterSet
from shipid.parts.helm import DirectRudder

DESIGNS = ("pole", "lqr", "pid")
#: The third pole, that of the integral, over the natural frequency: slow beside the course change, quick beside the weather.
INTEGRAL = 0.15
#: How far a pole between two speeds of the schedule may lie from the one asked for there, over its size.
TOLERANCE = 0.05
#: Most speeds of a schedule, refined.
_MOST = 64
#: Where between two speeds the poles are looked at.
_BETWEEN = (0.25, 0.5, 0.75)
#: Speeds outside those of the trials by less than this part are no extrapolation.
_SLACK = 0.05
#: Assumed where a ship does not say: 35 deg, and the 65 deg in 28 s of SOLAS II-1/29.
_LIMITS = {"delta_max": np.deg2rad(35.0), "delta_rate": np.deg2rad(65.0 / 28.0)}


def design_autopilot(
    model: Model | str | Any,
    ship: ParameterSet | str | Sequence[ParameterSet | str],
    *,
    actuator: type[Component] | str | None = "SteeringMachine",
    speeds: str | Sequence[float] | None = None,
    design: str = "pole",
    omega_n: str | float | None = None,
    damping: float | None = None,
    integral: float = INTEGRAL,
    rudder_weight: float = 1.0,
    rudder_limit: str | float = "15 deg",
) -> Autopilot:
    """Design a gain-scheduled autopilot from a declared ship, linearised exactly at each speed.

    The gains of heading and rate of turn are found at each speed, and more speeds are taken in until the poles of the loop
    stay within 5 % of those asked for at every speed between.

    Parameters
    ----------
    model : Model, component class or str
        The ship's model; a component is joined with planar motion, a name is looked up.
    ship : ParameterSet, str, or sequence of them
        The ship; several are load conditions of one ship, between which the schedule is linear.
    actuator : component class, str or None
        The steering machine, by default the installed `SteeringMachine`; None for a rudder that is where it is ordered.
        The gains are those of the ship alone, as published; the judgement holds the machine.
    speeds : str or sequence of float, optional
        ``"4:12:1 m/s"``, ``"8,12,16 kn"``, or numbers in m/s (text without a unit counts in m/s); by default 0.5 to 1.2 of
        the ship's own speed, by tenths of it.
    design : {"pole", "lqr", "pid"}
        Poles placed; the least cost of heading error and rudder; poles placed with an integral for a steady moment.
    omega_n : str or float, optional
        Natural frequency of the heading in rad/s at the ship's own speed, or with a unit; it follows u/L. By default the one
        at which the rudder goes as many degrees as the heading is off, or that of the ship itself where that is faster.
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
        If the request is none.
    """
    if design not in DESIGNS:
        raise UnknownNameError("design", design, DESIGNS)
    whole = find_model(model) if isinstance(model, str) else model if isinstance(model, Model) else whole_ship(model)
    check_steerable(whole)
    given = [ship] if isinstance(ship, (str, ParameterSet)) else list(ship)
    if not given:
        raise DesignRequestError("an autopilot needs a ship: give one, or one for each load condition.")
    ships = tuple(find_ship(s) if isinstance(s, str) else s for s in given)
    own = _own_speed(ships[0])
    grid = parse_speeds(speeds, own)
    service = own if own is not None else float(np.median(grid))
    machine = known_component(actuator) if isinstance(actuator, str) else DirectRudder if actuator is None else actuator
    limits, warnings = _limits(ships[0], machine)
    limit = to_si(rudder_limit, "rad", "the rudder limit") if isinstance(rudder_limit, str) else float(rudder_limit)
    if not 0 < limit <= np.pi / 2:
        raise DesignRequestError(f"a rudder limit of {np.rad2deg(limit):g} deg steers nothing: give one above zero.")
    if limit > limits["delta_max"]:
        limit = limits["delta_max"]
        warnings.append(f"rudder limit: the rudder itself stops at {np.rad2deg(limit):.3g} deg, which is taken.")
    request = _request(whole, ships, service, design, omega_n, damping, integral, rudder_weight)
    wish = _Wish(whole, ships, design, request, service)
    schedule = _refined(wish, grid)
    warnings += (
        _outside(whole, ships, schedule.speeds) + _about_ship(wish, schedule) + _too_fast(wish, schedule, limit, limits)
    )
    return Autopilot(whole, ships, machine, design, request, service, limit, limits, schedule, tuple(warnings))


class _Wish:
    """What is asked for at any speed: the poles, and the gains that give them."""

    def __init__(
        self, model: Model, ships: tuple[ParameterSet, ...], design: str, request: Mapping[str, float], service: float
    ) -> None:
        self.model, self.ships, self.design, self.request, self.service = model, ships, design, request, service

    def plants(self, speeds: np.ndarray, condition: int) -> Plant:
        """The ship alone at these speeds."""
        system = generate(self.model)
        ship = self.ships[condition]
        p = [system.vector(system.coefficients, coefficients_at(self.model, ship, float(v)).values) for v in speeds]
        return linear_plant(self.model, speeds, np.stack(p, axis=1))

    def pace(self, speed: float) -> float:
        """u/L; for a ship without a length, u over a length it sails in a second at its own speed."""
        return speed / (self.ships[0].particular("L", "m") or self.service)

    def polynomial(self, speed: float) -> np.ndarray:
        """The poles asked for."""
        omega = self.request["omega_n"] * speed / self.service
        pair = pole_pair(omega, self.request["damping"])
        return np.polymul(pair, [1.0, self.request["integral"] * omega]) if self.design == "pid" else pair

    def asked(self, plant: Plant, speed: float) -> np.ndarray:
        """The poles asked for; those of the least cost are all of them."""
        if self.design == "lqr":
            return closed_poles(plant, self.gains(plant, speed))
        return np.roots(self.polynomial(speed))

    def gains(self, plant: Plant, speed: float) -> Gains:
        """The gains, with a look at the poles that were not asked for."""
        if self.design == "lqr":
            return lqr_gains(plant, self.request["rudder_weight"], self.pace(speed))
        found = place(plant, self.polynomial(speed))
        check_stable(closed_poles(plant, found), f"the loop of {self.ships[0].name} at {speed:.4g} m/s")
        return found


def _refined(wish: _Wish, grid: np.ndarray) -> Schedule:
    """The schedule, with speeds added until the poles between them are those asked for."""
    known: dict[float, list[Gains]] = {}
    while True:
        fresh = np.array([v for v in grid if v not in known])
        for condition in range(len(wish.ships)):
            plants = wish.plants(fresh, condition)
            for i, speed in enumerate(fresh):
                known.setdefault(float(speed), []).append(wish.gains(plants.at(i), float(speed)))
        names = ("Kp", "Kd", "Ki") if wish.design == "pid" else ("Kp", "Kd")
        gains = {
            n: np.array([[getattr(known[float(v)][j], n) for v in grid] for j in range(len(wish.ships))]) for n in names
        }
        schedule = Schedule(grid, gains)
        coarse = _coarse(wish, schedule)
        if not coarse:
            return schedule
        if len(grid) + len(coarse) > _MOST:
            raise DesignRequestError(
                f"between {coarse[0]:.3g} m/s and its neighbours no schedule of {_MOST} speeds keeps the poles within "
                f"{TOLERANCE:.0%} of those asked for. Begin at a higher speed, or ask for what this ship can have there."
            )
        grid = np.sort(np.concatenate([grid, coarse]))


def _coarse(wish: _Wish, schedule: Schedule) -> list[float]:
    """Middles of the intervals between two speeds in which the poles stray."""
    grid = schedule.speeds
    if len(grid) < 2:
        return []
    between = (grid[:-1, None] + np.diff(grid)[:, None] * np.array(_BETWEEN)).ravel()
    astray = np.zeros(len(between), dtype=bool)
    for condition in range(len(wish.ships)):
        plants = wish.plants(between, condition)
        for i, speed in enumerate(between):
            plant = plants.at(i)
            asked = wish.asked(plant, float(speed))
            found = closed_poles(plant, Gains(**{n: float(g) for n, g in schedule.at(speed, condition).items()}))
            away = np.abs(found[:, None] - asked[None, :]).min(axis=0) / np.abs(asked)
            astray[i] |= bool(away.max() > TOLERANCE or found.real.max() >= 0)
    return list(0.5 * (grid[:-1] + grid[1:])[astray.reshape(-1, len(_BETWEEN)).any(axis=1)])


def _request(
    model: Model,
    ships: tuple[ParameterSet, ...],
    service: float,
    design: str,
    omega_n: str | float | None,
    damping: float | None,
    integral: float,
    weight: float,
) -> dict[str, float]:
    if design == "lqr":
        if omega_n is not None or damping is not None:
            raise DesignRequestError(
                "lqr finds frequency and damping by itself: give rudder_weight, or ask for pole or pid."
            )
        if not 0 < weight < np.inf:
            raise DesignRequestError(f"a rudder weight of {weight:g} is none: give one greater than zero.")
        return {"rudder_weight": float(weight)}
    zeta = 0.9 if damping is None else float(damping)
    if not 0.05 <= zeta <= 10:
        raise DesignRequestError(f"a damping ratio of {zeta:g} is none to steer with: give one from 0.05 to 10.")
    if omega_n is None:
        omega = _default_omega(model, ships[0], service, zeta)
    else:
        omega = to_si(omega_n, "rad/s", "omega_n") if isinstance(omega_n, str) else float(omega_n)
    if not 0 < omega < np.inf:
        raise DesignRequestError(f"a natural frequency of {omega:g} rad/s is none: give one greater than zero.")
    found = {"omega_n": omega, "damping": zeta}
    if design == "pid":
        if not 0.01 <= integral <= 1:
            raise DesignRequestError(f"a third pole of {integral:g} omega_n is none to steer with: give 0.01 to 1.")
        found["integral"] = float(integral)
    return found


def _default_omega(model: Model, ship: ParameterSet, service: float, damping: float) -> float:
    system = generate(model)
    known = coefficients_at(model, ship, service).values
    plant = linear_plant(model, np.array([service]), system.vector(system.coefficients, known)[:, None]).at(0)
    return natural_frequency(plant, damping, service / (ship.particular("L", "m") or service))


def _own_speed(ship: ParameterSet) -> float | None:
    own = ship.particular("speed", "m/s")
    if own is not None and not own > 0:
        raise ParameterSetError(f"the speed of ship {ship.name} is {own:g} m/s; an autopilot steers a ship under way.")
    return own


def parse_speeds(text: str | Sequence[float] | None, own: float | None) -> np.ndarray:
    """Read the speeds of a schedule.

    Parameters
    ----------
    text : str, sequence of float or None
        ``"4:12:1 m/s"``, ``"8,12,16 kn"``, numbers in m/s, or None for 0.5 to 1.2 of the ship's own speed.
    own : float or None
        That speed in m/s.

    Returns
    -------
    ndarray
        In m/s, rising.

    Raises
    ------
    DesignRequestError
        If it is no list of speeds greater than zero.
    ParameterSetError
        If there is neither a list nor a speed of the ship's own.
    """
    if text is None:
        if own is None:
            raise ParameterSetError("the ship has no speed of its own: say for which speeds, as in --speeds 4:12:1.")
        return np.round(own * np.arange(0.5, 1.25, 0.1), 6)
    found = _spoken(text) if isinstance(text, str) else np.array(sorted({float(v) for v in text}))
    if not len(found) or not np.isfinite(found).all() or found.min() <= 0:
        raise DesignRequestError(f"the speeds {text} are none to steer at: give numbers greater than zero.")
    if len(found) > _MOST:
        raise DesignRequestError(f"{len(found)} speeds are more than a schedule holds ({_MOST}). Take a wider step.")
    return found


def _spoken(text: str) -> np.ndarray:
    refusal = DesignRequestError(
        f"the speeds '{text}' are neither FROM:TO:STEP nor a list, as in '4:12:1 m/s' or '8,12 kn'."
    )
    parts = text.split(":") if ":" in text else text.split(",")
    try:
        numbers, (last, unit) = [float(p) for p in parts[:-1]], split(parts[-1])
    except (ValueError, UnitError):
        raise refusal from None
    scale = factor(unit or "m/s", "m/s", "the speeds")
    if ":" not in text:
        return np.unique(np.array([*numbers, last]) * scale)
    if len(numbers) == 1:
        numbers, last = [*numbers, last], 0.1 * (last - numbers[0])
    if len(numbers) != 2 or not last > 0 or not numbers[1] >= numbers[0] or (numbers[1] - numbers[0]) / last > 1e4:
        raise refusal
    count = int(np.floor((numbers[1] - numbers[0]) / last + 1e-9)) + 1
    return (numbers[0] + last * np.arange(count)) * scale


def _limits(ship: ParameterSet, machine: type[Component]) -> tuple[dict[str, float], list[str]]:
    found, assumed = {}, []
    for name, (unit, words) in {"delta_max": ("rad", "rudder angle"), "delta_rate": ("rad/s", "rudder rate")}.items():
        own = ship.particular(name, unit)
        found[name] = _LIMITS[name] if own is None else own
        if not found[name] > 0:
            raise ParameterSetError(f"the largest {words} of ship {ship.name} is {found[name]:g}: give one above zero.")
        if own is None and (name == "delta_max" or machine is not DirectRudder):
            shown = f"{np.rad2deg(found[name]):.3g} deg" + ("/s" if unit == "rad/s" else "")
            assumed.append(f"assumed: the largest {words} of ship {ship.name} is not known; {shown} is taken.")
    if ship.particular("L", "m") is None:
        assumed.append(
            f"assumed: the length of ship {ship.name} is not known; what it sails in a second stands in, and the weather it is "
            "judged in is of that size."
        )
    lag = ship.particular("tau_delta", "s")
    return found | ({} if lag is None else {"tau_delta": lag}), assumed


def _outside(model: Model, ships: tuple[ParameterSet, ...], speeds: np.ndarray) -> list[str]:
    found = []
    for ship in ships:
        known = [coefficients_at(model, ship, float(v)) for v in (speeds[0], speeds[-1])]
        span = known[0].span
        if span and (speeds[0] < span[0] * (1 - _SLACK) or speeds[-1] > span[1] * (1 + _SLACK)):
            found.append(
                f"outside the identified range: ship {ship.name} was tried from {span[0]:.3g} to {span[1]:.3g} m/s, and the "
                f"schedule runs from {speeds[0]:.3g} to {speeds[-1]:.3g} m/s; beyond the trials it is extrapolation."
            )
        elif not span and any(k.scaled for k in known):
            found.append(
                f"scaled by speed: the coefficients of {model.name} hold at {ship.particular('speed', 'm/s'):.3g} m/s; at other "
                "speeds they are scaled by L and L/U, which a ship follows only roughly."
            )
    return found


def _about_ship(wish: _Wish, schedule: Schedule) -> list[str]:
    found = []
    for condition, ship in enumerate(wish.ships):
        plants = wish.plants(schedule.speeds, condition)
        # The heading is the integral of the rate of turn: one root of the ship is zero whatever it is.
        roots = [np.roots(d) for d in plants.denominator]
        growing = [float(np.sort(r.real)[-1]) for r in roots]
        if max(growing) > 1e-9 * max(float(np.abs(r).max()) for r in roots):
            worst = int(np.argmax(growing))
            found.append(
                f"course-unstable: without the autopilot ship {ship.name} turns away by itself, within "
                f"{1 / growing[worst]:.3g} s at {schedule.speeds[worst]:.3g} m/s; its loop has a lower gain margin too."
            )
        if (schedule.gains["Kd"][condition] * schedule.gains["Kp"][condition] < 0).any():
            found.append(
                f"negative rate gain: the request is slower than ship {ship.name} itself, so the law pushes the turn on. Ask for "
                "a higher natural frequency or damping."
            )
        if (schedule.gains["Kp"][condition] < 0).any():
            found.append(f"reversed rudder: positive rudder turns ship {ship.name} to port; the gains are negative.")
    return found


def _too_fast(wish: _Wish, schedule: Schedule, limit: float, limits: Mapping[str, float]) -> list[str]:
    """Whether the rudder can follow an oscillation at the natural frequency as wide as the rudder limit."""
    speed = float(schedule.speeds[-1])
    plant = wish.plants(np.array([speed]), 0).at(0)
    omega = float(np.sqrt(np.abs(np.prod(wish.asked(plant, speed)[:2]))))
    needed = omega * limit
    if needed <= limits["delta_rate"]:
        return []
    return [
        f"rudder rate: at {speed:.3g} m/s the loop is asked for {omega:.3g} rad/s, at which a rudder swinging to its limit of "
        f"{np.rad2deg(limit):.3g} deg needs {np.rad2deg(needed):.3g} deg/s, and it has {np.rad2deg(limits['delta_rate']):.3g} "
        f"deg/s. At most {limits['delta_rate'] / limit * wish.service / speed:.3g} rad/s at {wish.service:.3g} m/s can be met."
    ]
