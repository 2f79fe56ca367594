"""The filters of targets: the generated prediction, and the multiple-model recursion beside filterpy's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.tracking.filters.motion import Motion, TargetMode
from shipid.encounter.tracking.filters.target_filters import TargetFilters
from shipid.encounter.tracking.filters.trackers import NAMES, motion_of
from shipid.foundation.errors import UnknownNameError
from shipid.parameters.catalogue import find_model, find_ship

MODEL = find_model("coordinated-turn-augmented")
TWO = Motion(MODEL, (TargetMode("steady", acceleration=0.1), TargetMode("manoeuvring", acceleration=1.0, stays=20.0)))
R = np.array([[[25.0, 4.0], [4.0, 16.0]]])


def begun(motion: Motion) -> TargetFilters:
    return TargetFilters.none(motion).begin(np.array([[100.0, -50.0]]), R, np.zeros(1), 5.0)


def test_a_turn_is_a_circle() -> None:
    """A quarter turn to starboard of a ship that sails north ends on an easterly course, one radius to the north and east."""
    motion = Motion(MODEL, (TargetMode("starboard", turn=0.05),))
    speed, rate = 4.0, 0.05
    x = np.array([[[0.0, 0.0, speed, 0.0, 0.0]]])
    P = np.zeros((1, 1, 5, 5))
    for _ in range(10):
        x, P = motion.predict(x, P, np.array([[rate]]), np.pi / 2 / rate / 10)
    radius = speed / rate
    assert x[0, 0, :4] == pytest.approx([radius, radius, 0.0, speed], abs=1e-3)


def test_the_curvature_turns_whatever_the_speed() -> None:
    motion = Motion(find_model("coordinated-circle-augmented"), (TargetMode("starboard", turn=0.01),))
    for speed in (2.0, 8.0):
        x = np.array([[[0.0, 0.0, speed, 0.0, 0.0]]])
        for _ in range(4):
            x, _ = motion.predict(x, np.zeros((1, 1, 5, 5)), np.array([[0.01]]), np.pi * 100 / speed / 8)
        assert x[0, 0, :2] == pytest.approx([100.0, 100.0], rel=1e-4)


def test_the_covariance_is_carried_by_the_exact_jacobian() -> None:
    motion = Motion(MODEL, (TargetMode("starboard", acceleration=1e-9),))
    x = np.array([3.0, 4.0, 5.0, -2.0, 0.02])
    turn, interval, step = np.array([[0.03]]), 3.0, 1e-6
    moved = [
        motion.predict((x + sign * step * e)[None, None], np.zeros((1, 1, 5, 5)), turn, interval)[0][0, 0]
        for e in np.eye(5)
        for sign in (1, -1)
    ]
    F = np.array([(moved[2 * k] - moved[2 * k + 1]) / (2 * step) for k in range(5)]).T
    P = np.diag([4.0, 9.0, 1.0, 2.0, 1e-4])
    _, ahead = motion.predict(x[None, None], P[None, None], turn, interval)
    assert ahead[0, 0] == pytest.approx(F @ P @ F.T, rel=1e-6, abs=1e-8)


def test_the_multiple_model_recursion_equals_that_of_filterpy() -> None:
    from filterpy.kalman import IMMEstimator, KalmanFilter

    interval = 2.0
    filters = begun(TWO)
    peers = []
    for k in range(2):
        one = KalmanFilter(4, 2)
        one.x, one.P = filters.x[0, k, :4].copy(), filters.P[0, k, :4, :4].copy()
        one.F = np.eye(4) + interval * np.eye(4, k=2)
        one.H, one.R = np.eye(4)[:2], R[0]
        _, noise = TWO.predict(np.zeros((1, 2, 5)), np.zeros((1, 2, 5, 5)), np.zeros((1, 2)), interval)
        one.Q = noise[0, k, :4, :4]
        peers.append(one)
    peer = IMMEstimator(peers, filters.mu[0].copy(), TWO.switching(interval))
    chance = np.random.default_rng(0)
    none = np.zeros(1)
    for k in range(100):
        z = np.array([[100.0 + 6.0 * k, -50.0 + 0.05 * k**2]]) + chance.normal(0, 5, (1, 2))
        filters = filters.predict(interval)
        filters = filters.update(filters.expect(z, R, none), none, np.array([[0.0, 1.0]]))
        peer.predict()
        peer.update(z[0])
    x, P = filters.combined()
    assert filters.mu[0] == pytest.approx(peer.mu, abs=1e-8)
    assert x[0] == pytest.approx(peer.x, abs=1e-8)
    assert P[0] == pytest.approx(peer.P, abs=1e-8)


def test_two_plots_are_a_mixture() -> None:
    """With one mode the update is the mean of what each plot alone gives, with the spread of the two."""
    motion = Motion(MODEL, (TargetMode("steady"),))
    filters, none = begun(motion).predict(2.0), np.zeros(2)
    z, both = np.array([[105.0, -45.0], [90.0, -52.0]]), np.repeat(R, 2, axis=0)
    expected = filters.expect(z, both, none)
    alone = [filters.update(expected, none, np.eye(3)[None, k]).combined() for k in range(3)]
    shares = np.array([0.2, 0.5, 0.3])
    x, P = filters.update(expected, none, shares[None]).combined()
    mean = sum(s * a[0][0] for s, a in zip(shares, alone))
    assert x[0] == pytest.approx(mean)
    spread = sum(s * (a[1][0] + np.outer(a[0][0] - mean, a[0][0] - mean)) for s, a in zip(shares, alone))
    assert P[0] == pytest.approx(spread)


def test_a_late_plot_shows_where_the_target_was() -> None:
    motion = Motion(MODEL, (TargetMode("steady", acceleration=1e-6),))
    filters, late = begun(motion), np.array([2.0])
    for k in range(1, 40):
        filters = filters.predict(1.0)
        z = np.array([[100.0 + 3.0 * (k - 2.0), -50.0 + 4.0 * (k - 2.0)]])
        filters = filters.update(filters.expect(z, R, late), late, np.array([[0.0, 1.0]]))
    assert filters.combined()[0][0] == pytest.approx([100 + 3 * 39, -50 + 4 * 39, 3.0, 4.0], abs=0.1)


@pytest.mark.parametrize("name", [n for n in NAMES if n not in ("alpha-beta", "cv")])
def test_the_modes_follow_a_turn(name: str) -> None:
    """In a steady turn to starboard the rate of turn is found, and the mode that turns there is the most probable one."""
    motion = motion_of(name)
    filters, none = TargetFilters.none(motion).begin(np.array([[0.0, 0.0]]), R, np.zeros(1), 5.0), np.zeros(1)
    rate, speed = np.deg2rad(3.0), 5.0
    chance = np.random.default_rng(3)
    for k in range(1, 60):
        angle = rate * 2.0 * k
        z = speed / rate * np.array([[np.sin(angle), 1 - np.cos(angle)]]) + chance.normal(0, 1, (1, 2))
        filters = filters.predict(2.0)
        filters = filters.update(filters.expect(z, R / 25, none), none, np.array([[0.0, 1.0]]))
    assert np.isfinite(filters.x).all() and np.isfinite(filters.P).all()
    x, P = filters.combined()
    assert np.hypot(*(x[0, :2] - speed / rate * np.array([np.sin(angle), 1 - np.cos(angle)]))) < 3.0
    assert np.linalg.eigvalsh(P[0])[0] > 0
    if name != "imm":
        assert np.rad2deg(filters.turn_rates()[0]) == pytest.approx(3.0, abs=1.2)


def test_a_ship_says_how_sharply_targets_turn() -> None:
    ship = find_ship("soesterberg")
    length = ship.particular("L", "m")
    assert length is not None
    motion = motion_of("vs-aimm", ship)
    assert motion.model.name == "coordinated-circle-augmented"
    assert motion.modes[2].high == pytest.approx(2 / (3.5 * length))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Motion(MODEL, ()), "at least one mode"),
        (lambda: Motion(find_model("de-keizer"), (TargetMode("a"),)), "no motion of a target"),
        (lambda: Motion(MODEL, (TargetMode("a", acceleration=0.0),)), "positive acceleration noise"),
        (
            lambda: Motion(
                MODEL,
                (TargetMode("port", low=-0.1, high=0.02), TargetMode("starboard", low=0.01, high=0.1)),
                "variable",
            ),
            "'port' and 'starboard' overlap",
        ),
        (lambda: motion_of("imm", find_ship("soesterberg")), "no mode that turns"),
    ],
)
def test_motions_that_cannot_be_meant(make: object, words: str) -> None:
    with pytest.raises(EncounterRequestError, match=words):
        make()  # type: ignore[operator]


def test_an_unknown_tracker() -> None:
    with pytest.raises(UnknownNameError, match="tracker 'vs-imm'"):
        motion_of("vs-imm")


def grid(mu: list[float], turn: list[float]) -> list[float]:
    """Turns of the adaptive grid after a scan, in shares of the sharpest one."""
    motion = motion_of("agimm")
    most = motion.modes[2].high
    filters = replace(begun(motion), mu=np.array([mu]), turn=most * np.array([turn]))
    return (filters.adapted().turn[0] / most).tolist()


def test_the_grid_closes_in_and_moves_out() -> None:
    """Modes port, straight, starboard; between half the sharpest turn and the whole of it apart."""
    assert grid([0.02, 0.96, 0.02], [-0.8, 0.0, 0.8]) == pytest.approx([-0.5, 0.0, 0.5])
    assert grid([0.1, 0.8, 0.1], [-0.8, 0.0, 0.8]) == pytest.approx([-0.8, 0.0, 0.8])
    # A sure turn to starboard: the centre goes there, and what lies beyond the sharpest turn is cut off.
    assert grid([0.01, 0.04, 0.95], [-0.6, 0.0, 0.6]) == pytest.approx([-0.036, 0.564, 1.0])


def test_the_grid_keeps_what_is_known_of_the_turn_where_it_moves() -> None:
    """What a scan said is counted once: the turn is as probable on the moved grid as it was before."""
    motion = motion_of("agimm")
    most = motion.modes[2].high
    generator = np.random.default_rng(4)
    mu = generator.dirichlet([1.0, 2.0, 1.0], 200)
    filters = begun(motion)
    rows = np.zeros(200, int)
    filters = replace(filters.select(rows), mu=mu, turn=most * np.tile([-0.7, 0.1, 0.8], (200, 1)))
    adapted = filters.adapted()
    assert adapted.mu.sum(axis=1) == pytest.approx(np.ones(200)) and adapted.mu.min() > 0

    def moments(found: TargetFilters) -> tuple[np.ndarray, np.ndarray]:
        mean = (found.mu * found.turn).sum(axis=1)
        return mean, (found.mu * (found.turn - mean[:, None]) ** 2).sum(axis=1)

    (mean, spread), (mean_now, spread_now) = moments(filters), moments(adapted)
    assert mean_now == pytest.approx(mean, abs=1e-5 * most)
    held = adapted.mu[:, 1] > 1e-5
    assert held.mean() > 0.5 and spread_now[held] == pytest.approx(spread[held], abs=1e-5 * most**2)
    assert np.all(spread_now <= spread + 1e-5 * most**2), "what the grid cannot hold is no wider"


def test_a_displacement_goes_into_the_turn_within_its_bounds() -> None:
    motion = motion_of("vs-aimm")
    filters = begun(motion)
    x = filters.x.copy()
    x[0, :, 4] = [1.0, 1e-3, -1.0]
    adapted = replace(filters, x=x).adapted()
    assert adapted.turn[0] == pytest.approx([motion.modes[0].high, 0.0, motion.modes[2].low])
    assert adapted.x[0, :, 4].tolist() == [0.0, 0.0, 0.0]
    fixed = begun(motion_of("fs-aimm"))
    assert fixed.adapted() is fixed


@pytest.mark.parametrize("name", ["imm", "vs-aimm"])
def test_no_target_is_none_after_a_scan(name: str) -> None:
    filters, none = TargetFilters.none(motion_of(name)).predict(2.0), np.zeros(1)
    filters = filters.update(filters.expect(np.array([[1.0, 2.0]]), R, none), none, np.zeros((0, 2)))
    x, P = filters.adapted().combined()
    assert x.shape == (0, 4) and P.shape == (0, 4, 4) and filters.turn_rates().shape == (0,)
