"""The speed before the manoeuvre: mean to the first execute, over the first quarter of L/U, or the usual speed of a ship that gathers way."""

import numpy as np
import pytest

from shipid.trials.errors import NotAheadError
from shipid.trials.speed import check_way, speed_before

T = np.arange(0.0, 100.0, 0.5)


def rudder_from(begin: float, angle: float = np.deg2rad(20.0)) -> np.ndarray:
    return np.where(begin <= T, angle, 0.01)


def losing(begin: float) -> np.ndarray:
    """5 m/s before the execute, two thirds of it after."""
    return np.where(begin > T, 5.0, 5.0 - 1.6 * (1 - np.exp(-(T - begin) / 5.0)))


def test_the_mean_from_the_start_to_the_first_execute() -> None:
    rng = np.random.default_rng(1)
    noise = 0.1 * rng.standard_normal(T.size)
    found = speed_before(T, losing(30.0) + noise, rudder_from(30.0), unit_time=8.0)
    assert found.source == "approach" and found.samples == 60
    assert found.value == pytest.approx(5.0 + noise[:60].mean(), abs=1e-12)
    assert found.std == pytest.approx(0.1 / np.sqrt(60), rel=0.3)


def test_a_record_that_begins_with_the_execute_is_averaged_while_the_ship_keeps_her_speed() -> None:
    found = speed_before(T, losing(0.0) + 0.0 * T, np.full(T.size, np.deg2rad(20.0)), unit_time=8.0)
    assert found.source == "first samples" and found.samples == 4
    assert found.value == pytest.approx(losing(0.0)[:4].mean())


def test_a_short_approach_is_not_continued_into_the_turn() -> None:
    found = speed_before(T, losing(3.0), rudder_from(3.0), unit_time=8.0)
    assert found.source == "first samples" and found.samples == 6
    assert found.value == 5.0


def test_a_speed_that_is_recorded_from_the_manoeuvre_on_is_as_uncertain_as_what_the_manoeuvre_takes() -> None:
    late = np.where(T < 40.0, np.nan, losing(30.0))
    found = speed_before(T, late, rudder_from(30.0), unit_time=8.0)
    assert found.value == late[T >= 40.0][0]
    assert found.std > abs(found.value - np.nanmedian(late)) > 0.1


def test_two_samples_have_the_noise_of_the_record() -> None:
    noise = 0.1 * np.random.default_rng(2).standard_normal(T.size)
    sparse = np.where((T < 1.0) | (T > 30.0), losing(30.0) + noise, np.nan)
    found = speed_before(T, sparse, rudder_from(30.0), unit_time=8.0)
    assert found.samples == 2 and found.std == pytest.approx(0.1 / np.sqrt(2), rel=0.3)


def test_without_a_rudder_or_a_length_the_first_samples_count() -> None:
    found = speed_before(T, np.arange(T.size, 0.0, -1.0) + 1000.0)
    assert found.source == "first samples" and found.samples == 10
    assert found.value == pytest.approx(1000.0 + np.mean([200 - k for k in range(10)]))


def test_missing_samples_are_left_out() -> None:
    speed = losing(30.0)
    speed[:20:2] = np.nan
    speed[70:90] = np.nan
    found = speed_before(T, speed, rudder_from(30.0), unit_time=8.0)
    assert found.value == pytest.approx(5.0) and found.samples == 50
    assert speed_before(T, np.full(T.size, np.nan), rudder_from(30.0)) is None


def test_a_ship_that_gathers_way_has_no_approach() -> None:
    found = speed_before(T, 5.0 * (1 - np.exp(-T / 10.0)), rudder_from(20.0), unit_time=8.0)
    assert found.source == "usual speed"
    assert found.value == pytest.approx(np.median(5.0 * (1 - np.exp(-T / 10.0))))


def test_a_helmsman_who_keeps_the_course_has_not_executed() -> None:
    keeping = np.deg2rad(1.0) * np.sin(T)
    assert speed_before(T, losing(30.0), np.where(T < 30.0, keeping, 0.35), 8.0).samples == 60


def test_a_ship_that_goes_astern_in_a_record_is_named() -> None:
    """Ten samples in a row below zero; fewer are noise about a ship that lies still."""
    speed = 5.0 - T / 10.0
    with pytest.raises(NotAheadError, match=r"goes astern from 50\.5 s on, and model de-keizer .*\(FILE@0:50\.5 for"):
        check_way({"t": T, "u": speed}, "stopping", "de-keizer")
    with pytest.raises(NotAheadError, match="Take a window in which it does, or"):
        check_way({"t": T, "u": speed - 6.0}, "astern", "de-keizer")
    noisy = np.where(np.arange(T.size) % 10 == 0, 0.1, -0.1)
    check_way({"t": T, "u": noisy}, "still", "de-keizer")
    check_way({"t": T[:5], "u": -np.ones(5)}, "short", "de-keizer")
    check_way({"t": T}, "no log", "de-keizer")
    holed = np.where(np.arange(T.size) % 2 == 0, np.nan, speed)
    with pytest.raises(NotAheadError, match=r"astern from 50\.5 s on"):
        check_way({"t": T, "u": holed}, "holed", "de-keizer")
