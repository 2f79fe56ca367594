"""Association: marginals beside every hypothesis counted, and the nearest assignment beside every permutation."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from shipid.encounter.tracking.association import joint_probabilities, nearest_assignment


def counted(weights: np.ndarray) -> np.ndarray:
    """Marginals by going through all joint hypotheses."""
    n, m = weights.shape
    found = np.zeros((n, m + 1))
    for choice in itertools.product(range(m + 1), repeat=n):
        taken = [c for c in choice if c]
        if len(set(taken)) < len(taken):
            continue
        weight = np.prod([weights[i, c - 1] if c else 1.0 for i, c in enumerate(choice)])
        found[np.arange(n), choice] += weight
    return found / found.sum(axis=1, keepdims=True)


@pytest.mark.parametrize("seed", range(5))
def test_without_a_loop_the_marginals_are_exact(seed: int) -> None:
    weights = np.exp(np.random.default_rng(seed).normal(0, 3, (3, 3)))
    weights[0, 2] = weights[2, 0] = weights[1, 0] = 0.0  # a chain: no two targets share two plots
    weights[2, 1] = 0.0
    assert joint_probabilities(weights) == pytest.approx(counted(weights), abs=1e-6)


@pytest.mark.parametrize("seed", range(10))
def test_with_loops_they_are_close(seed: int) -> None:
    weights = np.exp(np.random.default_rng(seed).normal(0, 2, (3, 4)))
    found = joint_probabilities(weights)
    assert found.sum(axis=1) == pytest.approx(1.0)
    assert np.abs(found - counted(weights)).max() < 0.12
    assert (found[:, 1:].sum(axis=0) < 1 + 1e-6).all()


def test_two_targets_of_one_plot_share_it() -> None:
    found = joint_probabilities(np.array([[1e3], [1e3]]))
    assert found[:, 1] == pytest.approx([0.5, 0.5], abs=0.01)


@pytest.mark.parametrize("seed", range(10))
def test_the_nearest_assignment_is_the_most_probable_hypothesis(seed: int) -> None:
    weights = np.exp(np.random.default_rng(seed).normal(0, 2, (3, 3)))
    found = nearest_assignment(weights)
    assert (
        set(np.unique(found)) <= {0.0, 1.0} and (found.sum(axis=1) == 1).all() and (found[:, 1:].sum(axis=0) <= 1).all()
    )
    ours = np.prod(weights[found[:, 1:] > 0])
    best = max(
        np.prod([weights[i, c - 1] for i, c in enumerate(choice) if c])
        for choice in itertools.product(range(4), repeat=3)
        if len({c for c in choice if c}) == sum(c > 0 for c in choice)
    )
    assert ours == pytest.approx(best)


def test_nothing_to_associate() -> None:
    for association in (joint_probabilities, nearest_assignment):
        assert association(np.zeros((0, 3))).shape == (0, 4)
        assert association(np.zeros((2, 0))).tolist() == [[1.0], [1.0]]
        assert association(np.zeros((1, 2))).tolist() == [[1.0, 0.0, 0.0]]
