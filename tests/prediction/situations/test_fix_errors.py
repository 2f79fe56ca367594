"""The current is as unsure as the errors of the fixes that it was estimated from."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.prediction.situations.fix_errors import FixErrors, stretch_squares, widened_current
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
