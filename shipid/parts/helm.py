"""The helmsman of each manoeuvre, declared like any other component.

A helmsman reads heading and rate of turn and states the rudder order ``delta_order``. The order changes at the samples
of the simulation and is held between them.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, derived, given, state
from shipid.foundation.aliases import Expression

_ORDER = "rudder order, positive turns to starboard"


class ScheduledOrder(Component):
    """A rudder order given beforehand: spiral, random telegraph, any recorded helm."""

    delta_order = derived("rad", _ORDER)
    helm_schedule = given("rad", "scheduled rudder order")

    @delta_order.equals
    def order(self) -> Expression:
        """Return the order as scheduled."""
        return self.helm_schedule


class HelmsmanAfterApproach(Component):
    """A helmsman who holds the rudder amidships on a straight approach first."""

    psi = given("rad", "heading")
    T_s = given("s", "sampling interval")
    helm_course = constant("rad", "heading of the approach")
    helm_start = constant("s", "length of the approach")
    helm_rudder = constant("rad", "rudder angle of the manoeuvre, positive to starboard")
    helm_clock = state("s", "time since the beginning")

    @helm_clock.next
    def tick(self) -> Expression:
        """The clock."""
        return self.helm_clock + self.T_s

    def begun(self) -> Expression:
        """Return whether the approach is over (half an interval of slack for the rounding of the clock)."""
        return self.helm_clock >= self.helm_start - 0.5 * self.T_s


class ZigzagHelm(HelmsmanAfterApproach):
    """Zig-zag: the rudder is reversed whenever the heading has gone far enough to its side (ITTC 7.5-04-02-01)."""

    delta_order = derived("rad", _ORDER)
    helm_heading = constant("rad", "heading change at which the rudder is reversed")
    helm_side = state("1", "+1 while the rudder is on the side of the first execute, -1 on the other", start=1.0)

    @delta_order.equals
    def order(self) -> Expression:
        """Return amidships on the approach, then the rudder angle to the side of the swing."""
        return np.where(self.begun(), self.helm_side * self.helm_rudder, 0.0 * self.helm_rudder)

    @helm_side.next
    def execute(self) -> Expression:
        """Reverse when the heading change on the side of the rudder reaches the execute angle."""
        swing = self.helm_side * np.sign(self.helm_rudder) * (self.psi - self.helm_course)
        return np.where(swing >= self.helm_heading, -self.helm_side, self.helm_side)


class TurningHelm(HelmsmanAfterApproach):
    """Turning circle: the rudder is held until the heading has turned far enough, then goes amidships (pull-out)."""

    delta_order = derived("rad", _ORDER)
    helm_turn = constant("rad", "heading change after which the rudder goes amidships")
    helm_released = state("1", "1 once the rudder is back amidships")

    @delta_order.equals
    def order(self) -> Expression:
        """Return amidships, the rudder angle, amidships again."""
        steering = np.logical_and(self.begun(), self.helm_released < 0.5)
        return np.where(steering, self.helm_rudder, 0.0 * self.helm_rudder)

    @helm_released.next
    def release(self) -> Expression:
        """Amidships from the end of the turn on."""
        return np.where(np.abs(self.psi - self.helm_course) >= self.helm_turn, 1.0, self.helm_released)


class CourseHelm(Component):
    """Course change under a proportional and derivative law, within a rudder limit."""

    delta_order = derived("rad", _ORDER)
    psi = given("rad", "heading")
    r = given("rad/s", "rate of turn, positive to starboard")
    helm_schedule = given("rad", "heading to steer")
    helm_limit = constant("rad", "largest rudder angle the law asks for")
    helm_gain = constant("1", "rudder per heading error", default=1.0)
    helm_damping = constant("s", "rudder per rate of turn")

    @delta_order.equals
    def order(self) -> Expression:
        """Return the proportional and derivative law, limited."""
        wanted = self.helm_gain * (self.helm_schedule - self.psi) - self.helm_damping * self.r
        return np.minimum(np.maximum(wanted, -self.helm_limit), self.helm_limit)


class RateHelm(Component):
    """Reversed spiral: a proportional and integral law finds the rudder angle of a given rate of turn."""

    delta_order = derived("rad", _ORDER)
    r = given("rad/s", "rate of turn, positive to starboard")
    T_s = given("s", "sampling interval")
    helm_schedule = given("rad/s", "rate of turn to keep")
    helm_limit = constant("rad", "largest rudder angle the law asks for")
    helm_gain = constant("s", "rudder per error in the rate of turn")
    helm_reset = constant("s", "time in which the integral repeats the proportional part")
    helm_integral = state("rad", "integral of the error in the rate of turn")

    def error(self) -> Expression:
        """Return the wanted rate of turn less the actual one."""
        return self.helm_schedule - self.r

    @helm_integral.next
    def integrate(self) -> Expression:
        """Euler's rule, on the samples."""
        return self.helm_integral + self.T_s * self.error()

    @delta_order.equals
    def order(self) -> Expression:
        """Return the proportional and integral law, limited."""
        wanted = self.helm_gain * (self.error() + self.helm_integral / self.helm_reset)
        return np.minimum(np.maximum(wanted, -self.helm_limit), self.helm_limit)


class DirectRudder(Component):
    """A ship without a steering machine: the rudder is where it is ordered."""

    delta_order = given("rad", "rudder order, positive turns to starboard")
    delta = derived("rad", "rudder angle, positive turns to starboard")

    @delta.equals
    def direct(self) -> Expression:
        """No lag."""
        return self.delta_order
