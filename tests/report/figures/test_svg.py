"""Figures as inline SVG."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

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
