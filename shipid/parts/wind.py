"""The wind: its yaw moment, its forces ahead and to the side, and the leeway.

Passenier (1989), section 2.5. The direction is the one the wind blows TO; a wind that is reported by the direction
it comes from is converted before.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, derived, given, parameter
from shipid.foundation.aliases import Expression


class RelativeWind(Component):
    """The wind over the ship.

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
    wind_ahead = derived("m/s", "relative wind, component ahead", latex="V_{wr,x}")
    wind_aside = derived("m/s", "relative wind, component to starboard", latex="V_{wr,y}")
    wind_relative = derived("m/s", "speed of the relative wind", latex="V_{wr}")
    wind_angle = derived("rad", "direction the relative wind blows to, from the bow", wraps=True, latex=r"\gamma_r")

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

    def blowing(self, acceleration: Expression) -> Expression:
        """Return what the wind does to the ship; as published, the air that she moves through in a calm as well.

        Parameters
        ----------
        acceleration : Expression
            By the relative wind.
        """
        return acceleration

    @wind_relative.equals
    def relative_speed(self):
        """Passenier (1989), eq. (2.74)."""
        return np.sqrt(self.wind_ahead**2 + self.wind_aside**2)

    @wind_angle.equals
    def relative_angle(self):
        """Passenier (1989), eq. (2.74)."""
        return np.arctan2(self.wind_aside, self.wind_ahead)


class LoggedWind(RelativeWind):
    """The wind of a log: none acts in a calm.

    The hull's coefficients hold what the air does to her own motion; a log without a wind would not tell the two apart.
    """

    def blowing(self, acceleration: Expression) -> Expression:
        """Return what the wind does to the ship; nothing in a calm.

        Parameters
        ----------
        acceleration : Expression
            By the relative wind.
        """
        return np.where(self.wind_speed > 0, acceleration, 0 * acceleration)


class PushedByWind(RelativeWind):
    """The surge acceleration by the wind.

    The prior is wide: a model whose speed follows its turns within some ship lengths needs ten times the push of the real one to lose
    as much speed.
    """

    L = constant("m", "length between perpendiculars")
    F_w = parameter(
        "1/m^2",
        "acceleration ahead per relative wind speed squared and length",
        start=0.01,
        low=0.0,
        high=0.5,
        spread=0.02,
        prime=True,
        latex="F_w'",
    )
    u_disturbance = derived("m/s^2", "forward acceleration by the wind", latex=r"\dot u_d")

    @u_disturbance.equals
    def push(self):
        """Passenier (1989), eq. (2.86) with (2.88): F_w' cos(gamma_r) V_wr^2, as an acceleration ahead.

        (2.86) prints it with a plus, which would let a wind from aft add to the loss of speed. Multiplied by L, it is
        (2.88) at u = U0; elsewhere the print, which divides by u for U0, differs by their ratio.
        """
        return self.blowing(self.F_w * self.L * self.wind_ahead * self.wind_relative)


class TurnedByWind(RelativeWind):
    """The yaw acceleration by the wind."""

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
    r_disturbance = derived("rad/s^2", "yaw acceleration by the wind and by what else acts", latex=r"\dot r_d")

    @r_disturbance.equals
    def moment(self):
        """Passenier (1989), eq. (2.85) with (2.87): N_w' sin(2 gamma_r) V_wr^2; and what is none of the wind's."""
        return self.blowing(2 * self.N_w * self.wind_ahead * self.wind_aside) + self.r_residual


class Wind(TurnedByWind, PushedByWind):
    """The yaw and surge accelerations by the wind."""


class LateralWind(RelativeWind):
    """The sway acceleration by the wind, for a model that states the sway speed by a rate; it joins beside `Wind`."""

    L = constant("m", "length between perpendiculars")
    Y_w = parameter(
        "1/m^2",
        "acceleration to the side per relative wind speed squared and length",
        start=0.03,
        low=0.0,
        high=1.0,
        prime=True,
        latex="Y_w'",
    )
    v_disturbance = derived("m/s^2", "sway acceleration by the wind", latex=r"\dot v_d")

    @v_disturbance.equals
    def push_aside(self):
        """Passenier (1989), eq. (2.76) with (2.79) and (2.83): a_y sin(gamma_r) V_wr^2, divided by the mass."""
        return self.blowing(self.Y_w * self.L * self.wind_aside * self.wind_relative)


