"""Models ranked by how they predict trials they were not fitted to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.vocabulary import display_unit, to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, plain_notices
from shipid.identification.validation.comparison import Comparison

if TYPE_CHECKING:
    import pandas as pd

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
_SHOWN = ("rate", "heading_refitted_bias", "overshoot", "speed", "sway", "heading_warm", "heading")


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
        How many of them only the trials determine: those without a declared prior.
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
    predictions : tuple of Comparison
        The left-out trials beside what it predicts of them; not part of `to_dict`.
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
    predictions: tuple[Comparison, ...] = ()

    def to_dict(self) -> dict[str, Plain]:
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
    warnings : tuple of Notice
        Where a trial that was predicted goes beyond those that were fitted.
    """

    ranks: tuple[Rank, ...]
    folds: tuple[str, ...]
    tied: tuple[str, ...]
    warnings: tuple[Notice, ...] = ()

    @property
    def best(self) -> str | None:
        """The model to take among those that are tied; None where none fitted.

        It is the one with the fewest coefficients that only the trials determine: where others are sailed than those that
        were left out, what is known of ships in general carries further than what two trials tell. Then the one that reads
        most of what was recorded, as a wind that was measured has turned the ship; then the one with fewer coefficients.
        """
        tied = [r for r in self.ranks if r.model in self.tied]
        return min(tied, key=lambda r: (r.free, -r.reads, r.coefficients, r.score or 0.0)).model if tied else None

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON."""
        units = {name: unit for name, (unit, _) in MEASURES.items()}
        return {
            "best": self.best,
            "tied": list(self.tied),
            "folds": list(self.folds),
            "units": units,
            "ranking": [r.to_dict() for r in self.ranks],
            "warnings": plain_notices(self.warnings),
        }

    def to_frame(self) -> pd.DataFrame:
        """Return the ranking as a pandas table, angles in degrees."""
        import pandas as pd

        rows = [
            {"model": r.model, "score": r.score, "std": r.std}
            | {f"{n} [{display_unit('', u)}]": _displayed(n, r.measures.get(n)) for n, (u, _) in MEASURES.items()}
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
            cells = [_displayed(n, r.measures.get(n)) for n in _SHOWN]
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
        lines += [f"  beyond: {notice}" for notice in self.warnings]
        return "\n".join(lines)


def tied_models(ranks: Sequence[Rank]) -> tuple[str, ...]:
    """Return the best, and those that are worse by no more than one standard error of the difference.

    Left-out trials are hard or easy for all models alike, so that only the differences between models count.

    Parameters
    ----------
    ranks : sequence of Rank
        Best first.

    Returns
    -------
    tuple of str
        Names of the models; empty where none could be fitted.
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


def _displayed(name: str, value: float | None) -> float | None:
    """A measure in the unit a reader expects."""
    return None if value is None else to_display(value, "", MEASURES[name][0])
