"""The text of a fit."""

from __future__ import annotations

import numpy as np

import shipid
from shipid.identification.fit_text import noise_lines
from shipid.identification.search.noise_levels import NoiseLevels


def test_noise_is_said_to_three_digits_in_the_units_of_the_display():
    none = np.zeros(0)
    process, sensors = {"r": np.deg2rad(0.012345), "u": 0.0098765}, {"psi": np.deg2rad(0.23456)}
    levels = NoiseLevels(none, none, process, sensors, none, 0.0, True, "", 0)
    assert [" ".join(line.split()) for line in noise_lines(levels, shipid.find_model("de-keizer"))] == [
        "noise drives r: 0.0123 deg/s/s^0.5 (white, per root second)",
        "noise drives u: 0.00988 m/s/s^0.5 (white, per root second)",
        "noise sensor of psi: 0.235 deg in one sample",
    ]
