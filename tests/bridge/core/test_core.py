"""The core against a clock that the test turns: filter, predictor, console, alarms, and what is shown of them."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import shipid
from shipid.bridge.bridge_settings import BridgeSettings
from shipid.bridge.core.route_watch import bridge_route
from shipid.bridge.core.source import SourceReading, Target
from shipid.bridge.open_bridge import pilot_of
from shipid.bridge.own_ship.gate_watch import GateWatch
from shipid.bridge.sources.simulated import SimulatedSource
from shipid.foundation.errors import UsageError
from shipid.parameters.replaced import with_values
from shipid.prediction.following.track_pilot import TrackPilot
from shipid.prediction.routes.route import route_through

from ..conftest import sail, shown

KEYS = {
    "ship", "time", "own", "sensors", "settings", "tracks", "route", "flow", "adaptation", "alarms", "targets", "simulation",
    "experiment", "recording", "notes",
}  # fmt: skip


class Scripted:
    """A source that shows a straight voyage at 9 m/s to the north, with what the test takes away or adds."""

    kind, timed, state = "nmea", False, "running"

    def __init__(self):
        self.silent: set[str] = set()
        self.offset = 0.0
        self.targets, self.told = (), ()
        self.heading = 0.0

    async def start(self):
        pass

    async def stop(self):
        pass

    def take(self, t):
        values = {"psi": self.heading, "r": 0.0, "u": 9.0, "x": 9.0 * t + self.offset, "y": 0.0, "delta": 0.0}
        return SourceReading({n: v for n, v in values.items() if n not in self.silent}, self.targets, self.told)


@pytest.fixture
def scripted(make_core):
    source = Scripted()
    return source, make_core(source)


def texts(core):
    return [a["text"] for a in core.alarms.to_list()]


def test_every_key_is_there_from_the_beginning(make_core):
    assert set(shown(make_core())) == KEYS


def test_a_position_that_jumps_is_an_alarm_and_the_core_goes_on(scripted):
    source, core = scripted
    sail(core, 60)
    assert not texts(core)
    before = core.own_ship.situation.current_std
    source.offset = 20_000.0
    sail(core, 30)
    assert "the position has jumped by 10.80 nm: check the fixes" in texts(core)
    known = core.own_ship.situation
    assert known.values["x"] == pytest.approx(9.0 * core.t + 20_000, abs=60)
    # A receiver that has jumped may err again, but not by as much as it jumped.
    assert 1.2 * before < known.current_std < 3.0
    sail(core, 70)
    assert "the position has jumped by 10.80 nm: check the fixes (no longer)" in texts(core)


def test_what_was_not_understood_of_the_route_is_a_caution_and_stands_in_the_details(make_core):
    core = make_core(Scripted(), notes=["route: not understood, and left out: portXTD of leg."])
    assert shown(core)["notes"] == ["route: not understood, and left out: portXTD of leg."]
    assert [(a["kind"], a["text"][:42]) for a in core.alarms.to_list()] == [
        ("caution", "the route or the chart was not read as it ")
    ]
    core.step(1.0)
    assert len(core.alarms.to_list()) == 1 and not make_core(Scripted()).alarms.to_list()


def test_the_filter_finds_the_ship_and_the_predictor_her_track(make_core, pilot):
    core = make_core()
    sail(core, 60)
    told, truth = shown(core), core.source.now
    assert told["own"]["psi"] == pytest.approx(truth["psi"], abs=0.01)
    # A fix has 10 m of noise: after 150 of them the estimate is better than 10 m.
    assert math.hypot(told["own"]["x"] - truth["x"], told["own"]["y"] - truth["y"]) < 10
    track = told["tracks"]["executed"]
    assert len(track["x"]) == 200 and len(track["half_width"]) == 200
    assert track["s"][-1] == pytest.approx(20 * pilot.length, rel=1e-3)
    assert told["tracks"]["trial"] is None


def test_a_trial_is_predicted_at_once_and_executed_it_is_sailed(make_core):
    core = make_core()
    sail(core, 10)
    core.question()
    core.command({"command": "trial", "heading": 1.0, "rudder_limit": math.radians(15)})
    question = core.question()
    assert question is not None and question.executed is None and question.trial.heading == 1.0
    core.take_answer(core.forecaster.answer(question))
    assert shown(core)["tracks"]["trial"]["psi"][-1] == pytest.approx(1.0, abs=0.05)
    core.command({"command": "execute"})
    told = shown(core)
    assert told["settings"]["executed"]["heading"] == 1.0
    assert told["tracks"]["trial"] is None and told["tracks"]["executed"]["psi"][-1] == pytest.approx(1.0, abs=0.05)
    sail(core, 300)
    assert core.source.now["psi"] == pytest.approx(1.0, abs=0.01)
    names = {v["name"]: v for v in shown(core)["adaptation"]["values"]}
    assert 0.8 < names["K_rho"]["value"] < 1.25 and names["K"]["sd"] < 0.2


def test_beside_a_speed_over_the_ground_no_current_is_told(scripted):
    source, core = scripted
    take = source.take

    def over_ground(t):
        reading = take(t)
        values = dict(reading.values)
        values["SOG"] = values.pop("u")
        return SourceReading(values, reading.targets)

    source.take = over_ground
    sail(core, 60)
    assert core.own_ship.situation is not None and shown(core)["flow"]["current"] is None
    source.take = take
    sail(core, 10)
    assert shown(core)["flow"]["current"]["speed"] == pytest.approx(0.0, abs=0.5)


def test_cancel_takes_the_trial_back(make_core):
    core = make_core()
    core.command({"command": "trial", "heading": 1.0})
    core.command({"command": "cancel"})
    assert core.console.trial == core.console.executed


@pytest.mark.parametrize(
    ("wanted", "name", "value"),
    [
        ({"heading": -math.pi / 2}, "heading", 1.5 * math.pi),
        ({"rudder_limit": 9.0}, "rudder_limit", math.radians(35)),
        ({"rudder": -9.0}, "rudder", -math.radians(35)),
        ({"mode": "rudder"}, "mode", "rudder"),
    ],
)
def test_what_is_tried_stays_within_its_range(make_core, wanted, name, value):
    core = make_core()
    core.command({"command": "trial", **wanted})
    found = core.console.trial.to_dict()[name]
    assert found == (value if isinstance(value, str) else pytest.approx(value))


@pytest.mark.parametrize(
    "message",
    [
        {}, {"command": 3}, {"command": "sink"}, {"command": "trial", "heading": "north"}, {"command": "trial", "heading": True},
        {"command": "trial", "heading": math.nan}, {"command": "trial", "mode": "track"}, {"command": "trial", "mode": []},
        {"command": "trial", "depth": 3.0}, {"command": "acknowledge"}, {"command": "acknowledge", "id": True},
        {"command": "acknowledge", "id": 77}, {"command": "simulation", "clock_factor": 1e9}, {"command": "simulation", "paused": 1},
        {"command": "simulation", "wind_speed": "strong"}, {"command": "simulation", "depth": 1.0},
        {"command": "simulation", "coefficient": "Q", "value": 1.0}, {"command": "simulation", "coefficient": "K"},
        {"command": "simulation", "coefficient": [], "value": 1.0}, {"command": "trial", "heading": 10**400},
        {"command": "trial", "rudder": -(10**400)}, {"command": "simulation", "wind_speed": 10**400},
        {"command": "simulation", "coefficient": "K", "value": 10**400}, {"command": "simulation", "clock_factor": 10**400},
        {"command": "execute", "heading": 1.0}, {"command": "cancel", "id": 1}, {"command": "acknowledge", "id": 1, "heading": 1.0},
    ],
)  # fmt: skip
def test_a_command_that_is_none_changes_nothing(make_core, message):
    core = make_core()
    before = shown(core)
    with pytest.raises(UsageError):
        core.command(message)
    assert shown(core) == before


def test_under_the_rudder_and_at_a_rate_of_turn(make_core):
    core = make_core()
    sail(core, 5)
    core.command({"command": "trial", "mode": "rudder", "rudder": 0.2})
    core.command({"command": "execute"})
    sail(core, 60)
    assert core.source.now["delta"] == pytest.approx(0.2, abs=1e-3) and core.source.now["r"] > 0.005
    assert shown(core)["settings"]["mode"] == "rudder"
    psi = core.source.now["psi"]
    core.command({"command": "trial", "mode": "rate", "heading": psi + 2.0, "rate": 0.006})
    core.command({"command": "execute"})
    sail(core, 150)
    assert core.source.now["r"] == pytest.approx(0.006, rel=0.1)
    core.command({"command": "trial", "mode": "heading", "heading": 0.0})
    core.command({"command": "execute"})
    sail(core, 5)
    assert core.source.now["psi"] > psi  # she sails on from where she is


def test_the_simulated_ship_and_her_surroundings_can_be_changed(make_core):
    core = make_core()
    sail(core, 5)
    core.command(
        {"command": "simulation", "coefficient": "K", "value": 1.0, "current_speed": 1.5, "current_direction_to": 1.0}
    )
    core.command({"command": "simulation", "wind_speed": 8.0, "wind_direction_from": 0.5})
    told = shown(core)["simulation"]
    assert next(c for c in told["coefficients"] if c["name"] == "K")["value"] == 1.0
    assert (told["current_speed"], told["wind_direction_from"]) == (1.5, pytest.approx(0.5))
    assert core.source.ship.coefficients["K"] == 1.0
    sail(core, 400)
    current = shown(core)["flow"]["current"]
    assert current["speed"] == pytest.approx(1.5, abs=0.4) and current["direction_to"] == pytest.approx(1.0, abs=0.3)
    core.command({"command": "trial", "mode": "rudder", "rudder": 0.1})
    core.command({"command": "execute"})
    assert core.source.ship.coefficients["K"] == 1.0  # also under another order


@pytest.mark.parametrize("name", ["psi", "r", "u", "delta"])
def test_a_lost_sensor_is_told_and_the_filter_goes_on(scripted, name):
    source, core = scripted
    sail(core, 60)
    assert texts(core) == []
    source.silent = {name}
    sail(core, 20)
    told = shown(core)
    assert [a["text"].startswith("sensor lost") for a in told["alarms"]] == [True]
    assert next(s for s in told["sensors"] if s["name"] == name)["lost"]
    assert (name in told["own"]["estimated"]) == (name != "delta")
    if name == "delta":
        assert told["own"]["delta"] is None
    assert told["own"]["x"] == pytest.approx(9 * core.t, abs=15) and told["tracks"]["executed"] is None
    core.command({"command": "acknowledge", "id": told["alarms"][0]["id"]})
    source.silent = set()
    sail(core, 2)
    assert texts(core) == [] and core.own_ship.health == "well"


def test_without_fixes_the_ship_is_reckoned(scripted):
    source, core = scripted
    sail(core, 120)
    source.silent = {"x", "y"}
    sail(core, 60)
    told = shown(core)
    assert told["own"]["x"] == pytest.approx(9 * core.t, abs=60)
    assert {"x", "y", "sog", "cog"} <= set(told["own"]["estimated"])
    assert told["alarms"][0]["text"] == "sensor lost: position" and told["alarms"][0]["kind"] == "alarm"


def test_a_jump_of_the_position_is_rejected_and_told(scripted):
    source, core = scripted
    sail(core, 120)
    source.offset = 3000.0
    shares = [core.own_ship.rejected]
    for _ in range(10):
        core.step(core.t + 0.4)
        shares.append(core.own_ship.rejected)
    core.publish()
    assert shown(core)["own"]["x"] == pytest.approx(9 * core.t, abs=30)
    # Of the fixes that come every 0.4 s one in 2 s is taken.
    assert np.count_nonzero(np.diff(shares) > 0) == 2


def test_a_sensor_that_is_lost_does_not_come_back_with_silence(scripted):
    source, core = scripted
    sail(core, 30)
    source.silent = {"psi"}
    sail(core, 8)
    source.silent = {"psi", "r", "u", "x", "y", "delta"}
    sail(core, 8)
    assert sorted(texts(core)) == ["no data from the source (nmea)", "sensor lost: heading"]


def test_silence_is_stale_and_the_alarm_comes_again(scripted):
    source, core = scripted
    sail(core, 30)
    source.silent = {"psi", "r", "u", "x", "y", "delta"}
    sail(core, 8)
    first = shown(core)["alarms"]
    assert [a["text"] for a in first] == ["no data from the source (nmea)"] and shown(core)["own"]["age"] > 5
    core.command({"command": "acknowledge", "id": first[0]["id"]})
    assert shown(core)["alarms"][0]["acknowledged"]
    source.silent = set()
    sail(core, 2)
    assert shown(core)["alarms"] == []
    source.silent = {"psi", "r", "u", "x", "y", "delta"}
    sail(core, 8)
    again = shown(core)["alarms"]
    assert not again[0]["acknowledged"] and again[0]["id"] > first[0]["id"]


def test_a_filter_that_diverges_is_an_alarm_and_begins_again(scripted, monkeypatch):
    from shipid.estimation.errors import FilterDivergedError

    _, core = scripted
    sail(core, 30)
    online = core.own_ship._online  # noqa: SLF001 - there is no honest way to make this filter diverge

    def diverge(sample, **_):
        raise FilterDivergedError("the filter diverges at 30 s.")

    monkeypatch.setattr(online, "update", diverge)
    core.step(core.t + 0.4)
    told = shown(core)
    assert told["adaptation"]["health"]["state"] == "diverged" and told["own"]["x"] is None
    assert told["alarms"][0]["kind"] == "alarm" and "diverged" in told["alarms"][0]["text"]
    sail(core, 70)
    assert core.own_ship.health == "well" and shown(core)["own"]["x"] == pytest.approx(9 * core.t, abs=20)


def test_a_heading_that_is_refused_for_long_is_believed_and_told(scripted):
    """Of two gyros the other is heard now and then at first: the filter then kept its heading for ever, and without a word."""
    source, core = scripted
    for k in range(10):
        source.heading = math.radians(30 if k % 2 == 0 else 0)
        core.step(core.t + 0.4)
    source.heading = 0.0
    sail(core, 20)
    assert math.degrees(shown(core)["own"]["psi"]) == pytest.approx(30, abs=5)
    sail(core, 20)
    told = shown(core)
    assert math.sin(told["own"]["psi"]) == pytest.approx(0, abs=0.03)
    assert any(
        "the heading that is heard was not what follows" in a["text"] and a["kind"] == "alarm" for a in told["alarms"]
    )


def test_a_single_sensor_that_is_rejected_makes_the_filter_doubtful():
    """A heading that comes seldom is a small share of all samples."""
    watch = GateWatch()
    for k in range(300):
        heard = SimpleNamespace(taken=("r", "u", "x", "y"), rejected=("psi",) if k % 5 == 0 else ())
        watch.look(0.4 * k, heard)
        assert watch.rejected < 0.1
    assert watch.many


def test_a_heading_that_passes_north_is_no_jump(scripted):
    source, core = scripted
    source.heading = 0.002
    sail(core, 30)
    source.heading = 2 * math.pi - 0.002
    sail(core, 10)
    assert shown(core)["adaptation"]["health"]["rejected"] == 0
    assert math.cos(shown(core)["own"]["psi"]) > 0.999


def test_a_live_ship_executes_nothing_before_the_navigator_does(scripted):
    source, core = scripted
    source.heading = 0.5
    sail(core, 10)
    told = shown(core)
    assert told["settings"]["executed"] is None and told["simulation"] is None
    assert told["settings"]["trial"]["heading"] == pytest.approx(0.5, abs=0.01)
    with pytest.raises(UsageError, match="not simulated"):
        core.command({"command": "simulation", "paused": True})


def test_other_ships_are_shown_where_they_are_and_forgotten(scripted):
    source, core = scripted
    sail(core, 10)
    source.targets = (Target("07", "ferry", 1000.0, math.pi / 2, 3.0, math.nan, core.t),)
    core.step(core.t + 0.4)
    source.targets = ()
    (ship,) = shown(core)["targets"]
    assert ship["y"] == pytest.approx(1000, abs=20) and ship["speed"] is None and ship["name"] == "ferry"
    sail(core, 70)
    assert shown(core)["targets"] == []


def test_a_source_that_is_not_reached_says_why(scripted):
    source, core = scripted
    source.silent, source.state, source.told = (
        {"psi", "r", "u", "x", "y", "delta"},
        "lost",
        ("refused; it is tried again.",),
    )
    sail(core, 3)
    assert shown(core)["adaptation"]["health"]["message"] == "refused; it is tried again."


def test_it_waits_for_what_the_filter_needs(scripted):
    source, core = scripted
    source.silent = {"delta", "u"}
    sail(core, 3)
    health = shown(core)["adaptation"]["health"]
    assert health["state"] == "starting" and health["message"] == "waiting for the speed and the rudder angle"
    source.silent = set()
    sail(core, 30)
    assert core.own_ship.health == "well"


class Stopping(Scripted):
    """A ship that loses her way, and goes astern."""

    begins, least = 9.0, -3.0

    def take(self, t):
        reading = super().take(t)
        return SourceReading({**reading.values, "u": max(self.begins - 0.15 * t, self.least)})


def test_a_ship_that_lies_still_has_no_way_ahead_yet(make_core):
    source = Stopping()
    source.begins = source.least = 0.0
    core = make_core(source)
    sail(core, 3)
    assert shown(core)["adaptation"]["health"]["message"] == "waiting for the way ahead"


def test_of_a_ship_that_goes_astern_no_old_place_on_the_route_is_shown(make_core):
    """Nothing is predicted of her; her distance off the track and the time to the wheel-over were those of minutes ago."""
    points = [(0.0, 0.0), (900.0, 0.0), (3000.0, 2000.0)]
    route = bridge_route(route_through(points, radius=300.0), None, 300.0)
    core = make_core(Stopping(), route=route, prediction_interval=10.0)
    sail(core, 40)
    told = shown(core)["route"]
    assert told["off_track"] is not None and told["wheel_over"] is not None
    sail(core, 60)
    told = shown(core)
    assert told["own"]["u"] is None and "makes none" in told["adaptation"]["health"]["message"]
    assert told["route"]["off_track"] is None and told["route"]["wheel_over"] is None


@pytest.fixture
def routed(make_core, pilot):
    points = [(0.0, 0.0), (4000.0, 0.0), (7000.0, 3000.0)]
    route = bridge_route(route_through(points, radius=900.0), None, 900.0)
    return make_core(SimulatedSource(pilot, seed=2, current=(0.5, 4.0)), route=route)


def test_the_wheel_over_of_a_ship_that_others_steer_is_warned_of_too(make_core):
    points = [(0.0, 0.0), (4000.0, 0.0), (7000.0, 3000.0)]
    core = make_core(Scripted(), route=bridge_route(route_through(points, radius=900.0), None, 900.0))
    sail(core, 100)
    told = shown(core)
    assert told["settings"]["executed"] is None
    left = told["route"]["wheel_over"]["seconds"]
    assert left > 60
    sail(core, left - 30)
    assert "wheel-over to 045.0° within a minute" in texts(core)


def test_no_wheel_over_is_told_from_the_first_samples(make_core, pilot):
    """With this noise the turn would have begun 10 minutes ago by the sample of 2.4 s, 4 minutes before it is due."""
    points = [(0.0, 0.0), (3000.0, 0.0), (5500.0, -2500.0)]
    route = bridge_route(route_through(points, radius=700.0), None, 700.0)
    core = make_core(SimulatedSource(pilot, seed=0), route=route)
    seen = []
    for _ in range(15):
        sail(core, 0.4)
        seen.append(shown(core)["route"]["wheel_over"])
    assert seen == [None] * 15 and "wheel-over" not in " ".join(texts(core))
    sail(core, 20)
    assert shown(core)["route"]["wheel_over"]["seconds"] > 60


def test_the_wheel_over_is_warned_of_a_minute_before(routed):
    sail(routed, 100)
    told = shown(routed)["route"]
    assert told["leg"] == 0 and abs(told["off_track"]) < 60 and told["wheel_over"]["seconds"] > 60
    assert told["wheel_over"]["course"] == pytest.approx(math.pi / 4, abs=0.15)
    sail(routed, told["wheel_over"]["seconds"] - 75)
    assert "wheel-over" not in " ".join(texts(routed))
    sail(routed, 25)
    (alarm,) = [a for a in shown(routed)["alarms"] if a["text"].startswith("wheel-over to 0")]
    assert alarm["kind"] == "warning" and 0 < shown(routed)["route"]["wheel_over"]["seconds"] < 60


def test_off_the_track_is_an_alarm(routed):
    routed.command({"command": "trial", "heading": math.radians(20)})
    routed.command({"command": "execute"})
    sail(routed, 160)
    off = shown(routed)["route"]["off_track"]
    assert off > 185.2 and any(t.startswith("off track") and t.endswith("starboard") for t in texts(routed))


def test_the_track_pilot_sails_the_route_and_its_end_is_told(routed):
    routed.command({"command": "trial", "mode": "track"})
    routed.command({"command": "execute"})
    off = []
    for _ in range(80):
        sail(routed, 10)
        off.append(routed.watch.off_track)
    assert routed.watch.leg == 1 and routed.console.executed.mode == "track"
    assert np.abs(off).max() < 100 and abs(off[-1]) < 25
    assert "the end of the route is passed" not in texts(routed)
    sail(routed, 200)
    assert "the end of the route is passed" in texts(routed)


def test_a_track_pilot_that_cannot_steer_says_why(routed, monkeypatch):
    def refuse(*_):
        raise UsageError("the current is too strong to keep the leg.")

    routed.command({"command": "trial", "mode": "track"})
    routed.command({"command": "execute"})
    sail(routed, 10)
    assert not any("track pilot" in text for text in texts(routed))
    with monkeypatch.context() as patched:
        patched.setattr(TrackPilot, "steer", refuse)
        sail(routed, 4)
        assert "the track pilot orders nothing: the current is too strong to keep the leg." in texts(routed)


def test_a_model_that_runs_away_is_a_message(make_core, monkeypatch):
    core = make_core()
    sail(core, 5)

    def runs_away(*_, **__):
        raise FloatingPointError("nan")

    monkeypatch.setattr(core.forecaster.predictor, "predict", runs_away)
    core.command({"command": "trial", "heading": 1.0})
    sail(core, 3)
    trial = shown(core)["tracks"]["trial"]
    assert trial["x"] == [] and trial["beyond"] and "nothing can be predicted" in trial["message"]


def test_a_track_that_begins_far_behind_the_ship_is_not_shown(make_core, pilot):
    core = make_core()
    sail(core, 10)
    assert shown(core)["tracks"]["executed"]["x"]
    # The answers stop: two ship lengths take her 48 s.
    until = core.t + 2.2 * pilot.length / 9.5
    while core.t < until:
        core.step(core.t + 0.4)
    track = shown(core)["tracks"]["executed"]
    assert track["x"] == [] and "the predictor is 5" in track["message"] and "late" in track["message"]
    core.take_answer(core.forecaster.answer(core.question()))
    assert shown(core)["tracks"]["executed"]["x"]


def test_without_the_predictor_nothing_of_it_is_shown(make_core):
    core = make_core(predicts=False)
    core.command({"command": "trial", "heading": 1.0})
    sail(core, 10)
    assert shown(core)["tracks"] == {"trial": None, "executed": None}


def test_on_a_straight_course_the_coefficients_stay_as_they_were_found(make_core):
    core = make_core()
    core.command({"command": "trial", "heading": 1.0})
    core.command({"command": "execute"})
    for _ in range(300):
        core.step(core.t + 0.4)
    while abs(core.source.now["r"]) > 1e-4:
        core.step(core.t + 0.4)
    found = {v["name"]: v for v in core.own_ship.adaptation()}
    for _ in range(2500):
        core.step(core.t + 0.4)
    kept = {v["name"]: v for v in core.own_ship.adaptation()}
    for name, truth in (("K", 1.6), ("tau", 1.7)):
        # Nothing tells them there: neither the estimate nor its standard deviation goes on.
        assert kept[name]["value"] == pytest.approx(found[name]["value"], rel=0.01)
        assert kept[name]["sd"] == pytest.approx(found[name]["sd"], rel=0.02)
        assert abs(kept[name]["value"] - truth) < 2.5 * kept[name]["sd"]


def test_a_slow_record_is_not_stale(make_core):
    source = Scripted()
    core = make_core(source)
    every = source.take

    def take(t):
        return every(t) if round(t / 0.4) % 25 == 1 else SourceReading()

    source.take = take
    sail(core, 100)
    assert texts(core) == []


def test_a_schedule_brings_its_ship_and_its_model(tmp_path):
    minimal = shipid.design_autopilot("de-keizer-minimal", "soesterberg")
    short = replace(minimal, ships=(with_values(minimal.ship, {"L": "200 m"}, [minimal.model]),))
    shipid.write_schedule(short, tmp_path / "schedule.toml")
    found = pilot_of(BridgeSettings(schedule=str(tmp_path / "schedule.toml")))
    assert found.model.name == "de-keizer-minimal" and found.length == 200.0
