"""Missing is normal: output error counts the samples that are there, and nothing else."""

from __future__ import annotations

import importlib
import json
from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest
from scipy.signal import lfilter

import shipid
from shipid.generation.record import make_record
from shipid.identification.noise.autoregression import autoregression_of
from shipid.identification.noise.filled_inputs import effects_of, errors_between
from shipid.identification.noise.residual_groups import groups_of
from shipid.identification.problem.signals import fitted_signals
from shipid.identification.problem.trial_data import prepare
from shipid.identification.uncertainty.covariance import covariance_of
from shipid.identification.validation import trial_measures
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.findings import Diagnosis
from shipid.trials.trial import Trial

MODEL, SHIP = shipid.find_model("norrbin"), shipid.find_ship("zeefakkel")
TRUTH = {n: SHIP.values(MODEL, speed=5.0)[n] for n in ("a", "b1", "b3")}
LEVELS = {"psi": np.deg2rad(0.2), "r": np.deg2rad(0.02)}
NAN = np.nan


@cache
def sailed_by(sampling: float) -> Trial:
    """A 20/20 zig-zag without noise."""
    return shipid.simulate(MODEL, SHIP, "zigzag:20/20", sampling=sampling, duration="200 s")


def table(sampling: float = 0.5, seed: int | None = 0, t: np.ndarray | None = None) -> pd.DataFrame:
    """A 20/20 zig-zag sailed with the rudder as the log has it; noise on heading and rate."""
    sailed = sailed_by(sampling)
    at = sailed["t"] if t is None else t
    delta = np.interp(at, sailed["t"], sailed["delta"])
    record = make_record(MODEL, ("psi", "r"))
    inputs = np.array(
        [{"delta": delta}.get(n, np.full(at.size, 5.0 if n in ("u", "cruise") else 0.0)) for n in MODEL.inputs]
    )
    p = record.system.vector(record.system.coefficients, SHIP.values(MODEL, speed=5.0))
    x0 = np.array([5.0 if s == "u" else 0.0 for s in MODEL.states])
    y, _ = record(x0, inputs, np.diff(at, append=at[-1]), p)
    clean = pd.DataFrame({"t": at, "delta": delta, "psi": y[0], "r": y[1], "u": np.full(at.size, 5.0)})
    if seed is not None:
        rng = np.random.default_rng(seed)
        for name, level in LEVELS.items():
            clean[name] += level * rng.standard_normal(at.size)
    return clean


def gone(made: pd.DataFrame, share: float, *names: str, seed: int = 1) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    made = made.copy()
    for name in names:
        made.loc[rng.random(len(made)) < share, name] = NAN
    return made


def fitted(made: pd.DataFrame, **options) -> shipid.Fit:
    return shipid.identify(MODEL, [Trial("log", made)], ship=SHIP, starts=1, **options)


def near_truth(fit: shipid.Fit, widths: float = 4.0) -> None:
    assert fit.converged
    for name, value in TRUTH.items():
        e = fit.parameters[name]
        assert abs(e.value - value) < widths * e.std, name
        assert e.std < 0.2 * abs(value), name


@pytest.fixture(scope="module")
def whole() -> shipid.Fit:
    """The fit of the record of which nothing is missing."""
    return fitted(table())


@pytest.mark.parametrize("share", [0.05, 0.5])
def test_samples_missing_at_random(share, whole):
    fit = fitted(gone(table(), share, "psi", "r", "u"))
    near_truth(fit)
    ratio = fit.parameters["b1"].std / whole.parameters["b1"].std
    assert ratio == pytest.approx((1 - share) ** -0.5, rel=0.2), "as much information as samples"
    assert fit.noise["psi"] == pytest.approx(LEVELS["psi"], rel=0.15)
    assert fit.chi_square == pytest.approx(1.0, abs=0.02)


