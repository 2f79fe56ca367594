"""Where a stretch of a record begins: what its own samples and those of the record say of the state, and how well."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from shipid import Trial, find_model
from shipid.identification.problem.trial_data import prepare, with_whole_inputs

SIGNALS = ("psi", "r", "u")
UNIT_TIME = 20.0
RATE = 0.01  #: rad/s, of a steady turn from 20 s on


def turning(missing: dict[str, tuple[float, float]]) -> Trial:
    """A steady turn at 1 Hz after 20 s of straight course, without what is missing."""
    t = np.arange(0.0, 200.0)
    turned = np.maximum(t - 20.0, 0.0)
    values = {"psi": RATE * turned, "r": np.where(turned > 0, RATE, 0.0), "u": 5.0 - 1.0 * (1 - np.exp(-turned / 10))}
    values["delta"] = np.where(turned > 0, 0.2, 0.0)
    for name, (begin, end) in missing.items():
        values[name] = np.where((t >= begin) & (t < end), np.nan, values[name])
    units = {"t": "s", "psi": "rad", "r": "rad/s", "u": "m/s", "delta": "rad"}
    return Trial.from_frame(pd.DataFrame({"t": t} | values), name="turn", units=units)


def second_stretch(missing: dict[str, tuple[float, float]]):
    """What lies behind a hole in the rudder from 60 to 100 s."""
    model, trial = find_model("de-keizer"), turning({"delta": (60.0, 100.0), **missing})
    stretch = with_whole_inputs(model, trial, SIGNALS, UNIT_TIME)[-1]
    assert stretch["t"][0] == 100.0
    return prepare(model, stretch, SIGNALS, None, UNIT_TIME, trial)


def test_samples_from_the_beginning_are_as_good_as_their_noise():
    data = second_stretch({})
    assert data.start["psi"] == pytest.approx(0.8) and data.start_std["psi"] < 1e-9


@pytest.mark.parametrize("late", [3.0, 30.0])
def test_the_state_moves_on_until_the_first_sample(late):
    """An estimate from late samples may be off by what the fastest change of the record makes of the time between."""
    data = second_stretch({"psi": (100.0, 100.0 + late)})
    assert data.start_std["psi"] == pytest.approx(RATE * late)
    assert abs(data.start["psi"] - 0.8) <= RATE * late + 1e-9


def test_the_nearest_sample_of_the_record_counts_where_the_stretch_has_none():
    data = second_stretch({"psi": (98.0, 200.0)})
    assert data.start["psi"] == pytest.approx(0.77) and data.start_std["psi"] == pytest.approx(3 * RATE)


def test_the_speed_before_the_manoeuvre_is_that_of_the_record():
    """A stretch begins in the middle of the turn; how fast the ship came to the turn is known as well as ever."""
    data = second_stretch({})
    cruise = find_model("de-keizer").inputs.index("cruise")
    assert data.inputs[cruise] == pytest.approx(np.full(data.inputs.shape[1], 5.0))
    assert data.approached and not data.settled
