"""A band is widened by what the predictor itself could see: how far off its earlier predictions were."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from shipid.foundation.errors import UsageError
from shipid.parameters.parameter_set import Value
from shipid.prediction.following.past_predictions import past_errors, situation_with_past
from shipid.prediction.predict_track import predict_track
from shipid.prediction.sailing.sail import sail
from shipid.prediction.situations.past import APART, LOOKED_AT, errors_of, told_of
from shipid.prediction.situations.trial_situation import known_before
from shipid.prediction.tracks.track_predictor import TrackPredictor

NOISE = {"psi": "0.2 deg", "r": "0.02 deg/s", "u": "0.1 m/s", "x": "3 m", "y": "3 m"}


def believing(pilot, **values):
    """The autopilot of a ship that is taken to have other coefficients."""
    changed = {n: Value(n, v, "1", "assumed") for n, v in values.items()}
    ship = pilot.ship
    sections = {**ship.sections, "de-keizer": {**ship.sections["de-keizer"], **changed}}
    return dataclasses.replace(pilot, ships=(dataclasses.replace(ship, sections=sections),))


@pytest.fixture(scope="module")
def trial(pilot):
    courses = [(60.0 + 120 * k, h) for k, h in enumerate((0.5, -0.4, 0.6, -0.5, 0.4, -0.6, 0.5))]
    return sail(pilot, courses, duration=900.0, sampling=1.0, noise=NOISE, seed=3)


def test_the_factor_is_that_of_the_mean_square():
    """Ten predictions, each three standard deviations off across the track at the two distances they have reached."""
    off = np.full((10, LOOKED_AT.size), np.nan)
    off[:, :3] = 3.0
    found = errors_of(off, np.where(np.isnan(off), np.nan, 0.5))
    assert found.s_star.tolist() == LOOKED_AT[:3].tolist() and found.count == 10
    free = 10 * np.minimum(1.0, APART / LOOKED_AT[:3])
    assert found.track == pytest.approx(np.sqrt((4 + 9 * free) / (4 + free)))
    # A band that was wide enough is not made narrower.
    assert found.heading.tolist() == [1.0, 1.0, 1.0]
    wider, turned = found.at(np.array([0.0, 0.75, 30.0]))
    assert wider == pytest.approx([found.track[0], found.track[:2].mean(), found.track[2]])
    assert turned.tolist() == [1.0, 1.0, 1.0]


def test_nothing_seen_widens_nothing():
    found = errors_of(np.full((1, LOOKED_AT.size), np.nan), np.full((1, LOOKED_AT.size), np.nan))
    assert found.count == 0 and not told_of(found)
    assert [f.tolist() for f in found.at(np.array([1.0, 2.0]))] == [[1.0, 1.0], [1.0, 1.0]]


def test_a_right_model_keeps_its_band(pilot, trial):
    known, told = situation_with_past(pilot, trial, 600.0)
    assert known.past.count >= 8
    assert max(known.past.track.max(), known.past.heading.max()) < 1.1
    assert not [n for n in told if n.kind == "band-widened"]


def test_a_wrong_model_is_seen_in_its_past_and_told(pilot, trial):
    wrong = believing(pilot, K=0.8)
    known, told = situation_with_past(wrong, trial, 600.0)
    (notice,) = [n for n in told if n.kind == "band-widened"]
    widest = max(known.past.track.max(), known.past.heading.max())
    assert widest > 1.5 and notice.known["factor"] == pytest.approx(widest)
    assert f"up to {widest:.2g} times as wide" in notice
    narrow = predict_track(wrong, dataclasses.replace(known, past=None), rudder=0.1, horizon=4).track
    wide = predict_track(wrong, known, rudder=0.1, horizon=4).track
    track, heading = known.past.at(wide.s_star)
    assert wide.half_width[1:] == pytest.approx(narrow.half_width[1:] * track[1:])
    assert wide.std["psi"][1:] == pytest.approx(narrow.std["psi"][1:] * heading[1:])
    assert wide.std["t"] == pytest.approx(narrow.std["t"])
    drawn = predict_track(wrong, known, rudder=0.1, horizon=4, band="samples").track
    assert drawn.half_width[-1] == pytest.approx(wide.half_width[-1], rel=0.25)


def test_which_band_is_widened_is_told():
    """The band of the track is printed, that of the heading is not: one that is as wide as before was told to be 25 times as wide."""
    right, wrong = np.ones((30, LOOKED_AT.size)), np.full((30, LOOKED_AT.size), 8.0)
    (of_heading,) = told_of(errors_of(right, wrong))
    assert "allow: the band of the heading is up to 7" in of_heading and "the band is" not in of_heading
    (of_both,) = told_of(errors_of(wrong, wrong))
    assert "the band is up to 7.5 times and the band of the heading is up to 7.5 times as wide" in of_both


def test_only_the_rudder_that_was_laid_is_replayed(pilot, trial):
    """With another rudder than the one that was laid, the past predictions miss."""
    _, _, past = known_before(pilot.model, pilot.ship, trial, 600.0)
    assert past_errors(pilot, past).track.max() < 1.1
    mirrored = dataclasses.replace(past, delta=-past.delta)
    assert past_errors(pilot, mirrored).track.max() > 2.0


def test_a_past_prediction_that_is_lost_is_told_and_widens_the_band(pilot, trial, monkeypatch):
    _, _, past = known_before(pilot.model, pilot.ship, trial, 600.0)
    whole = TrackPredictor.along
    begins = {s.t for s in past.situations[2:4]}

    def along(self, situations, rudders, horizon):
        if any(s.t == past.situations[0].t for s in situations):
            raise UsageError("this one cannot be made")
        tracks = whole(self, situations, rudders, horizon)
        short = [s.t in begins for s in situations]
        return [dataclasses.replace(t.part(0, 8), ended="it runs away") if cut else t for t, cut in zip(tracks, short)]

    monkeypatch.setattr(TrackPredictor, "along", along)
    found = past_errors(pilot, past)
    assert found.lost == 3 and found.count == len(past.situations)
    assert found.track.max() > 1.5 and found.heading.max() > 1.5
    lost, widened = told_of(found)
    assert lost.kind == "past-predictions-lost" and widened.kind == "band-widened"
    assert f"3 of the last {found.count} predictions of her ran away or could not be made" in lost
