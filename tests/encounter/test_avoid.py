"""An avoiding course along tracks that own ship can sail, against a fine simulation of the same meeting."""

from __future__ import annotations

import json

import numpy as np
import pytest

import shipid
from shipid.encounter.avoid import avoid
from shipid.encounter.avoidance import OtherShip
from shipid.encounter.errors import EncounterRequestError, TargetError
from shipid.encounter.ship_domain import circle
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import TrackPredictor

SPEED = 9.5


@pytest.fixture(scope="module")
def predictor():
    return TrackPredictor(shipid.design_autopilot("de-keizer", "soesterberg"))


@pytest.fixture
def own():
    return Situation({"x": 0.0, "y": 0.0, "psi": 0.0, "u": SPEED})


def coming(distance: float, aside: float = 0.0, **more) -> OtherShip:
    """A ship head on."""
    return OtherShip("Alpha", np.array([distance, aside, -6.0, 0.0]), **more)


def test_no_ship_and_a_ship_far_off_ask_for_no_alteration(predictor, own):
    assert avoid(predictor, own, [], circle(500.0)).alteration == 0
    far = OtherShip("Far", np.array([0.0, 20_000.0, 5.0, 0.0]))
    found = avoid(predictor, own, [far], circle(500.0))
    assert found.clear and found.alteration == 0 and found.heading == 0


def test_a_ship_head_on_is_passed_to_starboard_outside_her_domain(predictor, own):
    found = avoid(predictor, own, [coming(8000.0)], circle(600.0))
    assert found.clear and found.alteration > 0
    # The distance of a simulation on the track's own nodes, a hundred times as fine.
    t = found.track.t
    fine = np.linspace(0, 1200, 120_001)
    apart = np.hypot(8000 - 6 * fine - np.interp(fine, t, found.track.x), -np.interp(fine, t, found.track.y))
    assert found.passings[0].distance == pytest.approx(apart.min(), rel=1e-3)
    assert found.passings[0].t == pytest.approx(fine[apart.argmin()], abs=2.0)
    assert found.passings[0].share == pytest.approx(apart.min() / 600, rel=1e-3)
    smaller = [h for h in found.tried if 0 <= h < found.heading - 1e-9]
    assert all(found.tried[h] < 1 for h in smaller), "it is the smallest alteration"


def test_a_ship_with_inertia_needs_a_larger_alteration_than_one_without(predictor, own):
    """Near by, the turn itself takes room: the course that a ship turned at once would keep clear on does not."""
    near = [coming(2600.0)]
    found = avoid(predictor, own, near, circle(600.0), step="1 deg")
    at_once = next(
        a for a in np.deg2rad(np.arange(0, 91))
        if _share_at_once(a, near[0].motion, 600.0) >= 1
    )  # fmt: skip
    assert found.clear and found.alteration > at_once + np.deg2rad(1.5)
    assert found.at_once > found.share


def _share_at_once(heading: float, motion: np.ndarray, radius: float) -> float:
    t = np.linspace(0, 1200, 24_001)
    x, y = (
        motion[0] + t * motion[2] - SPEED * np.cos(heading) * t,
        motion[1] + t * motion[3] - SPEED * np.sin(heading) * t,
    )
    return float(np.hypot(x, y).min() / radius)


def test_where_nothing_keeps_clear_it_says_so(predictor, own):
    found = avoid(predictor, own, [coming(900.0)], circle(800.0))
    assert not found.clear
    (warning,) = found.warnings
    assert warning.serious and warning.kind == "no-clear-course" and "Alpha" in warning
    assert "NOT CLEAR" in found.text()
    assert found.share == pytest.approx(max(found.tried.values()))


def test_shares_that_differ_by_nothing_do_not_decide_on_a_side(predictor, own):
    """Head on and too near for any course: rounding sent her to port."""
    found = avoid(predictor, own, [coming(700.0)], circle(600.0))
    assert not found.clear and found.share < 0.1 and found.alteration >= 0


def test_a_ship_that_may_pass_inside_her_domain_is_not_surely_clear(predictor, own):
    def said(speed_std: float) -> list[str]:
        spread = np.diag([25.0**2, 25.0**2, speed_std**2, speed_std**2])
        found = avoid(predictor, own, [coming(8000.0, covariance=spread)], circle(600.0))
        assert found.clear
        return [w for w in found.warnings if w.kind == "clear-not-sure"]

    assert not said(0.1)
    (warning,) = said(1.0)
    assert "95 % interval of her distance Alpha may pass inside" in warning


def test_starboard_only(predictor, own):
    """A ship a little to starboard is passed by a smaller alteration to port."""
    others = [coming(8000.0, 300.0)]
    assert avoid(predictor, own, others, circle(600.0)).alteration < 0
    assert avoid(predictor, own, others, circle(600.0), starboard_only=True).alteration > 0


def test_the_spread_of_both_ships_is_in_the_distance(predictor, own):
    sure = avoid(predictor, own, [coming(8000.0)], circle(600.0))
    assert sure.passings[0].std is None
    unsure = avoid(
        predictor, own, [coming(8000.0, covariance=np.diag([25.0**2, 25.0**2, 0.1**2, 0.1**2]))], circle(600.0)
    )
    t = unsure.passings[0].t
    # All of it across the line of sight is the same in both directions.
    assert unsure.passings[0].std == pytest.approx(np.hypot(25.0, 0.1 * t), rel=1e-6)
    known = Situation(dict(own.values), ("x", "y"), np.diag([40.0**2, 40.0**2]))
    both = avoid(
        predictor, known, [coming(8000.0, covariance=np.diag([25.0**2, 25.0**2, 0.1**2, 0.1**2]))], circle(600.0)
    )
    assert both.passings[0].std > np.hypot(unsure.passings[0].std, 25.0)


def test_the_result_is_plain(predictor, own):
    told = json.loads(json.dumps(avoid(predictor, own, [coming(8000.0)], circle(600.0)).to_dict(), allow_nan=False))
    assert told["clear"] and told["passings"]["Alpha"]["distance"]["unit"] == "m"


def test_bad_requests(predictor, own):
    with pytest.raises(EncounterRequestError, match="give a step above zero"):
        avoid(predictor, own, [], circle(600.0), step=0.0)
    with pytest.raises(EncounterRequestError, match="a time above zero"):
        avoid(predictor, own, [], circle(600.0), ahead=-1.0)
    with pytest.raises(TargetError, match="the motion of Alpha is not known"):
        coming(np.nan)
    with pytest.raises(TargetError, match="4 rows and 4 columns"):
        coming(100.0, covariance=np.eye(2))


def test_a_covariance_below_zero_and_too_many_alterations_are_refused(predictor, own):
    with pytest.raises(TargetError, match="a variance below zero"):
        coming(3000.0, covariance=-np.eye(4))
    assert coming(3000.0, covariance=np.zeros((4, 4))).covariance is not None
    with pytest.raises(EncounterRequestError, match="are 900000 to a side, and at most 720 are tried"):
        avoid(predictor, own, [coming(3000.0)], circle(500.0), step="0.0001 deg")


def test_one_other_ship_needs_no_list(predictor, own):
    one, several = (avoid(predictor, own, o, circle(500.0)).alteration for o in (coming(3000.0), [coming(3000.0)]))
    assert one == several
