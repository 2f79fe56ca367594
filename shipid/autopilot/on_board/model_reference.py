"""Adaptive and model-reference control: gains from estimates, direct compensation, and a reference that follows slowly.

Passenier (1989), sections 4.6 and 5.5. The estimates are those of a yaw filter, by the names of the yaw in regular form:
``a`` = K*/tau*, ``b1`` = 1/tau* and the yaw acceleration ``d`` by a disturbance. The thesis writes the sampled coefficients
a_s = 1 - T (u/L) b1, b_s = T (u/L)^2 a and N_w = T d, from which T drops out.

The components join into a model by themselves, with the estimates as its inputs; `shipid.autopilot.on_board.sampled_loop` puts a filter in.
"""

from __future__ import annotations

import numpy as np

from shipid.autopilot.design.control_law import CourseController
from shipid.autopilot.design.plant import Plant
from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, derived, given, state
from shipid.foundation.aliases import Expression


class Estimates(Component):
    """The ship as the filter estimates it, and u/L, by which it is scaled."""

    a_hat = given("1", "estimated yaw acceleration per rudder angle, K*/tau*", latex=r"\hat a")
    b1_hat = given("1", "estimated yaw damping, 1/tau*", latex=r"\hat b_1")
    d_hat = given("rad/s^2", "estimated yaw acceleration by a disturbance", default=0.0, latex=r"\hat d")
    r_seen = given("rad/s", "rate of turn that is fed back")
    speed_seen = given("m/s", "forward speed through the water, as the autopilot measures it")
    L = constant("m", "length between perpendiculars")

    @property
    def pace(self) -> Expression:
        """u/L."""
        return self.speed_seen / self.L


class PlacedGains(Component):
    """Gains that place the poles of a ship of first order."""

    a_design = given("1", "yaw acceleration per rudder angle the gains are for, K*/tau*")
    b1_design = given("1", "yaw damping the gains are for, 1/tau*")
    speed_seen = given("m/s", "forward speed through the water, as the autopilot measures it")
    L = constant("m", "length between perpendiculars")
    omega_star = constant("1", "natural frequency of the heading over u/L", default=1.0, latex=r"\omega_n^*")
    damping = constant("1", "damping ratio of the heading", default=0.9, latex=r"\zeta")
    gain_Kp = derived("1", "rudder per heading error, scheduled", latex="K_p")
    gain_Kd = derived("s", "rudder per rate of turn, scheduled", latex="K_d")

    @gain_Kp.equals
    def proportional(self) -> Expression:
        """Passenier (1989), eq. (5.79), with omega_n = omega_n* u/L, so that the track is the same at every speed."""
        return self.omega_star**2 / self.a_design

    @gain_Kd.equals
    def derivative(self) -> Expression:
        """Passenier (1989), eq. (5.80); not below zero, also for a ship with more damping than requested."""
        wanted = (2 * self.damping * self.omega_star - self.b1_design) / self.a_design
        return self.L / self.speed_seen * np.maximum(wanted, 0.0)


class IndirectAdaptation(Estimates):
    """The gains are for the ship as it is estimated."""

    a_design = derived("1", "yaw acceleration per rudder angle the gains are for, K*/tau*")
    b1_design = derived("1", "yaw damping the gains are for, 1/tau*")

    @a_design.equals
    def acceleration(self) -> Expression:
        """Passenier (1989), eq. (4.141): the controller's parameters follow from the estimated ones."""
        return self.a_hat + 0.0

    @b1_design.equals
    def damped(self) -> Expression:
        """Passenier (1989), eq. (4.141)."""
        return self.b1_hat + 0.0


