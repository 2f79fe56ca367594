"""Pershitz's model: rate of turn and drift angle, with a speed that follows the rate of turn.

Pershitz (1973), as in Semerdjiev and Mihaylova (2000), "Variable- and fixed-structure augmented interacting
multiple-model algorithms for manoeuvring ship tracking based on new ship models", eq. (1)-(20): the continuous model,
the discrete one they derive from it, and the two forms their trackers use. In the paper X is east and Y is north;
here, as everywhere, x is north and y is east.
"""

from __future__ import annotations

import numpy as np

from shipid import Component, constant, derived, given, join, parameter, state
from shipid.parts.planar_motion import PlanarMotion


class PershitzCoefficients(Component):
    """The hydrodynamic coefficients the continuous and the discrete model share; it states nothing itself."""

    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    cruise = given("m/s", "speed on a straight course at the same power", latex="V_U")
    L = constant("m", "length between perpendiculars")
    q21 = parameter("1", "drift force per drift angle", start=0.3, low=0.0, high=5.0, latex="q_{21}")
    r21 = parameter("1", "drift force per rate of turn", start=-0.6, low=-5.0, high=0.0, latex="r_{21}")
    s21 = parameter("1", "drift force per rudder angle", start=-0.1, low=-3.0, high=0.5, latex="s_{21}")
    h1 = parameter("1", "drift force per drift angle squared", start=3.5, low=0.0, high=50.0, latex="h_1")
    q31 = parameter("1", "yaw moment per drift angle", start=-4.0, low=-20.0, high=0.0, latex="q_{31}")
    r31 = parameter("1", "yaw damping", start=3.5, low=0.01, high=20.0, latex="r_{31}")
    s31 = parameter("1", "yaw moment per rudder angle", start=-1.0, low=-10.0, high=0.0, latex="s_{31}")
    k_v = parameter(
        "1",
        "loss of speed per dimensionless rate of turn squared",
        start=1.9,
        low=0.0,
        high=20.0,
        latex="k_V",
    )


class Pershitz(PershitzCoefficients):
    """Rate of turn and drift angle with a quadratic drift force, and a speed that follows the rate at once."""

    omega = state("rad/s", "rate of turn the ship would have without its loss of speed", nominal="1 deg/s")
    beta = state("rad", "drift angle, positive when the bow points inside a starboard turn", nominal="5 deg")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    V = derived("m/s", "speed through the water")
    u = derived("m/s", "forward speed through the water")
    v = derived("m/s", "sway speed through the water, positive to starboard")
    r = derived("rad/s", "rate of turn, positive to starboard")

    @property
    def speed_ratio(self):
        """K_V, the share of the speed that is left: Semerdjiev and Mihaylova (2000), below eq. (6)."""
        return 1 / (1 + self.k_v * (self.omega * self.L / self.cruise) ** 2)

    @omega.rate
    def yaw(self):
        """Semerdjiev and Mihaylova (2000), eq. (4), with a disturbance added."""
        pace = self.cruise / self.L
        moment = self.q31 * self.beta + self.s31 * self.delta
        return -(pace**2) * moment - pace * self.r31 * self.omega + self.r_disturbance

    @beta.rate
    def drift(self):
        """Semerdjiev and Mihaylova (2000), eq. (5)."""
        force = self.q21 * self.beta + self.h1 * self.beta * np.abs(self.beta) + self.s21 * self.delta
        return -self.cruise / self.L * force - self.r21 * self.omega

    @V.equals
    def speed(self):
        """Semerdjiev and Mihaylova (2000), eq. (6)."""
        return self.cruise * self.speed_ratio

    @u.equals
    def forward_speed(self):
        """Semerdjiev and Mihaylova (2000), eq. (1)-(2): the course is the heading less the drift angle."""
        return self.V * np.cos(self.beta)

    @v.equals
    def sway(self):
        """Semerdjiev and Mihaylova (2000), eq. (1)-(2): the course is the heading less the drift angle."""
        return -self.V * np.sin(self.beta)

    @r.equals
    def rate_of_turn(self):
        """Semerdjiev and Mihaylova (2000), eq. (3)."""
        return self.speed_ratio * self.omega


