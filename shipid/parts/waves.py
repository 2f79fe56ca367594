"""The waves: a yaw motion that the instruments show, without an effect on the path.

Passenier (1989), sections 2.5 and 5.3. The direction is the one the waves run TO.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, derived, given, parameter, state


def wave_spectrum(omega: np.ndarray, height: float, period: float) -> np.ndarray:
    """Return the spectrum of the elevation of a fully developed sea.

    Passenier (1989), eq. (2.89), A omega^-p exp(-B omega^-q), with the numbers of the ITTC (1978): p = 5, q = 4, A = 173 H^2/T^4 and
    B = 691/T^4. Its integral is (H/4)^2, and it is largest at (4 B/5)^(1/4).

    Parameters
    ----------
    omega : ndarray, shape (N,)
        Frequencies in rad/s, greater than zero.
    height : float
        Significant wave height in m.
    period : float
        Average period in s.

    Returns
    -------
    ndarray, shape (N,)
        In m^2 s.
    """
    a, b = 173.0 * height**2 / period**4, 691.0 / period**4
    return a * omega**-5.0 * np.exp(-b * omega**-4.0)


class Waves(Component):
    """The yaw motion by waves: white noise through a narrow filter at the frequency of encounter.

    It changes what the instruments show, and not the path. With white noise of intensity q, the variance of the heading by
    waves is q / (4 zeta omega_e^3) in seas from ahead and abeam. In a following sea that would grow without limit as the ship
    keeps up with the waves, and the energy of the waves does not: there the variance stays q / (4 zeta omega_0^3), that of the
    ship at rest.
    """

    psi_wave = state("rad", "heading by the waves", nominal="0.5 deg", latex=r"\psi_v")
    r_wave = state("rad/s", "rate of turn by the waves", nominal="0.2 deg/s", latex="r_v")
    wave_noise = given("rad/s^2", "white noise that drives the waves", default=0.0, latex="w")
    wave_direction = given("rad", "direction the waves run to", default=0.0, wraps=True, latex=r"\psi_g")
    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    u = given("m/s", "forward speed through the water")
    wave_frequency = constant("rad/s", "frequency of the waves", default="0.6 rad/s", latex=r"\omega_0")
    wave_damping = constant("1", "damping ratio of the filter", default=0.15, latex=r"\zeta")
    g = constant("m/s^2", "acceleration of gravity", default="9.81 m/s^2")
    encounter = derived("rad/s", "frequency at which the ship meets the waves", latex=r"\omega_e")

    @encounter.equals
    def frequency_of_encounter(self):
        """Passenier (1989), eq. (2.90)."""
        along = self.u * np.cos(self.wave_direction - self.psi)
        return self.wave_frequency - self.wave_frequency**2 * along / self.g

    @psi_wave.rate
    def heading(self):
        """Passenier (1989), section 5.3: the heading by the waves is the integral of their rate."""
        return self.r_wave

    @r_wave.rate
    def shaping(self):
        """Van der Klugt (1987): s / (s^2 + 2 zeta omega s + omega^2), at the frequency of encounter.

        The frequency passes zero in following seas; its magnitude is used. A spectrum of relative width zeta keeps the width
        zeta omega_0 where its middle is met at zero, so that the frequency of the filter is not smaller; and below omega_0 the
        noise falls with omega^1.5, which keeps the energy of the waves: S(omega_e) d omega_e = S(omega) d omega. Both are this
        project's own.
        """
        omega = np.maximum(np.abs(self.encounter), self.wave_damping * self.wave_frequency)
        kept = np.minimum(omega / self.wave_frequency, 1.0) ** 1.5
        damping = 2 * self.wave_damping * omega * self.r_wave
        return kept * self.wave_noise - damping - omega**2 * self.psi_wave


class WaveMoment(Component):
    """The yaw acceleration by waves, which moves the ship itself: elevation at the frequency of encounter, times sin 2 gamma_w.

    `Waves` shows a motion to the instruments that the track does not have; this is the other form of the thesis, an input of the yaw
    equation. White noise of intensity 4 zeta omega_0^3 (H/4)^2 gives the elevation of a sea of significant height H, whatever the
    frequency of encounter: the ship's own speed adds no energy to the waves.
    """

    elevation = state("m", "elevation of the sea as the ship meets it", nominal=1.0, latex=r"\zeta_w")
    elevation_rate = state("m/s", "rate of the elevation", nominal=1.0, latex=r"\dot\zeta_w")
    elevation_noise = given("m/s^2", "white noise that drives the elevation", default=0.0, latex="w")
    wave_direction = given("rad", "direction the waves run to", default=0.0, wraps=True, latex=r"\psi_g")
    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    u = given("m/s", "forward speed through the water")
    r_residual = given("rad/s^2", "yaw acceleration by anything but the waves", default=0.0, latex=r"\dot r_{res}")
    wave_frequency = constant("rad/s", "frequency of the waves", default="0.6 rad/s", latex=r"\omega_0")
    wave_damping = constant("1", "damping ratio of the filter", default=0.15, latex=r"\zeta")
    g = constant("m/s^2", "acceleration of gravity", default="9.81 m/s^2")
    # No log holds the elevation, so that a run of the model with the recorded inputs has none, and shows nothing of this. The bounds
    # let half a degree of heading by waves of 0.75 m rms through for a ship of 230 m at 9.5 m/s, which is 600.
    H_g = parameter(
        "rad/m/s^2",
        "yaw acceleration per elevation, in waves from the quarter",
        start=0.1,
        low=-2000.0,
        high=2000.0,
        estimated=False,
        prime=True,
    )
    r_disturbance = derived("rad/s^2", "yaw acceleration by the waves and by what else acts", latex=r"\dot r_d")

    @elevation.rate
    def rise(self):
        """The elevation is the integral of its rate: Passenier (1989), fig. 2.14."""
        return self.elevation_rate

    @elevation_rate.rate
    def shaping(self):
        """The second-order filter of Passenier (1989), fig. 2.14, at the frequency of encounter, eq. (2.90), as in `Waves`."""
        along = self.u * np.cos(self.wave_direction - self.psi)
        encounter = self.wave_frequency - self.wave_frequency**2 * along / self.g
        omega = np.maximum(np.abs(encounter), self.wave_damping * self.wave_frequency)
        kept = (omega / self.wave_frequency) ** 1.5
        damping = 2 * self.wave_damping * omega * self.elevation_rate
        return kept * self.elevation_noise - damping - omega**2 * self.elevation

    @r_disturbance.equals
    def moment(self):
        """Passenier (1989), eq. (2.91): H_g sin(2 gamma_w), with one H_g over the narrow band of the waves."""
        return self.H_g * np.sin(2 * (self.wave_direction - self.psi)) * self.elevation + self.r_residual


class ColouredWaves(Component):
    """The yaw motion by waves as a filter uses it: first-order coloured noise, sampled.

    The heading by waves needs no state of its own: (5.40) makes it a fixed multiple of v_f, and with two states
    their difference would be unobservable.
    """

    v_f = state("rad/s", "slow part of the rate by waves", nominal="0.2 deg/s", spread="0.12 deg/s")
    T_s = given("s", "sampling interval")
    wave_noise = given(
        "rad/s", "white noise that drives the waves, per sample", default=0.0, noise="0.45 deg/s", latex="w"
    )
    wave_time = constant("s", "time constant of the colouring", default="3 s", latex=r"\tau_f")
    r_wave = derived("rad/s", "rate of turn by the waves", latex="r_v")
    psi_wave = derived("rad", "heading by the waves", latex=r"\psi_v")

    @v_f.next
    def colouring(self):
        """Passenier (1989), eq. (5.29) with a_f = 1 - T/tau_f and b_f = T/tau_f."""
        return self.v_f + self.T_s / self.wave_time * (self.wave_noise - self.v_f)

    @r_wave.equals
    def rate(self):
        """Passenier (1989), eq. (5.30)."""
        return self.wave_noise - self.v_f

    @psi_wave.equals
    def heading(self):
        """Passenier (1989), eq. (5.40): both sum the same differences, so psi_v is always (T/b_f) v_f."""
        return self.wave_time * self.v_f
