"""The range that coefficients come from: written, read, and said where it is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import ParameterSetError
from shipid.identification.uncertainty.amplitudes import largest_amplitudes, recorded_speeds
from shipid.parameters.catalogue import find_model, find_ship
from shipid.parameters.correlation import Joint
from shipid.parameters.replaced import with_values
from shipid.parameters.ship_coefficients import coefficients_at
from shipid.parameters.validity import BEYOND, OTHERWISE, UNKNOWN, WRONG_SIGN, beyond, beyond_in_run, range_of
from shipid.trials.manoeuvres.simulate import NotSailedError

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
        ({"rudder": 20 * DEG, "rate": 1.2 * DEG, "drift": 12 * DEG}, ["delta", "beta"]),
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


def test_rudder_and_rate_are_one_sentence():
    """The ship turns faster because the rudder goes farther: one notice holds both, and each with its range."""
    (found,) = beyond(MODEL, ship(speeds=(9.5, 9.5), rudder=15 * DEG, rate=1.0 * DEG), [9.5], 20 * DEG, rate=1.2 * DEG)
    assert found.startswith("The rudder goes to 20 deg and the ship turns at 1.2 deg/s: the [nomoto] coefficients")
    assert "were found at rudder angles up to 15 deg and rates of turn up to 1 deg/s. Beyond" in found
    assert found.known == {"quantity": "delta", "also": ["r"]}


def test_a_range_that_is_not_stated_is_said_once():
    (found,) = beyond(MODEL, ship(), [5.0], 0.6)
    assert found.kind == UNKNOWN and "ship soesterberg does not state it" in found
    # A model that takes nothing from the ship goes beyond nothing of it.
    assert beyond(find_model("yaw-filter"), ship(), [5.0]) == []


def test_a_table_against_speed_has_its_range():
    section, known = range_of(find_ship("zeefakkel"), MODEL)
    assert (section, known.speeds) == ("nomoto", (2.0, 6.2))


@pytest.mark.parametrize("added", ["-draught", "-delay", "-delay-displacement"])
def test_a_part_that_identify_added_unasked_is_named_where_it_is_left_out(added):
    """identify --model nomoto wrote [nomoto-draught], and predict nomoto read the published coefficients without a word."""
    fitted = Joint(("K",), ((1.0,),))
    own = replace(find_ship("soesterberg"), joint={"nomoto" + added: fitted})
    said = f"identified with [nomoto{added}], and model nomoto reads other coefficients of hers: name the model nomoto{added}."
    (told,) = [n for n in beyond(MODEL, own) if n.kind == OTHERWISE]
    assert told.serious and said in told
    for other in (
        {"nomoto": fitted, "nomoto" + added: fitted},
        {"nomoto-second-order": fitted},
        {"nomoto" + added: Joint((), ())},
    ):
        assert OTHERWISE not in {n.kind for n in beyond(MODEL, replace(own, joint=other))}


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


def test_the_speeds_are_those_that_the_trials_went_through(sail):
    """From the approach to the slowest: a ship that lost speed in her trials has been tried at what she slowed down to."""
    trial = sail("de-keizer", "soesterberg", "turn:35", speed="9.5 m/s")
    low, high = recorded_speeds([trial])
    assert low == pytest.approx(np.quantile(trial["u"], 0.02), rel=0.05) and low < 0.85 * 9.5
    assert high == pytest.approx(9.5, rel=0.02)
    made = shipid.identify("nomoto", [trial], ship="soesterberg", starts=1)
    assert made.ship.joint["nomoto"].speeds == (low, high)
    assert beyond(MODEL, made.ship, [low, 0.5 * (low + high), high]) == []
    # The coefficients of a model that keeps its speed belong to the speed before the manoeuvre: there they are not scaled.
    belongs_to = made.ship.joint["nomoto"].speed
    assert belongs_to == pytest.approx(9.5, rel=0.01)
    at = coefficients_at(MODEL, made.ship, belongs_to)
    assert not at.scaled and at.values["K"] == made.parameters["K"].value
    assert coefficients_at(MODEL, made.ship, low).values["K"] == pytest.approx(
        made.parameters["K"].value * low / belongs_to, rel=1e-9
    )
    assert f"K, tau belong to {belongs_to:.2f} m/s before the manoeuvre" in made.text()


def test_a_set_that_states_only_a_range_belongs_to_its_middle():
    known = ship(speeds=(4.0, 6.0)).joint["nomoto"]
    assert known.belongs_to == 5.0 and replace(known, speed=5.8).belongs_to == 5.8 and Joint((), ()).belongs_to is None


def test_a_fit_says_what_its_trials_reach(sail):
    trial = sail("nomoto", "soesterberg", "zigzag:10/10")
    # Without its rate of turn, and with the order for the rudder angle: both are what the trial shows of them.
    bare = shipid.Trial.from_frame(
        trial.table[["t", "psi", "delta"]].rename(columns={"delta": "delta_order"}),
        name="bare",
        units={"t": "s", "psi": "rad", "delta_order": "rad"},
    )
    whole, poor = largest_amplitudes([trial]), largest_amplitudes([bare])
    assert poor["rudder"] == pytest.approx(whole["rudder"], rel=1e-3)
    # Both hold the noise of their sensor; a tenth beyond the range is passed over.
    assert poor["rate"] == pytest.approx(whole["rate"], rel=0.05)
    assert "drift" not in poor
    fit = shipid.identify("nomoto", [trial], ship="soesterberg", starts=1)
    seen = fit.to_dict()["seen"]
    assert seen["rudder"]["value"] == fit.ship.joint["nomoto"].rudder
    assert seen["drift"]["value"] == fit.ship.joint["nomoto"].drift
    assert "rudder angles up to 10 deg, rates of turn up to" in repr(fit)


def test_a_run_is_held_against_all_that_is_stated():
    """The largest of each column that is finite; an empty or lost one says nothing."""
    known = ship(speeds=(9.5, 9.5), rudder=15 * DEG, rate=1.0 * DEG, drift=10 * DEG)
    run = {"delta": np.array([0.1, np.nan]), "r": np.array([0.0, -1.2 * DEG]), "u": np.array([9.0, 9.0])}
    assert [n.known["quantity"] for n in beyond_in_run(MODEL, known, 9.5, run)] == ["r"]
    run |= {"v": np.array([0.0, -2.0]), "r": np.full(2, np.nan)}
    assert [n.known["quantity"] for n in beyond_in_run(MODEL, known, 9.5, run)] == ["beta"]
    assert beyond_in_run(MODEL, ship(), 9.5, run, known=True) == []
    assert [n.kind for n in beyond_in_run(MODEL, ship(), 9.5, run)] == [UNKNOWN]


def test_a_run_that_is_lost_says_that_it_is_beyond():
    own = find_ship("kvlcc2")
    joint = {**own.joint, "bech": replace(own.joint["bech"], rudder=10 * DEG)}
    with pytest.raises(NotSailedError, match="rudder angles up to 10 deg"):
        shipid.simulate("bech", replace(own, joint=joint), "turn:30", values={"c3": "-9 1/rad^2"})


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


@pytest.mark.parametrize(
    ("stated", "says"), [({"K": "-1.6"}, "K is -1.6 in ship"), ({"tau": "-1.7"}, "tau is -1.7 in ship")]
)
def test_a_coefficient_of_the_wrong_sign_is_told(stated, says):
    model = find_model("de-keizer")
    own = with_values(find_ship("soesterberg"), stated, (model,))
    found = [n for n in beyond(model, own, [9.5]) if n.kind == WRONG_SIGN]
    assert len(found) == 1 and found[0].serious and found[0].startswith(says)
    assert not [n for n in beyond(model, find_ship("soesterberg"), [9.5]) if n.kind == WRONG_SIGN]
