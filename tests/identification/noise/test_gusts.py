"""Gusts that drive a ship: their size and time are found, and the intervals take them into account."""

import numpy as np
import pandas as pd
import pytest
from scipy.signal import lfilter

import shipid
from shipid.generation.record import make_record
from shipid.generation.system import generate
from shipid.identification.noise.gusts import rate_of, state_of, with_gusts

TRUTH = {"K": 0.08, "tau": 12.0}
SIZE, TIME, STEP, COUNT = 2e-4, 15.0, 0.5, 1600


def record(size: float, seed: int) -> shipid.Trial:
    model = shipid.find_model("nomoto")
    rng = np.random.default_rng(seed)
    phi = np.exp(-STEP / TIME)
    gust = size * np.sqrt(1 - phi**2) * lfilter([1.0], [1.0, -phi], rng.standard_normal(COUNT + 600))[600:]
    t = STEP * np.arange(COUNT)
    shown = {"delta": np.deg2rad(15) * np.sign(np.sin(2 * np.pi * t / 90)), "r_disturbance": gust, "u": 5.0 + 0 * t}
    function = make_record(model, ("psi", "r"))
    inputs = np.array([shown.get(n, 0 * t) for n in model.inputs])
    p = function.system.vector(function.system.coefficients, TRUTH)
    y, _ = function(np.zeros(len(model.states)), inputs, np.diff(t, append=t[-1]), p)
    psi, r = y + np.deg2rad([[0.1], [0.01]]) * rng.standard_normal(y.shape)
    columns = {"t": t, "psi": psi, "r": r, "delta": shown["delta"], "u": shown["u"]}
    units = {"t": "s", "psi": "rad", "r": "rad/s", "delta": "rad", "u": "m/s"}
    return shipid.Trial.from_frame(pd.DataFrame(columns), name="gusts", units=units)


def test_a_gust_decays_and_drives():
    model = with_gusts(shipid.find_model("nomoto"), ["r"])
    system = generate(model)
    assert state_of("r") in model.states and rate_of("r") in model.parameters
    function = make_record(model, ("r", state_of("r")))
    x0 = np.zeros(len(model.states))
    x0[model.states.index(state_of("r"))] = 1e-3
    t = np.arange(0.0, 40.0, 0.5)
    p = system.vector(system.coefficients, {**TRUTH, rate_of("r"): -np.log(10.0)})
    (r, gust), _ = function(x0, np.zeros((len(model.inputs), t.size)), np.diff(t, append=t[-1]), p)
    assert gust == pytest.approx(1e-3 * np.exp(-t / 10), rel=1e-6)
    # r' = -r / 12 + 1e-3 exp(-t / 10), by hand.
    assert r == pytest.approx(1e-3 * (np.exp(-t / 10) - np.exp(-t / 12)) / (1 / 12 - 1 / 10), rel=1e-5, abs=1e-12)


def test_size_and_time_of_gusts_are_found():
    fit = shipid.identify("nomoto", [record(SIZE, 3)], ship="zeefakkel", starts=1, purpose="filter")
    gust = fit.levels.gusts["r"]
    assert gust.size == pytest.approx(SIZE, rel=0.4)
    assert gust.time == pytest.approx(TIME, rel=0.7)
    assert all(p > 0.001 for p in fit.levels.whiteness.values())
    assert fit.levels.degrees.max() < 1000
    for name, true in TRUTH.items():
        estimate = fit.parameters[name]
        assert abs(estimate.value - true) < 3 * estimate.std
        # Student's quantile is beyond the normal one.
        assert estimate.ci95[1] - estimate.value > 1.97 * estimate.std
    plain = fit.to_dict()["filter_noise"]
    assert plain["gusts"]["r"]["size"]["value"] == gust.size and plain["whiteness"]["psi"]["white"]
    assert "drives r: gusts of" in fit.text() and "innovations are white" in fit.text()


def test_a_calm_record_has_no_gusts():
    fit = shipid.identify("nomoto", [record(0.0, 3)], ship="zeefakkel", starts=1, purpose="filter")
    assert fit.converged and not fit.levels.gusts