def test_long_holes_in_what_is_predicted():
    made = table()
    made.loc[100:180, "psi"] = NAN
    made.loc[220:260, "r"] = NAN
    fit = fitted(made)
    near_truth(fit)
    assert [c.trial.name for c in fit.fitted] == ["log"], "it has no hole in what drives it"
    assert fit.fitted[0].samples == {"psi": (320, 401), "r": (360, 401)}
    assert "samples there: psi 320 of 401, r 360 of 401" in fit.text()


def test_a_sample_that_is_missing_counts_as_one_that_never_was(monkeypatch):
    """Rows in which nothing but the rudder is known, against a log without them, the rudder between them on a straight line."""
    # The log with the rows says that the rudder has no corner between the others: that is left out of the comparison.
    monkeypatch.setattr(
        importlib.import_module("shipid.identification.identify"), "follow_corners", lambda found, _: found
    )
    made = table(seed=None)
    rng = np.random.default_rng(3)
    for name, level in LEVELS.items():
        made[name] += level * rng.standard_normal(len(made))
    kept = np.arange(len(made)) % 2 == 0
    # On a straight line over the rows in between, so that both logs say the same of the rudder.
    made["delta"] = np.interp(made["t"], made["t"][kept], made["delta"][kept])
    holed = made.copy()
    holed.loc[~kept, ["psi", "r", "u"]] = NAN
    one, other = fitted(holed), fitted(made[kept].reset_index(drop=True))
    for name in TRUTH:
        # Steps of half the length are integrated a little more exactly: by far less than a standard deviation.
        assert one.parameters[name].value == pytest.approx(
            other.parameters[name].value, abs=0.05 * one.parameters[name].std
        )
        assert one.parameters[name].std == pytest.approx(other.parameters[name].std, rel=0.05)
    # The initial state is held near the first ten rows: five samples where every other one is missing, ten where none is.
    assert one.noise["psi"] == pytest.approx(other.noise["psi"], rel=5e-3)
    assert one.noise["r"] == pytest.approx(other.noise["r"], rel=1e-3)


def test_residuals_and_slopes_of_missing_samples_are_none():
    made = gone(table(), 0.3, "psi", "r")
    problem = fitted(made).identified.problem
    residual, jacobian = problem.residuals(problem.first_guess(np.array(list(TRUTH.values()))))
    missing = np.isnan(made[["psi", "r"]].to_numpy().T).ravel()
    assert not residual[: missing.size][missing].any() and not jacobian[: missing.size][missing].any()
    assert residual[: missing.size][~missing].all()
    assert problem.missing == missing.sum()
    split = np.concatenate(problem.by_signal(residual)[0])
    np.testing.assert_array_equal(np.isnan(split), missing)


def test_a_hole_in_the_rudder_splits_the_record():
    made = table()
    made.loc[150:190, "delta"] = NAN
    fit = fitted(made)
    near_truth(fit)
    assert [c.trial.name for c in fit.fitted] == ["log@0:74.5", "log@95.5:200"]
    text = " ".join(fit.text().split())
    assert "Holes in delta split the record; 2 stretches are used" in text and "401, of which 360 are used" in text
    plain = json.loads(json.dumps(fit.to_dict(), allow_nan=False))
    assert plain["samples"]["log@0:74.5"]["signals"]["psi"] == {"there": 150, "possible": 150}
    assert "Holes in delta split the record" in " ".join(plain["samples"]["log@0:74.5"]["notes"])
    # What happened in the hole does not matter.
    wild = made.copy()
    wild.loc[155:185, ["psi", "r"]] = 7.0
    again = fitted(wild)
    assert all(again.parameters[n].value == fit.parameters[n].value for n in TRUTH)


def test_the_doctor_sees_a_record_once_and_whole(monkeypatch):
    made = table()
    made.loc[100:120, "delta"] = made.loc[240:260, "delta"] = NAN
    seen: list[int] = []

    def diagnosed(trial: Trial) -> Diagnosis:
        seen.append(len(trial))
        return check_trial(trial)

    monkeypatch.setattr(trial_measures, "check_trial", diagnosed)
    fit = fitted(made).validate([Trial("again", made)])
    assert len(fit.fitted) == len(fit.validation) == 3
    assert seen == [len(made), len(made)]


