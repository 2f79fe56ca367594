"""Candidates carry what was measured: the wind of the log, and a lag behind an order."""

from __future__ import annotations

import dataclasses

import numpy as np

import shipid
from shipid.identification.choice.candidates import completed, holds_orders_only


def with_wind(trial: shipid.Trial) -> shipid.Trial:
    table = trial.table.assign(wind_speed=5.0, wind_direction=0.3)
    return dataclasses.replace(trial, table=table)


def stepped(trial: shipid.Trial) -> shipid.Trial:
    """The same with the order in the place of the rudder angle."""
    return dataclasses.replace(trial, table=trial.table.assign(delta=trial["delta_order"]).drop(columns="delta_order"))


def names(models: list[str], trial: shipid.Trial) -> list[str]:
    return [m.name for m in completed(models, [trial])]


def test_the_wind_is_in_every_candidate_that_can_carry_it_and_each_is_there_once(sail):
    trial = sail("de-keizer", "soesterberg")
    asked = ["cubic", "cubic-wind", "bech-slipstream", "nomoto"]
    assert names(asked, trial) == asked
    assert names(asked, with_wind(trial)) == ["cubic-wind", "bech-slipstream-wind", "nomoto-wind"]
    found = shipid.find_model("bech-slipstream-wind")
    assert {"wind_speed", "wind_direction"} <= set(found.inputs) and {"N_w", "N_w1", "F_w"} <= set(found.parameters)


def test_an_order_without_feedback_has_a_lag_behind_it(sail):
    trial = sail("de-keizer", "soesterberg")
    assert not holds_orders_only(trial) and holds_orders_only(stepped(trial))
    order = with_wind(stepped(trial))
    # A model without a lag of its own sees the order act late.
    assert names(["de-keizer", "cubic-wind", "cross-flow", "norrbin"], order) == [
        "de-keizer-lag-wind",
        "cubic-lag-wind",
        "cross-flow-wind",
        "norrbin-wind-delay",
    ]


def test_a_steady_rudder_is_no_order(sail):
    trial = sail("de-keizer", "soesterberg")
    assert not holds_orders_only(dataclasses.replace(trial, table=trial.table.assign(delta=np.zeros(len(trial)))))
