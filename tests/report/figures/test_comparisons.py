"""A measured track beside predicted ones: calm, with the positions as logged faint beside it."""

from __future__ import annotations

import numpy as np

import shipid
from shipid.identification.validation.comparison import Comparison
from shipid.report.figures import comparisons
from shipid.report.figures.comparisons import track_drawing
from shipid.trials.manoeuvres.manoeuvre import Manoeuvre
from shipid.trials.trial import Trial


def _drawn(trial: Trial):
    comparison = Comparison(trial, {"x": trial["x"], "y": trial["y"]}, {}, shipid.measure(trial))
    drawing, _ = track_drawing({"predicted": comparison})
    return {line.get_label(): line for line in drawing.figure().axes[0].lines}


def test_a_measured_track_is_no_band_of_fixes():
    zigzag = Manoeuvre("zigzag", (np.radians(10.0), np.radians(10.0)))
    model = shipid.find_model("de-keizer")
    noisy, true = (
        shipid.simulate(model, "soesterberg", zigzag, sampling="1 s", noise=noise)
        for noise in ({"x": "8 m", "y": "8 m"}, None)
    )
    lines = _drawn(noisy)
    assert "position fixes" not in _drawn(true)
    measured = lines["measured"]
    assert len(lines["position fixes"].get_xdata()) <= 260
    length = [
        np.hypot(np.diff(a), np.diff(b)).sum()
        for a, b in ((measured.get_xdata(), measured.get_ydata()), (noisy["y"], noisy["x"]))
    ]
    sailed = np.hypot(np.diff(true["y"]), np.diff(true["x"])).sum()
    # Fixes of 8 m at each second make a path nearly twice as long as the ship's.
    assert length[0] < 1.05 * sailed < length[1]


def test_swings_that_last_few_fixes_are_drawn():
    """A fix every 6 s, and swings of about a minute: averaged over eleven fixes, a quarter of a swing was gone."""
    trial = shipid.simulate("nomoto", "zeefakkel", "zigzag:20/20", sampling="6 s")
    measured = _drawn(trial)["measured"]
    across = np.interp(trial["x"], measured.get_ydata(), measured.get_xdata())
    assert np.abs(across - trial["y"]).max() < 0.05 * np.ptp(trial["y"])


def test_positions_are_averaged_once(monkeypatch):
    calls = []
    smooth = comparisons.smooth_track
    monkeypatch.setattr(comparisons, "smooth_track", lambda *a: calls.append(1) or smooth(*a))
    zigzag = Manoeuvre("zigzag", (np.radians(10.0), np.radians(10.0)))
    trial = shipid.simulate(
        shipid.find_model("de-keizer"), "soesterberg", zigzag, sampling="1 s", noise={"x": "8 m", "y": "8 m"}
    )
    assert "position fixes" in _drawn(trial) and len(calls) == 1


def test_a_faint_mark_is_seen_in_the_legend_and_a_number_keeps_its_unit():
    zigzag = Manoeuvre("zigzag", (np.radians(10.0), np.radians(10.0)))
    trial = shipid.simulate(
        shipid.find_model("de-keizer"), "soesterberg", zigzag, sampling="1 s", noise={"x": "8 m", "y": "8 m"}
    )
    drawing, note = track_drawing({"predicted": Comparison(trial, {}, {}, shipid.measure(trial))})
    (legend,) = drawing.figure().legends
    marks = dict(zip([t.get_text() for t in legend.texts], legend.legend_handles))
    assert marks["position fixes"].get_markersize() > 3
    assert note.endswith("\u00a0s.")
