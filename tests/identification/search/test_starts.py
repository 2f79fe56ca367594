"""Where a search begins: first values and random others, all of them numbers."""

import numpy as np

from shipid.identification.problem.box import Box
from shipid.identification.search.least_squares import make_starts


def test_a_parameter_without_bounds_starts_at_numbers():
    start, infinite = np.array([1.0, 0.0, 0.05]), np.full(3, np.inf)
    for low in (-infinite, np.array([0.0, -np.inf, 0.01])):
        assert np.isfinite(make_starts(Box(start, low, infinite), 5, seed=0)).all()
