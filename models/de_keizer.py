"""De Keizer's model: rate of turn and speed, scaled by length and instantaneous speed.

De Keizer (1977), as in Passenier (1989), section 2.3.3. It differs from Van Leeuwen's in that the rate of turn itself
has the lag, and not its dimensionless form, which gives more overshoot of the rate in a turning circle.

A steady turn is stable only while u*_ss = K_u (K delta)^2 stays below (1 + tau_u/tau) / (3 + tau_u/tau) (found by
linearising; the thesis does not say it): in a harder turn u falls to 0. See `planar_motion.LEAST_WAY`.
"""

from __future__ import annotations

from shipid import derived, given, join, parameter, state
from shipid.models.van_leeuwen import CubicSway, VanLeeuwenSway
from shipid.parts.planar_motion import PlanarMotion, SpeedScaled


class DeKeizerMinimal(SpeedScaled):
    """Yaw and surge with linear feedback, the smallest choice that covers rudder angles and speeds."""

    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    u = state("m/s", "forward speed through the water", nominal=1.0)
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    u_disturbance = given(
        "m/s^2", "forward acceleration by wind or another disturbance", default=0.0, latex=r"\dot u_d"
    )
    K = parameter("1", "yaw gain K*", start=1.0, low=0.05, high=50.0, dimensional="1/s", latex="K^*")
    tau = parameter("1", "yaw time constant tau*", start=1.5, low=0.05, high=50.0, dimensional="s", latex=r"\tau^*")
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

    r_star = derived("1", "rate of turn, made dimensionless: r L/u", latex="r^*")
    u_star = derived("1", "share of the cruising speed that is lost", latex="u^*")

    @r_star.equals
    def dimensionless_rate(self):
        """Passenier (1989), eq. (2.40)."""
        return self.r * self.L / self.way

    @u_star.equals
    def dimensionless_loss(self):
        """Passenier (1989), eq. (2.41)."""
        return (self.cruise - self.u) / self.cruise

    def yaw_feedback(self):
        """H(r*), Passenier (1989), eq. (2.57)."""
        return self.r_star

    def speed_feedback(self):
        """H_u(u*), Passenier (1989), eq. (2.57)."""
        return self.u_star

    @r.rate
    def yaw(self):
        """De Keizer (1977); Passenier (1989), eq. (2.54)."""
        pace = self.way / self.L
        return pace**2 * (self.K * self.delta - self.yaw_feedback()) / self.tau + self.r_disturbance

    @u.rate
    def surge(self):
        """De Keizer (1977); Passenier (1989), eq. (2.55), read as tau_u* (L/u) du*/dt + H_u(u*) = K_u* r*^2.

        The print has du/dt, with which neither the sign nor the dimension is right; u = U0 (1 - u*) by (2.53).
        """
        slowing = (self.K_u * self.r_star**2 * self.way_left - self.speed_feedback()) / self.tau_u
        return -self.cruise * self.way / self.L * slowing + self.u_disturbance


class DeKeizer(DeKeizerMinimal):
    """Yaw with a cubic damping, and surge."""

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

    def yaw_feedback(self):
        """H(r*), Passenier (1989), eq. (2.45), its linear coefficient free as in (2.28) for unstable ships."""
        return self.alpha3 * self.r_star**3 + self.alpha1 * self.r_star


class DeKeizerCubic(DeKeizer):
    """Yaw and surge, both with a cubic damping."""

    beta3 = parameter("1", "cubic term of the loss of speed", start=0.0, low=-10.0, high=100.0, latex=r"\beta_3^*")

    def speed_feedback(self):
        """H_u(u*), Passenier (1989), eq. (2.39) in dimensionless form."""
        return self.u_star + self.beta3 * self.u_star**3


class DeKeizerAsymmetric(DeKeizer):
    """Yaw with all four terms of the reversed spiral, and surge: a ship that turns with the rudder amidships."""

    alpha0 = parameter(
        "1",
        "rudder angle that keeps a straight course, times K*",
        start=0.0,
        low=-2.0,
        high=2.0,
        nominal=0.02,
        latex=r"\alpha_0^*",
    )
    alpha2 = parameter(
        "1",
        "quadratic yaw damping: the turn is slower to starboard where it is positive",
        start=0.0,
        low=-10.0,
        high=10.0,
        nominal=0.05,
        dimensional="s/rad",
        latex=r"\alpha_2^*",
    )

    def yaw_feedback(self):
        """H(r*), Passenier (1989), eq. (2.27) in the dimensionless form of (2.45)."""
        return self.alpha3 * self.r_star**3 + self.alpha2 * self.r_star**2 + self.alpha1 * self.r_star + self.alpha0


de_keizer = join("de-keizer", DeKeizer, VanLeeuwenSway, PlanarMotion)
de_keizer_minimal = join("de-keizer-minimal", DeKeizerMinimal, VanLeeuwenSway, PlanarMotion)
de_keizer_cubic = join("de-keizer-cubic", DeKeizerCubic, CubicSway, PlanarMotion)
de_keizer_asymmetric = join("de-keizer-asymmetric", DeKeizerAsymmetric, VanLeeuwenSway, PlanarMotion)
