"""A robust regression: where it ends, and how many reweightings that takes."""

import numpy as np
import pytest

from shipid.trials.doctor import robust_statistics
from shipid.trials.doctor.robust_statistics import regress


@pytest.fixture
def line():
    """Two coefficients, with noise and a tenth of wild rows."""
    rng = np.random.default_rng(8)
    design = np.column_stack([np.linspace(-1.0, 1.0, 200), np.ones(200)])
    target = design @ np.array([2.0, 0.5]) + 0.1 * rng.standard_normal(200)
    target[::10] += 3.0
    return design, target


def test_reweighting_ends_where_nothing_moves_any_more(line, monkeypatch):
    """Where it ends when it is left to go on for long, in a part of the rounds."""
    monkeypatch.setattr(robust_statistics, "_SETTLED", -1.0)
    after_all = regress(*line, rounds=200)
    monkeypatch.undo()
    solved, count = np.linalg.lstsq, []
    monkeypatch.setattr(np.linalg, "lstsq", lambda *a, **k: (count.append(1), solved(*a, **k))[1])
    found = regress(*line)
    assert found is not None and after_all is not None
    assert len(count) < 12
    # What is left to move is nothing beside what the coefficients are uncertain by.
    assert np.all(np.abs(found.value - after_all.value) <= 1e-4 * found.std)
    assert found.sigma == pytest.approx(after_all.sigma, rel=1e-4)
    # The wild rows, one in ten, do not turn it.
    assert np.abs(found.value - [2.0, 0.5]).max() < 4 * found.std.max()
