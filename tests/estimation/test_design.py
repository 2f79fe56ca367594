"""The design of a filter: what the settings say, read once; results hold it and no engine."""

from dataclasses import FrozenInstanceError, fields
from typing import Any

import numpy as np
import pytest

from shipid import ExtendedKalmanFilter, find_model
from shipid.estimation.design import FilterDesign, FilterSettings, design_filter

SENSORS = {"psi": "0.2 deg", "r": "0.02 deg/s"}
SETTINGS = FilterSettings(measured=SENSORS, estimated=["K", "tau"])


@pytest.fixture(scope="module")
def design() -> FilterDesign:
    return design_filter("de-keizer", "soesterberg", SETTINGS)


def test_a_design_never_changes(design: FilterDesign) -> None:
    with pytest.raises(FrozenInstanceError):
        design.p = design.q  # type: ignore[misc]


def test_the_constructor_makes_the_same_design(design: FilterDesign) -> None:
    made = ExtendedKalmanFilter(find_model("de-keizer"), "soesterberg", measured=SENSORS, estimated=["K", "tau"]).design
    assert made.fingerprint == design.fingerprint
    assert {f.name for f in fields(FilterSettings)} == set(ExtendedKalmanFilter.__init__.__kwdefaults__)
    defaults = {f.name: f.default for f in fields(FilterSettings)}
    assert ExtendedKalmanFilter.__init__.__kwdefaults__ == defaults


def test_a_loop_is_generated_once(design: FilterDesign) -> None:
    assert design.loop() is design.loop() and design.loop(full=True) is not design.loop()
    assert design.backward is design.backward and design.gramian is design.gramian


def test_constants_in_the_order_of_the_step(design: FilterDesign) -> None:
    places = design.layout.constants
    assert design.constants[places["p"]] == pytest.approx(design.p)
    assert design.constants[places["q"]] == pytest.approx([s.level for s in design.sources])
    assert design.constants[places["r"]] == pytest.approx(np.deg2rad([0.2, 0.02]))


def test_results_hold_the_design_and_no_engine(design: FilterDesign, swing: Any) -> None:
    kalman = ExtendedKalmanFilter("de-keizer", "soesterberg", measured=SENSORS, estimated=["K", "tau"])
    t = np.arange(60.0)
    run = kalman.filter({"t": t, "delta": swing(t), "psi": 0 * t, "r": 0 * t, "cruise": np.full(60, 9.5)})
    last = kalman.start().update({"t": 0.0, "delta": 0.0, "psi": 0.0, "r": 0.0, "cruise": 9.5})
    for result in (run, kalman.smooth(run), kalman.observability(run), last):
        held = [getattr(result, f.name) for f in fields(result)]
        assert not any(callable(v) or isinstance(v, ExtendedKalmanFilter) for v in held)
        holder = getattr(result, "run", result)
        assert holder.design is kalman.design
