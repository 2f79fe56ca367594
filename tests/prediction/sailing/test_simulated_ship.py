from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import UnknownNameError
from shipid.prediction.sailing.sail import sail
from shipid.prediction.sailing.simulated_ship import SimulatedShip
from shipid.trials.manoeuvres.simulate import NotSailedError


def test_step_by_step_is_the_whole_voyage(pilot):
    whole = sail(
        pilot, [(0.0, "60 deg")], rudder_limit="12 deg", duration=400, sampling=2.0, current=("1 m/s", "90 deg")
    )
    ship = SimulatedShip(pilot, inputs={"current_east": 1.0})
    for k in range(1, 201):
        now = ship.advance(2.0, np.deg2rad(60), np.deg2rad(12))
        for name in ("x", "y", "psi", "u", "delta"):
            assert now[name] == pytest.approx(whole.table[name].iloc[k], abs=1e-3), (k, name)
    assert ship.t == 400.0


def test_orders_and_surroundings_change_on_the_way(pilot):
    ship = SimulatedShip(pilot, start={"x": 5.0, "psi": 0.3})
    assert ship.now["x"] == 5.0 and ship.now["psi"] == 0.3
    kept = ship.advance(100.0)
    assert kept["psi"] == pytest.approx(0.3, abs=1e-9)
    ship.inputs["current_north"] = 1.0
    drifted = ship.advance(10.0)
    assert drifted["x"] - kept["x"] == pytest.approx(95 * np.cos(0.3) + 10, abs=0.01)
    other = SimulatedShip(pilot, start={"psi": 0.3})
    ship.set("K", 1.0)
    assert ship.advance(40.0, 1.3)["psi"] < other.advance(40.0, 1.3)["psi"] < 1.3
    assert other.advance(400.0)["psi"] == pytest.approx(1.3, abs=0.02)


def test_errors(pilot):
    with pytest.raises(UnknownNameError, match="K_star"):
        SimulatedShip(pilot, values={"K_star": 1.0})
    with pytest.raises(UnknownNameError, match="K_star"):
        SimulatedShip(pilot).set("K_star", 1.0)
    wild = SimulatedShip(
        shipid.design_autopilot("norrbin", "soesterberg", rudder_limit="30 deg"), values={"b3": -100.0}
    )
    with pytest.raises(NotSailedError, match="runs away"):
        wild.advance(2000.0, 3.0)
