"""Where a trial came from, and what was done to it on the way in."""

from __future__ import annotations

from dataclasses import dataclass, field

from shipid.foundation.aliases import Plain
from shipid.trials.conditions import Conditions


@dataclass(frozen=True)
class Source:
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
    conditions : Conditions
        What is stated of the trial beside its log: loading, place, weather, who.
    """

    path: str | None = None
    sha256: str | None = None
    format: str | None = None
    notes: tuple[str, ...] = ()
    simulated: bool = False
    comment: str = ""
    start: str | None = None
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
            "conditions": {name: value for name, value in self.conditions.to_dict().items() if value is not None},
        }
