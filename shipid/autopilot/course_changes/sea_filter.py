"""A wave filter without a model of the ship: a notch at the frequency of encounter, and a roll-off above it.

The notch alone makes a rudder restless: it takes away the long swings of the waves, and what is left of the rate of turn, above
the frequency of encounter, falls only with the frequency. The rudder then reverses more often than without a filter, by less.

It replaces `Measured`. A Kalman filter, which has a model of the ship, removes more of the waves.
"""

from __future__ import annotations

from shipid.autopilot.design.control_law import Measured
from shipid.declaration.quantity import constant, state
from shipid.foundation.aliases import Expression

#: Damping of the poles of the notch: wide enough for the spread of the waves.
WIDTH = 0.7
#: The notch stays this many times above the natural frequency of the heading, where its lag costs little phase.
ABOVE = 4.0
#: The lag has its corner this many times above it: of slow ships in quick waves little is left of the waves.
LAG = 8.0


class SeaFiltered(Measured):
    """Feedback through a notch and a first-order lag: heading and rate of turn with the waves removed."""

    sea_frequency = constant("rad/s", "frequency of encounter the filter is set to", default="0.6 rad/s")
    sea_depth = constant("1", "setting of the filter: 0 in a calm sea, no filter; 1 the whole filter", default=1.0)
    sea_width = constant("1", "damping ratio of the notch", default=WIDTH)
    sea_lag = constant("rad/s", "corner frequency of the lag", default="0.6 rad/s")
    psi_swing = state("rad*s^2", "heading by the waves, twice integrated", nominal=0.01)
    psi_band = state("rad*s", "heading in the band of the waves, integrated", nominal=0.01)
    r_swing = state("rad*s", "rate of turn by the waves, twice integrated", nominal=0.01)
    r_band = state("rad", "rate of turn in the band of the waves, integrated", nominal=0.01)
    psi_smooth = state("rad", "heading behind notch and lag", nominal=0.01)
    r_smooth = state("rad/s", "rate of turn behind notch and lag", nominal=0.01)

    def band(self, shown: Expression, swing: Expression, moving: Expression) -> Expression:
        """Return the rate of a band pass, ``s / (s^2 + 2 zeta omega s + omega^2)``.

        Parameters
        ----------
        shown, swing, moving : Expression
            The filtered signal, and the two states of the filter.
        """
        return shown - 2 * self.sea_width * self.sea_frequency * moving - self.sea_frequency**2 * swing

    @psi_swing.rate
    def swing_heading(self) -> Expression:
        """The band pass of the heading."""
        return self.psi_band

    @psi_band.rate
    def band_heading(self) -> Expression:
        """The band pass of the heading."""
        return self.band(self.psi + self.psi_wave, self.psi_swing, self.psi_band)

    @r_swing.rate
    def swing_rate(self) -> Expression:
        """The band pass of the rate of turn."""
        return self.r_band

    @r_band.rate
    def band_rate(self) -> Expression:
        """The band pass of the rate of turn."""
        return self.band(self.r + self.r_wave, self.r_swing, self.r_band)

    def notched(self, shown: Expression, moving: Expression) -> Expression:
        """Return a signal through the notch: less its band, van Amerongen (1982), at the frequency of encounter.

        Parameters
        ----------
        shown, moving : Expression
            The signal, and its state of the band pass.
        """
        return shown - 2 * self.sea_width * self.sea_frequency * moving

    @psi_smooth.rate
    def smooth_heading(self) -> Expression:
        """A first-order lag behind the notch."""
        return self.sea_lag * (self.notched(self.psi + self.psi_wave, self.psi_band) - self.psi_smooth)

    @r_smooth.rate
    def smooth_rate(self) -> Expression:
        """A first-order lag behind the notch."""
        return self.sea_lag * (self.notched(self.r + self.r_wave, self.r_band) - self.r_smooth)

    def heading(self) -> Expression:
        """Return the heading through notch and lag, as far as the filter is set."""
        shown = self.psi + self.psi_wave
        return shown + self.sea_depth * (self.psi_smooth - shown)

    def rate(self) -> Expression:
        """Return the rate of turn through the same notch and lag."""
        shown = self.r + self.r_wave
        return shown + self.sea_depth * (self.r_smooth - shown)
