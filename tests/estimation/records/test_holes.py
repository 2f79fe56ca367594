"""Holes in what drives a model: filled by the rule, or the record is filtered in stretches; parameters go on over them."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid import ExtendedKalmanFilter, find_model, find_ship, simulate
from shipid.estimation.records.arrangement import arrange
from shipid.estimation.several.adaptive_noise import AdaptiveFilter
from shipid.estimation.several.cascade import Cascade
from shipid.identification.recursive.identifier import RecursiveIdentifier
from shipid.trials.errors import NoStretchError
from shipid.trials.trial import Trial

NAN = np.nan
SENSORS = {"psi": "0.2 deg", "r": "0.02 deg/s"}
NOISE = {"psi": "0.2 deg", "r": "0.02 deg/s", "x": "2 m", "y": "2 m", "u": "0.05 m/s"}
MODEL, SHIP = find_model("nomoto"), find_ship("zeefakkel")
K = SHIP.values(MODEL, speed=SHIP.particular("speed", "m/s"))["K"]


@pytest.fixture(scope="module")
def trial() -> Trial:
    return simulate(MODEL, SHIP, "zigzag:20/20", sampling="0.5 s", duration="300 s", noise=NOISE, seed=2)


@pytest.fixture(scope="module")
def kalman() -> ExtendedKalmanFilter:
    return ExtendedKalmanFilter(MODEL, SHIP, measured=SENSORS, estimated=["K", "tau"], gate=None)


def holed(trial: Trial, name: str, rows: slice) -> Trial:
    table = trial.table.copy()
    table.loc[rows.start : rows.stop - 1, name] = NAN
    return Trial(trial.name, table, trial.source, trial.ship)


def test_a_short_hole_of_the_rudder_is_interpolated(trial, kalman):
    run, filled = kalman.filter(holed(trial, "delta", slice(200, 204))), trial.table.copy()
    filled.loc[199:204, "delta"] = np.linspace(filled["delta"][199], filled["delta"][204], 6)
    np.testing.assert_allclose(run.x, kalman.filter(Trial("filled", filled)).x, rtol=1e-12, atol=1e-15)
    assert run.t.size == len(trial) and not run.arranged.holes
    assert "delta is interpolated between its samples at 4 of 601 times." in run.text()


def test_behind_a_long_hole_the_ship_starts_anew_and_the_parameters_go_on(trial, kalman):
    run = kalman.filter(holed(trial, "delta", slice(200, 300)))
    assert run.t.size == 501 and not np.any((run.t >= 100) & (run.t < 150)), "no estimates where nothing is known"
    assert np.isfinite(run.x).all() and np.isfinite(run.std).all()
    before, behind = 199, 200
    # The first sample of heading and rate behind it, with the standard deviation of one at the most.
    assert run["psi"][behind] == pytest.approx(trial["psi"][300], abs=2 * np.deg2rad(0.2))
    assert run.std_of("psi")[behind] < np.deg2rad(0.2) and run.std_of("psi")[behind] > run.std_of("psi")[before]
    for name in ("K", "tau"):
        assert run[name][behind] == pytest.approx(run[name][before], rel=1e-6)
        assert run.std_of(name)[behind] == pytest.approx(run.std_of(name)[before], rel=1e-3)
    assert run.parameters["K"].value == pytest.approx(K, abs=4 * run.parameters["K"].std)
    text = run.text()
    assert "100 of 601 samples lie in holes of an input" in text
    assert "No delta from 99.5 to 150 s: no estimates there; what it drives starts anew." in text
    plain = json.loads(json.dumps(run.to_dict(), allow_nan=False))["holes"]
    assert plain == {
        "filled": {},
        "samples_left_out": 100,
        "holes": [{"begin": 99.5, "end": 150.0, "inputs": ["delta"]}],
    }
    assert not run.to_frame().isna().to_numpy().any()
    assert run.arranged.back == 0, "these are no wrong time stamps"


def test_what_was_measured_in_the_hole_does_not_matter(trial, kalman):
    log = holed(trial, "delta", slice(200, 300))
    wild = log.table.copy()
    wild.loc[200:299, ["psi", "r"]] = 3.0
    np.testing.assert_array_equal(kalman.filter(Trial("wild", wild)).x, kalman.filter(log).x)


def test_the_square_root_form_does_the_same(trial, kalman):
    log = holed(trial, "delta", slice(200, 300))
    root = ExtendedKalmanFilter(MODEL, SHIP, measured=SENSORS, estimated=["K", "tau"], gate=None, form="square-root")
    one, other = kalman.filter(log), root.filter(log)
    np.testing.assert_allclose(other.x, one.x, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(other.std, one.std, rtol=1e-5)


def test_states_that_the_rudder_does_not_move_go_on(trial):
    """A current is no part of what the rudder drives: it keeps its estimate, and the position does not."""
    position = ExtendedKalmanFilter(
        find_model("position-filter"), SHIP, measured={"fix_north": "2 m", "fix_east": "2 m"}, gate=None
    )
    log = holed(trial, "psi", slice(200, 300))
    run = position.filter({n: log[n] for n in ("t", "x", "y", "psi", "r", "u")})
    driven = position.design.system.states_driven_by(["psi"])
    kept = [n for n in position.model.states if n not in driven]
    assert "x" in driven and kept
    for name in kept:
        # It may have changed in fifty seconds, which its random walk says; what it was is not forgotten.
        assert run.std_of(name)[199] < run.std_of(name)[200] < 0.8 * run.std_of(name)[0]
        assert run[name][200] == pytest.approx(run[name][199], abs=0.5 * run.std_of(name)[200])


def test_the_smoother_goes_back_over_a_hole_with_the_parameters_alone(trial, kalman):
    """Samples behind it sharpen the gain before it; the motion before it is as if the record ended there."""
    log = holed(trial, "delta", slice(200, 300))
    smoothed, run = kalman.smooth(kalman.filter(log)), kalman.filter(log)
    assert smoothed.t.size == run.t.size
    alone = kalman.smooth(kalman.filter(Trial("first", log.table.iloc[:200])))
    assert smoothed.std_of("K")[0] < 0.9 * alone.std_of("K")[0]
    assert smoothed.std_of("K")[0] == pytest.approx(smoothed.std_of("K")[-1], rel=1e-2), "a constant is one number"
    assert smoothed.std_of("psi")[199] == pytest.approx(alone.std_of("psi")[199], rel=0.1)
    assert np.all(smoothed.std <= run.std * (1 + 1e-6))


def test_the_likelihood_is_that_of_the_stretches(trial):
    plain = ExtendedKalmanFilter(MODEL, SHIP, measured=SENSORS, estimated=[], gate=None)
    log = holed(trial, "delta", slice(200, 300))
    unknowns = ["K", "tau", "sensor:psi", "bias:delta"]
    whole = plain.likelihood(log, unknowns)
    parts = [
        plain.likelihood(Trial("part", log.table.iloc[rows].reset_index(drop=True)), unknowns)
        for rows in (slice(0, 200), slice(300, 601))
    ]
    q = whole.start
    for got, wanted in zip(whole(q), zip(*(p(q) for p in parts))):
        np.testing.assert_allclose(got, wanted[0] + wanted[1], rtol=1e-9)
    step = 1e-6 * np.abs(q[0])
    ahead, behind = (whole(q + s * step * np.eye(4)[0])[0] for s in (1, -1))
    assert whole(q)[1][0] == pytest.approx((ahead - behind) / (2 * step), rel=1e-4)


def test_an_adaptive_filter_and_a_cascade_take_holes(trial):
    base = ExtendedKalmanFilter(MODEL, SHIP, measured=SENSORS, estimated=[], gate=None)
    log = holed(trial, "delta", slice(200, 300))
    run = AdaptiveFilter(base, ["r"], factors=(1.0, 10.0), lasting=("600 s", "20 s")).filter(log)
    assert run.t.size == 501 and np.isfinite(run.x).all() and run.probabilities[-1].sum() == pytest.approx(1.0)
    position = ExtendedKalmanFilter(
        find_model("position-filter"), SHIP, measured={"fix_north": "2 m", "fix_east": "2 m"}, gate=None
    )
    both = Cascade({"yaw": base, "position": position}).filter(
        {n: log[n] for n in ("t", "x", "y", "psi", "r", "u", "delta")}
    )
    # Where the first has no heading for the second, that has no estimates either.
    assert both["yaw"].t.size == 501 and both["position"].t.size < 520
    assert np.isfinite(both["position"].x).all()


def test_a_recursion_goes_on_over_a_hole():
    made = RecursiveIdentifier(
        find_model("yaw-filter"), "soesterberg", method="rls", measured={"r": None}, inputs={"cruise": "9.5 m/s"}
    )
    trial = simulate(find_model("de-keizer"), "soesterberg", "zigzag:15/15", noise={"r": "0.02 deg/s", "u": "0.05 m/s"})
    whole = made.identify(trial)
    rows = slice(150, 200)
    log = holed(trial, "delta", rows)
    run = made.identify(log)
    assert run.t.size == len(trial) - 50 and not run.diverged
    for i, name in enumerate(run.names):
        assert run.theta[150, i] == pytest.approx(run.theta[149, i], rel=1e-12), "no innovation at the first sample"
        assert run[name][-1] == pytest.approx(whole[name][-1], abs=5 * whole.std_of(name)[-1])
    assert run.y[150] == trial["r"][200]
    assert "No delta" in run.text() and json.dumps(run.to_dict(), allow_nan=False)


def test_the_noise_level_of_a_record_with_missing_samples():
    trial = simulate(find_model("de-keizer"), "soesterberg", "zigzag:15/15", noise={"r": "0.02 deg/s", "u": "0.05 m/s"})
    made = RecursiveIdentifier(find_model("yaw-filter"), "soesterberg", method="rls", measured={"r": None})
    gone = np.random.default_rng(0).random(len(trial)) < 0.2
    log = Trial("log", trial.table.assign(r=trial.table["r"].mask(gone)))
    assert made.identify(log).noise_level == pytest.approx(np.deg2rad(0.02), rel=0.25)


def test_signals_of_different_rates_are_filtered_on_their_own_clocks(trial, kalman):
    """Heading at 2 Hz, rate at 1 Hz, stamps 3 ms apart, the rudder with the rate."""
    t = np.sort(np.concatenate([trial["t"], trial["t"][::2] + 0.003]))
    late = np.isin(t, trial["t"][::2] + 0.003)
    table = pd.DataFrame({"t": t, "psi": NAN, "r": NAN, "delta": NAN, "u": NAN})
    table.loc[~late, "psi"], table.loc[late, ["r", "delta"]] = trial["psi"], trial.table[["r", "delta"]].to_numpy()[::2]
    run = kalman.filter(Trial("two", table))
    assert not run.arranged.holes and run.t.size == t.size
    assert run.innovations["psi"].t.size == 601 and run.innovations["r"].t.size == 301
    assert run.parameters["K"].value == pytest.approx(K, abs=5 * run.parameters["K"].std)


def test_a_record_begins_where_its_inputs_do(trial, kalman):
    """The rudder is not known for a hundred seconds: the first estimate comes from the first samples behind them."""
    run = kalman.filter(holed(trial, "delta", slice(0, 200)))
    assert run.t[0] == pytest.approx(100.0 - 2.5), "five intervals before its first sample"
    assert run["psi"][0] == pytest.approx(trial["psi"][195], abs=2 * np.deg2rad(0.2))
    assert run.parameters["K"].value == pytest.approx(K, abs=4 * run.parameters["K"].std)


def test_the_speed_before_the_manoeuvre_is_found_by_one_rule():
    """From the speed over all, and up to the first order, where a record has no other speed and no rudder."""
    made = ExtendedKalmanFilter(
        find_model("de-keizer"), "soesterberg", measured={"r": "0.02 deg/s"}, estimated=[], inputs={"delta": "0 deg"}
    )
    t = np.arange(0, 100, 0.5)
    over = t >= 40
    log = {"t": t, "r": 0.0 * t, "U": np.where(over, 6.0, 8.0), "delta_order": np.where(over, 0.3, 0.0)}
    arranged = arrange(made.design.instruments, log)
    assert arranged.inputs[0, made.model.inputs.index("cruise")] == 8.0


def test_nothing_is_known_at_no_time(trial, kalman):
    table = trial.table.copy()
    table["delta"] = NAN
    table.loc[0, "delta"] = 0.0
    with pytest.raises(shipid.ShipidError):
        kalman.filter({"t": trial["t"], "psi": trial["psi"], "r": trial["r"], "delta": np.full(len(trial), NAN)})
    run = kalman.filter(Trial("once", table))
    assert run.t.size == 1
    two = find_model("de-keizer")
    never = trial.table.assign(delta=trial.table["delta"].where(np.arange(len(trial)) < 100))
    never["cruise"] = np.where(np.arange(len(trial)) > 400, 5.0, NAN)
    filter_two = ExtendedKalmanFilter(two, "soesterberg", measured=SENSORS, estimated=[], gate=None)
    with pytest.raises(
        NoStretchError,
        match=r"at no time is everything known.*cruise 200 of 601.*delta 100 of 601|delta 100 of 601.*cruise 200 of 601",
    ):
        filter_two.filter(Trial("never", never))


def test_the_report_of_a_filter_says_what_is_left_out(trial, kalman, tmp_path):
    run = kalman.filter(holed(trial, "delta", slice(200, 300)))
    shipid.write_report(kalman.observability(run), tmp_path / "filter.html")
    page = " ".join((tmp_path / "filter.html").read_text().split())
    assert "No delta from 99.5 to 150 s: no estimates there" in page and ">nan<" not in page.lower()
