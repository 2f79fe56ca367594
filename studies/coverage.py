"""Do 95 % intervals hold the truth 95 times in 100? Simulated campaigns of two zig-zags, for each purpose of an identification.

Ships are sailed through a 20/20 and a 10/10 zig-zag; noise is put on what the sensors show, or gusts drive the ship; the model is
identified with noise levels estimated from the record, as on a real trial; and it is counted how often the interval holds the
truth.

- white: independent noise in every sample of every signal;
- drift: a first-order process with a time constant of 5 s on every signal;
- waves: a ship's yaw in waves (a second-order filter at 0.6 rad/s with a damping of 0.15, 0.2 deg/s rms) on heading and rate
  alike, on top of the white noise;
- gust:SIZE:TIME: a yaw acceleration of SIZE rad/s^2 (standard deviation) that lasts for TIME s, on top of the white noise; `gusts`
  is all of three sizes and three times;
- structure: white noise, and a ship with a cubic damping under a model that has none. There is no true value: the gain that a
  steady turn at 15 degrees would show stands for it, and by how much the intervals miss is printed, not asked.

Asked: 93 to 97 % of all truths, for each ship, noise and purpose in which the model is right. Output error (no purpose, and
prediction) has no noise that drives the states: under gusts the model of the noise is wrong, and its coverage is printed, not
asked. For a filter drift and waves are told from gusts by the likelihood, and the coefficients are then output error's. A single
parameter of 400 runs scatters by 1.1 % itself, so that one in fifteen leaves that band by chance where the intervals are exact;
each is printed with its standard error, and is asked to lie in the band widened by two of them. Each noise has draws of its own, so that
rows do not share their luck.

    python studies/coverage.py [--runs 400] [--noise white,drift,waves,gusts,structure] [--for none,prediction,filter]
                               [--ships nomoto,norrbin,de-keizer] [--seed 2026] [--short] [--json]
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import dataclass
from typing import Any
from zlib import crc32

import numpy as np
import pandas as pd
from scipy.signal import lfilter
from threadpoolctl import threadpool_limits

import shipid
from shipid.declaration.vocabulary import FIELDS
from shipid.generation.record import make_record

#: Standard deviation of the sensors, SI.
SENSORS = {"psi": np.deg2rad(0.2), "r": np.deg2rad(0.02), "u": 0.05, "v": 0.05}
#: Time constant of the drift in s; frequency, damping and rate of turn of the waves, SI.
DRIFT = 5.0
WAVES = (0.6, 0.15, np.deg2rad(0.2))
LOW, HIGH = 0.93, 0.97


@dataclass(frozen=True)
class Ship:
    """A ship whose truth is known.

    Attributes
    ----------
    model, ship : str
        Their names.
    signals : tuple of str
        What is measured.
    sampling : float
        In s.
    truth : dict of str to float
        Coefficients that replace those of the ship, SI.
    """

    model: str
    ship: str
    signals: tuple[str, ...]
    sampling: float
    truth: dict[str, float]


SHIPS = (
    Ship("nomoto", "zeefakkel", ("psi", "r"), 0.5, {"K": 0.08, "tau": 12.0}),
    Ship("norrbin", "zeefakkel", ("psi", "r"), 0.5, {}),
    Ship("de-keizer", "soesterberg", ("psi", "r", "u", "v"), 1.0, {"alpha3": 2.0}),
)
#: Sizes and correlation times of the gusts, rad/s^2 and s.
GUSTS = ((3e-5, 1e-4, 3e-4), (5.0, 20.0, 60.0))
#: Cubic damping n3 of the ship under a model that has none, s^2/rad^2, and the rudder of the steady turn, rad.
CUBIC, STEADY = 300.0, np.deg2rad(15.0)
MANOEUVRES = ("zigzag:20/20", "zigzag:10/10")


@dataclass(frozen=True)
class Sailed:
    """A ship with known coefficients and the rudder of each manoeuvre.

    Attributes
    ----------
    ship : Ship
        What is measured, and how often.
    model, true : Model
        What is fitted, and what sails.
    known, truth : dict of str to float
        Coefficients of what sails, and what the intervals of the fitted ones should hold.
    speed : float
        In m/s.
    rudders : list of (ndarray, ndarray)
        Times and angles, by manoeuvre.
    """

    ship: Ship
    model: shipid.Model
    true: shipid.Model
    known: dict[str, float]
    truth: dict[str, float]
    speed: float
    rudders: list[tuple[np.ndarray, np.ndarray]]

    def table(self, index: int, gust: tuple[float, float] | None, rng: Any) -> pd.DataFrame:
        """Return a manoeuvre without sensor noise, sailed again with its recorded rudder."""
        t, delta = self.rudders[index]
        count, signals, step = len(t), self.ship.signals, self.ship.sampling
        shown = {"delta": delta, "u": np.full(count, self.speed), "cruise": np.full(count, self.speed)}
        if gust is not None:
            size, time = gust
            shown["r_disturbance"] = size * first_order(time, count, step, rng)
        inputs = np.array([shown.get(n, np.zeros(count)) for n in self.true.inputs])
        record = make_record(self.true, signals)
        x0 = np.array([self.speed if s == "u" else 0.0 for s in self.true.states])
        p = record.system.vector(record.system.coefficients, self.known)
        y, _ = record(x0, inputs, np.diff(t, append=t[-1]), p)
        extra = {} if "u" in signals else {"u": shown["u"]}
        return pd.DataFrame({"t": t, "delta": delta, **dict(zip(signals, y)), **extra})


def first_order(time: float, count: int, step: float, rng: Any) -> np.ndarray:
    """Return a first-order process of unit variance, shape (count,)."""
    phi, before = np.exp(-step / time), int(20 * time / step)
    drive = np.sqrt(1 - phi**2) * rng.standard_normal(count + before)
    return np.asarray(lfilter([1.0], [1.0, -phi], drive)[before:])


def sailed(ship: Ship, structure: bool = False) -> Sailed:
    """Return a ship and the rudder of each manoeuvre; with another structure than the model's where that is asked."""
    model, own = shipid.find_model(ship.model), shipid.find_ship(ship.ship)
    speed = own.particular("speed", "m/s")
    truth = own.values(model, speed=speed) | ship.truth
    true, values, known = model, {n: (v, model[n].unit) for n, v in ship.truth.items()}, truth
    if structure:
        true = shipid.find_model("norrbin")
        gain, tau = truth["K"], truth["tau"]
        known = {"a": gain / tau, "b1": 1 / tau, "b3": CUBIC / tau}
        values = {n: (v, true[n].unit) for n, v in known.items()}
        rate = min(x.real for x in np.roots([CUBIC, 0.0, 1.0, -gain * STEADY]) if abs(x.imag) < 1e-12)
        truth = truth | {"K": float(rate) / STEADY}
    rudders = []
    for manoeuvre in MANOEUVRES:
        first = shipid.simulate(true, own, manoeuvre, sampling=ship.sampling, values=values)
        rudders.append((first["t"], first["delta"]))
    return Sailed(ship, model, true, known, truth, speed, rudders)


