"""Passenier (1989), chapter 4: bias and convergence of the family of recursive identification against noise.

The process is y(k+1) = .95 y(k) + .08 u(k) under a square wave of period 120, 1500 samples, with white noise on what is measured
of y; "noise/signal" is the ratio of their root mean squares. What counts is 1/tau = (1 - a)/T. Every method starts at a = .5,
b = 0. Those that believe the noise level start with a variance of .1 on both parameters (their recommended start: about the
distance to go, squared), the others with F = 100, which is to say with a hundred times the variance of the noise.

Noise comes in pairs of opposite sign, whose errors cancel to first order: biases are measured on the means of pairs, and are
far better known than the scatter of one run would allow. The thesis prints no numbers for this chapter but its claims.

    python studies/passenier_ch4.py [--runs 400] [--short] [--json] [--figure FILE.svg]
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from _table import Row
from scipy.signal import lfilter
from threadpoolctl import threadpool_limits

import shipid
from shipid.identification.recursive.identifier import RecursiveIdentifier
from shipid.identification.recursive.methods import find_method

TRUTH = np.array([0.95, 0.08])
SAMPLES, PERIOD = 1500, 120
RATIOS = (0.02, 0.10, 0.29, 0.49)
METHODS = (
    "series-parallel",
    "minimum-variance",
    "mras-parallel",
    "combined",
    "combined-heuristic",
    "instrumental-variables",
    "ekf",
)
BELIEVING, F0 = 0.1, 100.0
START = {"a": 0.5, "b": 0.0}


class FirstOrder(shipid.Component):
    """The process of the chapter."""

    y = shipid.state("1", "output")
    v = shipid.given("1", "input")
    a = shipid.parameter("1", "pole", start=0.5, low=-5, high=5)
    b = shipid.parameter("1", "gain", start=0.5, low=-5, high=5)

    @y.next
    def process(self):
        """Passenier (1989), eq. (4.65)."""
        return self.a * self.y + self.b * self.v


MODEL = shipid.join("first-order", FirstOrder)
INPUT = np.where(np.arange(SAMPLES) % PERIOD < PERIOD // 2, 1.0, -1.0)
OUTPUT = lfilter([0.0, TRUTH[1]], [1.0, -TRUTH[0]], INPUT)
SIGNAL = float(np.sqrt(np.mean(OUTPUT**2)))


def records(sigma: float, runs: int, seed: int, output: np.ndarray = OUTPUT) -> list[dict[str, np.ndarray]]:
    """Noisy records in pairs of opposite noise."""
    rng, t = np.random.default_rng(seed), np.arange(SAMPLES, dtype=float)
    noise = sigma * rng.standard_normal((runs // 2, SAMPLES))
    return [{"t": t, "v": INPUT, "y": output + sign * e} for e in noise for sign in (1.0, -1.0)]


@dataclass(frozen=True)
class Outcome:
    """What a method made of many runs at one noise level; errors of 1/tau relative to its true value."""

    method: str
    ratio: float
    bias: float
    bias_error: float
    samples: int | None
    spread: float
    said: float
    lost: int
    runs: int
    curve: np.ndarray
    mean_a: float
    mean_a_error: float


def identifier(method: str, sigma: float, first: float | None = None, **options: Any) -> RecursiveIdentifier:
    """The recursion with the start of this study."""
    described = find_method(method)
    # The gains of least squares start from a multiple of what is given.
    variance = (BELIEVING if first is None else first) if described.uses_noise_level else F0 * sigma**2
    deviation = float(np.sqrt(variance / described.first_factor))
    return RecursiveIdentifier(
        MODEL,
        method=method,
        measured={"y": sigma},
        initial={"a": deviation, "b": deviation},
        start=options.pop("start", START),
        hold="zero",
        **options,
    )


def outcome(method: str, ratio: float, runs: int, **options: Any) -> Outcome:
    """Run a method at one noise level."""
    sigma = ratio * SIGNAL
    results = identifier(method, sigma, **options).identify_all(records(sigma, runs, 1000 + round(1000 * ratio)))
    a = np.array([r["a"] for r in results])
    error = (TRUTH[0] - a) / (1 - TRUTH[0])
    pairs = error[:, -1].reshape(-1, 2).mean(axis=1)
    curve = np.median(np.abs(error), axis=0)
    outside = np.flatnonzero(curve >= 0.2)
    settled = int(outside[-1]) + 1 if outside.size else 0
    last, flagged = error[:, -1], np.array([r.diverged for r in results])
    middle, wide = np.median(last), np.subtract(*np.quantile(last, [0.75, 0.25])) / 1.349
    # Lost: the recursion says so itself, or its error is far out of what the others scatter and half of the value.
    lost = flagged | (np.abs(last - middle) > max(0.5, 5 * wide))
    kept = ~lost
    spread_of_pairs = np.subtract(*np.quantile(pairs, [0.75, 0.25])) / 1.349
    return Outcome(
        method,
        ratio,
        float(np.median(pairs)),
        # 1.2533 is the standard error of a median over that of a mean.
        float(1.2533 * spread_of_pairs / np.sqrt(len(pairs))),
        settled if settled < SAMPLES else None,
        float(np.std(error[kept, -1], ddof=1)) if kept.sum() > 1 else float("nan"),
        float(np.median([r.std[-1, 0] for r in results]) / (1 - TRUTH[0])),
        int(np.sum(lost)),
        len(results),
        curve,
        float(np.mean(a[:, -1])),
        float(np.std(a[:, -1].reshape(-1, 2).mean(axis=1), ddof=1) / np.sqrt(len(pairs))),
    )


def closed_form(ratio: float) -> np.ndarray:
    """Bias of least squares by noise on the measured output: -(R + diag(s^2, 0))^-1 (s^2 a, 0), R that of output and input."""
    psi, power = np.vstack([OUTPUT[:-1], INPUT[:-1]]), (ratio * SIGNAL) ** 2
    moments = psi @ psi.T / (SAMPLES - 1)
    return -np.linalg.solve(moments + np.diag([power, 0.0]), [power * TRUTH[0], 0.0])


def cramer_rao(ratio: float) -> float:
    """Smallest scatter of 1/tau an estimate without bias can have, relative to its value."""
    slopes = np.vstack([lfilter([0.0, 1.0], [1.0, -TRUTH[0]], s) for s in (OUTPUT, INPUT)])
    return float(np.sqrt(np.linalg.inv(slopes @ slopes.T)[0, 0]) * ratio * SIGNAL / (1 - TRUTH[0]))


@dataclass(frozen=True)
class Jump:
    """How a method follows a gain that jumps by a half: samples until within 10 %, and the scatter before."""

    method: str
    how: str
    samples: int | None
    scatter: float
    forgets: bool


def jumps(runs: int) -> list[Jump]:
    """Half of the record with b = .08, half with .12, noise/signal .10."""
    half, sigma = SAMPLES // 2, 0.10 * SIGNAL
    gain = np.where(np.arange(SAMPLES) < half, TRUTH[1], 1.5 * TRUTH[1])
    output = lfilter([0.0, 1.0], [1.0, -TRUTH[0]], gain * INPUT)
    made, found = records(sigma, runs, 7, output), []
    cases: list[tuple[str, str, dict[str, Any]]] = [
        ("ekf", "q = 1e-7", {"noise": dict.fromkeys("ab", 10**-3.5)}),
        ("ekf", "q = 1e-6", {"noise": dict.fromkeys("ab", 1e-3)}),
        ("combined", "q = 1e-6", {"noise": dict.fromkeys("ab", 1e-3)}),
        ("combined", "q = 1e-5", {"noise": dict.fromkeys("ab", 10**-2.5)}),
        ("mras-parallel", "lambda = .995", {"forgetting": 0.995}),
        ("mras-parallel", "lambda = .99", {"forgetting": 0.99}),
        ("series-parallel", "lambda = .99", {"forgetting": 0.99}),
        ("ekf", "q = 0", {}),
    ]
    for method, how, options in cases:
        b = np.array([r["b"] for r in identifier(method, sigma, **options).identify_all(made)])
        error = np.abs(np.median(b[:, half:], axis=0) / (1.5 * TRUTH[1]) - 1)
        outside = np.flatnonzero(error >= 0.1)
        settled = int(outside[-1]) + 1 if outside.size else 0
        scatter = float(np.std(b[:, half - 1], ddof=1) / TRUTH[1])
        found.append(Jump(method, how, settled if settled < half else None, scatter, "forgetting" in options))
    return found


def wind_up(runs: int) -> dict[str, float]:
    """Scatter of b in the first period after 800 samples in which nothing happens, relative to its value, by method."""
    sigma, t = 0.10 * SIGNAL, np.arange(SAMPLES, dtype=float)
    still = np.where((t < 480) | (t >= 1280), INPUT, 0.0)
    output = lfilter([0.0, TRUTH[1]], [1.0, -TRUTH[0]], still)
    made = [r | {"v": still} for r in records(sigma, runs, 5, output)]
    cases: list[tuple[str, dict[str, Any]]] = [
        ("mras-parallel", {"forgetting": 0.99}),
        ("series-parallel", {"forgetting": 0.99}),
        ("ekf", {"noise": dict.fromkeys("ab", 10**-3.5)}),
        ("combined", {"noise": dict.fromkeys("ab", 10**-3.5)}),
    ]
    result = {}
    for method, options in cases:
        b = np.array([r["b"] for r in identifier(method, sigma, **options).identify_all(made)])
        result[method] = float(np.median(np.ptp(b[:, 1280 : 1280 + PERIOD], axis=1)) / TRUTH[1])
    return result


def correspondence() -> tuple[float, float]:
    """Largest difference of combined (4.5.3) from the filter without cross terms; that of 4.4.4 from 4.5.3 in 1/tau."""
    sigma = 0.29 * SIGNAL
    made = records(sigma, 20, 3)
    options = {"start": {**START, "y": 0.0}}
    both = [
        np.array([r.theta for r in identifier(m, sigma, **options).identify_all(made)])
        for m in ("combined", "combined-heuristic")
    ]
    worst = 0.0
    for record, theta in zip(made, both[0]):
        x, p = np.array([0.0, START["a"], START["b"]]), np.diag([sigma**2, BELIEVING, BELIEVING])
        for k, z in enumerate(record["y"]):
            if k:
                psi = np.array([x[0], INPUT[k - 1]])
                f = np.vstack([np.concatenate([[x[1]], psi]), [[0, 1, 0], [0, 0, 1]]])
                x, p = np.array([psi @ x[1:], x[1], x[2]]), f @ p @ f.T
            gain = p[:, 0] / (p[0, 0] + sigma**2)
            x, p = x + gain * (z - x[0]), p - np.outer(gain, p[0])
            p[0, 1:] = p[1:, 0] = 0.0
            worst = max(worst, float(np.abs(theta[k] - x[1:]).max()))
    return worst, float(np.median(np.abs(both[1] - both[0])[:, 120:, 0].max(axis=1)) / (1 - TRUTH[0]))


def percent(value: float, digits: int = 2) -> str:
    return f"{100 * value:+.{digits}f} %"


def judge(found: dict[tuple[str, float], Outcome], runs: int) -> tuple[list[Row], list[dict[str, Any]]]:
    """The rows of what is asked, and of the claims."""
    rows = []
    for ratio in RATIOS:
        o, bias = found["series-parallel", ratio], closed_form(ratio)[0]
        off = (o.mean_a - TRUTH[0] - bias) / o.mean_a_error
        rows.append(
            Row(
                f"series-parallel, bias of a at noise/signal {ratio}",
                f"{bias:+.5f} within 3 standard errors",
                f"{o.mean_a - TRUTH[0]:+.5f}, {off:+.1f} of {o.mean_a_error:.5f}",
                abs(off) < 3,
            )
        )
    for method in ("mras-parallel", "combined", "ekf"):
        o = found[method, 0.29]
        rows.append(
            Row(
                f"{method}, bias of 1/tau at noise/signal .29",
                "within 0.5 %" + ("" if runs >= 400 else " and two standard errors"),
                f"{percent(o.bias)} ± {100 * o.bias_error:.2f}",
                abs(o.bias) < 0.005 + (0.0 if runs >= 400 else 2 * o.bias_error),
            )
        )
    lost = sum(o.lost for o in found.values())
    rows.append(
        Row("runs lost with the recommended start", "0", f"{lost} of {sum(o.runs for o in found.values())}", lost == 0)
    )
    slow, quick = found["mras-parallel", 0.29], found["combined", 0.29]
    ekf, bound = found["ekf", 0.29], cramer_rao(0.29)
    ratios = {o.method: o.said / o.spread for (m, r), o in found.items() if r == 0.10}
    rows.append(
        Row(
            "standard deviations said over scatter, noise/signal .10",
            "0.85 to 1.15" if runs >= 400 else "0.7 to 1.4",
            ", ".join(f"{v:.2f}" for v in ratios.values()),
            all((0.85 if runs >= 400 else 0.7) < v < (1.15 if runs >= 400 else 1.4) for v in ratios.values()),
        )
    )
    jumped = jumps(max(40, runs // 4))
    worst, apart = correspondence()
    rows.append(Row("combined against the filter without cross terms", "1e-12", f"{worst:.0e}", worst < 1e-12))
    restart = wind_up(max(40, runs // 4))
    sure = identifier("ekf", 0.29 * SIGNAL, 1.0, start={"a": 0.0, "b": 0.0})
    careless = sum(r.diverged for r in sure.identify_all(records(0.29 * SIGNAL, runs, 11)))

    def jump(method: str, how: str) -> Jump:
        return next(j for j in jumped if (j.method, j.how) == (method, how))

    wanders, forgets = jump("ekf", "q = 1e-7"), jump("mras-parallel", "lambda = .99")
    p8 = (
        all(r.holds for r in rows[:4])
        and found["series-parallel", 0.29].samples is None
        and abs(slow.bias) < 0.01
        and slow.samples is not None
        and all(
            (found["series-parallel", 0.02].samples or 9999) < (found[m, 0.02].samples or 9999)
            for m in ("mras-parallel",)
        )
    )
    p9 = (
        quick.samples is not None
        and slow.samples is not None
        and quick.samples < slow.samples
        and abs(quick.bias) < 0.01
        and quick.spread < slow.spread
    )
    p11 = (
        wanders.samples is not None
        and wanders.scatter < forgets.scatter
        and all(j.samples is None or j.samples > wanders.samples for j in jumped if j.forgets)
    )
    said = "noise/signal by root mean squares; 1/tau = (1 - a)/T; start a = .5, b = 0"
    claims = [
        {
            "claim": "P8",
            "published": "series-parallel is quick and biased by noise, parallel is not biased and slower",
            "ours": f"at .29: series-parallel {percent(found['series-parallel', 0.29].bias, 0)}, parallel {percent(slow.bias)} in "
            f"{slow.samples} samples; without much noise (.02) {found['series-parallel', 0.02].samples} against "
            f"{found['mras-parallel', 0.02].samples} samples; the bias has the closed form -(R + diag(s^2, 0))^-1 (s^2 a, 0)",
            "spread": f"{100 * slow.bias_error:.2f} %",
            "verdict": "holds" if p8 else "does not hold",
            "reading": said,
        },
        {
            "claim": "P9",
            "published": "the combined scheme is as quick as the one and as free of bias as the other",
            "ours": f"at .29: {percent(quick.bias)} in {quick.samples} samples (parallel {slow.samples}), scatter "
            f"{100 * quick.spread:.1f} % (parallel {100 * slow.spread:.1f} %, ekf {100 * ekf.spread:.1f} %, bound {100 * bound:.1f} %)",
            "spread": f"{100 * quick.bias_error:.2f} %",
            "verdict": "holds" if p9 else "does not hold",
            "reading": said + "; the scheme of 4.5.3",
        },
        {
            "claim": "P10",
            "published": "combined, minimum variance, least squares and MRAS are special cases of the extended Kalman filter",
            "ours": f"combined differs from the filter without cross terms by {worst:.0e}; the schemes of 4.4.4 and 4.5.3 differ by up to "
            f"{100 * apart:.1f} % of 1/tau after the first period",
            "spread": f"{worst:.0e}",
            "verdict": "holds under a reading" if worst < 1e-12 else "does not hold",
            "reading": "4.5.3; that of 4.4.4 divides by psi'F psi + R where (4.130) divides by M_yy + R, whatever (4.133) says",
        },
        {
            "claim": "P11",
            "published": "system noise on the parameters adapts better than a forgetting factor",
            "ours": f"a gain that jumps by half: ekf with q = 1e-7 within 10 % in {wanders.samples} samples at a scatter of "
            f"{100 * wanders.scatter:.1f} %, parallel with lambda .99 in {forgets.samples} at {100 * forgets.scatter:.1f} %; when the "
            f"input sets in again after 800 still samples, b sweeps over {100 * restart['ekf']:.0f} % of its value in a period "
            f"(ekf) against {100 * restart['mras-parallel']:.0f} % (parallel) and {100 * restart['series-parallel']:.0f} % "
            "(series-parallel)",
            "spread": "median of the runs",
            "verdict": "holds" if p11 else "does not hold",
            "reading": "q is a variance per sample",
        },
    ]
    print_jumps = [
        f"  {j.method:<18s}{j.how:<16s}{'never' if j.samples is None else j.samples!s:>6s} samples, scatter before "
        f"{100 * j.scatter:5.1f} %"
        for j in jumped
    ]
    claims[3]["table"] = print_jumps
    claims[0]["table"] = [
        f"ekf started at a = b = 0 with a variance of 1: {careless} of {runs} runs lost at noise/signal .29"
    ]
    return rows, claims


def table(found: dict[tuple[str, float], Outcome]) -> str:
    """Bias, convergence and scatter of every method at every level."""
    lines = [
        f"{'noise/signal':<13s}{'method':<24s}{'bias of 1/tau':>20s}{'to 20 %':>9s}{'scatter':>10s}{'said':>9s}{'lost':>6s}"
    ]
    for ratio in RATIOS:
        for method in METHODS:
            o = found[method, ratio]
            samples = "never" if o.samples is None else str(o.samples)
            lines.append(
                f"{ratio:<13.2f}{method:<24s}{f'{percent(o.bias)} ± {100 * o.bias_error:.2f}':>20s}{samples:>9s}"
                f"{100 * o.spread:>8.2f} %{100 * o.said:>7.2f} %{o.lost:>6d}"
            )
        lines.append(f"{'':<13s}{'(Cramér-Rao bound)':<53s}{100 * cramer_rao(ratio):>8.2f} %")
    return "\n".join(lines)


def draw(found: dict[tuple[str, float], Outcome], path: Path) -> None:
    """Median error of 1/tau along the record, one panel a noise level."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    shown = ("series-parallel", "mras-parallel", "combined", "instrumental-variables", "ekf")
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "shipid", "font.size": 9}):
        figure = Figure(figsize=(7.2, 5.4), layout="constrained")
        FigureCanvasSVG(figure)
        axes = figure.subplots(2, 2, sharex=True, sharey=True)
        for ax, ratio in zip(axes.flat, RATIOS):
            for method in shown:
                ax.semilogy(
                    range(0, SAMPLES, 6), np.maximum(100 * found[method, ratio].curve[::6], 1e-2), label=method, lw=1.2
                )
            ax.axhline(20, color="0.6", linewidth=0.8, linestyle=":")
            ax.set_title(f"noise/signal {ratio:.2f}", loc="left", fontsize=9)
        for ax in axes[:, 0]:
            ax.set_ylabel("median error of 1/τ [%]")
        for ax in axes[1]:
            ax.set_xlabel("samples")
        axes[0, 0].legend(frameon=False, fontsize=8)
        figure.savefig(path, metadata={"Date": None})


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=400, help="an even number")
    parser.add_argument("--short", action="store_true", help="60 runs")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--figure", type=Path, metavar="FILE", help="write the convergence as SVG")
    options = parser.parse_args()
    runs = 60 if options.short else options.runs
    with threadpool_limits(1, "blas"):
        found = {(m, ratio): outcome(m, ratio, runs) for ratio in RATIOS for m in METHODS}
        rows, claims = judge(found, runs)
    if options.figure:
        draw(found, options.figure)
    tables = {c["claim"]: c.pop("table", []) for c in claims}
    if options.json:
        print(json.dumps(claims, indent=1, ensure_ascii=False, allow_nan=False))
    else:
        print(f"{runs} runs of {SAMPLES} samples\n\n{table(found)}\n")
        print("a gain that jumps by half, noise/signal .10, until the median is within 10 %:")
        print("\n".join(tables["P11"]) + "\n\n" + "\n".join(tables["P8"]) + "\n")
        for row in rows:
            print(f"{row.what:<60s} asked {row.asked:<40s} measured {row.measured:<32s} {row.verdict}")
        for c in claims:
            print(f"\n{c['claim']}: {c['published']}\n    {c['ours']}\n    {c['verdict']} ({c['reading']})")
    return 0 if all(r.holds for r in rows) and not any(c["verdict"] == "does not hold" for c in claims) else 1


if __name__ == "__main__":
    sys.exit(main())
