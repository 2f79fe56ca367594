"""Linear sway and yaw with cross-flow drag, and surge: for turns that a cubic in the rate of turn does not describe.

The linear part is Pershitz's in sway speed instead of drift angle; the drag of the flow across the hull is the integral
of the local cross-flow times its size along the length, as in Norrbin (1971) and Oltmann and Sharma (1984). The
rudder force follows the slipstream as in `bech-slipstream`, and the surge is the same. Rudder, sway and rate of turn
are positive to starboard, so s21 and s31 are negative, as in `pershitz`.
"""

from __future__ import annotations

import numpy as np

from shipid import given, join, parameter, state
from shipid.models.bech_surge import Surge
from shipid.models.kinematics import PlanarMotion, SpeedScaled

#: Gauss-Legendre points along the hull, from -1/2 to 1/2 of the length, with their weights. Six of them are exact where
#: the cross-flow keeps its sign along the hull; where it changes, the moment is within 0.3 %, and the force within 0.15 %
#: of the force at the cross-flow of the faster end. The closed form divides by the rate of turn, which passes zero.
_POINTS, _WEIGHTS = (tuple((0.5 * a).tolist()) for a in np.polynomial.legendre.leggauss(6))


class CrossFlow(SpeedScaled):
    """Sway, yaw and surge with the drag of the flow across the hull, for hard turns."""

    v = state("m/s", "sway speed through the water, positive to starboard", nominal=0.5)
    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    q21 = parameter("1", "sway force per drift angle", start=0.3, low=-1.0, high=5.0, latex="q_{21}")
    r21 = parameter("1", "sway force per rate of turn", start=-0.5, low=-5.0, high=0.5, latex="r_{21}")
    s21 = parameter("1", "sway force per rudder angle", start=-0.15, low=-3.0, high=0.5, latex="s_{21}")
    q31 = parameter("1", "yaw moment per drift angle", start=-4.0, low=-20.0, high=2.0, latex="q_{31}")
    r31 = parameter("1", "yaw damping", start=2.5, low=0.01, high=20.0, latex="r_{31}")
    s31 = parameter("1", "yaw moment per rudder angle", start=-1.1, low=-10.0, high=0.0, latex="s_{31}")
    c_y = parameter("1", "cross-flow drag in sway", start=3.0, low=0.0, high=30.0, latex="c_y")
    c_z = parameter("1", "cross-flow drag in yaw", start=20.0, low=0.0, high=300.0, latex="c_z")
    m = parameter(
        "1",
        "share of the slipstream: 0 by the ship's speed, 2 by the propeller's",
        start=0.5,
        low=-0.5,
        high=2.5,
        spread=0.4,
    )

    def rudder(self):
        """Square of the speed at the rudder times its angle, by u^(2-m) U0^m."""
        return self.way**2 * (self.cruise / self.way) ** self.m * self.delta

    def drag(self, power):
        """Integral of xi^power w |w| along the hull, w the local cross-flow."""
        flow = [self.v + xi * self.L * self.r for xi in _POINTS]
        return sum(weight * xi**power * w * np.abs(w) for xi, weight, w in zip(_POINTS, _WEIGHTS, flow))

    @v.rate
    def sway(self):
        """Pershitz (1973), eq. (5) of Semerdjiev and Mihaylova (2000) for the sway speed, with cross-flow drag."""
        linear = -self.way * self.q21 * self.v + self.s21 * self.rudder() + self.r21 * self.way * self.L * self.r
        return (linear - self.c_y * self.drag(0)) / self.L

    @r.rate
    def yaw(self):
        """Pershitz (1973), eq. (4) of Semerdjiev and Mihaylova (2000) for the sway speed, with cross-flow drag."""
        linear = self.way * self.q31 * self.v - self.s31 * self.rudder() - self.r31 * self.way * self.L * self.r
        return (linear - self.c_z * self.drag(1)) / self.L**2 + self.r_disturbance


cross_flow = join("cross-flow", CrossFlow, Surge, PlanarMotion)
