"""Norrbin's model: Nomoto's first order with a cubic term, for large rudder angles and unstable ships.

Norrbin (1963), "On the design and analysis of the zig-zag test"; Passenier (1989), eq. (2.25) and (2.28).
Published as tau r' + n1 r + n3 r^3 = K delta with n1 = 1. That form is singular for a ship on the edge of course
stability, where tau and K run to infinity, so the model is fitted in its regular form; K, tau and n3 follow.
"""

from __future__ import annotations

from shipid import Component, derived, given, join, parameter, state
from shipid.parts.planar_motion import PlanarMotion


class Norrbin(Component):
    """First-order rate of turn at one speed with a cubic damping; an unstable ship has K < 0 and tau < 0, as n1 is 1."""

    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    a = parameter("1/s^2", "yaw acceleration per rudder angle, K/tau", start=0.7, low=0.01, high=20.0, prime=True)
    b1 = parameter("1/s", "linear damping, 1/tau", start=0.6, low=-5.0, high=20.0, prime=True, latex="b_1")
    b3 = parameter("s/rad^2", "cubic damping, n3/tau", start=1.0, low=-50.0, high=200.0, prime=True, latex="b_3")
    K = derived("1/s", "rate of turn per rudder angle at small angles")
    tau = derived("s", "time constant of yaw at small angles", latex=r"\tau")
    n3 = derived("s^2/rad^2", "cubic coefficient of the reversed spiral", latex="n_3")

    @r.rate
    def yaw(self):
        """Norrbin (1963); Passenier (1989), eq. (2.25) with (2.28), divided by tau."""
        return self.a * self.delta - self.b1 * self.r - self.b3 * self.r**3 + self.r_disturbance

    @K.equals
    def gain(self):
        """Passenier (1989), eq. (2.25), in regular coefficients."""
        return self.a / self.b1

    @tau.equals
    def time_constant(self):
        """Passenier (1989), eq. (2.25), in regular coefficients."""
        return 1 / self.b1

    @n3.equals
    def cubic_coefficient(self):
        """Norrbin (1963), in regular coefficients."""
        return self.b3 / self.b1

    @a.instead
    def acceleration(self):
        """Passenier (1989), eq. (2.25), divided by tau."""
        return self.K * self.b1

    @b1.instead
    def linear_damping(self):
        """Passenier (1989), eq. (2.25), divided by tau."""
        return 1 / self.tau

    @b3.instead
    def cubic_damping(self):
        """Norrbin (1963), divided by tau."""
        return self.n3 * self.b1


norrbin = join("norrbin", Norrbin, PlanarMotion)
