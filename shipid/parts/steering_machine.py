"""The steering machine: from the rudder order to the rudder angle.

Passenier (1989), section 2.3.4: a limit of the angle, then a limit of its rate.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, given, state
from shipid.declaration.units import factor
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import ParameterSetError
from shipid.foundation.numbers import brief

#: What a steering gear can do: name, words, SI unit, unit shown, and the most of it.
GEAR = {
    "delta_max": ("the largest rudder angle", "rad", "deg", 90.0),
    "delta_rate": ("the largest rudder rate", "rad/s", "deg/s", 360.0),
}


class SteeringMachine(Component):
    """A servo with a limited angle and a limited rate."""

    delta = state("rad", "rudder angle, positive turns to starboard", nominal="10 deg", latex=r"\delta")
    delta_order = given("rad", "rudder angle that is ordered, positive turns to starboard", latex=r"\delta_r")
    delta_max = constant("rad", "largest rudder angle", latex=r"\delta_{\max}")
    delta_rate = constant("rad/s", "largest rate of the rudder", latex=r"\dot\delta_{\max}")
    tau_delta = constant("s", "time constant of the servo inside its limits", default="0.5 s", latex=r"\tau_\delta")

    @delta.rate
    def servo(self):
        """Passenier (1989), fig. 2.9.

        The figure has no lag inside the limits; a short one (assumed, half a second) keeps the machine a smooth
        differential equation near the order.
        """
        return self.towards_order(self.delta)

    def towards_order(self, angle: Expression) -> Expression:
        """Return the rate in rad/s at which the machine moves a rudder towards the order.

        Parameters
        ----------
        angle : Expression
            Where the rudder is, in rad.
        """
        order = np.minimum(np.maximum(self.delta_order, -self.delta_max), self.delta_max)
        wanted = (order - angle) / self.tau_delta
        return np.minimum(np.maximum(wanted, -self.delta_rate), self.delta_rate)


def check_gear(name: str, value: float, ship: str) -> None:
    """Refuse a rudder angle or rate that no steering gear has: a rudder that never moves, or an angle in another unit than it says.

    Parameters
    ----------
    name : {"delta_max", "delta_rate"}
        The particular.
    value : float
        rad or rad/s.
    ship : str
        Whose.

    Raises
    ------
    ParameterSetError
        With what it may be.
    """
    words, si, unit, most = GEAR[name]
    shown = value * factor(si, unit)
    if not 0 < shown <= most * (1 + 1e-9):
        raise ParameterSetError(
            f"{words} {name} of ship {ship} is {brief(shown, 4)} {unit}: give one above zero, to {most:g} {unit}."
        )
