"""Many runs at once against the record of each."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import UnknownNameError
from shipid.generation.ensemble import BLOCK, make_ensemble, steps_of
from shipid.generation.record import make_record


def test_runs_equal_records():
    """Different starts, inputs, coefficients and clocks, an input that varies: the last state of each run is its record's."""
    model = shipid.find_model("de-keizer")
    batch = make_ensemble(model, ("delta",))
    system, rng = batch.system, np.random.default_rng(2)
    runs, count = 5, 3 * BLOCK
    ship = shipid.find_ship("soesterberg").values(model, speed=9.5)
    p = system.vector(system.coefficients, ship)[:, None] * rng.uniform(0.9, 1.1, (len(system.coefficients), runs))
    x0 = np.zeros((len(system.states), runs))
    x0[system.states.index("u")] = rng.uniform(8, 10, runs)
    held = np.zeros((len(system.inputs), runs))
    held[system.inputs.index("cruise")] = 9.5
    intervals = rng.uniform(0.5, 2.0, runs)
    rudder = 0.1 * rng.standard_normal((1, count, runs))
    found = batch(x0, held, p, intervals, count, rudder)
    record = make_record(model, system.states, hold="zero")
    for k in range(runs):
        inputs = np.repeat(held[:, [k]], count + 1, axis=1)
        inputs[system.inputs.index("delta"), :count] = rudder[0, :, k]
        y, _ = record(x0[:, k], inputs, np.full(count + 1, intervals[k]), p[:, k])
        np.testing.assert_allclose(found[:, k], y[:, -1], rtol=1e-12, atol=1e-12)


def test_lengths_are_whole_blocks():
    assert [steps_of(n) for n in (0, 1, BLOCK, BLOCK + 1)] == [BLOCK, BLOCK, BLOCK, 2 * BLOCK]


def test_an_unknown_input():
    with pytest.raises(UnknownNameError, match="input of model de-keizer called 'sail'"):
        make_ensemble(shipid.find_model("de-keizer"), ("sail",))
