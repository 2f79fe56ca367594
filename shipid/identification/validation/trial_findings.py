"""Findings of the trials' doctor on the trials of a fit, for the reader to judge. Nothing is repaired here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Literal

from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import moment, percent
from shipid.foundation.result import ResultEntry
from shipid.identification.evidence.unseen_gear import MATTERS, effect_of, usual_share
from shipid.identification.validation.comparison import Comparison
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.findings import SURE, Finding

_FULLY_TOLD = 2
"""Up to so many findings of one kind are told one by one."""


@dataclass(frozen=True, repr=False)
class TrialFinding(ResultEntry):
    """One finding on a trial of a fit.

    Attributes
    ----------
    trial : str
        Name of the trial.
    role : {"fitted", "validation"}
        What the fit did with it.
    finding : Finding
        The finding.
    bears : bool
        Whether it concerns a column that the fit used.
    """

    trial: str
    role: Literal["fitted", "validation"]
    finding: Finding
    bears: bool = True

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values; serious where it spoils this fit."""
        plain = self.finding.to_dict()
        return plain | {"serious": plain["serious"] and self.bears, "trial": self.trial, "role": self.role}

    def __str__(self) -> str:
        f = self.finding
        span = f"{moment(f.seconds[0])} to {moment(f.seconds[1])} s"
        return f"{self.trial}: {f.kind} ({f.channel}, {percent(f.confidence)}, {span}): {f.message}"


def findings_of(
    ship: ParameterSet,
    fitted: Sequence[Comparison],
    validation: Sequence[Comparison],
    inputs: Sequence[str] = (),
    method: str = "",
    delayed: bool = False,
    geared: bool = True,
) -> tuple[TrialFinding, ...]:
    """Return what the doctor is sure of in the trials of a fit, what spoils an identification first.

    Parameters
    ----------
    ship : ParameterSet
        The ship, for its length and speed.
    fitted, validation : sequence of Comparison
        The trials that were fitted, and those that were predicted.
    inputs : sequence of str
        What drives the model. A finding that concerns neither these nor a signal of the fit spoils nothing in it.
    method : str
        How the coefficients were found. Prediction error models the disturbances that an autopilot reacts to.
    delayed : bool
        Whether the model has a dead time of the rudder.
    geared : bool
        Whether the model has a steering gear or a lag between the rudder of the log and its force.
    """
    found = []
    share = None if geared else usual_share([c.trial for c in fitted], ship)
    roles: tuple[tuple[Literal["fitted", "validation"], Sequence[Comparison]], ...] = (
        ("fitted", fitted),
        ("validation", validation),
    )
    for role, comparisons in roles:
        for c in comparisons:
            diagnosis = check_trial(c.trial, ship)
            found += [
                TrialFinding(
                    c.trial.name,
                    role,
                    _settled(_with_gear(f, share), method, delayed),
                    f.touches({*c.samples, *inputs}, -inf, inf),
                )
                for f in diagnosis.findings
                if f.confidence >= SURE
            ]
    return tuple(sorted(found, key=lambda f: (not f.finding.spoils, f.role != "fitted")))


def _with_gear(finding: Finding, share: float | None) -> Finding:
    """An order taken for the rudder, serious where the gear that the model has not takes a large share of the time constant."""
    if finding.kind != "order-not-feedback" or share is None or share < MATTERS:
        return finding
    return replace(finding, spoils=True, effect=effect_of(share))


def _settled(finding: Finding, method: str, delayed: bool) -> Finding:
    """A finding, no longer serious where the method or the model settles it."""
    if finding.kind == "latency" and finding.fix is None and delayed and "x" not in finding.channels:
        return replace(finding, spoils=False, effect="The fit has a dead time for it.")
    if finding.kind == "closed-loop" and method == "prediction-error":
        return replace(finding, spoils=False)
    return finding


def lines_of(findings: Sequence[TrialFinding]) -> list[str]:
    """Return findings in words: one line each, or one line a kind where a kind is found many times.

    Parameters
    ----------
    findings : sequence of TrialFinding
        In the order in which they are told.

    Returns
    -------
    list of str
    """
    lines = []
    for kind in dict.fromkeys(f.finding.kind for f in findings):
        same = [f for f in findings if f.finding.kind == kind]
        if len(same) <= _FULLY_TOLD:
            lines += [str(f) for f in same]
            continue
        channels = ", ".join(dict.fromkeys(f.finding.channel for f in same[1:]))
        trials = len(dict.fromkeys(f.trial for f in same[1:]))
        lines.append(
            f"{same[0]}; and {len(same) - 1} more of this kind in {trials} trial{'s' * (trials > 1)} ({channels})"
        )
    return lines
