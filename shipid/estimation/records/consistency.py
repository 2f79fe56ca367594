"""Consistency of a filter: whether its innovations are white."""

from __future__ import annotations

import numpy as np

from shipid.foundation.statistics import ljung_box

#: A larger share of a sensor's samples beyond the gate is no accident.
REJECTED_SHARE = 0.1
#: Mean squared normalised innovations that still fit a filter: standard deviations right to 40 %.
FITTING = (0.5, 2.0)
#: Lags of the whiteness test: enough for a ship's oscillation sampled a few times a second, few enough for a short record.
_LAGS = 20
#: Smallest number of values that is tested.
_FEWEST = 30


def whiteness(values: np.ndarray) -> float | None:
    """Return the probability of correlations as large as these if the values were white (Ljung and Box 1978).

    Parameters
    ----------
    values : ndarray, shape (N,)
        Normalised innovations in the order of time.

    Returns
    -------
    float or None
        None for fewer than 30 values.
    """
    if values.size < _FEWEST:
        return None
    test = ljung_box(values, min(_LAGS, values.size // 3))
    # Values that do not vary have no correlation at all.
    return test.p_value if test.degrees else 1.0
