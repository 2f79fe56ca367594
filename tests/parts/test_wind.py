"""The relative wind is that of a ship over the ground: its speed through the water, and the current."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.declaration.model import Evaluation
from shipid.models import DeKeizer, LateralWind, PlanarMotion, VanLeeuwenSwayInWind, Wind, WindHarmonics
from shipid.parameters.catalogue import in_wind, known_models
from shipid.trials.manoeuvres.flows import parts_in_wind

MODEL = shipid.join("wind", Wind)


def relative(psi: float, **given: float) -> tuple[float, float]:
    """Relative wind ahead and to starboard in m/s."""
    ship = {"psi": psi, "u": 0.0, "v": 0.0, "wind_speed": 0.0, "wind_direction": 0.0, "current_north": 0.0}
    found = Evaluation(MODEL, ship | {"current_east": 0.0} | given)
    return float(found["wind_ahead"]), float(found["wind_aside"])


@pytest.mark.parametrize("psi", np.deg2rad([0.0, 40.0, 135.0, -100.0]))
def test_a_ship_that_drifts_with_the_wind_feels_none(psi):
    """2 m/s of current and of wind to 30 degrees; against each other they add to 4 m/s."""
    north, east = 2 * np.cos(np.pi / 6), 2 * np.sin(np.pi / 6)
    with_it = relative(psi, wind_speed=2.0, wind_direction=np.pi / 6, current_north=north, current_east=east)
    assert with_it == pytest.approx((0.0, 0.0), abs=1e-12)
    against = relative(psi, wind_speed=2.0, wind_direction=np.pi / 6, current_north=-north, current_east=-east)
    assert np.hypot(*against) == pytest.approx(4.0)
    # In calm air the wind over the deck is what the ship makes over the ground.
    assert relative(psi, u=3.0, current_north=north, current_east=east) == pytest.approx(
        (-3.0 - 2 * np.cos(np.pi / 6 - psi), -2 * np.sin(np.pi / 6 - psi))
    )


def test_a_current_moves_the_push_of_the_wind():
    """Heading north at 9 m/s with 10 m/s of wind from astern: 1 m/s pushes, and with a current of 1 m/s ahead nothing does."""
    at = {
        "N_w": 3e-7,
        "F_w": 4e-7,
        "L": 226.0,
        "u": 9.0,
        "wind_speed": 10.0,
        "wind_direction": 0.0,
        "psi": 0.0,
        "v": 0.0,
    }
    pushes = [
        Evaluation(MODEL, at | {"current_north": c, "current_east": 0.0})["u_disturbance"] for c in (0.0, 1.0, -1.0)
    ]
    assert pushes == pytest.approx([4e-7 * 226.0, 0.0, 4 * 4e-7 * 226.0])


@pytest.mark.parametrize("model", ["mmg", "cross-flow"])
def test_the_side_force_joins_beside_the_moment_or_comes_with_it(model):
    """Both read one relative wind; the harmonics state all three accelerations themselves."""
    for parts in ((Wind, LateralWind), (LateralWind, Wind), (WindHarmonics,)):
        whole = shipid.join("whole", shipid.find_model(model), *parts)
        assert {"wind_speed", "wind_direction"} <= set(whole.inputs)
        assert not {"u_disturbance", "v_disturbance", "r_disturbance", "wind_aside"} & set(whole.inputs)


def test_leeway_has_no_equation_to_solve():
    """A wind abeam from port pushes the ship to starboard, and the sway does not come back into the leeway."""
    model = shipid.join("leeway", DeKeizer, VanLeeuwenSwayInWind, Wind, PlanarMotion)
    still = dict.fromkeys((*model.states, *model.inputs, *model.parameters, *model.constants), 0.0)
    at = still | {"L": 226.0, "u": 9.0, "cruise": 9.0, "wind_speed": 10.0, "wind_direction": np.pi / 2, "k_w": 0.002}
    found = Evaluation(model, at | {"tau": 1.0, "tau_u": 1.0})
    assert found["v"] == pytest.approx(0.002 * 10.0 * np.hypot(9.0, 10.0) / 9.0)
    assert found["wind_aside"] == pytest.approx(10.0 - found["v"])


def test_calm_air_in_harmonics_is_finite():
    model = shipid.join("harmonics", WindHarmonics)
    calm = dict.fromkeys((*model.inputs, *model.parameters), 0.1) | {"L": 7.0, "least": 0.01, "wind_speed": 0.0}
    found = Evaluation(model, calm | {"u": 0.0, "v": 0.0, "current_north": 0.0, "current_east": 0.0, "r_residual": 0.0})
    assert [found[n] for n in ("u_disturbance", "v_disturbance", "r_disturbance")] == [0.0, 0.0, 0.0]


def carried() -> list[str]:
    """Models that a wind turns."""
    return [n for n, m in known_models().items() if in_wind(m) is not m]


@pytest.mark.parametrize("name", carried())
def test_what_simulates_a_wind_is_what_reads_it_from_a_log(name):
    """A wind that `simulate` adds to a model, and the model that `identify` takes for its log, are one law."""
    model = known_models()[name]
    pushed = (LateralWind,) if "v_disturbance" in model.inputs else ()
    sailed, read = shipid.join("sailed", model, *parts_in_wind(model, (9.0, 2.1)), *pushed), in_wind(model)
    assert set(sailed.states) == set(read.states) and set(sailed.inputs) == set(read.inputs)
    rng = np.random.default_rng(1)
    names = {*sailed.states, *sailed.inputs, *sailed.parameters, *sailed.constants}
    at = {n: 0.3 + 0.5 * rng.random() for n in sorted(names)}
    at |= {"wind_speed": 9.0, "wind_direction": 2.1, "r_residual": 0.0, "N_w1": 0.0}
    one, other = ({n: float(v) for n, v in Evaluation(m, at).right_hand_sides("rate").items()} for m in (sailed, read))
    assert one == pytest.approx(other, rel=1e-12)
    calm = Evaluation(read, at | {"wind_speed": 0.0})
    assert float(calm["r_disturbance"]) == 0.0, "what the air does to her own motion is the hull's"
