"""First-order yaw scaled by the speed, an actuator with a lag, and a moment by the measured wind.

Extensions of the models of the literature that real trials need: runs at several speeds, a log that holds the
order and not the rudder, a pond with wind.
"""

from __future__ import annotations

import numpy as np

from shipid import Component, constant, derived, given, join, parameter, state
from shipid.models.bech_surge import SlipstreamYaw, Surge
from shipid.models.de_keizer import DeKeizer
from shipid.models.van_leeuwen import VanLeeuwenSway
from shipid.parts.planar_motion import PlanarMotion, SpeedScaled


class CubicYaw(SpeedScaled):
    """First-order yaw with a cubic damping, scaled by the measured speed: one set of coefficients for several speeds."""

    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    a = parameter("1", "yaw acceleration per rudder angle", start=0.7, low=0.01, high=20.0, dimensional="1/s^2")
    b1 = parameter("1", "linear damping", start=0.6, low=-5.0, high=20.0, dimensional="1/s", latex="b_1")
    b3 = parameter("1", "cubic damping", start=1.0, low=-50.0, high=200.0, dimensional="s/rad^2", latex="b_3")

    @r.rate
    def yaw(self):
        """Norrbin (1963), divided by tau; scaled by L/u as in Passenier (1989), eq. (2.61)."""
        pace = self.way / self.L
        damping = self.b1 * pace * self.r + self.b3 * self.r**3 / pace
        return pace**2 * self.a * self.rudder() - damping + self.r_disturbance

    def rudder(self):
        """Rudder angle that acts: the recorded one."""
        return self.delta


class WindMoment(Component):
    """Yaw acceleration by the true wind, two harmonics of its direction.

    The prior is 0.004: a moment coefficient of 0.1, equal lateral areas above and below the water, the densities of air and
    water, and a ship's moment of inertia.

    It states the yaw disturbance, so it joins with any model of yaw in the place of `Wind`, which reads the relative
    wind and has a longitudinal force as well.
    """

    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    wind_speed = given("m/s", "true wind speed", default=0.0, latex="V_w")
    wind_direction = given("rad", "direction the true wind blows to", default=0.0, wraps=True, latex=r"\psi_w")
    r_residual = given("rad/s^2", "yaw acceleration by anything but the wind", default=0.0, latex=r"\dot r_{res}")
    L = constant("m", "length between perpendiculars")
    w1 = parameter(
        "1",
        "first harmonic of the wind moment",
        start=0.0,
        low=-0.1,
        high=0.1,
        spread=0.004,
        nominal=0.002,
        latex="w_1",
    )
    w2 = parameter(
        "1",
        "second harmonic of the wind moment",
        start=0.0,
        low=-0.1,
        high=0.1,
        spread=0.004,
        nominal=0.002,
        latex="w_2",
    )
    same_at_any_loading = ("w1", "w2")
    r_disturbance = derived("rad/s^2", "yaw acceleration by the wind and by what else acts", latex=r"\dot r_d")

    @r_disturbance.equals
    def moment(self):
        """The second harmonic of Passenier (1989), eq. (2.87), and a first one, both of the true wind.

        The first harmonic is the lever of the lateral area before or abaft midships. With the direction the wind comes
        from, w1 would change its sign, and w2 would not.
        """
        angle = self.wind_direction - self.psi
        wind = (self.wind_speed / self.L) ** 2 * (self.w1 * np.sin(angle) + self.w2 * np.sin(2 * angle))
        return wind + self.r_residual


