"""How high the sea is, from what the gyro shows: the recursion that sets the noise of a filter in waves.

Van Amerongen (1982) and van der Klugt (1987) let the filter follow the sea: what moves faster than the ship can is taken for
waves, and its mean square, with a memory of minutes, is their variance. The ship's own turning is taken out by two first-order
high-pass filters, for one leaves a tenth of a degree per second where the rudder is put over.
"""

from __future__ import annotations

import numpy as np

from shipid import Component, constant, derived, given, state


class WaveLevel(Component):
    """Root mean square of the rate of turn by waves, and the noise level that a filter takes for it."""

    slow = state("rad/s", "what the first filter holds for the ship's own turning")
    slower = state("rad/s", "what the second filter holds for the rest of it")
    power = state("rad^2/s^2", "mean square of what is faster than the ship")
    age = state("s", "time since the start")
    r = given("rad/s", "rate of turn as the gyro shows it, positive to starboard")
    r_expected = given("rad/s", "rate of turn that is expected of the ship, and taken off first", default=0.0)
    wave_time = constant("s", "time constant of the high-pass filters", default="3 s", latex=r"\tau_f")
    wave_frequency = constant("rad/s", "frequency of the waves", default="0.6 rad/s", latex=r"\omega_0")
    wave_memory = constant("s", "how long ago waves still count", default="200 s", latex=r"\tau_m")
    wave_margin = constant(
        "1", "level of white noise that stands for narrow-banded waves, in their root mean square", default=3.0
    )
    fast = derived("rad/s", "what is faster than the ship")
    wave_rms = derived("rad/s", "root mean square of the rate of turn by waves")
    sigma_w = derived(
        "rad/s", "standard deviation of a sample of the white noise that stands for the waves", latex=r"\sigma_w"
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
        """Van Amerongen (1982): the memory grows until it is full."""
        return 1.0

    @power.rate
    def mean_square(self):
        """Van Amerongen (1982): mean square with exponential forgetting; nothing counts until the filters have settled.

        At the start the memory is as long as the record, and not less than three time constants of the filters.
        """
        lasting = np.minimum(np.maximum(self.age - 5 * self.wave_time, 3 * self.wave_time), self.wave_memory)
        return np.where(self.age > 5 * self.wave_time, 1.0, 0.0) * (self.fast**2 - self.power) / lasting

    @wave_rms.equals
    def size(self):
        """Van Amerongen (1982), with what both filters keep of the waves' amplitude, (w tau)^2 / (1 + (w tau)^2), made up for."""
        pace = (self.wave_frequency * self.wave_time) ** 2
        return np.sqrt(np.maximum(self.power, 0.0)) * (1 + pace) / pace

    @sigma_w.equals
    def level(self):
        """Passenier (1989), section 5.3: the level the filter takes; white noise of the waves' own variance is too small for them.

        The filter of (5.29) and (5.30) passes white noise with a gain of 1 where it is sampled finely.
        """
        return self.wave_margin * self.wave_rms
