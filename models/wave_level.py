"""The level of the waves from the gyro: the recursion that sets the noise of a filter in waves.

Van Amerongen (1982) and van der Klugt (1987) adapt the filter to the waves: motion too fast for the ship is taken for waves,
and its mean square over some minutes is their variance. Two first-order high-pass filters remove the ship's own turning; one
alone would leave 0.1 deg/s when the rudder is put over.
"""

from __future__ import annotations

import numpy as np

from shipid import Component, constant, derived, given, state


class WaveLevel(Component):
    """Root mean square of the rate of turn by waves, and the noise level of a filter in these waves."""

    slow = state("rad/s", "low-pass state of the first filter: the ship's own turning")
    slower = state("rad/s", "low-pass state of the second filter")
    power = state("rad^2/s^2", "mean square of the high-passed rate of turn")
    age = state("s", "time since the start")
    r = given("rad/s", "rate of turn as the gyro shows it, positive to starboard")
    r_expected = given("rad/s", "expected rate of turn of the ship, subtracted first", default=0.0)
    wave_time = constant("s", "time constant of the high-pass filters", default="3 s", latex=r"\tau_f")
    wave_frequency = constant("rad/s", "frequency of the waves", default="0.6 rad/s", latex=r"\omega_0")
    wave_memory = constant("s", "memory of the mean square", default="200 s", latex=r"\tau_m")
    wave_margin = constant(
        "1", "level of the equivalent white noise over the root mean square of the narrow-band waves", default=3.0
    )
    fast = derived("rad/s", "high-passed rate of turn")
    wave_rms = derived("rad/s", "root mean square of the rate of turn by waves")
    sigma_w = derived(
        "rad/s", "standard deviation of a sample of the white noise equivalent to the waves", latex=r"\sigma_w"
    )

    def once(self):
        """After the first high-pass filter."""
        return self.r - self.r_expected - self.slow

    @fast.equals
    def faster_than_the_ship(self):
        """Van der Klugt (1987), as in Passenier (1989), eq. (5.29) and (5.30), applied twice."""
        return self.once() - self.slower

    @slow.rate
    def first(self):
        """Passenier (1989), eq. (5.29), continuous."""
        return self.once() / self.wave_time

    @slower.rate
    def second(self):
        """Passenier (1989), eq. (5.29), continuous."""
        return (self.once() - self.slower) / self.wave_time

    @age.rate
    def clock(self):
        """Van Amerongen (1982): the memory grows to its limit."""
        return 1.0

    @power.rate
    def mean_square(self):
        """Van Amerongen (1982): mean square with exponential forgetting; it starts when the filters have settled.

        At the start the memory is as long as the record, and not less than three time constants of the filters.
        """
        lasting = np.minimum(np.maximum(self.age - 5 * self.wave_time, 3 * self.wave_time), self.wave_memory)
        return np.where(self.age > 5 * self.wave_time, 1.0, 0.0) * (self.fast**2 - self.power) / lasting

    @wave_rms.equals
    def size(self):
        """Van Amerongen (1982), divided by the gain of both filters at the wave frequency, (w tau)^2 / (1 + (w tau)^2)."""
        pace = (self.wave_frequency * self.wave_time) ** 2
        return np.sqrt(np.maximum(self.power, 0.0)) * (1 + pace) / pace

    @sigma_w.equals
    def level(self):
        """Passenier (1989), section 5.3: the level of the filter; white noise of the waves' own variance is too small.

        The filter of (5.29) and (5.30) passes white noise with a gain of 1 where it is sampled finely.
        """
        return self.wave_margin * self.wave_rms
