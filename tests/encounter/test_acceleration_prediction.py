"""Prediction by an autoregressive acceleration: the closed form against the recursion it comes from."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.encounter.acceleration_prediction import acceleration_factor, predicted_positions
from shipid.encounter.errors import EncounterRequestError, TargetError


def recursion(points: np.ndarray, beta: float, steps: int) -> np.ndarray:
    """Equation 4, one step after the other."""
    known = [*points]
    for _ in range(steps):
        known.append((2 + beta) * known[-1] - (2 * beta + 1) * known[-2] + beta * known[-3])
    return np.array(known[len(points) :])


@pytest.mark.parametrize("count", [4, 6])
def test_the_closed_form_is_the_recursion(count):
    points = np.cumsum(np.random.default_rng(count).normal(5, 1, (count, 2)), axis=0)
    beta = float(acceleration_factor(points))
    np.testing.assert_allclose(predicted_positions(points, 5), recursion(points, beta, 5), rtol=1e-12)


def test_an_acceleration_that_dies_out_is_recovered():
    a = 0.8 ** np.arange(8)[:, None] * np.array([1.0, -2.0])
    points = np.cumsum(np.cumsum(a, axis=0) + 3.0, axis=0)
    assert acceleration_factor(points[:6]) == pytest.approx(0.8)
    np.testing.assert_allclose(predicted_positions(points[:6], 2), points[6:], rtol=1e-12)


def test_straight_courses_go_on():
    points = np.arange(6)[:, None] * np.array([3.0, 1.0])
    np.testing.assert_allclose(predicted_positions(points, 3), np.arange(6, 9)[:, None] * np.array([3.0, 1.0]))
    assert acceleration_factor(points) == 0


def test_many_targets_at_once_are_the_same_as_one_by_one():
    points = np.random.default_rng(1).normal(size=(3, 2, 5, 2))
    together = predicted_positions(points, 4, limit=1.0)
    assert together.shape == (3, 2, 4, 2)
    np.testing.assert_array_equal(together[2, 1], predicted_positions(points[2, 1], 4, limit=1.0))
    assert np.abs(acceleration_factor(points * 1.0, limit=0.3)).max() <= 0.3


def test_what_is_no_track_is_refused():
    with pytest.raises(TargetError, match="4 or more points"):
        acceleration_factor(np.zeros((3, 2)))
    with pytest.raises(TargetError, match="4 or more points"):
        acceleration_factor(np.zeros((6, 3)))
    with pytest.raises(TargetError, match="missing or not finite"):
        predicted_positions(np.full((6, 2), np.nan), 1)
    with pytest.raises(EncounterRequestError, match="0 steps ahead"):
        predicted_positions(np.zeros((6, 2)), 0)