def noise_on(signals: tuple[str, ...], kind: str, count: int, step: float, rng: Any) -> dict[str, np.ndarray]:
    """Return noise by signal, shape (count,) each."""
    white = {s: SENSORS[s] * rng.standard_normal(count) for s in signals}
    if kind not in ("drift", "waves"):
        return white
    if kind == "drift":
        return {s: SENSORS[s] * first_order(DRIFT, count, step, rng) for s in signals}
    omega, zeta, rate = WAVES
    fine = max(1, int(np.ceil(step / 0.1)))
    dt, before = step / fine, 1000
    # Exact steps of psi'' + 2 zeta omega psi' + omega^2 psi = w, whose rate has the variance q / (4 zeta omega).
    from scipy.linalg import expm

    a = np.array([[0.0, 1.0], [-(omega**2), -2 * zeta * omega]])
    q = np.array([[0.0, 0.0], [0.0, 4 * zeta * omega * rate**2]])
    block = expm(np.block([[-a, q], [np.zeros((2, 2)), a.T]]) * dt)
    forward = block[2:, 2:].T
    root = np.linalg.cholesky(forward @ block[:2, 2:])
    # x <- forward x + w, in the coordinates in which it is two first-order processes.
    poles, modes = np.linalg.eig(forward)
    driven = rng.standard_normal((before + count * fine, 2)) @ root.T @ np.linalg.inv(modes).T
    path = (np.stack([lfilter([1.0], [1.0, -p], d) for p, d in zip(poles, driven.T)], axis=1) @ modes.T).real
    by_waves = dict(zip(("psi", "r"), path[before::fine].T))
    return {s: w + by_waves.get(s, 0.0) for s, w in white.items()}


