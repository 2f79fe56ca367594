"""The verb: predict the next turn of a route from what is known of a ship."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from shipid.autopilot.course_changes.turn_order import RADIUS
from shipid.autopilot.design.autopilot import Autopilot
from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.vocabulary import compass
from shipid.foundation.errors import UsageError
from shipid.foundation.notices import Notice, notice_of
from shipid.parameters.parameter_set import ParameterSet
from shipid.prediction.following.planned_track import PlannedTrack
from shipid.prediction.following.wheel_over import heading_on
from shipid.prediction.predict_track import piloted, prediction_of
from shipid.prediction.prediction import Prediction
from shipid.prediction.routes.route import Route
from shipid.prediction.routes.route_plan import plan_of
from shipid.prediction.routes.route_turn import against_plan, next_turn
from shipid.prediction.routes.sailings import turned
from shipid.prediction.situations.ship_spread import with_coefficients
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import HORIZON, Band, TrackPredictor, wind_parts
from shipid.prediction.tracks.track_run import cruise_of
from shipid.trials.manoeuvres.flows import number

#: A ship so far from the track, in radii of its turns or ship lengths, is not on the route.
_FAR = 2.0
#: A ship whose heading is so far off her leg, in rad, does not sail along it.
_AWAY = np.deg2rad(45.0)
#: The track begins on another heading than the ship has, in rad.
_MOVED = np.deg2rad(1.0)
#: A ship that turns faster than this, as r L/U, is in her turn.
_TURNING = 0.02


def predict_route(
    pilot: Autopilot | Model | type[Component] | str,
    situation: Situation | Mapping[str, float] | ParameterSet | str | Path,
    route: Route,
    *,
    origin: tuple[float, float] | None = None,
    radius: float | None = None,
    rudder_limit: str | float | None = None,
    horizon: float = HORIZON,
    points: int | None = None,
    band: Band = "linear",
    source: str = "the situation given",
    warnings: Sequence[Notice] = (),
) -> Prediction:
    """Predict the next turn of a route: where the wheel goes over, and the track from there against the plan.

    Parameters
    ----------
    pilot : Autopilot, or Model, component class or str
        The autopilot that steers the ship, with her steering machine; or a model, for which one is designed by default.
    situation : Situation or mapping of str to float, or ParameterSet, str or Path
        What is known of her, SI; beside a model its ship, at her own speed. Without a position she begins at the first waypoint, on
        the first leg.
    route : Route
        The route.
    origin : tuple of float, optional
        Latitude and longitude in rad of the place where x and y are 0; the first waypoint by default.
    radius : float, optional
        Radius of turns in m where the route states none; eight ship lengths by default.
    rudder_limit : str or float, optional
        Of the turn; by default the one with which it stays nearest to its arc, the autopilot's own at most.
    horizon, points, band
        See `TrackPredictor.predict`; the track is as long as the turn takes at least.
    source : str
        Where the situation comes from, in words.
    warnings : sequence of Notice
        What is known to limit the situation.

    Returns
    -------
    Prediction
        Its track begins where the wheel goes over; on the last leg, where the ship is.

    Raises
    ------
    UsageError
        If the situation, the horizon or a turn of the route is none.
    RoutePlaneError
        If no plane of local metres holds the route.
    UnstatedInputError
        If the model reads an input that nothing states and that declares no default.
    """
    begins = not isinstance(pilot, Autopilot)
    pilot, situation = piloted(pilot, situation)
    if begins:
        source, situation = "the first waypoint", {"u": pilot.own_speed, "r": 0.0}
    if pilot.mode != "course":
        raise UsageError("an autopilot that holds a rate of turn steers no route: design one that holds a course.")
    told = [*warnings, *map(notice_of, route.notes)]
    size = RADIUS * pilot.length if radius is None else radius
    unstated = sum(w.radius is None for w in route.waypoints[1:-1])
    if unstated and radius is None:
        told.append(
            Notice(f"{unstated} waypoint{' states' if unstated == 1 else 's state'} no turn radius: {RADIUS:g} ship lengths, {size:.0f} m, are taken.", "turn-radius", radius=size)
        )  # fmt: skip
    plan = plan_of(route, origin=origin, radius=size)
    known = situation if isinstance(situation, Situation) else _begun(situation, plan)
    if not {"x", "y"} <= set(known.values):
        raise UsageError("a route asks for the ship's position, and nothing says 'x' and 'y'.")
    if band != "none":
        known = with_coefficients(known, pilot)
    predictor = TrackPredictor(pilot, parts=wind_parts(pilot, known))
    limit = None if rudder_limit is None else number(rudder_limit, "rad", "the rudder limit")
    turn, at = next_turn(predictor, known, route, plan, origin=origin or route.origin, rudder_limit=limit)
    if abs(turn.off_track) > _FAR * max(size, pilot.length):
        told.append(
            Notice(f"the ship is {abs(turn.off_track):.0f} m off the track: the next turn is that of the nearest leg.", "off-route", serious=True)
        )  # fmt: skip
    found = turn.wheel_over
    if found is None:
        heading = heading_on(plan.legs[turn.leg], at.current, cruise_of(at))
        if turn.left < 0:
            told.append(Notice(f"the end of the route is passed by {-turn.left:.0f} m.", "route-ended", serious=True))
        else:
            told.append(Notice(f"no turn is ahead: {turn.left:.0f} m of the last leg are left.", "last-leg"))
    else:
        heading, limit = found.heading, turn.rudder_limit
        horizon = max(horizon, float(found.track.s_star[-1]))
        turning = (
            known.values.get("r", 0.0) * turn.change > 0
            and abs(known.values["r"]) > _TURNING * cruise_of(known) / pilot.length
        )
        if turning and abs(found.distance) < pilot.length:
            told.append(Notice("the ship turns already: the track is the rest of her turn.", "turning"))
        else:
            told += _off_heading(plan, turn.leg, known)
            if found.due:
                told.append(
                    Notice(
                        f"the wheel-over point is passed by {-found.distance:.0f} m.", "wheel-over-passed", serious=True
                    )
                )
            elif found.warning:
                told.append(Notice(f"wheel-over in {found.time:.0f} s.", "wheel-over-soon", seconds=found.time))
    if abs(float(turned(at.values["psi"] - known.values["psi"]))) > _MOVED:
        source = f"{source}, then along her leg"
    track = predictor.predict(at, heading=heading, rudder_limit=limit, horizon=horizon, points=points, band=band)
    return prediction_of(pilot, at, track, horizon, band, source, told, turn=against_plan(turn, track))


def _off_heading(plan: PlannedTrack, leg: int, known: Situation) -> list[Notice]:
    """What has to be said of a ship that does not sail along her leg."""
    psi = known.values["psi"]
    off = abs(float(turned(plan.legs[leg].course - psi)))
    if off <= _AWAY:
        return []
    return [
        Notice(
            f"the ship heads {compass(psi)} deg, {np.rad2deg(off):.0f} deg off her leg: the wheel-over is that of a ship "
            "that sails along it.",
            "off-heading",
            serious=True,
        )
    ]


def _begun(values: Mapping[str, float], plan: PlannedTrack) -> Situation:
    """The ship as she is told, on the first leg where nothing says where she is."""
    if "x" in values or "y" in values:
        return Situation(dict(values))
    first = plan.legs[0]
    on = Situation({"psi": first.course, **values})
    heading = heading_on(first, on.current, cruise_of(on))
    return Situation({"psi": heading, **values, "x": first.x, "y": first.y})
