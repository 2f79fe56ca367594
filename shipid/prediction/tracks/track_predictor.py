"""The track predictor: tracks of a ship under orders, out of its declaration, its autopilot and what is known of it now."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from shipid.autopilot.course_changes.run_course_changes import stiffest
from shipid.autopilot.course_changes.turn_order import TurnOrder
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import closed_loop, coefficients_of, steered_ship
from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.foundation.errors import ParameterSetError, UnknownNameError, UsageError
from shipid.foundation.numbers import brief
from shipid.parameters.parameter_set import missing_values
from shipid.parameters.validity import growth_in_run
from shipid.parts.helm import DirectRudder
from shipid.parts.manoeuvring_range import manoeuvring_range
from shipid.parts.wind import Wind
from shipid.prediction.situations.situation import Situation, situation_of
from shipid.prediction.tracks.bands import linear_track, sampled_track, tracked
from shipid.prediction.tracks.distance_loop import make_distance_loop, with_clock
from shipid.prediction.tracks.first_order import at_cruising_speed, first_order_coefficients, first_order_for
from shipid.prediction.tracks.order import Order, read_order
from shipid.prediction.tracks.predicted_track import COLUMNS, PredictedTrack
from shipid.prediction.tracks.start_of_track import spread_in
from shipid.prediction.tracks.track_run import TrackRun, cruise_of, kind_of, ordered_run

#: Which model predicts.
Predicting = Literal["own", "first-order"]
#: How the band is found: not at all, by linear propagation, or by samples.
Band = Literal["none", "linear", "samples"]
#: Length of a track in ship lengths, and its nodes.
HORIZON, POINTS = 20.0, 600
#: Longest step of the prediction in L/u; and the longest track, in ship lengths and steps.
_LONGEST, _FARTHEST, _MOST = 0.05, 1e4, 100_000
#: Integration steps between two nodes that are compiled as one expression; a slow ship takes more, and then the loop has more nodes.
_UNROLLED = 8


class TrackPredictor:
    """Predicts where a ship goes under an order: by its own model, or by the first-order model of the thesis.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot that steers it, with the ship and its steering machine.
    model : {"own", "first-order"}
        The ship's own model, or eq. (7.2)-(7.3) at a constant speed.
    values : mapping of str to float, optional
        Coefficients that go before the ship's, SI: those a filter has estimated.
    parts : sequence of type[Component]
        Components that act on the ship besides: the wind.
    condition : int
        Which load condition.

    Raises
    ------
    ParameterSetError
        If the ship has no length.
    UnknownNameError
        If there is no such kind of model; when it predicts, if a value is none of the model's coefficients.

    Notes
    -----
    Passenier (1989), chapter 3 and section 5.6. The independent variable is the distance sailed, so that a track of the first-order
    model does not depend on the speed (3.43); with the ship's own model the loss of speed is in the times, and in what a current adds.
    """

    def __init__(
        self,
        pilot: Autopilot,
        *,
        model: Predicting = "own",
        values: Mapping[str, float] | None = None,
        parts: Sequence[type[Component]] = (),
        condition: int = 0,
    ) -> None:
        if model not in get_args(Predicting):
            raise UnknownNameError("kind of prediction model", model, get_args(Predicting))
        if pilot.ships[condition].particular("L", "m") is None:
            raise ParameterSetError(
                f"ship {pilot.ships[condition].name} has no length L, by which a track is measured: add it to her particulars."
            )
        self.pilot, self.kind, self.condition = pilot, model, condition
        self.values = dict(values or {})
        self._steering = pilot if model == "own" else replace(pilot, model=first_order_for(pilot.model))
        self._parts = tuple(parts)
        self._models: dict[str, Model] = {}
        self._coefficients: dict[tuple[str, float], dict[str, float]] = {}
        self._longest: dict[float, float] = {}

    def __repr__(self) -> str:
        return f"<track predictor of {self.pilot.ship.name} by {self._source}>"

    @property
    def _source(self) -> str:
        return self.pilot.model.name if self.kind == "own" else "the first-order model"

    @property
    def length(self) -> float:
        """Length of the ship in m."""
        return self.pilot.length

    def model_of(self, order: Order) -> Model:
        """Return the model that runs under an order: ship, steering machine, autopilot and the clock of the track.

        Parameters
        ----------
        order : Order
            The order; only its kind counts.
        """
        kind = kind_of(order)
        if kind not in self._models:
            steering = self._steering
            if kind == "rudder":
                whole = steered_ship(steering)
                parts = (*self._parts, *manoeuvring_range(whole))
                whole = join(whole.name, whole, *parts) if parts else whole
            else:
                mode: Literal["course", "rate"] = "course" if kind == "heading" else "rate"
                turn = (TurnOrder,) if kind == "turn" else ()
                parts = (*turn, *self._parts, *manoeuvring_range(steering.model))
                whole = closed_loop(replace(steering, mode=mode), *parts)
            self._models[kind] = with_clock(whole)
        return self._models[kind]

    def predict(
        self,
        situation: Situation | Mapping[str, str | float],
        *,
        heading: str | float | None = None,
        rudder: str | float | None = None,
        rate: str | float | None = None,
        rudder_limit: str | float | None = None,
        horizon: float = HORIZON,
        points: int | None = None,
        band: Band = "linear",
        samples: int = 200,
        seed: int = 0,
    ) -> PredictedTrack:
        """Predict the track under an order that is given now.

        Parameters
        ----------
        situation : Situation or mapping of str to str or float
            What is known of the ship; values by name are with a unit or in SI, and taken as exact.
        heading, rudder, rate : str or float, optional
            The order, with a unit or in SI: a heading to steer, a rudder angle to hold, a rate of turn to hold, or a heading with the
            rate of the turn to it. One of them has to be given.
        rudder_limit : str or float, optional
            Largest rudder angle; the autopilot's own by default.
        horizon : float
            Length of the track in ship lengths.
        points : int, optional
            Steps of the track; by default as near to each other on a long track as on one of the usual length.
        band : {"linear", "samples", "none"}
            How the spread of the track is found where the situation says how sure it is.
        samples : int
            How many tracks are drawn for a band by samples.
        seed : int
            Of the draws.

        Returns
        -------
        PredictedTrack

        Raises
        ------
        UsageError
            If the order, the horizon or the situation is none.
        UnknownNameError
            If there is no such band, or a value is none of the model's coefficients.
        UnstatedInputError
            If the model reads an input that nothing states and that declares no default.
        """
        order, situation = read_order(heading, rudder, rate, rudder_limit), situation_of(situation)
        if band not in get_args(Band):
            raise UnknownNameError("band", band, get_args(Band))
        known = situation.uncertain and (situation.covariance.any() or any(situation.noise.values()))
        return self._run(situation, [order], horizon, points, band if known else "none", samples, seed)[0]

    def fan(
        self,
        situation: Situation | Mapping[str, str | float],
        headings: Sequence[str | float],
        *,
        rudder_limit: str | float | None = None,
        horizon: float = HORIZON,
        points: int = POINTS,
    ) -> list[PredictedTrack]:
        """Predict the tracks to many headings, without their bands.

        Parameters
        ----------
        situation : Situation or mapping of str to str or float
            What is known of the ship.
        headings : sequence of str or float
            Headings to steer, with a unit or in rad.
        rudder_limit, horizon, points
            See `predict`.

        Returns
        -------
        list of PredictedTrack
        """
        orders = [read_order(h, None, None, rudder_limit) for h in headings]
        return self._run(situation_of(situation), orders, horizon, points, "none") if orders else []

    def along(
        self, situations: Sequence[Situation], rudders: np.ndarray, horizon: float = HORIZON
    ) -> list[PredictedTrack]:
        """Predict the tracks along which the rudder is laid as it is given, with their bands.

        Parameters
        ----------
        situations : sequence of Situation
            What is known of the ship at the beginning of each; the same quantities are uncertain in all.
        rudders : ndarray, shape (situations, points)
            Rudder orders in rad, one for each step.
        horizon : float
            Length of the tracks in ship lengths.

        Returns
        -------
        list of PredictedTrack
        """
        order = read_order(None, 0.0, None, None)
        model = self.model_of(order)
        points, distance = rudders.shape[1], horizon * self.length / rudders.shape[1]
        runs = []
        for situation in situations:
            named = {*model.parameters, *model.constants}
            known = self._known(model, "rudder", cruise_of(situation))
            known = known | {n: v for n, v in situation.values.items() if n in named}
            runs.append(ordered_run(model, self.pilot, situation, order, known, self.condition, self._source))
        speed = cruise_of(situations[0])
        substeps = self._substeps(distance, speed)
        if (split := substeps // _UNROLLED) > 1:
            self._refuse_slow(points * split, speed)
            return [t.every(split) for t in self.along(situations, np.repeat(rudders, split, axis=1), horizon)]
        extra, _, _ = spread_in(model, runs[0].situation, runs[0].slopes)
        loop = make_distance_loop(model, extra, "covariance", substeps, steered=True)
        controls = np.full((len(runs), points + 1, 2), distance)
        controls[:, :, 1] = np.concatenate([rudders, rudders[:, -1:]], axis=1)

        def sailed(runs: Sequence[TrackRun]) -> list[PredictedTrack]:
            starts = [spread_in(model, r.situation, r.slopes) for r in runs]
            table = loop.loop.side_by_side(
                np.stack([loop.carried(r.x0, covariance) for r, (_, covariance, _) in zip(runs, starts)]),
                controls,
                np.stack([loop.coefficients(r.p, r.inputs, r.least, noise) for r, (_, _, noise) in zip(runs, starts)]),
                threads=1,
            )
            return [tracked(run, loop, out) for run, out in zip(runs, table)]

        tracks = sailed(runs)
        wider, growths = zip(*map(self._grown, runs, tracks))
        if max(growths) == 1:
            return tracks
        return [replace(track, grown=growth) for track, growth in zip(sailed(wider), growths)]

    def _run(
        self,
        situation: Situation,
        orders: Sequence[Order],
        horizon: float,
        points: int | None,
        band: Band,
        samples: int = 0,
        seed: int = 0,
    ) -> list[PredictedTrack]:
        if points is None:
            points = POINTS if not HORIZON < horizon < _FARTHEST else min(_MOST, int(POINTS * horizon / HORIZON))
        if not (0 < horizon < _FARTHEST and 0 < points <= _MOST):
            raise UsageError(
                f"a track of {horizon:g} ship lengths in {points} steps is none: give 1 to {_MOST} steps, more than "
                f"0 and fewer than {_FARTHEST:g} ship lengths."
            )
        if self.kind == "first-order":
            situation = at_cruising_speed(situation)
        model, speed = self.model_of(orders[0]), cruise_of(situation)
        named = {*model.parameters, *model.constants}
        known = self._known(model, kind_of(orders[0]), speed) | {
            n: v for n, v in situation.values.items() if n in named
        }
        first = ordered_run(model, self.pilot, situation, orders[0], known, self.condition, self._source)
        runs = [first, *(first.to_heading(order) for order in orders[1:])]
        distance = horizon * self.length / points
        substeps = self._substeps(distance, speed)
        if (split := substeps // _UNROLLED) > 1:
            self._refuse_slow(points * split, speed)
            return [t.every(split) for t in self._run(situation, orders, horizon, points * split, band, samples, seed)]
        if band == "linear":
            found = []
            for run in runs:
                track = linear_track(run, distance, points, substeps)
                wider, growth = self._grown(run, track)
                found.append(
                    replace(linear_track(wider, distance, points, substeps), grown=growth) if growth > 1 else track
                )
            return found
        plain = make_distance_loop(model, (), "none", substeps)
        steps = np.full((points + 1, 1), distance)
        tables = plain.loop.side_by_side(
            np.stack([run.x0 for run in runs]),
            steps,
            np.stack([plain.coefficients(run.p, run.inputs, run.least) for run in runs]),
            threads=1 if len(runs) == 1 else None,
        )
        tracks = [run.track(out) for run, out in zip(runs, tables)]
        if band == "none":
            return tracks
        # Drawn tracks are compared with one that is integrated as they are, so that its error is not in the band.
        coarse = max(1, substeps // 2)
        found = []
        for run, track in zip(runs, tracks):
            wider, growth = self._grown(run, track)
            found.append(replace(sampled_track(wider, track, distance, coarse, samples, seed), grown=growth))
        return found

    def _grown(self, run: TrackRun, track: PredictedTrack) -> tuple[TrackRun, float]:
        """A run whose model errs as much more as its track goes beyond the fitted amplitudes, and how many times that is."""
        if not run.situation.structural:
            return run, 1.0
        ship, columns = self.pilot.ships[self.condition], {n: getattr(track, n) for n in COLUMNS}
        growth = growth_in_run(self.pilot.model, ship, cruise_of(run.situation), columns)
        return replace(run, situation=run.situation.with_structure(growth)), growth

    def _known(self, model: Model, kind: str, speed: float) -> dict[str, float]:
        key = (kind, speed)
        if key not in self._coefficients:
            if len(self._coefficients) > 256:
                self._coefficients.clear()
            if self.kind == "own":
                known = coefficients_of(self.pilot, model, speed, self.condition) | {"L": self.pilot.length}
            else:
                known = dict(self.pilot.limits) | {"rudder_limit": self.pilot.rudder_limit}
                if not {"K", "tau", "gamma"} <= set(self.values):
                    known |= first_order_coefficients(self.pilot, speed, self.condition)
                known["L"] = self.pilot.length
                if (late := self.pilot.model.delays.get("delta")) is not None:
                    own = coefficients_of(self.pilot, self.pilot.model, speed, self.condition)
                    known[first_order_for(self.pilot.model).delays["delta"]] = own[late]
                # What acts on her besides, the wind, has coefficients of its own in her set.
                ship = self.pilot.ships[self.condition]
                found = {n: ship.find(model, n) for n in (*model.parameters, *model.constants) if n not in known}
                known |= {n: v.at(speed, model[n].unit, f"ship {ship.name}") for n, v in found.items() if v is not None}
            lost = [n for n in self.values if n not in (*model.parameters, *model.constants)]
            if lost:
                raise UnknownNameError(f"coefficient of model {model.name} called", lost[0], model.parameters)
            known |= self.values
            if self.kind == "first-order":
                lacking = missing_values(
                    model, known | dict.fromkeys(model.constants, 0.0), f"ship {self.pilot.ships[self.condition].name}"
                )
                if lacking is not None:
                    raise lacking
            self._coefficients[key] = {n: v for n, v in known.items() if n in model}
        return self._coefficients[key]

    def _refuse_slow(self, nodes: int, speed: float) -> None:
        if nodes > _MOST:
            raise UsageError(
                f"at u = {brief(speed)} m/s the ship sails too slowly for her rudder: a track along the distance sailed would have {nodes} steps. Ask for a shorter one."
            )

    def _substeps(self, distance: float, speed: float) -> int:
        """Steps between two nodes, a power of two, so that few loops are compiled."""
        if speed not in self._longest:
            if len(self._longest) > 256:
                self._longest.clear()
            loop = steered_ship(self.pilot) if self.pilot.actuator is not DirectRudder else self.pilot.model
            finest = stiffest(self.pilot, loop, np.array([speed]))
            self._longest[speed] = min(finest, _LONGEST / self.pilot.pace(speed))
        return int(2 ** max(0, np.ceil(np.log2(distance / speed / self._longest[speed]))))


def wind_parts(pilot: Autopilot, known: Situation, model: Predicting = "own") -> tuple[type[Component], ...]:
    """Return the wind as a component to join, where there is some and the predicting model reads it.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot with its ship.
    known : Situation
        What is known.
    model : {"own", "first-order"}
        What predicts; the first-order model reads the wind always.
    """
    reads = model != "own" or "r_disturbance" in pilot.model.inputs
    return (Wind,) if reads and known.values.get("wind_speed") else ()
