"""Coefficients of any model that change with the loading."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import UsageError
from shipid.generation.system import generate
from shipid.parameters.loading import at_loading, load_parts, value_at_loading


def test_a_coefficient_keeps_its_sign_by_a_power_or_changes_in_a_line():
    model = shipid.find_model("norrbin-draught")
    assert load_parts(model) == {"a": "a_draught", "b1": "b1_draught", "b3": "b3_draught"}
    system = generate(model)
    values = {
        "a": 2.0,
        "a_draught": 1.5,
        "b1": 0.3,
        "b1_draught": -1.0,
        "b3": 1.0,
        "b3_draught": 0.0,
        "draught_ref": 5.0,
    }
    u = [8.0 if n == "draught" else 0.0 for n in model.inputs]
    wanted = [value_at_loading(model, n) for n in ("a", "b1", "b3")]
    found = system.function(wanted)(np.zeros(4), u, [values[n] for n in system.coefficients]).full().ravel()
    assert found == pytest.approx([2.0 * 1.6**1.5, 0.3 - 0.6, 1.0])


def test_at_the_reference_it_is_the_model_without_it():
    plain, loaded = shipid.find_model("cross-flow"), shipid.find_model("cross-flow-draught")
    one, two = generate(plain), generate(loaded)
    numbers = {n: 0.5 + 0.01 * k for k, n in enumerate([*loaded.entries])} | {"draught": 5.0, "draught_ref": 5.0}
    rates = [
        s.right_hand_side(*([numbers[n] for n in names] for names in (s.states, s.inputs, s.coefficients))).full()
        for s in (one, two)
    ]
    assert rates[0] == pytest.approx(rates[1])


def test_gear_does_not_depend_on_the_loading():
    parts = load_parts(shipid.find_model("cubic-lag-delay-displacement"))
    assert {"t_delta", "delay"}.isdisjoint(parts) and "a" in parts
    assert "delta" in shipid.find_model("nomoto-draught-delay").delays


def test_it_is_data_and_made_once():
    model = shipid.find_model("nomoto-draught")
    assert pickle.loads(pickle.dumps(model)) == model
    assert at_loading(model, "displacement") is model


def test_what_cannot_depend_on_a_loading_is_refused():
    with pytest.raises(UsageError, match="draught or displacement"):
        at_loading(shipid.find_model("nomoto"), "trim")
    with pytest.raises(UsageError, match="no coefficient"):
        at_loading(shipid.find_model("constant-velocity"))
