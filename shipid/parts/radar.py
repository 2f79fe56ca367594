"""What a radar shows of a ship: range and bearing from where it stands."""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, derived, given, output


class Radar(Component):
    """Range and true bearing of a ship from a radar; the radar stands at the origin unless its position is given."""

    x = given("m", "position to the north")
    y = given("m", "position to the east")
    radar_x = given("m", "position of the radar to the north", default=0.0)
    radar_y = given("m", "position of the radar to the east", default=0.0)
    least = constant("m", "range below which a radar shows no bearing", default="1 m", latex=r"\rho_0")
    distance = derived("m", "distance from the radar, not below the least range", latex=r"\rho")
    direction = derived("rad", "bearing from the radar, clockwise from north", wraps=True, latex=r"\theta")
    range = output("m", "range shown by the radar", measures="distance", noise="20 m")
    bearing = output("rad", "bearing shown by the radar", measures="direction", noise="0.5 deg")

    @distance.equals
    def reach(self):
        """Distance in the plane; with the floor its slope exists at the radar too."""
        north, east = self.x - self.radar_x, self.y - self.radar_y
        return np.sqrt(np.maximum(north**2 + east**2, self.least**2))

    @direction.equals
    def sight(self):
        """Direction in the plane; within the least range it counts as that of a point so far to the north."""
        north, east = self.x - self.radar_x, self.y - self.radar_y
        return np.arctan2(east, np.where(north**2 + east**2 < self.least**2, self.least, north))

    @range.equals
    def range_shown(self):
        """Semerdjiev and Mihaylova (2000), section 4.3: the first polar measurement."""
        return self.distance

    @bearing.equals
    def bearing_shown(self):
        """Semerdjiev and Mihaylova (2000), section 4.3: the second polar measurement."""
        return self.direction
