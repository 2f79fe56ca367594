"""Ten million filter steps: does the covariance stay symmetric and positive, or does rounding eat it?

A ship (De Keizer's model; heading, rate, speed and position measured) turns to and fro for ever, sampled at 1 s. Three parameters
of yaw are estimated and driven by no noise, of which only two ratios show: all but one direction becomes ever surer, so that the
smallest eigenvalue of the correlation matrix falls towards zero from above as long as the filter runs. It is the case that
rounding eats first. Covariance form in double precision, square-root form in double and in single. Asked, after every thousand steps:

- the filter at work: more than 99 % of the samples taken in, every number finite;
- symmetric: by construction (the upper triangle is what is carried), looked at through the formed matrix;
- positive: the smallest eigenvalue of the correlation matrix above zero, in every look;
- no drift: in the last tenth of the run within a factor of two of that of the square root in double precision; in single
  precision not below half of it (floats stop learning at about 1e-7, which leaves the filter less sure than it could be).

Single precision in the covariance form is run beside them and reported without being asked anything: that is what the square
root is for.

    python studies/filter_endurance.py [--steps 10000000] [--json]
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

import shipid
from shipid.estimation.records.arrangement import arrange
from shipid.estimation.records.controls import controls_of
from shipid.estimation.records.first_estimate import first_carried
from shipid.estimation.records.triangles import unpacked
from shipid.estimation.recursion.gate import TAKEN

#: Samples of the swing that is sailed again and again; after each round the covariance is looked at.
PERIOD = 1000
CASES = (
    ("square-root", False, True),
    ("covariance", False, True),
    ("square-root", True, True),
    ("covariance", True, False),
)


def make_filter(form: str, single: bool) -> shipid.ExtendedKalmanFilter:
    """Return the filter in a form and a precision."""
    return shipid.ExtendedKalmanFilter(
        shipid.find_model("de-keizer"),
        "soesterberg",
        measured={"psi": "0.2 deg", "r": "0.02 deg/s", "u": "0.1 m/s", "x": "10 m", "y": "10 m"},
        estimated=["K", "tau", "alpha1"],
        noise={"r": "0.002 deg/s^1.5", "u": "0.01 m/s^1.5"},
        inputs={"cruise": "9.5 m/s"},
        form=form,
        single=single,
    )


def sail(kalman: shipid.ExtendedKalmanFilter) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Return a swing as the sensors show it, with noise that repeats, and how far the ship gets in it, by state.

    The model sails it alone, through a filter whose one sensor tells nothing; of three rounds the last, when all but the
    positions closes on itself.
    """
    t = np.arange(3 * PERIOD + 1, dtype=float)
    delta = np.deg2rad(15) * np.sin(2 * np.pi * t / 200)
    zero = np.zeros(t.size)
    alone = shipid.ExtendedKalmanFilter(
        kalman.design.base,
        kalman.design.ship,
        measured={"psi": "1e6 rad"},
        inputs={"cruise": "9.5 m/s"},
        initial={"psi": "0.01 deg"},
        gate=None,
    )
    run = alone.filter({"t": t, "delta": delta, "psi": zero})
    last = slice(2 * PERIOD, 3 * PERIOD)
    rng = np.random.default_rng(7)
    levels = zip(kalman.measured, kalman.design.r)
    shown = {n: run[n][last] + v * rng.standard_normal(PERIOD) for n, v in levels}
    far = [run[s][-1] - run[s][2 * PERIOD] if s in ("x", "y") else 0.0 for s in kalman.model.states]
    return {"t": t[:PERIOD], "delta": delta[last], **shown}, np.array(far)


def endure(form: str, single: bool, asked: bool, steps: int) -> dict[str, Any]:
    """Run so many steps and look at the covariance on the way."""
    kalman = make_filter(form, single)
    record, far = sail(kalman)
    design = kalman.design
    rows = arrange(design.instruments, record)
    z = first_carried(design, record, rows)
    loop, p, control = design.loop(), design.constants, controls_of(design, rows)
    # The swing closes on itself: its first sample comes one interval after its last.
    again = control.copy()
    again[0, design.layout.control["T"]] = 1.0
    places, n = design.layout.carried, design.layout.joint
    skew = 0.0
    begin = time.perf_counter()
    looks = max(10, steps // PERIOD)
    carried, taken = [], 0.0
    fate = design.layout.brief["fate"]
    for k in range(looks):
        z, out = loop(z, again if k else control, p)
        carried.append(np.array(z[places["P"]], dtype=float))
        taken += float(np.mean(out[:, fate] == TAKEN)) / looks
        # The same round again, from where it began.
        z[places["x"]] -= far
    seconds = time.perf_counter() - begin
    packed = np.array(carried)
    if form == "square-root":
        root = packed.reshape(looks, n, n).transpose(0, 2, 1)
        whole = root @ root.transpose(0, 2, 1)
    else:
        whole = unpacked(packed, n)
    finite = bool(np.isfinite(whole).all())
    std = np.sqrt(np.maximum(np.diagonal(whole, axis1=1, axis2=2), 0.0))
    if finite and np.all(std > 0):
        correlation = whole / (std[:, :, None] * std[:, None, :])
        skew = float(np.abs(correlation - correlation.transpose(0, 2, 1)).max())
        if form == "square-root":
            # The eigenvalues of S S' are the squares of the singular values of S: no digits are lost on the way.
            least = np.linalg.svd(root / std[:, :, None], compute_uv=False)[:, -1] ** 2
        else:
            least = np.linalg.eigvalsh(correlation)[:, 0]
    else:
        least = np.full(looks, -1.0)
    late = least[-max(1, looks // 10) :]
    return {
        "form": form,
        "precision": "single" if single else "double",
        "steps": looks * PERIOD,
        "seconds": seconds,
        "finite": finite,
        "samples_taken": taken,
        "asymmetry": skew,
        "least_eigenvalue": float(least.min()),
        "late": float(np.median(late)),
        "asked": asked,
        "positive": bool(finite and taken > 0.99 and skew < 1e-12 and np.all(least > 0)),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=10_000_000)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    with threadpool_limits(1, "blas"):
        results = [endure(*case, options.steps) for case in CASES]
    exact = results[0]["late"]
    for r in results:
        r["holds"] = not r["asked"] or (
            r["positive"] and r["late"] / exact >= 0.5 and (r["precision"] == "single" or r["late"] / exact <= 2.0)
        )
    if options.json:
        print(json.dumps(results, indent=1, allow_nan=False))
    else:
        print(f"{'':24s}{'steps':>10s}{'least eigenvalue':>18s}{'in the end':>12s}{'seconds':>9s}")
        for r in results:
            verdict = ("holds" if r["holds"] else "DOES NOT HOLD") if r["asked"] else "not asked"
            print(
                f"{r['form'] + ', ' + r['precision']:24s}{r['steps']:10d}{r['least_eigenvalue']:18.2e}{r['late']:12.2e}"
                f"{r['seconds']:9.1f}  {verdict}"
            )
    return 0 if all(r["holds"] for r in results) else 1


if __name__ == "__main__":
    sys.exit(main())
