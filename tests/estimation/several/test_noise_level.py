"""The level of the waves: against simulated waves of known variance, and in the filter it is for."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.signal import lfilter

import shipid
from shipid.estimation.several.noise_level import LevelEstimator
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.generation.simulator import UnstatedInputError
from shipid.models import AdaptiveYaw, ColouredWaves, Compass, Gyro, PlanarMotion, WaveLevel
from shipid.parameters.parameter_set import Value

DT, GYRO = 0.4, np.deg2rad(0.01)


def waves(rms: float, count: int, seed: int, omega: float = 0.6, zeta: float = 0.15) -> np.ndarray:
    """Rate of turn by waves, exactly stationary: van der Klugt's filter by the matrix exponential, variance rms squared."""
    drift = np.array([[0.0, 1.0], [-(omega**2), -2 * zeta * omega]])
    power = np.array([[0.0, 0.0], [0.0, 4 * zeta * omega * rms**2]])
    block = expm(np.block([[-drift, power], [np.zeros((2, 2)), drift.T]]) * DT)
    forward = block[2:, 2:].T
    root = np.linalg.cholesky(forward @ block[:2, 2:])
    rng = np.random.default_rng(seed)
    x = np.array([rms / omega, rms]) * rng.standard_normal(2)
    out = np.empty(count)
    for k, w in enumerate(rng.standard_normal((count, 2)) @ root.T):
        x = forward @ x + w
        out[k] = x[1]
    return out


def zigzag(count: int, half: float = 65.0) -> np.ndarray:
    """A container ship's rate of turn in a 15/15 zig-zag: K = .067 1/s, tau = 40 s."""
    rudder = np.deg2rad(15) * np.where((DT * np.arange(count)) % (2 * half) < half, 1.0, -1.0)
    pole = np.exp(-DT / 40)
    return lfilter([0.0, 0.067 * (1 - pole)], [1.0, -pole], rudder)


@pytest.fixture(scope="module")
def rms() -> LevelEstimator:
    return LevelEstimator(WaveLevel, "wave_rms")


@pytest.mark.parametrize("level", [0.1, 0.3])
def test_waves_of_known_variance_are_found_while_the_ship_manoeuvres(rms, level):
    """Twelve records of 15 minutes; the level of one scatters by 8 %, for a narrow-banded sea is a few dozen independent waves."""
    count, truth = 2250, np.deg2rad(level)
    t, ship = DT * np.arange(count), zigzag(2250)
    rng = np.random.default_rng(1)
    found = [
        rms.estimate({"t": t, "r": ship + waves(truth, count, s) + GYRO * rng.standard_normal(count)}).values[-1]
        for s in range(12)
    ]
    assert np.mean(found) == pytest.approx(truth, rel=0.07)
    assert np.std(found, ddof=1) < 0.15 * truth


def test_a_pure_wave_is_measured_by_the_root_of_half_its_square(rms):
    t = DT * np.arange(3000)
    found = rms.estimate({"t": t, "r": 0.01 * np.sin(0.6 * t)}).values
    # Straight lines between the samples of a wave of 26 samples a period lose half a percent.
    assert found[-1] == pytest.approx(0.01 / np.sqrt(2), rel=0.01)
    assert (found[t < 15] == 0).all()


def test_the_ship_s_own_turning_is_hardly_taken_for_waves(rms):
    """Where the rudder is put over at once something passes: a tenth of a usual sea."""
    t = DT * np.arange(2250)
    turning = zigzag(2250)
    assert rms.estimate({"t": t, "r": turning}).values[-1] < np.deg2rad(0.025)
    assert rms.estimate({"t": t, "r": turning, "r_expected": turning}).values[-1] < 1e-12


def test_a_sea_that_rises_is_followed_within_the_memory(rms):
    count = 4500
    rise = np.where(np.arange(count) < 2000, np.deg2rad(0.05), np.deg2rad(0.3))
    found = rms.estimate({"t": DT * np.arange(count), "r": rise * waves(1.0, count, 3)}).values
    assert found[1999] == pytest.approx(np.deg2rad(0.05), rel=0.3)
    # One memory of 200 s after the rise, 1 - 1/e of the new power is there.
    assert found[2500] > np.deg2rad(0.18)
    assert found[-1] == pytest.approx(np.deg2rad(0.3), rel=0.3)


def test_samples_one_by_one_are_the_record(rms):
    t, r = DT * np.arange(300), waves(0.005, 300, 4)
    wanted, online = rms.estimate({"t": t, "r": r}), rms.start()
    for k in range(300):
        assert online.update({"t": t[k], "r": r[k]}) == wanted.values[k]
    before = online.update({"t": t[-1], "r": 5.0})
    assert before == wanted.values[-1]
    with pytest.raises(UsageError, match="needs its time"):
        online.update({"r": 0.1})


