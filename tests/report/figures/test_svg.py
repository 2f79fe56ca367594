"""Figures as inline SVG."""

from __future__ import annotations

import re

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from shipid.report.figures.charts import Axes, Line, chart
from shipid.report.figures.svg import thin


@given(st.integers(1, 20_000), st.integers(0, 2**32 - 1))
def test_thinning_keeps_ends_and_extremes(n, seed):
    y = np.random.default_rng(seed).standard_normal(n)
    kept = thin(y)
    assert len(kept) <= 1000
    assert (np.diff(kept) > 0).all()
    assert kept[0] == 0
    assert kept[-1] == n - 1
    assert y[kept].min() == y.min()
    assert y[kept].max() == y.max()


def test_a_label_keeps_its_decimals_and_a_coordinate_two():
    """Of a logarithmic axis from 0.001: the label is no 0.00."""
    x = np.geomspace(0.001, 10.0, 50)
    text = str(chart([Axes("Gain", "dB", [Line("", x, 1 / x)])], "frequency [rad/s]", "key", "title", log=True))
    assert ">0.001<" in text and ">0.00<" not in text and ">10<" in text
    assert not re.search(r'd="[^"]*\.\d{3}', text)
