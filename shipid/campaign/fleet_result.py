"""The result of a fleet: one row a trial, and how the coefficients scatter over the trials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import chdtrc

from shipid.campaign.campaign import Measure, Rows
from shipid.campaign.fleet import IDENTIFIED, NOT_EXAMINED, PARTS, listed
from shipid.campaign.result import CampaignResult
from shipid.campaign.table import read_runs
from shipid.estimation.standing import DETERMINED
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.numbers import counted, number, uncertain_text
from shipid.foundation.result import DrawnResult
from shipid.foundation.statistics import interval_95, plain

if TYPE_CHECKING:
    import pandas as pd

#: Below this probability the coefficients of the trials differ by more than their standard deviations.
_UNLIKELY = 0.01


@dataclass(frozen=True)
class Scatter:
    """A coefficient over the trials that determine it.

    Attributes
    ----------
    name, unit, meaning : str
        The coefficient, SI.
    count : int
        How many trials determine it.
    mean, mean_std : float or None
        Mean weighted by the inverse variances, and its standard deviation if the trials have one true value.
    scatter : float or None
        Standard deviation of the values over the trials.
    probability : float or None
        That values with these standard deviations of one true value scatter as much or more (chi-squared).
    """

    name: str
    unit: str
    meaning: str
    count: int
    mean: float | None
    mean_std: float | None
    scatter: float | None
    probability: float | None

    @property
    def differs(self) -> bool:
        """Whether the trials differ by more than their standard deviations say."""
        return self.probability is not None and self.probability < _UNLIKELY

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        interval = None if self.mean is None or self.mean_std is None else list(interval_95(self.mean, self.mean_std))
        return {
            "meaning": self.meaning,
            "trials": self.count,
            "mean": {"value": self.mean, "std": self.mean_std, "unit": self.unit, "interval_95": interval},
            "scatter": {"value": self.scatter, "unit": self.unit},
            "probability_of_one_value": self.probability,
            "differs": self.differs,
        }


@dataclass(frozen=True, eq=False, repr=False)
class FleetResult(DrawnResult):
    """What was identified from each trial of a folder.

    Attributes
    ----------
    model, ship : str
        Their names; the ship's is empty where none was given.
    rows : dict of str to ndarray
        One entry a trial in each column.
    measures : mapping of str to Measure
        What the columns are.
    coefficients : mapping of str to Scatter
        Each coefficient over the trials.
    provenance : mapping
        Versions, and the identity of model, ship, settings and files.
    beside : tuple of Notice
        What lies in the folder and was not read.
    """

    model: str
    ship: str
    rows: Rows
    measures: Mapping[str, Measure]
    coefficients: Mapping[str, Scatter]
    provenance: Mapping[str, Plain]
    beside: tuple[Notice, ...] = ()

    @property
    def identified(self) -> np.ndarray:
        """Whether each trial was identified."""
        return np.asarray(self.rows["outcome"] == IDENTIFIED)

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """What is missing, and which rows are not to be used as they are."""
        good, trials = self.identified, self.rows["trial"]
        found = []
        if not good.any():
            found.append(Notice("no trial was identified.", "nothing-identified", serious=True))
        if (~good).any():
            words = f"{(~good).sum()} of {good.size} trials {'was' if (~good).sum() == 1 else 'were'} not identified"
            found.append(
                Notice(f"{words}: {listed(trials[~good].tolist())}.", "not-identified", trials=trials[~good].tolist())
            )
        spoilt = good & (self.rows["doctor"] != "") & (self.rows["doctor"] != NOT_EXAMINED)
        if spoilt.any():
            words = f"the doctor finds serious faults in {listed(trials[spoilt].tolist())}; see their rows before using the numbers"
            found.append(Notice(f"{words}.", "trial-faults", serious=True, trials=trials[spoilt].tolist()))
        differing = [n for n, s in self.coefficients.items() if s.differs]
        if differing:
            words = (
                f"{', '.join(differing)} scatter over the trials by more than the standard deviations of the rows say"
            )
            found.append(
                Notice(f"{words}: the trials do not share one value, or the intervals are too narrow.", "scatter")
            )
        return (*found, *self.beside)

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON: SI, no NaN."""
        return {
            "model": self.model,
            "ship": self.ship or None,
            "trials": [self._row(k) for k in range(len(self.rows["trial"]))],
            "coefficients": {n: s.to_dict() for n, s in self.coefficients.items()},
            "warnings": plain_notices(self.warnings),
            "provenance": dict(self.provenance),
        }

    def _row(self, k: int) -> dict[str, Plain]:
        rows = self.rows
        samples, doctor = plain(float(rows["samples"][k])), str(rows["doctor"][k])
        return {
            "trial": str(rows["trial"][k]),
            "outcome": str(rows["outcome"][k]),
            "message": str(rows["message"][k]),
            "doctor": None if doctor == NOT_EXAMINED else [kind for kind in doctor.split(", ") if kind],
            "samples": None if samples is None else int(samples),
            "chi_square": plain(float(rows["chi_square"][k])),
            "parameters": {n: self._value(n, k) for n in self.coefficients},
        }

    def _value(self, name: str, k: int) -> dict[str, Plain]:
        value, std, low, high = (plain(float(self.rows[c][k])) for c in (name, *(f"{name}_{p}" for p in PARTS[:3])))
        standing = str(self.rows[f"{name}_{PARTS[3]}"][k]) or None
        ends = None if low is None and high is None else [low, high]
        known = None if standing is None else standing == DETERMINED
        number = {"value": value, "std": std, "unit": self.measures[name].unit, "interval_95": ends}
        return {**number, "determined": known, "standing": standing}

    def to_frame(self) -> pd.DataFrame:
        """Return one row a trial, as a pandas table."""
        import pandas as pd

        return pd.DataFrame(self.rows).set_index("run")

    def text(self) -> str:
        """Return the result in lines of text."""
        heads = ["trial", "outcome", *self.coefficients, "doctor"]
        lines = [heads]
        for k, trial in enumerate(self.rows["trial"]):
            values = [self._text(n, k) for n in self.coefficients]
            lines.append(
                [str(trial), str(self.rows["outcome"][k]), *values, str(self.rows["doctor"][k]) or "nothing serious"]
            )
        widths = [max(len(line[i]) for line in lines) for i in range(len(heads))]
        told = ["  ".join(cell.ljust(w) for cell, w in zip(line, widths)).rstrip() for line in lines]
        units = ", ".join(f"{n} [{s.unit}]" for n, s in self.coefficients.items() if s.unit != "1")
        head = f"{self.model} identified from {self.identified.sum()} of {counted(len(self.rows['trial']), 'trial')}"
        why = [f"  {t}: {m}" for t, m in zip(self.rows["trial"], self.rows["message"]) if m]
        spread = [
            f"  {n.ljust(8)} {uncertain_text(s.mean, s.mean_std)} over {counted(s.count, 'trial')}"
            + ("" if s.scatter is None else f", scatter {number(s.scatter, 2)}")
            for n, s in self.coefficients.items() if s.mean is not None
        ]  # fmt: skip
        return "\n".join(
            [
                head + (f"; units: {units}" if units else ""),
                *told,
                *why,
                *spread,
                *(f"  warning: {w}" for w in self.warnings),
            ]
        )

    def _text(self, name: str, k: int) -> str:
        value, std = plain(float(self.rows[name][k])), plain(float(self.rows[f"{name}_std"][k]))
        if value is None:
            return ""
        standing = self.rows[f"{name}_{PARTS[3]}"][k]
        return uncertain_text(value, std) + ("" if standing == DETERMINED else f" ({standing})")


