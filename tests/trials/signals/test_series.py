import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from shipid.trials.signals.series import maximum, value_at


@given(st.floats(-50, 50), st.floats(0.5, 20), st.floats(0.3, 0.7))
def test_maximum_of_a_parabola_is_exact(height, width, place):
    t = np.linspace(0, 10, 201)
    found = maximum(t, height - width * (t - 10 * place) ** 2, 0.2)
    assert found[0] == pytest.approx(10 * place, abs=0.02)
    assert found[1] == pytest.approx(height, abs=width * 0.02**2 + 1e-9)


def test_maximum_that_is_not_reached():
    t = np.linspace(0, 10, 201)
    assert maximum(t, t, 0.5) is None
    assert maximum(t[:3], t[:3], 0.5) is None
    slowed = maximum(t, 1 - np.exp(-t), 0.5)  # has all but come to rest
    assert slowed[1] == pytest.approx(1, abs=0.01)


def test_value_is_averaged():
    t = np.linspace(0, 10, 1001)
    noise = np.random.default_rng(0).normal(0, 1, len(t))
    assert value_at(t, 3 * t + noise, 5.0, 2.0, 1) == pytest.approx(15, abs=0.2)  # 4 sigma of 400 samples
    assert value_at(t, t**2, 5.0, 0.001) == pytest.approx(25, abs=1e-3)
