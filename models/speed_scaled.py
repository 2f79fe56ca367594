"""First-order yaw scaled by the speed, an actuator with a lag, and a moment by the measured wind.

Extensions of the models of the literature that real trials need: runs at several speeds, a log that holds the
order and not the rudder, a pond with wind.
"""

from __future__ import annotations

from shipid import Component, given, join, parameter, state
from shipid.models.bech_surge import SlipstreamYaw, Surge
from shipid.models.de_keizer import DeKeizer
from shipid.models.van_leeuwen import VanLeeuwenSway
from shipid.parts.planar_motion import PlanarMotion, SpeedScaled
from shipid.parts.wind import WindMoment


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


class CubicYawInWind(WindMoment, CubicYaw):
    """First-order yaw with a cubic damping, scaled by the measured speed, and a moment by the wind of the log."""


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
