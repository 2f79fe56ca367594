"""Corrections for estimated levels, against linear regression with an unknown variance."""

import numpy as np
import pytest

from shipid.identification.noise.small_sample import MANY, small_sample

ROWS, COEFFICIENTS = 40, 4


def information_at(design):
    """Expected information of coefficients and of the logarithm of the standard deviation."""

    def information(q):
        whole = np.zeros((q.size, q.size))
        whole[:-1, :-1] = design.T @ design / np.exp(2 * q[-1])
        whole[-1, -1] = 2 * len(design)
        return whole

    return information


def test_the_level_moves_to_the_restricted_maximum_and_the_degrees_are_the_rows():
    rng = np.random.default_rng(1)
    information = information_at(rng.standard_normal((ROWS, COEFFICIENTS)))
    q = np.array([1.0, -2.0, 0.5, 0.1, np.log(0.3)])
    found = small_sample(information, q, information(q), np.array([COEFFICIENTS]))
    # The maximum likelihood divides by n; the restricted one by n - p, which is exp(p / n) to first order.
    assert found.q[-1] - q[-1] == pytest.approx(COEFFICIENTS / (2 * ROWS), rel=0.02)
    assert found.q[:-1] == pytest.approx(q[:-1], abs=0)
    assert found.information == pytest.approx(information(found.q))
    assert found.degrees[:-1] == pytest.approx(np.full(COEFFICIENTS, ROWS), rel=0.03)


def test_without_levels_nothing_changes():
    information = information_at(np.eye(4))
    q = np.zeros(5)
    found = small_sample(information, q, information(q), np.zeros(0, dtype=int))
    assert (found.degrees == MANY).all() and found.q is q
