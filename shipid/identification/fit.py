"""The result of an identification: frozen, with names, units and uncertainties."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.estimation.estimate import Estimate
from shipid.foundation.aliases import Expression, Plain
from shipid.foundation.errors import UsageError
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.numbers import quantity
from shipid.foundation.result import DrawnResult
from shipid.foundation.statistics import plain
from shipid.generation.straight_course import linear_ship
from shipid.identification.assessment import Assessment
from shipid.identification.evidence.bias_spread import BiasSpread
from shipid.identification.evidence.explained import (
    MOSTLY_DISTURBED,
    astern_notices,
    unexplained_notices,
    unread_wind_notices,
)
from shipid.identification.evidence.missing_effect import MissingEffect
from shipid.identification.evidence.record_doubts import record_notices
from shipid.identification.fit_text import (
    FIRST,
    band_lines,
    bias_lines,
    coefficient_lines,
    comparison_lines,
    dead_time_lines,
    ladder_lines,
    noise_lines,
    prior_lines,
    range_lines,
)
from shipid.identification.identified import Identified
from shipid.identification.problem.prior_shares import prior_shares
from shipid.identification.search.noise_levels import NoiseLevels
from shipid.identification.search.rung import Rung
from shipid.identification.uncertainty.amplitudes import ONE_SIDED, beyond_of_record, one_sided_notices
from shipid.identification.uncertainty.posterior import Posterior, posterior_of
from shipid.identification.uncertainty.profiles import Profile, profile_of
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.loadings import LOADINGS, loading_lines, loading_notices
from shipid.identification.validation.predicted_manoeuvre import in_degrees
from shipid.identification.validation.predictions import predictions
from shipid.identification.validation.trial_findings import lines_of
from shipid.parameters.correlation import seen_by
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.validity import BEYOND
from shipid.trials.logs.reading import Trials, trials_of

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, repr=False)
class Fit(DrawnResult):
    """An identified model.

    Attributes
    ----------
    model : Model
        The fitted model.
    ship : ParameterSet
        The identified ship: its particulars, and the coefficients with their standard deviations.
    method : str
        How it was fitted, in words.
    converged : bool
        Whether the search converged.
    message : str
        The message of the search, and notes for the reader.
    parameters : mapping of str to Estimate
        Fitted coefficients, then published ones that follow from them.
    fixed : mapping of str to float
        Coefficients that were not estimated, SI.
    covariance, correlation : ndarray, shape (estimated, estimated)
        Of the fitted coefficients, in order; an infinite variance where the trials hold no information.
    condition_number : float or None
        Of that matrix; None where a coefficient has no finite variance.
    noise : mapping of str to float
        Standard deviation of each fitted signal's residuals, SI.
    fitted, validation : tuple of Comparison
        Trials that were fitted, and trials that were not.
    chi_square : float
        Mean squared weighted residual per degree of freedom.
    evaluations : int
        Runs of all trials.
    provenance : mapping
        Versions, and hashes of model and trials.
    identified : Identified
        The record of the identification, from which everything else is computed.
    ladder : tuple of Rung
        The methods that were tried, in order, and which was used.
    loss : str
        The loss of the residuals.
    levels : NoiseLevels or None
        Noise that drives the states and noise of the sensors, where they were found by prediction error.
    assessment : Assessment or None
        Bands, null directions, residuals and findings, where they were requested (`shipid.assess`).
    posterior : Posterior or None
        A sampled posterior, where one was requested (`sample_posterior`).
    bias_spread : BiasSpread or None
        How far the rudder biases of the trials are spread; None where there is one trial, or a method that does not estimate it.
    lacks : MissingEffect or None
        An effect that the residuals show and the model lacks; covariance and intervals hold what it does to the coefficients.
    """

    model: Model
    ship: ParameterSet
    method: str
    converged: bool
    message: str
    parameters: Mapping[str, Estimate]
    fixed: Mapping[str, float]
    covariance: np.ndarray
    correlation: np.ndarray
    condition_number: float | None
    noise: Mapping[str, float]
    fitted: tuple[Comparison, ...]
    validation: tuple[Comparison, ...]
    chi_square: float
    evaluations: int
    provenance: Mapping[str, Plain]
    identified: Identified
    ladder: tuple[Rung, ...] = ()
    loss: str = "linear"
    levels: NoiseLevels | None = None
    assessment: Assessment | None = None
    posterior: Posterior | None = None
    bias_spread: BiasSpread | None = None
    lacks: MissingEffect | None = None

    @property
    def estimated(self) -> tuple[str, ...]:
        """Names of the fitted coefficients."""
        return tuple(n for n, e in self.parameters.items() if not e.follows)

    @property
    def unidentifiable(self) -> tuple[str, ...]:
        """Names of the fitted coefficients that the trials do not determine."""
        return tuple(n for n in self.estimated if not self.parameters[n].identifiable)

    @property
    def prior_shares(self) -> dict[str, float]:
        """Share of the information on a coefficient that its prior is and not the trials, by coefficient that has a prior."""
        return prior_shares(self.identified.problem.prior, self.parameters)

    def validate(self, trials: Trials) -> Fit:
        """Return the same fit with its prediction of trials that were not fitted.

        Parameters
        ----------
        trials : Trial, str, Path or sequence of them
            Trials, or their files. Only the initial state is taken from the first seconds of each; the rudder bias is the mean of the fitted
            trials'. Reported apart: the same with rudder bias and initial state refitted on the record.

        Returns
        -------
        Fit
            Without an assessment, which would lack these trials.

        Raises
        ------
        NoStretchError
            If what drives the model has so many holes that no stretch of a trial is long enough.
        """
        compared = predictions(self.identified, trials_of(trials))
        records = {c.trial.name: {**c.trial.source.to_dict(), "samples": len(c.trial)} for c in compared}
        provenance = {**self.provenance, "trials": {**self.provenance["trials"], **records}}
        return replace(self, validation=self.validation + compared, provenance=provenance, assessment=None)

    def profile(self, name: str, points: int = 17) -> Profile:
        """Return the profile likelihood of a coefficient, with the 95 % interval by the likelihood ratio.

        Parameters
        ----------
        name : str
            A fitted coefficient, or a published one that can be held in place of one.
        points : int
            Number of its values.

        Raises
        ------
        UnknownNameError
            If there is no such coefficient.
        UsageError
            If it is held fixed, or cannot be held.
        """
        return profile_of(self.identified, name, points)

    def sample_posterior(self, draws: int = 10_000, seed: int = 0) -> Posterior:
        """Return draws from the posterior density of all unknowns, by an ensemble sampler (`shipid[posterior]`).

        Parameters
        ----------
        draws : int
            Number of draws over all walkers, after the burn-in.
        seed : int
            Of the sampler.

        Raises
        ------
        UsageError
            If the fit has no likelihood to sample, or the number of draws is too small.
        MissingExtraError
            If the sampler is not installed.
        PosteriorError
            If the unknowns are too many, or the density is improper.
        """
        return posterior_of(self.identified, draws, seed)

    def to_control(
        self,
        speed: str | None = None,
        inputs: Sequence[str] | None = None,
        outputs: Sequence[str] | None = None,
        given: Mapping[str, str] | None = None,
    ) -> Expression:
        """Return the ship on a straight course as a state-space system of python-control, SI: m, s, rad.

        The linearisation is exact, with the rudder amidships; ``shipid.linearise`` takes any other condition.

        Parameters
        ----------
        speed : str, optional
            Forward speed with its unit, such as ``"9 kn"``; by default that of the trials.
        inputs, outputs : sequence of str, optional
            Which to keep, such as ``["delta"]`` and ``["psi", "r"]``; by default all inputs, and the states as outputs. States
            that the outputs do not depend on are left out.
        given : mapping of str to str, optional
            Other inputs of the model, with their units, such as ``{"n": "80 rpm"}``.

        Returns
        -------
        control.StateSpace

        Raises
        ------
        UsageError
            If neither the trials nor the ship say a speed, it is not greater than zero, or a name does not exist.
        NoSteadyStateError
            If the ship does not go straight at this speed with these inputs.
        """
        return linear_ship(self.model, self.ship, self._speed(speed), given, inputs, outputs).to_state_space()

    def _speed(self, speed: str | None) -> float:
        """A speed in m/s: the one that is asked for, that of the trials, or the ship's own."""
        if speed is not None:
            return to_si(speed, "m/s", "the speed")
        joint = self.ship.joint.get(self.model.name)
        sailed = None if joint is None else joint.belongs_to
        known = sailed or self.ship.particular("speed", "m/s")
        if known is None:
            raise UsageError("neither the trials nor the ship say a speed: give one with its unit, as in '9 kn'.")
        return known

    def to_frame(self) -> pd.DataFrame:
        """Return the coefficients as a pandas table."""
        return self.identified.to_frame()

    def to_dict(self) -> dict[str, Plain]:
        """Return the result as plain values for JSON: SI, angles in radians, no NaN.

        What was not assessed is null, and bands are left out.
        """
        units = {s: self.model[s].unit for s in self.noise}
        assessed, compared = self.assessment, (*self.fitted, *self.validation)
        bands = {} if assessed is None or assessed.manoeuvres is None else assessed.manoeuvres
        findings = None if assessed is None else assessed.findings
        return {
            "model": self.model.name,
            "ship": self.ship.name,
            "method": self.method,
            "converged": self.converged,
            "message": self.message,
            "loss": self.loss,
            "ladder": [r.to_dict() for r in self.ladder],
            "checked": findings is not None,
            "warnings": [*plain_notices(self.warnings), *(f.to_dict() for f in findings or ())],
            "parameters": {n: e.to_dict() for n, e in self.parameters.items()},
            "load_part": None if (part := self.identified.load_part) is None else part.to_dict(),
            "seen": seen_by(self.ship.joint.get(self.model.name)),
            "fixed": {n: {"value": v, "unit": self.model[n].unit} for n, v in self.fixed.items()},
            "fit": {
                c.trial.name: {
                    s: {"rmse": quantity(plain(v), units[s]), "fit_percent": plain(c.fit_percent.get(s))}
                    for s, v in c.rmse.items()
                }
                for c in self.fitted
            },
            "validation": {
                c.trial.name: {
                    s: {
                        "rmse": quantity(plain(v), units[s]),
                        "fit_percent": plain(c.fit_percent.get(s)),
                        "rmse_warm": quantity(plain(c.warm.get(s)), units[s]),
                        "rmse_refitted_bias": quantity(plain(c.refitted.get(s)), units[s]),
                    }
                    for s, v in c.rmse.items()
                }
                for c in self.validation
            },
            "samples": {
                c.trial.name: {
                    "signals": {s: {"there": n, "possible": most} for s, (n, most) in c.samples.items()},
                    "notes": list(c.notes),
                }
                for c in compared
            },
            "manoeuvre": {
                c.trial.name: {
                    "overshoots": quantity(in_degrees(c.overshoots), "deg"),
                    "predicted_overshoots": quantity(in_degrees(c.predicted_overshoots), "deg"),
                    **(bands[c.trial.name].to_dict() if c.trial.name in bands else {}),
                    "not_sailed": None if c.departure is None else str(c.departure),
                }
                for c in compared
            },
            "rudder_bias": {c.trial.name: c.told_bias for c in compared},
            "rudder_bias_refitted": {c.trial.name: c.told_refitted_bias for c in self.validation},
            "bias_spread": None if self.bias_spread is None else self.bias_spread.to_dict(),
            "noise": {s: quantity(v, units[s]) for s, v in self.noise.items()},
            **({} if self.levels is None else {"filter_noise": self.levels.to_dict(self.model)}),
            "diagnostics": {
                "condition_number": self.condition_number,
                "unidentifiable": list(self.unidentifiable),
                "why": {n: self.parameters[n].why for n in self.unidentifiable},
                "prior_shares": self.prior_shares,
                "correlation": {"names": list(self.estimated), "matrix": self.correlation.round(6).tolist()},
                "directions": None if assessed is None else [d.to_dict() for d in assessed.directions],
                "residuals": None if assessed is None else {s: r.to_dict() for s, r in assessed.residuals.items()},
                "chi_square": plain(self.chi_square),
                "evaluations": self.evaluations,
            },
            **({} if self.posterior is None else {"posterior": self.posterior.to_dict()}),
            "provenance": dict(self.provenance),
        }

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """What makes the coefficients or a prediction unusable; the findings on the trials stand in the assessment."""
        found = []
        if not self.converged:
            found.append(Notice(f"the search did not converge: {self.message}", "not-converged", serious=True))
        withheld = next((e.why for e in self.parameters.values() if e.withheld), None)
        found += unexplained_notices(self.fitted, self.identified.scale.unit_time, withheld)
        found += astern_notices(self.model, self.fitted)
        found += unread_wind_notices(self.model, self.fitted, self.identified.scale.speed)
        found += one_sided_notices([c.trial for c in self.fitted])
        found += record_notices(self.fitted, self.validation, self.ship.particular("L", "m"))
        found += [c.not_sailed for c in (*self.fitted, *self.validation) if c.not_sailed is not None]
        found += [s.notice for s in (self.bias_spread, self.lacks) if s is not None and s.notice is not None]
        found += self.identified.solution.notices if withheld is None else ()
        found += self.levels.notices if self.levels is not None and self.identified.method == "prediction-error" else ()
        stated = {c.trial.name: c.trial.source.conditions for c in (*self.fitted, *self.validation)}
        found += loading_notices(stated, self.identified.load_part)
        pairs = ((c.trial, n) for c in self.validation for n in beyond_of_record(self.model, self.ship, c.trial))
        found += [n.about(trial.name) for trial, n in pairs if n.kind == BEYOND]
        return tuple(found)

    def text(self) -> str:
        """Return the result in lines of text."""
        state = "converged" if self.converged else f"NOT CONVERGED: {self.message}"
        trials = ", ".join(c.trial.name for c in self.fitted)
        findings = (None if self.assessment is None else self.assessment.findings) or ()
        serious = [f for f in findings if f.finding.serious]
        return "\n".join(
            [
                f"{self.model.name} fitted to {trials} ({self.method}; {state})",
                # Before the coefficients: who reads only those has read it.
                *(f"  check     {f}. {f.finding.effect}" for f in serious),
                *(f"  {'warning' if w.serious else 'note':9s} {w}" for w in self.warnings if w.kind in FIRST),
                *coefficient_lines(self.parameters),
                *(f"  note      {w}" for w in self.warnings if w.kind in (MOSTLY_DISTURBED, ONE_SIDED)),
                *dead_time_lines(self.model),
                *loading_lines(self.identified),
                *prior_lines(self.prior_shares),
                *range_lines(self.model, self.ship.joint.get(self.model.name)),
                *comparison_lines(self.fitted, "fitted"),
                *comparison_lines(self.validation, "predicted"),
                *(f"  beyond    {w}" for w in self.warnings if w.kind == BEYOND),
                *(f"  loadings  {w}" for w in self.warnings if w.kind == LOADINGS),
                *band_lines((None if self.assessment is None else self.assessment.manoeuvres) or {}),
                *bias_lines(self.bias_spread, self.fitted),
                *ladder_lines(self.ladder),
                *([] if self.levels is None else noise_lines(self.levels, self.model)),
                *(f"  check     {line}" for line in lines_of([f for f in findings if f not in serious])),
                *(f"  {line}" for line in ([] if self.posterior is None else self.posterior.text().splitlines())),
            ]
        )