class WindPush(LoggedWind, PushedByWind):
    """The push of `Wind`, for a model whose log has the wind."""


class WindMoment(LoggedWind, TurnedByWind):
    """The moment of `Wind`, and that of a lateral area before or abaft midships: for a model whose log has the wind.

    The prior is 0.01: a moment coefficient of 0.1 to 0.25, equal lateral areas above and below the water, the densities of air and
    water, and a ship's moment of inertia.
    """

    N_w = parameter(
        "rad/m^2",
        "yaw acceleration per relative wind speed squared, second harmonic of its angle",
        start=0.0,
        low=-0.5,
        high=0.5,
        spread=0.01,
        nominal=0.002,
        prime=True,
        latex="N_w'",
    )
    N_w1 = parameter(
        "rad/m^2",
        "yaw acceleration per relative wind speed squared, first harmonic of its angle",
        start=0.0,
        low=-0.5,
        high=0.5,
        spread=0.01,
        nominal=0.002,
        prime=True,
        latex="N_{w1}'",
    )
    same_at_any_loading = ("N_w", "N_w1")

    def moment(self):
        """Passenier (1989), eq. (2.85) with (2.87), and a first harmonic, which (2.87) leaves out: N_w1' sin(gamma_r) V_wr^2."""
        levered = self.N_w1 * self.wind_aside * self.wind_relative
        return self.blowing(2 * self.N_w * self.wind_ahead * self.wind_aside + levered) + self.r_residual


class WindForces(LoggedWind, PushedByWind, LateralWind):
    """Forward and sway acceleration by the wind, beside `WindMoment`, for a model that states both speeds by their rates.

    They push the ship along her track: in a slow turn as far as the water does. Force coefficients of 0.7 ahead and 0.8 aside, above the water
    half the lateral area and as much frontal area as below it, give a full hull 0.0005 and 0.001. The priors, this project's own, begin at
    twice as much and are ten and five times as wide as these, for ships with more windage. A wind does not push a ship against itself, so
    neither is negative.
    """

    F_w = parameter(
        "1/m^2",
        "acceleration ahead per relative wind speed squared and length",
        start=0.001,
        low=0.0,
        high=0.5,
        spread=0.005,
        prime=True,
        latex="F_w'",
    )
    Y_w = parameter(
        "1/m^2",
        "acceleration to the side per relative wind speed squared and length",
        start=0.002,
        low=0.0,
        high=1.0,
        spread=0.005,
        prime=True,
        latex="Y_w'",
    )


class Leeway(Component):
    """The sway speed by the wind, for a model whose sway follows at once: the wind's side force and the hull's balance.

    The sway itself is left out of the relative wind, beside which it is small; with it the balance would be an equation to solve.
    """

    wind_speed = given("m/s", "true wind speed, over the ground", default=0.0, latex="V_w")
    wind_direction = given("rad", "direction the true wind blows to", default=0.0, wraps=True, latex=r"\psi_w")
    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    u = given("m/s", "forward speed through the water")
    cruise = given("m/s", "cruising speed, the speed before the manoeuvre", latex="U_0")
    current_north = given("m/s", "current, component to the north", default=0.0, latex="U_{c,N}")
    current_east = given("m/s", "current, component to the east", default=0.0, latex="U_{c,E}")
    k_w = parameter(
        "1", "leeway angle in a beam wind of the ship's own speed", start=0.002, low=0.0, high=0.1, latex="k_w"
    )
    v_leeway = derived("m/s", "sway speed by the wind", latex="v_w")

    @v_leeway.equals
    def settled(self):
        """Passenier (1989), eq. (2.76) with (2.83) at rest: a_y sin(gamma_r) V_wr^2 against a hull force in proportion to u v.

        Below a fifth of the cruise that hull force is none, and the speed to divide by is that fifth.
        """
        drift_ahead = self.current_north * np.cos(self.psi) + self.current_east * np.sin(self.psi)
        drift_aside = self.current_east * np.cos(self.psi) - self.current_north * np.sin(self.psi)
        ahead = self.wind_speed * np.cos(self.wind_direction - self.psi) - self.u - drift_ahead
        aside = self.wind_speed * np.sin(self.wind_direction - self.psi) - drift_aside
        return self.k_w * aside * np.sqrt(ahead**2 + aside**2) / np.maximum(self.u, 0.2 * self.cruise)


