"""One run of a track: an order with the coefficients, inputs and states that belong to it, and the track the loop returns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from shipid.autopilot.course_changes.weather import CALM
from shipid.autopilot.design.autopilot import Autopilot
from shipid.declaration.model import Model
from shipid.foundation.errors import UsageError
from shipid.generation.departure import first_departure
from shipid.generation.simulator import input_rows
from shipid.generation.system import generate
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.distance_loop import LEAST_SHARE, NODE
from shipid.prediction.tracks.order import Order, unwrapped
from shipid.prediction.tracks.predicted_track import COLUMNS, PredictedTrack
from shipid.prediction.tracks.start_of_track import states_in


@dataclass(frozen=True, eq=False)
class TrackRun:
    """An order, and what the loop needs to run under it; SI.

    Attributes
    ----------
    model : Model
        What runs.
    situation : Situation
        What is known of the ship.
    order : Order
        What is ordered.
    p, inputs, x0 : ndarray
        Coefficients, inputs and initial states, in the order of the model.
    slopes : mapping
        See `shipid.prediction.tracks.start_of_track.states_in`.
    least : float
        Speed in m/s below which the ship has lost her way.
    limit : float
        Largest rudder angle in rad; infinite where the rudder itself is ordered.
    length : float
        Of the ship in m.
    source : str
        Which model predicts.
    """

    model: Model
    situation: Situation
    order: Order
    p: np.ndarray
    inputs: np.ndarray
    x0: np.ndarray
    slopes: Mapping[str, Mapping[str, float]]
    least: float
    limit: float
    length: float
    source: str

    def to_heading(self, order: Order) -> TrackRun:
        """Return the same run to another heading; nothing else of it depends on that.

        Parameters
        ----------
        order : Order
            A heading, under the same rudder limit.
        """
        assert order.heading is not None
        inputs = self.inputs.copy()
        inputs[self.model.inputs.index("psi_order")] = unwrapped(order.heading, self.situation.values["psi"])
        return replace(self, order=order, inputs=inputs)

    def track(self, out: np.ndarray) -> PredictedTrack:
        """Return the track out of the rows of the loop, as far as the ship sails it.

        Parameters
        ----------
        out : ndarray, shape (N, outputs)
            One row a node: `NODE`, then the margins of the guards.

        Returns
        -------
        PredictedTrack

        Raises
        ------
        UsageError
            If not even its first node can be predicted.
        """
        names = self.model.inputs
        north, east = (
            float(self.inputs[names.index(n)]) if n in names else 0.0 for n in ("current_north", "current_east")
        )
        track = PredictedTrack(
            **dict(zip(COLUMNS, out[:, : len(NODE)].T)),
            order=self.order,
            length=self.length,
            limit=self.limit,
            current=(north, east),
            source=self.source,
        )
        guards = self.model.guards
        margins = dict(zip(guards, out[:, len(NODE) : len(NODE) + len(guards)].T))
        left = first_departure(self.model, track.t, margins, out[:, : len(NODE)].T)
        if left is None:
            return track
        first = int(np.argmax(~(track.t < left.time)))
        if first == 0:
            raise UsageError(f"nothing can be predicted: {left.reason}.")
        return replace(track.part(0, first), ended=str(left))


def kind_of(order: Order) -> str:
    """Return which model an order needs: "heading", "rudder", "rate", or "turn" for a rate and a heading.

    Parameters
    ----------
    order : Order
        The order.
    """
    if order.rudder is not None:
        return "rudder"
    if order.rate is not None:
        return "rate" if order.heading is None else "turn"
    return "heading"


def ordered_run(
    model: Model,
    pilot: Autopilot,
    situation: Situation,
    order: Order,
    known: Mapping[str, float],
    condition: int,
    source: str,
) -> TrackRun:
    """Lay out the coefficients, inputs and states that belong to an order.

    Parameters
    ----------
    model : Model
        What runs.
    pilot : Autopilot
        Its autopilot, for the rudder limit where none is ordered.
    situation : Situation
        What is known of the ship.
    order : Order
        The order.
    known : mapping of str to float
        Coefficients, SI.
    condition : int
        Which load condition.
    source : str
        Which model predicts.

    Returns
    -------
    TrackRun

    Raises
    ------
    UnstatedInputError
        If the model reads an input that nothing states and that declares no default.
    """
    system, speed, psi = generate(model), cruise_of(situation), situation.values["psi"]
    limit = pilot.rudder_limit if order.rudder_limit is None else order.rudder_limit
    own: dict[str, float] = {}
    start = {"track_s": 0.0, "track_t": 0.0}
    acting = {**CALM, "cruise": speed, "loading": float(condition), **situation.values}
    if order.rudder is not None:
        bound = np.inf if order.rudder_limit is None else limit
        acting["delta_order"] = float(np.clip(order.rudder, -bound, bound))
    else:
        own["rudder_limit"] = limit
    if order.heading is not None:
        acting["psi_order"] = unwrapped(order.heading, psi)
    if order.rate is not None and order.heading is None:
        acting["r_order"] = order.rate
    elif order.rate is not None:
        own["turn_rate"], start["psi_ramp"] = order.rate, psi
    p = system.vector(system.coefficients, {**known, **own})
    inputs = input_rows(model, acting, 1)[:, 0]
    x0, slopes = states_in(model, situation, start, inputs, p)
    return TrackRun(
        model,
        situation,
        order,
        p,
        inputs,
        x0,
        slopes,
        LEAST_SHARE * speed,
        np.inf if order.rudder is not None else limit,
        pilot.length,
        source,
    )


def cruise_of(situation: Situation) -> float:
    """Return the speed before the manoeuvre in m/s: the one that is stated, or the present one.

    Parameters
    ----------
    situation : Situation
        What is known of the ship.
    """
    return float(situation.values.get("cruise", situation.values["u"]))
