"""Real trials, first pass: Nomoto and the cubic (Norrbin) on four campaigns against published-style baselines.

Asked: no worse than the baselines on the same splits. The baselines are output error at constant speed with initial yaw
rate and rudder bias refitted on every run; heading RMSE in degrees. Two fits of ours stand beside them: to the heading
alone (as the baselines, as far as is known) and the default (heading and rate of turn, weights from the residuals).

The trials are not part of the project; the script looks for them in ``../shared/data`` or ``--data``.

    python studies/real_trials.py [--data FOLDER] [--json]
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

import numpy as np

import shipid

FORMATS = Path(__file__).parent / "formats"
MARIN, HSVA, ESSO, GUNNERUS = (
    ("kvlcc2-marin/MARIN_FREE_KVLCC2_{}_m.dat", "kvlcc2-marin.toml"),
    ("kvlcc2-hsva/HSVA_CPMC_KVLCC2_Z_{}.dat", "kvlcc2-hsva.toml"),
    ("esso-osaka/zigzag_31-Jul-2020_{}", "esso-osaka.toml"),
    ("gunnerus/RVG_ManeuveringTests_part1.csv@{}", "gunnerus.toml"),
)
#: Campaign, files, ship, fitted trials, predicted trials; windows of the Esso Osaka run from just before the first execute.
CAMPAIGNS = {
    "MARIN": (MARIN, "kvlcc2", ("zz_20", "zz_-20"), ("zz_10",)),
    "HSVA": (HSVA, "kvlcc2-7m", ("20_10_P", "20_10_S"), ("10_10_P", "35_05")),
    "Esso Osaka 12 rps": (ESSO, "esso-osaka-3m", ("14_03_39.csv@33.6:146",), ("13_29_19.csv@41:134",)),
    "Gunnerus": (GUNNERUS, "gunnerus", ("1958:2195",), ("1622:1712", "2690:2900")),
}
#: Heading RMSE in degrees: fitted trials together, then each predicted trial; None where the baseline states no number.
BASELINES = {
    ("MARIN", "nomoto"): (1.76, (3.5,)),
    ("MARIN", "norrbin"): (1.28, (1.0,)),
    ("HSVA", "nomoto"): (1.82, (4.1, 3.6)),
    ("HSVA", "norrbin"): (1.76, (3.1, 2.1)),
    ("Esso Osaka 12 rps", "nomoto"): (0.88, (3.4,)),
    ("Esso Osaka 12 rps", "norrbin"): (None, (None,)),
    ("Gunnerus", "nomoto"): (1.83, (1.2, 1.6)),
    ("Gunnerus", "norrbin"): (None, (None, None)),
}
#: The baselines are printed with one or two decimals; half a unit of the last one is within them.
ROUNDING = 0.05


def read(folder: Path, files: tuple[str, str], name: str) -> shipid.Trial:
    pattern, trial_format = files
    return shipid.read_trial(str(folder / pattern.format(name)), format=str(FORMATS / trial_format))


def degrees(value: float) -> float:
    return round(float(np.rad2deg(value)), 3)


def run(folder: Path) -> list[dict[str, object]]:
    rows: list[dict[str, object]] = []
    for campaign, (files, ship, fitted, predicted) in CAMPAIGNS.items():
        train = [read(folder, files, n) for n in fitted]
        hold = [read(folder, files, n) for n in predicted]
        for model in ("nomoto", "norrbin"):
            base_train, base_hold = BASELINES[campaign, model]
            fits = {
                "heading": shipid.identify(model, train, ship=ship, signals=["psi"], validate=hold),
                "default": shipid.identify(model, train, ship=ship, validate=hold),
            }
            for how, fit in fits.items():
                together = np.sqrt(np.mean([c.rmse["psi"] ** 2 for c in fit.fitted]))
                rows.append(_row(campaign, model, how, "fitted", "+".join(fitted), together, base_train, fit))
                for c, base in zip(fit.validation, base_hold):
                    rows.append(_row(campaign, model, how, "predicted", c.trial.name, c.refitted["psi"], base, fit))
    return rows


def _row(
    campaign: str, model: str, how: str, role: str, trial: str, rmse: float, base: float | None, fit: shipid.Fit
) -> dict[str, object]:
    ours = degrees(rmse) if np.isfinite(rmse) else None
    verdict = "no baseline" if base is None else "holds" if ours is not None and ours <= base + ROUNDING else "missed"
    values = {n: e.value for n, e in fit.parameters.items()}
    return {
        "campaign": campaign,
        "model": model,
        "fitted_to": how,
        "role": role,
        "trial": trial,
        "ours": ours,
        "baseline": base,
        "verdict": verdict,
        "parameters": values,
        "unidentifiable": list(fit.unidentifiable),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    default = Path(__file__).resolve().parents[2] / "shared" / "data"
    parser.add_argument("--data", type=Path, default=default)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if not options.data.is_dir():
        print(f"the trials are not at {options.data}; nothing was run (give --data).", file=sys.stderr)
        return 0
    rows = run(options.data)
    if options.json:
        print(json.dumps(rows, indent=1, allow_nan=False))
    else:
        print(f"{'campaign':18s}{'model':9s}{'fitted to':10s}{'role':10s}{'ours':>8s}{'base':>7s}  verdict      trial")
        for r in rows:
            base = "" if r["baseline"] is None else f"{r['baseline']:.2f}"
            ours = "runs off" if r["ours"] is None else f"{r['ours']:.2f}"
            print(
                f"{r['campaign']:18s}{r['model']:9s}{r['fitted_to']:10s}{r['role']:10s}{ours:>8s}{base:>7s}"
                f"  {r['verdict']:12s} {r['trial']}"
            )
    return 1 if any(r["verdict"] == "missed" for r in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
