"""Nomoto's models: the rate of turn as a linear filter of the rudder, at one speed.

Nomoto et al. (1957), "On the steering qualities of ships"; the first-order form as in Passenier (1989), eq. (2.22).
A course-unstable ship has negative time constants, which a search from positive ones reaches only through infinity:
fit such a ship with `norrbin` or `bech`, whose coefficients pass through zero.
"""

from __future__ import annotations

from shipid import Component, given, join, parameter, state
from shipid.parts.planar_motion import PlanarMotion


class Nomoto(Component):
    """First-order rate of turn at one speed."""

    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    K = parameter("1/s", "rate of turn per rudder angle", start=1.0, low=0.02, high=50.0, prime=True)
    tau = parameter("s", "time constant of yaw", start=1.5, low=0.02, high=50.0, prime=True, latex=r"\tau")

    @r.rate
    def yaw(self):
        """Nomoto et al. (1957); Passenier (1989), eq. (2.22), with a disturbance added to the acceleration."""
        return (self.K * self.delta - self.r) / self.tau + self.r_disturbance


class NomotoSecondOrder(Component):
    """Second-order rate of turn at one speed, with the lead of the sway that the rudder starts.

    K (1 + tau3 s) / ((1 + tau1 s) (1 + tau2 s)), in a form that needs no derivative of the rudder.
    """

    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    w = state("rad/s^2", "yaw acceleration by earlier sway and rudder angles", nominal="0.05 deg/s^2")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    K = parameter("1/s", "rate of turn per rudder angle", start=1.0, low=0.02, high=50.0, prime=True)
    tau1 = parameter("s", "slow time constant", start=2.0, low=0.3, high=50.0, prime=True, latex=r"\tau_1")
    tau2 = parameter("s", "fast time constant", start=0.4, low=0.01, high=1.0, prime=True, latex=r"\tau_2")
    tau3 = parameter("s", "lead time constant", start=0.8, low=0.0, high=10.0, prime=True, latex=r"\tau_3")

    @r.rate
    def yaw(self):
        """Nomoto et al. (1957), second order, as two states, so that the rudder angle is not differentiated."""
        fast = self.tau1 * self.tau2
        lead = self.K * self.tau3 * self.delta / fast
        return self.w + lead - (self.tau1 + self.tau2) * self.r / fast + self.r_disturbance

    @w.rate
    def memory(self):
        """Nomoto et al. (1957), second order: the part of r'' without derivatives.

        A disturbance enters so that a steady one turns the ship as in the first-order model with
        tau = tau1 + tau2 - tau3.
        """
        first_order = self.tau1 + self.tau2 - self.tau3
        return (self.K * self.delta - self.r + first_order * self.r_disturbance) / (self.tau1 * self.tau2)


nomoto = join("nomoto", Nomoto, PlanarMotion)
nomoto_second_order = join("nomoto-second-order", NomotoSecondOrder, PlanarMotion)
