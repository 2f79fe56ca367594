"""Prediction error: the likelihood through the filter finds coefficients and noise levels that output error mistakes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.generation.loop import make_loop
from shipid.generation.step import make_step
from shipid.generation.system import generate
from shipid.identification.identify import identify
from shipid.identification.problem.box import box_of
from shipid.identification.search.prediction_error import fit_levels

TRUTH = {"K": 0.063, "tau": 40.0}
NOISE = {"r": 2e-4, "psi": np.deg2rad(0.2), "gyro": np.deg2rad(0.02)}
LENGTH, SPEED = 226.0, 9.5


def gusty(seed: int, samples: int = 900) -> shipid.Trial:
    """Nomoto's ship under a square rudder, its rate of turn driven by white noise besides."""
    import casadi as ca

    model = shipid.find_model("nomoto")
    system = generate(model)
    step = make_step(system, "rk4", "linear")
    z, w = ca.SX.sym("z", 4), ca.SX.sym("w")
    c = ca.SX.sym("c", 2 * len(model.inputs))
    n = len(model.inputs)
    moved = step.function(z, c[:n], c[n:], system.p, 1.0)
    moved[system.states.index("r")] += w
    loop = make_loop(ca.Function("ship", [z, ca.vertcat(c, w), system.p], [moved, z]), compiled=False)
    t = np.arange(samples, dtype=float)
    delta = np.deg2rad(15) * np.clip(8 * np.sin(2 * np.pi * t / 150), -1, 1)
    u = np.zeros((samples, n))
    u[:, system.inputs.index("delta")] = delta
    u[:, system.inputs.index("u")] = SPEED
    rng = np.random.default_rng(seed)
    control = np.hstack([u, np.vstack([u[1:], u[-1:]]), NOISE["r"] * rng.standard_normal((samples, 1))])
    _, x = loop(np.zeros(4), control, system.vector(system.coefficients, TRUTH))
    psi, r = (x[:, system.states.index(s)] for s in ("psi", "r"))
    table = {
        "t [s]": t,
        "psi [rad]": psi + NOISE["psi"] * rng.standard_normal(samples),
        "r [rad/s]": r + NOISE["gyro"] * rng.standard_normal(samples),
        "delta [rad]": delta,
        "u [m/s]": np.full(samples, SPEED),
    }
    return shipid.Trial.from_frame(pd.DataFrame(table), name=f"gusty-{seed}")


@pytest.fixture(scope="module")
def fitted():
    """Output error and prediction error on twelve records."""
    rows = []
    for seed in range(12):
        fit = identify("nomoto", [gusty(seed)], ship="soesterberg", starts=1)
        problem = dataclasses.replace(fit.identified.problem)
        start = fit.identified.solution.parameters
        box = box_of({n: (float(s), 1e-3 * float(s), 1e3 * float(s)) for n, s in zip(problem.estimated, start)})
        rows.append((problem.estimated, start, fit_levels(problem, box, start, LENGTH / SPEED)))
    return rows


def test_every_search_is_at_its_maximum(fitted):
    assert all(levels.converged for _, _, levels in fitted)


def test_coefficients_are_unbiased_and_their_covariance_is_right(fitted):
    names = fitted[0][0]
    truth = np.array([TRUTH[n] for n in names])
    errors = np.array([levels.parameters - truth for _, _, levels in fitted])
    spread = np.array([np.sqrt(np.diag(levels.covariance)) for _, _, levels in fitted])
    # The mean of twelve errors within three of its standard deviations.
    assert (np.abs((errors / spread).mean(axis=0)) < 3 / np.sqrt(len(fitted))).all()
    nees = [e @ np.linalg.solve(levels.covariance, e) for e, (_, _, levels) in zip(errors, fitted)]
    # Chi-square of 24 degrees of freedom: 99.9 % lie between 8 and 51.
    assert 8 < sum(nees) < 51


def test_noise_levels_are_recovered(fitted):
    process = np.array([levels.process["r"] for _, _, levels in fitted])
    heading = np.array([levels.sensors["psi"] for _, _, levels in fitted])
    assert np.median(process) == pytest.approx(NOISE["r"], rel=0.1)
    assert np.median(heading) == pytest.approx(NOISE["psi"], rel=0.05)


def test_it_is_nearer_to_the_truth_than_output_error(fitted):
    names = fitted[0][0]
    truth = np.array([TRUTH[n] for n in names])
    by_output = np.sqrt(np.mean([(start / truth - 1) ** 2 for _, start, _ in fitted], axis=0))
    by_prediction = np.sqrt(np.mean([(levels.parameters / truth - 1) ** 2 for _, _, levels in fitted], axis=0))
    assert (by_prediction < by_output).all()


def test_the_purpose_leads_to_it_and_the_result_says_so():
    fit = identify("nomoto", [gusty(1)], ship="soesterberg", starts=1, purpose="filter")
    assert [r.method for r in fit.ladder] == ["output-error", "prediction-error"]
    assert fit.ladder[-1].used and "prediction error" in fit.method
    result = fit.to_dict()
    level = result["filter_noise"]["process"]["r"]
    assert level["unit"] == "rad/s/s^0.5" and level["value"] == pytest.approx(NOISE["r"], rel=0.3)
    assert "drives r" in fit.text()


@pytest.mark.parametrize("seed", [0, 3])
def test_noise_that_is_not_there_does_not_hold_the_search_up(seed):
    """Nothing drives this ship: 39 and 60 passes went to and fro over levels of next to nothing, and far beyond those of the sensors."""
    noise = "psi=0.2 deg,r=0.02 deg/s,u=0.05 m/s,v=0.05 m/s"
    trial = shipid.simulate("de-keizer", "soesterberg", "zigzag:20/20", sampling=1.0, noise=noise, seed=seed)
    fit = identify("de-keizer", [trial], ship="soesterberg", starts=1, purpose="filter")
    levels = fit.identified.solution.levels
    assert levels.converged and levels.evaluations <= 25
    assert levels.sensors["psi"] == pytest.approx(np.deg2rad(0.2), rel=0.1)
