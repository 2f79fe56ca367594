"""Statistics by batches against those of all runs at once, and their bands against the truth."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

from shipid.campaign.campaign import Measure
from shipid.campaign.moments import MeasureTally, RunMoments, Statistic
from shipid.campaign.result import summary


def told(measure: Measure, rows: np.ndarray, size: int = 7) -> Statistic:
    tally = MeasureTally.begin(measure, rows)
    for k in range(0, len(rows), size):
        tally.add(rows[k : k + size])
    return tally.statistic("x")


def test_batches_add_up_to_the_whole():
    rng = np.random.default_rng(0)
    rows = 1e6 + rng.normal(size=(101, 4))
    rows[rng.random(rows.shape) < 0.2] = np.nan
    found = RunMoments.nothing((4,))
    for k in range(0, 101, 13):
        found.add(rows[k : k + 13])
    np.testing.assert_allclose(found.mean, np.nanmean(rows, 0), rtol=1e-14)
    np.testing.assert_allclose(found.std, np.nanstd(rows, 0, ddof=1), rtol=1e-9)
    np.testing.assert_array_equal(found.low, np.nanmin(rows, 0))
    np.testing.assert_array_equal(found.high, np.nanmax(rows, 0))


def test_an_error_has_root_mean_square_and_mean():
    rows = np.random.default_rng(1).normal(0.5, 2.0, 400)
    found = told(Measure("error", "m"), rows)
    assert found.rmse == pytest.approx(np.sqrt(np.mean(rows**2)))
    assert found.mean == pytest.approx(rows.mean())


def test_the_bands_hold_the_truth_as_often_as_they_say():
    """A thousand campaigns of 40 runs: the share of intervals that hold the truth is 95 % to within its own three sigma."""
    rng = np.random.default_rng(2)
    hits = {"mean": 0, "rmse": 0, "event": 0, "nees": 0}
    for _ in range(1000):
        error = rng.normal(0.5, 2.0, 40)
        found = told(Measure("error", "m"), error, 40)
        hits["mean"] += found.mean_interval[0] < 0.5 < found.mean_interval[1]
        hits["rmse"] += found.rmse_interval[0] < np.sqrt(4.25) < found.rmse_interval[1]
        low, high = told(Measure("event"), (rng.uniform(size=40) < 0.1).astype(float), 40).mean_interval
        hits["event"] += low < 0.1 < high
        nees = told(Measure("nees", degrees=2), (rng.normal(size=(40, 2)) ** 2).sum(1), 40)
        hits["nees"] += nees.expected_interval[0] < nees.mean < nees.expected_interval[1]
    # Squares of 40 errors are skew: the interval of their root mean square holds the truth in about 93 %.
    for name, least in {"mean": 930, "rmse": 905, "event": 920, "nees": 930}.items():
        assert least <= hits[name] <= 975, (name, hits[name])


def test_the_course_of_a_measure_has_statistics_at_each_place():
    rows = np.random.default_rng(3).normal([0.0, 1.0, 2.0], 1.0, (200, 3))
    found = told(Measure("error", "m"), rows)
    np.testing.assert_allclose(found.course["mean"], rows.mean(0))
    np.testing.assert_allclose(found.course["rmse"], np.sqrt((rows**2).mean(0)))
    assert found.rmse == pytest.approx(np.sqrt((rows**2).mean()))
    assert found.expected_interval is None
    plain = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert len(plain["course"]["rmse_interval"]) == 3 and len(plain["course"]["rmse_interval"][0]) == 2


def test_one_run_has_no_band():
    found = told(Measure("value", "s"), np.array([3.0]))
    assert found.mean == 3.0 and np.isnan(found.std)
    assert json.loads(json.dumps(found.to_dict(), allow_nan=False))["mean"]["interval_95"] == [None, None]


def test_runs_without_a_value_are_counted():
    found = told(Measure("value", "s"), np.array([1.0, np.nan, 3.0, np.inf]))
    assert (found.runs, found.missing, found.mean) == (4, 2, 2.0)


def test_texts_are_counted_up_to_a_number():
    found = told(Measure("text"), np.array([f"t{k}" for k in range(300)]))
    assert sum(found.texts.values()) == 300 and found.texts["(other)"] == 100


def test_an_angle_is_told_in_degrees_with_the_digits_of_its_interval():
    words = summary(told(Measure("error", "rad"), np.random.default_rng(1).normal(0.5, 0.2, 100)))
    number = r"\d\d\.\d\d"
    assert re.fullmatch(
        rf"RMSE {number} \({number} to {number}\) deg, mean error {number} \({number} to {number}\) deg", words
    )


def test_the_interval_of_a_count_is_garwoods_and_stays_at_zero_or_above():
    """Of 2 events in 40 runs Student's interval went from -0.02; of none it was 0 to 0."""
    rows = np.zeros(40)
    assert told(Measure("count"), rows).mean_interval == (0.0, pytest.approx(3.6889 / 40, rel=1e-4))
    rows[[3, 20]] = 1
    # Garwood (1936): 0.2422 and 7.2247 for two events seen; Student's factor of 40 runs is within the floor of the ratio here.
    low, high = told(Measure("count"), rows).mean_interval
    assert low * 40 == pytest.approx(0.2422, rel=0.06) and high * 40 == pytest.approx(7.2247, rel=0.06)
    assert np.isnan(told(Measure("count"), np.array([3.0])).mean_interval).all()


def test_the_interval_of_a_count_holds_the_truth():
    """Seldom and often, alone and in clusters: 95 % at least where events are independent, not much less in clusters."""
    rng = np.random.default_rng(4)
    for mean, cluster, least in ((0.05, 1, 950), (0.5, 1, 940), (20.0, 1, 935), (2.0, 4, 930), (0.5, 4, 900)):
        hits = 0
        for _ in range(1000):
            low, high = told(
                Measure("count"), cluster * rng.poisson(mean / cluster, 40).astype(float), 40
            ).mean_interval
            hits += low <= mean <= high
            assert low >= 0
        assert hits >= least, (mean, cluster, hits)


def test_the_interval_of_a_count_over_places_is_no_wider_for_being_a_mean():
    rows = np.random.default_rng(5).poisson(0.5, (40, 50)).astype(float)
    low, high = told(Measure("count"), rows).mean_interval
    assert 0 < low < 0.5 < high and high - low < 0.1
    assert (np.array(told(Measure("count"), rows).course["mean_interval"][0]) >= 0).all()
