"""Choosing a structure: every model predicts trials it was not fitted to, and the predictions are ranked.

Each trial is left out in turn, the model is fitted to the others and predicts it; a single trial is cut in two halves that
predict each other. The error of the fitted trials never enters: it falls with every coefficient that is added.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.errors import ShipidError, UsageError
from shipid.identification.fit import Comparison, Fit
from shipid.identification.identify import identify
from shipid.identification.search.least_squares import Progress
from shipid.parameters.catalogue import find_model
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.trial import Trial

#: What a prediction is judged by: name, unit of the value, meaning. Each counts in shares of what was measured. A heading
#: that is not corrected for a rudder bias is shown and does not count: on a ship that hardly keeps her course it measures
#: the bias, which no structure knows.
MEASURES = {
    "rate": ("rad/s", "rms error of the rate of turn, nothing refitted"),
    "heading_refitted_bias": ("rad", "rms error of the heading with rudder bias and initial state refitted"),
    "overshoot": ("rad", "rms error of the first two overshoot angles, recorded rudder"),
    "speed": ("m/s", "rms error of the forward speed, nothing refitted"),
    "sway": ("m/s", "rms error of the sway speed, nothing refitted"),
    "heading_warm": (
        "rad",
        "rms error of the heading after a warm-up to the first reversal of the rudder; not counted",
    ),
    "heading": ("rad", "rms error of the heading, nothing refitted; not counted"),
}
_COUNTED = ("rate", "heading_refitted_bias", "overshoot", "speed", "sway")
_SHOWN = ("rate", "heading_refitted_bias", "overshoot", "speed", "sway", "heading_warm", "heading")
#: What a model may take as given although it is what the ship does.
_MOTION = ("x", "y", "psi", "u", "v", "r", "cruise")
#: Share of what was measured at which a prediction is no better than none.
_WORTHLESS = 3.0


@dataclass(frozen=True)
class Rank:
    """One model of a comparison.

    Attributes
    ----------
    model : str
        Its name.
    coefficients : int
        How many it estimates.
    free : int
        How many of them nothing but the trials says anything about: those the model declares no belief of.
    reads : int
        How many recorded inputs it reads, as the rudder and the wind; a motion of the ship is no input.
    score : float or None
        Geometric mean over left-out trials and measures of the error in shares of what was measured; smaller is better.
        None where no fold could be fitted.
    std : float or None
        Standard error of the score, from the scatter between left-out trials; None for fewer than two.
    shares : tuple of float
        The score of each left-out trial.
    measures : mapping of str to float or None
        Root-mean-square of each measure over the left-out trials, SI.
    validation : mapping of str to mapping
        Measures of trials kept apart, from a fit to all the others.
    message : str
        What went wrong on the way.
    """

    model: str
    coefficients: int
    free: int
    reads: int
    score: float | None
    std: float | None
    shares: tuple[float, ...]
    measures: Mapping[str, float | None]
    validation: Mapping[str, Mapping[str, float | None]]
    message: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return plain values, free of NaN."""
        return {
            "model": self.model,
            "coefficients": self.coefficients,
            "free": self.free,
            "reads": self.reads,
            "score": self.score,
            "std": self.std,
            "shares": list(self.shares),
            "measures": dict(self.measures),
            "validation": {n: dict(m) for n, m in self.validation.items()},
            "message": self.message,
        }


