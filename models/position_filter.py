"""The position filter: speed, sway, current and position from the log and noisy fixes, with a known heading.

Passenier (1989), section 5.4. Heading and rate of turn are inputs, so the filter is linear. `own-ship-filter` is the yaw
filter and the position filter in one, with the thirteen states of the thesis, to compare with the two.

The noise levels are this project's tuning (the thesis prints none), as densities: of the current 0.02 m/s in a sample of 2 s,
a compromise between fast recovery from a change of current and a smooth track.
"""

from __future__ import annotations

import numpy as np

from shipid import Component, given, join, parameter, state
from shipid.models.van_leeuwen import VanLeeuwenSway
from shipid.models.yaw_filter import AdaptiveYaw, ColouredWavesSeven, Heading
from shipid.parts.sensors import Compass, Gyro, Log, PositionSensor
from shipid.parts.unmeasured import SlowCurrent, SlowDisturbance


class Track(Component):
    """The path of a ship whose heading is given, over the ground."""

    x = state("m", "position to the north", nominal=100.0)
    y = state("m", "position to the east", nominal=100.0)
    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    u = given("m/s", "forward speed through the water")
    v = given("m/s", "sway speed through the water, positive to starboard", default=0.0)
    current_north = given("m/s", "current, component to the north", default=0.0, latex="U_{c,N}")
    current_east = given("m/s", "current, component to the east", default=0.0, latex="U_{c,E}")

    @x.rate
    def north(self):
        """Passenier (1989), eq. (5.54) and (5.56)."""
        return self.u * np.cos(self.psi) - self.v * np.sin(self.psi) + self.current_north

    @y.rate
    def east(self):
        """Passenier (1989), eq. (5.55) and (5.57)."""
        return self.u * np.sin(self.psi) + self.v * np.cos(self.psi) + self.current_east


class SteadySpeed(Component):
    """A forward speed that changes slowly, as a random walk."""

    u = state("m/s", "forward speed through the water", nominal=1.0, spread="0.5 m/s", noise="0.035 m/s^1.5")

    @u.rate
    def keeps(self):
        """Passenier (1989), eq. (5.49): constant except for the process noise."""
        return 0.0


class SwayConstant(VanLeeuwenSway):
    """Sway speed proportional to the rate of turn, with an estimated constant."""

    gamma = parameter(
        "1",
        "sway constant gamma*: sway to port in a turn to starboard",
        start=0.45,
        low=-2.0,
        high=5.0,
        spread=0.3,
        noise="0.0031 1/s^0.5",
        dimensional="m/rad",
        latex=r"\gamma^*",
    )


class ConsistentWaves(ColouredWavesSeven):
    """The waves of `yaw-filter-seven` with a well-known start: no sensor separates psi_wave from the heading later."""

    v_f = state("rad/s", "slow part of the rate by waves", nominal="0.2 deg/s", spread="0.03 deg/s")
    psi_wave = state("rad", "heading by the waves", nominal="0.5 deg", spread="0.03 deg", latex=r"\psi_v")


position_filter = join("position-filter", Track, SteadySpeed, SwayConstant, SlowCurrent, Log, PositionSensor)
own_ship_filter = join(
    "own-ship-filter",
    ConsistentWaves,
    AdaptiveYaw,
    SlowDisturbance,
    Heading,
    SteadySpeed,
    SwayConstant,
    SlowCurrent,
    Track,
    Compass,
    Gyro,
    Log,
    PositionSensor,
)
