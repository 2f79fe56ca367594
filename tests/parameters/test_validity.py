"""The range that coefficients come from: written, read, and said where it is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import ParameterSetError
from shipid.parameters.catalogue import find_model, find_ship
from shipid.parameters.correlation import Joint
from shipid.parameters.validity import BEYOND, UNKNOWN, beyond, range_of

DEG = np.pi / 180
MODEL = find_model("nomoto")


def ship(**known) -> shipid.ParameterSet:
    """The container ship with another range of its Nomoto coefficients."""
    own = find_ship("soesterberg")
    return replace(own, joint={"nomoto": Joint((), (), **known)} if known else {})


@pytest.mark.parametrize(
    ("asked", "quantities"),
    [
        ({"speeds": [9.5], "rudder": 15 * DEG}, []),
        ({"speeds": [8.6, 10.4], "rudder": 16.4 * DEG}, []),
        ({"speeds": [8.5]}, ["u"]),
        ({"speeds": [9.5, 10.5], "rudder": 16.6 * DEG}, ["u", "delta"]),
        ({"rate": 1.2 * DEG}, ["r"]),
        # A ship at 11.4 m/s turns 1.2 times as fast at the same rate in ship lengths.
        ({"speeds": [11.4], "rate": 1.2 * DEG}, ["u"]),
        ({"drift": 12 * DEG}, ["beta"]),
        ({}, []),
    ],
)
def test_what_is_beyond_by_a_tenth_is_said(asked, quantities):
    known = ship(speeds=(9.5, 9.5), rudder=15 * DEG, rate=1.0 * DEG, drift=10 * DEG)
    found = beyond(MODEL, known, asked.pop("speeds", []), asked.pop("rudder", None), **asked)
    assert [n.known["quantity"] for n in found] == quantities
    assert all(n.kind == BEYOND and not n.serious and "[nomoto] coefficients of ship soesterberg" in n for n in found)


def test_a_range_that_is_not_stated_is_said_once():
    (found,) = beyond(MODEL, ship(), [5.0], 0.6)
    assert found.kind == UNKNOWN and "ship soesterberg does not state it" in found
    # A model that takes nothing from the ship goes beyond nothing of it.
    assert beyond(find_model("yaw-filter"), ship(), [5.0]) == []


def test_a_table_against_speed_has_its_range():
    section, known = range_of(find_ship("zeefakkel"), MODEL)
    assert (section, known.speeds) == ("nomoto", (2.0, 6.2))


def test_a_joined_model_takes_the_range_of_its_components():
    own = shipid.join("own ship", *find_model("de-keizer").components)
    assert range_of(find_ship("soesterberg"), own)[0] == "de-keizer"


def test_a_fit_records_its_range_and_the_file_keeps_it(tmp_path, sail):
    trial = sail("nomoto", "soesterberg", "zigzag:10/10")
    made = shipid.identify("nomoto", [trial], ship="soesterberg", starts=1).ship
    known = made.joint["nomoto"]
    assert np.rad2deg(known.rudder) == pytest.approx(10.0, abs=0.1)
    assert known.rate == pytest.approx(np.quantile(np.abs(trial["r"]), 0.995), rel=1e-3)
    shipid.write_parameter_set(made, tmp_path / "ship.toml")
    again = shipid.read_parameter_set(tmp_path / "ship.toml")
    assert (again.joint["nomoto"].speeds, again.joint["nomoto"].names) == (known.speeds, known.names)
    for name in ("rudder", "rate", "drift"):
        assert getattr(again.joint["nomoto"], name) == pytest.approx(getattr(known, name), rel=1e-12)
    assert [n.known["quantity"] for n in beyond(MODEL, again, [9.5], 20 * DEG)] == ["delta"]


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        ("rudder = 20", "'rudder' is 20. Write it with its unit, as in '20 deg'"),
        ("rudder = '20'", "20"),
        ("rate = '1 m'", "rad/s"),
        ("drift = '-3 deg'", "has to be zero or greater"),
    ],
)
def test_a_range_that_is_none(tmp_path, entry, says):
    path = tmp_path / "ship.toml"
    path.write_text(f'name = "odd"\n[identified.nomoto]\n{entry}\n', encoding="utf-8")
    with pytest.raises(ParameterSetError) as caught:
        shipid.read_parameter_set(path)
    assert says in str(caught.value)
