"""Van Leeuwen's model: yaw, speed and sway made dimensionless with the length and the instantaneous speed.

Van Leeuwen (1970), as in Passenier (1989), section 2.3.2 and 2.3.3. The independent variable is the distance sailed
in ship lengths, so the parameters hold for every speed. The states here are the dimensionless ones, integrated over
time by ds* = (u/L) dt.
"""

from __future__ import annotations

from shipid import Component, constant, derived, given, join, parameter, state
from shipid.parts.planar_motion import PlanarMotion, SpeedScaled
from shipid.parts.wind import Leeway


class VanLeeuwen(SpeedScaled):
    """Rate of turn and loss of speed with lags in the distance sailed."""

    r_star = state("1", "rate of turn, made dimensionless: r L/u", nominal=0.5, latex="r^*")
    u_star = state("1", "share of the cruising speed that is lost", nominal=0.2, latex="u^*")
    s_star = state("1", "distance sailed, in ship lengths", nominal=5.0, latex="s^*")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    u_disturbance = given(
        "m/s^2", "forward acceleration by wind or another disturbance", default=0.0, latex=r"\dot u_d"
    )
    K = parameter("1", "yaw gain K*", start=1.0, low=0.05, high=50.0, dimensional="1/s", latex="K^*")
    tau = parameter("1", "yaw time constant tau*", start=1.5, low=0.05, high=50.0, dimensional="s", latex=r"\tau^*")
    alpha1 = parameter(
        "1",
        "linear yaw damping: 1, or less than 0 for an unstable ship",
        start=1.0,
        low=-5.0,
        high=5.0,
        estimated=False,
        latex=r"\alpha_1^*",
    )
    alpha3 = parameter(
        "1", "cubic yaw damping", start=0.5, low=-10.0, high=200.0, dimensional="s^2/rad^2", latex=r"\alpha_3^*"
    )
    K_u = parameter(
        "1",
        "share of the speed lost per r* squared",
        start=0.8,
        low=0.01,
        high=20.0,
        dimensional="s^2/rad^2",
        latex="K_u^*",
    )
    tau_u = parameter(
        "1", "time constant of the speed", start=2.5, low=0.05, high=50.0, dimensional="s", latex=r"\tau_u^*"
    )
    u = derived("m/s", "forward speed through the water")
    r = derived("rad/s", "rate of turn, positive to starboard")

    @r_star.rate
    def yaw(self):
        """Passenier (1989), eq. (2.43) with (2.45), (2.42) and the disturbance of (2.85).

        The linear coefficient, 1 in (2.45), is kept free for unstable ships as in (2.28).
        """
        damping = self.alpha3 * self.r_star**3 + self.alpha1 * self.r_star
        pace = self.way / self.L
        return pace * (self.K * self.delta - damping) / self.tau + self.r_disturbance / pace

    @u_star.rate
    def loss_of_speed(self):
        """Passenier (1989), eq. (2.44) with (2.46) and (2.42); a push ahead lowers the loss (the sign of (2.86))."""
        filtered = (self.K_u * self.r_star**2 * self.way_left - self.u_star) / self.tau_u
        return self.way / self.L * filtered - self.u_disturbance / self.cruise

    @s_star.rate
    def distance(self):
        """Passenier (1989), eq. (2.42)."""
        return self.way / self.L

    @u.equals
    def forward_speed(self):
        """Passenier (1989), eq. (2.53)."""
        return self.cruise * (1 - self.u_star)

    @r.equals
    def rate_of_turn(self):
        """Passenier (1989), eq. (2.53)."""
        return self.way / self.L * self.r_star


class VanLeeuwenSway(Component):
    """Sway speed proportional to the rate of turn."""

    v = derived("m/s", "sway speed through the water, positive to starboard")
    r = given("rad/s", "rate of turn, positive to starboard")
    L = constant("m", "length between perpendiculars")
    gamma = parameter(
        "1",
        "sway constant gamma*: sway to port in a turn to starboard",
        start=0.45,
        low=-2.0,
        high=5.0,
        dimensional="m/rad",
        latex=r"\gamma^*",
    )

    @v.equals
    def sway(self):
        """Passenier (1989), eq. (2.60) with (2.63).

        (2.57) prints r* squared, which would give sway to the same side in turns to either side; (2.60) has the linear form.
        """
        return -self.gamma * self.L * self.r


class VanLeeuwenSwayInWind(Leeway, VanLeeuwenSway):
    """Sway speed proportional to the rate of turn, and the leeway by the wind."""

    def sway(self):
        """Passenier (1989), eq. (2.60) with (2.63), and the steady sway of (2.76)."""
        return self.v_leeway - self.gamma * self.L * self.r


class CubicSway(Component):
    """The sway speed with a cubic term, for hard turns."""

    v = derived("m/s", "sway speed through the water, positive to starboard")
    r_star = given("1", "rate of turn, made dimensionless: r L/u", latex="r^*")
    u = given("m/s", "forward speed through the water")
    gamma = parameter(
        "1", "linear sway constant gamma1*", start=0.45, low=-2.0, high=5.0, dimensional="m/rad", latex=r"\gamma_1^*"
    )
    gamma3 = parameter("1", "cubic sway constant gamma3*", start=0.0, low=-5.0, high=5.0, latex=r"\gamma_3^*")

    @v.equals
    def sway(self):
        """Passenier (1989), eq. (2.47)-(2.49)."""
        return -self.u * (self.gamma3 * self.r_star**3 + self.gamma * self.r_star)


class LossOfSpeed(Component):
    """First-order loss of speed by the rate of turn squared, at one cruising speed.

    Join it with a model of yaw at constant speed: the yaw does not change, and the path is sailed at the lower speed.
    """

    loss = state("m/s", "speed lost in the manoeuvre", nominal=1.0, latex=r"\Delta u")
    r = given("rad/s", "rate of turn, positive to starboard")
    cruise = given("m/s", "cruising speed, the speed before the manoeuvre", latex="U_0")
    u_disturbance = given(
        "m/s^2", "forward acceleration by wind or another disturbance", default=0.0, latex=r"\dot u_d"
    )
    K_u = parameter("m*s/rad^2", "speed lost per rate of turn squared", start=0.8, low=0.01, high=20.0, prime=True)
    tau_u = parameter("s", "time constant of the speed", start=2.5, low=0.05, high=50.0, prime=True, latex=r"\tau_u")
    beta3 = parameter(
        "s^2/m^2",
        "cubic term of the loss",
        start=0.0,
        low=-10.0,
        high=100.0,
        prime=True,
        estimated=False,
        latex=r"\beta_3",
    )
    u = derived("m/s", "forward speed through the water")

    @loss.rate
    def slowing(self):
        """Passenier (1989), eq. (2.38) with (2.39); with beta3 = 0 it is (2.37).

        K_u is the one of the loss in m/s here; that of (2.59) belongs to the share of the speed and is K_u/U0.
        """
        return (self.K_u * self.r**2 - self.loss - self.beta3 * self.loss**3) / self.tau_u - self.u_disturbance

    @u.equals
    def forward_speed(self):
        """Passenier (1989), eq. (2.34)."""
        return self.cruise - self.loss


van_leeuwen = join("van-leeuwen", VanLeeuwen, VanLeeuwenSway, PlanarMotion)
