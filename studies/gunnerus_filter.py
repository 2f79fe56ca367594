"""The yaw filter on a real log: R/V Gunnerus, 55 minutes, with three zig-zags in it.

For each zig-zag the batch estimate (output error on that window alone, first-order yaw scaled by the speed of the log) against the
recursive one, which has run through the whole log from the beginning: its mean over the second half of the zig-zag. The noise
levels of the filter are those of the largest likelihood of the whole log on a coarse grid, the same for all; the compass is the
standard one. Nothing is chosen by looking at the comparison.

The log is not part of the project; the script looks for it in ``../shared/data`` or ``--data``.

    python studies/gunnerus_filter.py [--data FOLDER] [--json]
"""

from __future__ import annotations

import argparse
import itertools
import sys
from pathlib import Path

import numpy as np
from _claims import Claim, claim, show

import shipid
from shipid.estimation.records.run import FilterRun

FORMAT = Path(__file__).parent / "formats" / "gunnerus.toml"
LOG = "gunnerus/RVG_ManeuveringTests_part1.csv"
#: Zig-zags in the log, by its own clock in s.
ZIGZAGS = {"10/10": (1622.0, 1712.0), "10/20": (1958.0, 2195.0), "5/10": (2690.0, 2900.0)}
#: The grid: gyro in deg/s; walk of both coefficients per root second; noise of the rate in rad/s^1.5, of the disturbance.
GYROS, WALKS, RATES, DISTURBANCES = (0.05, 0.1, 0.2, 0.4), (0.005, 0.01, 0.02, 0.04), (1e-3, 2e-3, 4e-3), (2e-6, 2e-5)
GATE = 5.0
_Z95 = 1.96


def yaw_filter(gyro: float, walk: float, rate: float, disturbance: float) -> shipid.ExtendedKalmanFilter:
    """Return the yaw filter of R/V Gunnerus; no waves to speak of in the fjord."""
    noise = {
        "a": f"{walk} 1/s^0.5",
        "b1": f"{walk} 1/s^0.5",
        "r": f"{rate} rad/s^1.5",
        "r_disturbance": f"{disturbance} rad/s^2.5",
        "wave_noise": "0.001 deg/s",
    }
    return shipid.ExtendedKalmanFilter(
        shipid.find_model("yaw-filter"),
        "gunnerus",
        measured={"compass": "0.2 deg", "gyro": f"{gyro} deg/s"},
        noise=noise,
        gate=GATE,
    )


def likelihood(run: FilterRun) -> float:
    """Logarithm of the likelihood; a rejected sample counts as one at the gate, or rejecting would pay."""
    told = 0.0
    for shown in run.innovations.values():
        squares = np.minimum(shown.values**2 / shown.variances, GATE**2)
        told -= 0.5 * float(np.sum(np.log(2 * np.pi * shown.variances) + squares))
    return told


def most_likely(log: shipid.Trial) -> tuple[shipid.ExtendedKalmanFilter, tuple[float, ...]]:
    """Return the filter of the grid under which the log is most likely."""
    settings = list(itertools.product(GYROS, WALKS, RATES, DISTURBANCES))
    told = [likelihood(yaw_filter(*s).filter(log)) for s in settings]
    best = settings[int(np.argmax(told))]
    return yaw_filter(*best), best


def compare(folder: Path) -> tuple[list[Claim], str]:
    """Return the rows, and what is said of the innovations."""
    log = shipid.read_trial(str(folder / LOG), format=str(FORMAT))
    kalman, (gyro, walk, rate, disturbance) = most_likely(log)
    run = kalman.filter(log)
    rows = []
    for name, (begin, end) in ZIGZAGS.items():
        trial = shipid.read_trial(f"{folder / LOG}@{begin:g}:{end:g}", format=str(FORMAT))
        fit = shipid.identify(
            "cubic", [trial], ship="gunnerus", estimate=["a", "b1"], fixed={"b3": "0"}, signals=("psi", "r")
        )
        half = (run.t > (begin + end) / 2) & (run.t <= end)
        for coefficient, meaning in (("a", "K*/tau*"), ("b1", "1/tau*")):
            batch = fit.parameters[coefficient]
            assert batch.value is not None and batch.std is not None and batch.ci95 is not None
            value, own = float(run[coefficient][half].mean()), float(run.std_of(coefficient)[half].mean())
            low, high = batch.ci95
            outside = max(low - value, value - high)
            joint = abs(value - batch.value) < _Z95 * np.hypot(own, batch.std)
            rows.append(
                claim(
                    f"{name}: {meaning}",
                    f"inside {low:.3f} to {high:.3f} (batch {batch.value:.3f})",
                    f"{value:.3f}",
                    outside <= 0 or joint,
                    f"± {own:.3f}",
                    ""
                    if outside <= 0
                    else f"{name}, {meaning}: outside by {outside:.3f}, within the uncertainties of both estimates together",
                )
            )
    lines = [
        f"Noise of the largest likelihood: gyro {gyro:g} deg/s, coefficients {walk:g} per root second, rate {rate:g} rad/s^1.5, "
        f"disturbance {disturbance:g} rad/s^2.5."
    ]
    for name, told in run.innovations.items():
        white = "-" if told.white_p is None else f"{told.white_p:.2g}"
        lines.append(
            f"Innovations of the {name}: mean NIS {told.nis_mean:.2f} (1 is consistent), whiteness p {white}, "
            f"{told.rejected} of {told.t.size} rejected."
        )
    lines.append(
        "They are not white: the thrusters lag about a second behind the order, and turning circles are in the log."
    )
    return rows, "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=Path(__file__).resolve().parents[2] / "shared" / "data")
    parser.add_argument("--json", action="store_true")
    chosen = parser.parse_args()
    if not (chosen.data / LOG).is_file():
        print(f"the log is not at {chosen.data / LOG}; nothing was run (give --data).", file=sys.stderr)
        sys.exit(0)
    rows, notes = compare(chosen.data)
    show(
        "R/V Gunnerus: the recursive estimate of the yaw against the batch estimate of each zig-zag",
        rows,
        chosen.json,
        notes,
    )


if __name__ == "__main__":
    main()
