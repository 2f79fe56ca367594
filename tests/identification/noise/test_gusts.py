"""Gusts that drive a ship: their size and time are found, and the intervals take them into account."""

import numpy as np
import pandas as pd
import pytest
from scipy.signal import lfilter

import shipid
from shipid.generation.record import make_record
from shipid.generation.system import generate
from shipid.identification.noise.gusts import rate_of, state_of, with_gusts
from shipid.identification.search import prediction_error
from shipid.identification.search.noise_levels import mean_over

TRUTH = {"K": 0.08, "tau": 12.0}
SIZE, TIME, STEP = 2e-4, 15.0, 0.5


def record(
    size: float,
    seed: int,
    model="nomoto",
    truth=TRUTH,
    signals=("psi", "r"),
    waves: float = 0.0,
    speed: float = 5.0,
    step: float = STEP,
    count: int = 1600,
    period: float = 90.0,
) -> shipid.Trial:
    model = shipid.find_model(model)
    rng = np.random.default_rng(seed)
    phi = np.exp(-step / TIME)
    gust = size * np.sqrt(1 - phi**2) * lfilter([1.0], [1.0, -phi], rng.standard_normal(count + 600))[600:]
    t = step * np.arange(count)
    shown = {
        "delta": np.deg2rad(15) * np.sign(np.sin(2 * np.pi * t / period)),
        "r_disturbance": gust,
        "u": speed + 0 * t,
        "cruise": speed + 0 * t,
    }
    function = make_record(model, signals)
    inputs = np.array([shown.get(n, 0 * t) for n in model.inputs])
    p = function.system.vector(function.system.coefficients, truth)
    x0 = np.array([speed if s == "u" else 0.0 for s in model.states])
    y, _ = function(x0, inputs, np.diff(t, append=t[-1]), p)
    levels = {"psi": np.deg2rad(0.1), "r": np.deg2rad(0.01), "u": 0.02}
    y += np.array([[levels[s]] for s in signals]) * rng.standard_normal(y.shape)
    columns = {"t": t, "delta": shown["delta"], "u": shown["u"], **dict(zip(signals, y))}
    # A heading that waves move to and fro by a second-order filter, and its rate.
    drive = rng.standard_normal(count + 600)
    yaw = lfilter([1.0], [1.0, -2 * 0.92 * np.cos(0.6 * step), 0.92**2], drive)[600:]
    yaw *= waves / yaw.std()
    columns["psi"], columns["r"] = columns["psi"] + yaw, columns["r"] + np.gradient(yaw, step)
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


def test_a_gust_on_one_state_is_found_where_others_have_none(monkeypatch):
    """The speed is calm: that no gust on it lasts does not hide the one on the rate of turn."""
    # To compile the likelihoods with their slopes takes longer than to run so short a record on the virtual machine.
    monkeypatch.setenv("SHIPID_COMPILE", "0")
    own = shipid.find_ship("soesterberg")
    truth = own.values(shipid.find_model("de-keizer"), speed=9.5)
    trial = record(SIZE / 2, 3, "de-keizer", truth, ("psi", "r", "u"), speed=9.5, step=2.0, count=500, period=200.0)
    fit = shipid.identify("de-keizer", [trial], ship=own, starts=1, purpose="filter", estimate=["K", "tau"])
    assert list(fit.levels.gusts) == ["r"]
    assert fit.levels.gusts["r"].time == pytest.approx(TIME, rel=0.7)
    for name in ("K", "tau"):
        assert abs(fit.parameters[name].value - truth[name]) < 3 * fit.parameters[name].std


def test_a_model_that_is_not_exact_is_told():
    """A ship with a cubic damping under a model that has none: tau is 8 of its standard deviations off, and white innovations say
    nothing of it, as what is left out counts as a gust."""
    cubic = {"a": 0.08 / 12, "b1": 1 / 12, "b3": 300 / 12}
    trial = record(0.0, 3, "norrbin", cubic)
    fit = shipid.identify("nomoto", [trial], ship="zeefakkel", starts=1, purpose="filter")
    assert fit.converged and "r" in fit.levels.gusts
    told = [n for n in fit.warnings if n.kind == "coefficients-differ"]
    assert len(told) == 1 and told[0].serious and "by output error" in told[0] and told[0] in fit.text()
    assert any(abs(a.value - a.simulated) > 1.96 * a.std for a in fit.levels.apart)


def test_waves_in_the_sensors_bias_no_coefficient():
    """Through a filter with white sensors tau is 2 to 3 of its standard deviations off."""
    fit = shipid.identify(
        "nomoto", [record(0.0, 3, waves=np.deg2rad(0.5))], ship="zeefakkel", starts=1, purpose="filter"
    )
    assert fit.converged and fit.levels.lasting is not None and fit.levels.sensors["psi"] > np.deg2rad(0.1)
    assert [r.method for r in fit.ladder if r.used] == ["output-error"]
    for name, true in TRUTH.items():
        assert abs(fit.parameters[name].value - true) < 3 * fit.parameters[name].std
    assert "noise of the sensors that lasts" in fit.text()
    asked = shipid.identify(
        "nomoto",
        [record(0.0, 3, waves=np.deg2rad(0.5))],
        ship="zeefakkel",
        starts=1,
        purpose="filter",
        method="prediction-error",
    )
    assert [r.method for r in asked.ladder if r.used] == ["prediction-error"]
    assert any(n.kind == "lasting-sensors" and n.serious for n in asked.warnings) and not any(
        n.kind == "lasting-sensors" for n in fit.warnings
    )


def test_gusts_that_are_not_told_from_white_noise_widen_the_intervals(monkeypatch):
    """Over 400 campaigns with gusts of 3e-5 rad/s^2 for 5 s, intervals by the likelier noise alone held 90 %."""
    shares = []

    def seen(likelier, other, share):
        shares.append((likelier, other, share))
        return mean_over(likelier, other, share)

    monkeypatch.setattr(prediction_error, "mean_over", seen)
    fit = shipid.identify("nomoto", [record(1.6e-5, 2, count=400)], ship="zeefakkel", starts=1, purpose="filter")
    ((likelier, other, share),) = shares
    assert 0.5 <= share < 0.99 and bool(likelier.gusts) != bool(other.gusts)
    away = other.parameters - likelier.parameters
    mean = share * likelier.covariance + (1 - share) * (other.covariance + np.outer(away, away))
    assert fit.levels.covariance == pytest.approx(mean) and fit.levels.parameters == pytest.approx(likelier.parameters)
    assert fit.levels.covariance[0, 0] > likelier.covariance[0, 0]
    shares.clear()
    shipid.identify("nomoto", [record(SIZE, 3)], ship="zeefakkel", starts=1, purpose="filter")
    assert not shares
