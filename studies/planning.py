"""A planned 20 minutes beside the standard pair of zig-zags: the gain that is predicted, and the gain in simulated spread.

For three ships the manoeuvres are planned (D-optimal, the toolbox's defaults), and both designs are sailed with sensor noise
and identified jointly, 40 times each. The stated factors: the determinant of the information is at least 2 times better for
each coefficient (its n-th root), and the standard deviations are at least 1.2 times smaller in their geometric mean (the
slowest ship, for which 20 minutes are 30 L/U, is predicted 1.4, and samples of 40 scatter by some 0.1 about that). The same
is asked of the sample covariance of the estimates; that the two agree is asked within three standard deviations, which
samples of a covariance scatter by (Wishart).

    python studies/planning.py [--runs 40] [--short] [--json]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

import numpy as np
from _table import Row, show
from scipy.special import polygamma

import shipid
from shipid.declaration.vocabulary import FIELDS
from shipid.generation.record import make_record
from shipid.planning.leg import Leg
from shipid.planning.plan import Plan

CASES = (("norrbin", "zeefakkel"), ("de-keizer", "soesterberg"), ("norrbin", "kvlcc2"))
DETERMINANT, SPREAD = 2.0, 1.2
SAMPLING = 1.0


def sailed(plan: Plan, leg: Leg) -> shipid.Trial:
    """Return a leg without noise, sailed again with the recorded rudder, so that noise is the only error left."""
    clean = shipid.simulate(
        plan.model,
        plan.ship,
        leg.manoeuvre,
        speed=leg.speed,
        duration=leg.duration,
        sampling=SAMPLING,
        seed=leg.seed,
    )
    model, t = plan.model, clean["t"]
    signals = tuple(plan.noise)
    record = make_record(model, signals)
    given = {"delta": clean["delta"], "cruise": leg.speed, "u": leg.speed}
    inputs = np.array([np.broadcast_to(given.get(n, 0.0), t.shape) for n in model.inputs])
    x0 = np.array([leg.speed if s == "u" else 0.0 for s in model.states])
    known = shipid.find_ship(plan.ship).values(model, speed=leg.speed)
    p = record.system.vector(record.system.coefficients, known)
    y, _ = record(x0, inputs, np.diff(t, append=t[-1]), p)
    table = clean.table[["t", "delta"]].assign(**dict(zip(signals, y)))
    return shipid.Trial.from_frame(table, name=leg.manoeuvre, units=units_of(table.columns))


def units_of(names: Sequence[str]) -> dict[str, str]:
    return {n: FIELDS[n].unit for n in names}


def estimates(plan: Plan, legs: Sequence[Leg], runs: int, design: int) -> np.ndarray:
    """Sail and identify some times; return the estimates, shape (runs, coefficients)."""
    clean = [sailed(plan, leg) for leg in legs]
    units = units_of(tuple(plan.noise))
    noise = {n: (s, units[n]) for n, s in plan.noise.items()}
    found = np.empty((runs, len(plan.parameters)))
    for run in range(runs):
        rng = np.random.default_rng([2026, design, run])
        trials = []
        for trial in clean:
            table = trial.table.copy()
            for name, deviation in plan.noise.items():
                table[name] += deviation * rng.standard_normal(len(table))
            trials.append(shipid.Trial.from_frame(table, name=trial.name, units=units_of(table.columns)))
        fit = shipid.identify(
            plan.model,
            trials,
            ship=plan.ship,
            estimate=tuple(plan.parameters),
            noise=noise,
            signals=tuple(plan.noise),
            starts=1,
        )
        if not fit.converged:
            raise SystemExit(f"run {run} of {plan.model.name} did not converge: {fit.message}")
        found[run] = [fit.parameters[n].value for n in plan.parameters]
    return found


def wishart(runs: int, size: int) -> float:
    """Standard deviation of the logarithm of the determinant of a sample covariance."""
    return float(np.sqrt(sum(polygamma(1, (runs - 1 - i) / 2) for i in range(size))))


def rows_of(model: str, ship: str, runs: int) -> list[Row]:
    plan = shipid.plan_trials(model, ship, "20 min", sampling=SAMPLING)
    case = f"{model} of {ship}"
    text = " + ".join(f"{leg.manoeuvre} {leg.duration:.0f} s at {leg.speed:.3g} m/s" for leg in plan.legs)
    print(f"{case}: {text}", file=sys.stderr)
    forecasts = plan.parameters.values()
    size = len(forecasts)
    smaller = float(np.exp(np.mean([np.log(f.ratio) for f in forecasts])))
    rows = [
        Row(f"{case}: time", "at most 1200 s", f"{plan.duration:.0f} s: {text}", plan.duration <= 1200),
        Row(
            f"{case}: determinant, predicted",
            f"{DETERMINANT:g} or more",
            f"{plan.det_gain:.2f}",
            plan.det_gain >= DETERMINANT,
        ),
        Row(f"{case}: spread, predicted", f"{SPREAD:g} or more", f"{smaller:.2f}", smaller >= SPREAD),
    ]
    planned, standard = (estimates(plan, legs, runs, k) for k, legs in enumerate((plan.legs, plan.standard)))
    covariances = [np.cov(e, rowvar=False) for e in (planned, standard)]
    logs = [np.linalg.slogdet(c)[1] for c in covariances]
    gain = float(np.exp((logs[1] - logs[0]) / size))
    scatter = np.sqrt(2) * wishart(runs, size) / size
    off = abs(np.log(gain / plan.det_gain)) / scatter
    spreads = [e.std(axis=0, ddof=1) for e in (planned, standard)]
    simulated = float(np.exp(np.mean(np.log(spreads[1] / spreads[0]))))
    rows += [
        Row(f"{case}: determinant, simulated", f"{DETERMINANT:g} or more", f"{gain:.2f}", gain >= DETERMINANT),
        Row(f"{case}: spread, simulated", f"{SPREAD:g} or more", f"{simulated:.2f}", simulated >= SPREAD),
        Row(
            f"{case}: determinant, simulated against predicted",
            f"{plan.det_gain:.2f} within a factor {np.exp(3 * scatter):.2f}",
            f"{gain:.2f}, {off:.1f} standard deviations off",
            bool(off < 3),
        ),
    ]
    for j, f in enumerate(forecasts):
        pairs = [spreads[0][j] / f.std, spreads[1][j] / f.standard_std]
        # Of all these ratios together, one in a thousand or so leaves 3.5 standard deviations of a standard deviation.
        allowed = 3.5 / np.sqrt(2 * (runs - 1))
        rows.append(
            Row(
                f"{case}: standard deviation of {f.name}, simulated over predicted, plan and standard",
                f"1 ± {allowed:.2f}",
                f"{pairs[0]:.2f}, {pairs[1]:.2f} (gain {spreads[1][j] / spreads[0][j]:.2f}, predicted {f.ratio:.2f})",
                bool(max(abs(p - 1) for p in pairs) <= allowed),
            )
        )
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=40, help="times each design is sailed and identified")
    parser.add_argument("--short", action="store_true", help="one ship, eight times")
    given, rest = parser.parse_known_args()
    sys.argv[1:] = rest
    runs = 8 if given.short else given.runs
    rows = [row for model, ship in (CASES[:1] if given.short else CASES) for row in rows_of(model, ship, runs)]
    show(
        f"A planned 20 minutes beside 10/10 and 20/20 zig-zags, {runs} simulated campaigns each",
        rows,
        "Determinants count for each coefficient: (ratio of the determinants of the information)^(1/n), 10/10 and 20/20 in the "
        "same time. Spread: geometric mean of the ratios of standard deviations. Only sensor noise is simulated.",
    )


if __name__ == "__main__":
    main()
