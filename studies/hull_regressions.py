#!/usr/bin/env python3
"""Whether estimates from the hull's particulars, as a prior, improve the prediction of manoeuvres that were not fitted.

The campaigns, trials and measures are those of ``targets.py``, and one more: a single 10/10 zig-zag that predicts both 20/20 and the
circle. Each model is fitted with the defaults of ``identify``: with the priors its declaration states; with the regression of
`shipid.parameters.hull` in the place of those of q21, r21, q31 and r31; and without any prior of these four, where the declaration has
one.

Scatter and form of the regression were chosen by published derivatives of four hulls, two of which sail here (KVLCC2 and the Esso
Osaka). Three fits of MARIN's 20/20 came before that, with guessed spreads: coupled masses, a drag coefficient of 1.0 ± 0.3 for c_y and
c_z, and both; their tactical diameters were 10.0, 8.7 and 10.5 % too large, and overshoots 1.1, 1.0 and 1.0 degrees off.

    python studies/hull_regressions.py [--data FOLDER] [--only NAME] [--json]
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from targets import CAMPAIGNS, MARIN_FILES, circle, measured, read

import shipid
from shipid.declaration.model import Model
from shipid.parameters.catalogue import find_model, find_ship
from shipid.parameters.hull.estimates import hull_estimates

#: Coefficients of the models that the regression estimates.
LINEAR = ("q21", "r21", "q31", "r31")
ALONE = {
    "files": MARIN_FILES,
    "ship": "kvlcc2",
    "fitted": ("zz_10",),
    "predicted": ("zz_20", "zz_-20"),
    "circles": ("tc_35",),
}
CASES: tuple[tuple[str, dict[str, Any], str], ...] = (
    ("MARIN, both 20/20", CAMPAIGNS["MARIN, both 20/20"], "cross-flow"),
    ("MARIN, both 20/20", CAMPAIGNS["MARIN, both 20/20"], "pershitz"),
    ("MARIN, 10/10 alone", ALONE, "cross-flow"),
    ("MARIN, 10/10 alone", ALONE, "pershitz"),
    ("HSVA, both 20/10", CAMPAIGNS["HSVA, both 20/10"], "cross-flow"),
    ("HSVA, both 20/10", CAMPAIGNS["HSVA, both 20/10"], "pershitz"),
    ("Esso Osaka", CAMPAIGNS["Esso Osaka"], "cross-flow-wind"),
    ("Esso Osaka", CAMPAIGNS["Esso Osaka"], "pershitz"),
)
SHOWN = ("r", "A", "B", "overshoot", "advance", "transfer", "tactical_diameter", "steady_rate")


def with_priors(model: Model, priors: dict[str, tuple[float | None, float | None]]) -> Model:
    """The model with another start and spread of some coefficients; None for the start keeps the declared one."""
    entries = dict(model.entries)
    for name, (start, spread) in priors.items():
        quantity = entries[name].quantity
        quantity = replace(quantity, start=quantity.start if start is None else start, spread=spread)
        entries[name] = replace(entries[name], quantity=quantity)
    return replace(model, entries=entries)


def variants(model: Model, ship: str) -> dict[str, Model]:
    """The model with each kind of prior."""
    by_hull = {n: (e.value, e.std) for n, e in hull_estimates(find_ship(ship)).found.items() if n in LINEAR}
    found = {"as declared": model, "by the hull": with_priors(model, by_hull)}
    if any(model[n].quantity.spread is not None for n in LINEAR):
        found["no prior"] = with_priors(model, dict.fromkeys(LINEAR, (None, None)))
    return found


def run(folder: Path, only: str | None) -> list[dict[str, Any]]:
    rows = []
    for campaign, case, name in CASES:
        if only and only.lower() not in f"{campaign} {name}".lower():
            continue
        fitted = [read(folder, case["files"], n) for n in case["fitted"]]
        predicted = [read(folder, case["files"], n) for n in (*case["predicted"], *case.get("circles", ()))]
        zigzags = len(case["predicted"])
        for prior, model in variants(find_model(name), case["ship"]).items():
            fit = shipid.assess(shipid.identify(model, fitted, ship=case["ship"]).validate(predicted), findings=False)
            found = measured(fit, zigzags, 1.0) | circle(fit, [c.trial.name for c in fit.validation[zigzags:]])
            values = {n: [fit.parameters[n].value, fit.parameters[n].std] for n in LINEAR}
            row = {"campaign": campaign, "model": name, "prior": prior}
            rows.append(row | {"found": {n: found.get(n) for n in SHOWN}, "coefficients": values})
            print(f"{campaign}, {name}, {prior}: fitted", file=sys.stderr)
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=Path(__file__).resolve().parents[2] / "shared" / "data")
    parser.add_argument("--only", metavar="NAME", help="one campaign or model, by a part of its name")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if not options.data.is_dir():
        print(f"the trials are not at {options.data}; nothing was run (give --data).", file=sys.stderr)
        return 0
    rows = run(options.data, options.only)
    if options.json:
        print(json.dumps(rows, indent=1))
        return 0
    print(f"{'':50s}" + "".join(f"{n.replace('tactical_', ''):>12s}" for n in SHOWN))
    for row in rows:
        numbers = "".join("           -" if v is None else f"{v:12.3g}" for v in row["found"].values())
        print(f"{row['campaign'] + ', ' + row['model']:37s}{row['prior']:13s}{numbers}")
        print("     " + ", ".join(f"{n} {v:.3g} ± {s:.2g}" for n, (v, s) in row["coefficients"].items() if v and s))
    print("r in deg/s, A, B and overshoot in deg; quantities of the circle in percent of the measured ones")
    return 0


if __name__ == "__main__":
    sys.exit(main())
