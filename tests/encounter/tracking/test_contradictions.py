"""A track that its plots or the truth contradict says so, and is wider than its filter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.plots.plots import Scan, Sensor, make_plots
from shipid.encounter.plots.read_plots import Detections
from shipid.encounter.plots.ship_path import ShipPath
from shipid.encounter.tracking.sensor_bias import SensorBias
from shipid.encounter.tracking.track import track
from shipid.encounter.tracking.track_residuals import power_over_time

#: Two ships that cross, told to be 5 m sure.
SHIPS = [(-300.0, -200.0, 5.0, 0.0), (0.0, 300.0, 0.0, -5.0)]


def stated(found: Detections, **values: float) -> Detections:
    (sensor,) = found.plots.sensors
    return replace(found, plots=replace(found.plots, sensors=(replace(sensor, **values),)))


def kinds(found) -> set[str]:
    return {w.kind for w in found.warnings}


def test_plots_that_scatter_as_stated_widen_nothing(scene):
    found = track(scene(SHIPS, clutter=1.0))
    assert not kinds(found) & {"plots-scatter-more", "covariance-too-small"}
    assert np.mean([one.widening.mean() for one in found.tracks]) < 1.1


def test_plots_that_scatter_more_than_stated_are_tracked_all_the_same(scene):
    """With 4 m for 20 m every track breaks: plots are outside the gate of their own target."""
    found = track(stated(scene(SHIPS, noise=20.0, clutter=1.0), position_std=4.0), "cv")
    (said,) = [w for w in found.warnings if w.kind == "plots-scatter-more"]
    assert said.known["factor"] == pytest.approx(5.0, rel=0.15)
    assert found.plots.sensors[0].position_std == pytest.approx(20.0, rel=0.15)
    for ship in found.score.ships:
        assert ship.held > 0.85 and ship.tracks == 1 and ship.nees < 4.0


def test_clutter_alone_makes_no_sensor_worse(scene):
    found = track(scene([], clutter=3.0, scans=40), "cv")
    assert "plots-scatter-more" not in kinds(found)
    assert not found.tracks


def test_errors_that_last_widen_the_track():
    """Positions whose errors last for five scans, as those of a plot that was smoothed before it was sent."""
    chance, t = np.random.default_rng(1), np.arange(0.0, 600.0, 2.0)
    e = chance.standard_normal((t.size, 2))
    for k in range(1, t.size):
        e[k] = 0.8 * e[k - 1] + 0.6 * e[k]
    x, y = 5.0 * t, 2.0 * t
    plots = make_plots(t, x + 40 * e[:, 0], y + 40 * e[:, 1], sensors=(Sensor(position_std=40.0),))
    found = track(Detections("late", plots, truth=(ShipPath("ship", t, x, y),)), "cv")
    (one,) = found.tracks
    assert one.widening[t.size // 2 :].min() > 1.3
    assert "covariance-widened" in kinds(found)
    assert found.score.ships[0].nees < 4.0
    # The filter's own covariance would be that much smaller.
    assert np.mean(one.widening) * found.score.ships[0].nees > 5.0
    assert (found.to_frame()["widening"].to_numpy()[-1] > 1) and found.to_dict()["tracks"][0]["widening"] > 1


def test_bearings_that_are_off_together_are_told_beside_the_truth_and_cost_width_where_they_are_stated(scene):
    """The heading that bearings count from is 1.2 deg wrong: residuals do not show it, the truth does."""
    right = scene([(-600.0, 700.0, 5.0, 0.0)], clutter=0.0)
    turned = replace(
        right, truth=tuple(ShipPath(p.name, p.t, *(_turn(-1.2) @ np.stack([p.x, p.y]))) for p in right.truth)
    )
    (said,) = [w for w in track(turned, "cv").warnings if w.kind == "covariance-too-small"]
    assert said.serious and "Bearings are +1.2 ±" in said
    found = track(stated(turned, bearing_bias_std=float(np.deg2rad(1.2))), "cv")
    assert "covariance-too-small" not in kinds(found) and 0.2 < found.score.ships[0].nees < 4.0
    # To turn everything about own ship changes no distance from her.
    plain, wide = track(right, "cv").tracks[0], found.tracks[0]
    assert wide.approach.cpa_interval == pytest.approx(plain.approach.cpa_interval, abs=2.0)
    assert wide.P[-1, 0, 0] > 5 * plain.P[-1, 0, 0]


def _turn(degrees: float) -> np.ndarray:
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array([[c, -s], [s, c]])


def test_an_offset_of_the_heading_turns_position_and_velocity_about_a_sensor_that_moves():
    bias = SensorBias((Sensor(bearing_bias_std=0.01, bias_std=3.0), Sensor()))
    bias.begin(0, 1)
    P = np.eye(4)[None]
    for t in (0.0, 2.0):
        bias.learn(0, Scan(t, 0, np.zeros((1, 2)), np.zeros(1), np.array([3.0 * t, -t])), P, P)
    x = np.array([[400.0, 300.0, 2.0, 1.0]])
    own = np.array([6.0, -2.0, 3.0, -1.0])
    small = 1e-6
    moved = np.concatenate([_turn(np.rad2deg(small)) @ part for part in np.split(x[0] - own, 2)]) + own
    by_differences = (moved - x[0]) / small
    expected = 0.01**2 * np.outer(by_differences, by_differences) + np.diag([9.0, 9.0, 0.0, 0.0])
    assert bias.covariance(x)[0] == pytest.approx(expected, rel=1e-5, abs=1e-8)


def test_a_second_sensor_takes_its_share_of_a_track():
    bias = SensorBias((Sensor(bias_std=4.0), Sensor(bias_std=2.0)))
    bias.begin(0, 1)
    scan = Scan(0.0, 1, np.zeros((1, 2)), np.zeros(1), np.zeros(2))
    bias.learn(1, scan, np.eye(4)[None], 0.25 * np.eye(4)[None])
    assert bias.share[0] == pytest.approx([0.25, 0.75])
    assert bias.covariance(np.zeros((1, 4)))[0, 0, 0] == pytest.approx((0.25 * 4) ** 2 + (0.75 * 2) ** 2)


def test_the_power_over_time_of_residuals_that_last():
    n = np.full(3, 100.0)
    power = power_over_time(np.array([100.0, 100.0, 100.0]), np.array([0.0, 50.0, -50.0]), n)
    # Correlated by one half they count threefold; residuals that change sides are not taken as better than they are.
    assert power == pytest.approx([1.0, 3.0, 1.0])


def test_a_bias_below_zero_is_refused():
    with pytest.raises(EncounterRequestError, match="zero or more"):
        Sensor(bias_std=-1.0)


def test_what_may_lie_still_has_no_course_and_is_no_sure_mover(scene):
    """A buoy 1400 m off in plots of 40 m, beside a ship: the truth knows neither."""
    found = track(scene([(1000.0, 1000.0, 0.0, 0.0), (-900.0, -300.0, 7.0, 0.0)], noise=40.0, clutter=0.0), "cv")
    apart = found.plots.span[1] + 1e4
    away = ShipPath("far", np.array([0.0, apart]), np.full(2, 1e5), np.full(2, 1e5))
    judged = track(replace(scene([(1000.0, 1000.0, 0.0, 0.0), (-900.0, -300.0, 7.0, 0.0)], noise=40.0, clutter=0.0), truth=(away,), own=None), "cv")  # fmt: skip
    buoy, ship = sorted(found.tracks, key=lambda one: one.x[-1, 0], reverse=True)
    assert ship.moves[-1] and not buoy.moves[-1]
    assert ship.course_std[-1] < 0.3 < buoy.course_std[-1] <= np.pi / np.sqrt(3)
    lines = [line for line in found.text().splitlines() if line.split()[:1] in (["1"], ["2"])]
    assert sorted("none" in line for line in lines) == [False, True]
    assert judged.score.false_tracks == 2 and judged.score.false_movers == 1
    assert "of which 1 surely move" in judged.text()


def test_own_ship_whose_path_ends_a_little_before_the_last_scan_is_carried_on(scene):
    found = scene([(-400.0, 300.0, 4.0, 0.0)], clutter=0.0)
    last = found.plots.span[1]

    def until(end: float) -> Detections:
        keep = found.own.t <= end
        return replace(found, own=ShipPath("own", found.own.t[keep], found.own.x[keep], found.own.y[keep]))

    (one,) = track(until(last - 4.0), "cv").tracks
    assert one.approach.cpa == pytest.approx(300, abs=30)
    late = track(until(last - 40.0), "cv")
    assert late.tracks[0].approach is None
    assert any("no motion at the last scan" in w for w in late.warnings)


def test_a_short_log_whose_target_vanishes_makes_no_sensor_worse(scene):
    """Few residuals, for a target that is gone for a minute: the plots scatter as stated."""
    found = track(scene([(-300.0, -200.0, 5.0, 0.0)], clutter=0.0, scans=48, hidden=(10, 38)), "cv")
    assert "plots-scatter-more" not in kinds(found) and found.plots.sensors[0].position_std == 5.0
