"""De Keizer's model in dimensional coefficients, and the schedule that makes them follow the speed.

Passenier (1989), eq. (2.58)-(2.63). The schedule is a component of its own, so the same equations run with a gain
schedule, or with coefficients that come from elsewhere. With the schedule the model is De Keizer's minimal one.
"""

from __future__ import annotations

from shipid import Component, derived, given, join, parameter, state
from shipid.parts.planar_motion import PlanarMotion, SpeedScaled


class GainSchedule(SpeedScaled):
    """The dimensional coefficients that belong to the present speed."""

    K_star = parameter("1", "yaw gain K*", start=1.0, low=0.05, high=50.0, dimensional="1/s", latex="K^*")
    tau_star = parameter(
        "1", "yaw time constant tau*", start=1.5, low=0.05, high=50.0, dimensional="s", latex=r"\tau^*"
    )
    K_u_star = parameter(
        "1",
        "share of the speed lost per r* squared",
        start=0.8,
        low=0.01,
        high=20.0,
        dimensional="s^2/rad^2",
        latex="K_u^*",
    )
    tau_u_star = parameter(
        "1", "time constant of the speed", start=2.5, low=0.05, high=50.0, dimensional="s", latex=r"\tau_u^*"
    )
    gamma_star = parameter(
        "1",
        "sway constant gamma*: sway to port in a turn to starboard",
        start=0.45,
        low=-2.0,
        high=5.0,
        dimensional="m/rad",
        latex=r"\gamma^*",
    )
    K = derived("1/s", "rate of turn per rudder angle")
    tau = derived("s", "time constant of yaw", latex=r"\tau")
    K_u = derived("s^2/rad^2", "share of the speed lost per rate of turn squared")
    tau_u = derived("s", "time constant of the speed", latex=r"\tau_u")
    gamma = derived("m/rad", "sway speed per rate of turn", latex=r"\gamma")

    @K.equals
    def yaw_gain(self):
        """Passenier (1989), eq. (2.61)."""
        return self.K_star * self.way / self.L

    @tau.equals
    def yaw_time(self):
        """Passenier (1989), eq. (2.61)."""
        return self.tau_star * self.L / self.way

    @K_u.equals
    def speed_gain(self):
        """Passenier (1989), eq. (2.62)."""
        return self.K_u_star * (self.L / self.way) ** 2 * self.way_left

    @tau_u.equals
    def speed_time(self):
        """Passenier (1989), eq. (2.62)."""
        return self.tau_u_star * self.L / self.way

    @gamma.equals
    def sway_gain(self):
        """Passenier (1989), eq. (2.63)."""
        return self.gamma_star * self.L


class ScheduledShip(Component):
    """Yaw, surge and sway with coefficients given from outside."""

    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    u = state("m/s", "forward speed through the water", nominal=1.0)
    v = derived("m/s", "sway speed through the water, positive to starboard")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    cruise = given("m/s", "cruising speed, the speed before the manoeuvre", latex="U_0")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    u_disturbance = given(
        "m/s^2", "forward acceleration by wind or another disturbance", default=0.0, latex=r"\dot u_d"
    )
    K = given("1/s", "rate of turn per rudder angle")
    tau = given("s", "time constant of yaw", latex=r"\tau")
    K_u = given("s^2/rad^2", "share of the speed lost per rate of turn squared")
    tau_u = given("s", "time constant of the speed", latex=r"\tau_u")
    gamma = given("m/rad", "sway speed per rate of turn", latex=r"\gamma")

    @r.rate
    def yaw(self):
        """Passenier (1989), eq. (2.58)."""
        return (self.K * self.delta - self.r) / self.tau + self.r_disturbance

    @u.rate
    def surge(self):
        """Passenier (1989), eq. (2.59), read as tau_u du*/dt + u* = K_u r^2 with u = U0 (1 - u*).

        The print has du/dt, with which neither the sign nor the dimension is right.
        """
        lost = (self.cruise - self.u) / self.cruise
        return -self.cruise * (self.K_u * self.r**2 - lost) / self.tau_u + self.u_disturbance

    @v.equals
    def sway(self):
        """Passenier (1989), eq. (2.60)."""
        return -self.gamma * self.r


gain_scheduled = join("gain-scheduled", ScheduledShip, GainSchedule, PlanarMotion)
