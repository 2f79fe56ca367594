"""A ship with values replaced, and a model with inputs held."""

from __future__ import annotations

import dataclasses

import pytest

import shipid
from shipid.foundation.errors import UnitError, UnknownNameError, UsageError
from shipid.parameters.correlation import Joint
from shipid.parameters.held_inputs import hold_inputs
from shipid.parameters.parameter_set import Value
from shipid.parameters.replaced import with_values

MODEL = shipid.find_model("norrbin")
SHIP = shipid.find_ship("zeefakkel")


def test_a_particular_goes_before_every_section():
    found = with_values(SHIP, {"L": "60 m", "delta_rate": "5 deg/s", "N_w": "0.02 rad/m^2"}, [MODEL])
    assert found.particular("L", "m") == 60.0 and SHIP.particular("L", "m") == 45.0
    assert found.particular("delta_rate", "deg/s") == pytest.approx(5.0)
    wind = shipid.find_model("de-keizer")
    assert found.find(wind, "N_w").value == 0.02


def test_a_published_coefficient_takes_the_place_of_the_one_it_defines():
    found = with_values(SHIP, {"n3": "0.8 s^2/deg^2"}, [MODEL])
    usual, other = (s.values(MODEL, speed=5.0) for s in (SHIP, found))
    partner = MODEL.partner("n3")
    assert other[partner] == pytest.approx(2 * usual[partner])


def test_what_is_replaced_has_no_standard_deviation():
    held = SHIP.sections["nomoto"]["K"] if "nomoto" in SHIP.sections else None
    nomoto = shipid.find_model("nomoto")
    joint = Joint(("K", "tau"), ((1.0, 0.5), (0.5, 1.0)), (4.0, 6.0))
    ship = dataclasses.replace(SHIP, joint={"nomoto": joint})
    found = with_values(ship, {"K": 0.3}, [nomoto])
    assert found.joint["nomoto"].names == ("tau",) and found.joint["nomoto"].correlation == ((1.0,),)
    assert found.joint["nomoto"].speeds == (4.0, 6.0) and found.find(nomoto, "K").std is None
    assert held is None or held.value != 0.3


def test_names_that_are_none():
    for name, error, words in (
        ("keel", UnknownNameError, "no value of a ship called 'keel'"),
        ("delta", UsageError, "an input; state it with --input"),
        ("r", UsageError, "'r' is a state"),
    ):
        with pytest.raises(error, match=words):
            with_values(SHIP, {name: 1.0}, [MODEL])


def test_a_held_input_is_an_input_no_more():
    """A current of a knot for 200 s carries the ship by 103 m; the model keeps its name and its ships."""
    model = shipid.find_model("de-keizer")
    held = hold_inputs(model, {"current_north": "1 kn"})
    assert held.name == model.name and "current_north" not in held.inputs and hold_inputs(model, {}) is model
    assert hold_inputs(model, {"current_north": "1 kn"}) == held
    still, carried = (shipid.simulate(m, "soesterberg", "turn:20", duration="200 s") for m in (model, held))
    assert carried["x"][-1] - still["x"][-1] == pytest.approx(200 * 1852 / 3600, rel=1e-6)
    with pytest.raises(UsageError, match="reads no input 'depth'"):
        hold_inputs(model, {"depth": "20 m"})
    with pytest.raises(UsageError, match="'delta' is what the command orders"):
        hold_inputs(model, {"delta": "20 deg"})


def test_a_shaft_speed_is_no_angle_wherever_it_is_given():
    """A model declares it in 1/s, and 12.57 rad/s are 2 of them, not 12.57."""
    model = shipid.find_model("mmg-revolutions")
    assert hold_inputs(model, {"n": "120 rpm"}) == hold_inputs(model, {"n": "2 1/s"})
    for refused in (
        lambda: hold_inputs(model, {"n": "12.57 rad/s"}),
        lambda: Value("n", 12.57, "rad/s", "assumed").at(None, "1/s", "ship"),
        lambda: with_values(SHIP, {"n": "12.57 rad/s"}, [hold_inputs(model, {"n": 2.0})]),
    ):
        with pytest.raises((UnitError, UsageError), match=r"counts revolutions|no value of a ship"):
            refused()
