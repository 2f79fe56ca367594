"""The assessment of a fit: prediction bands, null directions, residuals, findings on its trials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from shipid.foundation.result import Result
from shipid.identification.uncertainty.directions import NullDirection
from shipid.identification.uncertainty.residuals import Residuals
from shipid.identification.validation.predicted_manoeuvre import PredictedManoeuvre
from shipid.identification.validation.structure_error import StructureError
from shipid.identification.validation.trial_findings import TrialFinding


@dataclass(frozen=True, eq=False, repr=False)
class Assessment(Result):
    """The assessment of a fit, made by `shipid.assess`.

    Attributes
    ----------
    directions : tuple of NullDirection
        Directions in which the coefficients may move together, the weakest first, with what would help.
    residuals : mapping of str to Residuals
        Size and whiteness of the residuals of each signal.
    manoeuvres : mapping of str to PredictedManoeuvre, or None
        The manoeuvre of each trial by its name, measured and predicted, with 95 % bands; None where they were not requested.
    findings : tuple of TrialFinding, or None
        Faults found in the trials with confidence; None where they were not checked.
    structure : StructureError or None
        What the structure of the model is wrong by, which is in the bands; None where they were not requested.
    """

    TABLE: ClassVar[str] = "directions"

    directions: tuple[NullDirection, ...]
    residuals: Mapping[str, Residuals]
    manoeuvres: Mapping[str, PredictedManoeuvre] | None = None
    findings: tuple[TrialFinding, ...] | None = None
    structure: StructureError | None = None