class PershitzDiscrete(PershitzCoefficients):
    """Heading change per metre sailed, sampled: Pershitz's model with the drift angle eliminated.

    The printed model never leaves a turn: with the rudder amidships its time constant is infinite, as the ship of the
    paper is course-unstable. Amidships the time constant is that of the rudder angle `delta_midships`: with 30 deg (the
    largest, and the default) the turn ends in about 40 s, with 3 deg in minutes; 0 gives the printed model.
    """

    x = state("m", "position to the north", nominal=100.0)
    y = state("m", "position to the east", nominal=100.0)
    psi = state("rad", "heading, clockwise from north", nominal="10 deg", wraps=True, latex=r"\psi")
    Omega = state("rad/m", "heading change per metre sailed", nominal=0.002, latex=r"\Omega")
    T_s = given("s", "sampling interval")
    delta_midships = constant(
        "rad",
        "rudder angle that gives the time constant while the rudder is amidships",
        default="30 deg",
        latex=r"\delta_0",
    )
    beta0 = derived("rad", "drift angle of the steady turn at this rudder angle", latex=r"\beta_0")
    beta_settling = derived("rad", "the same, at `delta_midships` while the rudder is amidships", latex=r"\beta_0'")
    Omega_U = derived("rad/m", "heading change per metre in the steady turn", latex=r"\Omega_U")
    decay = derived("1/m", "rate at which the turn settles, per metre (tau in the paper)", latex=r"\tau")
    V = derived("m/s", "speed through the water")
    r = derived("rad/s", "rate of turn, positive to starboard")

    def steady_drift(self, delta):
        """beta_0, Semerdjiev and Mihaylova (2000), below eq. (6): drift angle of the steady turn, without sign.

        Parameters
        ----------
        delta : Expression
            Rudder angle in rad.
        """
        q = self.q21 * self.r31 - self.q31 * self.r21
        s = self.r21 * self.s31 - self.r31 * self.s21
        h = self.h1 * self.r31
        return (-q + np.sqrt(q**2 + 4 * h * s * np.abs(delta))) / (2 * h)

    @beta0.equals
    def turning_drift(self):
        """Semerdjiev and Mihaylova (2000), below eq. (6)."""
        return self.steady_drift(self.delta)

    @beta_settling.equals
    def settling_drift(self):
        """Semerdjiev and Mihaylova (2000), below eq. (6); amidships the paper leaves the angle to choose."""
        return self.steady_drift(np.where(self.delta == 0, self.delta_midships, self.delta))

    @Omega_U.equals
    def steady_turn(self):
        """Semerdjiev and Mihaylova (2000), below eq. (11)."""
        moment = self.s31 * self.delta + np.sign(self.delta) * self.q31 * self.beta0
        return -moment / (self.r31 * self.L)

    @decay.equals
    def settling(self):
        """Semerdjiev and Mihaylova (2000), below eq. (11), as (-p + sqrt(p^2 - q*)) / L.

        The print has 0.5 p and 0.25 p^2, with p already halved: eliminating the drift angle from (4) and (5) gives
        s^2 + 2 p s + q* = 0. Where the two roots are complex their real part is taken.
        """
        q21 = self.q21 + self.h1 * self.beta_settling
        p = 0.5 * (q21 + self.r31)
        product = q21 * self.r31 - self.q31 * self.r21
        return (-p + np.sqrt(np.maximum(p**2 - product, 0.0))) / self.L

    @V.equals
    def speed(self):
        """Semerdjiev and Mihaylova (2000), eq. (11)."""
        return self.cruise / (1 + self.k_v * (self.Omega * self.L) ** 2)

    @r.equals
    def rate_of_turn(self):
        """Semerdjiev and Mihaylova (2000), eq. (9), to first order in the sampling interval."""
        return self.V * self.Omega

    @x.next
    def north(self):
        """Semerdjiev and Mihaylova (2000), eq. (8); its Y is our x."""
        return self.x + self.T_s * self.V * np.cos(self.psi)

    @y.next
    def east(self):
        """Semerdjiev and Mihaylova (2000), eq. (7); its X is our y."""
        return self.y + self.T_s * self.V * np.sin(self.psi)

    @psi.next
    def heading(self):
        """Semerdjiev and Mihaylova (2000), eq. (9)."""
        sailed = self.T_s * self.V
        settling = 0.5 * sailed * self.decay * (self.Omega - self.Omega_U) * np.exp(sailed * self.decay)
        return self.psi + sailed * (self.Omega + settling)

    @Omega.next
    def turning(self):
        """Semerdjiev and Mihaylova (2000), eq. (10)."""
        left = np.exp(self.T_s * self.V * self.decay)
        return self.Omega * left + self.Omega_U * (1 - left)


