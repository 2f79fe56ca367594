"""The choice among candidates: which are tied, which of them to take, how firmly, and what would decide it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import hypot
from typing import ClassVar

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import quantity
from shipid.foundation.result import Result
from shipid.identification.choice.hard_turn import HardTurn
from shipid.identification.choice.scoring import MEASURES
from shipid.identification.evidence.explained import nothing_explained
from shipid.identification.validation.comparison import Comparison

#: Factor of the smallest error within which models are tied; where a campaign is too poor to choose by, there is one of its own.
TIED, TIED_IF_POOR = 1.25, 2.0
#: Factor within which a model that holds in a hard turn is taken instead of one that can run away there.
HOLDING = 2.0
#: Share of the draws that may run away in a hard turn.
MAY_RUN_AWAY = 0.05
#: A weight is the error to this power: what averages well is close to what predicts best.
_POWER = -4.0
#: Ratio of the steady rates in a hard turn from which that turn tells models apart.
_APART = 1.1


@dataclass(frozen=True, repr=False)
class Rank(Result):
    """One model of a comparison.

    Attributes
    ----------
    model : str
        Its name.
    coefficients : int
        How many it estimates.
    free : int
        How many of them only the trials determine: those without a declared prior. A model that is told the speed of the trial it
        predicts counts two more, those of a surge equation.
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
    spread : float
        Standard deviation of the rate of turn over draws of the coefficients, in shares of its size: on the trials kept apart
        (their rudder alone is used), or on the left-out ones and a hard turn in which the model does not run away.
    unexplained : float or None
        Error of the rate of turn of the left-out trials in shares of its size.
    turn : HardTurn or None
        What the model does in a hard turn.
    predictions : tuple of Comparison
        The left-out trials beside what it predicts of them; not part of `to_dict`.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"score": "1", "std": "1", "shares": "1", "spread": "1", "unexplained": "1"}

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
    spread: float = 0.0
    unexplained: float | None = None
    turn: HardTurn | None = None
    predictions: tuple[Comparison, ...] = ()

    @property
    def error(self) -> float | None:
        """What is expected of a prediction: the score, and the spread of the coefficients on top."""
        return None if self.score is None else hypot(self.score, self.spread)

    @property
    def runs_away(self) -> bool:
        """Whether the model can run away in a hard turn, as far as its coefficients are determined."""
        return self.turn is not None and self.turn.runs_away > MAY_RUN_AWAY

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, free of NaN."""
        return {
            "model": self.model,
            "coefficients": self.coefficients,
            "free": self.free,
            "reads": self.reads,
            "score": self.score,
            "std": self.std,
            "spread": self.spread,
            "error": self.error,
            "shares": list(self.shares),
            "measures": _with_units(self.measures),
            "hard_turn": None if self.turn is None else self.turn.to_dict(),
            "validation": {n: _with_units(m) for n, m in self.validation.items()},
            "message": self.message,
        }


def _with_units(measures: Mapping[str, float | None]) -> dict[str, Plain]:
    return {n: quantity(v, MEASURES[n][0]) for n, v in measures.items()}


def tied_models(ranks: Sequence[Rank], factor: float = TIED, without: int | None = None) -> tuple[str, ...]:
    """Return the model of the smallest error, and those whose error is within a factor of it.

    Parameters
    ----------
    ranks : sequence of Rank
        In any order.
    factor : float
        The factor.
    without : int, optional
        A left-out trial that does not count.

    Returns
    -------
    tuple of str
        Names, smallest error first; empty where none could be fitted.
    """
    errors = {r.model: e for r in ranks if (e := _error(r, without)) is not None}
    least = min(errors.values(), default=0.0)
    return tuple(sorted((m for m, e in errors.items() if e <= factor * least), key=errors.__getitem__))


def chosen(ranks: Sequence[Rank], factor: float = TIED, without: int | None = None) -> str | None:
    """Return the model to take among those that are tied; None where none could be fitted, or none explains the turns.

    One that can run away in a hard turn is not taken where another, tied or within twice the smallest error, does not. Then the
    fewest coefficients that only the trials determine:
    where others are sailed than those that were left out, what is known of ships in general carries further than what two
    trials tell. Then the one that reads most of what was recorded, as a wind that was measured has turned the ship; then
    the one of the smallest error.

    Parameters
    ----------
    ranks, factor, without
        See `tied_models`.
    """
    if not determined(ranks):
        return None
    for within in (factor, max(factor, HOLDING)):
        names = tied_models(ranks, within, without)
        holding = [r for r in ranks if r.model in names and not r.runs_away]
        if holding:
            return min(holding, key=lambda r: (r.free, -r.reads, names.index(r.model))).model
    names = tied_models(ranks, factor, without)
    tied = [r for r in ranks if r.model in names]
    return min(tied, key=lambda r: (r.free, -r.reads, names.index(r.model))).model if tied else None


def determined(ranks: Sequence[Rank]) -> bool:
    """Return whether a candidate explains the rate of turn of a trial that it was not fitted to.

    Parameters
    ----------
    ranks : sequence of Rank
        The candidates.
    """
    known = [r.unexplained for r in ranks if r.score is not None and r.unexplained is not None]
    return not nothing_explained(min(known, default=None))


def weights_of(ranks: Sequence[Rank]) -> dict[str, float]:
    """Return the weight of each model, for an average of their predictions or to see how they stand; their sum is 1.

    Parameters
    ----------
    ranks : sequence of Rank
        The candidates.
    """
    errors = {r.model: r.error for r in ranks}
    raw = {m: 0.0 if e is None else float(max(e, 1e-6) ** _POWER) for m, e in errors.items()}
    total = sum(raw.values())
    return {m: w / total if total else 0.0 for m, w in raw.items()}


def what_would_decide(ranks: Sequence[Rank], tied: Sequence[str]) -> str | None:
    """Return in words which trial would tell tied models apart; None where one is alone.

    Parameters
    ----------
    ranks : sequence of Rank
        The candidates.
    tied : sequence of str
        Those that are tied.
    """
    if len(tied) < 2:
        return None
    turns = {r.model: r.turn for r in ranks if r.model in tied and r.turn is not None and r.turn.rate}
    if len(turns) > 1:
        rates = {m: abs(t.rate or 0.0) for m, t in turns.items()}
        low, high = min(rates, key=rates.__getitem__), max(rates, key=rates.__getitem__)
        if rates[high] > _APART * rates[low]:
            return (
                f"a turning circle with {angle(turns[low].rudder, 2)} of rudder: {low} turns at {angle(rates[low], 3)}/s in it, "
                f"{high} at {angle(rates[high], 3)}/s."
            )
    return "more zig-zags, at other rudder angles: in a hard turn these models agree."


def _error(rank: Rank, without: int | None) -> float | None:
    """The error of a model, with one left-out trial not counted."""
    if without is None or rank.score is None:
        return rank.error
    shares = [s for k, s in enumerate(rank.shares) if k != without]
    return hypot(float(np.exp(np.mean(np.log(shares)))), rank.spread) if shares else rank.error
