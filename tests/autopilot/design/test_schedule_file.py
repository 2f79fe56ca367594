"""Schedules as files: what is written is read, and what a hand made of it is looked at."""

from __future__ import annotations

import json
import random
import re
import tomllib

import pytest
import tomli_w

import shipid
from shipid.autopilot.design.write_schedule import schedule_table
from shipid.autopilot.errors import ModelFileError, ScheduleError
from shipid.foundation.errors import UnknownNameError
from shipid.parameters.parameter_set import Value


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


OWN = '''
import pathlib

from shipid import Component, given, parameter, state

pathlib.Path(__file__).with_suffix(".ran").touch()


class Own(Component):
    """A yaw model of the user's own."""

    r = state("rad/s", "rate of turn, positive to starboard")
    delta = given("rad", "rudder angle, positive turns to starboard")
    K = parameter("1/s", "gain", start=0.2, low=0.01, high=5.0)
    tau = parameter("s", "time constant", start=15.0, low=0.5, high=500.0)

    @r.rate
    def yaw(self):
        """Own notes, page 1."""
        return (self.K * self.delta - self.r) / self.tau
'''


@pytest.fixture(scope="module")
def own_schedule(tmp_path_factory):
    """A schedule tuned with a model file, and the words the file was named by; the mark it leaves where it runs."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "own.py").write_text(OWN)
    words = f"{folder / 'own.py'}:Own"
    ship = shipid.ParameterSet("s", sections={
        "particulars": {"L": Value("L", 160.0, "m", "assumed"), "speed": Value("speed", 8.0, "m/s", "assumed"),
                        "delta_max": Value("delta_max", 35.0, "deg", "assumed"),
                        "delta_rate": Value("delta_rate", 3.0, "deg/s", "assumed")},
        "own": {"K": Value("K", 0.1, "1/s", "assumed"), "tau": Value("tau", 40.0, "s", "assumed")},
    })  # fmt: skip
    pilot = shipid.design_autopilot(words, ship, speeds=[8.0])
    shipid.write_schedule(pilot, folder / "named.toml", words)
    shipid.write_schedule(pilot, folder / "called.toml")
    (folder / "own.ran").unlink()
    return folder, words


def test_a_schedule_runs_no_model_file(own_schedule):
    folder, words = own_schedule
    with pytest.raises(
        ModelFileError, match=r"a model file, which is code, and a schedule runs none. If you trust"
    ) as no:
        shipid.read_schedule(folder / "named.toml")
    assert f"read_schedule(path, '{words}')" in str(no.value)
    with pytest.raises(UnknownNameError, match="no model 'own'"):
        shipid.read_schedule(folder / "called.toml")
    for name in (f"{words}:Own", "own.py", "../own.py:Own", f"file:{words}", f"{words} ", f" {words}"):
        text = (folder / "named.toml").read_text().replace(words, name)
        (folder / "edited.toml").write_text(text)
        with pytest.raises(ModelFileError):
            shipid.read_schedule(folder / "edited.toml")
    assert not (folder / "own.ran").exists(), "nothing ran"


def test_the_user_gives_the_model_file(own_schedule):
    folder, words = own_schedule
    for name in ("named", "called"):
        assert shipid.read_schedule(folder / f"{name}.toml", words).model.name == "own"
        assert shipid.read_schedule(folder / f"{name}.toml", shipid.find_model(words)).model.name == "own"
        with pytest.raises(
            ScheduleError, match=r"the schedule belongs to model '.*own.*', and 'nomoto' is given for it"
        ):
            shipid.read_schedule(folder / f"{name}.toml", "nomoto")


def test_an_actuator_turns_an_order_into_an_angle(text, tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(re.sub(r'(?m)^actuator = ".*"$', 'actuator = "PlanarMotion"', text))
    with pytest.raises(ScheduleError, match="'actuator' is PlanarMotion, which turns no order into a rudder angle"):
        shipid.read_schedule(path)


def test_three_hundred_edited_schedules(integral, tmp_path):
    """Each is refused with one clear error, or is sound."""
    chance, path, refused = random.Random(3), tmp_path / "s.toml", 0
    odd = (
        True,
        0,
        -1,
        10**400,
        1e308,
        float("nan"),
        float("inf"),
        "",
        "nan",
        "1 m",
        [],
        {},
        [[1]],
        [1, "a"],
        "x" * 300,
    )
    for _ in range(300):
        table = schedule_table(integral)
        for _ in range(chance.choice((1, 1, 2))):
            place, key = table, chance.choice(list(table))
            while isinstance(place[key], (dict, list)) and place[key] and chance.random() < 0.8:
                place = place[key]
                key = chance.choice(list(place)) if isinstance(place, dict) else chance.randrange(len(place))
            if chance.random() < 0.2:
                del place[key]
            else:
                place[key] = chance.choice(odd)
        path.write_text(tomli_w.dumps(table))
        try:
            shipid.read_schedule(path)
        except shipid.ShipidError as error:
            refused += 1
            assert str(error)
    assert refused > 150