class PershitzTrack(Component):
    """A turn of fixed curvature, sampled: one of the models of Pershitz's ship in a multiple-model tracker.

    Every scan multiplies the speed by the loss of that turn, as printed; the paper's trackers set the speed of the
    turning models back to that of the straight one after each scan.
    """

    x = state("m", "position to the north", nominal=100.0)
    y = state("m", "position to the east", nominal=100.0)
    psi = state("rad", "heading, clockwise from north", nominal="10 deg", wraps=True, latex=r"\psi")
    V_U = state("m/s", "speed on a straight course", nominal=5.0, latex="V_U")
    T_s = given("s", "sampling interval")
    Omega = given("rad/m", "heading change per metre sailed, fixed for each model of a tracker", latex=r"\Omega")
    mean_length = constant("m", "ship length in the loss of speed", default="69 m", latex="l")
    k_v = parameter(
        "1",
        "loss of speed per dimensionless rate of turn squared",
        start=1.9,
        low=0.0,
        high=20.0,
        estimated=False,
        latex="k_V",
    )
    V = derived("m/s", "speed through the water in the turn")

    def turn(self):
        """The heading change per metre: eq. (14) has that of the model alone."""
        return self.Omega

    @V.equals
    def speed(self):
        """Semerdjiev and Mihaylova (2000), eq. (15)."""
        return self.V_U / (1 + self.k_v * (self.Omega * self.mean_length) ** 2)

    @x.next
    def north(self):
        """Semerdjiev and Mihaylova (2000), eq. (13); its Y is our x."""
        return self.x + self.T_s * self.V * np.cos(self.psi)

    @y.next
    def east(self):
        """Semerdjiev and Mihaylova (2000), eq. (12); its X is our y."""
        return self.y + self.T_s * self.V * np.sin(self.psi)

    @psi.next
    def heading(self):
        """Semerdjiev and Mihaylova (2000), eq. (14), or (18) with the displacement."""
        return self.psi + self.T_s * self.V * self.turn()

    @V_U.next
    def straight_speed(self):
        """Semerdjiev and Mihaylova (2000), eq. (15): the fourth state, as in the paper's Jacobian."""
        return self.V


class PershitzTrackAugmented(PershitzTrack):
    """A turn of fixed curvature with an estimated correction, sampled; the loss of speed does not include the correction."""

    dOmega = state("rad/m", "turn of the ship less that of the model", nominal=0.001, latex=r"\Delta\Omega")

    def turn(self):
        """The heading change per metre of eq. (18)."""
        return self.Omega + self.dOmega

    @dOmega.next
    def displacement(self):
        """Semerdjiev and Mihaylova (2000), eq. (20)."""
        return self.dOmega


pershitz = join("pershitz", Pershitz, PlanarMotion)
pershitz_discrete = join("pershitz-discrete", PershitzDiscrete)
pershitz_track = join("pershitz-track", PershitzTrack)
pershitz_track_augmented = join("pershitz-track-augmented", PershitzTrackAugmented)
