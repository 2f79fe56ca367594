"""Bech's second-order yaw with a surge equation, scaled by length and instantaneous speed.

Bech and Wagner Smitt (1969) in regular coefficients, so that the ship may change its stability, made dimensionless
with L/u as in Passenier (1989), section 2.3.3; the surge balances thrust, resistance and the resistance of the turn.
Both parts are needed: a model at constant speed takes the loss of speed for cubic damping, and a first-order yaw
lacks the lag of the sway. At a constant speed it is `bech` with d1 = B1 (u/L)^2, d0 = B0 (u/L)^3, c1 = A1 u/L,
c0 = A0 (u/L)^2 and c3 = A3.

A steady turn at rudder delta has A0 r* + A3 r*^3 = B0 delta and u = U0 / sqrt(1 + r*^2 X_rr/X0), so that no rudder
angle stops the ship.
"""

from __future__ import annotations

from shipid import derived, given, join, parameter, state
from shipid.models.van_leeuwen import VanLeeuwenSway
from shipid.parts.planar_motion import PlanarMotion, SpeedScaled


class Surge(SpeedScaled):
    """Surge: thrust and resistance that balance at the cruising speed, and the resistance of the turn.

    The thrust is taken as constant. The resistance of the turn is X_vr v r; it is proportional to
    r squared, as the sway speed follows the rate of turn.
    """

    u = state("m/s", "forward speed through the water", nominal=1.0)
    r = given("rad/s", "rate of turn, positive to starboard")
    u_disturbance = given(
        "m/s^2", "forward acceleration by wind or another disturbance", default=0.0, latex=r"\dot u_d"
    )
    X0 = parameter("1", "resistance and thrust", start=0.1, low=0.002, high=2.0, latex="X_0")
    X_rr = parameter("1", "resistance of the turn", start=1.0, low=0.0, high=20.0, latex="X_{rr}")

    @u.rate
    def surge(self):
        """Resistance by the square of the speed, and X_vr v r of Norrbin (1971) for a sway that follows the turn.

        Below a twentieth of the cruising speed both are in proportion to the speed, so that a ship at rest or astern gathers way.
        """
        balance = self.X0 * (self.cruise**2 - self.u * self.way)
        return (balance - self.X_rr * (self.r * self.L) ** 2 * self.way_left) / self.L + self.u_disturbance


class BechYaw(SpeedScaled):
    """Second-order yaw of either course stability with a cubic damping, scaled by a speed that surge lowers in the turn."""

    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    w = state("1", "dimensionless yaw acceleration by earlier sway and rudder angles", nominal=0.02)
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    B1 = parameter("1", "yaw acceleration per rudder angle", start=1.0, low=-5.0, high=20.0, latex="B_1")
    B0 = parameter("1", "growth of the yaw acceleration per rudder angle", start=1.3, low=0.01, high=50.0, latex="B_0")
    A1 = parameter("1", "minus the sum of the poles", start=2.5, low=-5.0, high=50.0, spread=0.5, latex="A_1")
    A0 = parameter(
        "1",
        "product of the poles, negative for an unstable ship",
        start=-0.15,
        low=-20.0,
        high=50.0,
        spread=0.35,
        latex="A_0",
    )
    A3 = parameter("1", "cubic damping", start=8.0, low=-100.0, high=1000.0, latex="A_3")
    r_star = derived("1", "rate of turn, made dimensionless: r L/u", latex="r^*")

    @r_star.equals
    def dimensionless_rate(self):
        """Passenier (1989), eq. (2.40)."""
        return self.r * self.L / self.way

    def rudder(self):
        """Effective rudder angle: its force is proportional to the square of the ship's speed."""
        return self.delta

    @r.rate
    def yaw(self):
        """Bech (1969), second order, scaled as in Passenier (1989), eq. (2.42); the rudder is not differentiated."""
        pace = self.way / self.L
        return pace**2 * (self.w + self.B1 * self.rudder()) - pace * self.A1 * self.r + self.r_disturbance

    @w.rate
    def memory(self):
        """Bech (1969): the part of the second derivative without derivatives, with a cubic damping.

        A disturbance enters so that a steady one turns the ship as in the first-order model, as in `bech`.
        """
        pace = self.way / self.L
        pull = self.B0 * self.rudder() - self.A0 * self.r_star - self.A3 * self.r_star**3
        first_order = self.A1 - self.A0 * self.B1 / self.B0
        return pace * pull + first_order * self.r_disturbance / pace


class SlipstreamYaw(BechYaw):
    """Second-order yaw and surge with a rudder in the slipstream, which keeps part of its force as the ship slows."""

    m = parameter(
        "1",
        "exponent of the slipstream: rudder force by u^(2-m) U0^m",
        start=0.5,
        low=-0.5,
        high=2.5,
        spread=0.4,
    )
    same_at_any_loading = ("m",)

    def rudder(self):
        """Effective rudder angle: its force is proportional to u^(2-m) U0^m."""
        return self.delta * (self.cruise / self.way) ** self.m


bech_surge = join("bech-surge", BechYaw, Surge, VanLeeuwenSway, PlanarMotion)
bech_slipstream = join("bech-slipstream", SlipstreamYaw, Surge, VanLeeuwenSway, PlanarMotion)
