"""What a turning circle measures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from shipid.declaration.vocabulary import to_display
from shipid.foundation.numbers import last_place
from shipid.trials.measuring.results.measures import Measures, quantity, words


@dataclass(frozen=True, repr=False, kw_only=True)
class TurningCircle(Measures):
    """A turning circle, in the terms of IMO MSC.137(76) 4.2 and ITTC 7.5-04-02-01.

    Attributes
    ----------
    kind : str
        ``"turning circle"``.
    side : {"starboard", "port"}
        The side it turns to.
    track : str
        Where the track comes from: positions, or speeds and heading.
    advance, transfer, tactical_diameter, advance_ratio, transfer_ratio, tactical_diameter_ratio : float or None
        See the meaning of each in `quantities`.
    advance_uncertainty, transfer_uncertainty, tactical_diameter_uncertainty : float or None
        Of each, where it is read from positions; none of reckoned tracks.
    advance_still_water, transfer_still_water, tactical_diameter_still_water : float or None
        The same with the drift of the circle taken off, where it turns far enough to show it.
    advance_still_water_ratio, transfer_still_water_ratio, tactical_diameter_still_water_ratio : float or None
        In ship lengths.
    advance_still_water_uncertainty, transfer_still_water_uncertainty, tactical_diameter_still_water_uncertainty : float or None
        Of these; that of the drift is in them.
    drift_speed, drift_uncertainty, drift_direction : float or None
        Of the whole circle over the ground: current, and what wind and waves add to it; the direction it drifts to.
    times, speeds : tuple of float or None
        One a quarter of the circle.
    steady_rate, steady_speed, steady_drift, steady_diameter, steady_diameter_ratio, speed_loss : float or None
        Of the steady turn.
    pull_out_rate : float or None
        After the rudder was put amidships.
    """

    kind: ClassVar[str] = "turning circle"
    side: str = words()
    track: str = words()
    advance: float | None = quantity("m", "along the initial course, at 90 deg, over the ground")
    transfer: float | None = quantity("m", "across the initial course, at 90 deg, over the ground")
    tactical_diameter: float | None = quantity("m", "across the initial course, at 180 deg, over the ground")
    advance_uncertainty: float | None = quantity(
        "m", "95 % uncertainty of the advance: positions, heading and moment of the order"
    )
    transfer_uncertainty: float | None = quantity("m", "95 % uncertainty of the transfer")
    tactical_diameter_uncertainty: float | None = quantity("m", "95 % uncertainty of the tactical diameter")
    advance_ratio: float | None = quantity("1", "advance in ship lengths")
    transfer_ratio: float | None = quantity("1", "transfer in ship lengths")
    tactical_diameter_ratio: float | None = quantity("1", "tactical diameter in ship lengths")
    drift_speed: float | None = quantity("m/s", "drift of the circle over the ground, in turning through 360 deg")
    drift_uncertainty: float | None = quantity("m/s", "95 % uncertainty of that drift, in any direction")
    drift_direction: float | None = quantity("rad", "direction the circle drifts to, clockwise from north")
    advance_still_water: float | None = quantity("m", "advance with that drift taken off")
    transfer_still_water: float | None = quantity("m", "transfer with that drift taken off")
    tactical_diameter_still_water: float | None = quantity("m", "tactical diameter with that drift taken off")
    advance_still_water_uncertainty: float | None = quantity("m", "95 % uncertainty of that advance")
    transfer_still_water_uncertainty: float | None = quantity("m", "95 % uncertainty of that transfer")
    tactical_diameter_still_water_uncertainty: float | None = quantity(
        "m", "95 % uncertainty of that tactical diameter"
    )
    advance_still_water_ratio: float | None = quantity("1", "the same in ship lengths")
    transfer_still_water_ratio: float | None = quantity("1", "the same in ship lengths")
    tactical_diameter_still_water_ratio: float | None = quantity("1", "the same in ship lengths")
    times: tuple[float | None, ...] | None = quantity("s", "from the execute to 90, 180, 270, 360 deg")
    speeds: tuple[float | None, ...] | None = quantity("m/s", "speed at 90, 180, 270, 360 deg")
    steady_rate: float | None = quantity("rad/s", "steady rate of turn, size")
    steady_speed: float | None = quantity("m/s", "steady speed in the turn")
    steady_drift: float | None = quantity("rad", "steady drift angle, size")
    steady_diameter: float | None = quantity("m", "steady turning diameter")
    steady_diameter_ratio: float | None = quantity("1", "steady turning diameter in ship lengths")
    speed_loss: float | None = quantity("1", "share of the approach speed lost in the steady turn")
    pull_out_rate: float | None = quantity("rad/s", "rate of turn left after the pull-out, to starboard")

    def told(self, name: str, value: float, unit: str) -> str:
        """Return one number as `Measures.told` does, the drift in the digits that its own allows.

        Parameters
        ----------
        name, value, unit
            As there.
        """
        within = self.drift_uncertainty
        if name in ("drift_speed", "drift_uncertainty") and within is not None and within > 0:
            place = last_place(float(to_display(within, name, "m/s")))
            return f"{round(value, place) + 0.0:.{max(0, place)}f}"
        # Of no circle is the direction known to a degree.
        return f"{round(value) % 360:03d}" if name == "drift_direction" else super().told(name, value, unit)

    @property
    def title(self) -> str:
        """What the manoeuvre is called, such as ``turning circle to port``."""
        return f"{self.kind} to {self.side}"
