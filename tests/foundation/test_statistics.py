"""The shared statistics against SciPy and against their definitions."""

import math

import numpy as np
import pytest
from scipy import stats

from shipid.foundation.statistics import NORMAL_95, LjungBox, autocorrelation, interval_95, ljung_box, plain


def test_the_quantile_is_that_of_the_normal_distribution() -> None:
    assert stats.norm.ppf(0.975) == pytest.approx(NORMAL_95, rel=1e-15)
    assert interval_95(2.0, 1.0) == pytest.approx(stats.norm(2.0, 1.0).interval(0.95))


def test_numbers_for_json() -> None:
    assert plain(None) is plain(math.nan) is plain(math.inf) is None
    assert plain(np.float64(2.5)) == 2.5


def test_autocorrelation_by_its_definition() -> None:
    values = np.array([1.0, -2.0, 4.0, 0.5, 3.0])
    centred = values - values.mean()
    expected = [sum(centred[i] * centred[i + k] for i in range(5 - k)) / sum(centred**2) for k in (1, 2, 3)]
    assert autocorrelation(values, 3) == pytest.approx(expected)
    assert (autocorrelation(np.ones(9), 2) == 0).all()


def test_white_series_are_rejected_as_often_as_the_level_says() -> None:
    rng = np.random.default_rng(4)
    p = np.array([ljung_box(rng.standard_normal(400), 20).p_value for _ in range(2000)])
    # 2000 draws of a uniform number: the largest deviation of their distribution exceeds this once in a thousand.
    assert stats.kstest(p, "uniform").statistic < 1.95 / math.sqrt(2000) + 0.02  # the chi-square is asymptotic


def test_a_coloured_series_is_not_white() -> None:
    rng = np.random.default_rng(5)
    coloured = np.convolve(rng.standard_normal(500), [1.0, 0.5], "valid")
    found = ljung_box(coloured, 10)
    # The first autocorrelation of this moving average is 0.4: Q is near N 0.4^2 = 80 for one lag that matters.
    assert 40 < found.statistic < 160 and found.degrees == 10 and found.p_value < 1e-6


def test_tests_of_several_series_add_up() -> None:
    both = LjungBox(3.0, 2) + LjungBox(4.0, 3)
    assert both == LjungBox(7.0, 5)
    assert both.p_value == pytest.approx(stats.chi2.sf(7.0, 5))


def test_what_cannot_be_tested_has_no_degree_of_freedom() -> None:
    assert ljung_box(np.ones(50), 5) == ljung_box(np.arange(4.0), 0) == LjungBox(0.0, 0)
    assert LjungBox(math.inf, 3).p_value == 0.0
