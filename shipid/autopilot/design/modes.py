"""Other modes of an autopilot: rate of turn held for a helmsman, and a course kept without answering every wave.

Each states ``delta_order`` from ``psi_seen`` and ``r_seen`` as the course controller does, and takes its place in the loop.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from shipid.autopilot.design.control_law import CourseController
from shipid.autopilot.design.plant import Plant
from shipid.autopilot.errors import DesignRequestError
from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, derived, given, state


class RateController(Component):
    """A rate of turn held, as a helmsman orders it: proportional and integral, within the rudder limit."""

    r_order = given("rad/s", "rate of turn that is ordered", latex="r_r")
    r_seen = given("rad/s", "rate of turn the autopilot sees")
    rate_gain = constant("s", "rudder per error of the rate of turn")
    rate_integral = constant("1", "rudder per heading lost to the error")
    rudder_limit = constant("rad", "largest rudder angle the autopilot orders", default="15 deg")
    heading_lost = state("rad", "integral of the error of the rate of turn")
    rudder_wanted = derived("rad", "rudder the law asks for before the limit")
    delta_order = derived("rad", "rudder angle that is ordered, positive turns to starboard", latex=r"\delta_r")

    @heading_lost.rate
    def lose(self) -> Any:
        """The integral stands still while the law asks for more than the limit."""
        error = self.r_order - self.r_seen
        return np.where(np.abs(self.rudder_wanted) < self.rudder_limit, error, 0.0 * error)

    @rudder_wanted.equals
    def law(self) -> Any:
        """Proportional to the rate ordered less the one kept, and to what was lost of the heading."""
        return self.rate_gain * (self.r_order - self.r_seen) + self.rate_integral * self.heading_lost

    @delta_order.equals
    def limited(self) -> Any:
        """Within the rudder limit."""
        return np.minimum(np.maximum(self.rudder_wanted, -self.rudder_limit), self.rudder_limit)


class CourseKeeper(CourseController):
    """A course kept with a dead band: the rudder rests while the heading is off by less, and the rate is still damped.

    The band follows the sea: ``sea_state`` times what one unit of it yaws the ship.
    """

    sea_state = given("1", "setting for the sea: 0 calm, 1 for waves that yaw the ship by the band", default=0.0)
    dead_band = constant("rad", "heading error that is let go at a setting of 1", default="1 deg")

    def law(self) -> Any:
        """Passenier (1989), eq. (3.45), of the part of the error beyond the band (van Amerongen 1982, course keeping)."""
        error = self.psi_order - self.psi_seen
        band = self.sea_state * self.dead_band
        beyond = error - np.minimum(np.maximum(error, -band), band)
        return self.gain_Kp * beyond - self.gain_Kd * self.r_seen


def place_rate(plant: Plant, omega: float, damping: float) -> tuple[float, float]:
    """Return ``rate_gain`` [s] and ``rate_integral`` [1] that place the poles of the loop of the rate of turn.

    Parameters
    ----------
    plant : Plant
        One condition, from the rudder; of first order in the rate, where the two poles are all there are, or of a higher one,
        where they are two of them.
    omega : float
        Natural frequency in rad/s.
    damping : float
        Damping ratio.

    Raises
    ------
    DesignRequestError
        If frequency or damping are not greater than zero.
    """
    from shipid.autopilot.design.placement import place, pole_pair

    if not omega > 0 or not damping > 0:
        raise DesignRequestError(f"poles of {omega:g} rad/s and damping {damping:g} are none: give numbers above zero.")
    # The integral of the rate is a heading: the loop is that of heading and rate fed back, its order a ramp.
    gains = place(plant, pole_pair(omega, damping))
    return gains.Kd, gains.Kp
