"""The motion of another ship as radar sees her: position and velocity over the ground, straight on or in a steady turn.

Each is driven by white noise; `turn` and `curvature` tell the modes of a multiple-model tracker apart, and `more` is the
part of them that is estimated (Semerdjiev, Mihaylova and Li, 2000).
"""

from __future__ import annotations

import numpy as np

from shipid import Component, given, join, state


class GroundTrack(Component):
    """Position over the ground."""

    x = state("m", "position, north", nominal=100.0)
    y = state("m", "position, east", nominal=100.0)
    vx = given("m/s", "velocity over the ground, north")
    vy = given("m/s", "velocity over the ground, east")

    @x.rate
    def north(self):
        """Bar-Shalom, Li and Kirubarajan (2001), section 6.2: position is the integral of velocity."""
        return self.vx

    @y.rate
    def east(self):
        """Bar-Shalom, Li and Kirubarajan (2001), section 6.2: position is the integral of velocity."""
        return self.vy


class SteadyTurn(Component):
    """Velocity of constant size that turns at a given rate: zero is a straight course."""

    vx = state("m/s", "velocity over the ground, north", nominal=1.0, noise="0.25 m/s^1.5")
    vy = state("m/s", "velocity over the ground, east", nominal=1.0, noise="0.25 m/s^1.5")
    more = state("rad/s", "rate of turn beyond the given one", nominal=0.01)
    turn = given("rad/s", "rate of turn, positive to starboard", default=0.0)

    @vx.rate
    def north(self):
        """Bar-Shalom, Li and Kirubarajan (2001), section 11.7: coordinated turn."""
        return -(self.turn + self.more) * self.vy

    @vy.rate
    def east(self):
        """Bar-Shalom, Li and Kirubarajan (2001), section 11.7: coordinated turn."""
        return (self.turn + self.more) * self.vx

    @more.rate
    def keeps(self):
        """Bar-Shalom, Li and Kirubarajan (2001), section 11.7: a constant with noise."""
        return 0.0


class SteadyCircle(Component):
    """Velocity that turns by a given angle in each metre sailed: a ship with a rudder angle, whatever her speed."""

    vx = state("m/s", "velocity over the ground, north", nominal=1.0, noise="0.25 m/s^1.5")
    vy = state("m/s", "velocity over the ground, east", nominal=1.0, noise="0.25 m/s^1.5")
    more = state("rad/m", "curvature of the track beyond the given one", nominal=0.001)
    curvature = given("rad/m", "curvature of the track, positive to starboard", default=0.0)

    @vx.rate
    def north(self):
        """Semerdjiev and Mihaylova (2000), eq. (16)-(20), in velocities along the axes of the earth."""
        return -(self.curvature + self.more) * np.sqrt(self.vx**2 + self.vy**2) * self.vy

    @vy.rate
    def east(self):
        """Semerdjiev and Mihaylova (2000), eq. (16)-(20), in velocities along the axes of the earth."""
        return (self.curvature + self.more) * np.sqrt(self.vx**2 + self.vy**2) * self.vx

    @more.rate
    def keeps(self):
        """Semerdjiev and Mihaylova (2000): a constant with noise."""
        return 0.0


target_turn = join("target-turn", SteadyTurn, GroundTrack)
target_circle = join("target-circle", SteadyCircle, GroundTrack)
