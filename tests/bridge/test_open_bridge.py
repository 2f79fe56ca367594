"""A bridge that is put together: where x and y are 0 for its route, its source and its recording."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import shipid
from shipid.bridge.bridge_settings import BridgeSettings
from shipid.bridge.open_bridge import open_bridge
from shipid.foundation.errors import UsageError
from shipid.trials.logs.nmea.writing import write_nmea

from .conftest import sail, shown

#: A voyage to the north along 8 degrees east, and a route on the same meridian that begins 0.1 degrees to the south of it.
ROUTE = "lat [deg],lon [deg]\n53.9,8.0\n54.3,8.0\n"
APART = 11131.0


@pytest.fixture
def files(tmp_path):
    t = np.arange(0, 60.0)
    place = np.stack([t, 54.0 + 9.0 * t / 111310, 8.0 + 0 * t], axis=1)
    rows = "".join(f"{a:.0f},{b:.8f},{c:.8f},0,0,9,0\n" for a, b, c in place)
    head = "psi [deg],r [deg/s],u [m/s],delta [deg]\n"
    (tmp_path / "log.csv").write_text(f"t [s],lat [deg],lon [deg],{head}{rows}")
    (tmp_path / "route.csv").write_text(ROUTE)
    trial = shipid.read_trial(tmp_path / "log.csv")
    write_nmea(trial, tmp_path / "log.nmea")
    rows = "".join(f"{a:.0f},{9 * a:.1f},0,0,0,9,0\n" for a in t)
    (tmp_path / "nowhere.csv").write_text(f"t [s],x [m],y [m],{head}{rows}")
    return tmp_path


@pytest.mark.parametrize("log", ["log.csv", "log.nmea"])
def test_a_replay_and_its_route_lie_in_one_plane(files, log):
    """Each counted from its own first position: the ship was shown at the first waypoint, 11 km from where she was."""
    settings = BridgeSettings(
        source=f"replay:{files / log}",
        route=str(files / "route.csv"),
        record=files / "kept.csv",
        prediction_interval=60.0,
    )
    with open_bridge(settings, "127.0.0.1", 0) as opened:
        sail(opened.core, 30)
        told = shown(opened.core)
    start, end = (told["route"]["waypoints"][k]["x"] for k in (0, 1))
    assert start == pytest.approx(-APART, rel=0.01) and end == pytest.approx(3 * APART, rel=0.01)
    assert told["own"]["x"] == pytest.approx(270, abs=20) and abs(told["route"]["off_track"]) < 20
    assert not [a for a in told["alarms"] if "off track" in a["text"]]
    assert np.rad2deg(shipid.read_trial(files / "kept.csv").source.origin) == pytest.approx(
        [54.0, 8.0], abs=1e-5
    )  # the first fix of a log comes a moment later


def test_a_log_in_metres_does_not_lie_on_a_route_on_the_earth(files):
    settings = BridgeSettings(source=f"replay:{files / 'nowhere.csv'}", route=str(files / "route.csv"))
    with pytest.raises(UsageError, match="where on the earth"), open_bridge(settings, "127.0.0.1", 0):
        pass


@pytest.mark.parametrize("lacking", ["x", "y", "xy"])
def test_a_ship_without_a_fix_is_nowhere_on_her_route(tmp_path, lacking):
    """She was reckoned from (0, 0), the first waypoint, and warned of wheel-overs there."""
    (tmp_path / "route.csv").write_text("x [m],y [m]\n0,0\n900,0\n2000,900\n")
    names = [n for n in ("x", "y") if n not in lacking]
    head = "".join(f"{n} [m]," for n in names)
    rows = "".join(f"{t},{'300,' * len(names)}0,0,9,0\n" for t in range(60))
    (tmp_path / "log.csv").write_text(f"t [s],{head}psi [deg],r [deg/s],u [m/s],delta [deg]\n{rows}")
    settings = BridgeSettings(
        source=f"replay:{tmp_path / 'log.csv'}", route=str(tmp_path / "route.csv"), prediction_interval=20.0
    )
    with open_bridge(settings, "127.0.0.1", 0) as opened:
        sail(opened.core, 50)
        told = shown(opened.core)
    assert told["route"]["off_track"] is None and told["route"]["wheel_over"] is None
    assert [a["text"] for a in told["alarms"]] == ["sensor lost: position"] and "y" in told["own"]["estimated"]


@pytest.mark.parametrize(("factor", "cycles"), [(1, 0), (1000, 1)])
def test_a_schedule_whose_loop_cycles_is_told_before_the_page_opens_and_on_it(pilot, tmp_path, factor, cycles):
    gains = {name: factor * values for name, values in pilot.schedule.gains.items()}
    made = dataclasses.replace(pilot, schedule=dataclasses.replace(pilot.schedule, gains=gains))
    shipid.write_schedule(made, tmp_path / "schedule.toml")
    with open_bridge(BridgeSettings(schedule=str(tmp_path / "schedule.toml")), "127.0.0.1", 0) as opened:
        told = shown(opened.core)
        notes = [n for n in opened.notes if "the loop cycles" in n]
    alarms = [a for a in told["alarms"] if "the loop cycles" in a["text"]]
    assert len(notes) == len(alarms) == cycles and told["notes"] == notes
    assert all(a["kind"] == "warning" for a in alarms)
