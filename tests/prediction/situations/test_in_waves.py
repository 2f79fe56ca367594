"""Waves make uncertain what instruments show, by the motion that the component of waves has."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import UsageError
from shipid.generation.simulator import make_simulator
from shipid.parts.waves import Waves
from shipid.prediction.situations.in_waves import in_waves
from shipid.trials.manoeuvres.sea import wave_noise

KNOWN = {"psi": 0.5, "u": 9.0, "r": 0.0}


@pytest.mark.parametrize("direction", [0.5, 0.5 + np.pi, 2.0])
def test_the_spread_is_that_of_the_simulated_waves(direction):
    """In following, head and beam seas, over two hours: a narrow band has few independent samples, so within 15 %."""
    found = in_waves(KNOWN, ("psi", "r"), (np.deg2rad(0.5), direction), 220.0, 9.0)
    whole = shipid.join("in waves", shipid.models.PlanarMotion, Waves)
    t = np.arange(0.0, 7200.0, 0.1)
    noise = wave_noise(t.size, np.array([0.1]), 1, frequency=0.6, heading=np.deg2rad(0.5))[:, 0]
    acting = {"u": 9.0, "r": 0.0, "wave_noise": noise, "wave_direction": direction}
    known = {"wave_frequency": 0.6, "wave_damping": 0.15, "g": 9.81}
    run = make_simulator(whole, ("psi_wave", "r_wave"), hold="zero", compiled=False)(t, known, acting, {"psi": 0.5})
    assert found.std_of("psi") == pytest.approx(np.std(run["psi_wave"][2000:]), rel=0.15)
    assert found.std_of("r") == pytest.approx(np.std(run["r_wave"][2000:]), rel=0.15)


def test_only_what_is_read_is_uncertain():
    found = in_waves(KNOWN, ("psi", "u"), ("0.5 deg", "0 deg"), 220.0, 9.0)
    assert found.uncertain == ("psi",) and found.std_of("r") == 0.0
    with pytest.raises(UsageError, match="give it in the state"):
        in_waves(KNOWN, ("u",), ("0.5 deg", "0 deg"), 220.0, 9.0)
    with pytest.raises(UsageError, match="a size"):
        in_waves(KNOWN, ("psi",), (-0.1, 0.0), 220.0, 9.0)
