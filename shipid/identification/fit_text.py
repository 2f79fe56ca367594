"""A fit in plain text, as it is printed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.units import factor, pretty
from shipid.declaration.vocabulary import FIELDS

if TYPE_CHECKING:
    from shipid.identification.fit import Estimate, Fit
    from shipid.identification.search.ladder import Rung


def text_of(fit: Fit) -> str:
    """Return a fit in lines of text.

    Parameters
    ----------
    fit : Fit
        The fit.
    """
    state = "converged" if fit.converged else f"NOT CONVERGED: {fit.message}"
    lines = [f"{fit.model.name} fitted to {', '.join(c.trial.name for c in fit.fitted)} ({fit.method}; {state})"]
    lines += [
        f"  {e.name:<10s} {_value_text(e)}" + ("" if e.identifiable else f"   not determined: {e.why}")
        for e in fit.parameters.values()
    ]
    for c in (*fit.fitted, *fit.validation):
        role = "fitted   " if c in fit.fitted else "predicted"
        lines.append(f"  {role}  {c.trial.name}: rms error {', '.join(_error_text(s, v) for s, v in c.rmse.items())}")
        if c.refitted:
            again = ", ".join(_error_text(s, v) for s, v in c.refitted.items())
            lines.append(f"             with rudder bias and initial state refitted: {again}")
        if c.overshoots:
            pairs = zip(c.overshoots, c.predicted_overshoots)
            shown = ", ".join(f"{np.rad2deg(m):.1f} / {'-' if p is None else f'{np.rad2deg(p):.1f}'}" for m, p in pairs)
            lines.append(f"             overshoots measured / predicted: {shown} deg")
    if len(fit.ladder) > 1:
        lines += [f"  tried     {_rung_text(r)}" for r in fit.ladder]
    if fit.levels is not None:
        lines += [f"  noise     {line}" for line in _levels_text(fit)]
    lines += [f"  check     {f}" for f in fit.findings]
    if fit.posterior is not None:
        lines += ["  " + line for line in repr(fit.posterior).splitlines()]
    return "\n".join(lines)


def _levels_text(fit: Fit) -> list[str]:
    assert fit.levels is not None
    units = {n: fit.model[n].unit for n in (*fit.levels.process, *fit.levels.sensors)}

    def shown(name: str, level: float) -> tuple[float, str]:
        wanted = units[name].replace("rad", "deg") if "/rad" not in units[name] else units[name]
        return level / factor(wanted, units[name]), wanted

    lines = []
    for name, level in fit.levels.process.items():
        value, unit = shown(name, level)
        lines.append(f"drives {name}: {value:.3g} {unit}/s^0.5 (white, per root second)")
    for name, level in fit.levels.sensors.items():
        value, unit = shown(name, level)
        lines.append(f"sensor of {name}: {value:.3g} {unit} in one sample")
    return lines


def _rung_text(rung: Rung) -> str:
    cost = "runs away" if rung.cost is None else f"cost {rung.cost:.4g}"
    state = ", used" if rung.used else ""
    return f"{rung.method} ({cost}{'' if rung.converged else ', not converged'}{state}): {rung.reason}"


def _value_text(e: Estimate) -> str:
    """A value with two digits of its standard deviation, and its unit."""
    if e.value is None:
        return "runs to infinity"
    unit = "" if pretty(e.unit) == "1" else f" {pretty(e.unit)}"
    if not e.std:
        return f"{e.value:.6g}{unit}"
    decimals = 1 - int(np.floor(np.log10(e.std)))
    # Past six decimals or six figures before the point, powers of ten read better.
    if 0 <= decimals <= 6 and abs(e.value) < 1e6:
        return f"{e.value:.{decimals}f} ± {e.std:.{decimals}f}{unit}"
    figures = max(1, int(np.floor(np.log10(max(abs(e.value), e.std)))) + decimals + 1)
    return f"{e.value:.{min(figures, 12)}g} ± {e.std:.2g}{unit}"


def _error_text(signal: str, error: float) -> str:
    """An error of a signal in the unit people read it in."""
    if not np.isfinite(error):
        return f"{signal} runs away"
    shown = FIELDS[signal].display if signal in FIELDS else ""
    inside = FIELDS[signal].unit if signal in FIELDS else ""
    return f"{signal} {error * (factor(inside, shown) if shown else 1.0):.3g} {pretty(shown)}"
