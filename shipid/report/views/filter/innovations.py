"""The innovations of a filter or a recursion, as their pages show them."""

from __future__ import annotations

import numpy as np

from shipid.foundation.numbers import probability
from shipid.foundation.statistics import NORMAL_95, WHITE
from shipid.report.figures.trials import Curve, Panel
from shipid.report.page import Row
from shipid.report.typography.quantities import Shown
from shipid.report.views.filter.parameters import SETTLING


def innovation_row(how: Shown, values: np.ndarray, white_p: float | None, **others: str) -> Row:
    """Return a row of the table of innovations.

    Parameters
    ----------
    how : Shown
        How the signal is shown.
    values : ndarray
        The innovations that were taken, in the unit inside.
    white_p : float or None
        Probability that white ones look so.
    **others : str
        What else the row holds: samples, rejected, nis, band.
    """
    rms = how.number(float(np.sqrt(np.mean(values**2)))) if values.size else ""
    return {
        "label": how.label,
        "unit": how.unit,
        "rms": rms,
        "p": "" if white_p is None else probability(white_p),
        "white": None if white_p is None else white_p >= WHITE,
        **others,
    }


def innovation_panel(how: Shown, t: np.ndarray, values: np.ndarray, variances: np.ndarray) -> Panel:
    """Return innovations against time, with the bounds that hold 95 % of them.

    Parameters
    ----------
    how : Shown
        How the signal is shown.
    t, values, variances : ndarray, shape (n,)
        Times in s, innovations and their expected variances, in the unit inside.
    """
    bound = NORMAL_95 * np.sqrt(variances) * how.factor
    curves = [Curve("innovation", t, values * how.factor)]
    curves += [Curve("95 % bounds", t, s * bound) for s in (-1, 1)]
    return Panel(f"Innovation, {how.label.lower()}", how.unit, curves, SETTLING)
