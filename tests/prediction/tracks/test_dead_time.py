"""The track of a ship whose rudder acts late: as she sails it, and begun with the rudder where it stands."""

import numpy as np
import pytest

import shipid
from shipid.parameters.replaced import with_values
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import TrackPredictor

LATE, LENGTH = 12.0, 226.0


@pytest.fixture(scope="module")
def ship():
    return with_values(shipid.find_ship("soesterberg"), {"delay": f"{LATE} s"}, [shipid.find_model("de-keizer-delay")])


@pytest.fixture(scope="module")
def pilot(ship):
    return shipid.design_autopilot("de-keizer-delay", ship)


def test_a_track_is_the_one_she_sails(ship, pilot) -> None:
    """Against a turning circle that is simulated on a clock."""
    sailed = shipid.simulate("de-keizer-delay", ship, "turn:20", sampling="0.1 s")
    at = int(np.argmax(np.abs(sailed["delta"]) > 1e-6)) - 1
    begin = float(sailed["t"][at])
    start = Situation({n: float(sailed[n][at]) for n in ("psi", "u", "r")})
    track = TrackPredictor(pilot).predict(start, rudder="20 deg", horizon=8, points=800)
    x, y = (np.interp(track.t, sailed["t"] - begin, sailed[n] - sailed[n][at]) for n in ("x", "y"))
    assert np.hypot(track.x - x, track.y - y).max() < 0.001 * LENGTH
    prompt = TrackPredictor(shipid.design_autopilot("de-keizer", "soesterberg")).predict(
        start, rudder="20 deg", horizon=8, points=800
    )
    assert np.hypot(prompt.x - x, prompt.y - y).max() > 0.2 * LENGTH
    # What is shown of the rudder is where it is, and not the one that acts.
    assert track.delta.max() == pytest.approx(np.deg2rad(20.0), rel=1e-3)
    assert track.delta.min() >= 0.0


def test_a_rudder_that_stands_goes_on_acting(pilot) -> None:
    standing = Situation({"psi": 0.0, "u": 9.5, "r": 0.005, "delta": np.deg2rad(20.0)})
    track = TrackPredictor(pilot).predict(standing, rudder="20 deg", horizon=1)
    assert np.all(np.diff(track.r) > 0)
    assert track.delta == pytest.approx(np.full(track.t.size, np.deg2rad(20.0)))


def test_the_model_of_first_order_is_late_as_well(pilot) -> None:
    predictor = TrackPredictor(pilot, model="first-order")
    track = predictor.predict(Situation({"psi": 0.0, "u": 9.5}), rudder="10 deg", horizon=3)
    turns = track.t[np.argmax(track.r > 0.1 * track.r.max())]
    prompt = TrackPredictor(shipid.design_autopilot("de-keizer", "soesterberg"), model="first-order").predict(
        Situation({"psi": 0.0, "u": 9.5}), rudder="10 deg", horizon=3
    )
    assert turns - prompt.t[np.argmax(prompt.r > 0.1 * prompt.r.max())] == pytest.approx(LATE, abs=2.0)
