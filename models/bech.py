"""Bech's model: Nomoto's second order with a cubic term, for ships of either course stability.

Bech and Wagner Smitt (1969), "Analogue simulation of ship manoeuvres"; Passenier (1989), section 2.3.1. Published as
tau1 tau2 r'' + (tau1 + tau2) r' + r + n3 r^3 = K (delta + tau3 delta'). Fitted in a form without derivatives of the
rudder whose coefficients stay finite when a pole crosses zero; the published ones follow.
"""

from __future__ import annotations

import numpy as np

from shipid import Component, derived, given, join, parameter, state
from shipid.parts.planar_motion import PlanarMotion


class Bech(Component):
    """Second-order rate of turn at one speed, poles of either sign, a lead, and a cubic damping."""

    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    w = state("rad/s^2", "yaw acceleration by earlier sway and rudder angles", nominal="0.05 deg/s^2")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    d1 = parameter(
        "1/s^2", "yaw acceleration per rudder angle", start=0.7, low=-5.0, high=20.0, prime=True, latex="d_1"
    )
    d0 = parameter(
        "1/s^3",
        "growth of the yaw acceleration per rudder angle",
        start=1.0,
        low=0.01,
        high=50.0,
        prime=True,
        latex="d_0",
    )
    c1 = parameter(
        "1/s",
        "damping: minus the sum of the poles",
        start=2.5,
        low=-5.0,
        high=50.0,
        prime=True,
        latex="c_1",
    )
    c0 = parameter(
        "1/s^2",
        "product of the poles, negative for an unstable ship",
        start=0.5,
        low=-20.0,
        high=50.0,
        prime=True,
        latex="c_0",
    )
    c3 = parameter("1/rad^2", "cubic damping", start=5.0, low=-100.0, high=1000.0, prime=True, latex="c_3")
    K = derived("1/s", "rate of turn per rudder angle at small angles")
    tau1 = derived("s", "slow time constant, negative for an unstable ship", latex=r"\tau_1")
    tau2 = derived("s", "fast time constant", latex=r"\tau_2")
    tau3 = derived("s", "lead time constant", latex=r"\tau_3")
    n3 = derived("s^2/rad^2", "cubic coefficient of the reversed spiral", latex="n_3")

    @r.rate
    def yaw(self):
        """Bech (1969), second order, as two states, so that the rudder angle is not differentiated."""
        return self.w + self.d1 * self.delta - self.c1 * self.r + self.r_disturbance

    @w.rate
    def memory(self):
        """Bech (1969), divided by tau1 tau2: the part of r'' without derivatives.

        A disturbance enters so that a steady one turns the ship as in the first-order model with
        tau = tau1 + tau2 - tau3.
        """
        first_order = self.c1 - self.c0 * self.d1 / self.d0
        return self.d0 * self.delta - self.c0 * self.r - self.c3 * self.r**3 + first_order * self.r_disturbance

    @K.equals
    def gain(self):
        """Bech (1969), in regular coefficients."""
        return self.d0 / self.c0

    @tau1.equals
    def slow(self):
        """Bech (1969): minus the inverse of the slow root of s^2 + c1 s + c0 (no number where the roots are complex)."""
        return 2 / (self.c1 - np.sqrt(self.c1**2 - 4 * self.c0))

    @tau2.equals
    def fast(self):
        """Bech (1969): minus the inverse of the fast root of s^2 + c1 s + c0 (no number where the roots are complex)."""
        return 2 / (self.c1 + np.sqrt(self.c1**2 - 4 * self.c0))

    @tau3.equals
    def lead(self):
        """Bech (1969), in regular coefficients."""
        return self.d1 / self.d0

    @n3.equals
    def cubic_coefficient(self):
        """Bech (1969), in regular coefficients."""
        return self.c3 / self.c0

    @d1.instead
    def acceleration(self):
        """Bech (1969), divided by tau1 tau2."""
        return self.tau3 * self.d0

    @d0.instead
    def growth(self):
        """Bech (1969), divided by tau1 tau2."""
        return self.K * self.c0

    @c1.instead
    def damping(self):
        """Bech (1969), divided by tau1 tau2."""
        return 1 / self.tau1 + 1 / self.tau2

    @c0.instead
    def stiffness(self):
        """Bech (1969), divided by tau1 tau2."""
        return 1 / (self.tau1 * self.tau2)

    @c3.instead
    def cubic_damping(self):
        """Bech (1969), divided by tau1 tau2."""
        return self.n3 * self.c0


bech = join("bech", Bech, PlanarMotion)
