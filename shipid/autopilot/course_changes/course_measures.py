"""Measures of a course change: a component whose last states are overshoot, settling time and rudder activity.

Measured inside the model, a thousand runs need no more memory than one. The same component measures a recorded run.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.autopilot.course_changes.course_changes import CourseChanges
from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.quantity import constant, given, state
from shipid.foundation.aliases import Expression
from shipid.generation.simulator import make_simulator
from shipid.parts.guard_watch import DEPARTED

#: A course change is settled within this part of it, and at least half a degree.
_BAND, _LEAST_BAND = 0.02, np.deg2rad(0.5)


class CourseMeasures(Component):
    """Overshoot, settling, heading error, rudder activity and the track of a course change, or of keeping a course."""

    psi = given("rad", "heading, clockwise from north", wraps=True)
    psi_order = given("rad", "heading that is ordered")
    delta = given("rad", "rudder angle, positive turns to starboard")
    x = given("m", "position to the north")
    y = given("m", "position to the east")
    current_north = given("m/s", "current, component to the north", default=0.0)
    current_east = given("m/s", "current, component to the east", default=0.0)
    T_s = given("s", "sampling interval")
    change_side = constant("1", "side of the course change: 1 to starboard, -1 to port", default=1.0)
    settling_band = constant("rad", "heading error within which the ship counts as settled", default="0.5 deg")
    measured_from = constant("s", "time from which errors and activity are summed", default="0 s")
    least_swing = constant("rad", "least swing of the rudder that counts as a reversal", default="0.5 deg")
    clock = state("s", "time since the order")
    overshoot = state("rad", "largest heading beyond the one ordered", start=-10.0)
    error_before = state("rad", "heading error one sample earlier")
    settled = state("s", "time at which the heading was last outside the band")
    sum_error = state("rad*s", "sum of the heading error")
    sum_error_square = state("rad^2*s", "sum of the heading error squared")
    sum_rudder_square = state("rad^2*s", "sum of the rudder angle squared")
    travel = state("rad", "rudder travel")
    delta_before = state("rad", "rudder angle one sample earlier")
    delta_extreme = state("rad", "rudder angle farthest to the side it moves to")
    moving = state("1", "side the rudder moves to", start=1.0)
    reversals = state("1", "reversals of the rudder")
    reached = state("1", "1 once the heading has been within the band")
    off_most = state("m", "farthest across the new course to its right", start=-1e9)
    off_least = state("m", "farthest across the new course to its left", start=1e9)

    def error(self) -> Expression:
        """Return heading less heading ordered."""
        return self.psi - self.psi_order

    def counts(self) -> Expression:
        """Return whether this sample is summed."""
        return self.clock >= self.measured_from

    def across(self) -> Expression:
        """Return the position across the new course, the drift of the current taken out; positive to its right."""
        north, east = self.x - self.current_north * self.clock, self.y - self.current_east * self.clock
        return east * np.cos(self.psi_order) - north * np.sin(self.psi_order)

    def summed(self, total: Expression, rate: Expression) -> Expression:
        """Return a sum with this sample in it, where it counts.

        Parameters
        ----------
        total, rate : Expression
            The sum so far, and the term that is added.
        """
        return total + np.where(self.counts(), rate, 0.0 * rate) * self.T_s

    @clock.next
    def tick(self) -> Expression:
        """The clock."""
        return self.clock + self.T_s

    @overshoot.next
    def beyond(self) -> Expression:
        """The largest so far."""
        return np.maximum(self.overshoot, self.change_side * self.error())

    @settled.next
    def outside(self) -> Expression:
        """The time of this sample while it is outside the band; once inside, the time of crossing, straight between two samples.

        A time read to a whole sample would depend on the interval, which is another one in another batch of runs.
        """
        before, now = np.abs(self.error_before), np.abs(self.error())
        back = (self.settling_band - now) / np.maximum(before - now, 1e-9 * self.settling_band)
        crossed = np.where(before > self.settling_band, self.clock - back * self.T_s, self.settled)
        return np.where(now > self.settling_band, self.clock, crossed)

    @error_before.next
    def remember_error(self) -> Expression:
        """One sample."""
        return self.error() + 0.0 * self.error_before

    @sum_error.next
    def mean_error(self) -> Expression:
        """For the mean."""
        return self.summed(self.sum_error, self.error())

    @sum_error_square.next
    def rms_error(self) -> Expression:
        """For the root mean square."""
        return self.summed(self.sum_error_square, self.error() ** 2)

    @sum_rudder_square.next
    def rms_rudder(self) -> Expression:
        """For the root mean square."""
        return self.summed(self.sum_rudder_square, self.delta**2)

    @travel.next
    def run(self) -> Expression:
        """Every movement counts."""
        moved = np.abs(self.delta - self.delta_before)
        return self.travel + np.where(self.counts(), moved, 0.0 * moved)

    @delta_before.next
    def remember(self) -> Expression:
        """One sample."""
        return self.delta + 0.0 * self.delta_before

    def turned(self) -> Expression:
        """Return whether the rudder has come back from its extreme by the least swing."""
        return self.moving * (self.delta_extreme - self.delta) > self.least_swing

    @delta_extreme.next
    def extreme(self) -> Expression:
        """The farthest to the side it moves to; a reversal starts anew."""
        farthest = self.moving * np.maximum(self.moving * self.delta_extreme, self.moving * self.delta)
        return np.where(self.turned(), self.delta, farthest)

    @moving.next
    def side(self) -> Expression:
        """The other side after a reversal."""
        return np.where(self.turned(), -self.moving, self.moving)

    @reversals.next
    def reverse(self) -> Expression:
        """Counted."""
        return self.reversals + np.where(np.logical_and(self.turned(), self.counts()), 1.0, 0.0)

    @reached.next
    def arrive(self) -> Expression:
        """1 from the first sample within the band on."""
        return np.where(np.abs(self.error()) <= self.settling_band, 1.0, self.reached)

    @off_most.next
    def right(self) -> Expression:
        """From the arrival on."""
        return np.where(self.reached > 0.5, np.maximum(self.off_most, self.across()), self.off_most)

    @off_least.next
    def left(self) -> Expression:
        """From the arrival on."""
        return np.where(self.reached > 0.5, np.minimum(self.off_least, self.across()), self.off_least)


def settings_of(changes: np.ndarray, begin: np.ndarray) -> dict[str, np.ndarray]:
    """Return the constants of `CourseMeasures` for some course changes.

    Parameters
    ----------
    changes : ndarray, shape (runs,)
        In rad.
    begin : ndarray, shape (runs,)
        Time in s from which errors and activity are summed.
    """
    band = np.maximum(_BAND * np.abs(changes), _LEAST_BAND)
    return {"change_side": sides_of(changes), "settling_band": band, "measured_from": begin}


def sides_of(changes: np.ndarray) -> np.ndarray:
    """Return the side of each course change: -1 to port, otherwise 1.

    Parameters
    ----------
    changes : ndarray, shape (runs,)
        In rad.
    """
    return np.where(changes < 0, -1.0, 1.0)


def read_measures(
    end: Mapping[str, np.ndarray], speeds: np.ndarray, changes: np.ndarray, duration: np.ndarray, begin: np.ndarray
) -> CourseChanges:
    """Return the measures of some runs from the last states of `CourseMeasures`.

    Parameters
    ----------
    end : mapping of str to ndarray, shape (runs,)
        The last states of the model by name; a run with one that is not finite has diverged, and one
        that has left the range of its model has no measures either.
    speeds, changes : ndarray, shape (runs,)
        Speed before the change in m/s, and the change in rad.
    duration, begin : ndarray, shape (runs,)
        Of the run, and the time from which errors and activity were summed, in s.
    """
    good = np.isfinite(np.stack(list(end.values()))).all(axis=0)
    good &= ~(end.get(DEPARTED, np.zeros(good.shape)) > 0.5)
    span = duration - begin
    settled = end["settled"] + duration / 1e9
    found = {
        "overshoot": np.maximum(end["overshoot"], 0.0),
        # Outside the band until the very end: it never settled.
        "settling": np.where(end["settled"] > 0.98 * duration, np.inf, settled),
        "mean_error": end["sum_error"] / span,
        "rms_error": np.sqrt(np.maximum(end["sum_error_square"], 0.0) / span),
        "rms_rudder": np.sqrt(np.maximum(end["sum_rudder_square"], 0.0) / span),
        "reversals": end["reversals"] / span * 60.0,
        "travel": end["travel"] / span,
        "cross_track": np.where(end["reached"] > 0.5, end["off_most"] - end["off_least"], np.inf),
    }
    return CourseChanges(
        speed=speeds, change=changes, duration=duration, **{n: np.where(good, v, np.nan) for n, v in found.items()}
    )


def measure_history(history: Mapping[str, np.ndarray], speed: float, change: float) -> CourseChanges:
    """Return the measures of a recorded course change, by the same component.

    Parameters
    ----------
    history : mapping of str to ndarray, shape (n,)
        ``t``, evenly spaced, ``psi``, ``psi_order``, ``delta``, ``x``, ``y``, ``current_north`` and ``current_east``, SI.
    speed, change : float
        Speed before the change in m/s, and the change in rad.

    Returns
    -------
    CourseChanges
        Of one run.
    """
    model = join("course-measures", CourseMeasures)
    simulator = make_simulator(model, model.states, hold="zero")
    t = history["t"] - history["t"][0]
    interval = float(t[1])
    # The states after the last sample: a sample more, which is not measured.
    longer = {n: np.append(v, v[-1]) for n, v in history.items() if n in model.inputs}
    changes, begin = np.array([change]), np.zeros(1)
    first = float(history["delta"][0])
    settings = {n: float(v[0]) for n, v in settings_of(changes, begin).items()}
    start = {"moving": settings["change_side"], "delta_before": first, "delta_extreme": first}
    run = simulator(interval * np.arange(t.size + 1), settings, longer, start)
    end = {n: column[-1:] for n, column in run.columns.items()}
    return read_measures(end, np.array([speed]), changes, np.array([t.size * interval]), begin)
