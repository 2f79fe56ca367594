"""The wind: its yaw moment and its longitudinal force.

Passenier (1989), section 2.5. The direction is the one the wind blows TO; a wind that is reported by the direction
it comes from is converted before.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, derived, given, parameter


class Wind(Component):
    """The yaw and surge accelerations by the wind.

    The relative wind is what blows over the ship, which moves over the ground with the current. It is written by its components
    along and across the ship, so that nothing is divided by a wind speed that may be zero.
    """

    wind_speed = given("m/s", "true wind speed, over the ground", default=0.0, latex="V_w")
    wind_direction = given("rad", "direction the true wind blows to", default=0.0, wraps=True, latex=r"\psi_w")
    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    u = given("m/s", "forward speed through the water")
    v = given("m/s", "sway speed through the water, positive to starboard", default=0.0)
    current_north = given("m/s", "current, component to the north", default=0.0, latex="U_{c,N}")
    current_east = given("m/s", "current, component to the east", default=0.0, latex="U_{c,E}")
    r_residual = given("rad/s^2", "yaw acceleration by anything but the wind", default=0.0, latex=r"\dot r_{res}")
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
    wind_ahead = derived("m/s", "relative wind, component ahead", latex="V_{wr,x}")
    wind_aside = derived("m/s", "relative wind, component to starboard", latex="V_{wr,y}")
    wind_relative = derived("m/s", "speed of the relative wind", latex="V_{wr}")
    wind_angle = derived("rad", "direction the relative wind blows to, from the bow", wraps=True, latex=r"\gamma_r")
    r_disturbance = derived("rad/s^2", "yaw acceleration by the wind and by what else acts", latex=r"\dot r_d")
    u_disturbance = derived("m/s^2", "forward acceleration by the wind", latex=r"\dot u_d")

    @wind_ahead.equals
    def ahead(self):
        """Passenier (1989), eq. (2.74), along the ship; its speed over the ground includes the current."""
        drift = self.current_north * np.cos(self.psi) + self.current_east * np.sin(self.psi)
        return self.wind_speed * np.cos(self.wind_direction - self.psi) - self.u - drift

    @wind_aside.equals
    def aside(self):
        """Passenier (1989), eq. (2.74), across the ship; its speed over the ground includes the current."""
        drift = self.current_east * np.cos(self.psi) - self.current_north * np.sin(self.psi)
        return self.wind_speed * np.sin(self.wind_direction - self.psi) - self.v - drift

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
        """Passenier (1989), eq. (2.85) with (2.87): N_w' sin(2 gamma_r) V_wr^2; and what is none of the wind's."""
        return 2 * self.N_w * self.wind_ahead * self.wind_aside + self.r_residual

    @u_disturbance.equals
    def push(self):
        """Passenier (1989), eq. (2.86) with (2.88): F_w' cos(gamma_r) V_wr^2, as an acceleration ahead.

        (2.86) prints it with a plus, which would let a wind from aft add to the loss of speed. Multiplied by L, it is
        (2.88) at u = U0; elsewhere the print, which divides by u for U0, differs by their ratio.
        """
        return self.F_w * self.L * self.wind_ahead * self.wind_relative
