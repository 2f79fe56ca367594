"""The multiple-model tracker of targets: better than the last two scans, and consistent with one target alone."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.tracked_motion import TargetTracker


@pytest.fixture(scope="module")
def found():
    rng = np.random.default_rng(0)
    rate = np.zeros(80)
    rate[40:60] = np.deg2rad(0.5)
    course = np.cumsum(rate) * 5.0
    velocity = 6.0 * np.stack([np.cos(course), np.sin(course)], -1)
    truth = np.cumsum(5.0 * velocity, axis=0)
    seen = truth + rng.normal(0, 15, (4, 3, 80, 2))
    return truth, velocity, seen, TargetTracker(15.0).motions(seen, 5.0)


def test_it_is_nearer_to_the_truth_than_what_is_seen(found):
    truth, velocity, seen, motion = found
    late = slice(20, None)
    assert motion.shape == (4, 3, 80, 4)
    error = np.sqrt(np.mean(np.sum((motion[..., late, :2] - truth[late]) ** 2, -1)))
    assert error < 0.7 * np.sqrt(np.mean(np.sum((seen[..., late, :] - truth[late]) ** 2, -1)))
    assert np.sqrt(np.mean(np.sum((motion[..., late, 2:] - velocity[late]) ** 2, -1))) < 1.0


def test_nothing_looks_ahead_and_targets_are_apart(found):
    _, _, seen, motion = found
    alone = TargetTracker(15.0).motions(seen[1, 2, :50], 5.0)
    np.testing.assert_allclose(alone, motion[1, 2, :50], rtol=1e-12, atol=1e-9)


def test_settings_without_sense_are_refused():
    with pytest.raises(EncounterRequestError, match="above zero"):
        TargetTracker(0.0)
