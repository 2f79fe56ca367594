"""When the predictor is asked, and which of its answers are shown: the tracks under the trial and under the executed order."""

from __future__ import annotations

import math

from shipid.bridge.core.console import Console, SteeringOrder
from shipid.bridge.core.forecast import PredictionAnswer, Question, ShownTrack
from shipid.bridge.core.route_watch import RouteWatch
from shipid.bridge.own_ship.own_ship import OwnShip

#: A track that begins so many ship lengths behind the ship is not shown.
_BEHIND = 2.0
#: Seconds between two looks at how far off the predictions were.
_LOOKS_BACK = 20.0


class ShownTracks:
    """The predicted tracks on the page.

    Parameters
    ----------
    console : Console
        What is tried and executed.
    own_ship : OwnShip
        The own ship.
    route : RouteWatch or None
        The route that is sailed.
    interval : float
        Between two predictions in s.
    predicts : bool
        Whether anything is predicted.

    Attributes
    ----------
    trial_changed : bool
        Whether the trial has to be predicted anew at once.
    """

    def __init__(
        self, console: Console, own_ship: OwnShip, route: RouteWatch | None, interval: float, predicts: bool
    ) -> None:
        self._console, self._own_ship, self._route = console, own_ship, route
        self._interval, self._predicts = interval, predicts
        self.trial_changed = False
        self._trial: ShownTrack | None = None
        self._executed: ShownTrack | None = None
        self._begins: SteeringOrder | None = None
        self._asked = self._looked_back = -math.inf
        self._answered = 0.0

    def question(self, t: float) -> Question | None:
        """Return what is to be predicted now, or None where nothing is due.

        Parameters
        ----------
        t : float
            In s on the bridge's clock.
        """
        known, console = self._own_ship.situation, self._console
        if known is None or not self._predicts:
            return None
        trial = None if console.trial == console.executed else console.trial
        if t - self._asked >= self._interval - 1e-6:
            self._asked = t
            self.trial_changed = False
            executed, begins = console.executed, self._begins
            self._begins = None
            past = None
            if t - self._looked_back >= _LOOKS_BACK:
                # Once in a while: how far off predictions were does not change from one to the next.
                self._looked_back = t
                past = self._own_ship.remembered.past()
            return Question(
                t,
                known,
                self._as_headed(trial),
                self._as_headed(executed),
                self._route.next_leg if self._route is not None and self._own_ship.placed else None,
                console.trial.rudder_limit,
                executed is not None and executed.mode == "track",
                begins,
                past,
            )
        if self.trial_changed:
            self.trial_changed = False
            if trial is None:
                self._trial = None
                return None
            return Question(t, known, self._as_headed(trial))
        return None

    def _as_headed(self, steering: SteeringOrder | None) -> SteeringOrder | None:
        """A steering along the route, with the heading that it is about now."""
        if steering is None or steering.mode != "track" or self._route is None:
            return steering
        leg = self._route.route.plan.legs[self._route.leg]
        return SteeringOrder("track", leg.course % (2 * math.pi), steering.rudder_limit, steering.rate, steering.rudder)

    def take(self, answer: PredictionAnswer) -> None:
        """Take what was predicted; a trial that has changed meanwhile is predicted again.

        Parameters
        ----------
        answer : PredictionAnswer
            Of a question of `question`.
        """
        asked = answer.question
        if asked.executed is not None or asked.trial is not None:
            self._answered = asked.t
        if asked.executed is not None:
            self._executed = answer.executed
        if self._console.trial == self._console.executed:
            self._trial = None
        elif answer.trial is not None:
            self._trial = answer.trial

    def execute(self, order: SteeringOrder) -> None:
        """Take the track of the trial as that of the order that was executed just now, until it is predicted anew.

        Parameters
        ----------
        order : SteeringOrder
            The order.
        """
        self._executed, self._trial = self._trial or self._executed, None
        self._asked, self._begins = -math.inf, order

    def text(self, t: float) -> str:
        """Return the tracks as JSON.

        Parameters
        ----------
        t : float
            In s on the bridge's clock.
        """
        late = self._lateness(t)
        tracks = (("trial", self._trial), ("executed", self._executed))
        shown = {n: "null" if track is None else (late or track).text for n, track in tracks}
        return f'{{"trial":{shown["trial"]},"executed":{shown["executed"]}}}'

    def _lateness(self, t: float) -> ShownTrack | None:
        """What stands in place of tracks that begin where the ship was long ago; None where they are in time."""
        known, late = self._own_ship.situation, t - self._answered
        if known is None or late * known.values["u"] <= _BEHIND * self._own_ship.length:
            return None
        return ShownTrack(
            None, f"the predictor is {late:.0f} s late: this computer is too slow, or busy with other work."
        )
