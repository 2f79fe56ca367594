"""What every manoeuvre of a ship stays within, whatever the model: guards to join with a model that is simulated.

A linear model turns as fast as one likes, and a cubic one may turn to infinity. The two limits are far from what ships do, so
that a run that passes them is none of a ship: with full rudder ships turn in circles of about two lengths or more, and keep a
quarter to two thirds of their speed.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.guard import guard
from shipid.declaration.model import Model
from shipid.declaration.quantity import constant, given

#: Rate of turn, as r L/U with the speed of the approach: at that speed, a circle of 1.3 ship lengths.
FASTEST_TURN = 1.5
#: Share of the approach speed.
LEAST_SPEED = 0.2


class ManoeuvringRange(Component):
    """Limits of the rate of turn and of the loss of speed that no ship passes in a manoeuvre."""

    r = given("rad/s", "rate of turn, positive to starboard")
    u = given("m/s", "forward speed through the water")
    cruise = given("m/s", "cruising speed, the speed before the manoeuvre", latex="U_0")
    L = constant("m", "length between perpendiculars")
    turn_of_a_ship = guard("rad/s", "it turns faster than any ship: r L/U above 1.5, a circle of 1.3 lengths")
    speed_of_a_ship = guard("m/s", "it keeps less than a fifth of the speed before the manoeuvre, less than any ship")

    @turn_of_a_ship.equals
    def slow_enough(self):
        """A circle of diameter D at the speed of the approach has r L/U = 2 L/D."""
        return FASTEST_TURN * self.cruise / self.L - np.abs(self.r)

    @speed_of_a_ship.equals
    def fast_enough(self):
        """A fifth of the approach speed."""
        return self.u - LEAST_SPEED * self.cruise


def manoeuvring_range(model: Model) -> tuple[type[Component], ...]:
    """Return the guards to join with a model whose manoeuvres are simulated from a steady approach.

    Parameters
    ----------
    model : Model
        A ship model; one without a rate of turn has no such guards.
    """
    return (ManoeuvringRange,) if "r" in model else ()
