"""Figures of manoeuvres: what cannot be drawn is left out."""

import numpy as np

import shipid
from shipid.report.figures.manoeuvres import manoeuvre_figure
from shipid.trials.manoeuvres.manoeuvre import Manoeuvre
from shipid.trials.trial import Trial


def test_a_circle_whose_heading_never_turns_to_its_side_is_not_drawn():
    turn = Manoeuvre("turn", (np.radians(35.0), np.radians(200.0)))
    trial = shipid.simulate(shipid.find_model("norrbin"), "zeefakkel", turn, sampling="1 s")
    measures = shipid.measure(trial)
    assert manoeuvre_figure(measures, trial, None, "m") is not None
    frame = trial.to_frame()
    frame["psi [deg]"] = 360 - frame["psi [deg]"]
    assert manoeuvre_figure(measures, Trial.from_frame(frame), None, "m") is None
