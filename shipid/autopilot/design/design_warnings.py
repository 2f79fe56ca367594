"""Warnings of a design: its assumptions, and limits of the ship."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.autopilot.design.gain_design import GainDesign
from shipid.autopilot.design.schedule import Schedule
from shipid.declaration.model import Model
from shipid.declaration.vocabulary import angle, shown
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief
from shipid.generation.system import generate
from shipid.parameters.held_inputs import held_inputs
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.ship_coefficients import coefficients_at
from shipid.parameters.validity import BEYOND, MARGIN, beyond, range_of, speed_words


def design_warnings(
    problem: GainDesign, schedule: Schedule, rudder_limit: float, limits: Mapping[str, float]
) -> list[str]:
    """Return the warnings of a design in words.

    Parameters
    ----------
    problem : GainDesign
        The problem with its request.
    schedule : Schedule
        The gains found.
    rudder_limit : float
        Of the autopilot, in rad.
    limits : mapping of str to float
        Constants of the steering machine, SI.
    """
    return (
        _outside_trials(problem.model, problem.ships, schedule.speeds)
        + [n for ship in problem.ships for n in beyond(problem.model, ship, rudder=rudder_limit)]
        + _held(problem.model, schedule.speeds)
        + _about_ship(problem, schedule)
        + _too_fast(problem, schedule, rudder_limit, limits)
    )


def _outside_trials(model: Model, ships: tuple[ParameterSet, ...], speeds: np.ndarray) -> list[str]:
    found: list[str] = []
    for ship in ships:
        known = [coefficients_at(model, ship, float(v)) for v in (speeds[0], speeds[-1])]
        span = known[0].span
        outside = span and (speeds[0] < span[0] * (1 - MARGIN) or speeds[-1] > span[1] * (1 + MARGIN))
        if span and outside:
            section = range_of(ship, model)
            words = (
                f"The schedule runs from {brief(speeds[0])} to {brief(speeds[-1])} m/s: the [{section[0] if section else model.name}] "
                f"coefficients of ship {ship.name} were found at {speed_words(span)}. Beyond that the model extrapolates, and no band "
                "contains that error."
            )
            found.append(Notice(words, BEYOND, quantity="u"))
        if any(k.scaled for k in known) and (outside or not span):
            belongs_to = next(k.reference for k in known if k.scaled)
            found.append(
                f"scaled by speed: the coefficients of {model.name} hold at {brief(belongs_to)} m/s; at other "
                "speeds they are scaled by L and L/U, which a ship follows only roughly."
            )
    return found


def _held(model: Model, speeds: np.ndarray) -> list[str]:
    """What holds the speed of the ship, such as the revolutions, is the same at every speed of the schedule."""
    if len(speeds) < 2 or "u" not in model.states:
        return []
    system = generate(model)
    held = {n: c for n, c in held_inputs(model).items() if "u" in system.states_driven_by([c])}
    return [
        f"'{name}' is held at {shown(model[constant].number('default') or 0.0, name, model[constant].unit)} at every speed of the schedule, "
        f"from {brief(speeds[0])} to {brief(speeds[-1])} m/s: a ship that sails at another speed by another '{name}' is not judged. Tune each "
        "speed with its own, as in --speeds with one speed."
        for name, constant in held.items()
    ]


def _about_ship(problem: GainDesign, schedule: Schedule) -> list[str]:
    found = []
    for condition, ship in enumerate(problem.ships):
        plants = problem.plants(schedule.speeds, condition)
        # The heading is the integral of the rate of turn: one root of the ship is zero whatever it is.
        roots = [np.roots(d) for d in plants.denominator]
        growing = [float(np.sort(r.real)[-1]) for r in roots]
        if max(growing) > 1e-9 * max(float(np.abs(r).max()) for r in roots):
            worst = int(np.argmax(growing))
            found.append(
                f"course-unstable: without the autopilot ship {ship.name} leaves its course with a time constant of "
                f"{brief(1 / growing[worst])} s at {brief(schedule.speeds[worst])} m/s; its loop has a lower gain margin too."
            )
        if (schedule.gains["Kd"][condition] * schedule.gains["Kp"][condition] < 0).any():
            found.append(
                f"negative rate gain: the request is slower than ship {ship.name} itself, so the rate gain drives the turn. Take "
                "a higher natural frequency or damping."
            )
        if (schedule.gains["Kp"][condition] < 0).any():
            found.append(f"reversed rudder: positive rudder turns ship {ship.name} to port; the gains are negative.")
    return found


def _too_fast(problem: GainDesign, schedule: Schedule, limit: float, limits: Mapping[str, float]) -> list[str]:
    """Whether the rudder can follow an oscillation at the natural frequency as wide as the rudder limit."""
    speed = float(schedule.speeds[-1])
    plant = problem.plants(np.array([speed]), 0).at(0)
    omega = float(np.sqrt(np.abs(np.prod(problem.wanted_poles(plant, speed)[:2]))))
    needed = omega * limit
    if needed <= limits["delta_rate"]:
        return []
    return [
        f"rudder rate: at {brief(speed)} m/s the request is {brief(omega)} rad/s, at which a rudder swinging to its limit of "
        f"{angle(limit, 3)} needs {brief(np.rad2deg(needed))} deg/s, and its limit is {brief(np.rad2deg(limits['delta_rate']))} "
        f"deg/s. At most {brief(limits['delta_rate'] / limit * problem.service_speed / speed)} rad/s at {brief(problem.service_speed)} m/s can be met."
    ]
