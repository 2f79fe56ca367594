"""Speed: a compiled fit against the same fit with SciPy's finite differences over ``solve_ivp``, and the command line.

Asked: 600 samples and 4 unknowns, compiled and cached: 25 ms or less a fit from a good start, and at least 10 times faster than
the same fit with finite differences over ``solve_ivp``; ``shipid --help`` in 0.3 s; ``shipid identify`` with its report on one
trial with a warm cache in 1.5 s, with another trial to predict in 2 s, with an empty cache in 5 s; a joint fit of nine coefficients to four tank trials of 66 to 210 s at 20 Hz in 5 s, where the trials are at
hand (``../shared/data`` or ``--data``). Single times depend on the machine; ratios are taken within one run.

    python studies/speed.py [--json]
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

import shipid
from shipid.generation.record import make_record
from shipid.generation.simulator import coefficient_vector, initial_state
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import make_problem
from shipid.identification.problem.trial_data import prepare
from shipid.identification.search.least_squares import minimise

SIGNALS = ("psi", "r")
NAMES = ("a", "b1", "b3")
SIGMA = np.deg2rad([0.2, 0.02])


def best_of(action: Callable[[], object], repeats: int) -> float:
    """Return the shortest time of several in seconds: noise of the machine only ever adds."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return min(times)


def fits() -> dict[str, float]:
    """Time one fit of Norrbin's model (a, b1, b3 and a rudder bias) from 20 % off, both ways."""
    model = shipid.find_model("norrbin")
    trial = shipid.simulate(
        model,
        "zeefakkel",
        "zigzag:20/20",
        speed="5 m/s",
        duration="599 s",
        sampling="1 s",
        noise={"psi": "0.2 deg", "r": "0.02 deg/s"},
    )
    data = prepare(model, trial, SIGNALS, None)
    problem = make_problem(model, [data], SIGNALS, NAMES, {}, SIGMA, ("delta",))
    # The initial state is held in both: the four unknowns are a, b1, b3 and the bias.

    problem = replace(problem, initial=())
    known = shipid.find_ship("zeefakkel").values(model, speed=5.0)
    truth = np.array([known[n] for n in NAMES])
    box = Box(1.2 * truth, 0.01 * truth, 100 * truth)
    q0 = problem.first_guess(box.start)

    compiled = minimise(problem, q0, box, most=50)
    ours = best_of(lambda: minimise(problem, q0, box, most=50), 7)

    t, delta = trial["t"], trial["delta"]

    def residual(q: np.ndarray) -> np.ndarray:
        a, b1, b3, bias = q

        def rate(at: float, x: np.ndarray) -> list[float]:
            return [x[1], a * (np.interp(at, t, delta) + bias) - b1 * x[1] - b3 * x[1] ** 3]

        x0 = [data.start["psi"], data.start["r"]]
        found = solve_ivp(rate, (t[0], t[-1]), x0, t_eval=t, rtol=1e-8, atol=1e-10, max_step=5.0)
        return np.concatenate([(y - m) / s for y, m, s in zip(found.y, data.measured, SIGMA)])

    start = np.append(box.start, 0.0)
    plain = least_squares(residual, start, x_scale="jac", diff_step=1e-4, ftol=1e-8, xtol=1e-8)
    theirs = best_of(lambda: least_squares(residual, start, x_scale="jac", diff_step=1e-4, ftol=1e-8, xtol=1e-8), 1)
    record = make_record(model, SIGNALS, NAMES, (), ("delta",))
    x0, p = initial_state(model, data.start), coefficient_vector(model, dict(zip(NAMES, truth)))
    pass_ms = 1e3 * best_of(lambda: record(x0, data.inputs, data.intervals, p), 50)
    plain_record = make_record(model, SIGNALS, NAMES, (), ("delta",), compiled=False)
    machine_ms = 1e3 * best_of(lambda: plain_record(x0, data.inputs, data.intervals, p), 20)
    return {
        "virtual_machine_ms": machine_ms,
        "fit_ms": 1e3 * ours,
        "solve_ivp_fit_ms": 1e3 * theirs,
        "ratio": theirs / ours,
        "cost": compiled.cost,
        "solve_ivp_cost": float(plain.cost),
        "pass_ms": pass_ms,
        "evaluations": compiled.evaluations,
    }


