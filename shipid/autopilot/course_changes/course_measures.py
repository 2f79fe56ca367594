"""What is measured in a run, while it runs: a component whose states end as overshoot, settling, activity.

Measuring inside the model keeps a thousand runs as small as one, and the measures are those of every sample.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, given, state


class CourseMeter(Component):
    """Overshoot, settling, heading error, rudder activity and the track of a course change, or of keeping a course."""

    psi = given("rad", "heading, clockwise from north", wraps=True)
    psi_order = given("rad", "heading that is ordered")
    delta = given("rad", "rudder angle, positive turns to starboard")
    x = given("m", "position to the north")
    y = given("m", "position to the east")
    current_north = given("m/s", "current, its part that flows to the north", default=0.0)
    current_east = given("m/s", "current, its part that flows to the east", default=0.0)
    T_s = given("s", "sampling interval")
    meter_side = constant("1", "side of the course change: 1 to starboard, -1 to port", default=1.0)
    meter_band = constant("rad", "heading error within which the ship counts as settled", default="0.5 deg")
    meter_from = constant("s", "time from which errors and activity are summed", default="0 s")
    meter_swing = constant("rad", "least swing of the rudder that counts as a reversal", default="0.5 deg")
    clock = state("s", "time since the order")
    overshoot = state("rad", "largest heading beyond the one ordered", start=-10.0)
    settled = state("s", "time of the last sample outside the band")
    sum_error = state("rad*s", "sum of the heading error")
    sum_error_square = state("rad^2*s", "sum of the heading error squared")
    sum_rudder_square = state("rad^2*s", "sum of the rudder angle squared")
    travel = state("rad", "distance the rudder has run")
    delta_before = state("rad", "rudder angle one sample earlier")
    delta_extreme = state("rad", "rudder angle farthest to the side it moves to")
    moving = state("1", "side the rudder moves to", start=1.0)
    reversals = state("1", "reversals of the rudder")
    reached = state("1", "1 once the heading has been within the band")
    off_most = state("m", "farthest across the new course to its right", start=-1e9)
    off_least = state("m", "farthest across the new course to its left", start=1e9)

    def error(self) -> Any:
        """Heading less heading ordered."""
        return self.psi - self.psi_order

    def counts(self) -> Any:
        """Whether this sample is summed."""
        return self.clock >= self.meter_from

    def across(self) -> Any:
        """Position across the new course, the drift of the current taken out; positive to its right."""
        north, east = self.x - self.current_north * self.clock, self.y - self.current_east * self.clock
        return east * np.cos(self.psi_order) - north * np.sin(self.psi_order)

    def summed(self, total: Any, rate: Any) -> Any:
        """A sum, with this sample where it counts."""
        return total + np.where(self.counts(), rate, 0.0 * rate) * self.T_s

    @clock.next
    def tick(self) -> Any:
        """The clock."""
        return self.clock + self.T_s

    @overshoot.next
    def beyond(self) -> Any:
        """The largest so far."""
        return np.maximum(self.overshoot, self.meter_side * self.error())

    @settled.next
    def outside(self) -> Any:
        """The time of this sample while it is outside the band."""
        return np.where(np.abs(self.error()) > self.meter_band, self.clock, self.settled)

    @sum_error.next
    def mean_error(self) -> Any:
        """For the mean."""
        return self.summed(self.sum_error, self.error())

    @sum_error_square.next
    def rms_error(self) -> Any:
        """For the root mean square."""
        return self.summed(self.sum_error_square, self.error() ** 2)

    @sum_rudder_square.next
    def rms_rudder(self) -> Any:
        """For the root mean square."""
        return self.summed(self.sum_rudder_square, self.delta**2)

    @travel.next
    def run(self) -> Any:
        """Every movement counts."""
        moved = np.abs(self.delta - self.delta_before)
        return self.travel + np.where(self.counts(), moved, 0.0 * moved)

    @delta_before.next
    def remember(self) -> Any:
        """One sample."""
        return self.delta + 0.0 * self.delta_before

    def turned(self) -> Any:
        """Whether the rudder has come back from its extreme by the least swing."""
        return self.moving * (self.delta_extreme - self.delta) > self.meter_swing

    @delta_extreme.next
    def extreme(self) -> Any:
        """The farthest to the side it moves to; a reversal starts anew."""
        farthest = self.moving * np.maximum(self.moving * self.delta_extreme, self.moving * self.delta)
        return np.where(self.turned(), self.delta, farthest)

    @moving.next
    def side(self) -> Any:
        """Turned round by a reversal."""
        return np.where(self.turned(), -self.moving, self.moving)

    @reversals.next
    def reverse(self) -> Any:
        """Counted."""
        return self.reversals + np.where(np.logical_and(self.turned(), self.counts()), 1.0, 0.0)

    @reached.next
    def arrive(self) -> Any:
        """Once within the band, for good."""
        return np.where(np.abs(self.error()) <= self.meter_band, 1.0, self.reached)

    @off_most.next
    def right(self) -> Any:
        """From the arrival on."""
        return np.where(self.reached > 0.5, np.maximum(self.off_most, self.across()), self.off_most)

    @off_least.next
    def left(self) -> Any:
        """From the arrival on."""
        return np.where(self.reached > 0.5, np.minimum(self.off_least, self.across()), self.off_least)
