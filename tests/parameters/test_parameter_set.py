"""Parameter sets: read, refused, resolved, and written back."""

import string
from pathlib import Path

import pytest
from hypothesis import given as given_values
from hypothesis import settings
from hypothesis import strategies as st

from shipid import (
    Component,
    ParameterSet,
    derived,
    find_model,
    find_ship,
    join,
    parameter,
    read_parameter_set,
    write_parameter_set,
)
from shipid.foundation.errors import DeclarationError, ParameterSetError, UnitError, UnknownNameError
from shipid.parameters.parameter_set import Value, missing_values, parse_value, resolve
from shipid.parameters.replaced import with_values
from shipid.parts.steering_machine import SteeringMachine
from shipid.parts.wind import Wind

SHIP = """
name = "boat"
title = "A boat"
notes = "Made up."

[particulars]
L = { value = 45.0, unit = "m", source = "assumed" }
speed = { value = 10.0, unit = "kn", source = "assumed" }

[norrbin]
K = { value = [0.2, 0.4], unit = "1/s", speed = [4.0, 8.0], speed_unit = "kn", source = "Table 1" }
tau = { value = 33.0, unit = "s", source = "Table 1", std = 1.5, note = "by eye" }
n3 = { value = 0.4, unit = "s^2/deg^2", source = "Table 1" }

[van-leeuwen-sway]
gamma = { value = 0.4, unit = "1", source = "assumed" }
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "boat.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_set_is_read_with_everything_it_says(tmp_path: Path) -> None:
    ship = read_parameter_set(written(tmp_path, SHIP))
    assert (ship.name, ship.title, ship.notes) == ("boat", "A boat", "Made up.")
    assert ship.models == ("norrbin", "van-leeuwen-sway")
    tau = ship.sections["norrbin"]["tau"]
    assert (tau.value, tau.unit, tau.source, tau.std, tau.note) == (33.0, "s", "Table 1", 1.5, "by eye")
    assert ship.particular("speed", "m/s") == pytest.approx(10 * 1852 / 3600)
    assert ship.particular("B", "m") is None
    assert "norrbin: K, tau, n3" in ship.text()


def test_a_set_without_a_name_takes_the_file_s(tmp_path: Path) -> None:
    assert read_parameter_set(written(tmp_path, "[particulars]\n")).name == "boat"


def test_values_of_a_model_are_si_and_worked_out(tmp_path: Path) -> None:
    ship = read_parameter_set(written(tmp_path, SHIP))
    values = ship.values(find_model("norrbin"), speed=6 * 1852 / 3600)
    assert values["b1"] == pytest.approx(1 / 33)
    assert values["a"] == pytest.approx(0.3 / 33)
    assert values["b3"] == pytest.approx(0.4 * 3282.8064 / 33)


def test_a_component_s_table_serves_every_model_that_has_the_component(tmp_path: Path) -> None:
    ship = read_parameter_set(written(tmp_path, SHIP))
    for model in ("de-keizer", "van-leeuwen"):
        assert ship.values(find_model(model)) == {"gamma": 0.4, "L": 45.0}


def test_a_model_s_own_table_goes_before_a_component_s_and_that_before_the_particulars(tmp_path: Path) -> None:
    components = find_model("van-leeuwen").components
    general = SHIP.replace("[norrbin]", 'gamma = { value = 0.9, unit = "1", source = "assumed" }\n\n[norrbin]')
    own = '\n[my-sway]\ngamma = { value = 0.6, unit = "1", source = "assumed" }\n'
    ship = read_parameter_set(written(tmp_path, general + own))
    assert ship.values(join("my-sway", *components))["gamma"] == 0.6
    assert ship.values(join("another", *components))["gamma"] == 0.4


class Inverse(Component):
    """A gain and its inverse, either of which may be stated, and a third that is worked out of the second."""

    gain = parameter("s", "a gain")
    inverse = parameter("1/s", "its inverse")
    square = parameter("1/s^2", "the square of the inverse")
    shown = derived("1", "their product")

    @gain.instead
    def from_inverse(self):
        """By definition."""
        return 1 / self.inverse

    @inverse.instead
    def from_gain(self):
        """By definition."""
        return 1 / self.gain

    @square.instead
    def from_the_inverse(self):
        """By definition."""
        return self.inverse**2

    @shown.equals
    def product(self):
        """By definition."""
        return self.gain * self.inverse


def test_what_follows_from_each_other_needs_one_of_them() -> None:
    model = join("inverse", Inverse)
    assert resolve(model, {"gain": 4.0}) == {"gain": 4.0, "inverse": 0.25, "square": 0.0625}
    assert resolve(model, {"inverse": 0.25}) == {"gain": 4.0, "inverse": 0.25, "square": 0.0625}
    assert resolve(model, {}) == {}


def test_a_table_asks_for_a_speed_inside_it(tmp_path: Path) -> None:
    ship, model = read_parameter_set(written(tmp_path, SHIP)), find_model("norrbin")
    with pytest.raises(ParameterSetError, match=r"'K' in ship boat depends on the speed: say at which"):
        ship.values(model)
    with pytest.raises(
        ParameterSetError, match=r"known from 2\.05\d+ to 4\.11\d+ m/s, and 5 m/s is outside. Ask for a speed inside"
    ):
        ship.values(model, speed=5.0)


def test_a_unit_that_does_not_fit_names_ship_and_quantity(tmp_path: Path) -> None:
    ship = read_parameter_set(written(tmp_path, SHIP.replace('unit = "s^2/deg^2"', 'unit = "s^2"')))
    with pytest.raises(UnitError, match=r"'n3' in ship boat needs the unit s²/rad², and s² does not say which angle"):
        ship.values(find_model("norrbin"), speed=3.0)


def test_what_is_missing_is_listed_with_its_unit(tmp_path: Path) -> None:
    ship, model = read_parameter_set(written(tmp_path, SHIP)), find_model("nomoto")
    error = missing_values(model, ship.values(model), "boat")
    assert isinstance(error, ParameterSetError)
    assert "model nomoto needs K [1/s], tau [s], which boat does not hold" in str(error)
    assert "or write them into the ship's file, in [nomoto]." in str(error)
    assert missing_values(model, {"K": 1.0, "tau": 2.0}, "boat") is None


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("K = 0.2", r"\[nomoto\] K is the bare number 0\.2 with no unit and no source; write \{ value = 0\.2"),
        ('K = "0.2 1/s"', r"\[nomoto\] K is text; write"),
        ('K = { value = 0.2, source = "x" }', r"\[nomoto\] K has no unit"),
        ('K = { value = 0.2, unit = "1/s" }', r"\[nomoto\] K has no source"),
        ('K = { unit = "1/s", source = "x" }', r"\[nomoto\] K has no value"),
        ('K = { value = 0.2, unit = "1/s", source = "  " }', r"K has an empty source.*'assumed' is a source"),
        ('K = { value = 0.2, unit = "1/s", sourc = "x" }', r"an entry 'sourc' it does not know. Did you mean source"),
        ('K = { value = inf, unit = "1/s", source = "x" }', r"K is inf, which is not a finite number"),
        ('K = { value = nan, unit = "1/s", source = "x" }', r"K is nan, which is not a finite number"),
        ('K = { value = true, unit = "1/s", source = "x" }', r"K is True, which is not a finite number"),
        ('K = { value = "12", unit = "1/s", source = "x" }', r"K is '12', which is not a finite number"),
        ('K = { value = [1.0, 2.0], unit = "1/s", source = "x" }', r"needs one speed for each of its 2 values"),
        ('K = { value = [1.0, 2.0], unit = "1/s", speed = [2, 1], source = "x" }', r"2 values, rising"),
        ("K = {", r"is not valid TOML"),
    ],
)
def test_a_number_that_is_not_well_told_is_refused(tmp_path: Path, line: str, words: str) -> None:
    with pytest.raises(ParameterSetError, match=words) as error:
        read_parameter_set(written(tmp_path, f"[nomoto]\n{line}\n"))
    assert "boat.toml" in str(error.value)


def test_a_number_outside_a_table_and_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ParameterSetError, match=r"'titel' stands outside a table\. Did you mean title\?"):
        read_parameter_set(written(tmp_path, 'titel = "x"\n'))
    with pytest.raises(ParameterSetError, match=r"cannot be read: No such file"):
        read_parameter_set(tmp_path / "nothing.toml")


def test_a_set_cannot_be_changed(tmp_path: Path) -> None:
    ship = read_parameter_set(written(tmp_path, SHIP))
    with pytest.raises(TypeError):
        ship.sections["nomoto"] = {}
    with pytest.raises(AttributeError):
        ship.name = "other"


TEXT = st.text(st.characters(blacklist_categories=("Cs", "Cc")), max_size=30)
FINITE = st.floats(allow_nan=False, allow_infinity=False)
NAME = st.text(string.ascii_letters, min_size=1, max_size=8)
SECTION = st.text(string.ascii_lowercase + "-", min_size=1, max_size=12).filter(lambda s: s not in ("name", "notes"))


@st.composite
def quantities(draw: st.DrawFn) -> Value:
    speeds = sorted(draw(st.sets(st.floats(0, 50), max_size=4)))
    value = tuple(draw(FINITE) for _ in speeds) if speeds else draw(FINITE)
    return Value(
        draw(NAME),
        value,
        draw(st.sampled_from(["1", "1/s", "s^2/deg^2", "kn", "m"])),
        draw(TEXT.filter(str.strip)),
        std=draw(st.none() | st.floats(0, 1e6)),
        speed=tuple(speeds),
        speed_unit=draw(st.sampled_from(["m/s", "kn"])) if speeds else "m/s",
        note=draw(TEXT),
    )


@given_values(
    name=TEXT,
    title=TEXT,
    notes=TEXT,
    values=st.lists(st.tuples(SECTION, st.lists(quantities(), max_size=3)), max_size=3),
)
@settings(max_examples=60, deadline=None)
def test_what_is_written_reads_the_same(
    tmp_path_factory: pytest.TempPathFactory, name: str, title: str, notes: str, values: list
) -> None:
    sections = {section: {v.name: v for v in inside} for section, inside in values}
    sections.pop("title", None), sections.pop("schema", None)
    ship = ParameterSet(name, title, notes, sections)
    path = tmp_path_factory.mktemp("ships") / "boat.toml"
    write_parameter_set(ship, path)
    again = read_parameter_set(path)
    assert (again.name, again.title, again.notes) == (name, title, notes)
    assert {s: dict(v) for s, v in again.sections.items()} == sections
    assert [p.name for p in path.parent.iterdir()] == ["boat.toml"]  # no temporary file is left


def test_a_value_given_on_the_command_line() -> None:
    model = find_model("norrbin")
    assert parse_value(model, "n3 = 0.4 s^2/deg^2") == ("n3", pytest.approx(1313.12, rel=1e-5))
    with pytest.raises(UnitError, match=r"'n3' \(cubic coefficient of the reversed spiral\) is the bare number 0\.4"):
        parse_value(model, "n3=0.4")
    with pytest.raises(UnitError, match=r"does not say which angle"):
        parse_value(model, "n3=0.4 s^2")
    with pytest.raises(UnitError, match=r"'n3' does not say NAME=VALUE UNIT"):
        parse_value(model, "n3")
    with pytest.raises(UnknownNameError, match=r"called 'n4'"):
        parse_value(model, "n4=1 s")
    with pytest.raises(DeclarationError, match=r"'r' is a state of model norrbin, and cannot be given a value"):
        parse_value(model, "r=1 deg/s")


def test_a_message_about_lacking_values_shows_how_they_are_stated():
    """Values scaled by the length alone are shown where a search begins; of others no number is made up."""
    windy = join("in wind", find_model("nomoto"), Wind)
    said = str(missing_values(windy, {"L": 100.0, "K": 0.1, "tau": 10.0}, "ship x"))
    assert "--set 'F_w=1e-06 1/m²' --set 'N_w=1e-06 rad/m²' (where a search begins" in said
    assert "--set 'K=VALUE 1/s'" in str(
        missing_values(windy, {"L": 100.0, "tau": 10.0, "N_w": 0.0, "F_w": 0.0}, "ship x")
    )


@pytest.mark.parametrize("length", ["1e-9 m", "1e9 m", "-20 m", "0 m"])
def test_a_length_of_no_ship_is_refused(length: str) -> None:
    own = with_values(find_ship("soesterberg"), {"L": length}, (), "stated by --set")
    words = "must lie between 0.1 m, a small model, and 2000 m"
    with pytest.raises(ParameterSetError, match=words):
        own.particular("L", "m")
    with pytest.raises(ParameterSetError, match=words):
        own.values(find_model("nomoto"), speed=9.5)


@pytest.mark.parametrize(
    ("stated", "words"),
    [
        ({"delta_max": "0 deg"}, "largest rudder angle delta_max of ship soesterberg is 0 deg"),
        ({"delta_max": "-35 deg"}, "is -35 deg: give one above zero, to 90 deg"),
        ({"delta_max": "35 rad"}, "is 2005 deg"),
        ({"delta_rate": "0 deg/s"}, "largest rudder rate delta_rate of ship soesterberg is 0 deg/s"),
    ],
)
def test_a_steering_gear_that_moves_no_rudder_or_turns_it_round_is_refused(stated, words) -> None:
    own = with_values(find_ship("soesterberg"), stated, (), "stated by --set")
    name = next(iter(stated))
    with pytest.raises(ParameterSetError, match=words):
        own.particular(name, "rad" if name == "delta_max" else "rad/s")
    with pytest.raises(ParameterSetError, match=words):
        own.values(join("steered", find_model("nomoto"), SteeringMachine), speed=9.5)