class WindHarmonics(RelativeWind):
    """The accelerations by the wind from harmonics of its relative angle, in the place of `Wind`.

    A ship is the same to both sides: the force ahead has cosines, the force to the side and the moment have sines. Three harmonics
    fit the measured curves of Wagner (1967) and Blendermann (1994); each coefficient is in the prime system, per wind speed squared.
    """

    r_residual = given("rad/s^2", "yaw acceleration by anything but the wind", default=0.0, latex=r"\dot r_{res}")
    L = constant("m", "length between perpendiculars")
    least = constant("m/s", "wind speed below which the third harmonics fade", default="0.01 m/s")
    a_x0 = parameter("1", "force ahead by the wind, mean", start=0.0, low=-1.0, high=1.0, latex="a_{x0}")
    a_x1 = parameter("1", "force ahead by the wind, first harmonic", start=0.0, low=-1.0, high=1.0, latex="a_{x1}")
    a_x2 = parameter("1", "force ahead by the wind, second harmonic", start=0.0, low=-1.0, high=1.0, latex="a_{x2}")
    a_x3 = parameter("1", "force ahead by the wind, third harmonic", start=0.0, low=-1.0, high=1.0, latex="a_{x3}")
    b_y1 = parameter(
        "1", "force to the side by the wind, first harmonic", start=0.0, low=-1.0, high=1.0, latex="b_{y1}"
    )
    b_y2 = parameter(
        "1", "force to the side by the wind, second harmonic", start=0.0, low=-1.0, high=1.0, latex="b_{y2}"
    )
    b_y3 = parameter(
        "1", "force to the side by the wind, third harmonic", start=0.0, low=-1.0, high=1.0, latex="b_{y3}"
    )
    b_n1 = parameter("1", "yaw moment by the wind, first harmonic", start=0.0, low=-1.0, high=1.0, latex="b_{n1}")
    b_n2 = parameter("1", "yaw moment by the wind, second harmonic", start=0.0, low=-1.0, high=1.0, latex="b_{n2}")
    b_n3 = parameter("1", "yaw moment by the wind, third harmonic", start=0.0, low=-1.0, high=1.0, latex="b_{n3}")
    u_disturbance = derived("m/s^2", "forward acceleration by the wind", latex=r"\dot u_d")
    v_disturbance = derived("m/s^2", "sway acceleration by the wind", latex=r"\dot v_d")
    r_disturbance = derived("rad/s^2", "yaw acceleration by the wind and by what else acts", latex=r"\dot r_d")

    @property
    def cosines(self):
        """V_wr^2 cos(k gamma_r) for k of 1 to 3, by the components of the relative wind."""
        ahead, aside, speed = self.wind_ahead, self.wind_aside, self.wind_relative
        cube = ahead * (ahead**2 - 3 * aside**2)
        return ahead * speed, ahead**2 - aside**2, cube / np.maximum(speed, self.least)

    @property
    def sines(self):
        """V_wr^2 sin(k gamma_r) for k of 1 to 3."""
        ahead, aside, speed = self.wind_ahead, self.wind_aside, self.wind_relative
        cube = aside * (3 * ahead**2 - aside**2)
        return aside * speed, 2 * ahead * aside, cube / np.maximum(speed, self.least)

    @u_disturbance.equals
    def ahead_by_wind(self):
        """Passenier (1989), eq. (2.75) with (2.78) and (2.81)."""
        first, second, third = self.cosines
        still = self.a_x0 * self.wind_relative**2
        return (still + self.a_x1 * first + self.a_x2 * second + self.a_x3 * third) / self.L

    @v_disturbance.equals
    def aside_by_wind(self):
        """Passenier (1989), eq. (2.76) with (2.79) and (2.81)."""
        first, second, third = self.sines
        return (self.b_y1 * first + self.b_y2 * second + self.b_y3 * third) / self.L

    @r_disturbance.equals
    def turned_by_wind(self):
        """Passenier (1989), eq. (2.77) with (2.80) and (2.81)."""
        first, second, third = self.sines
        return (self.b_n1 * first + self.b_n2 * second + self.b_n3 * third) / self.L**2 + self.r_residual