class ReferenceModel(Estimates):
    """The ship the gains are for, which follows the estimated one slowly, and the rudder that compensates the difference."""

    T_s = given("s", "sampling interval")
    rudder_wanted = given("rad", "rudder of the law before the limit")
    rudder_limit = constant("rad", "largest rudder angle the autopilot orders", default="15 deg")
    adapting = given("1", "1 while the reference follows the estimates", default=1.0)
    compensating = given("1", "1 while the difference to the reference is compensated by rudder", default=1.0)
    K_R = constant(
        "1/s", "share of the difference the reference takes over in a second", default=1.0 / 300.0, latex="K_R"
    )
    a_ref = state("1", "yaw acceleration per rudder angle of the reference", start=1.0, latex="a_R")
    b1_ref = state("1", "yaw damping of the reference", start=1.0, latex="b_{1R}")
    a_design = derived("1", "yaw acceleration per rudder angle the gains are for, K*/tau*")
    b1_design = derived("1", "yaw damping the gains are for, 1/tau*")
    rudder_extra = derived("rad", "rudder that compensates the difference", latex=r"\Delta\delta")

    def share(self) -> Expression:
        """Return the share taken over in a sample: the whole difference at most."""
        return self.adapting * np.minimum(self.K_R * self.T_s, 1.0)

    @a_ref.next
    def follow_acceleration(self) -> Expression:
        """Passenier (1989), eq. (5.91), of b_s, in which T and u/L drop out."""
        return self.a_ref + self.share() * (self.a_hat - self.a_ref)

    @b1_ref.next
    def follow_damping(self) -> Expression:
        """Passenier (1989), eq. (5.91)."""
        return self.b1_ref + self.share() * (self.b1_hat - self.b1_ref)

    @a_design.equals
    def acceleration(self) -> Expression:
        """The autopilot is that of the reference: Passenier (1989), section 5.5.3."""
        return self.a_ref + 0.0

    @b1_design.equals
    def damped(self) -> Expression:
        """The autopilot is that of the reference: Passenier (1989), section 5.5.3."""
        return self.b1_ref + 0.0

    def rudder_ordered(self) -> Expression:
        """Return the rudder of the reference: that of the law within its limit."""
        return np.minimum(np.maximum(self.rudder_wanted, -self.rudder_limit), self.rudder_limit)

    @rudder_extra.equals
    def difference(self) -> Expression:
        """Passenier (1989), eq. (5.90): with Da = -T (u/L) (b1 - b1_R), Db = T (u/L)^2 (a - a_R), divided by b_s."""
        damping = -(self.b1_hat - self.b1_ref) * self.r_seen / self.pace
        rudder = (self.a_hat - self.a_ref) * self.rudder_ordered()
        return self.compensating * (damping + rudder + self.d_hat / self.pace**2) / self.a_hat


class CompensatedCourseController(CourseController):
    """Heading and rate of turn fed back within a rudder limit, less the rudder that makes the ship answer as the reference."""

    rudder_extra = given("rad", "rudder that compensates the difference to the reference")

    def limited(self) -> Expression:
        """Return the rudder of Passenier (1989), eq. (5.88) and fig. 5.14: the limiter is the reference's, the difference is added."""
        within = np.minimum(np.maximum(self.rudder_wanted, -self.rudder_limit), self.rudder_limit)
        return within - self.rudder_extra


class SelectedFeedback(Component):
    """The feedback of the autopilot: the instruments at first, and the filter's estimates once it has converged."""

    psi_shown = given("rad", "heading the compass shows", wraps=True)
    r_shown = given("rad/s", "rate of turn the gyro shows")
    psi_hat = given("rad", "estimated heading", wraps=True, latex=r"\hat\psi")
    r_hat = given("rad/s", "estimated rate of turn", latex=r"\hat r")
    u_shown = given("m/s", "forward speed the log shows")
    filtered = given("1", "1 while the filter's estimates are fed back", default=1.0)
    psi_seen = derived("rad", "heading that is fed back", wraps=True)
    r_seen = derived("rad/s", "rate of turn that is fed back")
    speed_seen = derived("m/s", "forward speed through the water, as the autopilot measures it")

    @psi_seen.equals
    def heading(self) -> Expression:
        """Passenier (1989), section 6.3.2: the measured signal first, the filtered one later."""
        return self.filtered * self.psi_hat + (1 - self.filtered) * self.psi_shown

    @r_seen.equals
    def rate(self) -> Expression:
        """Passenier (1989), section 6.3.2."""
        return self.filtered * self.r_hat + (1 - self.filtered) * self.r_shown

    @speed_seen.equals
    def speed(self) -> Expression:
        """The log's."""
        return self.u_shown + 0.0


def first_order_equivalent(plant: Plant, omega: float, pace: float) -> tuple[float, float]:
    """Return ``a`` = K*/tau* and ``b1`` = 1/tau* of the ship of first order that answers the rudder alike at one frequency.

    Of a ship of first order these are its own, whatever the frequency.

    Parameters
    ----------
    plant : Plant
        One condition, from the rudder.
    omega : float
        In rad/s, where both have the same response of the rate of turn.
    pace : float
        u/L in 1/s.
    """
    s = 1j * omega
    # Of first order, the inverse of the response is (s + b1 pace) / (a pace^2).
    inverse = np.polyval(plant.denominator, s) / np.polyval(plant.numerators[1], s)
    scale = omega / inverse.imag
    return float(scale / pace**2), float(scale * inverse.real / pace)
