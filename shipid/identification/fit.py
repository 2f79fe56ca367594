"""The result of an identification: frozen, with names, units and uncertainties."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from shipid.declaration.model import Model
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    from shipid.identification.search.ladder import Rung
    from shipid.identification.search.noise_levels import Levels
    from shipid.identification.uncertainty.directions import Direction
    from shipid.identification.uncertainty.posterior import Posterior
    from shipid.identification.uncertainty.profiles import Profile
    from shipid.identification.uncertainty.residuals import Residuals
    from shipid.identification.validation.bands import Manoeuvre
    from shipid.identification.validation.trial_findings import Checked


@dataclass(frozen=True)
class Estimate:
    """One estimated coefficient.

    Attributes
    ----------
    name, unit, meaning : str
        The coefficient as declared; SI.
    value : float or None
        The estimate; None where it runs to infinity (a gain at the edge of course stability).
    std : float or None
        Standard deviation; None where the data give none.
    ci95 : tuple of float or None
        95 % confidence interval.
    identifiable : bool
        Whether the trials determine it.
    why : str
        If not, why not.
    follows : bool
        Whether it is a published coefficient that follows from the fitted ones.
    prime : float or None
        Its value in the prime system (powers of L and U), or its dimensional value if it is declared without
        dimension; None where L or U is unknown.
    prime_unit : str
        Unit of `prime`.
    """

    name: str
    unit: str
    meaning: str
    value: float | None
    std: float | None
    ci95: tuple[float, float] | None
    identifiable: bool
    why: str = ""
    follows: bool = False
    prime: float | None = None
    prime_unit: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return plain values, free of NaN."""
        return {
            "value": self.value,
            "unit": self.unit,
            "std": self.std,
            "ci95": list(self.ci95) if self.ci95 else None,
            "identifiable": self.identifiable,
            "why": self.why,
            "follows": self.follows,
            "meaning": self.meaning,
            "normalised" if self.unit not in ("", "1") else "dimensional": self.prime,
            "normalised_unit" if self.unit not in ("", "1") else "dimensional_unit": self.prime_unit,
        }


@dataclass(frozen=True, eq=False)
class Comparison:
    """A trial beside its prediction.

    Attributes
    ----------
    trial : Trial
        The record.
    predicted : mapping of str to ndarray
        Predicted signals and track, SI, at the samples of the trial.
    rmse : mapping of str to float
        Root-mean-square error of each signal, SI.
    refitted : mapping of str to float
        The same with rudder bias and initial state refitted on this record; empty for a fitted trial.
    warm : mapping of str to float
        The same with rudder bias and initial state fitted to the record up to the first reversal of the rudder, and the
        error counted on the rest; empty for a fitted trial and where the rudder is never reversed.
    biases : mapping of str to float
        Bias of each input that was used, SI: the rudder, the cruising speed, the current.
    refitted_bias : float or None
        Rudder bias refitted on this record.
    overshoots, predicted_overshoots : tuple of float
        Overshoot angles in rad, measured and predicted with the recorded rudder.
    initial : mapping of str to float
        Initial states that were used.
    """

    trial: Trial
    predicted: Mapping[str, np.ndarray]
    rmse: Mapping[str, float]
    refitted: Mapping[str, float] = field(default_factory=dict)
    warm: Mapping[str, float] = field(default_factory=dict)
    biases: Mapping[str, float] = field(default_factory=dict)
    refitted_bias: float | None = None
    overshoots: tuple[float, ...] = ()
    predicted_overshoots: tuple[float | None, ...] = ()
    initial: Mapping[str, float] = field(default_factory=dict)

    @property
    def bias(self) -> float:
        """Rudder bias in rad that was used."""
        return self.biases.get("delta", 0.0)


