"""The current is as unsure as the errors of the fixes that it was estimated from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from shipid.prediction.situations.fix_errors import (
    CurrentMoves,
    FixErrors,
    moved_of_late,
    stretch_squares,
    widened_current,
)
from shipid.prediction.situations.situation import Situation

NAMES = ("psi", "current_north", "current_east")
KNOWN = Situation(
    {"psi": 0.0, "u": 5.0, "current_north": 0.5, "current_east": 0.0},
    NAMES,
    np.array([[0.01, 0.002, 0.0], [0.002, 0.04, 0.0], [0.0, 0.0, 0.04]]),
)


def test_independent_errors_widen_nothing_and_lasting_ones_do():
    random, t = np.random.default_rng(4), np.arange(0, 400, 0.5)
    white = random.standard_normal((t.size, 2))
    squares = stretch_squares(t, white, 10.0)
    assert squares.size == 39 and squares.mean() == pytest.approx(1.0, abs=0.4)
    assert widened_current(KNOWN, squares, 0.0).std_of("current_north") == pytest.approx(0.2, rel=0.2)
    # Each error stays for a whole stretch of twenty samples: its mean is sqrt(20) times as large as that of independent ones.
    held = stretch_squares(t, np.repeat(white[::20], 20, axis=0), 10.0)
    assert held.mean() == pytest.approx(20 * (white[::20] ** 2)[:-1].mean())
    wide = widened_current(KNOWN, held, 0.0)
    factor = np.sqrt((4 + held[-20:].sum()) / 24)
    assert factor > 2 and wide.std_of("current_east") == pytest.approx(0.2 * factor)
    assert wide.std_of("psi") == pytest.approx(0.1)
    assert wide.covariance[0, 1] == pytest.approx(0.002 * factor)


def test_fix_by_fix_it_is_the_same():
    random, t = np.random.default_rng(5), np.arange(0, 90, 0.5)
    off = random.standard_normal((t.size, 2)) + 0.5
    one = FixErrors(10.0)
    for time, (north, east) in zip(t, off):
        one.add(time, north, east)
    assert one.squares == pytest.approx(stretch_squares(t, off, 10.0))
    assert stretch_squares(t[:1], off[:1], 10.0).size == 0


@pytest.mark.parametrize(("turning", "share"), [(0.0, 0.0), (0.8, 0.08)])
def test_what_a_model_reads_as_a_current_is_in_its_interval(turning, share):
    """3 % of the speed by the log, 1 degree of drift, and in a turn the sway constant; the filter's own covariance stays."""
    found = widened_current(KNOWN, np.ones(20), turning)
    by_model = 5.0 * np.sqrt(0.03**2 + np.deg2rad(1.0) ** 2 + share**2)
    assert found.current_std == pytest.approx(np.hypot(0.2, by_model))
    assert np.array_equal(found.covariance, KNOWN.covariance)


def test_without_an_estimated_current_nothing_is_said_of_it():
    known = Situation({"psi": 0.0, "u": 5.0}, ("psi",), np.array([[0.01]]))
    assert widened_current(known, np.ones(20), 0.5) is known and known.current_std is None


def estimated(fixes, log=0.0):
    """A Kalman filter of position and current, one component a column: times, currents and their variances."""
    step, drift, level = 1.0, 1e-4, 4.0
    carry, sees = np.array([[1.0, step], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    x, p = np.zeros((2, 2)), np.diag([level**2, 0.25])
    found = []
    for fix in fixes:
        x, p = carry @ x + np.array([[log * step], [0.0]]), carry @ p @ carry.T + np.diag([0.0, drift * step])
        gain = p @ sees.T / (sees @ p @ sees.T + level**2)
        x, p = x + gain @ (fix[None, :] - sees @ x), p - gain @ sees @ p
        found.append((x[1], p[1, 1]))
    currents, variances = (np.array(column) for column in zip(*found))
    return np.arange(len(fixes)) * step, currents, np.stack([variances] * 2, axis=1)


def test_a_current_that_moves_more_than_its_filter_expects_is_unsure():
    random, n = np.random.default_rng(8), 4000
    current = np.cumsum(random.standard_normal((n, 2)) * 0.01, axis=0)
    fixes = np.cumsum(current, axis=0) + 4.0 * random.standard_normal((n, 2))
    t, found, variance = estimated(fixes)
    windows = [slice(k, k + 60) for k in range(0, n - 60, 60)]
    drift = np.full(2, 1e-4)
    moved = np.array([moved_of_late(t[w], found[w], variance[w], drift) for w in windows])
    # On average a move is as large as the filter expects: what is beyond it is small beside what the filter states.
    squares = [((found[w][-1] - found[w]) ** 2 - variance[w] + variance[w][-1]).mean() for w in windows]
    assert np.mean(squares) == pytest.approx(1e-4 * 59 / 2, rel=0.25)
    assert np.sqrt(np.mean(moved**2)) < np.sqrt(variance[-1, 0])
    # The fixes lag behind by up to 40 m for a minute and a half: what seems to be a current of 0.7 m/s is unsure by about as much.
    lag = 40.0 * np.exp(-(((t - 2000.0) / 60.0) ** 2))
    _, seen, _ = estimated(fixes - lag[:, None])
    worst = int(np.argmax(np.abs(seen - found).max(axis=1)))
    late = slice(worst - 59, worst + 1)
    off = float(np.abs(seen[worst] - found[worst]).max())
    assert off > 5 * np.sqrt(variance[-1, 0])
    assert moved_of_late(t[late], seen[late], variance[late], drift) > 0.5 * off


def test_estimate_by_estimate_the_move_is_the_same():
    moves, t = CurrentMoves(20.0), np.arange(30.0)
    current = np.stack([0.5 + 0.02 * t, np.zeros(30)], axis=1)
    for k in range(30):
        known = replace(
            KNOWN,
            values={**KNOWN.values, "current_north": current[k, 0]},
            t=t[k],
            noise={"current_north": 0.01, "current_east": 0.01},
        )
        moved = moves.add(known)
    late = slice(9, 30)
    expected = moved_of_late(t[late], current[late], np.full((21, 2), 0.04), np.full(2, 1e-4))
    assert moved == pytest.approx(expected) and moved > 0.1
    told = widened_current(known, np.ones(20), 0.0, moved).current_std
    assert told == pytest.approx(np.hypot(widened_current(known, np.ones(20), 0.0).current_std, moved))
