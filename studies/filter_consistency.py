"""Is a filter as far off as it says? Simulated runs in which model and noise are what the filter believes.

A ship (De Keizer's model with sway) is sailed through 20/20 zig-zags with white noise on yaw and surge, integrated ten times
finer than the filter steps; her gain, time constant and first state are drawn from what the filter believes at the start. Asked:

- the mean squared normalised innovation (NIS) over all runs inside its 95 % band, for all sensors together;
- the mean squared normalised error of the estimates (NEES), states and parameters, inside the 95 % band of one moment over
  all runs, averaged over the record; and the same of the smoothed estimates;
- at least 85 % of the moments inside that band (neighbouring moments are correlated, so their share scatters).

    python studies/filter_consistency.py [--runs 200] [--json]
"""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

import numpy as np
from _sailing import sail
from scipy.stats import chi2
from threadpoolctl import threadpool_limits

import shipid

DURATION, INTERVAL, FINER = 400.0, 1.0, 10
SENSORS = {"psi": "0.2 deg", "r": "0.02 deg/s", "u": "0.1 m/s", "x": "10 m", "y": "10 m"}
NOISE = {"r": "0.002 deg/s^1.5", "u": "0.01 m/s^1.5"}
FIRST = {"psi": "2 deg", "r": "0.05 deg/s", "u": "0.3 m/s", "x": "20 m", "y": "20 m"}
PARAMETERS = {"K": "0.15", "tau": "0.15"}
START = {"psi": "0 deg", "r": "0 deg/s", "u": "9.5 m/s", "x": "0 m", "y": "0 m"}


def squared(error: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return errors squared over their covariance, shape (samples,)."""
    return np.asarray(np.einsum("ki,ki->k", error, np.linalg.solve(covariance, error[:, :, None])[:, :, 0]))


def consistency(name: str, estimated: dict[str, str], runs: int) -> dict[str, Any]:
    """Filter and smooth so many runs, and average."""
    kalman = shipid.ExtendedKalmanFilter(
        shipid.find_model("de-keizer"),
        "soesterberg",
        measured=SENSORS,
        noise=NOISE,
        initial=FIRST | estimated,
        start=START,
        estimated=list(estimated),
        gate=None,
    )
    t = np.arange(0, DURATION + INTERVAL, INTERVAL)
    # Between the samples of the filter the rudder runs in a straight line.
    helm = np.deg2rad(20) * np.sign(np.sin(2 * np.pi * t / 160 + 0.2))
    records, truth = sail(kalman, t, {"delta": helm, "cruise": np.full(t.size, 9.5)}, runs, FINER)
    nees, smoothed, nis, count, wide = [], [], 0.0, 0, []
    for record, true in zip(records, truth):
        run = kalman.filter(record)
        after = kalman.smooth(run)
        nees.append(squared(run.x - true, run.covariance))
        smoothed.append(squared(after.x - true, after.covariance))
        for i in run.innovations.values():
            nis += float(np.sum(i.normalised**2))
            count += i.normalised.size
        wide.append(run.std[-1] / run.std[0])
    n = truth.shape[2]
    band = tuple(float(b) / runs for b in chi2.ppf([0.025, 0.975], runs * n))
    result: dict[str, Any] = {
        "case": name,
        "runs": runs,
        "states": n,
        "nis_mean": nis / count,
        "nis_interval_95": [float(b) / count for b in chi2.ppf([0.025, 0.975], count)],
        "nees_band95": list(band),
    }
    for key, values in (("nees", np.mean(nees, axis=0)), ("smoothed_nees", np.mean(smoothed, axis=0))):
        result[f"{key}_mean"] = float(values.mean())
        result[f"{key}_inside"] = float(np.mean((values >= band[0]) & (values <= band[1])))
    low, high = result["nis_interval_95"]
    result["holds"] = bool(
        low <= result["nis_mean"] <= high
        and all(
            band[0] <= result[f"{k}_mean"] <= band[1] and result[f"{k}_inside"] >= 0.85
            for k in ("nees", "smoothed_nees")
        )
    )
    return result


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    with threadpool_limits(1, "blas"):
        results = [
            consistency("states", {}, options.runs),
            consistency("states and two parameters", PARAMETERS, options.runs),
        ]
    if options.json:
        print(json.dumps(results, indent=1, allow_nan=False))
    else:
        print(f"{options.runs} runs of {DURATION:g} s\n")
        print(f"{'':28s}{'mean':>9s}{'95 % band':>18s}{'moments inside':>16s}")
        for r in results:
            low, high = r["nis_interval_95"]
            print(f"{r['case'] + ', NIS':38s}{r['nis_mean']:9.4f}   {low:.4f} to {high:.4f}")
            for key, label in (("nees", "NEES"), ("smoothed_nees", "smoothed NEES")):
                a, b = r["nees_band95"]
                print(
                    f"{r['case'] + ', ' + label:38s}{r[key + '_mean']:9.3f}   {a:6.3f} to {b:6.3f}{r[key + '_inside']:12.0%}"
                )
            print(f"{'':38s}{'holds' if r['holds'] else 'DOES NOT HOLD':>9s}")
    return 0 if all(r["holds"] for r in results) else 1


if __name__ == "__main__":
    sys.exit(main())
