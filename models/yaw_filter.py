"""The yaw filter: it removes the waves from heading and rate of turn, and estimates the yaw coefficients.

Passenier (1989), section 5.3. The thesis estimates the sampled coefficients a_s and b_s, which change with the speed; here
the states are 1/tau* and K*/tau*, which do not change with it. `yaw-filter` has six states:
the heading by waves is a multiple of v_f. `yaw-filter-seven` has the seven of the thesis, of which two cannot be separated.

The noise levels are this project's tuning for a 226 m container ship sampled every 0.4 s (the thesis prints none): waves of
0.15 deg/s, taken three times as strong, since the filter models narrow-band waves as white noise.
Noise of states and coefficients is a density, so that it means the same at another sampling interval.
"""

from __future__ import annotations

from shipid import Component, derived, given, join, parameter, state
from shipid.parts.planar_motion import SpeedScaled
from shipid.parts.sensors import Compass, Gyro
from shipid.parts.unmeasured import SlowDisturbance
from shipid.parts.waves import ColouredWaves


class AdaptiveYaw(SpeedScaled):
    """First-order yaw scaled by a speed that is given, in the coefficients a filter estimates."""

    a = parameter(
        "1",
        "yaw acceleration per rudder angle, K*/tau*",
        start=1.0,
        low=-20.0,
        high=20.0,
        spread=1.0,
        noise="3.2e-4 1/s^0.5",
        dimensional="1/s^2",
    )
    b1 = parameter(
        "1",
        "yaw damping, 1/tau*",
        start=2.0,
        low=-20.0,
        high=20.0,
        spread=1.0,
        noise="3.2e-4 1/s^0.5",
        dimensional="1/s",
        latex="b_1",
    )
    r = state(
        "rad/s",
        "rate of turn, positive to starboard",
        nominal="0.5 deg/s",
        spread="0.3 deg/s",
        noise="3.2e-5 rad/s^1.5",
    )
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    K = derived("1", "yaw gain K*", latex="K^*")
    tau = derived("1", "yaw time constant tau*", latex=r"\tau^*")

    @r.rate
    def yaw(self):
        """Passenier (1989), eq. (5.1), with the wind as in (5.13)."""
        pace = self.way / self.L
        return pace**2 * self.a * self.delta - pace * self.b1 * self.r + self.r_disturbance

    @K.equals
    def gain(self):
        """Passenier (1989), eq. (5.4) and (5.5), solved for K*."""
        return self.a / self.b1

    @tau.equals
    def time_constant(self):
        """Passenier (1989), eq. (5.4), solved for tau*."""
        return 1 / self.b1

    @a.instead
    def acceleration(self):
        """Passenier (1989), eq. (5.5)."""
        return self.K / self.tau

    @b1.instead
    def damping(self):
        """Passenier (1989), eq. (5.4)."""
        return 1 / self.tau


class Heading(Component):
    """The heading as the integral of a rate of turn, without a path."""

    psi = state("rad", "heading, clockwise from north", nominal="10 deg", wraps=True, spread="1 deg", latex=r"\psi")
    r = given("rad/s", "rate of turn, positive to starboard")

    @psi.rate
    def turning(self):
        """Passenier (1989), eq. (5.37)."""
        return self.r


class ColouredWavesSeven(ColouredWaves):
    """The yaw motion by waves with the heading by waves as a state of its own, as in the thesis.

    psi_wave and tau_f v_f sum the same differences, so that a constant part of psi_wave cannot be observed: an initial
    error of psi_wave stays in the heading.
    """

    psi_wave = state("rad", "heading by the waves", nominal="0.5 deg", spread="1 deg", latex=r"\psi_v")

    @psi_wave.next
    def heading(self):
        """Passenier (1989), eq. (5.40)."""
        return self.psi_wave + self.T_s * (self.wave_noise - self.v_f)


yaw_filter = join("yaw-filter", AdaptiveYaw, SlowDisturbance, ColouredWaves, Heading, Compass, Gyro)
yaw_filter_seven = join("yaw-filter-seven", ColouredWavesSeven, AdaptiveYaw, SlowDisturbance, Heading, Compass, Gyro)
