"""What the trials' doctor says of the trials of a fit: for the reader to judge. Nothing is repaired here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.findings import SURE, Finding

if TYPE_CHECKING:
    from shipid.identification.fit import Fit


@dataclass(frozen=True)
class Checked:
    """One finding on a trial of a fit.

    Attributes
    ----------
    trial : str
        Name of the trial.
    role : {"fitted", "validation"}
        What the fit did with it.
    finding : Finding
        What the doctor said.
    """

    trial: str
    role: str
    finding: Finding

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return {"trial": self.trial, "role": self.role, **self.finding.to_dict()}

    def __str__(self) -> str:
        f = self.finding
        span = f"{f.seconds[0]:.5g} to {f.seconds[1]:.5g} s"
        return f"{self.trial}: {f.kind} ({f.channel}, {f.confidence:.0%}, {span}): {f.message}"


def findings_of(fit: Fit) -> tuple[Checked, ...]:
    """Return what the doctor is sure of in the trials of a fit, what spoils an identification first.

    Parameters
    ----------
    fit : Fit
        The fit.
    """
    found = []
    for role, group in (("fitted", fit.fitted), ("validation", fit.validation)):
        for c in group:
            diagnosis = check_trial(c.trial, fit.ship)
            found += [Checked(c.trial.name, role, f) for f in diagnosis.findings if f.confidence >= SURE]
    return tuple(sorted(found, key=lambda c: (not c.finding.spoils, c.role != "fitted")))
