"""The MMG model of KVLCC2 beside the free-running tests of the same hull, and the limits it states.

The measured numbers are those of MARIN's free-running model, 7 m (SIMMAN 2008): the coefficients come from captive tests and know
nothing of them. The circles fit, and the overshoots come out too small.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import shipid
from shipid import find_model, find_ship
from shipid.generation.simulator import make_simulator

SHIP = "kvlcc2-7m"
LENGTH = 7.0


@pytest.fixture(scope="module")
def sailed() -> Callable[..., object]:
    """What is measured of a manoeuvre of the model, kept."""
    kept: dict[tuple[str, ...], object] = {}

    def run(manoeuvre: str, model: str = "mmg", **values: str) -> object:
        key = (manoeuvre, model, *values.values())
        if key not in kept:
            trial = shipid.simulate(model, SHIP, manoeuvre, sampling="0.1 s", values=values)
            kept[key] = shipid.measure(trial, length=f"{LENGTH} m")
        return kept[key]

    return run


@pytest.mark.parametrize(("rudder", "advance", "diameter"), [(35, 3.25, 3.34), (-35, 3.11, 3.08)])
def test_turning_circles_of_the_free_running_model(sailed, rudder, advance, diameter):
    """Advance and tactical diameter in lengths, within 8 %."""
    circle = sailed(f"turn:{rudder}")
    assert circle.advance / LENGTH == pytest.approx(advance, rel=0.08)
    assert abs(circle.tactical_diameter) / LENGTH == pytest.approx(diameter, rel=0.08)
    # The free-running model keeps 0.42 of its speed at 180 degrees, the forward one or not.
    assert circle.speeds[1] / 1.178 == pytest.approx(0.42, abs=0.04)


@pytest.mark.parametrize(
    ("manoeuvre", "first", "second"),
    [("10/10", 8.2, 21.9), ("-10/10", 9.5, 15.0), ("20/20", 13.7, 14.9), ("-20/20", 15.1, 13.3)],
)
def test_zigzags_of_the_free_running_model(sailed, manoeuvre, first, second):
    """First overshoots within 3.5 degrees, second ones within 2 at 20/20 and 8 at 10/10, where the hull is hardest to tell."""
    found = np.rad2deg(sailed(f"zigzag:{manoeuvre}").overshoots[:2])
    assert first - 3.5 < found[0] < first
    assert abs(found[1] - second) < (8.0 if "10" in manoeuvre else 2.0)


def test_the_ship_turns_more_easily_to_port(sailed):
    """Flow straightening of 0.64 in flow from port and 0.395 from starboard: a turn to port is checked less."""
    to_starboard, to_port = sailed("zigzag:20/20"), sailed("zigzag:-20/20")
    assert to_port.overshoots[0] > 1.2 * to_starboard.overshoots[0]


def test_at_the_cruise_thrust_and_resistance_balance(evaluate):
    """And the shaft turns as the free-running model's did, 10.3 to 12 1/s."""
    ship, model = find_ship(SHIP), find_model("mmg")
    values = dict.fromkeys(model.states, 0.0) | {"u": 1.178, "cruise": 1.178, "delta": 0.0} | ship.values(model)
    sides = evaluate(model, values)
    assert sides["u"] == pytest.approx(0.0, abs=1e-12)
    assert 10.3 < sides["n"] < 12.0
    for u in (-0.3, 0.0, 0.02, 0.5):
        assert evaluate(model, values | {"u": u})["u"] > 0


@pytest.mark.parametrize(("u", "n"), [(0.0, 0.0), (0.0, 10.0), (0.5, 0.0), (0.0, -10.0)])
def test_rest_and_a_stopped_propeller_are_finite(evaluate, u, n):
    ship, model = find_ship(SHIP), find_model("mmg-revolutions")
    rest = dict.fromkeys(model.states, 0.0) | {"u": u, "n": n, "cruise": 1.178, "delta": 0.3} | ship.values(model)
    sides = evaluate(model, rest)
    assert all(np.isfinite(v) for v in sides.values())
    assert (sides["turns_ahead"] >= 0) == (n >= 0)


def test_a_propeller_that_turns_astern_leaves_the_model():
    """A stop: the shaft goes from ahead to astern at 20 s."""
    ship, model = find_ship(SHIP), find_model("mmg-revolutions")
    t = np.arange(0.0, 40.0, 0.5)
    simulator = make_simulator(model, ("u",), hold="zero", compiled=False)
    inputs = {"n": np.where(t < 20, 10.0, -5.0), "delta": 0.0, "cruise": 1.178}
    left = simulator(t, ship.values(model), inputs, {"u": 1.178}).departure
    assert left.time == pytest.approx(20.0)
    assert left.reason == "the propeller turns astern, and its thrust is known ahead only"


def test_shallow_water_widens_the_circle_and_deep_water_changes_nothing(sailed):
    deep = sailed("turn:35")
    far = sailed("turn:35", "mmg-shallow", depth="200 m")
    near = sailed("turn:35", "mmg-shallow", depth="0.69 m")
    assert far.tactical_diameter == pytest.approx(deep.tactical_diameter, rel=0.01)
    assert near.tactical_diameter > 1.2 * deep.tactical_diameter
    assert near.speed_loss < 0.9 * deep.speed_loss


def test_a_depth_below_the_range_is_said():
    with pytest.raises(shipid.ShipidError, match=r"the water is less than 1\.2 draughts deep"):
        shipid.simulate("mmg-shallow", SHIP, "turn:35", values={"depth": "0.5 m"})


def test_a_mirrored_ship_sails_the_mirrored_manoeuvre(evaluate):
    """The coefficients of flow from port and from starboard change places; so each side is used where it belongs."""
    ship, model = find_ship(SHIP), find_model("mmg")
    values = dict.fromkeys(model.states, 0.0) | {"u": 0.9, "cruise": 1.178} | ship.values(model)
    to_port = {"v": 0.2, "r": -0.05, "delta": -0.4}
    mirrored = {n: -v for n, v in to_port.items()}
    exchanged = {
        n: values[m]
        for a, b in (("C_2_port", "C_2_starboard"), ("gamma_port", "gamma_starboard"))
        for n, m in ((a, b), (b, a))
    }
    first, second = evaluate(model, values | to_port), evaluate(model, values | mirrored | exchanged)
    assert second["u"] == pytest.approx(first["u"], rel=1e-12)
    assert (second["v"], second["r"]) == pytest.approx((-first["v"], -first["r"]), rel=1e-12)
    assert evaluate(model, values | mirrored)["r"] != pytest.approx(-first["r"], rel=1e-3)
