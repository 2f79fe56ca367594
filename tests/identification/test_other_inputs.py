"""Models that no rudder steers, and models with a steering machine of their own, are fitted to a log of what moves them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from shipid import Component, ExtendedKalmanFilter, ParameterSet, Trial, given, identify, join, parameter, state
from shipid.generation.simulator import make_simulator
from shipid.models import Nomoto, PlanarMotion
from shipid.trials.errors import ColumnUnitError, NoRudderMovementError, UnknownColumnError


class Thrusters(Component):
    """Yaw of a ship with a thruster on each side."""

    r = state("rad/s", "rate of turn")
    port = given("N", "thrust of the port thruster")
    starboard = given("N", "thrust of the starboard thruster")
    lever = parameter("1/(kg m)", "yaw acceleration for each newton of difference", start=1e-7, low=1e-9, high=1e-5)
    T = parameter("s", "time constant of yaw", start=10.0, low=1.0, high=200.0)

    @r.rate
    def yaw(self):
        """Made up."""
        return self.lever * (self.port - self.starboard) - self.r / self.T


class Machine(Component):
    """A steering machine with a time constant."""

    delta = state("rad", "rudder angle, positive turns to starboard")
    delta_order = given("rad", "rudder order, positive turns to starboard")
    T_d = parameter("s", "time constant of the machine", start=2.0, low=0.1, high=30.0)

    @delta.rate
    def move(self):
        """Made up."""
        return (self.delta_order - self.delta) / self.T_d


THRUSTERS = join("thrusters", Thrusters, PlanarMotion)
STEERED = join("steered", Nomoto, Machine, PlanarMotion)
SHIP = ParameterSet("own", {"particulars": {}})


def log_of(model, truth, moved) -> Trial:
    t = np.arange(0.0, 300.0, 0.5)
    inputs = {n: size * np.sin(t / period) for n, (size, period) in moved.items()}
    run = make_simulator(model, ("psi", "r"), hold="linear", compiled=False)(t, truth, {"u": 5.0, **inputs}, {})
    noise = np.random.default_rng(5).standard_normal((2, t.size)) * np.deg2rad([[0.2], [0.02]])
    table = {"t": t, "psi": run["psi"] + noise[0], "r": run["r"] + noise[1], "u": 5.0, **inputs}
    units = {n: model[n].unit for n in table if n != "t"} | {"t": "s"}
    return Trial.from_frame(pd.DataFrame(table), name="own", units=units)


@pytest.mark.parametrize(
    ("model", "truth", "moved"),
    [
        (THRUSTERS, {"lever": 3e-7, "T": 25.0}, {"port": (2e4, 17.0), "starboard": (1e4, 29.0)}),
        (STEERED, {"K": 0.1, "tau": 12.0, "T_d": 4.0}, {"delta_order": (0.2, 9.0)}),
    ],
    ids=["thrusters", "own steering machine"],
)
def test_what_moves_the_model_is_enough(model, truth, moved):
    """A log without a rudder angle was refused, whatever the model reads."""
    log = log_of(model, truth, moved)
    if model is THRUSTERS:  # a rudder that she has, and does not use
        log = replace(log, table=log.table.assign(delta=0.0))
    fit = identify(model, [log], ship=SHIP, starts=2)
    assert fit.converged
    for name, value in truth.items():
        estimate = fit.parameters[name]
        assert estimate.value == pytest.approx(value, abs=4 * estimate.std) and estimate.std < 0.3 * value


def test_inputs_that_stand_still_are_no_trial():
    still = log_of(THRUSTERS, {"lever": 3e-7, "T": 25.0}, {"port": (0.0, 1.0), "starboard": (0.0, 1.0)})
    with pytest.raises(
        NoRudderMovementError, match=r"nothing that moves model thrusters: none of its inputs port, starboard, u"
    ):
        identify(THRUSTERS, [still], ship=SHIP)


def test_a_model_that_reads_the_rudder_still_asks_for_it():
    log = log_of(THRUSTERS, {"lever": 3e-7, "T": 25.0}, {"port": (2e4, 17.0), "starboard": (1e4, 29.0)})
    with pytest.raises(UnknownColumnError, match="no column 'delta'"):
        identify("nomoto", [log], ship=SHIP)
    with pytest.raises(UnknownColumnError, match="no column 'delta_order'"):
        identify(STEERED, [log], ship=SHIP)


def test_a_column_in_another_unit_than_the_model_reads_is_refused():
    """SI values went in as they were: a plane angle logged in kN gave a coefficient and a narrow interval."""
    log = log_of(THRUSTERS, {"lever": 3e-7, "T": 25.0}, {"port": (2e4, 17.0), "starboard": (1e4, 29.0)})
    wrong = replace(log, units={**log.units, "port": "kg*m^2/s^2"})
    words = r"column 'port': it is in kg·m²/s², and model thrusters has 'port' \(thrust of the port thruster\) in N"
    with pytest.raises(ColumnUnitError, match=words):
        identify(THRUSTERS, [wrong], ship=SHIP)
    with pytest.raises(ColumnUnitError, match=words):
        identify(THRUSTERS, [log], ship=SHIP, starts=1).validate([wrong])
    filtered = ExtendedKalmanFilter(
        THRUSTERS, SHIP, measured={"r": "0.02 deg/s"}, values={"lever": 3e-7, "T": 25.0}, estimated=[]
    )
    with pytest.raises(ColumnUnitError, match=words):
        filtered.filter(wrong)
    assert filtered.filter(log).t.size == len(log)
