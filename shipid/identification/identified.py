"""The record of an identification: the problem, its solution, and the identified ship.

Everything that is computed from an identification later (bands, directions, profiles, a posterior, predictions) reads this
record.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.estimation.estimate import Estimate
from shipid.foundation.result import Result
from shipid.identification.evidence.load_part import LoadPart
from shipid.identification.methods import Method
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import Problem
from shipid.identification.problem.setting import box_around
from shipid.identification.search.solution import Solution
from shipid.identification.uncertainty.covariance import Covariance
from shipid.parameters.parameter_set import ParameterSet

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, repr=False)
class Identified(Result):
    """The result of the search, before any assessment.

    Attributes
    ----------
    ship : ParameterSet
        The identified ship.
    scale : Scale
        Its length and usual speed in the trials.
    solution : Solution
        The solution, with its problem.
    covariance : Covariance
        Covariance of all unknowns.
    parameters : mapping of str to Estimate
        Fitted coefficients, then published ones that follow from them.
    method : str
        Name of the method that found them (`shipid.identification.methods`).
    noise : ndarray, shape (signals,)
        Standard deviation of each signal, SI: that of its residuals where it was estimated. The weights of the search may differ.
    spreads : mapping of str to float
        Standard deviation, stated beforehand, of coefficients about which the trials say nothing.
    load_part : LoadPart or None
        What the trials say of coefficients that change with the loading; None where it was not asked.
    """

    ship: ParameterSet
    scale: Scale
    solution: Solution
    covariance: Covariance
    parameters: Mapping[str, Estimate]
    method: Method
    noise: np.ndarray
    spreads: Mapping[str, float] = field(default_factory=dict)
    load_part: LoadPart | None = None

    def to_frame(self) -> pd.DataFrame:
        """Return the coefficients as a pandas table."""
        import pandas as pd

        rows = [{"name": e.name, **e.to_dict()} for e in self.parameters.values()]
        frame = pd.DataFrame(rows).set_index("name")
        return frame[["value", "std", "unit", "interval_95", "identifiable", "follows", "meaning"]]

    @property
    def problem(self) -> Problem:
        """What was solved."""
        return self.solution.problem

    @property
    def model(self) -> Model:
        """What was fitted."""
        return self.problem.model

    @property
    def values(self) -> dict[str, float]:
        """Values of all coefficients, fitted and fixed, SI, by name."""
        return self.problem.values(self.solution.q)

    @property
    def box(self) -> Box:
        """Declared bounds of the fitted coefficients, around their values."""
        return box_around(self.model, self.scale, dict(zip(self.problem.estimated, self.solution.parameters.tolist())))
