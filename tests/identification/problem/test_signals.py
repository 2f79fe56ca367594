"""A state of one's own that a log shows is fitted, with a weight that belongs to its size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from shipid import Component, Trial, constant, find_model, given, join, output, parameter, state
from shipid.identification.errors import NothingToFitError
from shipid.identification.problem.prior import STRUCTURE_SPEED, structural_errors
from shipid.identification.problem.signals import fitted_signals
from shipid.identification.problem.trial_data import prepare
from shipid.models import Nomoto, PlanarMotion
from shipid.parts.sensors import FaultyGyro


class Engine(Component):
    """Shaft speed behind a governor."""

    n = state("1/s", "shaft speed, revolutions per second")
    n_order = given("1/s", "ordered shaft speed, revolutions per second")
    T_n = parameter("s", "time constant of the engine", start=5.0, low=0.5, high=60)

    @n.rate
    def follow(self):
        """A notebook (2001), page 3."""
        return (self.n_order - self.n) / self.T_n


@pytest.fixture(scope="module")
def trial():
    units = {"t": "s", "psi": "rad", "r": "rad/s", "u": "m/s", "delta": "rad", "n": "rps", "n_order": "rps"}
    t = np.arange(0.0, 60.0)
    values = {"psi": 0.01 * t, "r": 0.01, "u": 5.0, "delta": 0.1, "n": 2.0, "n_order": 2.0}
    return Trial.from_frame(pd.DataFrame({"t": t} | values), name="engine", units=units)


def test_trials_that_share_no_signal_are_told_with_what_each_has(trial):
    heading = replace(trial, name="gyro", table=trial.table[["t", "psi", "delta"]])
    rate = replace(trial, name="turn indicator", table=trial.table[["t", "r", "delta"]])
    with pytest.raises(NothingToFitError, match=r"share no signal .*gyro has psi; turn indicator has r\."):
        fitted_signals(find_model("nomoto"), [heading, rate])


def test_zeros_from_first_to_last_are_no_measurement(trial):
    """A drift that is zero without noise made a coefficient of 1e-31 with an interval as small."""
    zeros = replace(trial, table=trial.table.assign(v=0.0))
    assert fitted_signals(find_model("cubic"), [zeros]) == ("psi", "r")
    assert fitted_signals(find_model("cubic"), [zeros], ["psi", "v"]) == ("psi", "v")
    assert fitted_signals(find_model("cubic"), [zeros, replace(zeros, table=zeros.table.assign(v=0.1))]) == (
        "psi",
        "r",
        "v",
    )


def test_a_measured_state_of_the_model_is_fitted(trial):
    model = join("with an engine", Nomoto, PlanarMotion, Engine)
    assert fitted_signals(model, [trial]) == ("psi", "r", "n")
    assert fitted_signals(find_model("nomoto"), [trial]) == ("psi", "r")


def test_its_weight_goes_by_its_size(trial):
    model = join("with an engine", Nomoto, PlanarMotion, Engine)
    data = prepare(model, trial, ("psi", "r", "n"), 5.0, 10.0, trial)
    assert structural_errors(("psi", "n"), data, 10.0)[1] == pytest.approx(2.0 * STRUCTURE_SPEED)


class Inclinometer(Component):
    """What an instrument shows that is no field of the vocabulary."""

    r = given("rad/s", "rate of turn")
    heel_per_rate = constant("s", "heel for each rate of turn", default=2.0)
    bubble = output("rad", "inclinometer")

    @bubble.equals
    def reading(self):
        """Made up."""
        return self.heel_per_rate * self.r


def test_a_measured_output_of_the_model_is_fitted(trial):
    """A leeway that was declared and logged was left out without a word, and a coefficient came out surely wrong."""
    model = join("with an inclinometer", Nomoto, PlanarMotion, Inclinometer)
    logged = replace(trial, table=trial.table.assign(bubble=0.1 * trial["r"]))
    assert fitted_signals(model, [logged]) == ("psi", "r", "bubble")
    assert fitted_signals(model, [trial]) == ("psi", "r")


def test_the_reading_of_an_instrument_stands_for_what_it_measures_once(trial):
    model = join("with a gyro", Nomoto, PlanarMotion, FaultyGyro)
    logged = replace(trial, table=trial.table.assign(gyro=trial["r"]))
    assert fitted_signals(model, [logged]) == ("psi", "r")
