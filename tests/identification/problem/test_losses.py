"""Robust losses: the weights of SciPy's own, the truth under wild samples, and intervals that hold it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

import shipid
from shipid.identification.problem.losses import curvature_of, robust_scale, weights_of

UNITS = {"t": "s", "delta": "rad", "psi": "rad", "r": "rad/s", "u": "m/s"}
NAMES = ("a", "b1", "b3")


@pytest.mark.parametrize(("loss", "theirs", "bend"), [("huber", "huber", 1.345), ("soft-l1", "soft_l1", 2.0)])
def test_the_loss_is_scipys(loss, theirs, bend):
    """A location by reweighting ends where `scipy.optimize.least_squares` ends with that loss and scale."""
    rng = np.random.default_rng(3)
    sample = np.concatenate([rng.standard_normal(60), rng.uniform(5, 30, 8)])
    expected = least_squares(lambda m: m - sample, [0.0], loss=theirs, f_scale=bend, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    middle = 0.0
    for _ in range(200):
        weights = weights_of(loss, middle - sample, 1.0)
        middle = float(weights @ sample / weights.sum())
    assert middle == pytest.approx(expected.x[0], abs=1e-6)


@pytest.mark.parametrize("loss", ["huber", "soft-l1", "linear"])
def test_curvature_is_the_slope_of_the_weighted_residual(loss):
    residual = np.linspace(-8, 8, 41) + 0.01
    step = 1e-6
    pulled = [(residual + s) * weights_of(loss, residual + s, 1.5) for s in (-step, step)]
    slope = (pulled[1] - pulled[0]) / (2 * step)
    assert curvature_of(loss, weights_of(loss, residual, 1.5)) == pytest.approx(slope, abs=1e-6)


def test_the_scale_is_not_moved_by_a_few():
    rng = np.random.default_rng(1)
    sample = 3.0 * rng.standard_normal(4000)
    sample[:200] = 1e6
    # 5 % of wild samples raise the median of the others by 7 %.
    assert robust_scale(sample) == pytest.approx(3.0, rel=0.12)


def wild(sail, seed):
    """A zig-zag with 5 % of its samples 5 to 15 standard deviations off."""
    trial = sail("norrbin", "zeefakkel", sampling="0.2 s", seed=seed)
    rng = np.random.default_rng([7, seed])
    table = trial.table[list(UNITS)].copy()
    for signal, size in (("psi", np.deg2rad(0.2)), ("r", np.deg2rad(0.02))):
        hit = rng.random(len(table)) < 0.05
        table.loc[hit, signal] += size * rng.choice([-1.0, 1.0], hit.sum()) * rng.uniform(5, 15, hit.sum())
    return shipid.Trial.from_frame(table, name=f"wild-{seed}", units=UNITS)


def test_the_truth_comes_back_with_five_percent_outliers(sail, truth_of):
    truth = truth_of("norrbin", "zeefakkel")
    errors: dict[str, list[list[float]]] = {"linear": [], "huber": [], "soft-l1": []}
    for seed in range(2):
        trial = wild(sail, seed)
        for loss, found in errors.items():
            fit = shipid.identify("norrbin", [trial], ship="zeefakkel", loss=loss, starts=1)
            assert fit.converged and fit.loss == loss
            found.append([fit.parameters[n].value / truth[n] - 1 for n in NAMES])
            if loss == "linear":
                continue
            assert f"{loss} loss" in fit.method and fit.to_dict()["loss"] == loss
            for n in NAMES:
                # Four standard deviations, seeds fixed.
                assert abs(fit.parameters[n].value - truth[n]) < 4 * fit.parameters[n].std, (loss, n)
            # The noise level is that of the sensors, not of the wild samples; 5 % of them raise the median by 7 %.
            assert np.rad2deg(fit.noise["psi"]) == pytest.approx(0.2, rel=0.15)
    size = {loss: np.sqrt(np.mean(np.square(e))) for loss, e in errors.items()}
    assert max(size["huber"], size["soft-l1"]) < 0.6 * size["linear"]


@pytest.mark.parametrize("loss", ["huber", "soft-l1"])
def test_without_outliers_little_is_lost(sail, loss):
    """The interval of a clean trial widens by the efficiency of the loss on normal residuals: 1/0.95 and 1/0.98."""
    trial = sail("norrbin", "zeefakkel", sampling="0.2 s")
    plain = shipid.identify("norrbin", [trial], ship="zeefakkel", starts=1)
    robust = shipid.identify("norrbin", [trial], ship="zeefakkel", starts=1, loss=loss)
    efficiency = {"huber": 0.95, "soft-l1": 0.979}[loss]
    for n in NAMES:
        # The colour of the residuals is estimated anew, which moves a standard deviation by a few per cent.
        assert robust.parameters[n].std == pytest.approx(plain.parameters[n].std / np.sqrt(efficiency), rel=0.06)
