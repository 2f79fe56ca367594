"""A model without the states that have no influence on what is asked for."""

from __future__ import annotations

import numpy as np

import shipid
from shipid.generation.record import make_record
from shipid.generation.reduction import reduced


def test_positions_do_not_matter_to_a_heading():
    model = shipid.find_model("de-keizer")
    small = reduced(model, ("psi", "u"))
    assert set(model.states) - set(small.states) == {"x", "y"}
    assert small.parameters == model.parameters and small.inputs == model.inputs


def test_the_rest_moves_as_before():
    model = shipid.find_model("de-keizer")
    small = reduced(model, ("psi", "u"))
    ship = shipid.find_ship("soesterberg")
    runs = []
    for m in (model, small):
        record = make_record(m, ("psi", "u"), compiled=False)
        system = record.system
        u = np.zeros((len(system.inputs), 200))
        u[system.inputs.index("delta")] = 0.2
        u[system.inputs.index("cruise")] = 9.5
        x0 = system.vector(system.states, {"u": 9.5}, default=0.0)
        p = system.vector(system.coefficients, ship.values(m, speed=9.5))
        runs.append(record(x0, u, np.full(200, 1.0), p)[0])
    np.testing.assert_array_equal(runs[0], runs[1])


def test_nothing_is_left_out_of_what_is_needed():
    model = shipid.find_model("de-keizer")
    assert reduced(model, ("x",)) is model or "y" not in reduced(model, ("x",)).states
