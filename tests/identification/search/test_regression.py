"""The equations of a problem as a regression."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.trials.trial import Trial


@pytest.mark.parametrize("left", [3, 8])
def test_a_stretch_shorter_than_a_window_has_no_equations(left):
    """A hole in the rudder near the end leaves a few samples, too few for a rate of any state."""
    sailed = shipid.simulate("norrbin", "zeefakkel", "zigzag:20/20", noise="standard", sampling="1 s", duration="200 s")
    table = sailed.table.copy()
    end = len(table) - left
    table.loc[table.index[end - 30 : end], ["delta", "delta_order"]] = np.nan
    holed = Trial("holed", table, sailed.source)
    for method in ("output-error", "equation-error"):
        fit = shipid.identify("norrbin", [holed], ship="zeefakkel", starts=1, method=method)
        assert fit.parameters["K"].value == pytest.approx(0.5, rel=0.2)
