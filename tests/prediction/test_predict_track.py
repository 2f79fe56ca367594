"""A track from a model and her ship, without an autopilot and a situation of the user's own; and what an order passes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import UsageError
from shipid.prediction.routes.route import Waypoint


def test_a_model_and_its_ship_are_enough(pilot):
    """As in `shipid.simulate`: it was a TypeError."""
    found = shipid.predict_track("de-keizer", "soesterberg", rudder="10 deg", points=20)
    same = shipid.predict_track(pilot, {"psi": 0.0, "u": pilot.own_speed, "r": 0.0}, rudder="10 deg", points=20)
    np.testing.assert_allclose(found.track.x, same.track.x, rtol=1e-12)
    assert "from a straight course" in found.text()


def test_what_does_not_belong_together_is_told(pilot):
    route = shipid.Route("leg", (Waypoint((0.0, 0.0)), Waypoint((3000.0, 0.0))), geographic=False)
    for verb, more in ((shipid.predict_track, ()), (shipid.predict_route, (route,))):
        with pytest.raises(UsageError, match=r"give design_autopilot\(model, ship\) in its place"):
            verb("de-keizer", {"psi": 0.0, "u": 9.0}, *more)
        with pytest.raises(UsageError, match="an autopilot has its ship"):
            verb(pilot, "soesterberg", *more)


def test_more_rudder_than_the_ship_has_is_told_once(pilot):
    told = shipid.predict_track(
        pilot, {"psi": 0.0, "u": 9.5}, rudder="40 deg", rudder_limit="40 deg", points=20
    ).warnings
    assert [n.kind for n in told].count("beyond-the-rudder") == 1


def test_a_long_track_has_its_stages_where_those_of_a_short_one_are(pilot):
    """Of 5000 ship lengths each of 600 steps was eight long, and 10 degrees were told to be turned at 200 s in place of 36."""
    usual, long = (
        shipid.predict_track(pilot, {"psi": 0.0, "u": 9.5}, heading="60 deg", band="none", horizon=horizon)
        for horizon in (20, 500)
    )
    for one, other in zip(usual.stages[:3], long.stages[:3]):
        assert other.t == pytest.approx(one.t, abs=2.0) and other.what == one.what


def test_degrees_turned_count_to_the_side_of_the_order(pilot):
    """A ship that still turns to port goes on to port for a while: 10 degrees to port are no 10 degrees of a turn to starboard."""
    start = {"psi": 0.0, "u": 9.5, "r": np.deg2rad(-1.2)}
    found = shipid.predict_track(pilot, start, heading="60 deg", band="none")
    assert np.rad2deg(found.track.psi).min() < -11
    first = found.stages[0]
    assert first.what == "turned 10 deg" and np.rad2deg(first.heading) == pytest.approx(10, abs=1.5)
    assert first.band_words == "not known"


def test_a_band_of_less_than_a_metre_is_not_none(pilot):
    stage = shipid.predict_track(pilot, {"psi": 0.0, "u": 9.5}, heading="60 deg", points=20).stages[0]
    assert [replace(stage, half_width=w).band_words for w in (0.2, 0.6, 12.4)] == ["below ± 1", "± 1", "± 12"]
