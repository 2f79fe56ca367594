"""What was known of a ship at past instants, how she sailed on from there, and how far off predictions from there were."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief
from shipid.prediction.situations.situation import PastErrors, Situation

#: Independent predictions that the band itself counts as: it is not given up for a few that went wrong.
_BELIEVED = 4.0
#: Distances in ship lengths at which past predictions are looked at.
LOOKED_AT = np.array([0.5, 1.0, 2.0, 4.0, 8.0])
#: Past predictions begin so many L/U apart: the errors of a model last for so long.
APART = 1.5
#: A prediction that runs away or cannot be made, where the ship sailed on, counts as so many standard deviations off.
RUN_AWAY = 5.0
#: A band that is widened by more than this share is told.
_TOLD = 0.1


@dataclass(frozen=True, eq=False)
class Past:
    """Past instants and the voyage since; N samples, SI.

    Attributes
    ----------
    situations : tuple of Situation
        What was known then, with all that a prediction takes from it.
    t : ndarray, shape (N,)
        Times of the voyage in s, on the clock of the situations.
    x, y, psi, u : ndarray, shape (N,)
        Position in m, heading in rad and speed in m/s as they were estimated.
    delta : ndarray, shape (N,)
        Rudder angle in rad.
    sailed : ndarray, shape (N,)
        Distance through the water in m.
    """

    situations: tuple[Situation, ...]
    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    psi: np.ndarray
    u: np.ndarray
    delta: np.ndarray
    sailed: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        steps = 0.5 * (self.u[1:] + self.u[:-1]) * np.diff(self.t)
        object.__setattr__(self, "sailed", np.concatenate([[0.0], np.cumsum(steps)]))


def errors_of(across: np.ndarray, turned: np.ndarray, lost: int = 0) -> PastErrors:
    """Return by how much the bands of past predictions were too narrow.

    Parameters
    ----------
    across, turned : ndarray, shape (predictions, distances)
        Distance of the ship from the predicted track, and of her heading from the predicted one, in standard deviations of its band, at
        the distances `LOOKED_AT`; not a number where she has not sailed so far yet. The predictions begin `APART` from one another, and
        those that overlap err together.
    lost : int
        How many of the predictions ran away or could not be made; they are among the distances as `RUN_AWAY`.

    Returns
    -------
    PastErrors

    Notes
    -----
    The variance of the band counts as that of four predictions: with n independent ones of mean square m, in variances of the band,
    it is multiplied by (4 + n m) / (4 + n), and never made smaller.
    """
    counted = np.isfinite(across).sum(axis=0)
    independent = counted * np.minimum(1.0, APART / LOOKED_AT)
    factors = []
    for off in (across, turned):
        mean = np.divide(np.nansum(off**2, axis=0), counted, out=np.ones(counted.size), where=counted > 0)
        factors.append(np.sqrt(np.maximum(1.0, (_BELIEVED + independent * mean) / (_BELIEVED + independent))))
    seen = counted > 0
    return PastErrors(LOOKED_AT[seen], factors[0][seen], factors[1][seen], int(counted.max(initial=0)), lost)


def told_of(errors: PastErrors) -> list[Notice]:
    """Return what has to be said of a band that past predictions widen.

    Parameters
    ----------
    errors : PastErrors
        The errors.

    Returns
    -------
    list of Notice
        None where the bands were wide enough.
    """
    bands = {
        "band": float(errors.track.max(initial=1.0)),
        "band of the heading": float(errors.heading.max(initial=1.0)),
    }
    widest = max(bands.values())
    lost = []
    if errors.lost:
        lost = [
            Notice(
                f"{errors.lost} of the last {errors.count} predictions of her ran away or could not be made where she sailed on: each "
                f"counts as {RUN_AWAY:g} standard deviations off.",
                "past-predictions-lost",
                lost=errors.lost,
                count=errors.count,
            )
        ]
    if widest <= 1 + _TOLD:
        return lost
    wider = " and ".join(
        f"the {n} is up to {brief(factor, 2)} times" for n, factor in bands.items() if factor > 1 + _TOLD
    )
    return [
        *lost,
        Notice(
            f"The last {errors.count} predictions of her were farther off than their bands allow: {wider} as wide as the model states.",
            "band-widened",
            factor=widest,
        ),
    ]
