"""Planar motion: the path of a ship over the ground, from its speeds through the water and its rate of turn.

Passenier (1989), section 2.4 and 2.5.2. North is x and east is y, the heading is counted from north to the east,
and a current is given by the direction it flows to. The thesis draws the same axes.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.guard import guard
from shipid.declaration.quantity import constant, derived, given, state

#: Below this share of the cruising speed, the equations that divide by the speed use the share instead, and turning
#: slows the ship in proportion to the speed it still has. A model that is scaled with the speed is not valid for a
#: ship that hardly moves, and its steady turn may not exist (De Keizer's runs down to u = 0 in finite time): the floor
#: keeps such a run finite and the speed positive, and the guard of `SpeedScaled` says that the model does not sail it. Above it
#: the equations are as printed.
LEAST_WAY = 0.05


class PlanarMotion(Component):
    """Position and heading of a ship in a uniform current."""

    x = state("m", "position to the north", nominal=100.0)
    y = state("m", "position to the east", nominal=100.0)
    psi = state("rad", "heading, clockwise from north", nominal="10 deg", wraps=True, latex=r"\psi")
    u = given("m/s", "forward speed through the water")
    v = given("m/s", "sway speed through the water, positive to starboard", default=0.0)
    r = given("rad/s", "rate of turn, positive to starboard")
    current_north = given("m/s", "current, component to the north", default=0.0, latex="U_{c,N}")
    current_east = given("m/s", "current, component to the east", default=0.0, latex="U_{c,E}")

    @x.rate
    def north(self):
        """Passenier (1989), eq. (2.71)."""
        return self.u * np.cos(self.psi) - self.v * np.sin(self.psi) + self.current_north

    @y.rate
    def east(self):
        """Passenier (1989), eq. (2.72)."""
        return self.u * np.sin(self.psi) + self.v * np.cos(self.psi) + self.current_east

    @psi.rate
    def turning(self):
        """The heading is the integral of the rate of turn: Passenier (1989), section 2.4."""
        return self.r


class SpeedScaled(Component):
    """Quantities of the models scaled by length and instantaneous speed; those that state the speed declare it again."""

    u = given("m/s", "forward speed through the water")
    cruise = given("m/s", "cruising speed, the speed before the manoeuvre", latex="U_0")
    L = constant("m", "length between perpendiculars")
    way = derived("m/s", "forward speed to scale with: u, not less than a twentieth of the cruise", latex="u^+")
    way_kept = guard("m/s", "the forward speed is on the model's floor, a twentieth of the cruising speed")

    @way.equals
    def speed_to_scale_with(self):
        """U in Passenier (1989), eq. (2.40) and (2.42), but at least a twentieth of the speed before the manoeuvre."""
        return np.maximum(self.u, LEAST_WAY * self.cruise)

    @way_kept.equals
    def speed_above_the_floor(self):
        """The forward speed above that floor: on it the equations are not the published ones."""
        return self.u - LEAST_WAY * self.cruise

    @property
    def way_left(self):
        """1 while the ship has way; below a twentieth of the speed before the manoeuvre, the share of it that is left."""
        return self.u / self.way
