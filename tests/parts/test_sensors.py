"""What the standard sensors are said to be worth."""

import numpy as np
import pytest

from shipid.parts.sensors import standard_noise


def test_standard_noise() -> None:
    degree = np.pi / 180
    assert standard_noise() == pytest.approx({"psi": 0.2 * degree, "r": 0.02 * degree, "u": 0.1, "x": 10.0, "y": 10.0})
