"""Choosing a structure: every model predicts trials it was not fitted to, and the predictions are ranked.

Each trial is left out in turn, the model is fitted to the others and predicts it; a single trial is cut in two halves that
predict each other. The error of the fitted trials never enters: it falls with every coefficient that is added.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ShipidError, UsageError
from shipid.foundation.notices import Notice
from shipid.foundation.statistics import plain
from shipid.identification.fit import Fit
from shipid.identification.identify import identify
from shipid.identification.problem.signals import SIGNALS, is_predicted
from shipid.identification.search.least_squares import Progress
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.ranking import MEASURES, Rank, Ranking, tied_models
from shipid.parameters.catalogue import model_of
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.validity import BEYOND
from shipid.trials.trial import Trial

_COUNTED = ("rate", "heading_refitted_bias", "overshoot", "speed", "sway")
#: What a model may take as given although it is what the ship does.
_MOTION = ("x", "y", "psi", "u", "v", "r", "cruise")
#: Share of what was measured at which a prediction is no better than none.
_WORTHLESS = 3.0


def compare_models(
    models: Sequence[Model | type[Component] | str],
    trials: Sequence[Trial],
    *,
    ship: ParameterSet | str | None = None,
    validate: Sequence[Trial] = (),
    starts: int = 5,
    seed: int = 0,
    progress: Progress | None = None,
) -> Ranking:
    """Rank models by their predictions of trials they were not fitted to.

    Parameters
    ----------
    models : sequence of Model, component class or str
        The candidates.
    trials : sequence of Trial
        Left out in turn; a single one is cut in two halves.
    ship : ParameterSet or str, optional
        Particulars and first values.
    validate : sequence of Trial
        Trials kept apart: reported for each model, never used for the ranking.
    starts, seed
        See `shipid.identify`.
    progress : callable, optional
        Called with a line of text for each fit.

    Returns
    -------
    Ranking

    Raises
    ------
    UsageError
        If there are no models or no trials.
    """
    if not models or not trials:
        raise UsageError("a comparison needs at least one model and one trial.")
    tell = progress or (lambda _: None)
    whole = [model_of(m) for m in models]
    folds = _folds(trials)
    ranks = []
    # Once for each trial and quantity: every model is fitted to the same trials.
    beyond: dict[tuple[Plain, Plain], Notice] = {}
    for model in whole:
        compared, trouble = [], ""
        for left_out, rest in folds:
            tell(f"{model.name}: predicting {left_out.name}")
            fit, trouble = _attempt(model, rest, [left_out], ship, starts, seed)
            compared.append(fit.validation if fit else None)
            _note_beyond(beyond, fit)
        kept: Fit | None = None
        if validate:
            tell(f"{model.name}: fitting all trials")
            kept, trouble = _attempt(model, trials, validate, ship, starts, seed)
            _note_beyond(beyond, kept)
        ranks.append(_rank(model, compared, kept, trouble))
    ranks.sort(key=lambda r: (r.score is None, r.score or 0.0))
    names = tuple(left_out.name for left_out, _ in folds)
    return Ranking(tuple(ranks), names, tied_models(ranks), tuple(beyond.values()))


def _note_beyond(found: dict[tuple[Plain, Plain], Notice], fit: Fit | None) -> None:
    """Keep what a fit says of trials that go beyond those it was fitted to."""
    for notice in () if fit is None else fit.warnings:
        if notice.kind == BEYOND:
            found.setdefault((notice.known["subject"], notice.known["quantity"]), notice)


def _folds(trials: Sequence[Trial]) -> list[tuple[Trial, list[Trial]]]:
    if len(trials) > 1:
        return [(one, [o for o in trials if o is not one]) for one in trials]
    clock = trials[0]["t"]
    middle = clock[clock.size // 2]
    halves = [trials[0].window(clock[0], middle), trials[0].window(middle, clock[-1])]
    return [(halves[0], [halves[1]]), (halves[1], [halves[0]])]


def _attempt(
    model: Model,
    trials: Sequence[Trial],
    validate: Sequence[Trial],
    ship: ParameterSet | str | None,
    starts: int,
    seed: int,
) -> tuple[Fit | None, str]:
    """A fit for prediction, or None with what went wrong: a model that cannot be fitted ranks last, it stops nothing."""
    try:
        fit = identify(model, trials, ship=ship, purpose="prediction", validate=validate, starts=starts, seed=seed)
    except ShipidError as error:
        return None, str(error)
    return fit, "" if fit.converged else "a search did not converge."


def _rank(model: Model, compared: Sequence[Sequence[Comparison] | None], kept: Fit | None, trouble: str) -> Rank:
    """Rank one model; what was left out is a trial, or the stretches of one that has holes in its inputs."""
    folds = [[_measures(model, c) for c in fold] for fold in compared if fold is not None]
    together = {n: _together([m[n] for fold in folds for m, _ in fold]) for n in MEASURES}
    # A fold that could not be fitted counts as a prediction that is worth nothing.
    scores = [
        float(np.log(_WORTHLESS)) if fold is None else float(np.mean([_score(*_measures(model, c)) for c in fold]))
        for fold in compared
    ]
    score = float(np.exp(np.mean(scores))) if folds else None
    std = score * float(np.std(scores, ddof=1)) / len(scores) ** 0.5 if score is not None and len(scores) > 1 else None
    validation = {c.trial.name: _measures(model, c)[0] for c in kept.validation} if kept else {}
    trials = [c.trial for fold in compared if fold is not None for c in fold]
    recorded = [n for n in model.inputs if n not in _MOTION and all(t.has(n) for t in trials)]
    estimated = [model[n].quantity for n in model.parameters if model[n].quantity.estimated]
    return Rank(
        model.name,
        len(estimated),
        sum(q.spread is None for q in estimated),
        len(recorded),
        score,
        std,
        tuple(np.exp(scores).tolist()),
        together,
        validation,
        trouble,
        tuple(c for fold in compared if fold is not None for c in fold),
    )


def _measures(model: Model, c: Comparison) -> tuple[dict[str, float | None], dict[str, float]]:
    """Measures of one prediction, and the size of what was measured, by measure."""
    size = {n: float(np.nanstd(c.trial[n])) if _is_there(c, n) else 1.0 for n in SIGNALS}
    pairs = [(m, p) for m, p in zip(c.overshoots[:2], c.predicted_overshoots[:2]) if p is not None]
    overshoot = float(np.sqrt(np.mean([(m - p) ** 2 for m, p in pairs]))) if pairs else None
    found = {
        "rate": c.rmse.get("r"),
        "heading_warm": c.warm.get("psi"),
        "heading_refitted_bias": c.refitted.get("psi"),
        "overshoot": overshoot,
        "speed": _missed(model, c, "u"),
        "sway": _missed(model, c, "v"),
        "heading": c.rmse.get("psi"),
    }
    sizes = {
        "rate": size["r"],
        "heading_warm": size["psi"],
        "heading_refitted_bias": size["psi"],
        "overshoot": float(np.mean(c.overshoots[:2])) if pairs else 1.0,
        "speed": size["u"],
        "sway": size["v"],
    }
    return {n: plain(v) for n, v in found.items()}, sizes


def _is_there(c: Comparison, name: str) -> bool:
    return c.trial.has(name) and bool(np.isfinite(c.trial[name]).any())


def _missed(model: Model, c: Comparison, name: str) -> float | None:
    """Error of a speed; a model that says nothing of it has the speed of the approach, and no sway."""
    if not _is_there(c, name):
        return None
    if name in c.predicted and is_predicted(model, name):
        predicted = c.predicted[name]
    else:
        predicted = c.predicted["u"][:1] if name == "u" and "u" in c.predicted else np.zeros(1)
    with np.errstate(over="ignore", invalid="ignore"):
        errors = (c.trial[name] - predicted)[np.isfinite(c.trial[name])]
        return float(np.sqrt(np.mean(errors**2)))


def _score(measures: Mapping[str, float | None], size: Mapping[str, float]) -> float:
    """Mean logarithm of the counted measures in shares of what was measured."""
    shares = [
        min(_WORTHLESS, max(1e-6, v / size[n])) for n in _COUNTED if (v := measures[n]) is not None and size[n] > 0
    ]
    return float(np.mean(np.log(shares))) if shares else float(np.log(_WORTHLESS))


def _together(values: Sequence[float | None]) -> float | None:
    known = [v for v in values if v is not None]
    return float(np.sqrt(np.mean(np.square(known)))) if known else None
