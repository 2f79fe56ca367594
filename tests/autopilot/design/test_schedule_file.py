"""Schedules as files: what is written is read, and what a hand made of it is looked at."""

from __future__ import annotations

import json
import re
import tomllib

import pytest

import shipid
from shipid.autopilot.errors import ScheduleError
from shipid.foundation.errors import UnknownNameError


@pytest.fixture(scope="module")
def text(integral, tmp_path_factory):
    path = tmp_path_factory.mktemp("s") / "schedule.toml"
    shipid.write_schedule(integral, path)
    return by_hand(tomllib.loads(path.read_text()))


def by_hand(table, name=""):
    """The same schedule as a person writes it: one line a value."""
    lines, tables = [], []
    for key, value in table.items():
        if isinstance(value, dict) and "value" not in value:
            tables.append((f"{name}{key}", value))
        elif isinstance(value, dict):
            inside = ", ".join(f"{k} = {json.dumps(v)}" for k, v in value.items())
            lines.append(f"{key} = {{ {inside} }}")
        else:
            lines.append(f"{key} = {json.dumps(value)}")
    for inner, value in tables:
        lines += ["", f"[{inner}]", by_hand(value, f"{inner}.")]
    return "\n".join(lines)


def test_round_trip(integral, uncertain_pilot, tmp_path):
    for k, pilot in enumerate((integral, uncertain_pilot)):
        shipid.write_schedule(pilot, tmp_path / f"{k}.toml")
        again = shipid.read_schedule(tmp_path / f"{k}.toml")
        assert again.speeds.tolist() == pytest.approx(pilot.speeds.tolist(), rel=1e-14)
        for name, table in pilot.schedule.gains.items():
            assert again.schedule.gains[name] == pytest.approx(table, rel=1e-14)
        assert again.ships == pilot.ships
        assert again.request == pytest.approx(pilot.request) and again.rudder_limit == pytest.approx(pilot.rudder_limit)
        assert (again.design, again.actuator, again.warnings) == (pilot.design, pilot.actuator, pilot.warnings)


def test_round_trip_of_load_conditions(sized, tmp_path):
    pilot = shipid.design_autopilot(
        "de-keizer", ["soesterberg", sized("soesterberg", "de-keizer", K=2.2)], speeds=[9.5], actuator=None
    )
    shipid.write_schedule(pilot, tmp_path / "s.toml")
    again = shipid.read_schedule(tmp_path / "s.toml")
    assert again.schedule.gains["Kp"] == pytest.approx(pilot.schedule.gains["Kp"], rel=1e-14)
    assert again.ships == pilot.ships and again.actuator is pilot.actuator


def test_units_may_be_changed_by_hand(text, integral, tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(re.sub(r"(?m)^u = \{.*\}$", "u = { value = [25.2, 34.2], unit = 'km/h' }", text))
    assert shipid.read_schedule(path).speeds == pytest.approx([7.0, 9.5])


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (r'kind = ".*"', 'kind = "other"', "is no schedule of an autopilot"),
        (r'design = "pid"', 'design = "guess"', "'design' is 'guess'. Write one of pole, lqr, pid"),
        (r'mode = "course"', 'mode = "track"', "'mode' is 'track'. Write one of course, rate"),
        (r'design = "pid"', 'design = "pid"\ncolour = 3', "there is no entry 'colour'"),
        (r"service_speed = .*", "", "'service_speed' is missing"),
        (r"service_speed = .*", "service_speed = 9.5", "the bare number 9.5, with no unit"),
        (r"service_speed = .*", "service_speed = { value = -1, unit = 'm/s' }", "has to be greater than zero"),
        (r"rudder_limit = .*", "rudder_limit = { value = 80, unit = 'deg' }", "the rudder limit is 80 deg"),
        (r"rudder_limit = .*", "rudder_limit = { value = 15, unit = 'm' }", "'rudder_limit' needs the unit"),
        (r"delta_max = .*", "", "'delta_max' is missing"),
        (r"\nu = .*", "\nu = { value = [9.5, 7.0], unit = 'm/s' }", "to rise"),
        (r"\nu = .*", "\nu = { value = ['a'], unit = 'm/s' }", "no list of numbers"),
        (r"\nu = .*", "\nu = { value = [nan, 7.0], unit = 'm/s' }", "no list of finite numbers"),
        (r"\nKd = .*", "\nKd = [1, 2]", "has to be written { value = [..], unit = 's' }"),
        (r"\nKd = .*", "\nKd = { value = [1.0, 2.0], unit = 'deg' }", "Kd needs the unit s"),
        (r"\nKd = .*", "\nKd = { value = [1.0], unit = 's' }", "Kd has 1 values in 1 rows"),
        (r"\nKd = .*", "", "[schedule]: 'Kd' is missing"),
        (r"\nKi = .*", "\nKj = { value = [1.0, 2.0], unit = '1/s' }", "there is no entry 'Kj'. Did you mean Kp or Ki"),
        (r"\nKp = .*", "\nKp = { value = [-1.0, -1.0], unit = '1' }", "with these gains is unstable"),
        (r"\[request\]", "[request]\nspeed = { value = 1, unit = '1' }", "[request]: there is no entry 'speed'"),
        (r"\n\[limits\][^\[]*", "\nlimits = 3\n", None),
        (r"(\[ship.particulars\]\nL = \{ value = )226.0", r"\g<1>'x'", "the ship in"),
    ],
)
def test_nonsense_is_named(text, tmp_path, old, new, words):
    path = tmp_path / "edited.toml"
    changed, count = re.subn(old, new, text, count=1)
    assert count == 1
    path.write_text(changed)
    with pytest.raises(ScheduleError, match=re.escape(words) if words else "limits"):
        shipid.read_schedule(path)


def test_files_that_are_none(tmp_path, text):
    with pytest.raises(ScheduleError, match=r"missing\.toml cannot be read"):
        shipid.read_schedule(tmp_path / "missing.toml")
    path = tmp_path / "broken.toml"
    path.write_text("kind = ")
    with pytest.raises(ScheduleError, match="is not valid TOML"):
        shipid.read_schedule(path)
    path.write_text(text.replace('model = "de-keizer"', 'model = "unheard"'))
    with pytest.raises(UnknownNameError, match="no model 'unheard'"):
        shipid.read_schedule(path)
    head = text[: text.index("\n[ship]")].replace('design = "pid"', 'design = "pid"\nship = 3')
    path.write_text(head)
    with pytest.raises(ScheduleError, match="'ship' is 3, and has to be a table"):
        shipid.read_schedule(path)
