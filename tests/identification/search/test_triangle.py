"""The triangle of several trials, made trial by trial: that of all their residuals at once."""

import numpy as np
import pytest

import shipid
from shipid.identification.search.least_squares import triangle_of
from shipid.identification.search.trust_region import triangle


def test_trial_by_trial_is_all_at_once() -> None:
    trials = [
        shipid.simulate("nomoto", "soesterberg", f"zigzag:{angle}/10", sampling="4 s", noise="standard", seed=angle)
        for angle in (10, 20)
    ]
    fit = shipid.identify("nomoto", trials, ship="soesterberg", starts=1)
    problem, q = fit.identified.problem, fit.identified.solution.q * 1.01
    whole, parts = triangle(*problem.residuals(q)), triangle_of(problem, q)
    assert parts.shape == whole.shape
    product = whole.T @ whole
    assert parts.T @ parts == pytest.approx(product, abs=1e-9 * np.abs(product).max())
