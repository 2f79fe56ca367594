"""How well a record knows the constant bias of an input: a rudder that does not move has none that can be told."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.vocabulary import to_display
from shipid.estimation.levels.record_levels import BiasStanding
from shipid.estimation.standing import UNKNOWN, standing_of

#: A rudder that stays within this range [rad] is not steered.
_STEERED = np.deg2rad(1.0)


def is_steered(columns: Mapping[str, np.ndarray]) -> bool:
    """Return whether the rudder of a record moves, by more than the noise of its feedback.

    Parameters
    ----------
    columns : mapping of str to ndarray
        The record, SI.
    """
    rudder = columns.get("delta", np.zeros(0))
    shown = rudder[np.isfinite(rudder)]
    return bool(shown.size) and float(np.ptp(np.quantile(shown, (0.02, 0.98)))) > _STEERED


def bias_standings(
    model: Model, biases: Mapping[str, float], std: np.ndarray, sizes: np.ndarray, *, steered: bool, informed: bool
) -> dict[str, BiasStanding]:
    """Return what a record says of each bias, by input.

    Parameters
    ----------
    model : Model
        Whose inputs they are.
    biases : mapping of str to float
        The biases, SI.
    std, sizes : ndarray, shape (biases,)
        Their standard deviations, zero where one ended at its bound, and those before the record, SI.
    steered : bool
        Whether the rudder moves.
    informed : bool
        Whether the record determines a coefficient: as long as it does not, a rudder's bias is only known in its product with one.
    """
    found = {}
    for (name, value), own, size in zip(biases.items(), np.where(std > 0, std, np.nan), sizes):
        # As it is shown, since the reason holds numbers.
        value, spread, usual = (to_display(float(v), name, model[name].unit) for v in (value, own, size))
        standing, why = standing_of(value, spread, size=usual, before=usual)
        if name == "delta" and not (steered and informed):
            still = "neither are the coefficients" if steered else "the rudder does not move"
            standing, why = UNKNOWN, f"{still}: wind or current may turn the ship as well."
        found[name] = BiasStanding(float(own), standing, why)
    return found
