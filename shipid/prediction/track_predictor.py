"""The track predictor: tracks of a ship under orders, out of its declaration, its autopilot and what is known of it now."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from shipid.autopilot.course_changes.run_course_changes import stiffest
from shipid.autopilot.course_changes.turn_order import TurnOrder
from shipid.autopilot.course_changes.weather import CALM
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import closed_loop, coefficients_of, steered_ship
from shipid.declaration.component import Component
from shipid.declaration.join import join
from shipid.declaration.model import Model
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.generation.simulator import input_rows
from shipid.generation.system import generate
from shipid.parts.helm import DirectRudder
from shipid.prediction.distance_loop import (
    LEAST_SHARE,
    NODE,
    DistanceLoop,
    Spread,
    make_distance_loop,
    unpacked_spread,
    with_clock,
)
from shipid.prediction.first_order import first_order_coefficients, first_order_ship
from shipid.prediction.order import Order, read_order, unwrapped
from shipid.prediction.predicted_track import PredictedTrack
from shipid.prediction.situation import Situation
from shipid.prediction.start_of_track import spread_in, states_in

#: Which model predicts.
Predicting = Literal["own", "first-order"]
#: How the band is found: not at all, by linear propagation, or by samples.
Band = Literal["none", "linear", "samples"]
#: Length of a track in ship lengths, and its nodes.
HORIZON, POINTS = 20.0, 600
#: Longest step of the prediction in L/u.
_LONGEST = 0.05


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
    UnknownNameError
        If there is no such kind of model.

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
        self.pilot, self.kind, self.condition = pilot, model, condition
        self.values = dict(values or {})
        self._steering = pilot if model == "own" else replace(pilot, model=first_order_ship)
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
        kind = _kind(order)
        if kind not in self._models:
            steering = self._steering
            if kind == "rudder":
                whole = steered_ship(steering)
                whole = join(whole.name, whole, *self._parts) if self._parts else whole
            else:
                mode: Literal["course", "rate"] = "course" if kind == "heading" else "rate"
                turn = (TurnOrder,) if kind == "turn" else ()
                whole = closed_loop(replace(steering, mode=mode), *turn, *self._parts)
            self._models[kind] = with_clock(whole)
        return self._models[kind]

    def predict(
        self,
        situation: Situation,
        *,
        heading: str | float | None = None,
        rudder: str | float | None = None,
        rate: str | float | None = None,
        rudder_limit: str | float | None = None,
        horizon: float = HORIZON,
        points: int = POINTS,
        band: Band = "linear",
        samples: int = 200,
        seed: int = 0,
    ) -> PredictedTrack:
        """Predict the track under an order that is given now.

        Parameters
        ----------
        situation : Situation
            What is known of the ship.
        heading, rudder, rate : str or float, optional
            The order, with a unit or in SI: a heading to steer, a rudder angle to hold, a rate of turn to hold, or a heading with the
            rate of the turn to it. One of them has to be given.
        rudder_limit : str or float, optional
            Largest rudder angle; the autopilot's own by default.
        horizon : float
            Length of the track in ship lengths.
        points : int
            Steps of the track.
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
            If the order or the horizon is none.
        UnstatedInputError
            If the model reads an input that nothing states and that declares no default.
        """
        order = read_order(heading, rudder, rate, rudder_limit)
        if band not in get_args(Band):
            raise UnknownNameError("band", band, get_args(Band))
        known = situation.uncertain and (situation.covariance.any() or any(situation.noise.values()))
        return self._run(situation, [order], horizon, points, band if known else "none", samples, seed)[0]

    def fan(
        self,
        situation: Situation,
        headings: Sequence[str | float],
        *,
        rudder_limit: str | float | None = None,
        horizon: float = HORIZON,
        points: int = POINTS,
    ) -> list[PredictedTrack]:
        """Predict the tracks to many headings, without their bands.

        Parameters
        ----------
        situation : Situation
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
        return self._run(situation, orders, horizon, points, "none", 0, 0) if orders else []

    def _run(
        self, situation: Situation, orders: Sequence[Order], horizon: float, points: int, band: Band, samples: int, seed: int
    ) -> list[PredictedTrack]:
        if not (0 < horizon < 1e4 and 0 < points <= 100_000):
            raise UsageError(f"a track of {horizon:g} ship lengths in {points} steps is none.")
        model = self.model_of(orders[0])
        speed = float(situation.values.get("cruise", situation.values["u"]))
        base = self._known(model, _kind(orders[0]), speed) | {
            n: v for n, v in situation.values.items() if n in (*model.parameters, *model.constants)
        }
        system = generate(model)
        distance = horizon * self.length / points
        runs = []
        for order in orders:
            own, start, inputs = self._ordered(order, situation, speed)
            p = system.vector(system.coefficients, base | own)
            u = input_rows(model, inputs, 1)[:, 0]
            x0, slopes = states_in(model, situation, start, u, p)
            runs.append((order, p, u, x0, slopes))
        substeps = self._substeps(distance, speed)
        least = LEAST_SHARE * speed
        if band == "linear":
            return [self._linear(model, situation, run, distance, points, substeps, least) for run in runs]
        plain = make_distance_loop(model, (), "none", substeps)
        steps = np.full((points + 1, 1), distance)
        tables = plain.loop.map(
            [x0 for _, _, _, x0, _ in runs],
            [steps] * len(runs),
            [plain.coefficients(p, u, least) for _, p, u, _, _ in runs],
            threads=1 if len(runs) == 1 else None,
        )
        tracks = [self._track(run, out, situation, model, least) for run, (_, out) in zip(runs, tables)]
        if band == "samples":
            return [
                self._sampled(model, situation, run, track, distance, substeps, least, samples, seed)
                for run, track in zip(runs, tracks)
            ]
        return tracks

    def _known(self, model: Model, kind: str, speed: float) -> dict[str, float]:
        key = (kind, speed)
        if key not in self._coefficients:
            if len(self._coefficients) > 256:
                self._coefficients.clear()
            if self.kind == "own":
                known = coefficients_of(self.pilot, model, speed, self.condition)
            else:
                known = dict(self.pilot.limits) | {"rudder_limit": self.pilot.rudder_limit}
                if not {"K", "tau", "gamma"} <= set(self.values):
                    known |= first_order_coefficients(self.pilot, speed, self.condition)
                known["L"] = self.pilot.length
            known |= self.values
            self._coefficients[key] = {n: v for n, v in known.items() if n in model}
        return self._coefficients[key]

    def _ordered(
        self, order: Order, situation: Situation, speed: float
    ) -> tuple[dict[str, float], dict[str, float], dict[str, float]]:
        """Coefficients, states and inputs that belong to an order."""
        own: dict[str, float] = {}
        start = {"track_s": 0.0, "track_t": 0.0}
        limit = order.rudder_limit if order.rudder_limit is not None else self.pilot.rudder_limit
        inputs = {**CALM, "cruise": speed, "loading": float(self.condition), **situation.values}
        psi = situation.values["psi"]
        if order.rudder is not None:
            bound = np.inf if order.rudder_limit is None else limit
            inputs["delta_order"] = float(np.clip(order.rudder, -bound, bound))
        else:
            own["rudder_limit"] = limit
        if order.rate is not None and order.heading is None:
            inputs["r_order"] = order.rate
        if order.rate is not None and order.heading is not None:
            own["turn_rate"] = order.rate
            start["psi_ramp"] = psi
        if order.heading is not None:
            inputs["psi_order"] = unwrapped(order.heading, psi)
        return own, start, inputs

    def _substeps(self, distance: float, speed: float) -> int:
        """Steps between two nodes, a power of two, so that few loops are compiled."""
        if speed not in self._longest:
            if len(self._longest) > 256:
                self._longest.clear()
            loop = steered_ship(self.pilot) if self.pilot.actuator is not DirectRudder else self.pilot.model
            finest = stiffest(self.pilot, loop, np.array([speed]))
            self._longest[speed] = min(finest, _LONGEST / self.pilot.pace(speed))
        return int(2 ** max(0, np.ceil(np.log2(distance / speed / self._longest[speed]))))

    def _track(
        self, run: tuple[Order, np.ndarray, np.ndarray, np.ndarray, object], out: np.ndarray, situation: Situation, model: Model, least: float
    ) -> PredictedTrack:
        order, _, inputs, _, _ = run
        columns = dict(zip(("s", "t", "x", "y", "psi", "r", "u", "v", "delta"), out[:, : len(NODE)].T))
        current = tuple(
            float(inputs[model.inputs.index(n)]) if n in model.inputs else 0.0 for n in ("current_north", "current_east")
        )
        limit = order.rudder_limit if order.rudder_limit is not None else self.pilot.rudder_limit
        track = PredictedTrack(
            **columns,
            order=order,
            length=self.length,
            limit=np.inf if order.rudder is not None else limit,
            current=(current[0], current[1]),
            source=self._source,
        )
        return _checked(track, least)

    def _linear(
        self,
        model: Model,
        situation: Situation,
        run: tuple[Order, np.ndarray, np.ndarray, np.ndarray, dict[str, dict[str, float]]],
        distance: float,
        points: int,
        substeps: int,
        least: float,
    ) -> PredictedTrack:
        _, p, u, x0, slopes = run
        extra, covariance, noise = spread_in(model, situation, slopes)
        loop = make_distance_loop(model, extra, "covariance", substeps)
        _, out = loop.loop(
            loop.carried(x0, covariance), np.full((points + 1, 1), distance), loop.coefficients(p, u, least, noise)
        )
        track = self._track(run, out, situation, model, least)
        return _with_spread(track, unpacked_spread(out[: track.s.size, len(NODE) :]))

    def _sampled(
        self,
        model: Model,
        situation: Situation,
        run: tuple[Order, np.ndarray, np.ndarray, np.ndarray, dict[str, dict[str, float]]],
        track: PredictedTrack,
        distance: float,
        substeps: int,
        least: float,
        samples: int,
        seed: int,
    ) -> PredictedTrack:
        if samples < 2:
            raise UsageError(f"a band by {samples} samples is none: take at least 2, better 200.")
        _, p, u, x0, slopes = run
        extra, covariance, noise = spread_in(model, situation, slopes)
        loop = make_distance_loop(model, extra, "drawn", substeps)
        system, random = loop.system, np.random.default_rng(seed)
        values, vectors = np.linalg.eigh(covariance)
        root = vectors * np.sqrt(np.maximum(values, 0.0))
        draws = random.standard_normal((samples, len(covariance))) @ root.T
        states = len(system.states)
        nodes = track.s.size
        controls = np.empty((samples, nodes, 1 + len(covariance)))
        controls[:, :, 0] = distance
        driven = np.flatnonzero(noise)
        controls[:, :, 1:] = 0.0
        if driven.size:
            controls[:, :, 1 + driven] = random.standard_normal((samples, nodes, driven.size))
        table = np.repeat(loop.coefficients(p, u, least, noise)[None], samples, axis=0)
        n_p = len(p)
        for k, name in enumerate(extra):
            in_p = name in system.coefficients
            place = system.coefficients.index(name) if in_p else n_p + system.inputs.index(name)
            drawn = table[:, place] + draws[:, states + k]
            low, high = (model[name].number(b) for b in ("low", "high")) if in_p else (None, None)
            table[:, place] = np.clip(drawn, -np.inf if low is None else low, np.inf if high is None else high)
        found = loop.loop.map(list(x0 + draws[:, :states]), list(controls), list(table))
        rows = np.stack([out[:, [2, 3, 4, 1]] for _, out in found])
        centre = np.stack([track.x, track.y, track.psi, track.t], axis=1)
        away = rows - centre
        lost = int(samples - np.isfinite(away).all(axis=(1, 2)).sum())
        away = away[np.isfinite(away).all(axis=(1, 2))]
        if len(away) < 2:
            return replace(track, ended=track.ended or "its samples run away: no band")
        spread = np.einsum("kni,knj->nij", away, away) / len(away)
        found_track = _with_spread(track, spread)
        return replace(found_track, ended=f"{lost} of {samples} samples run away") if lost else found_track


def _kind(order: Order) -> str:
    if order.rudder is not None:
        return "rudder"
    if order.rate is not None:
        return "rate" if order.heading is None else "turn"
    return "heading"


def _checked(track: PredictedTrack, least: float) -> PredictedTrack:
    """Cut a track where the model runs away, or where the ship loses its way."""
    good = np.isfinite(np.stack([track.s, track.t, track.x, track.y, track.psi, track.r, track.u])).all(axis=0)
    slow = track.u < least
    bad = ~good | slow
    if not bad.any():
        return track
    first = int(np.argmax(bad))
    why = (
        f"the ship loses its way: below {100 * LEAST_SHARE:.0f} % of its cruising speed the prediction ends"
        if slow[first] and good[first]
        else "the model runs away: it does not describe so hard a turn"
    )
    if first == 0:
        raise UsageError(f"nothing can be predicted: {why}.")
    return replace(track.part(0, first), ended=why)


def _with_spread(track: PredictedTrack, spread: np.ndarray) -> PredictedTrack:
    std = np.sqrt(np.maximum(np.einsum("nii->ni", spread), 0.0))
    return replace(track, covariance=spread[:, :2, :2], std={"psi": std[:, 2], "t": std[:, 3]})
