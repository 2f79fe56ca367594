"""The result of judging a design for ships that differ from the one it was made for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import quantity, with_units
from shipid.foundation.result import Result


@dataclass(frozen=True, repr=False)
class Robustness(Result):
    """The disk margin when the ship differs from that of the design.

    Attributes
    ----------
    samples : int
        Draws of the ship's coefficients; 0 where their uncertainty is unknown.
    source : str
        Where the draws come from, in words.
    disk_worst, disk_low : float
        Least disk margin over draws and speeds, and the one that 5 % of the draws fall short of.
    speed_worst : float
        Speed of the worst, in m/s.
    unstable : int
        Draws that are unstable at a speed.
    disk_by_speed : tuple of float
        Least disk margin at each speed of the schedule.
    overshoot_deg : tuple of float or None
        Overshoot of the sample course change: of the ship as it is, in the middle of the draws, and at 95 % of them.
    settling_s : tuple of float or None
        The same for the settling time.
    sample_change_deg : float
        That course change.
    variants : mapping of str to mapping
        The disk margin and the overshoot under a slow rudder, and with the log off by 10 % either way.
    """

    UNITS: ClassVar[Mapping[str, str]] = {
        "speed_worst": "m/s",
        "disk_worst": "1",
        "disk_low": "1",
        "disk_by_speed": "1",
    }

    samples: int
    source: str
    disk_worst: float
    disk_low: float
    speed_worst: float
    unstable: int
    disk_by_speed: tuple[float, ...]
    overshoot_deg: tuple[float | None, ...]
    settling_s: tuple[float | None, ...]
    sample_change_deg: float
    variants: Mapping[str, Mapping[str, float | None]]

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {
            "disk_worst": self.disk_worst,
            "samples": self.samples,
            "source": self.source,
            "disk_5_percent": self.disk_low,
            "speed_worst": quantity(self.speed_worst, "m/s"),
            "unstable": self.unstable,
            "disk_by_speed": list(self.disk_by_speed),
            "change": quantity(self.sample_change_deg, "deg"),
            "overshoot": quantity(list(self.overshoot_deg), "deg"),
            "settling": quantity(list(self.settling_s), "s"),
            "variants": {n: with_units(v) for n, v in self.variants.items()},
        }
