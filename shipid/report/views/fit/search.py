"""How the coefficients were searched for, as the page shows it: noise and method, the doctor's findings, the posterior."""

from __future__ import annotations

import numpy as np

from shipid.declaration.units import pretty
from shipid.foundation.numbers import fixed, number, probability
from shipid.identification.fit import Fit
from shipid.report.page import Row, Section
from shipid.report.typography.quantities import shown

_OUTPUT_ERROR = (
    "Output error: the model is run over the recorded rudder from an initial state of its own in each trial, and the "
    "coefficients are those that bring its signals closest to the measured ones."
)
_EQUATION_ERROR = (
    "Equation error: the coefficients are those that make the equations balance at the measured states, without running the "
    "model. Noise in the measured states biases them; the standard deviations count the scatter alone."
)
_LOSS = {
    "huber": "Huber's loss: residuals beyond 1.3 standard deviations of their signal enter by their size, not its square.",
    "soft-l1": "The soft-l1 loss: large residuals enter by their size, not its square.",
}


def noise_section(fit: Fit) -> Section:
    """Return the section of the noise of the signals, and of the method.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    ladder = [
        {
            "method": r.method,
            "cost": "runs away" if r.cost is None else number(r.cost, 4),
            "converged": "yes" if r.converged else "no",
            "used": "yes" if r.used else "no",
            "reason": r.reason,
        }
        for r in fit.ladder
    ]
    view = {"signals": _signals(fit), "method": _method(fit), "ladder": ladder}
    return Section("Noise and method", "fit/noise.html", view, folded=True)


def check_section(fit: Fit) -> Section | None:
    """Return the section of what the trials' doctor found; None where it was not asked.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    if fit.assessment is None or fit.assessment.findings is None:
        return None
    rows = [
        {
            "trial": c.trial,
            "kind": f"{c.finding.kind} ({c.finding.channel})",
            "message": c.finding.message,
            "effect": c.finding.effect,
            "repair": c.finding.repair,
        }
        for c in fit.assessment.findings
    ]
    return Section("What the check of the trials found", "fit/check.html", {"findings": rows}, short="Check")


def posterior_section(fit: Fit) -> Section | None:
    """Return the section of the sampled posterior; None where it was not sampled.

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
                "median": number(float(p.quantiles[2, k]), 4),
                "interval": f"{number(float(p.quantiles[0, k]), 4)} to {number(float(p.quantiles[-1, k]), 4)}",
                "ratio": "" if ratio is None else fixed(ratio, 2),
                "independent": f"{p.independent[k]:.0f}",
            }
        )
    view = {"rows": rows, "draws": len(p.draws), "walkers": p.walkers, "mixed": p.mixed}
    return Section("Sampled posterior", "fit/posterior.html", view, folded=True)


def _signals(fit: Fit) -> list[Row]:
    residuals = fit.assessment.residuals if fit.assessment else {}
    rows: list[Row] = []
    for name, level in fit.noise.items():
        how, found = shown(fit.model, name), residuals.get(name)
        row: Row = {"label": how.label, "level": how.number(level), "unit": how.unit}
        if found is None:
            rows.append({**row, "effective": "none", "time": "", "p": "", "white": None, "chi": ""})
            continue
        rows.append(
            {
                **row,
                "effective": f"{found.effective:.0f} of {found.samples}",
                "time": number(found.autocorrelation_time_s, 2),
                "p": probability(found.p_value),
                "white": found.white,
                "chi": number(found.chi_square, 3),
            }
        )
    return rows


def _method(fit: Fit) -> list[str]:
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
        f"The search ended: {fit.message}",
    ]
