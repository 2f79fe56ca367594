"""What a core may be given besides its source: what keeps the samples, and what judges the voyage."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from shipid.foundation.aliases import Plain


class Recording(Protocol):
    """What keeps the samples."""

    def add(self, t: float, values: Mapping[str, float]) -> None:
        """Keep a sample.

        Parameters
        ----------
        t : float
            In s.
        values : mapping of str to float
            SI.
        """

    def to_dict(self) -> dict[str, Plain]:
        """Return file, samples and message."""


class VoyageJudge(Protocol):
    """What judges a voyage: the tracking experiment."""

    def add(self, t: float, values: Mapping[str, float]) -> None:
        """Take where the ship is.

        Parameters
        ----------
        t : float
            In s.
        values : mapping of str to float
            ``x``, ``y`` and ``r``, SI.
        """

    def to_dict(self) -> dict[str, Plain]:
        """Return what the page shows."""