@dataclass(frozen=True, eq=False)
class Fit:
    """An identified model.

    Attributes
    ----------
    model : Model
        What was fitted.
    ship : ParameterSet
        The identified ship: its particulars, and the coefficients with their standard deviations.
    method : str
        How it was fitted.
    converged : bool
        Whether the search converged.
    message : str
        What the search said, and what the reader has to know.
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
    ladder : tuple of Rung
        What was tried, in order, and which of it was used.
    loss : str
        How residuals counted.
    checked : bool
        Whether the trials' doctor is asked.
    posterior : Posterior or None
        A sampled posterior, where one was asked for (`sample_posterior`).
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
    provenance: Mapping[str, Any]
    ladder: tuple[Rung, ...] = ()
    loss: str = "linear"
    checked: bool = True
    posterior: Posterior | None = None
    _problem: Any = field(repr=False, default=None)
    _solution: Any = field(repr=False, default=None)
    _predict: Any = field(repr=False, default=None)

    @property
    def levels(self) -> Levels | None:
        """What drives the states and the noise of the sensors, where prediction error found them."""
        return self._solution.levels if self._solution is not None else None

    @property
    def estimated(self) -> tuple[str, ...]:
        """Names of the fitted coefficients."""
        return tuple(n for n, e in self.parameters.items() if not e.follows)

    @property
    def unidentifiable(self) -> tuple[str, ...]:
        """Names of the fitted coefficients that the trials do not determine."""
        return tuple(n for n in self.estimated if not self.parameters[n].identifiable)

    def validate(self, trials: Any) -> Fit:
        """Return the same fit with its prediction of trials that were not fitted.

        Parameters
        ----------
        trials : sequence of Trial
            Only the initial state is taken from the first seconds of each; the rudder bias is the mean of the fitted
            trials'. Reported apart: the same with rudder bias and initial state refitted on the record.
        """
        compared, records = self._predict(self, trials)
        provenance = {**self.provenance, "trials": {**self.provenance["trials"], **records}}
        return replace(self, validation=self.validation + compared, provenance=provenance)

    def to_frame(self) -> Any:
        """Return the coefficients as a pandas table."""
        import pandas as pd

        rows = [{"name": e.name, **e.to_dict()} for e in self.parameters.values()]
        frame = pd.DataFrame(rows).set_index("name")
        return frame[["value", "std", "unit", "ci95", "identifiable", "follows", "meaning"]]

    @functools.cached_property
    def manoeuvres(self) -> Mapping[str, Manoeuvre]:
        """The manoeuvre of each trial by its name, measured and predicted, with 95 % bands; worked out when asked for."""
        from shipid.identification.validation.bands import manoeuvres_of

        return manoeuvres_of(self)

    @functools.cached_property
    def directions(self) -> tuple[Direction, ...]:
        """Directions in which the coefficients may move together, the weakest first, with what would help."""
        from shipid.identification.uncertainty.directions import directions_of

        return directions_of(self)

    @functools.cached_property
    def residuals(self) -> Mapping[str, Residuals]:
        """Size and whiteness of the residuals of each signal."""
        from shipid.identification.uncertainty.residuals import residuals_of

        return {} if self._solution is None else residuals_of(self._solution)

    @functools.cached_property
    def findings(self) -> tuple[Checked, ...]:
        """What the trials' doctor is sure of; none where he was not asked."""
        from shipid.identification.validation.trial_findings import findings_of

        return findings_of(self) if self.checked else ()

    def sample_posterior(self, draws: int = 10_000, seed: int = 0) -> Posterior:
        """Return draws from the posterior density of all unknowns, by an ensemble sampler (`shipid[posterior]`).

        Parameters
        ----------
        draws : int
            How many, over all walkers, after those that are thrown away.
        seed : int
            Of the sampler.
        """
        from shipid.identification.uncertainty.posterior import posterior_of

        return posterior_of(self, draws, seed)

    def profile(self, name: str, points: int = 17) -> Profile:
        """Return the profile likelihood of a coefficient, with the 95 % interval by the likelihood ratio.

        Parameters
        ----------
        name : str
            A fitted coefficient, or a published one that can be held in place of one.
        points : int
            Number of its values.
        """
        from shipid.identification.uncertainty.profiles import profile_of

        return profile_of(self, name, points)

    def to_dict(self, bands: bool = True) -> dict[str, Any]:
        """Return the result as plain values for JSON: SI, angles in radians, no NaN.

        Parameters
        ----------
        bands : bool
            Whether prediction bands are worked out, which takes a good part of a second for each trial.
        """
        units = {s: self.model[s].unit for s in self.noise}
        return {
            "model": self.model.name,
            "ship": self.ship.name,
            "method": self.method,
            "converged": self.converged,
            "message": self.message,
            "loss": self.loss,
            "ladder": [r.to_dict() for r in self.ladder],
            "findings": [f.to_dict() for f in self.findings] if self.checked else None,
            "parameters": {n: e.to_dict() for n, e in self.parameters.items()},
            "fixed": {n: {"value": v, "unit": self.model[n].unit} for n, v in self.fixed.items()},
            "fit": {
                c.trial.name: {s: {"rmse": _plain(v), "unit": units[s]} for s, v in c.rmse.items()} for c in self.fitted
            },
            "validation": {
                c.trial.name: {
                    s: {
                        "rmse": _plain(v),
                        "rmse_warm": _plain(c.warm.get(s)),
                        "rmse_refitted_bias": _plain(c.refitted.get(s)),
                        "unit": units[s],
                    }
                    for s, v in c.rmse.items()
                }
                for c in self.validation
            },
            "manoeuvre": {
                c.trial.name: {
                    "overshoots_deg": [_degrees(o) for o in c.overshoots],
                    "predicted_overshoots_deg": [_degrees(o) for o in c.predicted_overshoots],
                    **(self.manoeuvres[c.trial.name].to_dict() if bands else {}),
                }
                for c in (*self.fitted, *self.validation)
            },
            "rudder_bias": {
                c.trial.name: {"value": c.bias, "refitted": c.refitted_bias, "unit": "rad"}
                for c in (*self.fitted, *self.validation)
            },
            "noise": {s: {"std": v, "unit": units[s]} for s, v in self.noise.items()},
            **({} if self.levels is None else {"filter_noise": self.levels.to_dict(self.model)}),
            "diagnostics": {
                "condition_number": self.condition_number,
                "unidentifiable": list(self.unidentifiable),
                "why": {n: self.parameters[n].why for n in self.unidentifiable},
                "correlation": {
                    "names": list(self.estimated),
                    "matrix": [[round(float(v), 6) for v in row] for row in self.correlation],
                },
                "directions": [d.to_dict() for d in self.directions],
                "residuals": {s: r.to_dict() for s, r in self.residuals.items()},
                "chi_square": _plain(self.chi_square),
                "evaluations": self.evaluations,
            },
            **({} if self.posterior is None else {"posterior": self.posterior.to_dict()}),
            "provenance": dict(self.provenance),
        }

    def __repr__(self) -> str:
        from shipid.identification.fit_text import text_of

        return text_of(self)


def _plain(value: float | None) -> float | None:
    """A number for JSON, which knows neither NaN nor infinity."""
    return None if value is None or not np.isfinite(value) else float(value)


def _degrees(angle: float | None) -> float | None:
    return None if angle is None or not np.isfinite(angle) else round(float(np.rad2deg(angle)), 4)
