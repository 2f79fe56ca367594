"""The timetable of a plan: each order of the helmsman, its condition, and the room that the tracks take."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.parameters.replaced import with_values
from shipid.planning.leg import Leg
from shipid.planning.timetable import Surroundings, sailed_timetable, timetable_of

MODEL, SHIP = shipid.find_model("norrbin"), shipid.find_ship("zeefakkel")


def test_a_zigzag_is_ordered_as_it_is_sailed():
    """The executes of the trial that the same manoeuvre gives, each with the heading it waits for."""
    found = timetable_of(MODEL, SHIP, [Leg("zigzag:-20/10", 5.0, 200.0, 0.0), Leg("turn:25/180", 5.0, 150.0, 300.0)])
    trial = shipid.simulate(MODEL, SHIP, "zigzag:-20/10", speed=5.0, duration=200.0)
    steps = trial["t"][1:][np.diff(trial["delta_order"]) != 0]
    first = [o for o in found.orders if o.leg == 1 and o.rudder is not None]
    assert [o.time for o in first] == pytest.approx(steps.tolist())
    assert [np.rad2deg(o.rudder) for o in first[:2]] == pytest.approx([-20, 20])
    assert (first[0].action, first[0].when) == ("rudder 20 deg to port", "")
    assert first[1].when == "when the heading has changed by 10 deg to port"
    assert first[2].when == "when the heading has changed by 10 deg to starboard"
    second = [o for o in found.orders if o.leg == 2]
    assert second[0].time == 300.0 and "steady on a straight course at 5 m/s" in second[0].action
    assert second[2].action == "rudder amidships" and second[2].when == "when the ship has turned by 180 deg"
    times = [o.time for o in found.orders]
    assert times == sorted(times) and times[-1] == 450.0


def test_orders_by_the_clock_and_by_a_helmsman():
    found = timetable_of(
        MODEL,
        SHIP,
        [Leg("telegraph:10", 5.0, 200.0, 0.0, seed=3), Leg("course:60/15", 4.0, 200.0, 260.0)],
    )
    trial = shipid.simulate(MODEL, SHIP, "telegraph:10", speed=5.0, duration=200.0, seed=3)
    held = [o for o in found.orders if o.leg == 1 and o.rudder is not None]
    assert len(held) == np.count_nonzero(np.diff(trial["delta_order"])) and {o.when for o in held} == {""}
    actions = [o.action for o in found.orders if o.leg == 2]
    assert actions[0].startswith("new speed, steady") and len(actions) == 3
    assert actions[1] == "change course by 60 deg to starboard with at most 15 deg of rudder, and steer it"


def test_the_sea_room():
    """Half a circle twice, with 500 m straight between: out on the first heading, back, and out again on the other side."""
    legs = [Leg("turn:20/180", 5.0, 120.0, 0.0), Leg("turn:-20/180", 5.0, 120.0, 220.0)]
    found = timetable_of(MODEL, SHIP, legs)
    first = shipid.simulate(MODEL, SHIP, "turn:20/180", speed=5.0, duration=120.0)
    assert found.rooms[0].starboard == pytest.approx(first["y"].max()) and found.rooms[0].port == pytest.approx(
        0, abs=1
    )
    assert found.rooms[0].ahead == pytest.approx(first["x"].max())
    # The other circle is the mirror image of this one.
    assert found.rooms[1].port == pytest.approx(found.rooms[0].starboard, rel=1e-6)
    # Behind the first circle the ship runs 5 m/s for 100 s on the heading it has then.
    north, heading = (float(first[n][-1]) for n in ("x", "psi"))
    assert found.room.astern >= -(north + 500 * np.cos(heading)) - 1e-6 > 0
    assert found.room.ahead == pytest.approx(found.rooms[0].ahead, rel=1e-6)
    assert set(found.to_dict()) == {"weather", "orders", "sea_room", "sea_room_of_each"}


def test_a_plan_holds_its_timetable():
    plan = shipid.plan_trials("norrbin", "zeefakkel", "8 min", draws=0, repertoire=["zigzag:20/20"])
    assert plan.timetable is not None and plan.to_dict()["timetable"]["sea_room"]["ahead"]["unit"] == "m"
    assert {o.leg for o in plan.timetable.orders} == set(range(1, len(plan.legs) + 1))
    text = plan.text()
    assert plan.timetable.text() in text
    assert "rudder 20 deg to port, when the heading has changed by 20 deg to starboard" in text and "sea room" in text


def test_a_manoeuvre_that_is_not_sailed_gives_a_reason():
    """A damping that pushes: the ship runs away."""
    wild, said = with_values(SHIP, {"b1": "-1 1/s", "b3": "0 s/rad^2"}, [MODEL]), []
    assert sailed_timetable(MODEL, wild, [Leg("turn:30", 5.0, 300.0, 0.0)], said) is None
    assert said[0].startswith("there is no timetable: turn:30 of ship zeefakkel")


def test_the_sea_room_in_a_current():
    """A current along the first heading carries the whole track; on the reverse heading it lies astern."""
    legs = [Leg("turn:20/180", 5.0, 120.0, 0.0), Leg("turn:-20/180", 5.0, 120.0, 220.0)]
    calm = timetable_of(MODEL, SHIP, legs)
    for heading, side in ((0.7, "ahead"), (0.7 + np.pi, "astern")):
        found = timetable_of(MODEL, SHIP, legs, Surroundings(heading, current=(1.0, 0.7)))
        assert (found.room.ahead > calm.room.ahead + 50) is (side == "ahead")
        assert (found.room.astern > calm.room.astern + 200) is (side == "astern")
        assert found.weather == f"a current of 1 m/s to 40.1 deg, first heading {np.degrees(heading):.3g} deg"
    turned = timetable_of(MODEL, SHIP, legs, Surroundings(2.0))
    assert turned.weather == "calm" and turned.room.starboard == pytest.approx(calm.room.starboard, abs=0.5)
