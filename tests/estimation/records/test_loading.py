"""The loading that a trial states drives a filter whose coefficients depend on it."""

from dataclasses import replace

import numpy as np

import shipid
from shipid.estimation.records.arrangement import columns_of
from shipid.trials.conditions import Conditions


def test_what_a_trial_states_of_its_loading_is_a_column() -> None:
    trial = shipid.simulate("nomoto", "soesterberg", "zigzag:20/20", sampling="4 s")
    stated = Conditions({"draught_forward": 7.0, "draught_aft": 9.0})
    loaded = replace(trial, source=replace(trial.source, conditions=stated))
    columns, _ = columns_of(loaded)
    assert np.all(columns["draught"] == 8.0) and columns["draught"].size == len(trial)
    assert "draught" not in columns_of(trial)[0]
