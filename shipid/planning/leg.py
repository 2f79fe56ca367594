"""One manoeuvre of a plan."""

from __future__ import annotations

from dataclasses import dataclass

from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import quantity


@dataclass(frozen=True)
class Leg:
    """One manoeuvre of a plan.

    Attributes
    ----------
    manoeuvre : str
        As ``shipid simulate --manoeuvre`` takes it.
    speed : float
        Speed of the approach in m/s.
    duration : float
        In s, with a straight approach of one L/U.
    start : float
        When it begins, in s of the plan.
    seed : int
        Of the random telegraph, as ``shipid simulate --seed`` takes it; nothing else reads it.
    """

    manoeuvre: str
    speed: float
    duration: float
    start: float
    seed: int = 0

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {
            "manoeuvre": self.manoeuvre,
            "speed": quantity(round(self.speed, 6), "m/s"),
            "duration": quantity(round(self.duration, 3), "s"),
            "start": quantity(round(self.start, 3), "s"),
            "seed": self.seed,
        }