def coverage(ship: Ship, kind: str, runs: int, purpose: str | None = None, seed: int = 2026) -> dict[str, Any]:
    """Identify so many campaigns and count."""
    own = sailed(ship, kind == "structure")
    gust = tuple(map(float, kind.split(":")[1:])) if kind.startswith("gust:") else None
    right = kind in ("white", "drift", "waves") or (purpose == "filter" and gust is not None)
    begin, names, inside, errors, spreads, lost, told = time.perf_counter(), (), [], [], [], 0, 0
    for run in range(runs):
        rng = np.random.default_rng([seed, crc32(kind.encode()), run])
        trials = []
        for k in range(len(own.rudders)):
            noisy = own.table(k, gust, rng)
            for signal, noise in noise_on(ship.signals, kind, len(noisy), ship.sampling, rng).items():
                noisy[signal] += noise
            units = {n: FIELDS[n].unit for n in noisy.columns}
            trials.append(shipid.Trial.from_frame(noisy, name=f"trial-{k}", units=units))
        fit = shipid.identify(own.model, trials, ship=ship.ship, signals=ship.signals, starts=1, purpose=purpose)
        if not fit.converged:
            lost += 1
            continue
        told += any(n.serious for n in fit.warnings)
        names = [n for n in fit.estimated if kind != "structure" or n == "K"]
        found = [fit.parameters[n] for n in names]
        inside.append([e.ci95 is not None and e.ci95[0] <= own.truth[n] <= e.ci95[1] for n, e in zip(names, found)])
        errors.append([e.value - own.truth[n] for n, e in zip(names, found)])
        spreads.append([e.std for e in found])
    if len(inside) < 2:
        raise SystemExit(f"{ship.model}, {kind}: {lost} of {runs} campaigns did not converge.")
    runs, truth = len(inside), own.truth
    hits, scatter = np.mean(inside, axis=0), np.std(errors, axis=0, ddof=1)
    error = float(np.sqrt(0.95 * 0.05 / runs))
    rows = [
        {
            "parameter": n,
            "truth": truth[n],
            "coverage": float(h),
            "binomial_error": error,
            "mean_std_over_scatter": float(m / s),
            "mean_error_over_scatter": float(e / s),
            "holds": bool(not right or LOW - 2 * error <= h <= HIGH + 2 * error),
        }
        for n, h, m, e, s in zip(names, hits, np.mean(spreads, axis=0), np.mean(errors, axis=0), scatter)
    ]
    together = float(np.mean(inside))
    # A short form is asked what so few runs can show.
    slack = max(0.0, 2 * (error - np.sqrt(0.95 * 0.05 / 400)))
    return {
        "model": ship.model,
        "ship": ship.ship,
        "noise": kind,
        "purpose": purpose or "none",
        "runs": runs,
        "not_converged": lost,
        "told": told,
        "right": right,
        "coverage": together,
        "parameters": rows,
        "seconds": time.perf_counter() - begin,
        "holds": bool(not right or (LOW - slack <= together <= HIGH + slack and all(r["holds"] for r in rows))),
    }


def show(result: dict[str, Any]) -> None:
    """Print one ship under one noise."""
    verdict = ("holds" if result["holds"] else "DOES NOT HOLD") if result["right"] else "the model is wrong, not asked"
    print(
        f"{result['model']} / {result['ship']}, {result['noise']}, for {result['purpose']}: {result['coverage']:.1%} of all truths "
        f"in {result['runs']} campaigns ({result['not_converged']} not converged, {result['told']} with a serious warning, {result['seconds']:.0f} s): {verdict}"
    )
    for r in result["parameters"]:
        mark = "" if r["holds"] else "  missed"
        print(
            f"  {r['parameter']:8s}{r['coverage']:7.1%} ± {r['binomial_error']:.1%}   mean std / scatter "
            f"{r['mean_std_over_scatter']:.2f}, mean error / scatter {r['mean_error_over_scatter']:+.2f}{mark}"
        )


def kinds(text: str) -> list[str]:
    """Return the noises that are asked, `gusts` spelt out."""
    every = [f"gust:{size:g}:{time:g}" for size in GUSTS[0] for time in GUSTS[1]]
    return [k for kind in text.split(",") for k in (every if kind == "gusts" else [kind])]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument("--noise", default="white,drift,waves,gusts,structure")
    parser.add_argument("--for", dest="purposes", default="none,prediction,filter", help="as shipid identify has it")
    parser.add_argument("--ships", default="nomoto,norrbin,de-keizer")
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--short", action="store_true", help="one ship, one gust and white noise, for a filter")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if options.short:
        options.runs, options.ships, options.purposes = 10, "nomoto", "filter"
        options.noise = f"white,gust:{GUSTS[0][1]:g}:{GUSTS[1][1]:g}"
    results = []
    with threadpool_limits(1, "blas"):
        for ship in (s for s in SHIPS if s.model in options.ships.split(",")):
            for kind in kinds(options.noise):
                if kind == "structure" and ship.model != "nomoto":
                    continue
                for purpose in options.purposes.split(","):
                    asked = None if purpose == "none" else purpose
                    results.append(coverage(ship, kind, options.runs, asked, options.seed))
                    if not options.json:
                        show(results[-1])
                        sys.stdout.flush()
    if options.json:
        print(json.dumps(results, indent=1, allow_nan=False))
    return 0 if all(r["holds"] for r in results) else 1


if __name__ == "__main__":
    sys.exit(main())