def test_signals_of_different_rates_stay_on_their_own_clocks():
    """Heading at 10 Hz, rate at 5, rudder at 2: stamps of each 3 ms apart."""
    clocks = {
        "psi": np.arange(0, 200, 0.1),
        "r": np.arange(0, 200, 0.2) + 0.003,
        "delta": np.arange(0, 200, 0.5) + 0.006,
    }
    t = np.unique(np.concatenate(list(clocks.values())))
    made = table(seed=0, t=t)
    for name, clock in clocks.items():
        made[name] = made[name].where(np.isin(t, clock))
    fit = fitted(made)
    near_truth(fit, 5.0)
    assert fit.fitted[0].samples == {"psi": (1995, 1995), "r": (997, 997)}
    assert fit.noise["r"] == pytest.approx(LEVELS["r"], rel=0.15)


@pytest.mark.parametrize(
    "method", ["equation-error", "instrumental-variables", "multiple-shooting", "prediction-error"]
)
def test_every_method_takes_holes(method):
    made = gone(table(), 0.1, "psi", "r", "u")
    made.loc[100:140, "r"] = NAN
    fit = fitted(made, method=method)
    assert fit.converged
    for name, value in TRUTH.items():
        # Least squares in the equations is biased by noise in the regressors.
        assert fit.parameters[name].value == pytest.approx(value, rel=0.3), name


@pytest.mark.parametrize("loss", ["huber", "soft-l1"])
def test_a_robust_loss_takes_holes(loss):
    made = gone(table(), 0.2, "psi", "r")
    there = np.flatnonzero(np.isfinite(made["psi"]))[::25]
    made.loc[there, "psi"] += 0.5
    fit = fitted(made, loss=loss)
    near_truth(fit)
    assert all((w[~np.isfinite(made[["psi", "r"]].to_numpy().T)] == 1).all() for w in fit.identified.problem.weights)


def test_what_is_assessed_and_predicted_takes_holes(tmp_path):
    made, other = gone(table(), 0.2, "psi", "r", "u"), gone(table(seed=5), 0.2, "psi", "r", "u", "delta")
    other.loc[200:240, "delta"] = NAN
    fit = shipid.assess(fitted(made, validate=[Trial("other", other)]))
    assert len(fit.validation) == 2
    for c in fit.validation:
        assert 0 < c.rmse["psi"] < np.deg2rad(3) and 0 < c.rmse["r"] < np.deg2rad(0.3)
    residuals = fit.assessment.residuals["psi"]
    assert residuals.samples == np.isfinite(made["psi"]).sum() and residuals.white
    report = tmp_path / "report.html"
    shipid.write_report(fit, report)
    page = " ".join(report.read_text().split())
    assert "Samples there: heading" in page and ">nan<" not in page.lower()
    json.dumps(fit.to_dict(), allow_nan=False)
    low, high = fit.profile("b1").ci95
    e = fit.parameters["b1"]
    assert high - low == pytest.approx(2 * 1.96 * e.std, rel=0.3)


def test_models_are_compared_on_trials_with_holes():
    trials = [Trial("one", gone(table(), 0.2, "psi", "r")), Trial("two", gone(table(seed=4), 0.2, "psi", "r"))]
    trials[1].table.loc[150:190, "delta"] = NAN
    ranking = shipid.compare_models(["nomoto", "norrbin"], trials, ship=SHIP, starts=1, workers=1)
    assert ranking.best == "norrbin" and all(np.isfinite(r.score) for r in ranking.ranks)


def test_a_signal_with_a_few_samples_is_fitted_on_request_only():
    made = table()
    made["r"] = made["r"].where(np.arange(len(made)) % 40 == 0)
    trial = Trial("few", made)
    assert fitted_signals(MODEL, [trial]) == ("psi",)
    assert fitted_signals(MODEL, [trial], ["psi", "r"]) == ("psi", "r")
    assert fitted_signals(MODEL, [Trial("few", made.drop(columns="psi"))]) == ("r",), "better than nothing"


