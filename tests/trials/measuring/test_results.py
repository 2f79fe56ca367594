"""How measured quantities are shown."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.measuring.results.turning_circle import TurningCircle


@pytest.mark.parametrize(
    ("angle", "shown"),
    [
        (359.98, "000.0 deg"),
        (-0.02, "000.0 deg"),
        (359.9, "359.9 deg"),
        (90.0, "090.0 deg"),
        (7.3, "007.3 deg"),
        (725.0, "005.0 deg"),
    ],
)
def test_a_direction_is_shown_as_on_a_compass(angle, shown):
    found = TurningCircle(trial="log", execute="order", course=np.deg2rad(angle), drift_direction=np.deg2rad(angle))
    for name in ("course", "drift direction"):
        assert f"{name:<28s} {shown}" in found.text()


def test_a_moment_of_a_clock_that_counts_from_long_ago_keeps_its_hundredths():
    assert "259223.75 s" in TurningCircle(trial="log", execute="order", first_execute=259223.75).text()


def test_a_time_has_no_thousandths():
    assert " 9.7 s" in TurningCircle(trial="log", execute="order", first_execute=9.696).text()
