"""Models ranked by how they predict trials they were not fitted to, and the one to take."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from shipid.declaration.vocabulary import display_unit, to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.numbers import number, percent
from shipid.foundation.result import DrawnResult
from shipid.identification.choice.choosing import (
    MAY_RUN_AWAY,
    TIED,
    TIED_IF_POOR,
    Rank,
    chosen,
    determined,
    tied_models,
    weights_of,
    what_would_decide,
)
from shipid.identification.choice.scoring import MEASURES
from shipid.identification.evidence.explained import NOT_DETERMINED, not_determined
from shipid.parameters.validity import BEYOND

if TYPE_CHECKING:
    import pandas as pd

_COLUMNS = {
    "rate": "rate",
    "heading_refitted_bias": "bias",
    "overshoot": "open",
    "overshoot_closed": "closed",
    "period": "period",
    "speed": "speed",
    "sway": "sway",
    "heading_warm": "warm",
    "heading": "as it is",
}
#: Kinds of the notices.
TOO_POOR = "too-poor-to-choose"


@dataclass(frozen=True, repr=False)
class Ranking(DrawnResult):
    """Models ranked by how they predict what they were not fitted to.

    Attributes
    ----------
    ranks : tuple of Rank
        Best first; models without a score last.
    folds : tuple of str
        What was left out, in turn.
    lacking : tuple of str
        What the campaign lacks for a choice, in sentences; then the simplest model of those that predict about as well is taken.
    beyond : tuple of Notice
        Where a trial that was predicted goes beyond those that were fitted, or its ship astern.
    """

    ranks: tuple[Rank, ...]
    folds: tuple[str, ...]
    lacking: tuple[str, ...] = ()
    beyond: tuple[Notice, ...] = ()

    @property
    def tied(self) -> tuple[str, ...]:
        """Models whose error is within a factor of the smallest, smallest first."""
        return tied_models(self.ranks, self._factor)

    @property
    def best(self) -> str | None:
        """The model to take, see `shipid.identification.choice.choosing.chosen`; None where nothing is determined."""
        return chosen(self.ranks, self._factor)

    @property
    def others(self) -> dict[str, str | None]:
        """What would be taken if a trial were not left out, by that trial; empty where there are fewer than two."""
        if len(self.folds) < 2:
            return {}
        return {fold: chosen(self.ranks, self._factor, k) for k, fold in enumerate(self.folds)}

    @property
    def weights(self) -> dict[str, float]:
        """Weight of each model among all, their sum being 1."""
        return weights_of(self.ranks)

    @property
    def _factor(self) -> float:
        return TIED_IF_POOR if self.lacking else TIED

    @property
    def words(self) -> tuple[str, ...]:
        """What is taken, why, how firmly, and what would decide it: sentences."""
        best = self.best
        if best is None:
            return ()
        tied, others = self.tied, self.others
        if best not in tied:
            sentences = [
                f"{', '.join(tied)} can run away in a hard turn. {best}, whose error is within twice the smallest, does not, and is taken."
            ]
        elif len(tied) > 1:
            why = f"{', '.join(tied)} are tied: their errors are within a factor of {self._factor:g}. "
            why += f"{best} is taken, the one of these with the fewest coefficients that only trials determine"
            away = [r.model for r in self.ranks if r.model in tied and r.runs_away and r.model != best]
            if away:
                why += f"; {', '.join(away)} can run away in a hard turn"
            sentences = [why + "."]
        else:
            sentences = [f"No other comes within a factor of {self._factor:g} of the error of {best}."]
        same = [fold for fold, other in others.items() if other == best]
        if self.lacking:
            sentences.append("How firm the choice is cannot be told from so poor a campaign.")
        elif others and len(same) == len(others):
            sentences.append(f"The choice is firm: it is the same without any one of the {len(others)} trials.")
        elif others:
            changes = "; ".join(f"without {f} it would be {o}" for f, o in others.items() if o != best)
            sentences.append(f"The choice is not firm: {changes}.")
        decide = what_would_decide(self.ranks, tied)
        if decide:
            sentences.append(f"It would be decided by {decide}")
        return tuple(sentences)

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """What a reader has to know before taking the model."""
        found = []
        if all(r.score is None for r in self.ranks):
            found.append(
                Notice(
                    " ".join(
                        (
                            "Not determined: no candidate could be fitted to these trials. The reason stands beside each.",
                            *self.lacking,
                        )
                    ),
                    NOT_DETERMINED,
                    serious=True,
                )
            )
        elif not determined(self.ranks):
            least = min(r.unexplained for r in self.ranks if r.unexplained is not None)
            found.append(
                not_determined("no candidate explains how the ship turned in a trial that it was not fitted to", least)
            )
        elif self.lacking:
            found.append(
                Notice(
                    f"Too poor a campaign to choose by, so the simplest is taken. {' '.join(self.lacking)}", TOO_POOR
                )
            )
        best = next((r for r in self.ranks if r.model == self.best), None)
        if best is not None and best.turn is not None and best.turn.runs_away > MAY_RUN_AWAY:
            found.append(
                Notice(
                    f"{best.model} runs away in a hard turn with {percent(best.turn.runs_away)} of the coefficients that were drawn "
                    "within their uncertainty: sail a turning circle before it is used for one.",
                    "runs-away",
                )
            )
        return (*found, *self.beyond)

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON."""
        weights = self.weights
        return {
            "best": self.best,
            "tied": list(self.tied),
            "words": list(self.words),
            "without": dict(self.others),
            "folds": list(self.folds),
            "measure_weights": {n: weight for n, (_, weight, _) in MEASURES.items()},
            "ranking": [r.to_dict() | {"weight": weights[r.model]} for r in self.ranks],
            "warnings": plain_notices(self.warnings),
        }

    def to_frame(self) -> pd.DataFrame:
        """Return the ranking as a pandas table, angles in degrees."""
        import pandas as pd

        weights = self.weights
        rows = [
            {
                "model": r.model,
                "error": r.error,
                "score": r.score,
                "std": r.std,
                "spread": r.spread,
                "weight": weights[r.model],
            }
            | {f"{n} [{display_unit('', u)}]": _displayed(n, r.measures.get(n)) for n, (u, _, _) in MEASURES.items()}
            for r in self.ranks
        ]
        return pd.DataFrame(rows).set_index("model")

    def text(self) -> str:
        """Return the result in lines of text."""
        weights = self.weights
        lines = [f"predictions of what was left out ({', '.join(self.folds)}); a smaller error is better", self._head()]
        for r in self.ranks:
            if r.score is None or r.error is None:
                lines.append(f"  {r.model:<24s}{'-':>7s}  {r.message}")
                continue
            score = f"{r.score:.3f}" + ("" if r.std is None else f" ± {r.std:.3f}")
            lines.append(
                f"  {r.model:<24s}{r.error:>7.3f}{score:>15s}{r.spread:>8.3f}{percent(weights[r.model]):>8s}{_cells(r.measures)}"
                + (f"  {r.message}" if r.message else "")
            )
        shown = ", ".join(f"{_COLUMNS[n]} {w:g}" for n, (_, w, _) in MEASURES.items())
        lines += [
            "  error: score, and spread of the coefficients on top, in shares of what was measured; weight: of the model among all",
            f"  weights in the score: {shown}",
            "  rate in deg/s, speed and sway in m/s, period in s, the others in deg; bias: heading with rudder bias and initial state "
            "refitted; open, closed: overshoots with the recorded rudder, and with the rudder reversed at the headings; warm: heading "
            "after the first reversal; as it is: heading with nothing refitted",
        ]
        for name in dict.fromkeys(n for r in self.ranks for n in r.validation):
            lines += [f"predictions of {name}, which was kept apart and does not count", self._head(False)]
            lines += [
                f"  {r.model:<24s}{'':>38s}{_cells(r.validation[name])}" for r in self.ranks if name in r.validation
            ]
        lines += [f"  {sentence}" for sentence in self.words]
        if self.best:
            lines.append(f"  to take: {self.best}")
        lines += [
            f"  {'beyond' if n.kind == BEYOND else 'warning' if n.serious else 'note'}: {n}" for n in self.warnings
        ]
        return "\n".join(lines)

    def _head(self, scores: bool = True) -> str:
        names = "".join(f"{_COLUMNS[n]:>9s}" for n in MEASURES)
        return (
            f"  {'model':<24s}"
            + (f"{'error':>7s}{'score':>15s}{'spread':>8s}{'weight':>8s}" if scores else f"{'':>38s}")
            + names
        )


def _cells(measures: object) -> str:
    """One cell a measure."""
    assert isinstance(measures, dict)
    cells = [_displayed(n, measures.get(n)) for n in MEASURES]
    return "".join(("-" if c is None else number(c, 3)).rjust(9) for c in cells)


def _displayed(name: str, value: float | None) -> float | None:
    """A measure in the unit a reader expects."""
    return None if value is None else to_display(value, "", MEASURES[name][0])
