"""De Keizer's yaw in the form that is linear in its coefficients, as regressions and adaptive filters take it.

Its coefficients are the yaw damping 1/tau* and the rudder effectiveness K*/tau*, the states of Passenier's (1989) yaw filter.
Normalised like this they stay the same when the ship changes speed, which those of the sampled equation do not.
"""

from __future__ import annotations

from shipid import derived, given, join, parameter, state
from shipid.models.kinematics import PlanarMotion, SpeedScaled


class LinearYaw(SpeedScaled):
    """First-order yaw scaled by a speed that is given, by its damping and the effectiveness of the rudder."""

    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    damping = parameter(
        "1", "yaw damping 1/tau*", start=0.7, low=0.0, high=20.0, dimensional="1/s", latex=r"(1/\tau^*)"
    )
    effectiveness = parameter(
        "1", "rudder effectiveness K*/tau*", start=0.7, low=0.0, high=20.0, dimensional="1/s^2", latex=r"(K^*/\tau^*)"
    )
    K = derived("1", "yaw gain K*", latex="K^*")
    tau = derived("1", "yaw time constant tau*", latex=r"\tau^*")

    @r.rate
    def yaw(self):
        """De Keizer (1977); Passenier (1989), eq. (2.54) with (2.57), in the coefficients of (5.27) and (5.28)."""
        pace = self.way / self.L
        return pace**2 * self.effectiveness * self.delta - pace * self.damping * self.r + self.r_disturbance

    @K.equals
    def gain(self):
        """Passenier (1989), eq. (2.54): the steady rate of turn r* for a unit of rudder."""
        return self.effectiveness / self.damping

    @tau.equals
    def time_constant(self):
        """Passenier (1989), eq. (2.54)."""
        return 1 / self.damping

    @damping.instead
    def damping_of_tau(self):
        """Passenier (1989), eq. (5.27)."""
        return 1 / self.tau

    @effectiveness.instead
    def effectiveness_of_K(self):
        """Passenier (1989), eq. (5.28)."""
        return self.K / self.tau


linear_yaw = join("linear-yaw", LinearYaw, PlanarMotion)
