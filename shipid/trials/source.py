"""Where a trial came from, and what was done to it on the way in."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from shipid.foundation.aliases import Plain
from shipid.foundation.result import Result
from shipid.trials.conditions import Conditions


@dataclass(frozen=True, repr=False)
class Source(Result):
    """Where a trial came from, and what was done to it on the way in.

    Attributes
    ----------
    path : str or None
        The file, as the caller named it; None for a table made in memory.
    sha256 : str or None
        Checksum of the file.
    format : str or None
        Name of the trial format file, or None where the header spoke for itself.
    notes : tuple of str
        What was converted, repaired or dropped, and what the reader should know.
    simulated : bool
        Whether the record is a simulation (its first comment line says so).
    comment : str
        The comment lines at the head of the file.
    start : str or None
        The moment of t = 0 in ISO 8601, with its zone where one is known; None where the log says no date.
    origin : tuple of float or None
        Latitude and longitude in rad of the place where x and y are 0; None where it is not known.
    conditions : Conditions
        What is stated of the trial beside its log: loading, place, weather, who.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"origin": "rad"}

    path: str | None = None
    sha256: str | None = None
    format: str | None = None
    notes: tuple[str, ...] = ()
    simulated: bool = False
    comment: str = ""
    start: str | None = None
    origin: tuple[float, float] | None = None
    conditions: Conditions = field(default_factory=Conditions)

    def to_dict(self) -> dict[str, Plain]:
        """Return the source as plain values."""
        return {
            "path": self.path,
            "sha256": self.sha256,
            "format": self.format,
            "notes": list(self.notes),
            "simulated": self.simulated,
            "comment": self.comment,
            "start": self.start,
            "origin": None
            if self.origin is None
            else {n: {"value": math.degrees(c), "unit": "deg"} for n, c in zip(("lat", "lon"), self.origin)},
            "conditions": {name: value for name, value in self.conditions.to_dict().items() if value is not None},
        }


_ORIGIN = re.compile(
    r"^Origin of x and y: latitude (-?\d{1,2}(?:\.\d+)?) deg, longitude (-?\d{1,3}(?:\.\d+)?) deg", re.MULTILINE
)


def origin_words(origin: tuple[float, float]) -> str:
    """Return the comment line of a trial that says where x and y are 0.

    Parameters
    ----------
    origin : tuple of float
        Latitude and longitude in rad.
    """
    lat, lon = map(math.degrees, origin)
    return f"Origin of x and y: latitude {lat:.9f} deg, longitude {lon:.9f} deg (WGS84)"


def origin_in(comment: str) -> tuple[float, float] | None:
    """Return the place where x and y are 0, as the comment of a trial says it; None where it does not.

    Parameters
    ----------
    comment : str
        The comment lines.
    """
    match = _ORIGIN.search(comment)
    if match is None or not (abs(float(match[1])) <= 90 and abs(float(match[2])) <= 360):
        return None
    return math.radians(float(match[1])), math.radians(float(match[2]))
