"""What missing samples cost: a 20/20 zig-zag with holes, identified by output error. Do the intervals hold the truth, how fast?

The container ship of `recover_truth` is sailed at 1 Hz, or at 10 Hz for the cases with several rates. Noise is put on heading,
rate of turn, speed and position; noise levels are estimated from the residuals, as on a real trial. Then samples are taken out,
of every column on its own, the rudder included:

- random: each sample with a chance of 5, 20 or 50 %;
- holes: as many, in holes of 3 to 40 samples; those of the rudder split the record;
- rows: a fifth of the rows, of all columns together;
- rates: heading and rudder at 10 Hz, rate of turn at 5, speed and position at 1;
- offset: the same, each sensor with its own clock, 3 ms apart.

Asked of each case: 95 % intervals of the coefficients hold the truth 93 to 97 times in 100, and the fit takes at most 1.5 times as
long as that of the whole record with the same number of rows (medians of runs side by side).

The coverage of so few runs scatters by its binomial error, of which two are allowed for; the short form allows for 2.5 times as long.

    python studies/missing.py [--runs 200] [--only WORD] [--short] [--json]
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

import shipid
from shipid.generation.record import make_record
from shipid.parts.sensors import standard_noise

#: De Keizer's container, as in `recover_truth`.
TRUTH = {"K": 1.6, "tau": 1.7, "alpha3": 2.0, "gamma": 0.573, "K_u": 0.9, "tau_u": 2.5}
SIGNALS = ("psi", "r", "u", "x", "y")
SPEED, DURATION = 9.5, 600.0
LOW, HIGH, SLOWEST = 0.93, 0.97, 1.5
#: Rows between two samples of each column of a 10 Hz record, and seconds by which its clock is late.
EVERY = {"psi": 1, "delta": 1, "r": 2, "u": 10, "x": 10, "y": 10}
LATE = {"psi": 0.0, "delta": 0.003, "r": 0.006, "u": 0.009, "x": 0.012, "y": 0.012}

Table = pd.DataFrame
Spoil = Callable[[Table, Any], Table]


@dataclass(frozen=True)
class Case:
    """A way of taking samples out.

    Attributes
    ----------
    name : str
        In words.
    sampling : float
        Of the whole record, in s.
    spoil : callable
        From a whole record, and a generator of random numbers, to one with missing samples.
    """

    name: str
    sampling: float
    spoil: Spoil


def at_random(share: float) -> Spoil:
    """Each sample is missing with the same chance."""

    def spoil(table: Table, rng: Any) -> Table:
        gone = rng.random(table.shape) < share
        gone[:, 0] = False
        return table.mask(gone)

    return spoil


def in_holes(share: float) -> Spoil:
    """So many samples of each column are missing, in holes of 3 to 40."""

    def spoil(table: Table, rng: Any) -> Table:
        gone = np.zeros(table.shape, dtype=bool)
        for j in range(1, table.shape[1]):
            while gone[:, j].mean() < share:
                begin = int(rng.integers(0, len(table)))
                gone[begin : begin + int(rng.integers(3, 41)), j] = True
        return table.mask(gone)

    return spoil


def rows_at_random(share: float) -> Spoil:
    """Whole rows are missing: what the rudder did between those that are left is not known either."""

    def spoil(table: Table, rng: Any) -> Table:
        return table[rng.random(len(table)) >= share].reset_index(drop=True)

    return spoil


def at_rates(table: Table, _: Any) -> Table:
    """Each sensor at its own rate, at the same stamps."""
    gone = np.array([np.arange(len(table)) % EVERY.get(n, 1) != 0 for n in table.columns]).T
    return table.mask(gone)


def offset(table: Table, _: Any) -> Table:
    """Each sensor at its own rate and with its own clock: the stamps of all, 3 ms apart."""
    t = table["t"].to_numpy()
    parts = []
    for late in sorted(set(LATE.values())):
        names = [n for n in table.columns if LATE.get(n) == late]
        every = EVERY[names[0]]
        # What a sensor shows a few milliseconds later differs by less than its noise; the rudder is read exactly.
        own = {n: np.interp(t + late, t, table[n])[::every] for n in names}
        parts.append(pd.DataFrame({"t": (t + late)[::every], **own}))
    return pd.concat(parts).sort_values("t", ignore_index=True)[list(table.columns)]


CASES = (
    *(Case(f"{share:.0%} missing at random", 1.0, at_random(share)) for share in (0.05, 0.2, 0.5)),
    *(Case(f"{share:.0%} missing in holes", 1.0, in_holes(share)) for share in (0.05, 0.2, 0.5)),
    Case("20% of the rows missing", 1.0, rows_at_random(0.2)),
    Case("10, 5 and 1 Hz", 0.1, at_rates),
    Case("10, 5 and 1 Hz, 3 ms apart", 0.1, offset),
)


def clean_record(sampling: float) -> tuple[shipid.Model, Table]:
    """Return the model and a noise-free 20/20 zig-zag, sailed again with the recorded rudder."""
    model = shipid.find_model("de-keizer")
    values = {n: (v, model[n].unit) for n, v in TRUTH.items()}
    sailed = shipid.simulate(
        model, "soesterberg", "zigzag:20/20", speed=SPEED, duration=DURATION, sampling=sampling, values=values
    )
    t, count = sailed["t"], len(sailed)
    record = make_record(model, SIGNALS)
    shown = {"delta": sailed["delta"], "cruise": np.full(count, SPEED)}
    inputs = np.array([shown.get(n, np.zeros(count)) for n in model.inputs])
    x0 = np.array([SPEED if s == "u" else 0.0 for s in model.states])
    known = shipid.find_ship("soesterberg").values(model) | TRUTH
    p = record.system.vector(record.system.coefficients, known)
    y, _ = record(x0, inputs, np.diff(t, append=t[-1]), p)
    return model, pd.DataFrame({"t": t, "delta": sailed["delta"], **dict(zip(SIGNALS, y))})


def identified(model: shipid.Model, table: Table, run: int) -> tuple[shipid.Fit, float]:
    """Return the fit of a table, and the processor time it took in s."""
    trial = shipid.Trial(f"run-{run}", table)
    begin = time.process_time()
    fit = shipid.identify(
        model, [trial], ship="soesterberg", estimate=tuple(TRUTH), signals=SIGNALS, starts=1, seed=run
    )
    return fit, time.process_time() - begin


def measure(case: Case, runs: int, timed: int, slowest: float = SLOWEST) -> dict[str, Any]:
    """Identify so many records of a case and count."""
    model, clean = clean_record(case.sampling)
    noise = {n: d for n, d in standard_noise().items() if n in SIGNALS}
    inside, errors, spreads, failed = [], [], [], 0
    names: tuple[str, ...] = ()
    ratios, stretches, shares = [], [], []
    for run in range(runs):
        rng = np.random.default_rng([2026, run])
        noisy = clean.copy()
        for name, deviation in noise.items():
            noisy[name] += deviation * rng.standard_normal(len(noisy))
        spoilt = case.spoil(noisy, rng)
        shares.append(float(spoilt[list(SIGNALS)].notna().to_numpy().mean()))
        fit, seconds = identified(model, spoilt, run)
        if run < timed:
            # A whole record with the same rows.
            whole = pd.DataFrame({n: np.interp(spoilt["t"], noisy["t"], noisy[n]) for n in noisy.columns})
            # The last stamps of all sensors read the end of the record.
            whole = whole[np.diff(whole["t"], prepend=-1.0) > 0].reset_index(drop=True)
            # Twice each: a computer that does something else as well is never too fast.
            again = identified(model, spoilt, run)[1]
            ratios.append([min(seconds, again), min(identified(model, whole, run)[1] for _ in range(2))])
        if not fit.converged:
            failed += 1
            continue
        names = fit.estimated
        found = [fit.parameters[n] for n in names]
        inside.append([e.ci95[0] <= TRUTH[n] <= e.ci95[1] if e.ci95 else True for n, e in zip(names, found)])
        errors.append([e.value - TRUTH[n] for n, e in zip(names, found)])
        spreads.append([e.std for e in found])
        stretches.append(len(fit.fitted))
    error = float(np.sqrt(0.95 * 0.05 / runs))
    hits, scatter = np.mean(inside, axis=0), np.std(errors, axis=0, ddof=1)
    together = float(np.mean(inside))
    slow, fast = np.median(ratios, axis=0)
    # The hits of coefficients of one run are correlated: the share of all scatters nearly as much as that of one.
    slack = 2 * error
    return {
        "case": case.name,
        "runs": runs,
        "not_converged": failed,
        "samples_there": float(np.mean(shares)),
        "stretches": float(np.mean(stretches)),
        "coverage": together,
        "asked": [LOW - slack, min(1.0, HIGH + slack)],
        "parameters": {
            n: {
                "coverage": float(h),
                "mean_std_over_scatter": float(m / s),
                "scatter": float(s),
                "bias_over_scatter": float(b / s),
            }
            for n, h, m, s, b in zip(names, hits, np.mean(spreads, axis=0), scatter, np.mean(errors, axis=0))
        },
        "seconds": float(slow),
        "time_ratio": float(slow / fast),
        "slowest_asked": slowest,
        "holds": bool(LOW - slack <= together <= HIGH + slack and slow / fast <= slowest and failed <= 0.02 * runs),
    }


def show(result: dict[str, Any]) -> None:
    """Print one case."""
    low, high = result["asked"]
    print(
        f"{result['case']}: {result['coverage']:.1%} of all truths in {result['runs']} runs (asked {low:.1%} to {high:.1%}), "
        f"{result['time_ratio']:.2f} times as long as whole (asked {result['slowest_asked']:g}): {'holds' if result['holds'] else 'DOES NOT HOLD'}"
    )
    print(
        f"  {result['samples_there']:.0%} of the samples there, {result['stretches']:.1f} stretches, {result['seconds']:.2f} s, "
        f"{result['not_converged']} not converged"
    )
    for name, r in result["parameters"].items():
        print(
            f"  {name:8s}{r['coverage']:7.1%}   mean std / scatter {r['mean_std_over_scatter']:.2f}, bias / scatter "
            f"{r['bias_over_scatter']:+.2f}, scatter {r['scatter']:.3g}"
        )
    sys.stdout.flush()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--only", default="", help="the cases with this word in their names")
    parser.add_argument("--short", action="store_true", help="2 runs of a case of each kind")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    results = []
    with threadpool_limits(1, "blas"):
        for case in (c for c in (CASES[1::3] if options.short else CASES) if options.only in c.name):
            runs = 2 if options.short else options.runs
            # Times of a few runs scatter.
            results.append(
                measure(case, runs, min(runs, 1 if options.short else 20), 2.5 if options.short else SLOWEST)
            )
            if not options.json:
                show(results[-1])
    if options.json:
        print(json.dumps(results, indent=1, allow_nan=False))
    return 0 if all(r["holds"] for r in results) else 1


if __name__ == "__main__":
    sys.exit(main())
