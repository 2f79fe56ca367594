"""Ship domains and velocities that keep out of them, against the motion sampled finely."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.ship_domain import ShipDomain, circle
from shipid.encounter.velocity_obstacles import VelocityPlanner


def test_an_ellipse_that_moves_and_turns_with_its_ship():
    rng = np.random.default_rng(0)
    domain = ShipDomain(600.0, 250.0, ahead=150.0, starboard=40.0)
    t = np.linspace(0, 300, 20_001)
    for _ in range(20):
        other, own = rng.normal(0, [2000, 2000, 6, 6]), rng.normal(0, [200, 200, 6, 6])
        course = np.arctan2(other[3], other[2])
        centre = (
            other[:2]
            + 150 * np.array([np.cos(course), np.sin(course)])
            + 40 * np.array([-np.sin(course), np.cos(course)])
        )
        apart = centre + t[:, None] * other[2:] - own[:2] - t[:, None] * own[2:]
        ahead, aside = apart @ [np.cos(course), np.sin(course)], apart @ [-np.sin(course), np.cos(course)]
        sampled = np.hypot(ahead / 600, aside / 250).min()
        assert domain.nearest(other - own, course, 300.0) == pytest.approx(sampled, abs=1e-3)


def test_a_round_domain_is_a_distance():
    assert circle(200.0).nearest(np.array([1000.0, 100.0, -5.0, 0.0]), np.array(0.3), 1e4) == pytest.approx(0.5)


def test_with_nothing_in_the_way_it_goes_straight_to_the_goal():
    planner = VelocityPlanner(circle(230.0), 20.0)
    heading, speed, clear = planner.choose(np.zeros(2), np.array(0.1), np.array([1000.0, 0.0]), np.zeros((0, 4)))
    assert heading == pytest.approx(0.0, abs=np.deg2rad(1.0)) and speed == 20.0 and clear


def test_the_chosen_velocity_keeps_out_of_every_domain():
    rng = np.random.default_rng(1)
    planner = VelocityPlanner(circle(230.0), 20.0)
    others = np.concatenate(
        [rng.uniform([500, -1500], [3500, 1500], (200, 3, 2)), rng.normal(0, 5, (200, 3, 2))], axis=-1
    )
    heading, speed, clear = planner.choose(np.zeros((200, 2)), np.zeros(200), np.array([6500.0, 0.0]), others)
    assert clear.sum() > 20
    t = np.linspace(0, 150, 3001)
    velocity = speed[:, None] * np.stack([np.cos(heading), np.sin(heading)], -1)
    apart = others[:, :, None, :2] + t[:, None] * (others[:, :, None, 2:] - velocity[:, None, None, :])
    nearest = np.hypot(apart[..., 0], apart[..., 1]).min(axis=(1, 2))
    assert (nearest[clear] >= 230 - 1e-6).all()
    assert np.abs(heading).max() <= np.deg2rad(40) + 1e-12


def test_what_lies_behind_the_goal_does_not_count():
    planner = VelocityPlanner(circle(230.0), 20.0)
    behind = np.array([[1500.0, 0.0, 0.0, 0.0]])
    heading, speed, clear = planner.choose(np.zeros(2), np.array(0.0), np.array([1000.0, 0.0]), behind)
    assert clear and speed == 20.0 and heading == 0.0
    heading, _, clear = planner.choose(np.zeros(2), np.array(0.0), np.array([1400.0, 0.0]), behind)
    assert clear and heading != 0.0


def test_inside_a_domain_it_leaves():
    planner = VelocityPlanner(circle(230.0), 20.0)
    other = np.array([[150.0, 10.0, 0.0, 0.0]])
    heading, _, clear = planner.choose(np.zeros(2), np.array(0.0), np.array([5000.0, 0.0]), other, delay=5.0)
    assert not clear and heading == pytest.approx(-np.deg2rad(40))


def test_settings_without_sense_are_refused():
    with pytest.raises(EncounterRequestError, match="has no area"):
        circle(0.0)
    with pytest.raises(EncounterRequestError, match="above zero"):
        VelocityPlanner(circle(1.0), 0.0)
