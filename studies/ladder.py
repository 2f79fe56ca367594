"""The rungs of the ladder: bad starts, noisy rates, outliers, and a sampled posterior.

- bad starts: 20 for each of three models on a 20/20 zig-zag of 600 samples, coefficients a tenth to ten times the truth (the
  cubic as far as 1/33 to 8 times the gain, 1/20 to 17 times the time constant, and a cubic coefficient of either sign), 15 or
  20 % of them with the wrong sign, no bounds. Counted: searches that end within 1 % of the cost at the truth, by output error
  alone and by multiple shooting finished by output error. Asked: nowhere fewer, and at least 15 of the 60 starts that only
  multiple shooting brings home;
- noisy rate: 40 zig-zags with ten times the usual noise on the rate of turn. Asked: equation error by instrumental variables
  is off by less than least squares, and its mean by less than 3 standard errors of it;
- outliers: 60 zig-zags, 5 % of all samples off by 5 to 15 standard deviations to either side. Asked of Huber's and the soft-l1
  loss: the scatter of the estimates below half of that by squares, and 89 to 99 % of the truths inside 95 % intervals (180
  truths, three to a run);
- posterior: one zig-zag. Asked: the sampled 95 % intervals 0.8 to 1.25 times as wide as those of the fit, which is Gaussian
  there.

    python studies/ladder.py [--runs 60] [--json]
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

import shipid
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import Problem, make_problem
from shipid.identification.problem.signals import fitted_signals, unknown_biases
from shipid.identification.problem.trial_data import prepare
from shipid.identification.search.least_squares import minimise
from shipid.identification.search.multiple_shooting import shoot

NOISE = {"psi": "0.2 deg", "r": "0.02 deg/s", "u": "0.1 m/s", "v": "0.1 m/s"}
SIGMA = {"psi": np.deg2rad(0.2), "r": np.deg2rad(0.02), "u": 0.1, "v": 0.1}
Draw = Callable[[Any, np.ndarray], np.ndarray]


def cubic(rng: Any, truth: np.ndarray) -> np.ndarray:
    """Draw gain, time constant and cubic coefficient, and return a, b1, b3."""
    a, b1, _ = truth
    gain = a / b1 * np.exp(rng.uniform(np.log(0.03), np.log(8))) * rng.choice([1, -1], p=[0.8, 0.2])
    tau = np.exp(rng.uniform(np.log(0.05), np.log(17))) / b1
    return np.array([gain, 1.0, rng.uniform(-5000, 5000)]) / tau


def decade(rng: Any, truth: np.ndarray) -> np.ndarray:
    """Draw each coefficient within a decade to either side, 15 % with the wrong sign."""
    factor = np.exp(rng.uniform(np.log(0.1), np.log(10), truth.size))
    return truth * factor * rng.choice([1, -1], p=[0.85, 0.15], size=truth.size)


CASES: tuple[tuple[str, str, Draw], ...] = (
    ("norrbin", "zeefakkel", cubic),
    ("bech", "kvlcc2", decade),
    ("davidson-schiff", "mariner", decade),
)


def problem_of(model: str, ship: str) -> tuple[Problem, np.ndarray, float]:
    """Return a simulated problem, the truth, and L/U."""
    found, own = shipid.find_model(model), shipid.find_ship(ship)
    speed, length = own.particular("speed", "m/s"), own.particular("L", "m")
    trial = shipid.simulate(found, own, "zigzag:20/20", noise=NOISE, sampling="1 s", duration="599 s")
    known = own.values(found, speed=speed)
    names = tuple(n for n in found.parameters if found[n].quantity.estimated)
    signals = fitted_signals(found, [trial])
    problem = make_problem(
        found,
        [prepare(found, trial, signals, speed)],
        signals,
        names,
        {n: v for n, v in known.items() if n not in names},
        np.array([SIGMA[s] for s in signals]),
        unknown_biases(found, signals),
    )
    return problem, np.array([known[n] for n in names]), length / speed


def bad_starts() -> list[dict[str, Any]]:
    """Count for each model which method comes home from where."""
    rows = []
    for model, ship, draw in CASES:
        problem, truth, unit_time = problem_of(model, ship)
        free = np.full(truth.size, np.inf)
        box = Box(truth, -free, free)
        best = minimise(problem, problem.first_guess(truth), box, most=200).cost
        rng = np.random.default_rng(4)
        home, seconds = [], [0.0, 0.0]
        for _ in range(20):
            q0 = problem.first_guess(draw(rng, truth))
            begin = time.perf_counter()
            single = minimise(problem, q0, box, most=200)
            between = time.perf_counter()
            joined = shoot(problem, q0, box, unit_time)
            multiple = minimise(problem, joined.q, box, most=200)
            seconds[0] += between - begin
            seconds[1] += time.perf_counter() - between
            home.append([single.cost < 1.01 * best, multiple.cost < 1.01 * best])
        single_home, multiple_home = np.array(home).T
        rows.append(
            {
                "model": model,
                "output_error": int(single_home.sum()),
                "multiple_shooting": int(multiple_home.sum()),
                "only_multiple_shooting": int((multiple_home & ~single_home).sum()),
                "either": int((multiple_home | single_home).sum()),
                "seconds": seconds,
            }
        )
    return rows


def _truth() -> np.ndarray:
    own = shipid.find_ship("zeefakkel")
    known = own.values(shipid.find_model("norrbin"), speed=own.particular("speed", "m/s"))
    return np.array([known[n] for n in ("a", "b1", "b3")])


def noisy_rate(runs: int) -> dict[str, Any]:
    """Errors of equation error over runs, in shares of the truth, by method."""
    truth = _truth()
    found: dict[str, Any] = {}
    for method in ("equation-error", "instrumental-variables"):
        errors = []
        for run in range(runs):
            noise = {**NOISE, "r": "0.2 deg/s"}
            trial = shipid.simulate(
                shipid.find_model("norrbin"), "zeefakkel", "zigzag:20/20", noise=noise, sampling="0.5 s", seed=run
            )
            fit = shipid.identify("norrbin", [trial], ship="zeefakkel", method=method)
            errors.append([fit.parameters[n].value / t - 1 for n, t in zip(("a", "b1", "b3"), truth)])
        mean, spread = np.mean(errors, axis=0), np.std(errors, axis=0, ddof=1)
        found[method] = {
            "mean": dict(zip(("a", "b1", "b3"), mean.tolist())),
            "scatter": dict(zip(("a", "b1", "b3"), spread.tolist())),
            "worst_mean_in_standard_errors": float(np.abs(mean / spread).max() * np.sqrt(runs)),
        }
    return found


def outliers(runs: int, one_sided: bool = False) -> dict[str, Any]:
    """Scatter and coverage over runs with 5 % outliers, by loss."""
    truth, units = _truth(), {"t": "s", "delta": "rad", "psi": "rad", "r": "rad/s", "u": "m/s"}
    found = {}
    for loss in ("linear", "huber", "soft-l1"):
        errors, inside = [], []
        for run in range(runs):
            trial = shipid.simulate(
                shipid.find_model("norrbin"), "zeefakkel", "zigzag:20/20", noise=NOISE, sampling="0.2 s", seed=run
            )
            rng = np.random.default_rng([2026, run])
            table = trial.table[list(units)].copy()
            for signal in ("psi", "r"):
                hit = rng.random(len(table)) < 0.05
                sign = 1.0 if one_sided else rng.choice([-1.0, 1.0], hit.sum())
                table.loc[hit, signal] += SIGMA[signal] * sign * rng.uniform(5, 15, hit.sum())
            bad = shipid.Trial.from_frame(table, name=f"run-{run}", units=units)
            fit = shipid.identify("norrbin", [bad], ship="zeefakkel", loss=loss, starts=1)
            estimates = [fit.parameters[n] for n in ("a", "b1", "b3")]
            errors.append([e.value / t - 1 for e, t in zip(estimates, truth)])
            inside.append([e.ci95[0] <= t <= e.ci95[1] for e, t in zip(estimates, truth)])
        found[loss] = {
            "rms_error": dict(zip(("a", "b1", "b3"), np.sqrt(np.mean(np.square(errors), axis=0)).tolist())),
            "coverage": float(np.mean(inside)),
        }
    return found


def posterior() -> dict[str, Any]:
    """Sample one posterior."""
    trial = shipid.simulate(shipid.find_model("norrbin"), "zeefakkel", "zigzag:20/20", noise=NOISE, sampling="1 s")
    fit = shipid.identify("norrbin", [trial], ship="zeefakkel")
    return fit.sample_posterior(20_000).to_dict()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=60)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    with threadpool_limits(1, "blas"):
        starts, rate, wild, drawn = bad_starts(), noisy_rate(40), outliers(options.runs), posterior()
    rows: list[tuple[str, str, str, bool]] = [
        (
            f"{r['model']}: of 20 bad starts home by output error / multiple shooting",
            "no fewer",
            f"{r['output_error']} / {r['multiple_shooting']} ({r['seconds'][0]:.0f} / {r['seconds'][1]:.0f} s)",
            r["multiple_shooting"] >= r["output_error"],
        )
        for r in starts
    ]
    only = sum(r["only_multiple_shooting"] for r in starts)
    rows.append(("starts only multiple shooting brings home", "15 of 60 or more", str(only), only >= 15))
    squares, instruments = rate["equation-error"], rate["instrumental-variables"]
    worst = {m: max(abs(v) for v in rate[m]["mean"].values()) for m in rate}
    rows.append(
        (
            "noisy rate: largest mean error, least squares / instruments",
            "smaller, below 3 SE",
            f"{worst['equation-error']:.1%} ({squares['worst_mean_in_standard_errors']:.1f} SE) / "
            f"{worst['instrumental-variables']:.1%} ({instruments['worst_mean_in_standard_errors']:.1f} SE)",
            worst["instrumental-variables"] < worst["equation-error"]
            and instruments["worst_mean_in_standard_errors"] < 3,
        )
    )
    for loss in ("huber", "soft-l1"):
        ratio = max(wild[loss]["rms_error"][n] / wild["linear"]["rms_error"][n] for n in ("a", "b1", "b3"))
        covered = wild[loss]["coverage"]
        rows.append((f"outliers, {loss}: error over that of squares", "0.5 or less", f"{ratio:.2f}", ratio <= 0.5))
        rows.append(
            (
                f"outliers, {loss}: truths inside 95 % intervals (squares {wild['linear']['coverage']:.0%})",
                "89 to 99 %",
                f"{covered:.1%}",
                0.89 <= covered <= 0.99,
            )
        )
    widths = [p["width_over_gaussian"] for p in drawn["parameters"].values()]
    rows.append(
        (
            "posterior: width of its intervals over the fit's",
            "0.8 to 1.25, mixed",
            f"{min(widths):.2f} to {max(widths):.2f}" + ("" if drawn["mixed"] else ", NOT MIXED"),
            drawn["mixed"] and min(widths) >= 0.8 and max(widths) <= 1.25,
        )
    )
    result = {"bad_starts": starts, "noisy_rate": rate, "outliers": wild, "posterior": drawn}
    if options.json:
        print(json.dumps(result, indent=1, allow_nan=False))
    else:
        for what, asked, measured, good in rows:
            print(f"{what:78s}{asked:>22s}   {measured}{'' if good else '   MISSED'}")
    return 0 if all(good for *_, good in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
