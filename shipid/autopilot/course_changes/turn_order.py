"""A course change under an autopilot that holds a rate of turn: the rate is ordered until its integral is the change."""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, derived, given, state
from shipid.foundation.aliases import Expression

#: Radius of the turn in ship lengths: a planned bend, a mile for a ship of 230 m.
RADIUS = 8.0


class TurnOrder(Component):
    """A rate of turn ordered until its integral is the course change; the last sample takes the rest."""

    psi_order = given("rad", "heading at the end of the turn", latex=r"\psi_r")
    T_s = given("s", "sampling interval")
    turn_rate = constant("rad/s", "rate of the turn")
    psi_ramp = state("rad", "heading that is due", nominal="10 deg")
    r_order = derived("rad/s", "rate of turn that is ordered, positive to starboard", latex="r_r")

    @r_order.equals
    def rate(self) -> Expression:
        """At most the rate of the turn, to the side of the rest of the change."""
        left = (self.psi_order - self.psi_ramp) / self.T_s
        return np.minimum(np.maximum(left, -self.turn_rate), self.turn_rate)

    @psi_ramp.next
    def due(self) -> Expression:
        """The integral of the rate that is ordered."""
        return self.psi_ramp + self.T_s * self.r_order
