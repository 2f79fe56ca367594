"""An autopilot of a ship whose rudder acts late: it is judged with the dead time, and slower by default."""

import numpy as np
import pytest

import shipid
from shipid.autopilot.course_changes.run_course_changes import run_course_changes
from shipid.autopilot.design.closed_loop import linear_ship
from shipid.autopilot.design.read_schedule import read_schedule
from shipid.autopilot.design.write_schedule import write_schedule
from shipid.autopilot.judgement.margins import margins_at
from shipid.parameters.replaced import with_values
from shipid.parts.rudder_delay import LateDirectRudder, LateSteeringMachine

LATE = 3.0


def ship(seconds: float):
    return with_values(shipid.find_ship("zeefakkel"), {"delay": f"{seconds} s"}, [shipid.find_model("norrbin-delay")])


@pytest.fixture(scope="module")
def pilot():
    return shipid.design_autopilot("norrbin-delay", ship(LATE), speeds="5,6 m/s")


def delay_margin(pilot) -> float:
    gains = pilot.schedule.gains_at(5.0, 0)
    return margins_at(linear_ship(pilot, [5.0], steered=True).at(0), gains, 5.0, pilot.pace(5.0)).delay_s


def test_the_delay_margin_is_less_by_the_dead_time(pilot) -> None:
    """The same gains without it: what a loop bears, less what it has, to 1 % of the approximant."""
    prompt = shipid.design_autopilot("norrbin", "zeefakkel", speeds="5,6 m/s", omega_n=pilot.request["omega_n"])
    assert prompt.schedule.gains["Kp"] == pytest.approx(pilot.schedule.gains["Kp"], rel=1e-9)
    assert delay_margin(prompt) - delay_margin(pilot) == pytest.approx(LATE, rel=0.01)


def test_the_frequency_that_is_chosen_leaves_room_for_it(pilot) -> None:
    assert pilot.request["omega_n"] == pytest.approx(0.2 / LATE)
    assert any("dead time: the rudder acts 3 s late" in w for w in pilot.warnings)
    short = shipid.design_autopilot("norrbin-delay", ship(0.1), speeds="5,6 m/s")
    assert not any("dead time" in w for w in short.warnings)
    change = run_course_changes(pilot, [5.0], [np.deg2rad(20.0)])
    assert np.isfinite(change.settling).all()


def test_a_schedule_brings_its_dead_time_along(pilot, tmp_path) -> None:
    assert pilot.actuator is LateSteeringMachine
    write_schedule(pilot, tmp_path / "schedule.toml")
    again = read_schedule(tmp_path / "schedule.toml")
    assert again.actuator is LateSteeringMachine
    assert delay_margin(again) == pytest.approx(delay_margin(pilot), rel=1e-6)
    direct = shipid.design_autopilot("norrbin-delay", ship(LATE), actuator=None, speeds="5,6 m/s")
    assert direct.actuator is LateDirectRudder
    write_schedule(direct, tmp_path / "direct.toml")
    assert read_schedule(tmp_path / "direct.toml").actuator is LateDirectRudder