class WindForces(Component):
    """Forward and sway acceleration by the true wind, beside `WindMoment`, for a model that states both speeds by their rates.

    They push the ship along her track: in a slow turn as far as the water does. The priors are
    this project's own estimate: force coefficients of 0.7 ahead and 0.8 aside, above the water half the lateral area and as much frontal area
    as below it, for a full hull, each as uncertain as it is large. A wind does not push a ship against itself, so neither is negative.
    """

    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    wind_speed = given("m/s", "true wind speed", default=0.0, latex="V_w")
    wind_direction = given("rad", "direction the true wind blows to", default=0.0, wraps=True, latex=r"\psi_w")
    L = constant("m", "length between perpendiculars")
    w_x = parameter("1", "surge force of the wind", start=0.0005, low=0.0, high=0.02, spread=0.0005, latex="w_x")
    w_y = parameter("1", "sway force of the wind", start=0.001, low=0.0, high=0.02, spread=0.001, latex="w_y")
    u_disturbance = derived("m/s^2", "forward acceleration by the wind", latex=r"\dot u_d")
    v_disturbance = derived("m/s^2", "sway acceleration by the wind", latex=r"\dot v_d")

    @u_disturbance.equals
    def push_ahead(self):
        """Passenier (1989), eq. (2.88), of the true wind."""
        return self.wind_speed**2 / self.L * self.w_x * np.cos(self.wind_direction - self.psi)

    @v_disturbance.equals
    def push_aside(self):
        """Passenier (1989), eq. (2.76) with (2.79) and (2.83), of the true wind, divided by the mass."""
        return self.wind_speed**2 / self.L * self.w_y * np.sin(self.wind_direction - self.psi)


class CubicYawInWind(WindMoment, CubicYaw):
    """First-order yaw with a cubic damping, scaled by the measured speed, and a moment by the true wind of the log."""


class ActuatorLag(Component):
    """An actuator with a lag: for a log that holds only the order."""

    delta = given("rad", "rudder angle that is ordered, positive turns to starboard", latex=r"\delta")
    delta_lagged = state("rad", "angle the actuator has reached", nominal="10 deg", latex=r"\delta_l")
    # In seconds: the lag of an actuator does not depend on the ship's speed, and runs at two speeds showed one lag in
    # seconds and not one in ship lengths. Below the bound, Runge-Kutta steps of half a second are unstable.
    t_delta = parameter("s", "lag of the actuator", start=1.0, low=0.25, high=20.0, spread=1.0, latex=r"\tau_\delta")
    same_at_any_loading = ("t_delta",)

    @delta_lagged.rate
    def actuator(self):
        """First-order lag: the simplest form of the steering machine of Passenier (1989), section 2.3.4."""
        return (self.delta - self.delta_lagged) / self.t_delta


class CubicYawLag(CubicYaw, ActuatorLag):
    """First-order yaw with a cubic damping, scaled by the measured speed, behind an actuator with a lag."""

    def rudder(self):
        """Rudder angle that acts: what the actuator has reached."""
        return self.delta_lagged


class DeKeizerLag(DeKeizer, ActuatorLag):
    """Yaw with a cubic damping, and surge, behind an actuator with a lag."""

    def yaw(self):
        """De Keizer (1977); Passenier (1989), eq. (2.54), with the rudder the actuator has reached."""
        pace = self.way / self.L
        return pace**2 * (self.K * self.delta_lagged - self.yaw_feedback()) / self.tau + self.r_disturbance


class SlipstreamYawLag(SlipstreamYaw, ActuatorLag):
    """Second-order yaw with a rudder in the slipstream, behind an actuator with a lag."""

    def rudder(self):
        """Effective rudder angle that the actuator has reached: its force is proportional to u^(2-m) U0^m."""
        return self.delta_lagged * (self.cruise / self.way) ** self.m


cubic = join("cubic", CubicYaw, VanLeeuwenSway, PlanarMotion)
cubic_wind = join("cubic-wind", CubicYawInWind, VanLeeuwenSway, PlanarMotion)
de_keizer_lag = join("de-keizer-lag", DeKeizerLag, VanLeeuwenSway, PlanarMotion)
cubic_lag = join("cubic-lag", CubicYawLag, VanLeeuwenSway, PlanarMotion)
bech_slipstream_lag = join("bech-slipstream-lag", SlipstreamYawLag, Surge, VanLeeuwenSway, PlanarMotion)
