"""The equations of a problem as a regression."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import shipid
from shipid.identification.problem.box import Box
from shipid.identification.search.equation_error import instrumental_variables, least_squares
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
        states=block.states[:, :0],
        inputs=block.inputs[:, :0],
        intervals=np.zeros(0),
        left=np.zeros((equations, 0)),
    )
    both = replace(regression, blocks=(block, short))
    theta = np.ones(both.size)
    (error, slope), (nothing, none) = both.rows(theta)
    assert nothing.shape == (equations, 0) and none.shape == (equations, 0, both.size)
    alone, alone_slope = regression.rows(np.ones(regression.size))[0]
    np.testing.assert_array_equal(error, alone)
    np.testing.assert_array_equal(slope[:, :, : len(regression.covered)], alone_slope[:, :, : len(regression.covered)])


def test_instruments_are_run_for_the_stretches_that_have_equations():
    """One that is shorter than a window changes nothing, wherever it stands."""
    trial = shipid.simulate("de-keizer", "soesterberg", "zigzag:20/20", noise="standard", sampling="2 s")
    fit = shipid.identify("de-keizer", [trial], ship="soesterberg", starts=1)
    problem = fit.identified.solution.problem
    (data,) = problem.trials
    unknown = np.full(len(problem.estimated), np.nan)
    start = np.array([fit.parameters[n].value for n in problem.estimated])
    box = Box(start, np.where(start > 0, 1e-3, -np.inf), np.full(start.size, np.inf), unknown)
    found = []
    for trials in ((data,), (data, data.head(5))):
        regression = make_regression(replace(problem, trials=trials), 226.0 / 9.5)
        assert [block.left.shape[1] > 0 for block in regression.blocks] == [True, False][: len(trials)]
        refined = instrumental_variables(least_squares(regression, box), box)
        assert refined.converged
        found.append(refined.parameters(box))
    np.testing.assert_allclose(found[1], found[0], rtol=1e-6)
