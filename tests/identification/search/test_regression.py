"""The equations of a problem as a regression."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import shipid
from shipid.identification.search.regression import make_regression


def test_a_stretch_shorter_than_a_window_has_no_equations():
    """It may stand between holes; the equations of the others are what they are without it."""
    trial = shipid.simulate("de-keizer", "soesterberg", "zigzag:20/20", noise="standard", sampling="2 s")
    fit = shipid.identify("de-keizer", [trial], ship="soesterberg", starts=1)
    regression = make_regression(fit.identified.solution.problem, 226.0 / 9.5)
    (block,) = regression.blocks
    equations = len(regression.equations)
    short = replace(
        block,
        states=np.zeros((0, 0)),
        inputs=block.inputs[:, :7],
        left=np.zeros((equations, 0)),
    )
    both = replace(regression, blocks=(block, short))
    theta = np.ones(both.size)
    (error, slope), (nothing, none) = both.rows(theta)
    assert nothing.shape == (equations, 0) and none.shape == (equations, 0, both.size)
    alone, alone_slope = regression.rows(np.ones(regression.size))[0]
    np.testing.assert_array_equal(error, alone)
    np.testing.assert_array_equal(slope[:, :, : len(regression.covered)], alone_slope[:, :, : len(regression.covered)])
