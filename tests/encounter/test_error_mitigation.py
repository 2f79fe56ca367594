"""Mitigation of errors: the exact solve against a fine grid and the swarm, frames, readings, and targets that hardly move."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.encounter.acceleration_prediction import acceleration_factor
from shipid.encounter.error_mitigation import Mitigation, mitigated_points, scans_between, straight_points
from shipid.encounter.errors import EncounterRequestError, TargetError
from shipid.encounter.smoothest_points import MiddleProblem, exact_middle, swarm_middle
from shipid.foundation.errors import UnknownNameError


def problems(count: int, radius: float, seed: int = 0, degree: int = 2) -> MiddleProblem:
    """Curves and observed points about them, some of them with the solution on a circle."""
    rng = np.random.default_rng(seed)
    curve = np.stack([rng.normal(0, 10, count), rng.normal(0, 0.3, count), rng.normal(0, 3e-3, count)], -1)[
        :, : degree + 1
    ]
    ends = np.stack([rng.normal(90, 25, count), rng.normal(-90, 25, count)], -1)
    along = np.stack([rng.normal(30, 25, count), rng.normal(-30, 25, count)], -1)
    height = np.sum(curve[:, None, :] * along[..., None] ** np.arange(degree + 1), -1)
    observed = np.stack([along, height + rng.uniform(-0.95 * radius, 0.95 * radius, along.shape)], -1)
    return MiddleProblem(curve, ends, observed, radius)


def squared(problem: MiddleProblem, middle: np.ndarray) -> np.ndarray:
    return problem.jerk(middle[..., None])[..., 0]


@pytest.mark.parametrize(("radius", "degree"), [(30.0, 2), (8.0, 2), (8.0, 1)])
def test_no_point_of_a_grid_is_better_than_the_exact_one(radius, degree):
    count = 60
    problem = problems(count, radius, degree=degree)
    found = exact_middle(problem)
    assert problem.distance(found[..., None]).max() <= radius * (1 + 1e-6)
    offsets = np.linspace(-radius, radius, 161)
    x1 = problem.observed[:, 0, 0, None, None] + offsets[:, None]
    x2 = problem.observed[:, 1, 0, None, None] + offsets[None, :]
    middle = np.stack([a.reshape(count, -1) for a in np.broadcast_arrays(x1, x2)], axis=1)
    inside = (problem.distance(middle) <= radius).all(axis=1)
    best = np.where(inside, problem.jerk(middle), np.inf).min(axis=1)
    assert (squared(problem, found) <= best + 1e-6).all()
    assert np.mean(squared(problem, found) < 1e-9) < (1.0 if radius == 8 else 1.01), "some solutions lie on a circle"


def test_the_swarm_finds_the_same_and_never_better():
    problem = problems(300, 12.0, seed=1)
    exact, swarm = squared(problem, exact_middle(problem)), squared(problem, swarm_middle(problem))
    assert (exact <= swarm + 1e-6).all()
    assert np.median(np.sqrt(swarm) - np.sqrt(exact)) < 1.0


def test_a_curve_that_misses_the_circles_gives_the_nearest_points():
    problem = MiddleProblem(
        np.array([0.0, 0.0, 0.0]), np.array([90.0, -90.0]), np.array([[40.0, 50.0], [-20.0, 60.0]]), 10.0
    )
    np.testing.assert_allclose(exact_middle(problem), [40.0, -20.0], atol=1e-6)


def turning(count: int = 16, rate: float = 0.01, speed: float = 6.0) -> np.ndarray:
    course = 0.4 + rate * 2.0 * np.arange(count)
    return np.cumsum(speed * 2.0 * np.stack([np.cos(course), np.sin(course)], -1), axis=0)


@pytest.mark.parametrize("reading", ["sampled", "all scans"])
def test_points_without_errors_stay_where_they_are(reading):
    """A parabola is not an arc: over 180 m it departs from one by a metre."""
    track = turning()
    np.testing.assert_allclose(mitigated_points(track, 5, Mitigation(reading)), track[::5], atol=3.0)


@pytest.mark.parametrize("reading", ["sampled", "all scans"])
def test_the_frame_does_not_matter(reading):
    scans = turning() + np.random.default_rng(2).normal(0, 12, (16, 2))
    turn = np.array([[np.cos(2.2), -np.sin(2.2)], [np.sin(2.2), np.cos(2.2)]])
    one = mitigated_points(scans, 5, Mitigation(reading))
    other = mitigated_points(scans @ turn.T + [5000.0, -300.0], 5, Mitigation(reading))
    np.testing.assert_allclose(one @ turn.T + [5000.0, -300.0], other, atol=1e-6)


def test_errors_of_the_middle_points_shrink_and_those_of_the_ends_hardly():
    """As measured for the paper's settings: about 21 m to 13-15 m in the middle, the ends as they were."""
    rng = np.random.default_rng(3)
    track = np.broadcast_to(turning(), (1500, 16, 2))
    angle, away = rng.uniform(0, 2 * np.pi, (1500, 16)), 30 * np.sqrt(rng.uniform(size=(1500, 16)))
    scans = track + np.stack([away * np.cos(angle), away * np.sin(angle)], -1)
    found = mitigated_points(scans, 5, Mitigation("sampled"))
    rms = np.sqrt(np.mean(np.sum((found - track[:, ::5]) ** 2, -1), 0))
    assert rms[[0, 3]] == pytest.approx(21.0, abs=1.0) and rms[[1, 2]].max() < 16.5
    assert np.median(acceleration_factor(found)) == pytest.approx(1.0, abs=0.02)


def test_a_target_that_hardly_moves_has_no_direction():
    scans = np.random.default_rng(4).normal(0, 8, (16, 2))
    np.testing.assert_allclose(mitigated_points(scans, 5, Mitigation()), straight_points(scans, 5))


def test_straight_points_lie_on_the_line_of_least_squares():
    scans = turning(rate=0.0) + np.random.default_rng(5).normal(0, 10, (16, 2))
    found = straight_points(scans, 5)
    line = np.stack([np.polyval(np.polyfit(np.arange(16), scans[:, i], 1), np.arange(0, 16, 5)) for i in (0, 1)], -1)
    np.testing.assert_allclose(found, line, atol=1e-9)


def test_the_period_is_a_whole_number_of_scans():
    assert scans_between(12_000.0, 5.0 * 23.0) == 10
    assert scans_between(100.0, 115.0) == 1
    with pytest.raises(EncounterRequestError, match="both are positive"):
        scans_between(12_000.0, 0.0)


def test_bad_settings_and_scans_are_refused():
    with pytest.raises(UnknownNameError, match="reading 'some'"):
        Mitigation("some")
    with pytest.raises(UnknownNameError, match="solver 'ants'"):
        Mitigation(solver="ants")
    with pytest.raises(EncounterRequestError, match="degree 3"):
        Mitigation(degree=3)
    with pytest.raises(EncounterRequestError, match="radius of the error is 0 m"):
        Mitigation(radius=0.0)
    with pytest.raises(TargetError, match="do not hold 16 positions"):
        mitigated_points(np.zeros((15, 2)), 5, Mitigation())
    with pytest.raises(TargetError, match="a scan has no position"):
        mitigated_points(np.full((16, 2), np.nan), 5, Mitigation())
