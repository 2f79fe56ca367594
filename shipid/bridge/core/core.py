"""The core of the bridge: what a reading, a command and an answer of the predictor do to what the page shows.

It has no clock of its own: whoever drives it says the time, so that a test and a browser see the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime, timedelta

from shipid.autopilot.design.autopilot import Autopilot
from shipid.bridge.core.alarm_watch import AlarmWatch
from shipid.bridge.core.companions import Recording, VoyageJudge
from shipid.bridge.core.console import Console, Limits, SteeringMode, SteeringOrder
from shipid.bridge.core.forecast import Forecaster, PredictionAnswer, Question
from shipid.bridge.core.route_watch import BridgeRoute, RouteWatch
from shipid.bridge.core.scale_watch import ScaleWatch
from shipid.bridge.core.shown_tracks import ShownTracks
from shipid.bridge.core.source import SampleSource, SourceReading, Steered
from shipid.bridge.core.targets import Targets
from shipid.bridge.own_ship.own_ship import OwnShip
from shipid.bridge.shown.alarms import Alarms
from shipid.bridge.shown.board import Board
from shipid.bridge.shown.past_track import PastTrack
from shipid.bridge.shown.plain_values import number
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import TrackPredictor

#: Ranges of a trial rate of turn, as r L/U; and the rudder limit at the beginning, in rad, where the ship allows it.
_SLOWEST, _FASTEST = 0.02, 0.8
RUDDER_LIMIT = math.radians(10.0)

#: A remark of the source is shown for so many seconds.
_TOLD = 60.0


class BridgeCore:
    """Own ship, console, route, alarms and predicted tracks.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot, with the model and the ship.
    source : SampleSource
        Where the samples come from.
    route : BridgeRoute, optional
        The planned track.
    recording : Recording, optional
        What keeps the samples.
    score : VoyageJudge, optional
        What judges the voyage.
    filter_interval, prediction_interval : float
        Between two steps of the filters, and between two predictions, in s.
    started : datetime, optional
        The moment of t = 0; unknown by default.
    predicts : bool
        Whether tracks are predicted, and the wheel-over with them.
    heading, rudder_limit : float
        On the console at the beginning, in rad.
    notes : sequence of str
        What was found out when the route and the chart were read.
    faults : sequence of str
        What is wrong with the schedule of the autopilot.

    Attributes
    ----------
    board : Board
        What the page shows.
    past : PastTrack
        Where the ship has been.
    console : Console
        What is tried and executed.
    alarms : Alarms
        The alarms.
    tracks : ShownTracks
        The predicted tracks, and when they are predicted.
    forecaster : Forecaster
        Answers the questions of `question`.
    t : float
        The time of the last step in s.
    slowed : bool
        Whether the machine cannot keep up with the clock factor.
    """

    def __init__(
        self,
        pilot: Autopilot,
        source: SampleSource,
        *,
        route: BridgeRoute | None = None,
        recording: Recording | None = None,
        score: VoyageJudge | None = None,
        filter_interval: float = 0.4,
        prediction_interval: float = 2.0,
        started: datetime | None = None,
        predicts: bool = True,
        heading: float = 0.0,
        rudder_limit: float = RUDDER_LIMIT,
        notes: Sequence[str] = (),
        faults: Sequence[str] = (),
    ) -> None:
        self.pilot, self.source = pilot, source
        self.filter_interval, self.prediction_interval = filter_interval, prediction_interval
        self.board, self.past, self.alarms, self.targets = Board(), PastTrack(), Alarms(), Targets()
        self.own_ship = OwnShip(pilot)
        self.watch = None if route is None else RouteWatch(route)
        self.forecaster = Forecaster(TrackPredictor(pilot), prediction_interval)
        self.scale = ScaleWatch()
        self.steered: Steered | None = source if isinstance(source, Steered) else None
        self.recording, self.score, self._started = recording, score, started
        self.console = self._console(route is not None, heading, rudder_limit)
        self.t = 0.0
        self.clock_factor: float | None = 1.0 if source.timed else None
        self.paused = self.slowed = False
        self.tracks = ShownTracks(self.console, self.own_ship, self.watch, prediction_interval, predicts)
        self._alarm_watch = AlarmWatch(self.alarms, source, self.own_ship, self.watch, recording)
        self._heading_known = self.steered is not None
        self._told, self._told_at, self._touched = "", 0.0, False
        length, beam = pilot.length, pilot.ship.particular("B", "m")
        self.board.put("ship", {"name": pilot.ship.name, "length": number(length), "beam": number(beam)})
        self.board.put("notes", [*notes, *faults])
        for k, fault in enumerate(faults):
            self.alarms.set(f"schedule:{k}", True, 0.0, "warning", str(fault))
        if notes:
            self.alarms.set(
                "notes", True, 0.0, "caution", "the route or the chart was not read as it stands: see Details"
            )
        self.publish()

    def _console(self, routed: bool, heading: float, rudder_limit: float) -> Console:
        pilot = self.pilot
        largest = pilot.limits.get("delta_max", pilot.rudder_limit)
        pace = pilot.pace(pilot.own_speed)
        start = SteeringOrder("heading", heading % (2 * math.pi), min(rudder_limit, largest), 0.2 * pace, 0.0)
        limits = Limits((math.radians(1.0), largest), (_SLOWEST * pace, _FASTEST * pace), (-largest, largest))
        modes: tuple[SteeringMode, ...] = ("heading", "rudder", "rate")
        return Console(start, limits, (*modes, "track") if routed else modes, executed=self.steered is not None)

    # What happens with time.

    @property
    def standing(self) -> bool:
        """Whether time stands: it is paused, or a record has been played to its end. What was sailed after that is not known."""
        return self.paused or (self.source.timed and self.source.state == "ended")

    def step(self, t: float) -> None:
        """Take what the source has up to a time; the filter goes on also where that is nothing.

        Parameters
        ----------
        t : float
            In s on the bridge's clock, later than the step before.
        """
        reading = self.source.take(t)
        self.t = t
        self.own_ship.take(t, reading.values)
        if reading.told:
            self._told, self._told_at = reading.told[-1], t
        elif t - self._told_at > _TOLD:
            self._told = ""
        if self.recording is not None and reading.values:
            self.recording.add(t, reading.values)
        self._follow(reading)
        self._alarm_watch.look(t)

    def _follow(self, reading: SourceReading) -> None:
        known = self.own_ship.situation
        if known is None:
            if self.watch is not None:
                self.watch.lose()
            return
        values = known.values
        if not self._heading_known:
            # The console begins at the ship's own heading, unless it was set meanwhile.
            self._heading_known = True
            if not self._touched:
                self.console.change({"heading": values["psi"]})
        if not self.own_ship.sensors.silent:
            # Where she has been is not where the filter takes her to be once nothing is heard.
            self.past.add(self.t, values["x"], values["y"])
        self.targets.take(reading.targets, values)
        self.scale.update(self.t, values)
        if self.watch is not None and self.own_ship.placed:
            self.watch.update(values["x"], values["y"])
        if self.score is not None:
            # The voyage of a simulated ship is judged by where she is, not by where the filter takes her to be.
            self.score.add(self.t, values if self.steered is None else self.steered.now)

    # What is predicted.

    def question(self) -> Question | None:
        """Return what is to be predicted now, or None where nothing is due."""
        return self.tracks.question(self.t)

    def take_answer(self, answer: PredictionAnswer) -> None:
        """Take what was predicted; the track pilot's order is steered.

        Parameters
        ----------
        answer : PredictionAnswer
            Of a question of `question`.
        """
        asked = answer.question
        if asked.begins is not None:
            self.scale.begin(answer.still)
        self.tracks.take(answer)
        # What is asked once a trial has changed says nothing of the route; nor has a ship that others steer anything executed.
        if self.watch is not None and (asked.executed or asked.leg or self.watch.next_leg is None):
            track = None if answer.executed is None else answer.executed.track
            # Where a turn begins is not known from the first samples: the time would jump, by minutes, and with it a warning.
            self.watch.take(None if self.own_ship.starting else answer.wheel_over, track, asked.t)
        if self.watch is not None:
            self.watch.unsteered = answer.unsteered
        executed = self.console.executed
        if answer.order is not None and self.steered is not None and executed is not None and executed.mode == "track":
            order = answer.order
            self.steered.steer(
                SteeringOrder("heading", order.heading, order.rudder_limit, executed.rate, executed.rudder)
            )

    def warm(self) -> None:
        """Have everything compiled that a command may ask for; it is called in the thread of the predictor."""
        self.forecaster.warm(Situation({"psi": 0.0, "u": self.pilot.own_speed}))
        if self.steered is not None:
            self.steered.warm()

    # What a navigator does.

    def command(self, message: Mapping[str, Plain]) -> None:
        """Do what the page asks for.

        Parameters
        ----------
        message : mapping
            ``command``, and what belongs to it.

        Raises
        ------
        UsageError
            If there is no such command, or a value is none; nothing is changed then.
        """
        name = message.get("command")
        rest = {k: v for k, v in message.items() if k != "command"}
        commands: dict[str, Callable[[dict[str, Plain]], None]] = {
            "trial": self._try,
            "execute": self._execute,
            "cancel": self._cancel,
            "acknowledge": self._acknowledge,
            "simulation": self._simulation,
        }
        if not isinstance(name, str) or name not in commands:
            raise UsageError(f"there is no such command; there are {', '.join(commands)}.")
        if more := [k for k in rest if name not in ("trial", "simulation") and (name, k) != ("acknowledge", "id")]:
            raise UsageError(f"'{name}' has no '{more[0][:40]}'.")
        commands[name](rest)

    def _try(self, rest: dict[str, Plain]) -> None:
        self._touched = True
        self.tracks.trial_changed |= self.console.change(rest)

    def _cancel(self, rest: dict[str, Plain]) -> None:
        self.tracks.trial_changed |= self.console.cancel()

    def _execute(self, rest: dict[str, Plain]) -> None:
        self.console.execute()
        executed = self.console.executed
        assert executed is not None
        self.tracks.execute(executed)
        if executed.mode == "track" and self.watch is not None:
            self.forecaster.follow(self.watch.route.plan, executed.rudder_limit, self.watch.leg)
        elif self.steered is not None:
            self.steered.steer(executed)

    def _acknowledge(self, rest: dict[str, Plain]) -> None:
        which = rest.get("id")
        if isinstance(which, bool) or not isinstance(which, int):
            raise UsageError("an alarm is acknowledged by its id.")
        self.alarms.acknowledge(which)

    def _simulation(self, rest: dict[str, Plain]) -> None:
        if self.clock_factor is None:
            raise UsageError(f"the source {self.source.kind} is not simulated.")
        wanted = dict(rest)
        factor, paused = wanted.pop("clock_factor", None), wanted.pop("paused", None)
        if factor is not None and (
            isinstance(factor, bool) or not isinstance(factor, (int, float)) or not 0.1 <= factor <= 1000
        ):
            raise UsageError("the clock factor is a number from 0.1 to 1000.")
        if paused is not None and not isinstance(paused, bool):
            raise UsageError("'paused' is true or false.")
        if wanted:
            if self.steered is None:
                raise UsageError(f"the source {self.source.kind} is not simulated.")
            self.steered.change(wanted)
        self.clock_factor = self.clock_factor if factor is None else float(factor)
        self.paused = self.paused if paused is None else paused

    # What is shown.

    def publish(self) -> None:
        """Bring the board up to date."""
        put, own, t = self.board.put, self.own_ship, self.t
        state: str = self.source.state
        if state == "running":
            state = "paused" if self.paused else "slower than asked" if self.slowed else state
        put("time", {
            "t": number(t, 9), "utc": self._utc(), "source": self.source.kind, "state": state, "clock_factor": number(self.clock_factor),
        })  # fmt: skip
        put("own", own.to_dict())
        put("sensors", own.sensors.to_list())
        put("settings", self.console.to_dict())
        self.board.put_text("tracks", self.tracks.text(t))
        self.board.put_text("route", "null" if self.watch is None else self.watch.text(t))
        put("flow", own.flow())
        # Why nothing comes is worth more than that the filter waits for it.
        message = (self.source.state == "lost" and self._told) or own.message or self._told or None
        health = {"state": own.health, "message": message, "rejected": number(own.rejected, 3)}
        put("adaptation", {"values": [*own.adaptation(), *self.scale.to_list()], "health": health})
        put("alarms", self.alarms.to_list())
        put("targets", self.targets.to_list(t))
        simulation: dict[str, Plain] | None = None
        if self.clock_factor is not None:
            simulation = {
                **({} if self.steered is None else self.steered.to_dict()), "clock_factor": number(self.clock_factor), "paused": self.paused,
                "clock_factors": [1, 2, 4, 8, 16, 32, 64],
            }  # fmt: skip
        put("simulation", simulation)
        put("experiment", None if self.score is None else self.score.to_dict())
        nothing = {"file": None, "samples": 0, "message": None}
        put("recording", nothing if self.recording is None else self.recording.to_dict())

    def _utc(self) -> str | None:
        if self._started is None:
            return None
        moment = (self._started + timedelta(seconds=self.t)).astimezone(UTC)
        return moment.strftime("%Y-%m-%dT%H:%M:%SZ")