@dataclass(frozen=True)
class Ranking:
    """Models ranked by how they predict what they were not fitted to.

    Attributes
    ----------
    ranks : tuple of Rank
        Best first; models without a score last.
    folds : tuple of str
        What was left out, in turn.
    tied : tuple of str
        Models whose score is within one standard error of the smallest, the error being that of the difference.
    """

    ranks: tuple[Rank, ...]
    folds: tuple[str, ...]
    tied: tuple[str, ...]

    @property
    def best(self) -> str | None:
        """The model to take among those that are tied; None where none fitted.

        It is the one with the fewest coefficients that only the trials determine: where others are sailed than those that
        were left out, what is known of ships in general carries further than what two trials tell. Then the one that reads
        most of what was recorded, as a wind that was measured has turned the ship; then the one with fewer coefficients.
        """
        tied = [r for r in self.ranks if r.model in self.tied]
        return min(tied, key=lambda r: (r.free, -r.reads, r.coefficients, r.score or 0.0)).model if tied else None

    def to_dict(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        units = {name: unit for name, (unit, _) in MEASURES.items()}
        return {
            "best": self.best,
            "tied": list(self.tied),
            "folds": list(self.folds),
            "units": units,
            "ranking": [r.to_dict() for r in self.ranks],
        }

    def to_frame(self) -> Any:
        """Return the ranking as a pandas table, angles in degrees."""
        import pandas as pd

        rows = [
            {"model": r.model, "score": r.score, "std": r.std}
            | {f"{n} [{u.replace('rad', 'deg')}]": _shown(n, r.measures.get(n)) for n, (u, _) in MEASURES.items()}
            for r in self.ranks
        ]
        return pd.DataFrame(rows).set_index("model")

    def __repr__(self) -> str:
        lines = [f"predictions of what was left out ({', '.join(self.folds)}); a smaller score is better"]
        lines.append(
            f"  {'model':<22s}{'score':>14s}{'rate':>9s}{'bias':>9s}{'overshoot':>11s}{'speed':>9s}{'sway':>9s}{'warm':>9s}{'as it is':>10s}"
        )
        for r in self.ranks:
            score = "-" if r.score is None else f"{r.score:.3f}" + ("" if r.std is None else f" ± {r.std:.3f}")
            cells = [_shown(n, r.measures.get(n)) for n in _SHOWN]
            shown = [("-" if c is None else f"{c:.3g}").rjust(w) for c, w in zip(cells, (9, 9, 11, 9, 9, 9, 10))]
            lines.append(f"  {r.model:<22s}{score:>14s}{''.join(shown)}" + (f"  {r.message}" if r.message else ""))
        lines.append(
            "  rate in deg/s, speed and sway in m/s, the others in deg; 'as it is' is the heading with nothing refitted"
        )
        if len(self.tied) > 1:
            lines.append(f"  within one standard error of the smallest: {', '.join(self.tied)}")
        if self.best:
            lines.append(
                f"  to take: {self.best}, the one of these with the fewest coefficients that only trials determine"
            )
        return "\n".join(lines)


def compare_models(
    models: Sequence[Model | str],
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
    models : sequence of Model or str
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
    whole = [find_model(m) if isinstance(m, str) else m for m in models]
    folds = _folds(trials)
    ranks = []
    for model in whole:
        compared, trouble = [], ""
        for left_out, rest in folds:
            tell(f"{model.name}: predicting {left_out.name}")
            fit, trouble = _attempt(model, rest, [left_out], ship, starts, seed)
            compared.append(fit.validation[0] if fit else None)
        kept: Fit | None = None
        if validate:
            tell(f"{model.name}: fitting all trials")
            kept, trouble = _attempt(model, trials, validate, ship, starts, seed)
        ranks.append(_rank(model, compared, kept, trouble))
    ranks.sort(key=lambda r: (r.score is None, r.score or 0.0))
    return Ranking(tuple(ranks), tuple(left_out.name for left_out, _ in folds), _tied(ranks))


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


def _rank(model: Model, compared: Sequence[Comparison | None], kept: Fit | None, trouble: str) -> Rank:
    folds = [_measures(model, c) for c in compared if c is not None]
    together = {n: _together([m[n] for m, _ in folds]) for n in MEASURES}
    # A fold that could not be fitted counts as a prediction that is worth nothing.
    scores = [float(np.log(_WORTHLESS)) if c is None else _score(*_measures(model, c)) for c in compared]
    score = float(np.exp(np.mean(scores))) if folds else None
    std = score * float(np.std(scores, ddof=1)) / len(scores) ** 0.5 if score is not None and len(scores) > 1 else None
    validation = {c.trial.name: _measures(model, c)[0] for c in kept.validation} if kept else {}
    trials = [c.trial for c in compared if c is not None]
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
    )


def _measures(model: Model, c: Comparison) -> tuple[dict[str, float | None], dict[str, float]]:
    """Measures of one prediction, and the size of what was measured, by measure."""
    size = {n: float(np.std(c.trial[n])) if c.trial.has(n) else 1.0 for n in ("psi", "r", "u", "v")}
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
    return {n: v if v is not None and np.isfinite(v) else None for n, v in found.items()}, sizes


def _missed(model: Model, c: Comparison, name: str) -> float | None:
    """Error of a speed; a model that says nothing of it has the speed of the approach, and no sway."""
    if not c.trial.has(name):
        return None
    if name in c.predicted and model[name].quantity.kind != "given":
        predicted = c.predicted[name]
    else:
        predicted = c.predicted["u"][:1] if name == "u" and "u" in c.predicted else np.zeros(1)
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.sqrt(np.mean((c.trial[name] - predicted) ** 2)))


def _score(measures: Mapping[str, float | None], size: Mapping[str, float]) -> float:
    """Mean logarithm of the counted measures in shares of what was measured."""
    shares = [
        min(_WORTHLESS, max(1e-6, v / size[n])) for n in _COUNTED if (v := measures[n]) is not None and size[n] > 0
    ]
    return float(np.mean(np.log(shares))) if shares else float(np.log(_WORTHLESS))


def _together(values: Sequence[float | None]) -> float | None:
    known = [v for v in values if v is not None]
    return float(np.sqrt(np.mean(np.square(known)))) if known else None


def _tied(ranks: Sequence[Rank]) -> tuple[str, ...]:
    """The best, and those that are worse by no more than one standard error of the difference.

    Left-out trials are hard or easy for all models alike, so that only the differences between models count.
    """
    best = ranks[0]
    if best.score is None:
        return ()
    tied = [best.model]
    for r in ranks[1:]:
        worse = np.log(r.shares) - np.log(best.shares)
        reach = float(np.std(worse, ddof=1)) / worse.size**0.5 if worse.size > 1 else 0.0
        if r.score is not None and worse.mean() <= reach:
            tied.append(r.model)
    return tuple(tied)


def _shown(name: str, value: float | None) -> float | None:
    """A measure in the unit a reader expects: degrees for angles."""
    return value if value is None or "rad" not in MEASURES[name][0] else float(np.rad2deg(value))