def test_thinning_keeps_the_samples_of_a_slow_signal():
    made = table(sampling=0.1)
    made["r"] = made["r"].where(np.arange(len(made)) % 10 == 3)
    data = prepare(MODEL, Trial("slow", made), ("psi", "r"), 5.0, 5.0)
    thin = data.thinned(200)
    assert 200 <= thin.there[0].sum() < 300 and thin.there[1].sum() >= 20
    assert thin.intervals.size < 300


def test_the_start_comes_from_samples_that_are_there():
    made = table()
    made.loc[:5, "psi"] = NAN
    made["r"] = made["r"].where(np.arange(len(made)) % 4 == 1)
    data = prepare(MODEL, Trial("late", made), ("psi", "r"), 5.0, 20.0)
    assert np.isfinite(list(data.start.values())).all()
    # The line through the first samples, back to the first row: the ship has turned by 1 degree when they begin.
    first = made["psi"][6:10]
    assert data.start["psi"] == pytest.approx(np.polyval(np.polyfit(made["t"][6:10], first, 1), 0.0))
    silent = prepare(MODEL, Trial("silent", made.assign(r=NAN)), ("psi", "r"), 5.0, 20.0)
    assert silent.start["r"] == 0.0


def coloured(data, phi: float, seed: int) -> np.ndarray:
    """Residuals of a first-order process that both signals have in common, where there are samples."""
    rng = np.random.default_rng(seed)
    path = lfilter([np.sqrt(1 - phi**2)], [1, -phi], rng.standard_normal(data.intervals.size + 500))[500:]
    return np.where(data.there, path, 0.0)


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.9])
def test_the_colour_of_noise_is_found_through_holes(phi):
    """A first-order process, samples of two signals missing at random: the variance of its sum is that of all pairs there."""
    made = gone(table(sampling=0.1), 0.3, "psi", "r")
    data = prepare(MODEL, Trial("holed", made), ("psi", "r"), 5.0, 5.0)
    jacobian = np.where(data.there, 1.0, 0.0)[:, :, None]
    lags = np.abs(np.subtract.outer(np.arange(2001), np.arange(2001)))
    weights = data.there.sum(axis=0).astype(float)
    true = weights @ (phi**lags if phi else np.eye(2001)) @ weights
    found = []
    for seed in range(20):
        total = 0.0
        for group in groups_of(data, 0, coloured(data, phi, seed), jacobian, np.arange(1)):
            total += float(np.sum(autoregression_of(group.residual).shaped(group.jacobian) ** 2))
        found.append(total)
    # Entries hold one to three samples each.
    assert np.median(found) == pytest.approx(true, rel=0.15)


def test_white_noise_stays_white_through_holes():
    made = gone(table(sampling=0.1), 0.3, "psi", "r")
    data = prepare(MODEL, Trial("holed", made), ("psi", "r"), 5.0, 5.0)
    orders = []
    for seed in range(40):
        residual = np.where(data.there, np.random.default_rng(seed).standard_normal(data.there.shape), 0.0)
        groups = groups_of(data, 0, residual, np.where(data.there, 1.0, 0.0)[:, :, None], np.arange(1))
        orders += [autoregression_of(group.residual).order for group in groups]
    assert np.mean(np.array(orders) > 0) <= 0.05


def test_series_of_signals_of_different_rates():
    """A signal that is much slower, and what another shows in a long hole, are series of their own; no sample is lost."""
    made = table(sampling=0.1)
    made["r"] = made["r"].where(np.arange(len(made)) % 50 == 0)
    data = prepare(MODEL, Trial("slow", made), ("psi", "r"), 5.0, 5.0)
    jacobian = np.where(data.there, 1.0, 0.0)[:, :, None]
    groups = groups_of(data, 0, jacobian[:, :, 0], jacobian, np.arange(1))
    assert [g.signals for g in groups] == [(0,), (1,)]
    assert [(g.jacobian**2).sum() for g in groups] == pytest.approx([2001, 41])
    made = table()
    made.loc[100:180, "r"] = NAN
    data = prepare(MODEL, Trial("hole", made), ("psi", "r"), 5.0, 5.0)
    jacobian = np.where(data.there, 1.0, 0.0)[:, :, None]
    groups = groups_of(data, 0, jacobian[:, :, 0], jacobian, np.arange(1))
    assert [(g.signals, g.residual.shape[1]) for g in groups] == [((0, 1), 320), ((0,), 81)]


