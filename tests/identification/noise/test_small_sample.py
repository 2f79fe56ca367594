"""Corrections for estimated levels, against linear regression with an unknown variance."""

import numpy as np
import pytest

from shipid.identification.noise.small_sample import MANY, small_sample

ROWS, COEFFICIENTS = 40, 4


def slopes_at(design, level):
    """Gradient and expected information of coefficients, at their best, and of a level at which the likelihood is largest."""

    def slopes(q):
        gradient, whole = np.zeros(q.size), np.zeros((q.size, q.size))
        gradient[-1] = len(design) * (np.exp(2 * (level - q[-1])) - 1)
        whole[:-1, :-1] = design.T @ design / np.exp(2 * q[-1])
        whole[-1, -1] = 2 * len(design)
        return gradient, whole

    return slopes


@pytest.mark.parametrize("rows", [ROWS, 10])
def test_the_level_moves_to_the_restricted_maximum_and_the_degrees_are_the_rows(rows):
    rng = np.random.default_rng(1)
    q = np.array([1.0, -2.0, 0.5, 0.1, np.log(0.3)])
    slopes = slopes_at(rng.standard_normal((rows, COEFFICIENTS)), q[-1])
    found = small_sample(slopes, q, np.array([COEFFICIENTS]))
    # The maximum likelihood divides the sum of squares by n; the restricted one by n - p.
    assert found.q[-1] - q[-1] == pytest.approx(-0.5 * np.log(1 - COEFFICIENTS / rows), rel=0.05)
    assert found.q[:-1] == pytest.approx(q[:-1], abs=0)
    assert found.information == pytest.approx(slopes(found.q)[1])
    assert not found.added.any()
    assert found.degrees[:-1] == pytest.approx(np.full(COEFFICIENTS, rows), rel=0.03)


def test_without_levels_nothing_changes():
    slopes = slopes_at(np.eye(4), 0.0)
    q = np.zeros(5)
    found = small_sample(slopes, q, np.zeros(0, dtype=int))
    assert (found.degrees == MANY).all() and found.q is q


def test_coefficients_that_move_with_the_levels_scatter_more():
    """The mean of two groups of different scatter, each estimated (Graybill and Deal 1959): variance told beside the true one."""
    rng, means, told, plain = np.random.default_rng(3), [], [], []
    for _ in range(400):
        groups = [scale * rng.standard_normal(count) for scale, count in ((1.0, 10), (1.5, 10))]

        def slopes(q, groups=groups):
            gradient, whole = np.zeros(3), np.zeros((3, 3))
            for k, group in enumerate(groups, start=1):
                weight, away = np.exp(-2 * q[k]), group - q[0]
                gradient += weight * away.sum() * np.eye(3)[0] + (weight * away @ away - group.size) * np.eye(3)[k]
                whole += np.diag(weight * group.size * np.eye(3)[0] + 2 * group.size * np.eye(3)[k])
            return gradient, whole

        q = np.array([0.0, 0.0, 0.0])
        for _ in range(60):
            gradient, information = slopes(q)
            q += np.linalg.solve(information, gradient)
        found = small_sample(slopes, q, np.array([1, 2]))
        means.append(q[0])
        plain.append(1 / found.information[0, 0])
        told.append(plain[-1] + found.added[0, 0])
    true = np.mean(np.square(means))
    assert np.mean(plain) < 0.9 * true and np.mean(told) == pytest.approx(true, rel=0.15)
