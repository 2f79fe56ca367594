"""The tracking experiment: its numbers, its reference, and the score of a voyage."""

from __future__ import annotations

import math

import numpy as np
import pytest

from shipid.bridge.experiment.open_experiment import open_experiment
from shipid.bridge.experiment.tracks import track_experiment
from shipid.bridge.experiment.voyage_score import VoyageScore
from shipid.foundation.errors import UnknownNameError
from shipid.prediction.sailing.simulated_ship import SimulatedShip


def test_the_tracks_are_those_of_table_6_1():
    experiment = track_experiment()
    assert list(experiment.tracks) == ["T1", "T2", "T3", "T4", "T5", "T6"]
    for changes in experiment.tracks.values():
        assert sorted(changes) == ["C1", "C2", "C3", "C4", "C5"]
    assert [round(math.degrees(c)) for c in experiment.changes.values()] == [15, 30, 45, 75, 105]
    assert experiment.leg == pytest.approx(2.25 * 1852) and experiment.rudder_limit == pytest.approx(math.radians(10))
    assert experiment.current[0] == pytest.approx(2.5 * 1852 / 3600)
    # The sides alternate, so that a track stays within eight miles.
    for track in experiment.tracks:
        at = np.array([(leg.x, leg.y) for leg in experiment.legs(track)])
        assert np.hypot(*(at.max(axis=0) - at.min(axis=0))) < 8 * 1852 * math.sqrt(2)
    with pytest.raises(UnknownNameError, match="no scenario 'T7'"):
        experiment.legs("T7")


@pytest.fixture(scope="module")
def reference(pilot):
    return track_experiment().reference("T1", lambda: SimulatedShip(pilot))


def score_of(reference, places, **settings):
    score = VoyageScore(track_experiment(), "T1", "C", reference, **settings)
    for k, (x, y) in enumerate(places):
        score.add(2.0 * k, {"x": x, "y": y, "r": 0.01 * (-1) ** k})
    return score


def test_on_the_reference_nothing_is_off(reference):
    score = score_of(reference, reference.line)
    assert score.rms == pytest.approx(0, abs=1e-6) and score.done
    assert score.spread == pytest.approx(0.01, rel=1e-2)
    assert score.by_leg()[-1] == pytest.approx(0, abs=1e-6)


def test_beside_the_reference_the_distance_is_the_score(reference):
    along = np.arange(0, 3000, 50.0)
    score = score_of(reference, [(x, -40.0) for x in along])
    assert score.rms == pytest.approx(40.0) and not score.done
    assert "NOT SAILED TO ITS END" in score.text() and "40.0 m" in score.text()
    assert score.to_dict()["leg"] == 0 and score.to_dict()["of"] == 6


def test_samples_are_taken_every_two_seconds(reference):
    score = VoyageScore(track_experiment(), "T1", "A", reference)
    for k in range(100):
        score.add(0.4 * k, {"x": 0.0, "y": 0.0 if k % 5 else 30.0, "r": 0.0})
    assert score.rms == pytest.approx(30.0)


def test_the_end_is_told_once(reference):
    told = []
    score_of(reference, [*reference.line, *reference.line[-3:]], ended=told.append)
    assert len(told) == 1


def test_nothing_sailed_has_no_score(reference):
    score = VoyageScore(track_experiment(), "T1", "A", reference)
    assert score.rms is None and score.spread is None and "nothing was sailed" in score.text()


def test_who_sees_what(pilot):
    assert [open_experiment(pilot, "T2", c).predicts for c in "ABCD"] == [False, False, True, True]
    # Without a vector and a predictor the navigator does not know the drift angle at the beginning.
    assert open_experiment(pilot, "T2", "A").source.now["psi"] == 0.0
    assert open_experiment(pilot, "T2", "C").source.now["psi"] > 0.05
    with pytest.raises(UnknownNameError, match="A, B, C, D"):
        open_experiment(pilot, "T2", "E")
