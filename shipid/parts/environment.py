"""Current, wind and waves: what acts on the ship from outside.

Passenier (1989), section 2.5. Directions are those the current, the wind and the waves go TO; a wind that is
reported by where it comes from is turned round before it gets here.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, derived, given, parameter, state


class UniformCurrent(Component):
    """A current that is the same everywhere."""

    current_speed = given("m/s", "speed of the current", default=0.0, latex="U_c")
    current_direction = given("rad", "direction the current flows to", default=0.0, wraps=True, latex=r"\psi_c")
    current_north = derived("m/s", "current, its part that flows to the north", latex="U_{c,N}")
    current_east = derived("m/s", "current, its part that flows to the east", latex="U_{c,E}")

    @current_north.equals
    def north(self):
        """Passenier (1989), eq. (2.71)."""
        return self.current_speed * np.cos(self.current_direction)

    @current_east.equals
    def east(self):
        """Passenier (1989), eq. (2.72)."""
        return self.current_speed * np.sin(self.current_direction)


class Wind(Component):
    """The yaw acceleration and the push ahead by the wind.

    The relative wind is written by its parts along and across the ship, ahead and aside, so that nothing is divided
    by a wind speed that may be zero.
    """

    wind_speed = given("m/s", "true wind speed", default=0.0, latex="V_w")
    wind_direction = given("rad", "direction the true wind blows to", default=0.0, wraps=True, latex=r"\psi_w")
    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    u = given("m/s", "forward speed through the water")
    v = given("m/s", "sway speed through the water, positive to starboard", default=0.0)
    L = constant("m", "length between perpendiculars")
    N_w = parameter(
        "rad/m^2",
        "yaw acceleration per relative wind speed squared",
        start=0.01,
        low=-0.5,
        high=0.5,
        prime=True,
        latex="N_w'",
    )
    F_w = parameter(
        "1/m^2",
        "acceleration ahead per relative wind speed squared and length",
        start=0.01,
        low=0.0,
        high=0.5,
        prime=True,
        latex="F_w'",
    )
    wind_ahead = derived("m/s", "relative wind, its part from aft to ahead", latex="V_{wr,x}")
    wind_aside = derived("m/s", "relative wind, its part from port to starboard", latex="V_{wr,y}")
    wind_relative = derived("m/s", "speed of the relative wind", latex="V_{wr}")
    wind_angle = derived("rad", "direction the relative wind blows to, from the bow", wraps=True, latex=r"\gamma_r")
    r_disturbance = derived("rad/s^2", "yaw acceleration by the wind", latex=r"\dot r_d")
    u_disturbance = derived("m/s^2", "forward acceleration by the wind", latex=r"\dot u_d")

    @wind_ahead.equals
    def ahead(self):
        """Passenier (1989), eq. (2.74), along the ship."""
        return self.wind_speed * np.cos(self.wind_direction - self.psi) - self.u

    @wind_aside.equals
    def aside(self):
        """Passenier (1989), eq. (2.74), across the ship."""
        return self.wind_speed * np.sin(self.wind_direction - self.psi) - self.v

    @wind_relative.equals
    def relative_speed(self):
        """Passenier (1989), eq. (2.74)."""
        return np.sqrt(self.wind_ahead**2 + self.wind_aside**2)

    @wind_angle.equals
    def relative_angle(self):
        """Passenier (1989), eq. (2.74)."""
        return np.arctan2(self.wind_aside, self.wind_ahead)

    @r_disturbance.equals
    def moment(self):
        """Passenier (1989), eq. (2.85) with (2.87): N_w' sin(2 gamma_r) V_wr^2."""
        return 2 * self.N_w * self.wind_ahead * self.wind_aside

    @u_disturbance.equals
    def push(self):
        """Passenier (1989), eq. (2.86) with (2.88): F_w' cos(gamma_r) V_wr^2, as an acceleration ahead.

        (2.86) prints it with a plus, which would let a wind from aft add to the loss of speed. Multiplied by L, it is
        (2.88) at u = U0; elsewhere the print, which divides by u for U0, differs by their ratio.
        """
        return self.F_w * self.L * self.wind_ahead * self.wind_relative


class Waves(Component):
    """The yaw motion by waves: white noise through a narrow filter at the frequency of encounter.

    It moves what the instruments show, and not the path. With white noise of intensity q, the variance of the
    rate by waves is q / (4 zeta omega).
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

        The frequency passes zero in following seas; its size is what counts.
        """
        omega = np.abs(self.encounter)
        damping = 2 * self.wave_damping * omega * self.r_wave
        return self.wave_noise - damping - omega**2 * self.psi_wave


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
        """Passenier (1989), eq. (5.40): both sum the same differences, so psi_v is (T/b_f) v_f for good."""
        return self.wave_time * self.v_f
