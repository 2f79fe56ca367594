"""How measured quantities are shown."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.measuring.results.turning_circle import TurningCircle


@pytest.mark.parametrize(
    ("angle", "shown"),
    [
        (359.98, "000.0"),
        (-0.02, "000.0"),
        (359.9, "359.9"),
        (90.0, "090.0"),
        (7.3, "007.3"),
        (725.0, "005.0"),
    ],
)
def test_a_direction_is_shown_as_on_a_compass(angle, shown):
    found = TurningCircle(trial="log", execute="order", course=np.deg2rad(angle), drift_direction=np.deg2rad(angle))
    assert f"{'course':<28s} {shown} deg" in found.text()
    whole = f"{round(float(shown)) % 360:03d} deg"
    assert f"{'drift direction':<28s} {whole}" in found.text(), "no circle shows it to a tenth"


def test_a_drift_has_the_digits_of_its_uncertainty_on_terminal_and_page():
    found = TurningCircle(trial="log", execute="order", drift_speed=0.49161, drift_uncertainty=0.46913)
    assert "drift speed                  0.49 m/s" in found.text()
    assert (
        found.told("drift_speed", 0.49161, "m/s") == "0.49"
        and found.told("drift_uncertainty", 0.46913, "m/s") == "0.47"
    )


def test_a_moment_of_a_clock_that_counts_from_long_ago_keeps_its_hundredths():
    assert "259223.75 s" in TurningCircle(trial="log", execute="order", first_execute=259223.75).text()


def test_a_time_has_no_thousandths():
    assert " 9.7 s" in TurningCircle(trial="log", execute="order", first_execute=9.696).text()
