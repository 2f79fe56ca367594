"""Whether trials at several loadings show that coefficients change with the loading, or one set is as good for all.

The model with the part that depends on the loading is fitted; the one without it is that part at zero. Their odds are the density
of the part at zero before the trials, over the density there after them (Dickey 1971, the ratio of Savage and Dickey), both
normal: a part that the trials do not need costs the odds what it could have been.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from shipid.declaration.vocabulary import shown
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import brief
from shipid.foundation.statistics import plain
from shipid.identification.loading import loading_of
from shipid.identification.problem.output_error import Problem
from shipid.identification.uncertainty.amplitudes import largest_amplitudes
from shipid.parameters.loading import load_parts, measure_of
from shipid.trials.conditions import one_loading
from shipid.trials.trial import Trial

#: Odds from which the part is kept: strong evidence (Kass and Raftery 1995).
STRONG = 20.0
#: Share by which the largest rudder angles at two loadings may differ and be those of one manoeuvre.
_SAME_MANOEUVRE = 1.25
#: Standard deviation of a coefficient from trial to trial of one ship at one loading, in shares of itself, where the model
#: leaves an error of its structure.
_REPEATED = 0.1


@dataclass(frozen=True)
class LoadPart:
    """What trials at several loadings say of the part of the coefficients that depends on it.

    Attributes
    ----------
    measure : str
        What says the loading: ``draught`` or ``displacement``.
    loadings : tuple of float
        The loadings of the trials, SI, rising; those within 3 % are one.
    log_odds : float or None
        Natural logarithm of the odds of the model with the part against the one without it; None where it was not tried.
    kept : bool
        Whether the coefficients depend on the loading in the fit.
    why : str
        Why they do not, a sentence; empty where they do.
    """

    measure: str
    loadings: tuple[float, ...]
    log_odds: float | None
    kept: bool
    why: str = ""

    @property
    def odds(self) -> str:
        """The odds in words."""
        if self.log_odds is None:
            return "not known"
        size = brief(np.exp(abs(self.log_odds)), 2) if abs(self.log_odds) < np.log(1e5) else "more than 100000"
        return f"{size} to 1" if self.log_odds >= 0 else f"1 to {size}"

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI."""
        return {
            "measure": self.measure,
            "loadings": list(self.loadings),
            "unit": {"draught": "m", "displacement": "kg"}[self.measure],
            "log_odds": plain(self.log_odds),
            "kept": self.kept,
            "why": self.why,
        }


def weigh_load_part(problem: Problem, values: np.ndarray, covariance: np.ndarray, structural: bool) -> LoadPart:
    """Return what a fit of a model whose coefficients depend on the loading says of that part.

    Parameters
    ----------
    problem : Problem
        What was solved, with the prior of the part.
    values : ndarray, shape (parameters,)
        The coefficients that were found.
    covariance : ndarray, shape (parameters, parameters)
        Their covariance.
    structural : bool
        Whether the residuals are those of a structure that is wrong: then manoeuvres that differ may look like loadings.

    Returns
    -------
    LoadPart
    """
    model, trials = problem.model, [data.trial for data in problem.trials]
    measure = measure_of(model)
    assert measure is not None and problem.prior is not None
    by_loading = _grouped(trials, measure)
    loadings = tuple(by_loading)
    if len(loadings) < 2:
        return LoadPart(measure, loadings, None, False, "the trials were sailed at one loading.")
    names = [n for n in load_parts(model).values() if n in problem.prior.parameters]
    at = [problem.estimated.index(n) for n in names]
    before = np.array([problem.prior.parameters[n][1] for n in names])
    # In standard deviations of the prior, about zero, where it has its mean.
    after = covariance[np.ix_(at, at)] / np.outer(before, before)
    part = values[at] / before
    if not np.isfinite(after).all():
        return LoadPart(
            measure, loadings, None, False, "the trials hold no information about a part that depends on it."
        )
    if structural:
        spread = _REPEATED / (max(loadings) / min(loadings) - 1)
        after = after + spread**2 * np.eye(len(at))
    log_odds = 0.5 * float(part @ np.linalg.solve(after, part) + np.linalg.slogdet(after)[1])
    found = LoadPart(measure, loadings, log_odds, False)
    if log_odds < np.log(STRONG):
        return _without(
            found,
            f"the odds that the coefficients change with the {measure} are {found.odds}, and have to be {STRONG:g} to 1.",
        )
    reached = {v: largest_amplitudes(group).get("rudder", 0.0) for v, group in by_loading.items()}
    if structural and max(reached.values()) > _SAME_MANOEUVRE * min(reached.values()):
        each = ", ".join(f"{shown(d, 'delta', 'rad', 3)} at {shown(v, measure, digits=3)}" for v, d in reached.items())
        return _without(
            found,
            f"the manoeuvres differ as well (rudder angles up to {each}), and the model leaves more of the trials than noise: what comes of "
            "the loading cannot be told from what comes of the manoeuvre. Sail the same manoeuvre at each loading.",
        )
    return LoadPart(measure, loadings, log_odds, True)


def _without(found: LoadPart, why: str) -> LoadPart:
    return LoadPart(found.measure, found.loadings, found.log_odds, False, why)


def _grouped(trials: Sequence[Trial], measure: str) -> Mapping[float, list[Trial]]:
    """Trials by their loading, rising; those within 3 % are at one."""
    stated = sorted(((v, t) for t in trials if (v := loading_of(t, measure)) is not None), key=lambda pair: pair[0])
    groups: dict[float, list[Trial]] = {}
    first = None
    for value, trial in stated:
        if first is None or not one_loading([first, value]):
            first = value
        groups.setdefault(first, []).append(trial)
    return groups
