"""Motion of another ship as a tracker sees it: constant velocity and the coordinated turn, sampled exactly.

Bar-Shalom, Li and Kirubarajan (2001), sections 6.3.2 and 11.7; Semerdjiev, Mihaylova and Li (2000), sections 2 and 4, whose X and Y
are x and y here, so that their turn rate is positive to starboard.
"""

from __future__ import annotations

import numpy as np

from shipid import Component, derived, given, join, state

#: Below this angle turned between two samples, in rad, series stand for the sines: exact to rounding, and without 0/0.
SMALL_TURN = 0.05


class ConstantVelocity(Component):
    """Straight motion at a steady speed, with accelerations that a tracker takes as noise."""

    x = state("m", "position to the north", nominal=100.0)
    y = state("m", "position to the east", nominal=100.0)
    vx = state("m/s", "velocity to the north", nominal=10.0, latex="v_x")
    vy = state("m/s", "velocity to the east", nominal=10.0, latex="v_y")
    T_s = given("s", "sampling interval")
    ax = given("m/s^2", "acceleration to the north, held over an interval", default=0.0, latex="a_x")
    ay = given("m/s^2", "acceleration to the east, held over an interval", default=0.0, latex="a_y")
    SOG = derived("m/s", "speed over the ground")
    COG = derived("rad", "course over the ground, clockwise from north", wraps=True)

    @SOG.equals
    def speed(self):
        """Length of the velocity: Bar-Shalom, Li and Kirubarajan (2001), section 6.3.2."""
        return np.sqrt(self.vx**2 + self.vy**2)

    @COG.equals
    def course(self):
        """Direction of the velocity: Bar-Shalom, Li and Kirubarajan (2001), section 6.3.2."""
        return np.arctan2(self.vy, self.vx)

    @x.next
    def north(self):
        """Bar-Shalom, Li and Kirubarajan (2001), section 6.3.2."""
        return self.x + self.T_s * self.vx + 0.5 * self.T_s**2 * self.ax

    @y.next
    def east(self):
        """Bar-Shalom, Li and Kirubarajan (2001), section 6.3.2."""
        return self.y + self.T_s * self.vy + 0.5 * self.T_s**2 * self.ay

    @vx.next
    def north_speed(self):
        """Bar-Shalom, Li and Kirubarajan (2001), section 6.3.2."""
        return self.vx + self.T_s * self.ax

    @vy.next
    def east_speed(self):
        """Bar-Shalom, Li and Kirubarajan (2001), section 6.3.2."""
        return self.vy + self.T_s * self.ay


class CoordinatedTurn(ConstantVelocity):
    """A turn at a steady speed and a rate that is given: a mode of a tracker."""

    omega = given("rad/s", "rate of turn of the course, positive to starboard", latex=r"\omega")

    def turned(self):
        """The angle turned in an interval."""
        return self.omega * self.T_s

    def along(self):
        """sin(a) / a, with a the angle turned: the way along the old course, as a share of the way sailed."""
        a = self.turned()
        small = np.abs(a) < SMALL_TURN
        divisor = np.where(small, 1.0, a)
        series = 1 - a**2 / 6 * (1 - a**2 / 20 * (1 - a**2 / 42))
        return np.where(small, series, np.sin(divisor) / divisor)

    def across(self):
        """(1 - cos(a)) / a, with a the angle turned: the way across the old course."""
        a = self.turned()
        small = np.abs(a) < SMALL_TURN
        divisor = np.where(small, 1.0, a)
        series = a / 2 * (1 - a**2 / 12 * (1 - a**2 / 30 * (1 - a**2 / 56)))
        return np.where(small, series, (1 - np.cos(divisor)) / divisor)

    def north(self):
        """Semerdjiev, Mihaylova and Li (2000), section 2, F_CT and G."""
        way = self.along() * self.vx - self.across() * self.vy
        return self.x + self.T_s * way + 0.5 * self.T_s**2 * self.ax

    def east(self):
        """Semerdjiev, Mihaylova and Li (2000), section 2, F_CT and G."""
        way = self.across() * self.vx + self.along() * self.vy
        return self.y + self.T_s * way + 0.5 * self.T_s**2 * self.ay

    def north_speed(self):
        """Semerdjiev, Mihaylova and Li (2000), section 2, F_CT and G."""
        a = self.turned()
        return np.cos(a) * self.vx - np.sin(a) * self.vy + self.T_s * self.ax

    def east_speed(self):
        """Semerdjiev, Mihaylova and Li (2000), section 2, F_CT and G."""
        a = self.turned()
        return np.sin(a) * self.vx + np.cos(a) * self.vy + self.T_s * self.ay


class CoordinatedTurnAugmented(CoordinatedTurn):
    """A coordinated turn whose rate differs from that of the mode by an estimated displacement."""

    domega = state("rad/s", "rate of turn less that of the mode", nominal=0.01, latex=r"\Delta\omega")

    def turned(self):
        """The angle turned in an interval, eq. (17)."""
        return (self.omega + self.domega) * self.T_s

    @domega.next
    def displacement(self):
        """Semerdjiev, Mihaylova and Li (2000), eq. (17), the noise left to the filter."""
        return self.domega


class ConstantVelocityAugmented(ConstantVelocity):
    """Straight motion that carries the displacement of the turning modes, without an effect."""

    omega = given("rad/s", "rate of turn of the course, positive to starboard", default=0.0, latex=r"\omega")
    domega = state("rad/s", "rate of turn less that of the mode", nominal=0.01, latex=r"\Delta\omega")

    @domega.next
    def displacement(self):
        """Semerdjiev, Mihaylova and Li (2000), eq. (16)."""
        return self.domega


class TurningAtUnknownRate(CoordinatedTurn):
    """A coordinated turn whose rate is a state."""

    omega = state("rad/s", "rate of turn of the course, positive to starboard", nominal=0.01, latex=r"\omega")

    @omega.next
    def rate(self):
        """Bar-Shalom, Li and Kirubarajan (2001), section 11.7, the noise left to the filter."""
        return self.omega


class CoordinatedCircleAugmented(CoordinatedTurn):
    """A turn by an angle in each metre sailed, at any speed: a ship with a rudder angle; part of it is estimated."""

    omega = derived("rad/s", "rate of turn of the course, positive to starboard", latex=r"\omega")
    curvature = given("rad/m", "curvature of the track, positive to starboard", latex=r"\kappa")
    dcurvature = state("rad/m", "curvature less that of the mode", nominal=0.001, latex=r"\Delta\kappa")

    @omega.equals
    def rate(self):
        """Semerdjiev and Mihaylova (2000), eq. (18), with the speed over the ground."""
        return (self.curvature + self.dcurvature) * self.SOG

    @dcurvature.next
    def displacement(self):
        """Semerdjiev and Mihaylova (2000), eq. (20), the noise left to the filter."""
        return self.dcurvature


constant_velocity = join("constant-velocity", ConstantVelocity)
coordinated_turn = join("coordinated-turn", CoordinatedTurn)
coordinated_turn_augmented = join("coordinated-turn-augmented", CoordinatedTurnAugmented)
constant_velocity_augmented = join("constant-velocity-augmented", ConstantVelocityAugmented)
coordinated_circle_augmented = join("coordinated-circle-augmented", CoordinatedCircleAugmented)
turning_at_unknown_rate = join("turning-at-unknown-rate", TurningAtUnknownRate)
