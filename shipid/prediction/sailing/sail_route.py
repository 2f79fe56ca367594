"""Sail a route under the track pilot: a voyage from its first waypoint to its last."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

import shipid
from shipid.autopilot.course_changes.turn_order import RADIUS
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import closed_loop
from shipid.declaration.component import Component
from shipid.declaration.guard import NOT_SAILED
from shipid.declaration.model import Model
from shipid.declaration.vocabulary import shown
from shipid.foundation.errors import UsageError
from shipid.foundation.notices import Notice, notice_of
from shipid.foundation.numbers import brief
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.validity import beyond_in_run
from shipid.parts.manoeuvring_range import FASTEST_TURN, LEAST_SPEED
from shipid.parts.waves import Waves
from shipid.prediction.following.planned_track import PlannedTrack
from shipid.prediction.following.track_pilot import TrackPilot
from shipid.prediction.following.wheel_over import heading_on
from shipid.prediction.routes.route import Route
from shipid.prediction.routes.route_plan import plan_of
from shipid.prediction.routes.sailings import turned
from shipid.prediction.sailing.loop_cycles import loop_cycles
from shipid.prediction.sailing.rudder_at_rate import cycles_at_rate
from shipid.prediction.sailing.sail import steering
from shipid.prediction.sailing.simulated_ship import SimulatedShip
from shipid.prediction.sailing.surroundings import stated_inputs, stated_values, with_waves
from shipid.prediction.sailing.voyage import Voyage, WheelOverDone, limits_left, not_followed, too_late
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import TrackPredictor
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
from shipid.trials.source import Source, origin_words
from shipid.trials.trial import Trial

#: The track pilot gives an order every so many L/U: 2 s for the ship of the thesis.
_ORDERED = 1 / 12
#: A voyage is given up after so many times what the route takes at the ship's own speed, and so many L/U.
_SLOWER, _MORE = 2.5, 100.0
_MOST_STEPS = 1e6
#: A wheel-over is late by more than so many intervals of the orders.
_LATE = 2.0
#: What the pilot knows of the ship.
_KNOWN = ("x", "y", "psi", "r", "u", "v", "delta")


def sail_route(
    pilot: Autopilot,
    route: Route,
    *,
    model: Model | type[Component] | str | None = None,
    ship: ParameterSet | str | Path | None = None,
    speed: str | float | None = None,
    radius: str | float | None = None,
    rudder_limit: str | float | None = None,
    sampling: str | float | None = None,
    duration: str | float | None = None,
    current: Flow | None = None,
    wind: Flow | None = None,
    waves: Flow | None = None,
    inputs: Mapping[str, str | float] | None = None,
    noise: str | Mapping[str, str | float] | None = None,
    values: Mapping[str, str | float] | None = None,
    seed: int = 0,
    name: str | None = None,
) -> Voyage:
    """Sail a route from its first waypoint to its last under the track pilot, in simulation.

    The ship begins on the first leg, with the drift angle that keeps it in the current. The pilot knows her position, her motion, the
    current and the wind as they are; its predictions are those of the autopilot's own ship.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot; it holds a course.
    route : Route
        The route.
    model : Model, component class or str, optional
        The ship that sails, where it is not the one the autopilot was designed on.
    ship : ParameterSet, str or Path, optional
        Its coefficients; the autopilot's own ship by default.
    speed : str or float, optional
        Speed before the first turn; by default the one speed that the route plans, or the ship's own.
    radius : str or float, optional
        Radius of the turns where the route states none; eight ship lengths by default.
    rudder_limit : str or float, optional
        Rudder limit of the turns; by default that with which each turn stays nearest to its arc, the autopilot's own at most.
    sampling, duration : str or float, optional
        A thirtieth of L/U rounded; and until the end of the route.
    current, wind : str or tuple, optional
        Speed and direction it flows TO, with units or in SI.
    waves : str or tuple, optional
        Root mean square of the heading by waves, and the direction they run TO, with units or in SI; see `shipid.simulate`.
    inputs : mapping of str to str or float, optional
        Constant inputs of the model, with units or in SI.
    noise : str or mapping, optional
        See `shipid.simulate`.
    values : mapping of str to str or float, optional
        Coefficients that replace those of the ship, with a unit or in SI; the pilot does not know of them.
    seed : int
        Of the waves and the noise.
    name : str, optional
        Name of the trial; that of the route by default.

    Returns
    -------
    Voyage

    Raises
    ------
    UsageError
        If the autopilot holds a rate of turn, or a value, a flow, a turn or a leg does not fit.
    RoutePlaneError
        If no plane of local metres holds the route.
    UnknownNameError
        If a value is none of the model's coefficients.
    UnstatedInputError
        If the model reads an input that nothing states and that declares no default.
    NotSailedError
        If the ship leaves what a ship can do, or runs away.
    """
    if pilot.mode != "course":
        raise UsageError("an autopilot that holds a rate of turn steers no route: design one that holds a course.")
    steered, truth = steering(pilot, model, ship, values)
    check_flows(truth, current, wind)
    told: list[str] = [*map(notice_of, route.notes)]
    u0 = _speed(pilot, route, speed, told)
    plan = plan_of(route, radius=_radius(pilot, route, radius, told))
    flows = flow_inputs(current, wind)
    windy = parts_in_wind(truth, wind)
    helm = TrackPilot(
        TrackPredictor(pilot, parts=parts_in_wind(pilot.model, wind)),
        plan,
        rudder_limit=None if rudder_limit is None else number(rudder_limit, "rad", "the rudder limit"),
    )
    pushed = driven_by(truth)[0]
    parts: tuple[type[Component], ...] = (*windy, Waves) if waves is not None and pushed == "wave_noise" else windy
    whole = closed_loop(steered, *parts)
    known, acting = stated_values(whole, values), {**flows, **stated_inputs(whole, inputs)}
    if waves is not None:
        # What the waves are; the noise that drives them follows, in steps of the ship.
        known, driven = with_waves(truth, waves, known, {}, pilot.length, u0, 1.0, 1, seed)
        acting |= {n: float(np.asarray(v).flat[0]) for n, v in driven.items()}
    drift = flows.get("current_north", 0.0), flows.get("current_east", 0.0)
    begin = {"x": plan.line[0, 0], "y": plan.line[0, 1], "psi": heading_on(plan.legs[0], drift, u0)}
    sailing = SimulatedShip(
        pilot,
        model=model,
        ship=ship,
        speed=u0,
        start={n: float(v) for n, v in begin.items()},
        values=known,
        inputs=acting,
        parts=parts,
    )
    interval, end = _times(pilot, plan, u0, sampling, duration)
    run = _Run(sailing, helm, {**flows, "cruise": u0}, interval)
    if waves is not None:
        size = (int(end / interval) + 2) * run.fine
        _, driven = with_waves(truth, waves, known, {}, pilot.length, u0, interval / run.fine, size, seed)
        run.pushed, run.waves = pushed, np.asarray(driven[pushed]).reshape(-1, run.fine)
    run.sail(end)
    if waves is None:
        t, delta = (np.array([sample[n] for sample in run.samples]) for n in ("t", "delta"))
        told += cycles_at_rate(t, delta, sailing.coefficients.get("delta_rate", pilot.limits["delta_rate"]))
    else:  # a sound loop answers waves at the limit, too: ask of the loop without them
        told += loop_cycles(steered, u0, current=current, wind=wind, inputs=inputs, values=values)
    met = met_words(current, wind, waves, driven_by(truth)[1], values)
    beside = logged_beside(truth, wind, {n: acting[n] for n in inputs or {}})
    return _voyage(run, pilot, route, parse_noise(noise), seed, met, told, name or route.name, beside)


def _speed(pilot: Autopilot, route: Route, speed: str | float | None, told: list[str]) -> float:
    planned = sorted({w.speed for w in route.waypoints[1:] if w.speed is not None})
    if speed is not None:
        u0 = number(speed, "m/s", "the speed")
    elif len(planned) == 1:
        u0 = planned[0]
    else:
        u0 = pilot.own_speed
    if not u0 > 0:
        raise UsageError(f"a speed of {u0:g} m/s does not steer a ship: give one greater than zero.")
    if planned and max(abs(planned[0] - u0), abs(planned[-1] - u0)) > 0.02 * u0:
        told.append(
            Notice(
                f"the route plans {shown(planned[0], 'u', digits=3)} to {shown(planned[-1], 'u', digits=3)}; the ship sails with the "
                f"revolutions of {shown(u0, 'u', digits=3)} all the way.",
                "planned-speed",
            )
        )
    return u0


def _radius(pilot: Autopilot, route: Route, radius: str | float | None, told: list[str]) -> float:
    size = RADIUS * pilot.length if radius is None else number(radius, "m", "the radius of the turns")
    if not size > 0:
        raise UsageError("the radius of a turn is greater than zero.")
    unstated = sum(w.radius is None for w in route.waypoints[1:-1])
    if unstated and radius is None:
        told.append(
            Notice(
                f"{unstated} waypoint{' states' if unstated == 1 else 's state'} no turn radius: {RADIUS:g} ship lengths, {size:.0f} m, are taken.",
                "turn-radius",
                radius=size,
            )
        )
    return size


def _times(
    pilot: Autopilot, plan: PlannedTrack, u0: float, sampling: str | float | None, duration: str | float | None
) -> tuple[float, float]:
    """Sampling interval, and when the voyage is given up, in s."""
    unit_time = 1 / pilot.pace(u0)
    length = float(np.hypot(*np.diff(plan.line, axis=0).T).sum())
    interval = usual_interval_of(unit_time) if sampling is None else number(sampling, "s", "the sampling interval")
    end = _SLOWER * length / u0 + _MORE * unit_time if duration is None else number(duration, "s", "the duration")
    if not 0 < interval < end:
        raise UsageError(f"a sampling interval of {interval:g} s does not fit a voyage of {end:g} s.")
    if end / interval > _MOST_STEPS:
        raise UsageError(
            f"a voyage of {length / 1000:.0f} km at {interval:g} s takes too many samples: sample less often, or cut the route."
        )
    return interval, end


class _Run:
    """A voyage while it is sailed.

    Parameters
    ----------
    ship : SimulatedShip
        The ship.
    helm : TrackPilot
        Her pilot.
    surroundings : dict of str to float
        What else the pilot knows: the current, the wind, the speed before the turns.
    interval : float
        Of the samples in s.
    """

    def __init__(self, ship: SimulatedShip, helm: TrackPilot, surroundings: dict[str, float], interval: float) -> None:
        self.ship, self.helm, self.surroundings, self.interval = ship, helm, surroundings, interval
        self.fine = max(1, int(np.ceil(interval / ship.longest_step - 1e-9)))
        self.every = max(1, round(_ORDERED / ship.pilot.pace(ship.speed) / interval))
        self.waves: np.ndarray | None = None
        self.pushed = "wave_noise"
        self.samples: list[dict[str, float]] = []
        self.legs: list[int] = []
        self.turning: list[bool] = []
        self.wheel_overs: list[WheelOverDone] = []

    def sail(self, end: float) -> None:
        """Sail until the route or the time ends."""
        ship, helm, k = self.ship, self.helm, 0
        self._order()
        while True:
            self._record()
            if helm.phase == "arrived" or ship.t >= end - 1e-9:
                return
            if self.waves is None:
                ship.advance(self.interval)
            else:
                for push in self.waves[k]:
                    ship.inputs[self.pushed] = float(push)
                    ship.advance(self.interval / self.fine)
            k += 1
            self._check()
            if k % self.every == 0:
                self._order()

    def _order(self) -> None:
        ship, helm, now = self.ship, self.helm, self.ship.now
        before = helm.leg
        order = helm.steer(
            Situation({**{n: now[n] for n in _KNOWN if n in now}, **self.surroundings}, t=ship.t),
            self.every * self.interval,
        )
        ship.inputs["psi_order"] = order.heading
        ship.set("rudder_limit", order.rudder_limit)
        plan = helm.plan
        if order.leg > before and plan.waypoints[order.leg] > plan.waypoints[before]:
            leg, following = plan.legs[before], plan.legs[order.leg]
            self.wheel_overs.append(
                WheelOverDone(
                    plan.waypoints[before],
                    "",
                    ship.t,
                    float(leg.along(following.x, following.y) - leg.along(now["x"], now["y"])),
                    float(turned(following.course - leg.course)),
                    order.rudder_limit,
                    order.to_wheel_over is not None and order.to_wheel_over < -_LATE * self.every * self.interval,
                )
            )

    def _record(self) -> None:
        now = self.ship.now
        self.samples.append({"t": self.ship.t, **now, "psi_order": self.ship.inputs["psi_order"]})
        self.legs.append(self.helm.leg)
        self.turning.append(self.helm.phase == "turning")

    def _check(self) -> None:
        """Whether she still does what a ship can do."""
        now, ship = self.ship.now, self.ship
        fast = abs(now["r"]) > FASTEST_TURN * ship.pilot.pace(ship.speed)
        if fast or now["u"] < LEAST_SPEED * ship.speed:
            what = "she turns faster than any ship" if fast else "she keeps less than a fifth of her speed"
            raise NotSailedError(
                f"the voyage of ship {ship.pilot.ship.name} at {brief(ship.speed)} m/s is {NOT_SAILED} ({ship.model.name}): {what}, "
                f"{brief(ship.t, 4)} s after the start. A smaller rudder limit, wider turns or less wind keep it within its range."
            )


def _voyage(
    run: _Run,
    pilot: Autopilot,
    route: Route,
    deviations: Mapping[str, float],
    seed: int,
    met: str,
    told: list[str],
    name: str,
    beside: tuple[dict[str, float], dict[str, str]],
) -> Voyage:
    ship, plan = run.ship, run.helm.plan
    columns = {n: np.array([s[n] for s in run.samples]) for n in run.samples[0]}
    t, legs, turning = columns["t"], np.array(run.legs), np.array(run.turning)
    off, on = np.empty(t.shape), np.empty(t.shape, dtype=int)
    for leg in np.unique(legs):
        rows = legs == leg
        off[rows], on[rows] = plan.off_track(columns["x"][rows], columns["y"][rows], int(leg))
    to = np.array(plan.waypoints)[on]
    seen = {n: n for n in RECORDED if n in columns}
    if run.waves is not None and run.pushed == "wave_noise":
        seen |= {"psi": "psi_seen", "r": "r_seen"}
    draws = own_seed(seed, f"{route.name}, {brief(ship.speed, 4)} m/s")
    table = measured({n: columns[q] for n, q in seen.items()}, t, deviations, draws)
    table = table.assign(**{n: value for n, value in beside[0].items() if n not in table})
    table = table.assign(psi_order=columns["psi_order"], off_track=off, waypoint=(to + 1).astype(float))
    arrived = run.helm.phase == "arrived"
    if not arrived:
        told.append(Notice(f"the end of the route was not reached after {t[-1]:.0f} s.", "not-arrived", serious=True))
    done = tuple(replace(w, name=route.called(w.waypoint)) for w in run.wheel_overs)
    told += [*not_followed(off / ship.pilot.length, route, to), *too_late(done)]
    told += beyond_in_run(ship.pilot.model, ship.pilot.ship, ship.speed, columns)
    origin = "" if route.origin is None else f"\n{origin_words(route.origin)}"
    comment = (
        f"Simulated, not measured: shipid {shipid.__version__}, model {ship.pilot.model.name}, ship {ship.pilot.ship.name}, autopilot "
        f"({pilot.design}) and track pilot on route '{' '.join(route.name.split())}', {brief(ship.speed, 4)} m/s, "
        f"noise {noise_words(deviations)}, seed {seed}{met}{origin}"
    )
    source = Source(simulated=True, comment=comment, notes=(comment, *told), origin=route.origin)
    units = beside[1] | {"psi_order": "rad", "off_track": "m", "waypoint": "1"}
    return Voyage(
        Trial(name, table, source, ship=ship.pilot.ship.name, units=units),
        route,
        plan,
        off,
        turning,
        done,
        limits_left(plan, route, t, off, on),
        arrived,
        tuple(told),
    )
