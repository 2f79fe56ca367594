"""The multiple-model tracker of targets: better than the last two scans, and consistent with one target alone."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.tracked_motion import TargetTracker, along_arc


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
    assert motion.shape == (4, 3, 80, 5)
    error = np.sqrt(np.mean(np.sum((motion[..., late, :2] - truth[late]) ** 2, -1)))
    assert error < 0.7 * np.sqrt(np.mean(np.sum((seen[..., late, :] - truth[late]) ** 2, -1)))
    assert np.sqrt(np.mean(np.sum((motion[..., late, 2:4] - velocity[late]) ** 2, -1))) < 1.0


def test_nothing_looks_ahead_and_targets_are_apart(found):
    _, _, seen, motion = found
    alone = TargetTracker(15.0).motions(seen[1, 2, :50], 5.0)
    np.testing.assert_allclose(alone, motion[1, 2, :50], rtol=1e-12, atol=1e-9)


def test_the_rate_of_turn_is_found(found):
    """In the middle of a turn of 0.5 deg/s."""
    assert np.rad2deg(np.mean(found[3][..., 58, 4])) == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("rate", [0.0, 1e-9, 0.02, -0.02])
def test_an_arc_is_the_motion_integrated(rate):
    t = np.linspace(0, 60, 60_001)
    course = 0.3 + rate * t
    way = np.cumsum(6 * np.stack([np.cos(course), np.sin(course)], -1)[:-1], axis=0) * 1e-3
    motion = np.array([100.0, -50.0, 6 * np.cos(0.3), 6 * np.sin(0.3), rate])
    np.testing.assert_allclose(
        along_arc(motion, np.array([0.0, 60.0])), motion[:2] + np.array([[0, 0], way[-1]]), atol=0.01
    )


def test_settings_without_sense_are_refused():
    with pytest.raises(EncounterRequestError, match="above zero"):
        TargetTracker(0.0)
