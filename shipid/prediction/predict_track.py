"""The verb: predict a track from what is known of a ship, or from a record and the filter of her own model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.design_autopilot import design_autopilot
from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import UsageError
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief
from shipid.parameters.catalogue import ship_of
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.validity import beyond_in_run
from shipid.prediction.following.wheel_over import TrackLeg, WheelOver, wheel_over
from shipid.prediction.prediction import Prediction
from shipid.prediction.routes.route_turn import RouteTurn
from shipid.prediction.situations.ship_spread import with_coefficients
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.not_reached import not_reached
from shipid.prediction.tracks.predicted_track import COLUMNS, PredictedTrack
from shipid.prediction.tracks.track_predictor import HORIZON, Band, Predicting, TrackPredictor, wind_parts
from shipid.prediction.tracks.track_run import cruise_of


def predict_track(
    pilot: Autopilot | Model | type[Component] | str,
    situation: Situation | Mapping[str, float] | ParameterSet | str | Path,
    *,
    heading: str | float | None = None,
    rudder: str | float | None = None,
    rate: str | float | None = None,
    leg: TrackLeg | None = None,
    rudder_limit: str | float | None = None,
    horizon: float = HORIZON,
    points: int | None = None,
    band: Band = "linear",
    model: Predicting = "own",
    values: Mapping[str, float] | None = None,
    origin: str = "the situation given",
    warnings: Sequence[Notice] = (),
) -> Prediction:
    """Predict where a ship goes under an order that is given now.

    Parameters
    ----------
    pilot : Autopilot, or Model, component class or str
        The autopilot that steers her, with the ship and its steering machine; or a model, for which one is designed by default.
    situation : Situation or mapping of str to float, or ParameterSet, str or Path
        What is known of her; ``psi`` and ``u`` at least, SI. Beside a model its ship, which begins on a straight course to the north at
        her own speed.
    heading, rudder, rate : str or float, optional
        The order, see `TrackPredictor.predict`.
    leg : TrackLeg, optional
        A planned leg instead of a heading: where the wheel goes over, and the turn onto it from there.
    rudder_limit, horizon, points, band
        See `TrackPredictor.predict`.
    model : {"own", "first-order"}
        The ship's own model, or the first-order model of the thesis.
    values : mapping of str to float, optional
        Coefficients that go before the ship's, SI.
    origin : str
        Where the situation comes from, in words.
    warnings : sequence of Notice
        What is known to limit the situation.

    Returns
    -------
    Prediction

    Raises
    ------
    UsageError
        If the order, the situation or the horizon is none, or a model stands beside a situation.
    UnstatedInputError
        If the model reads an input that nothing states and that declares no default.
    """
    if not isinstance(pilot, Autopilot):
        origin = "a straight course"
    pilot, situation = piloted(pilot, situation)
    known = situation if isinstance(situation, Situation) else Situation(dict(situation))
    parts = wind_parts(pilot, known, model)
    if model == "own" and band != "none":
        known = with_coefficients(known, pilot)
    predictor = TrackPredictor(pilot, model=model, values=values, parts=parts)
    told = list(warnings)
    found = None
    if leg is not None:
        found = wheel_over(predictor, known, leg, rudder_limit=rudder_limit, horizon=horizon)
        there = replace(known, values={**known.values, "x": found.x, "y": found.y})
        heading = found.heading
        if found.due:
            told.append(
                Notice(f"the wheel-over point is passed by {-found.distance:.0f} m.", "wheel-over-passed", serious=True)
            )
        known = there if not found.due else known
    track = predictor.predict(
        known,
        heading=heading,
        rudder=rudder,
        rate=rate,
        rudder_limit=rudder_limit,
        horizon=horizon,
        points=points,
        band=band,
    )
    return prediction_of(pilot, known, track, horizon, band, origin, told, wheel_over=found)


def piloted(
    pilot: Autopilot | Model | type[Component] | str,
    situation: Situation | Mapping[str, float] | ParameterSet | str | Path,
) -> tuple[Autopilot, Situation | Mapping[str, float]]:
    """Return an autopilot and what is known of its ship, where a model and its ship are given instead.

    Parameters
    ----------
    pilot : Autopilot, or Model, component class or str
        The autopilot; or a model, for which one is designed by default.
    situation : Situation or mapping of str to float, or ParameterSet, str or Path
        What is known of the ship; or the ship of the model.

    Returns
    -------
    pilot : Autopilot
    situation : Situation or mapping of str to float
        Of a ship without a situation: to the north, at her own speed.

    Raises
    ------
    UsageError
        If both do not belong together.
    """
    if isinstance(situation, (Situation, Mapping)):
        if isinstance(pilot, Autopilot):
            return pilot, situation
        raise UsageError(
            "a model is steered by an autopilot: give design_autopilot(model, ship) in its place, or the model's ship in place of "
            "the situation."
        )
    if isinstance(pilot, Autopilot):
        raise UsageError(
            "an autopilot has its ship: give what is known of her beside it, as in {'psi': 0.0, 'u': 8.0}."
        )
    designed = design_autopilot(pilot, ship_of(situation))
    return designed, {"psi": 0.0, "u": designed.own_speed, "r": 0.0}


def prediction_of(
    pilot: Autopilot,
    known: Situation,
    track: PredictedTrack,
    horizon: float,
    band: Band,
    origin: str,
    told: list[Notice],
    *,
    wheel_over: WheelOver | None = None,
    turn: RouteTurn | None = None,
) -> Prediction:
    """Return a predicted track as a result, with what limits it.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot that steers the ship.
    known : Situation
        Where the track begins.
    track : PredictedTrack
        The track.
    horizon : float
        Its length in ship lengths, as it was asked for.
    band : {"linear", "samples", "none"}
        The band that was asked for.
    origin : str
        Where the situation comes from, in words.
    told : list of Notice
        What is known to limit it so far.
    wheel_over : WheelOver, optional
        Where the turn onto a planned leg begins.
    turn : RouteTurn, optional
        The next turn of a route.

    Returns
    -------
    Prediction
    """
    if track.ended:
        told.append(
            Notice(
                f"the track ends after {brief(track.s_star[-1], 3)} of {horizon:g} ship lengths: {track.ended}.",
                "outside-the-model",
                serious=True,
                ship_lengths=float(track.s_star[-1]),
            )
        )
    told += not_reached(pilot, track)
    run = {n: getattr(track, n) for n in COLUMNS}
    told += beyond_in_run(pilot.model, pilot.ship, cruise_of(known), run, grown=track.grown)
    if track.covariance is None and band != "none":
        told.append(Notice("nothing says how sure the situation is: the band is not known.", "band-not-known"))
    units = {n: e.unit for n, e in pilot.model.entries.items()} | {
        n: FIELDS[n].unit for n in known.values if n in FIELDS
    }
    return Prediction(pilot.ship.name, track.source, known, track, origin, units, wheel_over, tuple(told), turn)
