"""Faults of sensors, clock and rudder feedback against the time a filter needs to recover.

A ship (De Keizer's model, gain and time constant estimated along) sails zig-zags for half an hour at one sample a second; heading,
rate, speed and position are measured, noise is what the filter believes. From 600 s on something is wrong. For each fault, over
the runs:

- recovered: seconds after the fault is over until every state is, for good, within 5 of its own standard deviations of the truth
  or within one of a filter that was spared the fault, and these are at most 1.5 times that filter's; median and slowest run;
- NEES: the mean squared normalised error of the states over their number while the fault lasts, and after recovery; 1 is right;
- rejected: the share of faulty samples refused, and of good samples (before, during and after) refused.

Asked: every estimate finite; all runs recovered within the time stated in the column beside; NEES below 2 after recovery, and
below 2 during the fault where the filter can know of it (sensors that fall silent; not a compass that is stuck and plausible);
outliers refused but for one in a hundred, and of good samples no more than one in a thousand where nothing else is wrong.

    python studies/filter_faults.py [--runs 20] [--json]
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from _sailing import sail
from threadpoolctl import threadpool_limits

import shipid
from shipid.estimation.recursion.gate import REJECTED

BEGIN, DURATION = 600, 1800
SENSORS = {"psi": "0.2 deg", "r": "0.02 deg/s", "u": "0.1 m/s", "x": "10 m", "y": "10 m"}
LEVELS = {"psi": np.deg2rad(0.2), "r": np.deg2rad(0.02), "u": 0.1, "x": 10.0, "y": 10.0}


@dataclass(frozen=True)
class Fault:
    """Something that goes wrong.

    Attributes
    ----------
    name : str
        In words.
    seconds : int
        How long it lasts from `BEGIN` on.
    spoil : callable
        From a record, the rows of the fault and random numbers to the spoilt record.
    within : float
        Seconds in which the filter recovers.
    known : bool
        Whether the filter can know of it, so that its estimate stays consistent meanwhile.
    counts : bool
        Whether the share of faulty samples that is refused is asked for.
    """

    name: str
    seconds: int
    spoil: Callable[..., dict[str, np.ndarray]]
    within: float
    known: bool = True
    counts: bool = False


def silent(*names: str) -> Callable[..., dict[str, np.ndarray]]:
    """Sensors or inputs that show nothing."""

    def spoil(record: dict[str, np.ndarray], rows: slice, rng: Any) -> dict[str, np.ndarray]:
        new = dict(record)
        for n in names:
            new[n] = record[n].copy()
            new[n][rows] = np.nan
        return new

    return spoil


def stuck(name: str) -> Callable[..., dict[str, np.ndarray]]:
    """A sensor that repeats the last value it showed."""

    def spoil(record: dict[str, np.ndarray], rows: slice, rng: Any) -> dict[str, np.ndarray]:
        values = record[name].copy()
        values[rows] = values[rows.start - 1]
        return record | {name: values}

    return spoil


def outliers(record: dict[str, np.ndarray], rows: slice, rng: Any) -> dict[str, np.ndarray]:
    """One sample in twenty of every sensor off by twenty standard deviations."""
    new = dict(record)
    for n, level in LEVELS.items():
        values = record[n].copy()
        hit = np.zeros(values.size, dtype=bool)
        hit[rows] = rng.random(rows.stop - rows.start) < 0.05
        values[hit] += 20 * level * rng.choice([-1, 1], np.count_nonzero(hit))
        new[n] = values
    return new


def holes(record: dict[str, np.ndarray], rows: slice, rng: Any) -> dict[str, np.ndarray]:
    """Every third value of everything is not a number, the rudder included."""
    new = dict(record)
    for n in (*LEVELS, "delta"):
        values = record[n].copy()
        values[rows][rng.random(rows.stop - rows.start) < 0.33] = np.nan
        new[n] = values
    return new


def clock(by: float, only: bool = False) -> Callable[..., dict[str, np.ndarray]]:
    """Time stamps that jump, one of them or all from then on."""

    def spoil(record: dict[str, np.ndarray], rows: slice, rng: Any) -> dict[str, np.ndarray]:
        t = record["t"].copy()
        t[rows.start : rows.start + 1 if only else None] += by
        return record | {"t": t}

    return spoil


def nothing(record: dict[str, np.ndarray], rows: slice, rng: Any) -> dict[str, np.ndarray]:
    """No fault: the ship herself does what is hard."""
    return record


FAULTS = [
    *(Fault(f"{n} silent for {s} s", s, silent(n), 60.0) for n in SENSORS for s in (1, 10, 60, 600)),
    Fault("everything silent for 60 s", 60, silent(*SENSORS), 60.0),
    Fault("everything silent for 600 s", 600, silent(*SENSORS), 120.0),
    *(Fault(f"{n} stuck for {s} s", s, stuck(n), 120.0, known=False) for n in SENSORS for s in (60, 600)),
    Fault("5 % outliers of 20 sigma, 600 s", 600, outliers, 60.0, counts=True),
    Fault("a third of everything NaN, 600 s", 600, holes, 60.0),
    Fault("rudder feedback lost for 60 s", 60, silent("delta"), 60.0),
    Fault("rudder feedback lost for 600 s", 600, silent("delta"), 60.0),
    Fault("one stamp an hour ahead", 1, clock(3600.0, only=True), 60.0),
    Fault("one stamp ten seconds back", 1, clock(-10.0, only=True), 60.0),
    Fault("clock set back by an hour", 1, clock(-3600.0), 60.0),
    Fault("clock set ahead by an hour", 1, clock(3600.0), 300.0, known=False),
    Fault("clock set ahead by 30 s", 1, clock(30.0), 300.0, known=False),
    Fault("speed through zero and back", 300, nothing, 60.0),
]


def make_filter() -> shipid.ExtendedKalmanFilter:
    """Return the filter, as a user makes one."""
    return shipid.ExtendedKalmanFilter(
        shipid.find_model("de-keizer"),
        "soesterberg",
        measured=SENSORS,
        estimated=["K", "tau"],
        noise={"r": "0.001 deg/s^1.5", "u": "0.01 m/s^1.5"},
        start={"psi": "0 deg", "r": "0 deg/s", "u": "9.5 m/s", "x": "0 m", "y": "0 m"},
        initial={"psi": "1 deg", "r": "0.05 deg/s", "u": "0.2 m/s", "x": "10 m", "y": "10 m", "K": "0.1", "tau": "0.1"},
        lost={"delta": "15 deg"},
    )


def endured(
    kalman: Any, fault: Fault, record: dict[str, np.ndarray], true: np.ndarray, calm: Any, rng: Any
) -> dict[str, Any]:
    """Filter one spoilt record and say how it went."""
    rows = slice(BEGIN, BEGIN + fault.seconds)
    spoilt = fault.spoil(record, rows, rng)
    run = kalman.filter(spoilt)
    kept = np.flatnonzero(run.arranged.forward)
    base = kalman.design.base
    n = len(base.states)
    own = [kalman.model.states.index(s) for s in base.states]
    error = (run.x - true[kept])[:, own]
    psi = base.states.index("psi")
    error[:, psi] = (error[:, psi] + np.pi) % (2 * np.pi) - np.pi
    std = run.std[:, own]
    beside = np.abs((run.x - calm.x[kept])[:, own]) <= std
    well = np.all(((np.abs(error) <= 5 * std) | beside) & (std <= 1.5 * calm.std[kept][:, own]), axis=1)
    after = kept >= rows.stop
    ill = np.flatnonzero(after & ~well)
    recovered = 0.0 if not ill.size else float(kept[ill[-1]] + 1 - rows.stop)
    covariance = run.covariance[:, own][:, :, own]
    nees = np.einsum("ki,ki->k", error, np.linalg.solve(covariance, error[:, :, None])[:, :, 0]) / n
    during = (kept >= rows.start) & (kept < rows.stop)
    later = kept >= rows.stop + recovered
    fates = run.rows("fate")
    wrong = np.array([spoilt[s][kept] != record[s][kept] for s in SENSORS]).T & np.isfinite(
        np.array([spoilt[s][kept] for s in SENSORS]).T
    )
    refused = fates == REJECTED
    return {
        "finite": bool(np.isfinite(run.x).all() and np.isfinite(run.std).all()),
        "recovered": recovered,
        "during": float(nees[during].mean()) if during.any() else 1.0,
        "later": float(nees[later].mean()) if later.any() else np.inf,
        "faulty": int(wrong.sum()),
        "faulty_refused": int((refused & wrong).sum()),
        "good": int((~wrong & (fates != 0)).sum()),
        "good_refused": int((refused & ~wrong).sum()),
        "stamps": run.arranged.back,
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--only", default="", help="faults whose name holds this")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    kalman = make_filter()
    t = np.arange(DURATION + 1.0)
    helm = np.deg2rad(15) * np.sign(np.sin(2 * np.pi * t / 170 + 0.2))
    inputs = {"delta": helm, "cruise": np.full(t.size, 9.5)}
    backing = inputs | {"u_disturbance": np.where((t >= BEGIN) & (t < BEGIN + 300), -0.05, 0.0)}
    results = []
    with threadpool_limits(1, "blas"):
        sets = {}
        for fault in FAULTS:
            if options.only not in fault.name:
                continue
            which = fault.spoil is nothing
            if which not in sets:
                records, truth = sail(kalman, t, backing if which else inputs, options.runs)
                sets[which] = records, truth, [kalman.filter(r) for r in records]
            rng = np.random.default_rng(99)
            each = [endured(kalman, fault, *parts, rng) for parts in zip(*sets[which])]
            r: dict[str, Any] = {"fault": fault.name, "asked_within_s": fault.within, "runs": options.runs}
            r["finite"] = all(e["finite"] for e in each)
            r["recovered_median_s"] = float(np.median([e["recovered"] for e in each]))
            r["recovered_slowest_s"] = max(e["recovered"] for e in each)
            r["nees_during"] = float(np.mean([e["during"] for e in each]))
            r["nees_after"] = float(np.mean([e["later"] for e in each]))
            faulty, good = sum(e["faulty"] for e in each), sum(e["good"] for e in each)
            r["faulty_refused"] = sum(e["faulty_refused"] for e in each) / faulty if faulty else None
            r["good_refused"] = sum(e["good_refused"] for e in each) / good
            r["stamps_refused"] = sum(e["stamps"] for e in each) / options.runs
            r["holds"] = bool(
                r["finite"]
                and r["recovered_slowest_s"] <= fault.within
                and r["nees_after"] < 2
                and (not fault.known or (r["nees_during"] < 2 and r["good_refused"] <= 1e-3))
                and (not fault.counts or r["faulty_refused"] >= 0.99)
            )
            results.append(r)
    if options.json:
        print(json.dumps(results, indent=1, allow_nan=False))
    else:
        print(
            f"{'':34s}{'recovered in':>14s}{'asked':>7s}{'NEES during':>13s}{'after':>7s}{'refused: faulty':>17s}{'good':>9s}{'stamps':>8s}"
        )
        for r in results:
            faulty = "-" if r["faulty_refused"] is None else f"{r['faulty_refused']:.1%}"
            print(
                f"{r['fault']:34s}{r['recovered_median_s']:6.0f}, {r['recovered_slowest_s']:4.0f} s{r['asked_within_s']:6.0f}"
                f"{r['nees_during']:13.2f}{r['nees_after']:7.2f}{faulty:>17s}{r['good_refused']:9.2%}{r['stamps_refused']:8.1f}"
                f"  {'holds' if r['holds'] else 'MISSED'}"
            )
    return 0 if all(r["holds"] for r in results) else 1


if __name__ == "__main__":
    sys.exit(main())
