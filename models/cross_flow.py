"""Linear sway and yaw with cross-flow drag, and surge: from small zig-zags to hard turns with one set of coefficients.

The linear part is Pershitz's in sway speed instead of drift angle; the drag of the flow across the hull is the integral
of the local cross-flow along the length, as in Norrbin (1971) and Oltmann and Sharma (1984), with a factor of this
project's own, w^3 / sqrt(w^2 + w_0^2 u^2), in the place of |w| w: the drag of a section builds up along the hull. Rudder, sway and rate of
turn are positive to starboard, so s21 and s31 are negative, as in `pershitz`.

One or two zig-zags do not separate the linear part from the drag: a model that is too unstable and has too much drag fits
them as well, but is wrong at other amplitudes. Therefore the coefficients have priors (``spread``): linear
derivatives as the regressions of Clarke, Gedling and Hine (1982) give them for hulls from container ship to tanker, whose
scatter is about the spread; a drag coefficient of the section near 1; slipstream and loss of speed as Yasukawa and Yoshimura
(2015) print them for KVLCC2. Turned into the coefficients here, all divided by masses that include the added ones.
"""

from __future__ import annotations

import numpy as np

from shipid import constant, given, join, parameter, state
from shipid.parts.planar_motion import PlanarMotion, SpeedScaled
from shipid.parts.wind import WindForces, WindMoment

#: Gauss-Legendre points along the hull, from -1/2 to 1/2 of the length, with their weights. For a full drag six of them
#: are exact where the cross-flow keeps its sign along the hull; where it changes, the moment is within 0.3 %, and the force
#: within 0.15 % of the force at the cross-flow of the faster end. The closed form divides by the rate of turn, which passes
#: zero.
_POINTS, _WEIGHTS = (tuple((0.5 * a).tolist()) for a in np.polynomial.legendre.leggauss(6))


