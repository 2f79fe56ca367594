"""Where a trial is filtered, its file will do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import shipid

FILE = Path(__file__).parents[2] / "studies" / "trials" / "container-10-10.csv"
SENSORS = {"psi": "0.2 deg", "r": "0.02 deg/s"}


def test_the_file_of_a_trial_is_filtered_as_the_trial():
    kalman = shipid.ExtendedKalmanFilter("de-keizer", "soesterberg", measured=SENSORS)
    run = kalman.filter(str(FILE))
    assert np.array_equal(run.x, kalman.filter(shipid.read_trial(FILE)).x) and run.record == "container-10-10"


@pytest.mark.parametrize("file", [FILE, str(FILE)])
def test_the_file_of_a_trial_is_identified_from_sample_by_sample(file):
    one = shipid.identify_recursively("nomoto", file, method="ekf", ship="soesterberg")
    (same,) = shipid.identify_recursively("nomoto", [file], method="ekf", ship="soesterberg")
    assert one.text() == same.text()
