"""A log that falls silent: what its tracks say across the silence is told, and a slow or patchy log is none."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.encounter.plots.plots import make_plots
from shipid.encounter.tracking.track import track


def told(t):
    rng = np.random.default_rng(1)
    plots = make_plots(t, 2000 - 3 * t + rng.normal(0, 8, t.size), 500 + 2 * t + rng.normal(0, 8, t.size))
    found = track(plots)
    return found, [w for w in found.warnings if w.kind == "silent-log"]


def test_a_track_that_goes_on_behind_a_silence():
    found, (said,) = told(np.r_[np.arange(0, 200, 3.0), np.arange(300, 500, 3.0)])
    assert len(found.tracks) == 1 and said.serious and said.known["seconds"] == 102 and said.known["tracks"] == [1]
    assert "from 198 to 300 s" in said


@pytest.mark.parametrize(
    "t",
    [
        np.arange(0, 500, 3.0),
        np.r_[np.arange(0, 200, 3.0), np.arange(225, 500, 3.0)],  # eight scans missed
        np.arange(0, 6000, 60.0),  # a slow log
    ],
)
def test_no_silence(t):
    assert not told(t)[1]
