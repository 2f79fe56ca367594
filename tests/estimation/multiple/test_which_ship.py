"""Which of two conditions of a ship sails."""

import numpy as np
import pytest

from shipid import ExtendedKalmanFilter, InteractingMultipleModel, find_model
from shipid.estimation.errors import ModeError
from shipid.estimation.multiple.which_ship import which_ship
from shipid.parameters.parameter_set import ParameterSet, Value

CONDITIONS = {"loaded": (0.067, 40.0), "ballast": (0.075, 30.0)}
SENSORS = {"psi": "0.2 deg", "r": "0.02 deg/s"}


def condition(name):
    """The parameters of a condition."""
    gain, constant = CONDITIONS[name]
    rows = {
        "particulars": [("L", 226.0, "m"), ("speed", 9.5, "m/s")],
        "nomoto": [("K", gain, "1/s"), ("tau", constant, "s")],
    }
    return ParameterSet(name, sections={s: {r[0]: Value(*r, "assumed") for r in given} for s, given in rows.items()})


def zigzag(name, seconds=300):
    """A zig-zag by time of one condition, with sensor noise."""
    gain, constant = CONDITIONS[name]
    t = np.arange(float(seconds))
    delta = np.deg2rad(10) * np.sign(np.sin(2 * np.pi * (t + 0.5) / 160))
    left = np.exp(-1 / constant)
    r, psi = np.zeros(t.size), np.zeros(t.size)
    for k in range(1, t.size):
        steady = gain * delta[k - 1]
        r[k] = steady + (r[k - 1] - steady) * left
        psi[k] = psi[k - 1] + steady + (r[k - 1] - steady) * constant * (1 - left)
    rng = np.random.default_rng(4)
    return {
        "t": t,
        "psi": psi + np.deg2rad(0.2) * rng.standard_normal(t.size),
        "r": r + np.deg2rad(0.02) * rng.standard_normal(t.size),
        "delta": delta,
    }


@pytest.mark.parametrize("sails", CONDITIONS)
def test_the_condition_that_sails_is_found(sails):
    found = which_ship(find_model("nomoto"), [condition(n) for n in CONDITIONS], zigzag(sails), measured=SENSORS)
    assert found.run.most_probable[-1] == sails
    assert found.run.probabilities[-1].max() > 0.95
    assert max(found.log_likelihoods, key=found.log_likelihoods.get) == sails
    assert found.answer.startswith(f"{sails} sails")
    data = found.to_dict()
    assert data["told"] and data["modes"][sails]["probability"] > 0.95
    assert set(data["modes"][sails]) >= {"log_likelihood_alone", "ship", "model"}


def test_where_no_rudder_is_used_it_says_so():
    """On a straight course both conditions are the same ship."""
    record = zigzag("loaded", 120)
    straight = record | {"delta": np.zeros(120), "psi": record["psi"] * 0, "r": record["r"] * 0}
    noise = np.random.default_rng(1).standard_normal((2, 120))
    straight["psi"], straight["r"] = np.deg2rad(0.2) * noise[0], np.deg2rad(0.02) * noise[1]
    kept = ["sensor:psi", "sensor:r", "noise:r"]
    found = which_ship(
        find_model("nomoto"),
        [condition(n) for n in CONDITIONS],
        straight,
        measured=SENSORS,
        kept=kept,
        noise={"r": "0.001 deg/s^1.5"},
    )
    assert not found.to_dict()["told"]
    assert "does not tell" in found.answer and "loaded" in found.answer


def test_what_does_not_fit_is_refused():
    model, record = find_model("nomoto"), zigzag("loaded", 60)
    for ships in ([condition("loaded")], [condition("loaded"), condition("loaded")]):
        with pytest.raises(ModeError, match="different names"):
            which_ship(model, ships, record, measured=SENSORS)
    gated = {n: ExtendedKalmanFilter(model, condition(n), measured=SENSORS, estimated=()) for n in CONDITIONS}
    with pytest.raises(ModeError, match="gate=None"):
        InteractingMultipleModel.of_filters(gated, [[0.9, 0.1], [0.1, 0.9]])
    unlike = {
        n: ExtendedKalmanFilter(model, condition(n), measured={"psi": level}, estimated=(), gate=None)
        for n, level in (("loaded", "0.2 deg"), ("ballast", "0.3 deg"))
    }
    with pytest.raises(ModeError, match="same noise"):
        InteractingMultipleModel.of_filters(unlike, [[0.9, 0.1], [0.1, 0.9]])
    with pytest.raises(ModeError, match="at least one model"):
        InteractingMultipleModel.of_filters({}, [[1.0]])
