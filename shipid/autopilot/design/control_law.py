"""Control laws as components: the feedback an autopilot has, and the rudder it orders.

A law reads ``psi_seen`` and ``r_seen`` and states ``delta_order``. `Measured` states the feedback from the ship's own motion,
with the waves where a wave model is joined; a filter that states the same two can replace it.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, derived, given, state
from shipid.foundation.aliases import Expression


class Measured(Component):
    """The feedback without a filter: compass, rate gyro and log."""

    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    r = given("rad/s", "rate of turn, positive to starboard")
    u = given("m/s", "forward speed through the water")
    psi_wave = given("rad", "heading by the waves", default=0.0, latex=r"\psi_v")
    r_wave = given("rad/s", "rate of turn by the waves", default=0.0, latex="r_v")
    log_scale = constant("1", "speed the log shows over the speed through the water", default=1.0)
    psi_seen = derived("rad", "heading that is fed back", wraps=True)
    r_seen = derived("rad/s", "rate of turn that is fed back")
    speed_seen = derived("m/s", "forward speed through the water, as the autopilot measures it")

    @psi_seen.equals
    def heading(self) -> Expression:
        """Passenier (1989), section 5.3: the heading with the wave motion added."""
        return self.psi + self.psi_wave

    @r_seen.equals
    def rate(self) -> Expression:
        """Passenier (1989), eq. (5.21): the rate of turn with the wave motion added."""
        return self.r + self.r_wave

    @speed_seen.equals
    def speed(self) -> Expression:
        """A log that is off by a factor shifts the schedule."""
        return self.log_scale * self.u


class CourseController(Component):
    """Heading and rate of turn fed back within a rudder limit."""

    psi_order = given("rad", "heading that is ordered, unwrapped as the ship's own", latex=r"\psi_r")
    psi_seen = given("rad", "heading that is fed back", wraps=True)
    r_seen = given("rad/s", "rate of turn that is fed back")
    gain_Kp = given("1", "rudder per heading error, scheduled", latex="K_p")
    gain_Kd = given("s", "rudder per rate of turn, scheduled", latex="K_d")
    rudder_limit = constant("rad", "largest rudder angle the autopilot orders", default="15 deg")
    rudder_wanted = derived("rad", "rudder of the law before the limit")
    delta_order = derived("rad", "rudder angle that is ordered, positive turns to starboard", latex=r"\delta_r")

    @rudder_wanted.equals
    def law(self) -> Expression:
        """Passenier (1989), eq. (3.45)."""
        return self.gain_Kp * (self.psi_order - self.psi_seen) - self.gain_Kd * self.r_seen

    @delta_order.equals
    def limited(self) -> Expression:
        """Passenier (1989), fig. 5.10: the rudder limiter."""
        return np.minimum(np.maximum(self.rudder_wanted, -self.rudder_limit), self.rudder_limit)


class IntegralCourseController(CourseController):
    """The same with an integral for a steady moment, which stops while the rudder is saturated."""

    gain_Ki = given("1/s", "rudder per heading error and second, scheduled", latex="K_i")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    psi_integral = state("rad*s", "integral of the heading error", nominal=1.0)

    @psi_integral.rate
    def integrate(self) -> Expression:
        """Conditional integration (Astrom and Hagglund 2006, "Advanced PID control", section 3.5).

        The integral stops while the law exceeds the limit and while the rudder, for its rate, lags behind
        the order by half the limit; and it grows no faster than for an error of a fifth of the proportional band. A larger one is the
        error of a course change, and no measure of a steady moment.
        """
        inside = np.abs(self.rudder_wanted) < self.rudder_limit
        follows = np.abs(self.delta_order - self.delta) < 0.5 * self.rudder_limit
        band = 0.2 * self.rudder_limit / np.abs(self.gain_Kp)
        error = np.minimum(np.maximum(self.psi_order - self.psi_seen, -band), band)
        return np.where(np.logical_and(inside, follows), error, 0.0 * error)

    def law(self) -> Expression:
        """Return the rudder of Passenier (1989), eq. (3.45), with the integral of the error."""
        error = self.psi_order - self.psi_seen
        return self.gain_Kp * error - self.gain_Kd * self.r_seen + self.gain_Ki * self.psi_integral


class RateController(Component):
    """Control of the rate of turn: proportional and integral feedback within the rudder limit.

    The integral of the rate of turn is a heading, so that the gains are those of the course controller: ``gain_Kd`` of the
    error of the rate, ``gain_Kp`` of its integral.
    """

    r_order = given("rad/s", "rate of turn that is ordered, positive to starboard", latex="r_r")
    r_seen = given("rad/s", "rate of turn that is fed back")
    gain_Kp = given("1", "rudder per integral of the rate error, scheduled", latex="K_p")
    gain_Kd = given("s", "rudder per rate error, scheduled", latex="K_d")
    rudder_limit = constant("rad", "largest rudder angle the autopilot orders", default="15 deg")
    rate_integral = state("rad", "integral of the rate error", nominal="1 deg")
    rudder_wanted = derived("rad", "rudder of the law before the limit")
    delta_order = derived("rad", "rudder angle that is ordered, positive turns to starboard", latex=r"\delta_r")

    @rate_integral.rate
    def integrate(self) -> Expression:
        """The integral stops while the law exceeds the limit."""
        error = self.r_order - self.r_seen
        return np.where(np.abs(self.rudder_wanted) < self.rudder_limit, error, 0.0 * error)

    @rudder_wanted.equals
    def law(self) -> Expression:
        """Proportional to the rate ordered less the rate measured, and to the integral of the difference."""
        return self.gain_Kd * (self.r_order - self.r_seen) + self.gain_Kp * self.rate_integral

    @delta_order.equals
    def limited(self) -> Expression:
        """Within the rudder limit."""
        return np.minimum(np.maximum(self.rudder_wanted, -self.rudder_limit), self.rudder_limit)