def test_a_missing_sample_is_held(rms):
    t, r = DT * np.arange(400), waves(0.005, 400, 4)
    gappy = r.copy()
    gappy[[0, 100, 101]] = np.nan
    filled = r.copy()
    filled[0], filled[100:102] = r[1], r[99]
    np.testing.assert_array_equal(rms.estimate({"t": t, "r": gappy}).values, rms.estimate({"t": t, "r": filled}).values)


@pytest.fixture(scope="module")
def yaw() -> shipid.ExtendedKalmanFilter:
    model = shipid.join("yaw in waves", AdaptiveYaw, PlanarMotion, ColouredWaves, Gyro, Compass)
    known = {n: Value(n, v, "1", "the ship of this test") for n, v in (("a", 1.6 / 1.7), ("b1", 1 / 1.7))}
    length = {"L": Value("L", 226.0, "m", "the ship of this test")}
    return shipid.ExtendedKalmanFilter(
        model,
        shipid.ParameterSet("ship", sections={"particulars": length, "yaw in waves": known}),
        measured={"gyro": "0.01 deg/s", "compass": "0.1 deg"},
        estimated=(),
        noise={"wave_noise": "0.05 deg/s", "r": "0.002 deg/s^1.5"},
        inputs={"u": "9.5 m/s", "cruise": "9.5 m/s"},
        gate=None,
    )


def test_the_level_makes_the_filter_calm_in_a_high_sea(yaw):
    """A filter set for a calm sea follows the waves; with the estimated level its rate of turn is the ship's."""
    count = 2250
    t, ship, sea = DT * np.arange(count), zigzag(2250), waves(np.deg2rad(0.3), 2250, 5)
    rng = np.random.default_rng(2)
    record = {
        "t": t,
        "r": ship + sea + GYRO * rng.standard_normal(count),
        "psi": np.cumsum(ship + sea) * DT + np.deg2rad(0.1) * rng.standard_normal(count),
        "delta": np.deg2rad(15) * np.where(t % 130 < 65, 1.0, -1.0),
    }
    record["gyro"], record["compass"] = record["r"], record["psi"]
    level = LevelEstimator(WaveLevel).estimate(record)
    assert level.values[-1] == pytest.approx(3 * np.deg2rad(0.3), rel=0.25)
    fixed, adapted = yaw.filter(record), yaw.filter(record, scale=level.scale(yaw))
    late = slice(count // 3, None)
    error = [np.sqrt(np.mean((run["r"] - ship)[late] ** 2)) for run in (fixed, adapted)]
    assert error[1] < 0.5 * error[0] and error[1] < np.deg2rad(0.03)
    json.dumps(level.to_dict(), allow_nan=False)
    assert "sigma_w over 2250 samples" in level.text()


def test_the_factor_on_a_noise(yaw):
    """1 while there is no estimate, the ratio of the levels after, and never so little that the sensors are taken as exact."""
    estimator = LevelEstimator(WaveLevel)
    t = DT * np.arange(800)
    run = estimator.estimate({"t": t, "r": 0.02 * np.sin(0.6 * t)})
    factor, given = run.scale(yaw)["wave_noise"], np.deg2rad(0.05)
    assert (factor[:30] == 1).all()
    np.testing.assert_allclose(factor[-1], run.values[-1] / given, rtol=1e-14)
    online = estimator.start()
    assert online.scale(yaw) == {"wave_noise": 1.0}
    for k in range(800):
        online.update({"t": t[k], "r": 0.02 * np.sin(0.6 * t[k])})
    assert online.scale(yaw)["wave_noise"] == factor[-1]
    still = estimator.estimate({"t": t, "r": 1e-9 * np.sin(0.6 * t)})
    assert still.scale(yaw)["wave_noise"][-1] == 0.05


def test_what_cannot_be_a_level_is_refused(yaw):
    with pytest.raises(UnknownNameError, match="level of model wave-level called 'height'"):
        LevelEstimator(WaveLevel, "height")
    estimator = LevelEstimator(WaveLevel)
    with pytest.raises(UnstatedInputError, match="reads 'r'"):
        estimator.estimate({"t": np.arange(3.0)})
    with pytest.raises(UsageError, match="decreases"):
        estimator.estimate({"t": np.array([0.0, 1.0, 0.5]), "r": np.zeros(3)})
    run = estimator.estimate({"t": np.arange(3.0), "r": np.zeros(3)})
    with pytest.raises(UnknownNameError, match="noise of the filter called 'sea'"):
        run.scale(yaw, "sea")
    with pytest.raises(UsageError, match="is a density"):
        run.scale(yaw, "r")
