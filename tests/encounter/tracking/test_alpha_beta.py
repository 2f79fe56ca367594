"""The fuzzy bank: gains of a fitted line, the rules of the table, and the lag in a turn."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.encounter.tracking.filters.alpha_beta import FuzzySettings, advance, chosen_memory, gains, rule_shares

SETTINGS = FuzzySettings()


def test_the_bank_fits_a_line_through_its_memory():
    """With growing gains the estimate after k updates is that of the straight line through all k + 1 positions."""
    chance = np.random.default_rng(0)
    z, tau = chance.normal(0, 5, (8, 1, 2)), 3.0
    x = np.zeros((1, SETTINGS.memories.size, 4))
    x[..., :2] = z[0]
    for k in range(1, 8):
        x, residual = advance(x, z[k], np.array([k]), np.array([tau]), SETTINGS)
        line = np.polyfit(tau * (np.arange(k + 1) - k), z[: k + 1, 0], 1)
        assert x[0, -1] == pytest.approx([*line[1], *line[0]])
        assert residual[0, -1] == pytest.approx(np.hypot(*(z[k, 0] - line[1])))


def test_the_gains_of_the_paper():
    alpha, beta = gains(np.array([1, 2, 10]))
    assert alpha == pytest.approx([1.0, 5 / 6, 42 / 132]) and beta == pytest.approx([1.0, 0.5, 6 / 132])


@pytest.mark.parametrize("good", range(10))
def test_each_rule_calls_for_its_memory(good):
    """The first filters good and the others bad: the memory of the last good one; all bad: the shortest."""
    residual = np.where(np.arange(9) < good, 0.0, 1e3)[None]
    memory = chosen_memory(rule_shares(residual, np.ones(1), SETTINGS), SETTINGS)
    assert memory == pytest.approx([max(good + 1, 2)])


def test_no_rule_leaves_the_shortest_memory():
    # Bad, then good: no rule of the table holds.
    residual = np.where(np.arange(9) < 4, 1e9, 0.0)[None]
    shares = rule_shares(residual, np.ones(1), SETTINGS)
    assert shares.sum() == pytest.approx(1.0) and chosen_memory(shares, SETTINGS) == pytest.approx([2.0])


@pytest.mark.parametrize(("speed", "printed"), [(10.0, 5), (20.0, 3)])
def test_the_memories_that_the_paper_prints(speed, printed):
    chance = np.random.default_rng(0)
    tau, sigma, radius = 3.0, 5.0, 300.0
    angle = speed / radius * tau * np.arange(60)
    path = radius * np.stack([np.sin(angle), 1 - np.cos(angle)], axis=1)
    z = path + sigma * chance.standard_normal((50, *path.shape))
    x = np.zeros((50, 9, 4))
    x[..., :2] = z[:, None, 0]
    memory = []
    for k in range(1, 60):
        x, residual = advance(x, z[:, k], np.full(50, k), np.full(50, tau), SETTINGS)
        memory.append(chosen_memory(rule_shares(residual, np.full(50, sigma), SETTINGS), SETTINGS).mean())
    assert round(float(np.mean(memory[20:]))) == printed
