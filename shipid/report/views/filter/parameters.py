"""Parameters that a filter or a recursion estimates, as their pages show them."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.units import pretty
from shipid.estimation.estimate import Estimate
from shipid.foundation.numbers import interval, uncertain
from shipid.foundation.statistics import NORMAL_95
from shipid.report.figures.trials import Curve, Panel, halves
from shipid.report.page import Row, Section
from shipid.report.typography.quantities import named
from shipid.report.views.words import standing_remark, with_unit

#: Share of a record in which a filter settles: its bounds there would flatten the rest of a figure.
SETTLING = 0.2


class Estimating(Protocol):
    """A run that estimates parameters against time."""

    @property
    def t(self) -> np.ndarray:
        """Times in s."""

    @property
    def parameters(self) -> dict[str, Estimate]:
        """The last estimates by name."""

    def __getitem__(self, name: str) -> np.ndarray:
        """The estimates of one of them against time."""

    def std_of(self, name: str) -> np.ndarray:
        """Return their standard deviations.

        Parameters
        ----------
        name : str
            Of the parameter.
        """


def last_estimates(run: Estimating) -> list[str]:
    """Return a sentence with the last estimates; none where no parameter is estimated.

    Parameters
    ----------
    run : FilterRun or RecursiveIdentification
        The run.
    """
    last = [f"{n} = {with_unit(uncertain(p.value, p.std), p.unit)}" for n, p in run.parameters.items()]
    return [f"Estimates at the end: {'; '.join(last)}."] if last else []


def parameters_section(run: Estimating, model: Model) -> Section | None:
    """Return the section of the parameters; None where none is estimated.

    Parameters
    ----------
    run : FilterRun or RecursiveIdentification
        The run.
    model : Model
        The model the parameters belong to.
    """
    estimates = run.parameters
    if not estimates:
        return None
    panels = []
    for name in estimates:
        value, std = run[name], run.std_of(name)
        curves = [Curve("estimate", run.t, value)]
        curves += [Curve("95 % band", run.t, value + s * NORMAL_95 * std) for s in (-1, 1)]
        panels.append(Panel(name, pretty(model[name].unit), curves, SETTLING))
    figures = halves(panels, "parameters", "Estimated parameters against time")
    rows = [_row(p, model) for p in estimates.values()]
    return Section("Parameters", "filter/parameters.html", {"rows": rows, "figures": figures})


def _row(p: Estimate, model: Model) -> Row:
    return {
        "named": named(model, p.name),
        "value": uncertain(p.value, p.std),
        "unit": pretty(p.unit),
        "interval": interval(p.ci95, p.std),
        "determined": p.identifiable,
        "meaning": p.meaning,
        "remark": standing_remark(p),
    }
