"""Prediction of manoeuvres that were not fitted, on four real campaigns, by one procedure with the same defaults.

For each campaign the structure is chosen on the fitted trials alone (``compare_models``), fitted for prediction, and predicts
trials kept apart. A: nothing refitted; W: after a warm-up to the first reversal; B: rudder bias and initial state refitted.
The targets were set on more runs than stand here; "must" and "stretch" are those of the best published low-order models.

The trials are not part of the project; the script looks for them in ``../shared/data`` or ``--data``.

    python studies/targets.py [--data FOLDER] [--starts 5] [--json]
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import shipid

FORMATS = Path(__file__).parent / "formats"
#: The same candidates for every campaign; those that read a wind take part where the log holds it.
CANDIDATES = ["nomoto", "cubic", "de-keizer", "de-keizer-lag", "bech-surge", "bech-slipstream", "cross-flow"]
MARIN = "kvlcc2-marin/MARIN_FREE_KVLCC2_{}_m.dat"
HSVA = "kvlcc2-hsva/HSVA_CPMC_KVLCC2_Z_{}.dat"
GUNNERUS = "gunnerus/RVG_ManeuveringTests_part1.csv@{}"
ESSO = "esso-osaka/zigzag_31-Jul-2020_{}"
CAMPAIGNS: dict[str, dict[str, Any]] = {
    "MARIN 20/20 to 10/10": {
        "files": (MARIN, "kvlcc2-marin.toml"),
        "ship": "kvlcc2",
        "fitted": ("zz_20", "zz_-20"),
        "predicted": ("zz_10",),
        "asked": {"r": (0.045, 0.030), "A": (8.5, 5.4), "B": (2.1, 1.4), "overshoot": (1.5, 0.9)},
    },
    "MARIN 20/20 to the circle": {
        "files": (MARIN, "kvlcc2-marin.toml"),
        "ship": "kvlcc2",
        "fitted": ("zz_20", "zz_-20"),
        "predicted": ("tc_35",),
        "asked": {"advance": (10, 4), "tactical_diameter": (10, 3), "transfer": (15, 10), "steady_rate": (15, 10)},
    },
    "HSVA 20/10": {
        "files": (HSVA, "kvlcc2-hsva.toml"),
        "ship": "kvlcc2-7m",
        "fitted": ("20_10_P", "20_10_S"),
        "predicted": ("10_10_P", "35_05"),
        "asked": {"B": (2.0, 1.5), "r": (0.20, 0.18), "overshoot": (1.6, 1.3)},
    },
    "Gunnerus": {
        "files": (GUNNERUS, "gunnerus.toml"),
        "ship": "gunnerus",
        "fitted": ("1958:2195", "2690:2900"),
        "predicted": ("1622:1712",),
        "asked": {"B": (2.4, 2.2), "r": (0.16, 0.14)},
    },
    "Esso Osaka": {
        "files": (ESSO, "esso-osaka.toml"),
        "ship": "esso-osaka-3m",
        "fitted": (
            "13_04_24.csv@42.6:140",
            "13_14_21.csv@16.8:121",
            "13_42_53.csv@32:193",
            "14_03_39.csv@33.6:146",
        ),
        "predicted": ("13_29_19.csv@41:134",),
        "asked": {"B": (3.0, 2.3), "overshoot": (1.6, 1.15)},
    },
}


def read(folder: Path, files: tuple[str, str], name: str) -> shipid.Trial:
    return shipid.read_trial(str(folder / files[0].format(name)), format=str(FORMATS / files[1]))


def measured(fit: shipid.Fit) -> dict[str, float]:
    """Errors over all predicted trials: heading and overshoots in deg, rate in deg/s."""

    def together(values: list[float]) -> float:
        return float(np.rad2deg(np.sqrt(np.mean(np.square(values))))) if values else float("nan")

    pairs = [(m, p) for c in fit.validation for m, p in zip(c.overshoots[:2], c.predicted_overshoots[:2])]
    return {
        "r": together([c.rmse["r"] for c in fit.validation]),
        "A": together([c.rmse["psi"] for c in fit.validation]),
        "W": together([c.warm["psi"] for c in fit.validation if c.warm]),
        "B": together([c.refitted["psi"] for c in fit.validation]),
        "overshoot": together([m - p for m, p in pairs if p is not None]),
    }


def circle(fit: shipid.Fit, length: str) -> dict[str, float]:
    """Errors of the turning circle in percent, both read the same way from the track."""
    c = fit.validation[0]
    columns = {"t": c.trial["t"], "delta": c.trial["delta"]} | {
        n: c.predicted[n] for n in ("x", "y", "psi", "r", "u", "v") if n in c.predicted
    }
    units = {n: shipid.trials.COLUMNS[n].unit for n in columns}
    ours = shipid.Trial.from_frame(pd.DataFrame(columns), name="predicted", units=units)
    a, b = (shipid.measure(t, kind="turning circle", execute="moved", length=length) for t in (c.trial, ours))
    names = ("advance", "transfer", "tactical_diameter", "steady_rate", "steady_speed")
    return {
        n: 100 * (getattr(b, n) / getattr(a, n) - 1) if getattr(a, n) and getattr(b, n) else float("nan") for n in names
    }


def run(folder: Path, starts: int) -> list[dict[str, Any]]:
    rows = []
    for campaign, set_up in CAMPAIGNS.items():
        begin = time.perf_counter()
        fitted = [read(folder, set_up["files"], n) for n in set_up["fitted"]]
        predicted = [read(folder, set_up["files"], n) for n in set_up["predicted"]]
        windy = all(t.has("wind_speed", "wind_direction") for t in fitted + predicted)
        models = CANDIDATES + (["cubic-wind"] if windy else [])
        ranking = shipid.compare_models(models, fitted, ship=set_up["ship"], starts=starts)
        for model in dict.fromkeys([ranking.best, *ranking.tied]):
            fit = shipid.identify(
                model, fitted, ship=set_up["ship"], purpose="prediction", validate=predicted, starts=starts
            )
            found = circle(fit, "320 m") if "circle" in campaign else measured(fit)
            rows.append(
                {
                    "campaign": campaign,
                    "model": model,
                    "chosen": model == ranking.best,
                    "found": {n: None if not np.isfinite(v) else round(v, 3) for n, v in found.items()},
                    "asked": set_up["asked"],
                    "seconds": round(time.perf_counter() - begin, 1),
                }
            )
    return rows


def verdict(value: float | None, asked: tuple[float, float]) -> str:
    if value is None:
        return "none"
    return "stretch" if abs(value) <= asked[1] else "must" if abs(value) <= asked[0] else "MISSED"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=Path(__file__).resolve().parents[2] / "shared" / "data")
    parser.add_argument("--starts", type=int, default=5)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if not options.data.is_dir():
        print(f"the trials are not at {options.data}; nothing was run (give --data).", file=sys.stderr)
        return 0
    rows = run(options.data, options.starts)
    missed = False
    if options.json:
        print(json.dumps(rows, indent=1, allow_nan=False))
    for row in rows:
        verdicts = {n: verdict(row["found"].get(n), a) for n, a in row["asked"].items()}
        missed = missed or (row["chosen"] and "MISSED" in verdicts.values())
        if not options.json:
            mark = "chosen on the fitted trials" if row["chosen"] else "tied with it"
            print(f"{row['campaign']}: {row['model']} ({mark}), {row['seconds']:.0f} s")
            for name, value in row["found"].items():
                asked = row["asked"].get(name)
                bounds = f"must {asked[0]:g}, stretch {asked[1]:g}: {verdicts[name]}" if asked else "shown only"
                print(f"    {name:20s}{'-' if value is None else f'{value:.3g}':>9s}   {bounds}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
