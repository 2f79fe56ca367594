"""Many runs at once against the record of each."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import UnknownNameError
from shipid.generation.ensemble import BLOCK, make_ensemble, run_many, steps_of
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


def test_runs_that_threads_share_stand_in_their_order(monkeypatch):
    """Seven runs for three threads, none of which has as many as another two: each is what it is by itself."""
    monkeypatch.setattr("shipid.generation.ensemble._WORTH_THREADS", 1)
    monkeypatch.setattr("os.cpu_count", lambda: 3)
    model = shipid.find_model("nomoto")
    record = make_record(model, ("psi", "r"))
    values = shipid.find_ship("zeefakkel").values(model, speed=5.0)
    runs, count = 7, 50
    inputs = np.broadcast_to(np.linspace(0.0, 0.3, runs)[:, None, None], (runs, len(model.inputs), count))
    x0 = np.zeros((runs, len(model.states)))
    p = np.tile(record.system.vector(record.system.coefficients, values), (runs, 1))
    bias = 0.01 * np.arange(runs)[:, None] * np.ones(len(model.inputs))
    y, _ = run_many(record, x0, inputs, np.full(count, 1.0), p, bias)
    alone = [record(x0[k], inputs[k], np.full(count, 1.0), p[k], bias[k])[0] for k in range(runs)]
    np.testing.assert_array_equal(y, alone)
    assert len({float(one[0, -1]) for one in y}) == runs
