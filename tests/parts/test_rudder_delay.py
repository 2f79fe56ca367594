"""A rudder that acts late in a closed loop: its record, shifted, gives the same run."""

import numpy as np
import pytest

import shipid
from shipid import find_model, find_ship
from shipid.generation.simulator import make_simulator
from shipid.parts.rudder_delay import recorded_rudder


@pytest.mark.parametrize("delay", [2.3, 6.0])
def test_a_simulated_trial_holds_the_rudder_before_it_acts(delay: float) -> None:
    """The approximant of a closed loop against the shift of a record, to 0.2 % of the heading."""
    model, ship = find_model("de-keizer-delay"), find_ship("soesterberg")
    trial = shipid.simulate(model, ship, "zigzag:20/20", values={"delay": f"{delay} s"}, sampling="0.5 s")
    assert trial.has("delta")
    values = ship.values(model, speed=trial["u"][0])
    run = make_simulator(model, ("psi",), compiled=False)(
        trial["t"],
        values | {"delay": delay},
        {"delta": trial["delta"], "cruise": trial["u"][0]},
        {"u": trial["u"][0], "psi": trial["psi"][0]},
    )
    assert run["psi"] == pytest.approx(trial["psi"], abs=2e-3 * np.ptp(trial["psi"]))
    prompt = shipid.simulate("de-keizer", ship, "zigzag:20/20", sampling="0.5 s")
    assert np.ptp(trial["psi"]) > np.ptp(prompt["psi"]) + np.deg2rad(0.5)


def test_without_a_dead_time_the_record_is_the_rudder() -> None:
    assert recorded_rudder(find_model("nomoto-delay")) == "delta"