def fleet_result(result: CampaignResult, model: str, ship: str, beside: Sequence[Notice] = ()) -> FleetResult:
    """Return the rows of a fleet's campaign, with the scatter of the coefficients.

    Parameters
    ----------
    result : CampaignResult
        The campaign; its folder holds the rows.
    model, ship : str
        Names.
    beside : sequence of Notice
        What was not read (`shipid.campaign.fleet.not_read`).

    Returns
    -------
    FleetResult
    """
    assert result.folder is not None
    rows = read_runs(result.folder, result.runs)
    measures = {n: s.measure for n, s in result.statistics.items()}
    names = [n.removesuffix(f"_{PARTS[3]}") for n in measures if n.endswith(f"_{PARTS[3]}")]
    scatter = {n: _scatter(n, measures[n], rows) for n in names}
    return FleetResult(model, ship, rows, measures, scatter, result.provenance, tuple(beside))


def _scatter(name: str, measure: Measure, rows: Rows) -> Scatter:
    value, std = rows[name], rows[f"{name}_std"]
    known = (rows[f"{name}_{PARTS[3]}"] == DETERMINED) & np.isfinite(value) & (std > 0)
    value, std = value[known], std[known]
    if not value.size:
        return Scatter(name, measure.unit, measure.meaning, 0, None, None, None, None)
    weight = 1 / std**2
    mean = float(weight @ value / weight.sum())
    if value.size == 1:
        return Scatter(name, measure.unit, measure.meaning, 1, mean, float(std[0]), None, None)
    chance = float(chdtrc(value.size - 1, float(weight @ (value - mean) ** 2)))
    return Scatter(
        name,
        measure.unit,
        measure.meaning,
        value.size,
        mean,
        float(weight.sum() ** -0.5),
        float(value.std(ddof=1)),
        chance,
    )
