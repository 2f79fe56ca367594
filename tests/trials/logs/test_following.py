"""Speeds from speed and drift angle, and the true wind from the relative one, by independent vector sums."""

import cmath

import numpy as np
import pandas as pd
import pytest

import shipid

T = np.arange(0.0, 40.0, 1.0)


def read(tmp_path, **columns):
    units = {
        "psi": "deg",
        "U": "m/s",
        "beta": "deg",
        "u": "m/s",
        "v": "m/s",
        "SOG": "m/s",
        "COG": "deg",
        "delta": "deg",
    }
    units |= {"wind_speed_relative": "m/s", "wind_direction_relative": "deg", "wind_speed": "m/s"}
    table = pd.DataFrame({f"{n} [{units[n]}]": np.broadcast_to(v, T.shape) for n, v in columns.items()})
    table.insert(0, "t [s]", T)
    table.to_csv(tmp_path / "log.csv", index=False)
    return shipid.read_trial(tmp_path / "log.csv")


def test_speeds_follow_from_speed_and_drift_angle(tmp_path):
    beta = 12.0 * np.sin(0.1 * T)
    trial = read(tmp_path, psi=0.0, U=8.0, beta=beta)
    assert np.hypot(trial["u"], trial["v"]) == pytest.approx(np.full(T.size, 8.0))
    # By the definition of the drift angle: positive where the flow comes from port.
    assert np.rad2deg(np.arctan2(-trial["v"], trial["u"])) == pytest.approx(beta, abs=1e-9)
    assert any("u was worked out as U cos(beta)" in note for note in trial.source.notes)


def test_missing_samples_of_either_stay_missing(tmp_path):
    whole, beta = np.full(T.size, 8.0), np.full(T.size, 5.0)
    whole[3], beta[7] = np.nan, np.nan
    trial = read(tmp_path, psi=0.0, U=whole, beta=beta)
    assert np.flatnonzero(np.isnan(trial["u"])).tolist() == [3, 7]
    assert np.flatnonzero(np.isnan(trial["v"])).tolist() == [3, 7]


def test_the_sway_speed_follows_from_forward_speed_and_drift_angle(tmp_path):
    trial = read(tmp_path, psi=0.0, u=7.0, beta=-10.0)
    assert trial["v"] == pytest.approx(np.full(T.size, 7.0 * np.tan(np.deg2rad(10.0))))
    assert "U" not in trial.table


def test_what_is_recorded_is_not_replaced(tmp_path):
    trial = read(tmp_path, psi=0.0, U=8.0, beta=5.0, u=7.5, v=0.1)
    assert trial["u"] == pytest.approx(np.full(T.size, 7.5)) and trial["v"] == pytest.approx(np.full(T.size, 0.1))


@pytest.mark.parametrize("over_ground", [False, True])
def test_relative_wind_becomes_true_wind(tmp_path, over_ground):
    """A northerly of 10 m/s on a ship that turns through north at 5 m/s; complex numbers count north + i east."""
    psi = np.deg2rad(-20.0 + T)
    wind, moves = cmath.rect(10.0, np.pi), 5.0 * np.exp(1j * (psi + 0.1))
    felt = (wind - moves) * np.exp(-1j * psi)
    relative = {
        "wind_speed_relative": np.abs(felt),
        "wind_direction_relative": np.rad2deg(np.angle(felt)),
    }
    ship = moves * np.exp(-1j * psi)
    speeds = {"u": ship.real, "v": ship.imag}
    if over_ground:
        # The speed through the water is another one.
        speeds = {"SOG": np.abs(moves), "COG": np.rad2deg(np.angle(moves)) % 360, "u": 3.0}
    trial = read(tmp_path, psi=np.rad2deg(psi) % 360, **speeds, **relative)
    assert trial["wind_speed"] == pytest.approx(np.full(T.size, 10.0), abs=1e-9)
    # It blows TO the south.
    assert np.cos(trial["wind_direction"]) == pytest.approx(np.full(T.size, -1.0), abs=1e-9)
    note = next(n for n in trial.source.notes if n.startswith("wind_speed and"))
    assert ("over the ground" in note) is over_ground and ("where a current sets" in note) is not over_ground


def test_a_recorded_true_wind_stays_and_a_lack_is_said(tmp_path):
    relative = {"wind_speed_relative": 6.0, "wind_direction_relative": 170.0}
    assert "wind_direction" not in read(tmp_path, psi=0.0, u=5.0, wind_speed=4.0, **relative).table
    trial = read(tmp_path, psi=0.0, **relative)
    assert "wind_speed" not in trial.table
    assert any("the true wind is not known" in n and "no speed of the ship" in n for n in trial.source.notes)
    assert any("no heading" in n for n in read(tmp_path, u=5.0, **relative).source.notes)
    drifting = read(tmp_path, psi=90.0, SOG=5.0, wind_speed_relative=5.0, wind_direction_relative=180.0)
    assert drifting["wind_speed"] == pytest.approx(np.zeros(T.size), abs=1e-9)


def test_a_speed_without_a_drift_angle_is_said_not_to_be_used():
    t = np.arange(20.0)
    trial = shipid.Trial.from_frame({"t [s]": t, "psi [deg]": t, "U [m/s]": 8 + 0 * t})
    assert any("the speed U and no drift angle beta" in note for note in trial.source.notes)
