"""The current: a flow of the water over the ground.

Passenier (1989), section 2.5. The direction is the one the current flows TO.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import derived, given


class UniformCurrent(Component):
    """A uniform current."""

    current_speed = given("m/s", "speed of the current", default=0.0, latex="U_c")
    current_direction = given("rad", "direction the current flows to", default=0.0, wraps=True, latex=r"\psi_c")
    current_north = derived("m/s", "current, component to the north", latex="U_{c,N}")
    current_east = derived("m/s", "current, component to the east", latex="U_{c,E}")

    @current_north.equals
    def north(self):
        """Passenier (1989), eq. (2.71)."""
        return self.current_speed * np.cos(self.current_direction)

    @current_east.equals
    def east(self):
        """Passenier (1989), eq. (2.72)."""
        return self.current_speed * np.sin(self.current_direction)
