"""Tracks of simulated scans: the truth is recovered out of clutter, and a track that is not sure says that it is lost."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.plots.plots import Sensor, make_plots
from shipid.encounter.plots.read_plots import Detections
from shipid.encounter.tracking.filters.alpha_beta import FuzzySettings
from shipid.encounter.tracking.filters.trackers import NAMES
from shipid.encounter.tracking.track import track
from shipid.encounter.tracking.tracker import TrackerSettings
from shipid.foundation.errors import UnknownNameError

CROSSING = [(-300.0, -200.0, 5.0, 0.0), (0.0, 300.0, 0.0, -5.0)]


@pytest.mark.parametrize("name", NAMES)
def test_two_targets_are_found_in_clutter(scene, name):
    found = track(scene(CROSSING), name)
    assert found.score is not None
    for ship in found.score.ships:
        # Some scans go before a track is confirmed, and the bank remembers ten scans at most.
        assert ship.held > 0.85 and ship.rmse[0] < {"alpha-beta": 9.0}.get(name, 5.0), ship
    if name in ("imm", "cv"):
        assert found.score.false_tracks == 0
        assert [o.status for o in found.tracks] == ["held", "held"]
        assert 1.0 < np.mean([s.nees for s in found.score.ships]) < 3.5
    json.dumps(found.to_dict(), allow_nan=False)
    assert np.isfinite(found.to_frame().to_numpy(float)).all()


@pytest.mark.parametrize("name", NAMES)
def test_every_tracker_knows_the_course_of_a_ship_on_a_straight_leg(scene, name):
    """Plots err by 10 m: at 7 m/s the course is known to some 5 degrees, and no ship steers 40 off."""
    off = []
    for seed in range(3):
        found = track(scene([(-900.0, 400.0, 7.0, 0.0)], seed=seed, clutter=0.0, noise=10.0, scans=100), name)
        one = max(found.tracks, key=lambda track: track.t.size)
        off.append(np.rad2deg(np.angle(np.exp(1j * one.course[one.t > one.t[0] + 30]))))
    errors = np.concatenate(off)
    assert np.sqrt(np.mean(errors**2)) < 11 and np.abs(errors).max() < 35


def test_ten_scenes_hold_their_targets_and_invent_none(scene):
    scores = [track(scene(CROSSING, seed=seed, clutter=6.0)).score for seed in range(10)]
    ships = [ship for score in scores for ship in score.ships]
    assert np.mean([s.held for s in ships]) > 0.92
    assert sum(score.false_tracks for score in scores) <= 2  # in 20 minutes
    assert 1.2 < np.mean([s.nees for s in ships]) < 2.8
    assert np.mean([s.rmse[0] for s in ships]) < 4.0  # plots err by 7 m


def test_the_nearest_assignment_tracks_too(scene):
    found = track(scene(CROSSING, clutter=1.0), settings=TrackerSettings(association="nearest"))
    assert found.score is not None and min(s.held for s in found.score.ships) > 0.8


def test_the_course_speed_and_closest_approach(scene):
    """A target 300 m to the east that goes north at 4 m/s, own ship lies still: CPA 300 m, passed 18 s ago."""
    found = track(scene([(-400.0, 300.0, 4.0, 0.0)], clutter=0.0, detection=1.0, noise=1.0))
    (one,) = found.tracks
    assert one.speed[-1] == pytest.approx(4.0, abs=0.25)
    assert abs(np.rad2deg(np.angle(np.exp(1j * one.course[-1])))) < 7
    near = one.approach
    assert near.cpa == pytest.approx(300, abs=8) and near.tcpa == pytest.approx(100 - 118, abs=10)


def test_a_target_that_vanishes_is_lost_and_comes_back(scene):
    found = track(scene([(-300.0, -200.0, 5.0, 0.0)], scans=90, hidden=(30, 60)))
    first, *others = found.tracks
    assert first.status == "ended" and not first.held[-1]
    assert (first.P[-1, 0, 0] > 10 * first.P[first.held.argmin() - 3, 0, 0]).all()
    assert first.approach is None
    assert others and others[-1].status == "held" and others[-1].t[0] > 120.0
    # Whatever is held lies near the target, or there is none.
    assert all(s.rmse[0] < 25 for s in found.score.ships)


def test_a_ship_that_appears_late_in_clutter_is_tracked(scene):
    """What began in clutter and was never seen again is wide: it does not swallow the first plots of a ship."""
    found = track(scene([(-300.0, -200.0, 5.0, 0.0)], scans=60, hidden=(0, 40), clutter=6.0))
    assert found.score is not None and found.score.ships[0].held > 0.8


def test_what_moves_along_the_edge_of_the_range_is_confirmed_inside():
    """A shore that the range cuts off gives a plot that goes round own ship; the same plots farther in are a ship."""
    chance = np.random.default_rng(0)
    t = 2.0 * np.arange(40)
    bearing = 0.02 * t
    edge = 1000 * np.column_stack([np.cos(chance.uniform(0, 6.3, 40)), np.sin(chance.uniform(0, 6.3, 40))])
    edge = 1000 * edge / np.hypot(*edge.T)[:, None]

    def tracks(range_, begins):
        round_ = range_ * np.column_stack([np.cos(bearing), np.sin(bearing)]) + 3 * chance.standard_normal((40, 2))
        x, y = np.concatenate([edge, round_[begins:]]).T
        return track(make_plots(np.concatenate([t, t[begins:]]), x, y, sensors=(Sensor(position_std=3.0),))).tracks

    assert not tracks(950.0, 20)
    assert len(tracks(250.0, 20)) == 1


def test_what_vanishes_at_the_end_is_lost(scene):
    (one,) = track(scene([(-300.0, -200.0, 5.0, 0.0)], scans=45, hidden=(34, 45), clutter=1.0)).tracks
    assert one.status == "lost" and one.approach is None
    assert "lost" in track(scene([(-300.0, -200.0, 5.0, 0.0)], scans=45, hidden=(34, 45), clutter=1.0)).text()


def test_a_latency_that_is_given_is_taken_out(scene):
    late = scene([(-300.0, -200.0, 6.0, 3.0)], latency=3.0)
    ignored = scene([(-300.0, -200.0, 6.0, 3.0)], latency=3.0, said=0.0)
    errors = [track(s).score.ships[0].rmse[0] for s in (late, ignored)]
    assert errors[0] < 6.0 and errors[1] > 15.0


def test_a_latency_is_found_with_a_second_sensor():
    """A radar that stamps its plots 2 s late, beside a lidar that does not: the difference is found with the tracks."""
    chance = np.random.default_rng(5)
    t = np.concatenate([np.arange(0, 300, 2.0), np.arange(0.5, 300, 1.0)])
    radar = np.arange(t.size) < 150
    age = t - np.where(radar, 2.0, 0.0)
    x, y = -600 + 5.0 * age + chance.normal(0, 3, t.size), 2.0 * age + chance.normal(0, 3, t.size)
    sensors = (Sensor("radar", 3.0, latency_std=2.0), Sensor("lidar", 3.0))
    found = track(make_plots(t, x, y, sensor=np.where(radar, 0, 1), sensors=sensors))
    value, std = found.latency["radar"]
    assert value == pytest.approx(2.0, abs=0.3) and 0 < std < 0.3
    alone = track(make_plots(t[radar], x[radar], y[radar], sensors=sensors[:1]))
    assert alone.to_dict()["tracks"]


def test_a_latency_that_nothing_shows_is_said(scene):
    found = scene([(100.0, 100.0, 0.0, 0.0)], clutter=0.0)
    sensor = replace(found.plots.sensors[0], latency_std=2.0)
    found = track(replace(found, plots=replace(found.plots, sensors=(sensor,))))
    assert [w.kind for w in found.warnings] == ["latency-not-known"], found


def test_a_target_on_a_pier_has_no_closest_approach():
    t, noise = 3.0 * np.arange(40), np.random.default_rng(0).normal(0, 5, (2, 40))
    pier = make_plots(t, 2000 + noise[0], 2000 + noise[1])
    found = track(Detections("pier", pier, relative=True))
    (row,) = [line.split() for line in found.text().splitlines() if line.lstrip().startswith("1 ")]
    assert row[9:12] == ["none", "not", "known"] and row[-1] == "unsure"
    assert "no track that is held surely comes nearer to own ship; track 1 is the nearest, at 28" in found.text()
    near = found.to_dict()["tracks"][0]["closest_approach"]
    assert near["cpa"]["value"] is None and near["cpa"]["interval_95"][1] > 2000


def test_one_plot_is_no_track():
    found = track(make_plots(np.array([1.0]), np.array([10.0]), np.array([20.0])))
    assert not found.tracks and "no-track" in [w.kind for w in found.warnings]
    assert "1 plot in 1 scan," in found.text()
    assert found.to_frame().empty and list(found.to_frame().columns)[:3] == ["track", "t", "x"]


def test_plots_without_noise():
    """Positions of a ruler: the track is exact, and its covariance stays one."""
    t = np.arange(0, 100, 2.0)
    found = track(make_plots(t, 100 + 3 * t, -2 * t))
    (one,) = found.tracks
    assert one.x[-1] == pytest.approx([100 + 3 * 98, -2 * 98, 3, -2], abs=0.05)
    assert (np.linalg.eigvalsh(one.P) > 0).all()


def test_order_duplicates_and_gaps_do_not_matter():
    t = np.arange(0, 100, 2.0)
    x, y = 100 + 3 * t, -2 * t
    plain = track(make_plots(t, x, y))
    order = np.random.default_rng(0).permutation(t.size)
    mixed = np.concatenate([order, order[:7]])
    bad = [np.concatenate([v[mixed], [np.nan, 5.0, 7.0]]) for v in (t, x, y)]
    bad[1][-2], bad[2][-1], bad[0][-1] = np.nan, np.inf, 7.0
    found = track(make_plots(*bad))
    assert {w.kind for w in found.warnings} >= {"plots-missing", "plots-out-of-order", "plots-twice"}
    assert found.tracks[0].x == pytest.approx(plain.tracks[0].x)


def test_own_echo_is_left_out():
    t = np.arange(0, 40, 2.0)
    found = make_plots(np.tile(t, 2), np.concatenate([200 + t, 0 * t]), np.concatenate([t, 0 * t]))
    assert len(found) == t.size and "plots-at-own-position" in [n.kind for n in found.notes]


def test_own_ship_unknown_is_said(scene):
    found = track(replace(scene(CROSSING), own=None))
    assert "own-ship-unknown" in [w.kind for w in found.warnings]
    assert all(o.approach is None for o in found.tracks)
    relative = track(replace(scene(CROSSING), own=None, relative=True))
    assert "relative-motion" in [w.kind for w in relative.warnings]
    assert all(o.approach is not None for o in relative.tracks)


def test_an_antenna_that_turns_makes_scans_of_its_bearings():
    """Targets all around, one plot after the other: the scan is a turn of the antenna."""
    bearings = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    t = (3.0 * np.arange(20)[:, None] + 3.0 * bearings / (2 * np.pi)).ravel()
    x, y = (1000 * f(np.tile(bearings, 20)) for f in (np.cos, np.sin))
    plots = make_plots(t, x, y)
    assert len(plots.scans) == pytest.approx(20, abs=1)
    given = make_plots(t, x, y, sensors=(Sensor(period=3.0),))
    assert len(given.scans) == 20
    assert len(track(given).tracks) == 8


@pytest.mark.parametrize("noise", [0.0, 5.0])
def test_one_target_on_one_bearing_is_no_antenna_that_turns(noise):
    """Her bearing goes to and fro by the noise, or by the last digit."""
    chance, t = np.random.default_rng(1), np.arange(0, 60, 2.0)
    range_ = 1000 - 4 * t + noise * chance.standard_normal(t.size)
    angle = 0.5 + noise * 1e-3 * chance.standard_normal(t.size)
    plots = make_plots(t, range_ * np.cos(angle), range_ * np.sin(angle))
    assert len(plots.scans) == t.size and len(track(plots).tracks) == 1


def test_one_target_that_passes_is_no_antenna_that_turns():
    """Her bearing goes one way but for a single small step backward, which is not nearly a whole turn."""
    t = np.arange(0, 120, 3.0)
    angle = 0.3 + 0.02 * np.arange(t.size)
    angle[20] = angle[19] - 0.005
    plots = make_plots(t, 1000 * np.cos(angle), 1000 * np.sin(angle))
    assert len(plots.scans) == t.size


def test_the_score_counts_what_is_no_ship(scene):
    """A second target that the truth does not know is a false track."""
    known = scene(CROSSING, clutter=1.0)
    found = track(replace(known, truth=known.truth[:1]))
    assert found.score.false_tracks == 1
    assert "1 moving track without a ship" in found.text()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: TrackerSettings(association="best"), "'best' is no association"),
        (lambda: TrackerSettings(lost=0.9999), "has to rise"),
        (lambda: TrackerSettings(speed=0.0), "above zero"),
        (lambda: Sensor(position_std=0.0), "above zero"),
        (lambda: Sensor(range_std=3.0), "range and bearing together"),
        (lambda: Sensor(detection=1.0), "between zero and one"),
        (lambda: Sensor(period=0.0), "a time above zero"),
        (lambda: FuzzySettings(longest=1), "two steps or more"),
        (lambda: make_plots(np.zeros(2), np.zeros(2), np.zeros(3)), "equally many"),
    ],
)
def test_settings_that_cannot_be_meant(make, words):
    with pytest.raises(EncounterRequestError, match=words):
        make()


def test_an_unknown_tracker(scene):
    with pytest.raises(UnknownNameError, match="agimm"):
        track(scene(CROSSING), "agim")


def test_the_same_plots_give_the_same_tracks(scene):
    first, second = (track(scene(CROSSING)).to_frame() for _ in range(2))
    assert first.equals(second)


def test_detections_are_what_is_tracked(scene):
    found: Detections = scene(CROSSING)
    assert track(found.plots).tracks[0].x == pytest.approx(track(found).tracks[0].x)


def test_a_track_on_own_ship_is_no_target(scene):
    """Her own AIS sails with her; another ship is tracked as before."""
    both = scene([(0.0, 0.0, 4.0, 1.0), (500.0, 300.0, -3.0, 0.0)], clutter=0.0)
    times = both.own.t
    own = replace(both.own, x=4.0 * times, y=1.0 * times)
    found = track(replace(both, own=own))
    (told,) = [w for w in found.warnings if w.kind == "track-on-own-ship"]
    assert not told.serious and told.known["tracks"] == [1] and "track 1 stays within" in told
    assert [one.approach is None for one in found.tracks] == [True, False]


def test_plots_that_stand_at_the_origin_are_told():
    """Where nothing is known of own ship, what never leaves x = y = 0 is no target; plots elsewhere are."""
    t = 2.5 * np.arange(40)
    for north, count in ((0.0, 1), (400.0, 0)):
        plots = make_plots(t, np.full(40, north), np.zeros(40), own=np.full((40, 2), np.nan))
        told = [w for w in track(plots).warnings if w.kind == "track-on-own-ship"]
        assert [w.serious for w in told] == [True] * count
