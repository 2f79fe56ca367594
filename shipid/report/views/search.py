"""How the coefficients were searched for, as the page shows it: method, rungs, the doctor's findings, the posterior."""

from __future__ import annotations

from typing import Any

import numpy as np

from shipid.declaration.units import pretty
from shipid.identification.fit import Fit
from shipid.report.typography.numbers import fixed, given, number

_OUTPUT_ERROR = (
    "Output error: the model is run over the recorded rudder from an initial state of its own in each trial, and the "
    "coefficients are those that bring its signals closest to the measured ones."
)
_EQUATION_ERROR = (
    "Equation error: the coefficients are those that make the equations balance at the measured states, without running the "
    "model. Noise in the measured states biases them; the standard deviations count the scatter alone."
)
_LOSS = {
    "huber": "Huber's loss: residuals beyond 1.3 standard deviations of their signal count by their size, not its square.",
    "soft-l1": "The soft-l1 loss: large residuals count by their size, not its square.",
}


def method_view(fit: Fit) -> list[str]:
    """Return the method in sentences.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    chi = fit.chi_square
    used = next((r.method for r in fit.ladder if r.used), "output-error")
    regressed = used in ("equation-error", "instrumental-variables")
    lines = [f"Method: {fit.method}.", _EQUATION_ERROR if regressed else _OUTPUT_ERROR]
    if fit.loss in _LOSS:
        lines.append(_LOSS[fit.loss])
    return [
        *lines,
        f"The trials were run {fit.evaluations} times.",
        f"Mean squared weighted residual per degree of freedom: {number(chi, 3)} (1 where the noise levels are right)."
        if np.isfinite(chi)
        else "The weighted residual is not finite: the model ran away.",
        f"The search said: {fit.message}",
    ]


def ladder_view(fit: Fit) -> list[dict[str, Any]]:
    """Return one row for each method that was tried.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    return [
        {
            "method": r.method,
            "cost": "runs away" if r.cost is None else number(r.cost, 4),
            "converged": r.converged,
            "used": r.used,
            "reason": r.reason,
        }
        for r in fit.ladder
    ]


def findings_view(fit: Fit) -> list[dict[str, str]]:
    """Return one row for each thing the trials' doctor is sure of.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    return [
        {
            "trial": c.trial,
            "kind": c.finding.kind,
            "channel": c.finding.channel,
            "message": c.finding.message,
            "effect": c.finding.effect,
            "repair": c.finding.repair,
        }
        for c in (fit.assessment and fit.assessment.findings) or ()
    ]


def posterior_view(fit: Fit) -> dict[str, Any] | None:
    """Return the sampled posterior, or None where there is none.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    p = fit.posterior
    if p is None:
        return None
    rows = []
    for k, name in enumerate(p.names):
        ratio = p.width_over_gaussian(k)
        rows.append(
            {
                "name": name,
                "unit": pretty(p.units[k]),
                "median": given(float(f"{p.quantiles[2, k]:.5g}")),
                "interval": f"{p.quantiles[0, k]:.5g} to {p.quantiles[-1, k]:.5g}",
                "ratio": "–" if ratio is None else fixed(ratio, 2),
                "independent": f"{p.independent[k]:.0f}",
            }
        )
    return {"rows": rows, "draws": len(p.draws), "walkers": p.walkers, "mixed": p.mixed}
