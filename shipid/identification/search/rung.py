"""One rung of the ladder of methods: a method that was tried, and its outcome."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from shipid.foundation.aliases import Plain
from shipid.foundation.result import Result
from shipid.identification.methods import Method


@dataclass(frozen=True, repr=False)
class Rung(Result):
    """One rung of the ladder.

    Attributes
    ----------
    method : str
        Its name, one of `shipid.identification.methods.METHODS`.
    cost : float or None
        Half the sum of squares of output error with what it found, thinned records, first weights; None where the model
        runs away with it.
    converged : bool
        Whether it met its tolerances.
    used : bool
        Whether the result comes from it.
    reason : str
        The outcome, and why the method was tried.
    evaluations : int
        Runs of all trials it took.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"cost": "1"}

    method: Method
    cost: float | None
    converged: bool
    used: bool
    reason: str
    evaluations: int = 0

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {
            "method": self.method,
            "cost": self.cost,
            "converged": self.converged,
            "used": self.used,
            "reason": self.reason,
            "evaluations": self.evaluations,
        }
