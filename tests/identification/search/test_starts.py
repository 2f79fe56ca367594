"""Where a search begins: first values and random others, all of them numbers."""

import numpy as np
import pytest

from shipid.identification.problem.box import Box
from shipid.identification.search.least_squares import make_starts
from shipid.identification.search.trust_region import search


def test_a_parameter_without_bounds_starts_at_numbers():
    start, infinite = np.array([1.0, 0.0, 0.05]), np.full(3, np.inf)
    for low in (-infinite, np.array([0.0, -np.inf, 0.01])):
        assert np.isfinite(make_starts(Box(start, low, infinite), 5, seed=0)).all()


def test_a_search_begins_where_it_is_told_however_small_the_unknowns_are():
    """A force of the wind on a ship of 200 m is 5e-7 in SI; it was begun at 1e-6 above the bound of zero."""
    start, tried = np.array([5e-7, 2e-7, 1.0]), []

    def line(q):
        tried.append(q)
        return (q - [4e-7, -3e-7, 2.0]) / [1e-7, 1e-7, 1.0], np.diag([1e7, 1e7, 1.0])

    low, high = np.array([0.0, -1e-5, -np.inf]), np.array([1e-5, 1e-5, np.inf])
    found = search(line, start, np.zeros(3, dtype=bool), low, high, most=20, tolerance=1e-10)
    assert tried[0] == pytest.approx(start, rel=1e-9)
    assert found.q == pytest.approx([4e-7, -3e-7, 2.0], rel=1e-4)
