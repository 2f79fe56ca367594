"""Sail a ship under its autopilot: courses ordered one after the other, recorded as a trial."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import shipid
from shipid.autopilot.course_changes.run_course_changes import PACE, stiffest
from shipid.autopilot.course_changes.turn_order import RADIUS, TurnOrder
from shipid.autopilot.course_changes.weather import CALM
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import closed_loop, coefficients_of
from shipid.declaration.component import Component
from shipid.declaration.guard import NOT_SAILED
from shipid.declaration.model import Model
from shipid.declaration.vocabulary import shown
from shipid.foundation.errors import UsageError
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief, moment
from shipid.generation.simulator import make_simulator
from shipid.parameters.catalogue import model_of, ship_of
from shipid.parameters.parameter_set import ParameterSet, missing_values
from shipid.parameters.replaced import with_values
from shipid.parameters.validity import beyond_in_run
from shipid.parts.manoeuvring_range import manoeuvring_range
from shipid.parts.waves import Waves
from shipid.prediction.sailing.rudder_at_rate import CYCLES, cycles_at_rate
from shipid.prediction.sailing.surroundings import stated_inputs, stated_values, with_waves
from shipid.prediction.tracks.order import unwrapped
from shipid.trials.manoeuvres.flows import (
    Flow,
    check_flows,
    flow_inputs,
    logged_beside,
    met_words,
    number,
    parts_in_wind,
)
from shipid.trials.manoeuvres.noise import measured, noise_words, own_seed, parse_noise
from shipid.trials.manoeuvres.sea import driven_by
from shipid.trials.manoeuvres.simulate import RECORDED, NotSailedError, usual_interval_of
from shipid.trials.source import Source
from shipid.trials.trial import Trial

#: After the last order the ship sails so far, in L/U.
_AFTER = 25.0


def sail(
    pilot: Autopilot,
    courses: Sequence[tuple[str | float, str | float]] | str | float,
    *,
    model: Model | type[Component] | str | None = None,
    ship: ParameterSet | str | Path | None = None,
    speed: str | float | None = None,
    heading: str | float = 0.0,
    duration: str | float | None = None,
    sampling: str | float | None = None,
    rudder_limit: str | float | None = None,
    current: Flow | None = None,
    wind: Flow | None = None,
    waves: Flow | None = None,
    inputs: Mapping[str, str | float] | None = None,
    noise: str | Mapping[str, str | float] | None = None,
    values: Mapping[str, str | float] | None = None,
    seed: int = 0,
    name: str | None = None,
) -> Trial:
    """Sail courses under an autopilot and return what happened as a trial.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot.
    courses : sequence of (time, heading), or one heading
        When in s, or with a unit, and what heading is ordered then, with a unit or in rad; one heading alone is ordered after five
        L/U. Each is reached the shorter way round.
    model : Model, component class or str, optional
        The ship that sails, where it is not the one the autopilot was designed on.
    ship : ParameterSet, str or Path, optional
        Its coefficients; the autopilot's own ship by default.
    speed : str or float, optional
        Speed before the first change; by default the ship's own.
    heading : str or float
        Heading at the beginning.
    duration, sampling : str or float, optional
        By default 25 L/U after the last order, and a thirtieth of L/U rounded.
    rudder_limit : str or float, optional
        Largest rudder angle the autopilot orders; its own by default.
    current, wind : str or tuple, optional
        Speed and direction it flows TO, with units or in SI.
    waves : str or tuple, optional
        Root mean square of the heading by waves, and the direction they run TO, with units or in SI; see `shipid.simulate`.
    inputs : mapping of str to str or float, optional
        Constant inputs of the model, with units or in SI.
    noise : str or mapping, optional
        See `shipid.simulate`.
    values : mapping of str to str or float, optional
        Coefficients that replace those of the ship, with a unit or in SI.
    seed : int
        Of the waves and the noise.
    name : str, optional
        Name of the trial.

    Returns
    -------
    Trial
        SI columns; ``psi`` and ``r`` with the waves in them where there are any.

    Raises
    ------
    UsageError
        If an order, a time or a flow does not fit.
    UnknownNameError
        If a value is none of the model's coefficients.
    UnstatedInputError
        If the model reads an input that nothing states and that declares no default.
    NotSailedError
        If the model leaves the range in which it is valid, or runs away.
    """
    pilot, truth = steering(pilot, model, ship, values)
    u0 = pilot.own_speed if speed is None else number(speed, "m/s", "the speed")
    if not u0 > 0:
        raise UsageError(f"a speed of {u0:g} m/s does not steer a ship: give one greater than zero.")
    unit_time = 1 / pilot.pace(u0)
    course = number(heading, "rad", "the heading")
    orders = _orders(courses, 5 * unit_time, course)
    check_flows(truth, current, wind)
    end = orders[-1][0] + _AFTER * unit_time if duration is None else number(duration, "s", "the duration")
    interval = usual_interval_of(unit_time) if sampling is None else number(sampling, "s", "the sampling interval")
    if not 0 < interval < end:
        raise UsageError(f"a sampling interval of {interval:g} s does not fit a voyage of {end:g} s.")
    parts: list[type[Component]] = [TurnOrder] if pilot.mode == "rate" else []
    parts += manoeuvring_range(truth)
    parts += parts_in_wind(truth, wind)
    shows = waves is not None and driven_by(truth)[0] == "wave_noise"
    parts += [Waves] if shows else []
    whole = closed_loop(pilot, *parts)
    finest = min(stiffest(pilot, whole, np.array([u0])), PACE * unit_time)
    fine = max(1, int(np.ceil(interval / finest - 1e-9)))
    count = round(end / interval)
    if count * fine > 1e7:
        raise UsageError(
            f"a voyage of {brief(end, 3)} s at {brief(interval, 3)} s takes more than 1e7 steps: ask for a shorter one."
        )
    t = np.arange(count * fine + 1) * (interval / fine)
    acting: dict[str, float | np.ndarray] = {
        **CALM,
        "u": u0,
        "cruise": u0,
        **flow_inputs(current, wind),
        **(held := stated_inputs(whole, inputs)),
    }
    acting["psi_order"] = np.select([t >= w for w, _ in reversed(orders)], [h for _, h in reversed(orders)], course)
    known = coefficients_of(pilot, whole, u0) | stated_values(whole, values)
    known |= {"turn_rate": u0 / (RADIUS * pilot.length)} if pilot.mode == "rate" else {}
    if rudder_limit is not None:
        known["rudder_limit"] = number(rudder_limit, "rad", "the rudder limit")
    if waves is not None:
        known, acting = with_waves(truth, waves, known, acting, pilot.length, u0, interval / fine, t.size, seed)
    if (lacking := missing_values(whole, known, f"ship {pilot.ship.name}")) is not None:
        raise lacking
    recorded = {n: n for n in RECORDED if n in whole}
    if shows:
        recorded |= {"psi": "psi_seen", "r": "r_seen"}
    run = make_simulator(whole, tuple(recorded.values()), hold="zero", compiled=False)(
        t, known, acting, {"u": u0, "psi": course, "psi_behind": course, "psi_ramp": course}
    )
    if run.departure is not None:
        raise NotSailedError(
            f"the voyage of ship {pilot.ship.name} at {brief(u0, 3)} m/s is {NOT_SAILED} ({truth.name}): {run.departure.reason}, "
            f"{brief(run.departure.time, 4)} s after the start. A smaller rudder limit keeps it within its range."
        )
    deviations = parse_noise(noise)
    said = ", ".join(f"{shown(h % (2 * np.pi), 'psi')} at {moment(w)} s" for w, h in orders)
    draws = own_seed(seed, f"{said}, {brief(u0, 4)} m/s")
    table = measured({n: run[q][::fine] for n, q in recorded.items()}, t[::fine], deviations, draws)
    beside, units = logged_beside(truth, wind, held)
    table = table.assign(**{n: value for n, value in beside.items() if n not in table})
    comment = (
        f"Simulated, not measured: shipid {shipid.__version__}, model {truth.name}, ship {pilot.ship.name}, autopilot "
        f"({pilot.design}) ordered {said}, {brief(u0, 4)} m/s, noise {noise_words(deviations)}, seed {seed}"
        f"{met_words(current, wind, waves, driven_by(truth)[1], values)}"
    )
    told = beyond_in_run(truth, pilot.ship, u0, {n: run[q] for n, q in recorded.items()})
    gear = known.get("delta_rate", pilot.limits["delta_rate"])
    if (cycles := cycles_at_rate(t, run["delta"], float(np.min(gear)))) and waves is not None:
        # A sound loop in waves answers them at the limit; one that cycles does so without them.
        calm = sail(
            pilot, courses, speed=u0, heading=course, duration=end, sampling=interval, rudder_limit=rudder_limit, current=current,
            wind=wind, inputs=inputs, values=values,
        )  # fmt: skip
        cycles = [n for n in calm.source.notes if isinstance(n, Notice) and n.kind == CYCLES]
    told = [*told, *cycles]
    return Trial(
        name or f"{truth.name}-courses",
        table,
        Source(simulated=True, comment=comment, notes=(comment, *told)),
        ship=pilot.ship.name,
        units=units,
    )


def steering(
    pilot: Autopilot,
    model: Model | type[Component] | str | None,
    ship: ParameterSet | str | Path | None,
    values: Mapping[str, str | float] | None = None,
) -> tuple[Autopilot, Model]:
    """Return an autopilot with its gains on the ship that sails, and the model of that ship.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot.
    model : Model, component class or str, optional
        The ship that sails; the autopilot's own by default.
    ship : ParameterSet, str or Path, optional
        Its coefficients.
    values : mapping of str to str or float, optional
        Those that its set lacks are taken from here.

    Returns
    -------
    pilot : Autopilot
    model : Model

    Raises
    ------
    UsageError
        If the model has no position or no heading.
    """
    truth = pilot.model if model is None else model_of(model)
    ships = pilot.ships if ship is None else (ship_of(ship),)
    lacked = {n: v for n, v in (values or {}).items() if n in truth.parameters and ships[0].find(truth, n) is None}
    ships = tuple(with_values(s, lacked, [truth]) for s in ships) if lacked else ships
    if truth is pilot.model and ships == pilot.ships:
        return pilot, truth
    if "x" not in truth.states or "psi" not in truth.states:
        raise UsageError(f"model {truth.name} has no position and heading: join it with PlanarMotion.")
    return replace(pilot, model=truth, ships=ships), truth


def _orders(
    courses: Sequence[tuple[str | float, str | float]] | str | float, begin: float, course: float
) -> list[tuple[float, float]]:
    pairs = [(begin, courses)] if isinstance(courses, (str, int, float)) else list(courses)
    if not pairs:
        raise UsageError("a voyage needs a course, as in courses='60 deg'.")
    found: list[tuple[float, float]] = []
    before = course
    for when, wanted in pairs:
        at = number(when, "s", "the time of a course")
        if at < (found[-1][0] if found else 0.0):
            raise UsageError(
                f"the courses are ordered one after the other, and {moment(at)} s is earlier than the one before."
            )
        before = unwrapped(number(wanted, "rad", "a course"), before)
        found.append((at, before))
    return found
