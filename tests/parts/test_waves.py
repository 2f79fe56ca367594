"""The waves keep their energy at every speed: the filter's stationary variance, from the Lyapunov equation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

import shipid
from shipid.declaration.model import Evaluation
from shipid.models import Waves

#: Frequency and damping ratio of the waves, and the root mean square of the heading of a ship at rest in them, in degrees.
OMEGA, ZETA, AT_REST = 0.6, 0.15, 0.5
INTENSITY = 4 * ZETA * OMEGA**3 * np.deg2rad(AT_REST) ** 2
MODEL = shipid.join("waves", Waves)


def rms(speed: float, angle: float = 0.0) -> tuple[float, float]:
    """Root mean square of the heading [deg] and its rate [deg/s] by waves that run at an angle from the course."""
    still = {"wave_frequency": OMEGA, "wave_damping": ZETA, "g": 9.81, "psi": 0.0, "u": speed, "wave_direction": angle}

    def rates(**given: float) -> list[float]:
        values = still | {"psi_wave": 0.0, "r_wave": 0.0, "wave_noise": 0.0} | given
        found = Evaluation(MODEL, values).right_hand_sides("rate")
        return [float(found[n]) for n in ("psi_wave", "r_wave")]

    matrix = np.array([rates(psi_wave=1.0), rates(r_wave=1.0)]).T
    noise = np.array([rates(wave_noise=1.0)]).T
    covariance = solve_continuous_lyapunov(matrix, -INTENSITY * noise @ noise.T)
    return tuple(np.rad2deg(np.sqrt(np.diag(covariance))))


def test_a_ship_that_keeps_up_with_the_waves_does_not_swing_without_limit():
    """16.2 m/s in waves of 0.6 rad/s from astern: the heading had 228 deg rms, where the ship at rest has half a degree."""
    assert pytest.approx(0.0055, abs=1e-4) == OMEGA - OMEGA**2 * 16.2 / 9.81
    assert rms(0.0)[0] == pytest.approx(AT_REST, rel=1e-9)
    assert rms(16.2)[0] == pytest.approx(AT_REST, rel=1e-9)
    assert rms(9.81 / OMEGA)[0] == pytest.approx(AT_REST, rel=1e-9)


@pytest.mark.parametrize("angle", np.deg2rad([0.0, 30.0, 60.0, 90.0, 180.0]))
def test_no_speed_and_no_course_adds_energy(angle):
    for speed in np.linspace(0.0, 60.0, 121):
        heading, rate = rms(speed, angle)
        assert heading <= AT_REST * (1 + 1e-9)
        assert rate <= AT_REST * max(OMEGA, abs(OMEGA - OMEGA**2 * speed * np.cos(angle) / 9.81)) * (1 + 1e-9)


def test_seas_from_ahead_are_as_they_were():
    """q / (4 zeta omega_e^3), Van der Klugt's filter at the frequency of encounter."""
    omega = OMEGA + OMEGA**2 * 9.0 / 9.81
    assert np.deg2rad(rms(9.0, np.pi)[0]) == pytest.approx(np.sqrt(INTENSITY / (4 * ZETA * omega**3)), rel=1e-9)
