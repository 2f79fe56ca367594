"""What the instruments on board show: the quantity, the waves where a wave model is joined, and noise.

The standard deviations are those of the simulated instruments in this project's studies; a filter may be given
others. Passenier (1989), section 5.2 and 5.3: waves move the heading and its rate, and not the path.
"""

from __future__ import annotations

from shipid.declaration.component import Component, declared_quantities
from shipid.declaration.quantity import given, output
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


#: The sensors that a ship has on board.
STANDARD_SENSORS: tuple[type[Component], ...] = (Compass, Gyro, Log, PositionSensor)


#: No sensor of a ship has a smaller standard deviation, SI.
SMALLEST_LEVEL = 1e-12


def standard_noise() -> dict[str, float]:
    """Return the standard deviation per sample of the standard sensors, SI, by the quantity they measure."""
    shown = [q for sensor in STANDARD_SENSORS for q in declared_quantities(sensor).values() if q.kind == "output"]
    return {q.measures: to_si(q.noise, q.unit, f"noise of {q.name}") for q in shown if q.measures and q.noise}
