"""CPA and TCPA: closed forms, the limits of straight courses, and the spread against a Monte Carlo of our own."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipid.encounter.closest_approach import closest_approach, nearest_distance
from shipid.encounter.errors import EncounterRequestError, TargetError

finite = st.floats(-5000, 5000)
speed = st.floats(-20, 20)


def test_crossing_ships():
    """A target 1000 m north that goes east at 5 m/s, own ship north at 5 m/s: 45 degrees, 707 m, in 100 s."""
    met = closest_approach((1000, 0, 0, 5), (0, 0, 5, 0))
    assert met.cpa == pytest.approx(1000 / np.sqrt(2))
    assert met.tcpa == pytest.approx(100)
    assert met.miss == pytest.approx((500, 500))
    assert met.motion == "closing"
    assert met.nearest == pytest.approx(met.cpa)
    assert met.cpa_std is met.tcpa_interval is met.chance is None


def test_a_collision_course_has_no_distance():
    met = closest_approach((1000, 1000, 0, -5), (0, 0, 5, 0), covariance=np.diag([1, 1, 0.01, 0.01]), domain=100.0)
    assert met.cpa == pytest.approx(0, abs=1e-9)
    assert met.tcpa == pytest.approx(200)
    assert met.cpa_interval[0] < 2 and met.chance == pytest.approx(1.0, abs=0.01)


def test_past_the_closest_approach_the_range_is_the_nearest():
    met = closest_approach((-300, 400, -4, 0), domain=450.0, covariance=np.diag([1, 1, 1e-4, 1e-4]))
    assert (met.motion, met.tcpa, met.cpa) == ("opening", pytest.approx(-75), pytest.approx(400))
    assert met.nearest == pytest.approx(500)
    assert met.chance == 0.0


def test_parallel_courses_with_the_faster_ship_behind():
    met = closest_approach((1000, 200, 5, 0), (0, 0, 8, 0))
    assert (met.cpa, met.tcpa) == (pytest.approx(200), pytest.approx(1000 / 3))


def test_no_relative_motion_has_no_time():
    c, s = np.cos(0.5236), np.sin(0.5236)
    met = closest_approach((300, 400, 5.1 * c, 5.1 * s), (0, 0, 5.1 * c, 5.1 * s + 1e-12))
    assert met.motion == "steady" and np.isnan(met.tcpa)
    assert (met.cpa, met.nearest) == (pytest.approx(500), pytest.approx(500))
    assert met.miss == pytest.approx((300, 400))
    assert json.loads(json.dumps(met.to_dict(), allow_nan=False))["tcpa"] is None


def test_no_relative_motion_that_is_known_for_sure_has_no_interval_of_time():
    met = closest_approach((300, 400, 3, 0), (0, 0, 3, 0), covariance=np.diag([4, 4, 0, 0]))
    assert met.tcpa_interval is None and met.tcpa_std is None
    assert met.cpa_interval == pytest.approx((500 - 3.92, 500 + 3.92), abs=0.2)


def test_relative_speed_that_is_hardly_known_gives_no_standard_deviation_but_an_interval():
    """One knot of error on one knot of relative speed: the closest approach may be anything up to the range."""
    met = closest_approach((2000, 0, -0.5, 0), covariance=np.diag([100, 100, 0.25, 0.25]), domain=300.0)
    assert met.cpa_std is None and met.tcpa_std is None
    low, high = met.cpa_interval
    assert low < 200 and high > 1800
    assert 0 < met.chance < 0.5


def test_the_horizon_bounds_what_is_near():
    assert closest_approach((1000, 0, -2, 0), horizon=100.0).nearest == pytest.approx(800)


@pytest.mark.parametrize("own_share", [0.0, 0.4])
def test_the_spread_is_that_of_a_monte_carlo(own_share):
    rng = np.random.default_rng(5)
    target, own = np.array([3000.0, 1500.0, -4.0, -1.0]), np.array([0.0, 0.0, 5.0, 1.0])
    a = rng.normal(size=(4, 4))
    covariance = np.diag([30, 30, 0.2, 0.2]) @ (a @ a.T / 4 + 0.2 * np.eye(4)) @ np.diag([30, 30, 0.2, 0.2])
    met = closest_approach(
        target, own, covariance=(1 - own_share) * covariance, own_covariance=own_share * covariance, domain=400.0
    )
    drawn = rng.multivariate_normal(target - own, covariance, 200_000)
    p, v = drawn[:, :2], drawn[:, 2:]
    t = -(p * v).sum(1) / (v * v).sum(1)
    miss = np.hypot(*(p + t[:, None] * v).T)
    assert met.tcpa_std == pytest.approx(t.std(), rel=0.03)
    assert met.cpa_std == pytest.approx(miss.std(), rel=0.03)
    # 8192 draws: a quantile of 2.5 % has a standard error of about 0.03 standard deviations.
    assert met.cpa_interval == pytest.approx(np.quantile(miss, (0.025, 0.975)), abs=0.1 * miss.std())
    assert met.tcpa_interval == pytest.approx(np.quantile(t, (0.025, 0.975)), abs=0.1 * t.std())
    assert met.chance == pytest.approx(np.mean(miss < 400), abs=0.02)


@settings(max_examples=200, deadline=None)
@given(finite, finite, speed, speed)
def test_no_instant_is_nearer_than_the_nearest(x, y, vx, vy):
    near = nearest_distance(np.array([x, y, vx, vy]), 500.0)
    t = np.linspace(0, 500, 401)
    sailed = np.hypot(x + t * vx, y + t * vy)
    # On 401 instants the smallest distance is missed by at most half a step of the relative motion.
    assert sailed.min() >= near - 1e-6
    assert sailed.min() <= near + np.hypot(vx, vy) * 0.63 + 1e-6


def test_what_is_no_motion_is_refused():
    with pytest.raises(TargetError, match=r"motion of the target .* four finite numbers"):
        closest_approach((1, 2, np.nan, 0))
    with pytest.raises(TargetError, match="motion of own ship"):
        closest_approach((1, 2, 3, 4), (1, 2))
    with pytest.raises(TargetError, match="4 rows and 4 columns"):
        closest_approach((1, 2, 3, 4), covariance=np.eye(3))
    with pytest.raises(TargetError, match="variance below zero"):
        closest_approach((1, 2, 3, 4), covariance=np.diag([1, 1, 1, -1]))
    with pytest.raises(TargetError, match="own ship is not symmetric"):
        closest_approach((1, 2, 3, 4), own_covariance=np.eye(4) + np.eye(4, k=1) * 0.5)
    with pytest.raises(EncounterRequestError, match="the domain is 0"):
        closest_approach((1, 2, 3, 4), domain=0.0)
    with pytest.raises(EncounterRequestError, match="the horizon is -1"):
        closest_approach((1, 2, 3, 4), horizon=-1.0)


def test_what_may_lie_still_has_no_closest_approach_but_an_interval():
    """A buoy at 2.8 km that seems to drift by 0.2 m/s: its mean motion would lead to 68 m, outside the 95 % interval."""
    met = closest_approach([2000.0, 2000.0, 0.14, 0.14], covariance=np.diag([80.0, 80.0, 0.6, 0.6]))
    assert met.motion == "unsure" and met.miss is None and np.isnan([met.cpa, met.tcpa, met.nearest]).all()
    assert met.range == pytest.approx(2828, abs=1) and met.cpa_interval[0] < 500 < 2500 < met.cpa_interval[1]
    plain = json.loads(json.dumps(met.to_dict(), allow_nan=False))
    assert plain["cpa"] is None and plain["miss"] is None and "closest approach, unsure" in met.text()
    assert closest_approach([2000.0, 2000.0, 3.0, 0.0], covariance=np.diag([80.0, 80.0, 0.6, 0.6])).motion == "opening"
