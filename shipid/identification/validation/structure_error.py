"""The error that a model has by its structure, for the bands of what it predicts.

A low-order model is wrong by its form, and the covariance of its coefficients says nothing of that. Trials that were left out
show it: their errors are pooled with what low-order models usually miss. It grows where a manoeuvre goes beyond the
amplitudes that were fitted.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from scipy.special import stdtrit

from shipid.declaration.model import Model
from shipid.foundation.result import ResultEntry
from shipid.foundation.statistics import NORMAL_95
from shipid.identification.uncertainty.amplitudes import largest_amplitudes
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.left_out import LeftOutTrial
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.validity import growth_beyond

#: What an overshoot is missed by, in rad, before a trial was left out, and how many independent errors that counts as.
USUAL, USUAL_COUNT = np.deg2rad(1.5), 4.0
#: Independent errors in the overshoots of one trial: those of a zig-zag err together.
_INDEPENDENT = 2.0
#: Standard error of a turning circle in shares of what is predicted, at the amplitudes that were fitted. The transfer is the smallest
#: of the distances and has the largest relative error.
TURN_SHARES = {
    "advance": 0.05,
    "transfer": 0.1,
    "tactical_diameter": 0.05,
    "steady_rate": 0.05,
    "steady_speed": 0.05,
}


@dataclass(frozen=True, repr=False)
class StructureError(ResultEntry):
    """Standard errors by the structure of a model.

    Attributes
    ----------
    open_loop, closed_loop : float
        Of an overshoot in rad, with the recorded rudder and with the rudder reversed at the headings.
    degrees : float
        Degrees of freedom of both.
    trials : int
        How many left-out trials they come from.
    turn : mapping of str to float
        Of the quantities of a turning circle, in shares of the prediction.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"open_loop": "rad", "closed_loop": "rad", "degrees": "1"}

    open_loop: float = float(USUAL)
    closed_loop: float = float(USUAL)
    degrees: float = USUAL_COUNT
    trials: int = 0
    turn: Mapping[str, float] = field(default_factory=lambda: TURN_SHARES)

    def half_width(self, closed: bool, growth: float) -> float:
        """Return the half-width in rad of a 95 % band of an overshoot.

        Parameters
        ----------
        closed : bool
            Whether the rudder is reversed at the headings.
        growth : float
            See `growth_of`.
        """
        return float(stdtrit(self.degrees, 0.975)) * growth * (self.closed_loop if closed else self.open_loop)

    def share(self, name: str, growth: float) -> float:
        """Return the half-width of a 95 % band of a turning circle's quantity, in shares of the prediction.

        Parameters
        ----------
        name : str
            The quantity.
        growth : float
            See `growth_of`.
        """
        return NORMAL_95 * growth * self.turn[name]


def structure_error(trials: Iterable[LeftOutTrial]) -> StructureError:
    """Return the error of a structure from trials that were left out.

    Parameters
    ----------
    trials : iterable of LeftOutTrial
        Zig-zags count, with all their overshoots.
    """
    known = [t for t in trials if t.comparison.overshoots]
    measured = [t.comparison.overshoots for t in known]
    open_loop = [t.comparison.predicted_overshoots for t in known]
    closed = [() if t.swings is None else t.swings.overshoots for t in known]
    return StructureError(
        _pooled(measured, open_loop), _pooled(measured, closed), USUAL_COUNT + _INDEPENDENT * len(known), len(known)
    )


def _pooled(measured: Sequence[Sequence[float]], predicted: Sequence[Sequence[float | None]]) -> float:
    """The root of the mean square of the errors and of what is usual; a swing that is not reached is missed whole."""
    squares = [
        float(np.mean([(m - (p or 0.0)) ** 2 for m, p in zip(one, other)]))
        for one, other in zip(measured, predicted)
        if one and other
    ]
    together = USUAL_COUNT * USUAL**2 + _INDEPENDENT * sum(squares)
    return float(np.sqrt(together / (USUAL_COUNT + _INDEPENDENT * len(squares))))


def growth_of(model: Model, ship: ParameterSet, comparison: Comparison) -> float:
    """Return how far a prediction goes beyond the amplitudes that were fitted, 1 where it does not.

    It is the larger of the ratios of the rudder angles and of the rates of turn, the rate being the predicted one: what was measured
    does not shape the band that is to hold it.

    Parameters
    ----------
    model : Model
        The model.
    ship : ParameterSet
        The identified ship, with the amplitudes of her trials.
    comparison : Comparison
        The record and its prediction.
    """
    reached = largest_amplitudes([comparison.trial]).get("rudder")
    rate = np.abs(comparison.predicted.get("r", np.zeros(1)))
    return growth_beyond(model, ship, reached, float(rate.max()) if np.isfinite(rate).all() else None)