def command_line() -> dict[str, float]:
    """Time the command line as whole processes."""
    command = [sys.executable, "-m", "shipid"]
    trials = Path(__file__).parent / "trials"
    fitted, other = (str(trials / f"container-{n}.csv") for n in ("20-20", "10-10"))
    with tempfile.TemporaryDirectory() as folder:
        counter = iter(range(100))

        def call(*arguments: str, cache: str | None = None) -> None:
            environment = os.environ | ({} if cache is None else {"SHIPID_CACHE": cache})
            subprocess.run([*command, *arguments], check=True, capture_output=True, cwd=folder, env=environment)

        def identify(*options: str, cache: str | None = None) -> None:
            ship = ("--model", "de-keizer", "--ship", "soesterberg")
            call("identify", fitted, *ship, *options, "--out", f"out{next(counter)}", cache=cache)

        identify("--validate", other)
        return {
            "help_s": best_of(lambda: call("--help"), 5),
            "identify_s": best_of(identify, 3),
            "identify_and_predict_s": best_of(lambda: identify("--validate", other), 3),
            "identify_cold_s": best_of(lambda: identify(cache=f"{folder}/cache{next(counter)}"), 2),
        }


def joint(data: Path) -> dict[str, float]:
    """Time a joint fit of `bech-slipstream` to the trials of HSVA for prediction, with its starts."""
    trial_format = str(Path(__file__).parent / "formats" / "kvlcc2-hsva.toml")
    names = ("20_10_P", "20_10_S", "10_10_P", "35_05")
    files = [data / "kvlcc2-hsva" / f"HSVA_CPMC_KVLCC2_Z_{n}.dat" for n in names]
    if not all(f.is_file() for f in files):
        return {}
    trials = [shipid.read_trial(str(f), format=trial_format) for f in files]

    def fit() -> None:
        found = shipid.identify("bech-slipstream", trials, ship="kvlcc2-7m", purpose="prediction")
        if not found.converged:
            raise SystemExit(f"the joint fit did not converge: {found.message}")

    fit()
    return {"joint_s": best_of(fit, 3)}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--data", type=Path, default=Path(__file__).resolve().parents[2] / "shared" / "data")
    options = parser.parse_args()
    result = fits() | command_line() | joint(options.data)
    rows = [
        ("fit, 600 samples, 4 unknowns [ms]", result["fit_ms"], 25.0, result["fit_ms"] <= 25),
        ("the same over solve_ivp, times slower", result["ratio"], 10.0, result["ratio"] >= 10),
        ("shipid --help [s]", result["help_s"], 0.3, result["help_s"] <= 0.3),
        ("shipid identify, warm, with report [s]", result["identify_s"], 1.5, result["identify_s"] <= 1.5),
        (
            "the same, predicting another trial [s]",
            result["identify_and_predict_s"],
            2.0,
            result["identify_and_predict_s"] <= 2,
        ),
        ("shipid identify, empty cache [s]", result["identify_cold_s"], 5.0, result["identify_cold_s"] <= 5),
    ]
    if "joint_s" in result:
        rows.append(("joint fit, 4 trials, 9 coefficients [s]", result["joint_s"], 5.0, result["joint_s"] <= 5))
    if options.json:
        print(json.dumps(result, indent=1, allow_nan=False))
    else:
        print(f"{'':42s}{'measured':>10s}{'asked':>8s}")
        for label, value, asked, good in rows:
            print(f"{label:42s}{value:10.3g}{asked:8.3g}  {'holds' if good else 'MISSED'}")
        print(
            f"one pass with sensitivities {result['pass_ms']:.2f} ms ({result['virtual_machine_ms']:.2f} ms not compiled), {result['evaluations']:.0f} passes a fit; over solve_ivp "
            f"{result['solve_ivp_fit_ms']:.0f} ms; cost reached {result['cost']:.1f} against {result['solve_ivp_cost']:.1f}"
        )
    return 0 if all(good for *_, good in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
