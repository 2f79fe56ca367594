"""The design of a filter: what the settings say, read once; results hold it and no engine."""

from dataclasses import FrozenInstanceError, fields
from typing import Any

import numpy as np
import pytest

from shipid import ExtendedKalmanFilter, find_model
from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.quantity import constant, given, output, parameter, state
from shipid.estimation.design import FilterDesign, FilterSettings, design_filter
from shipid.estimation.errors import NotMeasurableError
from shipid.estimation.settings.defaults import own_sensors, standard_sensors
from shipid.models import Nomoto, PlanarMotion
from shipid.parts.sensors import FaultyGyro

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


def test_own_states_that_were_logged_are_sensors():
    """A shaft speed with noise of 0.02 rps on a slow change; one that is steady, or has a standard sensor, or is in no log, is none."""

    class Engine(Component):
        """A shaft behind its order."""

        n = state("1/s", "shaft speed")
        boost = state("1", "pressure of the charge air")
        r = state("rad/s", "rate of turn")
        order = given("1/s", "ordered shaft speed")
        T = parameter("s", "time constant", start=5.0, low=0.1, high=60)

        @n.rate
        def follow(self):
            """A lag."""
            return (self.order - self.n) / self.T

        @boost.rate
        def charge(self):
            """Made up."""
            return -self.boost / self.T

        @r.rate
        def turn(self):
            """Made up."""
            return -self.r / self.T

    model, t = join("engine", Engine), np.arange(2000.0)
    noisy = 2 + np.sin(t / 100) + np.random.default_rng(7).normal(0, 0.02, t.size)
    found = own_sensors(model, {"n": noisy, "r": noisy, "other": noisy})
    assert list(found) == ["n"] and found["n"] == (pytest.approx(0.02, rel=0.1), "1/s")
    assert own_sensors(model, {"n": np.full(10, 2.0), "boost": np.array([np.nan, 1.0])}) == {}
    clean = own_sensors(model, {"n": t})
    assert clean["n"] == (pytest.approx(1e-3 * t.std()), "1/s")


class Bubble(Component):
    """An instrument of the user's own."""

    r = given("rad/s", "rate of turn")
    heel_per_rate = constant("s", "heel for each rate of turn", default=2.0)
    bubble = output("rad", "inclinometer")
    level = output("rad", "spirit level", noise="0.1 deg")

    @bubble.equals
    def reading(self):
        """Made up."""
        return self.heel_per_rate * self.r

    @level.equals
    def other(self):
        """Made up."""
        return self.heel_per_rate * self.r


def test_an_output_of_its_own_stands_beside_the_standard_sensors():
    """A model with a leeway of its own was filtered by that alone, or not at all."""
    model, t = join("nomoto", Nomoto, PlanarMotion, Bubble), np.arange(200.0)
    columns = {"t": t, "psi": t, "r": np.sin(t), "bubble": np.sin(t), "level": np.sin(t)}
    assert set(standard_sensors(model, ("t", "psi", "r"))) == {"psi", "r"}
    assert set(standard_sensors(model, tuple(columns))) == {"psi", "r", "level"}
    assert list(own_sensors(model, columns)) == ["bubble"]
    assert standard_sensors(model, ("t", "bubble")) == {}
    with pytest.raises(NotMeasurableError, match=r"nothing that a sensor shows of model nomoto \(psi, r, .*bubble.*\)"):
        standard_sensors(model, ("t", "delta"))


def test_a_model_that_declares_its_instruments_says_itself_what_is_measured():
    model = join("nomoto", Nomoto, PlanarMotion, FaultyGyro, Bubble)
    assert set(standard_sensors(model, ("t", "psi", "r", "bubble"))) == {"gyro", "bubble"}
    assert own_sensors(model, {"bubble": np.arange(9.0)}) == {}
