"""What is predicted: the tracks under the trial and under the executed orders, and where the wheel goes over.

It is a function of a question: it runs in a thread, and nothing else touches the predictor meanwhile.
"""

from __future__ import annotations

import functools
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from shipid.bridge.core.console import SteeringOrder
from shipid.bridge.core.scale_watch import still_water_track
from shipid.bridge.shown.plain_values import number, strict_json
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ShipidError
from shipid.parameters.validity import beyond_in_run
from shipid.prediction.following.past_predictions import past_errors
from shipid.prediction.following.planned_track import PlannedTrack
from shipid.prediction.following.track_pilot import TrackOrder, TrackPilot
from shipid.prediction.following.wheel_over import TrackLeg, WheelOver, wheel_over
from shipid.prediction.situations.past import Past, told_of
from shipid.prediction.situations.ship_spread import with_coefficients
from shipid.prediction.situations.situation import PastErrors, Situation
from shipid.prediction.tracks.not_reached import not_reached
from shipid.prediction.tracks.predicted_track import COLUMNS, PredictedTrack
from shipid.prediction.tracks.track_predictor import HORIZON, POINTS, TrackPredictor
from shipid.prediction.tracks.track_run import cruise_of

#: A track is sent with so many points at most.
_SENT = 200


@dataclass(frozen=True)
class ShownTrack:
    """A predicted track, or why there is none.

    Attributes
    ----------
    track : PredictedTrack or None
        The track.
    message : str
        Why there is none, why it ends early, where it goes beyond what the ship's coefficients come from, or that its band is widened.
    """

    track: PredictedTrack | None
    message: str = ""

    @functools.cached_property
    def text(self) -> str:
        """It as JSON, made once."""
        return strict_json(self.to_dict())

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI, of at most 200 points."""
        track, said = self.track, self.message or None
        if track is None:
            empty: dict[str, Plain] = {n: [] for n in ("x", "y", "psi", "s", "t")}
            return empty | {"half_width": None, "message": said, "beyond": True}
        kept = np.unique(np.linspace(0, track.s.size - 1, min(_SENT, track.s.size)).round().astype(int))
        width = track.half_width
        shown = {
            n: [number(v, digits) for v in getattr(track, n)[kept].tolist()]
            for n, digits in (("x", 8), ("y", 8), ("psi", 6), ("s", 6), ("t", 6))
        }
        half = None if width is None else [number(v, 4) for v in width[kept].tolist()]
        return {**shown, "half_width": half, "message": said, "beyond": bool(track.ended)}


@dataclass(frozen=True)
class Question:
    """What is to be predicted.

    Attributes
    ----------
    t : float
        When it was asked, in s on the bridge's clock.
    situation : Situation
        What is known of the ship.
    trial, executed : SteeringOrder or None
        The orders whose tracks are wanted.
    leg : TrackLeg or None
        The next leg of the route, where its wheel-over is wanted.
    rudder_limit : float
        Of the turn onto that leg, in rad.
    steer : bool
        Whether the track pilot is asked what to order.
    begins : SteeringOrder or None
        What was executed just now: its turn in still water is wanted.
    past : Past or None
        The voyage so far, where it is to be seen anew how far off the predictions along it were.
    """

    t: float
    situation: Situation
    trial: SteeringOrder | None = None
    executed: SteeringOrder | None = None
    leg: TrackLeg | None = None
    rudder_limit: float = 0.1
    steer: bool = False
    begins: SteeringOrder | None = None
    past: Past | None = None


@dataclass(frozen=True)
class PredictionAnswer:
    """What was predicted.

    Attributes
    ----------
    question : Question
        What was asked.
    trial, executed : ShownTrack or None
        The tracks that were wanted.
    wheel_over : WheelOver or None
        Where the turn onto the next leg begins.
    order : TrackOrder or None
        What the track pilot orders.
    unsteered : str
        Why it orders nothing, where it cannot.
    still : PredictedTrack or None
        The turn that begins, in still water.
    """

    question: Question
    trial: ShownTrack | None = None
    executed: ShownTrack | None = None
    wheel_over: WheelOver | None = None
    order: TrackOrder | None = None
    unsteered: str = ""
    still: PredictedTrack | None = None


class Forecaster:
    """Answers questions about the future.

    Parameters
    ----------
    predictor : TrackPredictor
        Predicts the tracks.
    interval : float
        Between two questions in s.
    band : bool
        Whether the tracks have their bands.
    """

    def __init__(self, predictor: TrackPredictor, interval: float, *, band: bool = True) -> None:
        self.predictor, self.interval = predictor, interval
        self._band = band
        self._pilot: TrackPilot | None = None
        self._errors: PastErrors | None = None

    def follow(self, plan: PlannedTrack, rudder_limit: float, leg: int) -> None:
        """Begin to steer along a planned track.

        Parameters
        ----------
        plan : PlannedTrack
            The track.
        rudder_limit : float
            Of its turns in rad.
        leg : int
            The leg the ship is on.
        """
        self._pilot = TrackPilot(self.predictor, plan, rudder_limit=rudder_limit)
        self._pilot.leg = leg

    def answer(self, question: Question) -> PredictionAnswer:
        """Return what is predicted.

        Parameters
        ----------
        question : Question
            What is to be predicted.

        Returns
        -------
        PredictionAnswer
            What cannot be predicted says why.
        """
        if question.past is not None and self._band:
            with suppress(ShipidError):
                self._errors = past_errors(self.predictor.pilot, question.past)
        order, unsteered = None, ""
        if question.steer and self._pilot is not None:
            try:
                order = self._pilot.steer(question.situation, self.interval)
            except ShipidError as error:
                unsteered = str(error)
        turn = None
        if question.leg is not None:
            try:
                turn = wheel_over(self.predictor, question.situation, question.leg, rudder_limit=question.rudder_limit)
            except ShipidError:
                turn = None
        trial = self._forecast(question, question.trial, None)
        executed = self._forecast(question, question.executed, order)
        for track in (trial, executed):
            if track is not None:
                track.text  # noqa: B018 - written here, in the thread, and not where the page is brought up to date
        still = None
        if question.begins is not None:
            still = still_water_track(self.predictor, question.situation, question.begins)
        return PredictionAnswer(question, trial, executed, turn, order, unsteered, still)

    def warm(self, situation: Situation) -> None:
        """Predict once under every kind of order, so that what has to be compiled is.

        Parameters
        ----------
        situation : Situation
            Any of the ship.
        """
        for order in (
            {"heading": 0.5},
            {"rudder": 0.1},
            {"heading": 0.5, "rate": 0.2 * self.predictor.pilot.pace(situation.values["u"])},
        ):
            with suppress(ShipidError):
                self.predictor.predict(situation, **order, band="none")  # type: ignore[arg-type]

    def _forecast(
        self, question: Question, steering: SteeringOrder | None, order: TrackOrder | None
    ) -> ShownTrack | None:
        if steering is None:
            return None
        wanted = steering.order()
        if order is not None:
            wanted = {"heading": order.heading, "rudder_limit": order.rudder_limit}
        try:
            known = question.situation
            if self._band:
                # What the filter does not estimate of her coefficients, and that a model is not the ship, is in the band too.
                known = replace(with_coefficients(known, self.predictor.pilot), past=self._errors)
            track = self.predictor.predict(
                known,
                **wanted,
                horizon=HORIZON,
                points=POINTS,
                band="linear" if self._band else "none",
            )
        except ShipidError as error:
            return ShownTrack(None, str(error))
        except (ArithmeticError, ValueError, RuntimeError) as error:
            return ShownTrack(None, f"nothing can be predicted: {type(error).__name__}.")
        if not all(np.isfinite(getattr(track, n)).all() for n in ("x", "y", "psi", "s", "t")):
            return ShownTrack(None, f"the model runs away under {track.order}: take a smaller rudder angle.")
        pilot, run = self.predictor.pilot, {n: getattr(track, n) for n in COLUMNS}
        said = not_reached(pilot, track)
        said += beyond_in_run(
            pilot.model, pilot.ship, cruise_of(question.situation), run, known=True, grown=track.grown
        )
        if self._errors is not None:
            said += told_of(self._errors)
        return ShownTrack(track, " ".join([track.ended, *said]).strip())