def test_errors_of_a_filled_rudder_are_as_large_as_they_are():
    """Drawn errors of a zig-zag's rudder, every other sample of which is gone, against the true ones: power within a third."""
    made = table(seed=None)
    t, delta = made["t"].to_numpy(), made["delta"].to_numpy()
    true, drawn = [], []
    for seed in range(40):
        own = np.random.default_rng(seed).random(t.size) < 0.5
        own[[0, -1]] = True
        filled = np.interp(t, t[own], delta[own])
        errors = errors_between(t, filled, own)
        assert not errors[:, own].any()
        true.append(np.sum((filled - delta) ** 2))
        drawn.append(np.sum(errors**2) / len(errors))
    assert np.mean(drawn) == pytest.approx(np.mean(true), rel=0.34)


def test_a_filled_rudder_widens_the_intervals():
    made = gone(table(), 0.4, "delta", seed=2)
    fit = fitted(made)
    problem = fit.identified.problem
    exact = replace(problem, trials=tuple(replace(d, sampled=None) for d in problem.trials))
    solution = replace(fit.identified.solution, problem=exact)
    assert covariance_of(solution).matrix[0, 0] < 0.9 * fit.covariance[0, 0]
    near_truth(fit)


def test_rows_that_are_missing_count_as_well(whole):
    """What the rudder did between two rows that are far apart is not known, whether or not there are rows between."""
    made = table()
    rows = np.random.default_rng(1).random(len(made)) > 0.4
    holed = made.copy()
    holed.loc[~rows, ["psi", "r", "u", "delta"]] = NAN
    q = whole.identified.solution.q
    sizes = []
    for log in (holed, made[rows].reset_index(drop=True)):
        problem = fitted(log).identified.problem
        effects = effects_of(problem, q, 0)
        sizes.append(np.sqrt(np.mean(effects[:, problem.trials[0].there] ** 2)))
    assert sizes[0] == pytest.approx(sizes[1], rel=0.5) and min(sizes) > 0.01
    assert effects_of(whole.identified.problem, q, 0) is None


def test_a_stretch_in_which_the_compass_was_silent():
    """It is fitted by the rate of turn; its heading holds no residual, and nothing is measured of it."""
    made = table()
    made.loc[200:240, "delta"] = NAN
    made.loc[241:, "psi"] = NAN
    fit = shipid.assess(fitted(made))
    assert [c.samples["psi"][0] for c in fit.fitted] == [200, 0] and set(fit.fitted[1].rmse) == {"r"}
    assert fit.fitted[1].measures.kind == ""
    near_truth(fit)
    json.dumps(fit.to_dict(), allow_nan=False)


@pytest.mark.parametrize("seed", [10, 20])
def test_a_speed_that_a_noisy_log_gives_as_one_number_is_in_the_intervals(seed):
    """The gain of a model scaled by the speed goes with its square: of twenty samples of 0.13 m/s, one per cent of 8 m/s."""
    noise = "psi=0.3 deg,r=0.03 deg/s,u=0.13 m/s"
    trial = shipid.simulate("cubic", "kvlcc2", "zigzag:20/20", noise=noise, seed=seed)
    gain = shipid.identify("cubic", [trial], ship="kvlcc2", signals=["psi", "r"], starts=1).parameters["a"]
    truth = shipid.find_ship("kvlcc2").values(shipid.find_model("cubic"))["a"]
    assert abs(gain.value - truth) < 3 * gain.std
    assert 0.003 * truth < gain.std < 0.02 * truth
