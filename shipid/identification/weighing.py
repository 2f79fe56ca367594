"""Weights for prediction: the error of a low-order model, or what a record shows beyond it, whichever is larger.

In a towing tank the structure of the model is what is wrong, and it is wrong by about the same shares for every ship. At sea
and on a pond waves, wind and current move the ship as well: a signal they disturb says less of the coefficients, and the
beliefs more.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipid.identification.solve import Box, Solution, minimise, noise_levels

#: Change of a weight below which it has settled, and how often it may change.
_SETTLED = 0.05
_TURNS = 4


def weigh_again(solution: Solution, box: Box, least: np.ndarray) -> Solution:
    """Return the solution under weights that are no firmer than its own residuals.

    Parameters
    ----------
    solution : Solution
        Found under the weights `least`.
    box : Box
        Bounds of the parameters.
    least : ndarray, shape (signals,)
        Standard deviation a signal is never believed beyond, SI.

    Returns
    -------
    Solution
        The same where every residual is within `least`.
    """
    for _ in range(_TURNS):
        sigma = np.maximum(least, noise_levels(solution))
        if np.abs(np.log(sigma / solution.problem.sigma)).max() < _SETTLED:
            break
        again = minimise(replace(solution.problem, sigma=sigma), solution.q, box, most=100, tolerance=1e-6)
        solution = replace(again, evaluations=solution.evaluations + again.evaluations)
    return solution
