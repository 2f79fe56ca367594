"""The score of the likelihood as a generated function: a filter step with the sensitivities of all it carries.

Estimate, covariance and their derivatives by unknowns run along inside one step, as in `shipid.generation.record`: one pass
over the record, compiled once whatever its length. Fisher's expected information, from the first derivatives of the
innovations and their variances, is summed up with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import casadi as ca
import numpy as np

from shipid.estimation.recursion import covariance_form
from shipid.estimation.recursion.equations import Equations
from shipid.estimation.recursion.layout import StepLayout, StepSettings
from shipid.estimation.recursion.step import make_filter_step
from shipid.foundation.aliases import CasadiFunction


@dataclass(frozen=True)
class Unknown:
    """Where an unknown of the likelihood stands in the vectors of the step.

    Attributes
    ----------
    kind : {"constant", "level", "state", "input"}
        A coefficient, the logarithm of a noise level (both among the constants), a first state, or what is added to an input.
    at : int
        Its index there.
    """

    kind: Literal["constant", "level", "state", "input"]
    at: int


def bare(settings: StepSettings) -> StepSettings:
    """Return settings whose step has derivatives: in covariance form, without gate and bounds.

    Parameters
    ----------
    settings : StepSettings
        What the filter's step does.
    """
    unbounded = np.full(settings.low.shape, np.inf)
    return replace(settings, form="covariance", gate=None, low=-unbounded, high=unbounded)


def make_score_step(
    equations: Equations, settings: StepSettings, unknowns: Sequence[Unknown], innovations: bool = False
) -> CasadiFunction:
    """Generate the step ``(carried, control, constants) -> (carried, [log-likelihood, its gradient])``.

    Parameters
    ----------
    equations : Equations
        The model.
    settings : StepSettings
        See `bare`.
    unknowns : sequence of Unknown
        What the likelihood is differentiated by.
    innovations : bool
        Whether the outputs are, instead, for each sensor whether a sample is there, its innovation in standard deviations, and the
        derivatives of that (of the innovation alone), unknown by unknown.

    Returns
    -------
    casadi.Function
        Carried are what the filter carries, its sensitivities column by column, and the packed triangle of the information.
    """
    step, layout = make_filter_step(equations, settings), StepLayout(equations, settings)
    size = len(unknowns)
    z, control, constants = (ca.SX.sym(n, step.size1_in(i)) for i, n in enumerate(("z", "c", "k")))
    carried = ca.SX.sym("S", z.shape[0], size)
    information = ca.SX.sym("I", covariance_form.size(size))
    by_control, by_constant = ca.SX(control.shape[0], size), ca.SX(constants.shape[0], size)
    for j, unknown in enumerate(unknowns):
        if unknown.kind == "constant":
            by_constant[unknown.at, j] = 1.0
        elif unknown.kind == "level":
            by_constant[unknown.at, j] = constants[unknown.at]
        elif unknown.kind == "input":
            by_control[layout.control["u"].start + unknown.at, j] = 1.0
    z_next, out = step(z, control, constants)
    e, spread, fate = (out[layout.brief[n]] for n in ("e", "S", "fate"))
    everything, moved = ca.vertcat(z, control, constants), ca.vertcat(carried, by_control, by_constant)
    shown = ca.vertcat(z_next, out[layout.brief["ll"]], e, spread)
    slopes = ca.jtimes(shown, everything, ca.densify(moved)) if size else ca.SX(shown.shape[0], 0)
    n, m = z.shape[0], layout.sensors
    by_e, by_spread = slopes[n + 1 : n + 1 + m, :], slopes[n + 1 + m :, :]
    gained = ca.SX.zeros(size, size)
    for i in range(m):
        mean, variance = by_e[i, :], by_spread[i, :]
        gained += fate[i] * ((mean.T @ mean) / spread[i] + (variance.T @ variance) / (2 * spread[i] ** 2))
    following = ca.vertcat(z_next, ca.vec(slopes[:n, :]), information + covariance_form.pack(gained))
    outputs = ca.vertcat(shown[n], slopes[n, :].T)
    if innovations:
        root = ca.sqrt(spread)
        outputs = ca.vertcat(fate, fate * e / root, ca.vec(by_e * ca.repmat(fate / root, 1, size)))
    following, outputs = ca.cse([ca.densify(following), ca.densify(outputs)])
    return ca.Function(
        "score_step", [ca.vertcat(z, ca.vec(carried), information), control, constants], [following, outputs]
    )