class CrossFlow(SpeedScaled):
    """Sway, yaw and surge with the drag of the flow across the hull."""

    u = state("m/s", "forward speed through the water", nominal=1.0)
    v = state("m/s", "sway speed through the water, positive to starboard", nominal=0.5)
    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    delta_lagged = state("rad", "rudder angle behind the lag of its force", nominal="10 deg", latex=r"\delta_l")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    u_disturbance = given(
        "m/s^2", "forward acceleration by wind or another disturbance", default=0.0, latex=r"\dot u_d"
    )
    v_disturbance = given("m/s^2", "sway acceleration by wind or another disturbance", default=0.0, latex=r"\dot v_d")
    q21 = parameter("1", "sway force per drift angle", start=0.55, low=0.0, high=5.0, spread=0.1, latex="q_{21}")
    r21 = parameter("1", "sway force per rate of turn", start=-0.33, low=-5.0, high=0.0, spread=0.1, latex="r_{21}")
    s21 = parameter("1", "sway force per rudder angle", start=-0.15, low=-3.0, high=0.0, latex="s_{21}")
    q31 = parameter("1", "yaw moment per drift angle", start=-4.2, low=-20.0, high=0.0, spread=0.7, latex="q_{31}")
    r31 = parameter("1", "yaw damping", start=1.8, low=0.01, high=20.0, spread=0.35, latex="r_{31}")
    s31 = parameter("1", "yaw moment per rudder angle", start=-1.1, low=-10.0, high=0.0, latex="s_{31}")
    c_y = parameter("1", "cross-flow drag in sway", start=2.5, low=0.0, high=30.0, spread=0.8, latex="c_y")
    c_z = parameter("1", "cross-flow drag in yaw", start=35.0, low=0.0, high=300.0, spread=12.0, latex="c_z")
    m = parameter(
        "1",
        "exponent of the slipstream: rudder force by u^(2-m) U0^m",
        start=1.3,
        low=-0.5,
        high=2.5,
        spread=0.3,
    )
    # In seconds, as the lag of an actuator does not depend on the speed; bounds in L/U. Below the lowest, steps of a
    # tenth of L/U would be unstable, and the flow past rudder and stern needs about that long to build up a force.
    t_delta = parameter(
        "s",
        "lag of the rudder's force behind the recorded angle, or order",
        start=0.06,
        low=0.04,
        high=3.0,
        spread=0.1,
        prime=True,
        latex=r"\tau_\delta",
    )
    # Spread 1.7 degrees: every helmsman would notice a propeller that needs more rudder.
    delta_p = parameter(
        "rad",
        "rudder angle equivalent to the propeller's side force, per U0/u - 1",
        start=0.0,
        low=-0.3,
        high=0.3,
        spread=0.03,
        nominal=0.01,
        latex=r"\delta_p",
    )
    same_at_any_loading = ("m", "t_delta", "delta_p")
    X0 = parameter("1", "resistance and thrust", start=0.06, low=0.002, high=2.0, latex="X_0")
    X_vr = parameter("1", "resistance of the turn", start=1.65, low=0.0, high=20.0, spread=0.12, latex="X_{vr}")
    w_0 = constant(
        "1",
        "cross-flow over forward speed at which the drag is 0.7 of its full value (this project's own)",
        default=0.4,
    )
    k_T = constant("1", "relative growth of the thrust per relative loss of speed", default=0.8)
    k_delta = constant(
        "1/rad", "drag of the rudder over its side force, per rudder angle", default=0.77, latex=r"k_\delta"
    )

    def rudder(self):
        """Square of the speed at the rudder times its angle, by u^(2-m) U0^m, with the propeller's side force."""
        slowed = self.cruise / self.way
        return self.way**2 * slowed**self.m * (self.delta_lagged + self.delta_p * (slowed - 1))

    def drag(self, power):
        """Integral of xi^power |w| w along the hull, w the local cross-flow, where it is fast enough.

        The drag of a section grows with the distance that the flow has moved across it, which is w/u times the distance from
        the bow (the impulsively started cylinder of Sarpkaya, 1966). So it is proportional to w^3 where w/u is small, as in
        the cubic models, and to |w| w where it is large. The factor w^3 / sqrt(w^2 + w_0^2 u^2) that joins the two, and its w_0,
        are this project's own: no publication gives them.

        Parameters
        ----------
        power : {0, 1}
            Of the distance along the hull: 0 for the side force, 1 for the yaw moment.
        """
        flow = [self.v + xi * self.L * self.r for xi in _POINTS]
        late = (self.w_0 * self.way) ** 2
        # At rest, cross-flow and speed are both zero: the small number avoids 0/0, in the derivatives too.
        least = (1e-9 * self.cruise) ** 2
        return sum(
            weight * xi**power * w**3 / np.sqrt(w**2 + late + least) for xi, weight, w in zip(_POINTS, _WEIGHTS, flow)
        )

    @delta_lagged.rate
    def actuator(self):
        """First-order lag: the simplest form of the steering machine of Passenier (1989), section 2.3.4."""
        return (self.delta - self.delta_lagged) / self.t_delta

    @v.rate
    def sway(self):
        """Pershitz (1973), eq. (5) of Semerdjiev and Mihaylova (2000) for the sway speed; cross-flow drag by a factor of this project's own."""
        linear = -self.way * self.q21 * self.v + self.s21 * self.rudder() + self.r21 * self.way * self.L * self.r
        return (linear - self.c_y * self.drag(0)) / self.L + self.v_disturbance

    @r.rate
    def yaw(self):
        """Pershitz (1973), eq. (4) of Semerdjiev and Mihaylova (2000) for the sway speed; cross-flow drag by a factor of this project's own."""
        linear = self.way * self.q31 * self.v - self.s31 * self.rudder() - self.r31 * self.way * self.L * self.r
        return (linear - self.c_z * self.drag(1)) / self.L**2 + self.r_disturbance

    @u.rate
    def surge(self):
        """Thrust at constant revolutions, resistance, rudder drag, and X_vr v r of Norrbin (1971).

        The thrust grows as the ship slows and the resistance falls with the square of the speed. Below a twentieth of the cruising
        speed the resistances of hull and turn are in proportion to the speed, as in `bech_surge`.
        """
        thrust = self.cruise**2 + self.k_T * self.cruise * (self.cruise - self.u)
        balance = self.X0 * (thrust - self.u * self.way)
        turn = self.X_vr * self.v * self.r * self.L + self.k_delta * self.s21 * self.rudder() * self.delta_lagged
        return (balance + turn * self.way_left) / self.L + self.u_disturbance


class CrossFlowInWind(CrossFlow):
    """Sway, yaw and surge with cross-flow drag, turned and pushed by the wind of the log: joined with `WindMoment` and `WindForces`."""


cross_flow = join("cross-flow", CrossFlow, PlanarMotion)
cross_flow_wind = join("cross-flow-wind", CrossFlowInWind, WindMoment, WindForces, PlanarMotion)
