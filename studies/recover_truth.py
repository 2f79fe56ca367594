"""Recover the truth: 60 noisy 20/20 zig-zags of the container ship, identified with six parameters.

Asked: bias within 2 standard errors, standard deviation over the Cramer-Rao bound 0.82 to 1.18, and the mean normalised
estimation error squared (NEES) inside its 95 % band, 5.1 to 6.9 for six parameters and 60 runs.

    python studies/recover_truth.py [--runs 60] [--json]
"""

from __future__ import annotations

import argparse
import json
import sys

import numpy as np
import pandas as pd
from scipy.stats import chi2

import shipid
from shipid.generation.record import make_record
from shipid.trials.simulation import standard_noise

#: De Keizer's container; alpha3, K_u and tau_u are assumed.
TRUTH = {"K": 1.6, "tau": 1.7, "alpha3": 2.0, "gamma": 0.573, "K_u": 0.9, "tau_u": 2.5}
SIGNALS = ("psi", "r", "u", "x", "y")


def clean_record() -> tuple[shipid.Model, pd.DataFrame]:
    """Return the model and a noise-free 20/20 zig-zag of 600 s at 1 Hz, sailed again with the recorded rudder.

    The rudder between two samples of a log is not known; the truth here is what the log's own rudder does, so that no
    error but the noise is left.
    """
    model = shipid.find_model("de-keizer")
    values = {n: (v, model[n].unit) for n, v in TRUTH.items()}
    sailed = shipid.simulate(
        model, "soesterberg", "zigzag:20/20", speed="9.5 m/s", duration="600 s", sampling="1 s", values=values
    )
    t, count = sailed["t"], len(sailed)
    record = make_record(model, SIGNALS)
    inputs = np.array(
        [{"delta": sailed["delta"], "cruise": np.full(count, 9.5)}.get(n, np.zeros(count)) for n in model.inputs]
    )
    x0 = [9.5 if s == "u" else 0.0 for s in model.states]
    known = shipid.find_ship("soesterberg").values(model) | TRUTH
    y, _ = record(
        np.array(x0), inputs, np.diff(t, append=t[-1]), record.system.vector(record.system.coefficients, known)
    )
    return model, pd.DataFrame({"t": t, "delta": sailed["delta"], **dict(zip(SIGNALS, y))})


def run_all(runs: int) -> dict[str, object]:
    """Identify every run and compare with the bound."""
    model, clean = clean_record()
    noise = {n: d for n, d in standard_noise().items() if n in SIGNALS}
    units = {n: shipid.trials.COLUMNS[n].unit for n in clean.columns}
    names = tuple(n for n in model.parameters if n in TRUTH)
    truth = np.array([TRUTH[n] for n in names])
    bound = None
    errors, nees = [], []
    for run in range(runs):
        rng = np.random.default_rng([2026, run])
        noisy = clean.copy()
        for name, deviation in noise.items():
            noisy[name] += deviation * rng.standard_normal(len(noisy))
        trial = shipid.Trial.from_frame(noisy, name=f"run-{run}", units=units)
        levels = {n: (d, units[n]) for n, d in noise.items()}
        # From a poor start: the assumed values of the issue are not told to the search.
        fit = shipid.identify(
            model, [trial], ship="soesterberg", estimate=names, noise=levels, signals=SIGNALS, starts=2, seed=run
        )
        if not fit.converged:
            raise SystemExit(f"run {run} did not converge: {fit.message}")
        estimate = np.array([fit.parameters[n].value for n in fit.estimated])
        error = estimate - truth
        errors.append(error)
        nees.append(float(error @ np.linalg.solve(fit.covariance, error)))
        if bound is None:
            bound = _bound(fit, truth)
    spread = np.std(errors, axis=0, ddof=1)
    bias = np.mean(errors, axis=0) / (spread / np.sqrt(runs))
    low, high = chi2.ppf([0.025, 0.975], len(names) * runs) / runs
    return {
        "parameters": {
            n: {"truth": t, "bias_in_standard_errors": b, "std": s, "bound": c, "ratio": s / c}
            for n, t, b, s, c in zip(names, truth, bias, spread, bound)
        },
        "nees": float(np.mean(nees)),
        "nees_band": [float(low), float(high)],
        "runs": runs,
    }


def _bound(fit: shipid.Fit, truth: np.ndarray) -> np.ndarray:
    """Cramer-Rao bound at the truth, with initial state, biases and current unknown."""
    problem = fit._problem
    q = fit._solution.q.copy()
    q[: len(truth)] = truth
    _, jacobian = problem.residuals(q)
    return np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))[: len(truth)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=60)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    result = run_all(options.runs)
    if options.json:
        print(json.dumps(result, indent=1, allow_nan=False))
    rows = result["parameters"]
    low, high = result["nees_band"]
    # The band of a sample standard deviation widens for fewer runs; 0.82-1.18 is the one for 60.
    slack = 0.18 * np.sqrt(60 / options.runs)
    good = all(abs(r["bias_in_standard_errors"]) <= 2 and abs(r["ratio"] - 1) <= slack for r in rows.values())
    good = good and low <= result["nees"] <= high
    if not options.json:
        print(f"{'':8s}{'truth':>8s}{'bias/SE':>9s}{'std':>10s}{'bound':>10s}{'ratio':>7s}")
        for name, r in rows.items():
            print(
                f"{name:8s}{r['truth']:8.3f}{r['bias_in_standard_errors']:9.2f}{r['std']:10.5f}{r['bound']:10.5f}"
                f"{r['ratio']:7.2f}"
            )
        print(f"asked: |bias/SE| <= 2, ratio {1 - slack:.2f} to {1 + slack:.2f}, NEES {low:.2f} to {high:.2f}")
        print(f"mean NEES {result['nees']:.2f} over {options.runs} runs: {'holds' if good else 'DOES NOT HOLD'}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
