"""Checks of a record: what unit a rate of turn seems to have, and the sign of the rudder with a wild sample in the record."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials import checks
from shipid.trials.errors import LooksLikeDegreesError

T = np.arange(0.0, 240.0, 0.5)
RATE = np.radians(1.5) * np.sin(T / 9)
HEADING = np.radians(13.5) * (1 - np.cos(T / 9))


@pytest.mark.parametrize(
    ("factor", "said", "seems"),
    [(60.0, "deg/s", "deg/min"), (1 / 60, "deg/min", "deg/s"), (60.0, "°/s", "deg/min"), (1 / 60, "DEG/MIN", "deg/s")],
)
def test_a_minute_taken_for_a_second(factor, said, seems):
    with pytest.raises(
        LooksLikeDegreesError, match=rf"column 'r': the unit says {said}, and the values look like {seems}"
    ):
        checks.check_angles({"t": T, "psi": HEADING, "r": factor * RATE}, {"psi": "deg", "r": said}, "log")


def test_degrees_taken_for_radians_are_still_told():
    with pytest.raises(
        LooksLikeDegreesError, match="column 'psi': the unit says degrees, and the values look like radians"
    ):
        checks.check_angles({"t": T, "psi": np.radians(HEADING), "r": RATE}, {"psi": "deg", "r": "deg/s"}, "log")


@pytest.mark.parametrize("row", [0, 1, 100, -2, -1])
@pytest.mark.parametrize("wild", [-1e3, 1e3])
@pytest.mark.parametrize("channel", ["delta", "r"])
def test_one_wild_sample_does_not_turn_the_rudder_over(row, wild, channel):
    delta = np.radians(20) * np.sign(np.sin(T / 15 + 0.2))
    r = np.zeros_like(T)
    for k in range(1, len(T)):
        r[k] = r[k - 1] + 0.5 / 12 * (0.08 * delta[k - 1] - r[k - 1])
    assert not checks.turns_to_port(T, delta, r)
    assert checks.turns_to_port(T, -delta, r)
    signals = {"delta": delta.copy(), "r": r.copy()}
    signals[channel][row] = wild
    assert not checks.turns_to_port(T, signals["delta"], signals["r"])
    signals["delta"] = -signals["delta"]
    assert checks.turns_to_port(T, signals["delta"], signals["r"])
