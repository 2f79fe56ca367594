"""What the instruments on board show: the quantity, the waves where a wave model is joined, and noise.

The standard deviations are those of the simulated instruments in this project's studies; a filter may be given
others. Passenier (1989), section 5.2 and 5.3: waves move the heading and its rate, and not the path.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.declaration.component import Component, declared_quantities
from shipid.declaration.model import Model
from shipid.declaration.quantity import constant, given, output, parameter, state
from shipid.declaration.units import to_si


class Compass(Component):
    """The gyro compass."""

    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    psi_wave = given("rad", "heading by the waves", default=0.0, latex=r"\psi_v")
    compass = output("rad", "heading shown by the compass", measures="psi", noise="0.2 deg")

    @compass.equals
    def reading(self):
        """Passenier (1989), section 5.3: the heading with the wave motion added."""
        return self.psi + self.psi_wave


class Gyro(Component):
    """The rate gyro."""

    r = given("rad/s", "rate of turn, positive to starboard")
    r_wave = given("rad/s", "rate of turn by the waves", default=0.0, latex="r_v")
    gyro = output("rad/s", "rate of turn shown by the gyro", measures="r", noise="0.02 deg/s")

    @gyro.equals
    def reading(self):
        """Passenier (1989), eq. (5.21): the rate of turn with the wave motion added."""
        return self.r + self.r_wave


class Log(Component):
    """The log: forward speed through the water."""

    u = given("m/s", "forward speed through the water")
    log = output("m/s", "forward speed shown by the log", measures="u", noise="0.1 m/s")

    @log.equals
    def reading(self):
        """Passenier (1989), section 5.4: the log shows the speed through the water."""
        return self.u


class PositionSensor(Component):
    """A position fix on each axis."""

    x = given("m", "position to the north")
    y = given("m", "position to the east")
    fix_north = output("m", "position to the north by the fix", measures="x", noise="10 m")
    fix_east = output("m", "position to the east by the fix", measures="y", noise="10 m")

    @fix_north.equals
    def north(self):
        """Passenier (1989), section 5.4: the fix shows the position over the ground."""
        return self.x

    @fix_east.equals
    def east(self):
        """Passenier (1989), section 5.4: the fix shows the position over the ground."""
        return self.y


class FaultyCompass(Component):
    """A compass that follows the heading late, and with an offset; it joins in the place of `Compass`."""

    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    psi_wave = given("rad", "heading by the waves", default=0.0, latex=r"\psi_v")
    psi_behind = state("rad", "heading the card has reached", wraps=True, nominal="10 deg", latex=r"\psi_c")
    psi_offset = parameter(
        "rad", "offset of the compass", start=0.0, low=-0.3, high=0.3, nominal=0.01, latex=r"\Delta\psi"
    )
    # The bound keeps steps of half a second stable.
    tau_compass = parameter("s", "lag of the compass", start=1.0, low=0.25, high=20.0, latex=r"\tau_c")
    compass = output("rad", "heading shown by the compass", measures="psi", noise="0.2 deg")

    @psi_behind.rate
    def follow(self):
        """A first-order lag; Passenier (1989), section 5.3, has none. A heading behind it wraps with the heading itself."""
        ahead = self.psi + self.psi_wave - self.psi_behind
        # The short way round, so that a card at 000 reaches 359 through north.
        return np.arctan2(np.sin(ahead), np.cos(ahead)) / self.tau_compass

    @compass.equals
    def reading(self):
        """Passenier (1989), section 5.3, with lag and offset."""
        return self.psi_behind + self.psi_offset


class FaultyGyro(Component):
    """A rate gyro with a bias and a scale error; it joins in the place of `Gyro`."""

    r = given("rad/s", "rate of turn, positive to starboard")
    r_wave = given("rad/s", "rate of turn by the waves", default=0.0, latex="r_v")
    r_bias = parameter("rad/s", "bias of the gyro", start=0.0, low=-0.01, high=0.01, nominal=1e-4, latex="b_r")
    r_scale = parameter("1", "scale of the gyro", start=1.0, low=0.5, high=2.0, latex="s_r")
    gyro = output("rad/s", "rate of turn shown by the gyro", measures="r", noise="0.02 deg/s")

    @gyro.equals
    def reading(self):
        """Passenier (1989), eq. (5.21), with scale and bias."""
        return self.r_scale * (self.r + self.r_wave) + self.r_bias


class FaultyLog(Component):
    """A log with a scale error; it joins in the place of `Log`."""

    u = given("m/s", "forward speed through the water")
    u_scale = parameter("1", "scale of the log", start=1.0, low=0.5, high=2.0, latex="s_u")
    log = output("m/s", "forward speed shown by the log", measures="u", noise="0.1 m/s")

    @log.equals
    def reading(self):
        """Passenier (1989), section 5.4, with a scale: a log that shows a tenth too little makes K* a tenth too large."""
        return self.u_scale * self.u


class AntennaFix(Component):
    """A position fix of an antenna that stands away from midship; it joins in the place of `PositionSensor`."""

    x = given("m", "position to the north")
    y = given("m", "position to the east")
    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    antenna_ahead = constant("m", "antenna before midship", latex="l_x")
    antenna_starboard = constant("m", "antenna to starboard of the centre line", default="0 m", latex="l_y")
    fix_north = output("m", "position to the north by the fix", measures="x", noise="10 m")
    fix_east = output("m", "position to the east by the fix", measures="y", noise="10 m")

    @fix_north.equals
    def north(self):
        """Passenier (1989), eq. (2.71) integrated: the lever turned by the heading."""
        return self.x + self.antenna_ahead * np.cos(self.psi) - self.antenna_starboard * np.sin(self.psi)

    @fix_east.equals
    def east(self):
        """Passenier (1989), eq. (2.72) integrated: the lever turned by the heading."""
        return self.y + self.antenna_ahead * np.sin(self.psi) + self.antenna_starboard * np.cos(self.psi)


#: The sensors that a ship has on board.
STANDARD_SENSORS: tuple[type[Component], ...] = (Compass, Gyro, Log, PositionSensor)


#: No sensor of a ship has a smaller standard deviation, SI.
SMALLEST_LEVEL = 1e-12
#: Nor a larger one: its samples would say nothing, and their squares overflow.
LARGEST_LEVEL = 1e12


def standard_noise() -> dict[str, float]:
    """Return the standard deviation per sample of the standard sensors, SI, by the quantity they measure."""
    shown = [q for sensor in STANDARD_SENSORS for q in declared_quantities(sensor).values() if q.kind == "output"]
    return {q.measures: to_si(q.noise, q.unit, f"noise of {q.name}") for q in shown if q.measures and q.noise}


def shown_by(model: Model, names: Sequence[str]) -> tuple[str, ...]:
    """Return what a log shows of quantities: the reading of an instrument with errors of its own, such as a scale; else themselves.

    Parameters
    ----------
    model : Model
        The model.
    names : sequence of str
        Quantities that are measured.
    """
    own = {e.owner for e in model.entries.values() if e.quantity.kind in ("parameter", "constant")}
    readings = {model[n].quantity.measures: n for n in model.outputs if model[n].owner in own}
    return tuple(readings.get(n, n) for n in names)
