"""The text of a fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import shipid
from shipid.declaration.vocabulary import shown_error
from shipid.identification.fit_text import fit_words, noise_lines
from shipid.identification.search.noise_levels import NoiseLevels
from shipid.report.typography.quantities import shown_field
from shipid.trials.conditions import Conditions


def test_noise_is_said_to_three_digits_in_the_units_of_the_display():
    none = np.zeros(0)
    process, sensors = {"r": np.deg2rad(0.012345), "u": 0.0098765}, {"psi": np.deg2rad(0.23456)}
    levels = NoiseLevels(none, none, process, sensors, none, 0.0, True, "", 0)
    assert [" ".join(line.split()) for line in noise_lines(levels, shipid.find_model("de-keizer"))] == [
        "noise drives r: 0.0123 deg/s/s^0.5 (white, per root second)",
        "noise drives u: 0.00988 m/s/s^0.5 (white, per root second)",
        "noise sensor of psi: 0.235 deg in one sample",
    ]


def test_trials_at_several_loadings_are_not_pooled_in_silence(drift, drifting):
    """One set of coefficients for two ships: the notice names the trials and what they state."""
    trials = [drifting(np.deg2rad(0.5), 120, seed=seed)[0] for seed in (1, 2)]
    stated = [
        replace(t, name=name, source=replace(t.source, conditions=Conditions({"displacement": mass})))
        for t, name, mass in zip(trials, ("light", "laden"), (520e3, 610e3))
    ]
    told = [w for w in shipid.identify(drift, stated, starts=1).warnings if w.kind == "loadings"]
    assert len(told) == 1
    assert "displacement 520 t (light), 610 t (laden)" in told[0]
    assert not told[0].serious
    alone = shipid.identify(drift, stated[:1], starts=1, validate=stated[1:])
    assert "loadings  the trials state different loadings" in alone.text()
    assert not [w for w in shipid.identify(drift, trials, starts=1).warnings if w.kind == "loadings"]


def test_a_fit_of_nothing_has_no_sign():
    assert fit_words(-0.01) == "0.0 %" and fit_words(-0.06) == "-0.1 %"


@pytest.mark.parametrize("error", [np.deg2rad(0.2), np.deg2rad(0.02), np.deg2rad(1.234567), np.deg2rad(120.0)])
def test_an_error_reads_the_same_on_the_terminal_and_on_the_page(error):
    assert shown_error(error, "psi") == f"{shown_field('psi').number(error)} deg"
