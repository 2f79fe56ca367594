#!/usr/bin/env python3
"""Prediction of manoeuvres that were not fitted, on real campaigns, by one procedure with the same defaults.

For each campaign the structure is chosen on the fitted trials alone (``compare_models``), fitted with the defaults of ``identify``,
and predicts trials kept apart. A: nothing refitted; W: after a warm-up to the first reversal; B: rudder bias and initial state
refitted. Then, over all campaigns, how many of the overshoots and of the circles' quantities the 95 % bands hold, and how wide
the bands are. Last, a record from which nothing can be identified.

The model of HSVA's tank (7 m) predicts MARIN's runs as well, which are given in full-scale values and brought to 7 m by
Froude's law.

The trials are not part of the project; the script looks for them in ``../shared/data`` or ``--data``. What each was used for
before it is predicted here:

- Nested, by the procedure: in each campaign no trial that is predicted is seen by the choice of the structure, by the fit, or by the
  errors of left-out trials in the bands.
- Seen by its authors, and so no evidence for what they chose: MARIN's 10/10 and circle (numbers of ``cross-flow`` within what the
  literature leaves open: w_0 = 0.4 between 0.3 and 0.5, the spreads of c_y, c_z and X_vr; and that its surge has thrust, rudder drag
  and v r of their own); HSVA's and Gunnerus's runs (that the rudder's force lags); all that stand here (that a heading that is not
  corrected for a bias has no weight in the score; that of tied models the most believed is taken, then one that reads the
  measured wind); Esso Osaka's turns (that the wind pushes a model that states its sway and surge, and not only turns it, and that a
  turn is steady until the propeller stops; the priors of the two forces are
  from areas and force coefficients, set after a fit with other ones, about no effect, had been seen on the same turns; that the wind is
  the relative one, from simulated ships, whose forces are larger: so the two priors became ten and five times as wide, once with the
  narrow ones six bands of the turns could not be drawn).
- Tried on MARIN's circle and not taken: a rudder of which a fixed share stands in the slipstream, the flow straightened by hull and
  propeller, the normal force of the rudder in surge and by its cosine, w_0 as a coefficient. The best brought the tactical diameter from 8.2 to
  4.3 %, and lost 31 % of the steady speed; to Esso Osaka's overshoots one of them was worse. Yasukawa and Yoshimura's set as the truth errs the other way (-7 to -13 %).
  Then, also on this circle, a fault was found: the speed before the manoeuvre of a predicted trial was averaged far into its turn, 7.3 for 8.0 m/s.
  Mended, the tactical diameter is 5.4 % off (8.2 before), the rate 0.9 % (-7).
- From other runs of these campaigns, that do not stand here: the targets, the factor of 1.25 within which models are tied, the 1.5 deg of
  the bands on overshoots with its four degrees of freedom.
- Set before these runs were looked at with them: the weights of the measures in the score, and the 5 % of a circle (10 % of its
  transfer) by which a structure is taken to be wrong at the amplitudes that were fitted, and in proportion beyond them.
- MARIN and HSVA sailed the same hull, so that what was chosen by one is not independent of the other. The ships' files hold values
  that were identified from these campaigns; they are where a search starts, and no belief.

    python studies/targets.py [--data FOLDER] [--starts 5] [--only NAME] [--chosen] [--json]
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
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.statistics import plain

FORMATS = Path(__file__).parent / "formats"
#: The same candidates for every campaign; each is taken with the wind where the log holds it.
CANDIDATES = ["nomoto", "cubic", "de-keizer", "de-keizer-lag", "bech-surge", "bech-slipstream", "cross-flow"]
MARIN = "kvlcc2-marin/MARIN_FREE_KVLCC2_{}_m.dat"
HSVA = "kvlcc2-hsva/HSVA_CPMC_KVLCC2_Z_{}.dat"
GUNNERUS = "gunnerus/RVG_ManeuveringTests_part1.csv@{}"
ESSO = "esso-osaka/{}"
MARIN_FILES, HSVA_FILES = (MARIN, "kvlcc2-marin.toml"), (HSVA, "kvlcc2-hsva.toml")
HAKUSAN = "hakusan/HAKUSAN.txt"
#: Of the full-scale values to the model of 7 m.
SCALE = 320.0 / 7.0
#: For each quantity what a campaign must reach, and what it should: a quantity of a circle in percent.
CAMPAIGNS: dict[str, dict[str, Any]] = {
    "MARIN, both 20/20": {
        "files": MARIN_FILES,
        "ship": "kvlcc2",
        "fitted": ("zz_20", "zz_-20"),
        "predicted": ("zz_10",),
        "circles": ("tc_35",),
        "asked": {
            "r": (0.045, 0.025),
            "A": (8.5, 5.0),
            "B": (2.1, 0.5),
            "overshoot": (2.5, 1.0),
            "advance": (4, 1.5),
            "tactical_diameter": (4, 1.5),
            "transfer": (8, 4),
            "steady_rate": (5, 2),
        },
    },
    "HSVA, both 20/10": {
        "files": HSVA_FILES,
        "ship": "kvlcc2-7m",
        "fitted": ("20_10_P", "20_10_S"),
        "predicted": ("10_10_P", "35_05", "25_05", "15_05"),
        "asked": {"A": (8.0, 3.0), "B": (2.0, 0.7), "r": (0.20, 0.12), "overshoot": (2.0, 1.0)},
    },
    "HSVA at 7 m predicts MARIN": {
        "files": HSVA_FILES,
        "ship": "kvlcc2-7m",
        "fitted": ("20_10_P", "20_10_S", "10_10_P", "35_05", "25_05", "15_05"),
        "predicted_files": MARIN_FILES,
        "predicted": ("zz_10", "zz_20", "zz_-20"),
        "circles": ("tc_35",),
        "scale": SCALE,
        "asked": {
            "A": (10.0, 3.3),
            "B": (1.5, 1.5),
            "overshoot": (4.0, 2.0),
            "advance": (5, 3),
            "tactical_diameter": (5, 3),
        },
    },
    "Gunnerus": {
        "files": (GUNNERUS, "gunnerus.toml"),
        "ship": "gunnerus",
        "fitted": ("1958:2195", "2690:2900"),
        "predicted": ("1622:1712",),
        "asked": {"B": (2.0, 2.0), "r": (0.15, 0.13), "overshoot_closed": (1.6, 1.2)},
    },
    "Esso Osaka": {
        "files": (ESSO, "esso-osaka.toml"),
        "ship": "esso-osaka-3m",
        "fitted": (
            "zigzag_31-Jul-2020_13_04_24.csv@42.6:140",
            "zigzag_31-Jul-2020_13_14_21.csv@16.8:121",
            "zigzag_31-Jul-2020_13_42_53.csv@32:193",
            "zigzag_31-Jul-2020_14_03_39.csv@33.6:146",
        ),
        "predicted": ("zigzag_31-Jul-2020_13_29_19.csv@41:134",),
        "circles": (
            "turn_14-Oct-2020_15_21_57.csv@60:387",
            "turn_14-Oct-2020_14_17_39.csv@150:362",
            "turn_14-Oct-2020_14_29_49.csv@60:442",
        ),
        "asked": {"B": (2.3, 1.8), "r_B": (0.30, 0.30), "overshoot": (2.5, 1.5), "tactical_diameter": (12, 12)},
    },
}
#: Share of the overshoots and of the circles' quantities that the bands of the chosen models hold: must, stretch.
HELD = (0.88, 0.93)


def read(folder: Path, files: tuple[str, str], name: str) -> shipid.Trial:
    return shipid.read_trial(str(folder / files[0].format(name)), format=str(FORMATS / files[1]))


def brought_to(trial: shipid.Trial, scale: float) -> shipid.Trial:
    """The same trial of a model so many times smaller, by Froude's law."""
    powers = {"x": -1.0, "y": -1.0, "u": -0.5, "v": -0.5, "U": -0.5, "t": -0.5, "r": 0.5, "psi": 0.0, "delta": 0.0}
    columns = {n: trial[n] * scale**p for n, p in powers.items() if trial.has(n)}
    units = {n: FIELDS[n].unit for n in columns}
    return shipid.Trial.from_frame(pd.DataFrame(columns), name=trial.name, units=units)


def measured(fit: shipid.Fit, zigzags: int, scale: float) -> dict[str, float]:
    """Errors over the predicted zig-zags: heading and overshoots in deg, rate in deg/s of the ship as it was recorded."""
    compared = fit.validation[:zigzags]

    def together(values: list[float]) -> float:
        return float(np.rad2deg(np.sqrt(np.mean(np.square(values))))) if values else float("nan")

    def missed(predictions: list[tuple[float | None, ...]]) -> float:
        pairs = [(m, p) for c, foreseen in zip(compared, predictions) for m, p in zip(c.overshoots[:2], foreseen)]
        # A swing that is not reached is missed whole.
        return together([m - (p or 0.0) for m, p in pairs])

    return {
        "r": together([c.rmse["r"] for c in compared]) / scale**0.5,
        "A": together([c.rmse["psi"] for c in compared]),
        "W": together([c.warm["psi"] for c in compared if c.warm]),
        "B": together([c.refitted["psi"] for c in compared]),
        "r_B": together([c.refitted["r"] for c in compared]) / scale**0.5,
        "overshoot": missed([c.predicted_overshoots for c in compared]),
        "overshoot_closed": missed([fit.assessment.manoeuvres[c.trial.name].closed_loop for c in compared]),
    }


def circle(fit: shipid.Fit, names: list[str]) -> dict[str, float]:
    """Errors of turning circles in percent, root-mean-square, both read the same way from the track."""
    found: dict[str, list[float]] = {}
    for one in names:
        for name, value in fit.assessment.manoeuvres[one].turn.items():
            known = value.measured and value.predicted
            found.setdefault(name, []).append(100 * (value.predicted / value.measured - 1) if known else np.nan)
    return {n: v[0] if len(v) == 1 else float(np.sqrt(np.mean(np.square(v)))) for n, v in found.items()}


def held(fit: shipid.Fit, compared: tuple[Any, ...]) -> dict[str, list[tuple[bool, float]]]:
    """Whether each band holds what was measured, and its half-width: of overshoots in deg, of circles in shares of the prediction."""
    rows: dict[str, list[tuple[bool, float]]] = {"open loop": [], "closed loop": [], "circle": []}
    for c in compared:
        m = fit.assessment.manoeuvres[c.trial.name]
        for which, bands in (("open loop", m.band95), ("closed loop", m.closed_loop_band95)):
            for measured, band in [*zip(m.overshoots, bands)][:2]:
                inside = band is not None and band[0] <= measured <= band[1]
                rows[which].append((inside, np.nan if band is None else float(np.rad2deg(band[1] - band[0])) / 2))
        for value in m.turn.values():
            if value.measured is None:
                continue
            inside = value.band95 is not None and value.band95[0] <= value.measured <= value.band95[1]
            wide = np.nan if value.band95 is None else (value.band95[1] - value.band95[0]) / 2 / abs(value.predicted)
            rows["circle"].append((inside, wide))
    return rows


def run(folder: Path, starts: int, only: str | None, chosen_only: bool = False) -> list[dict[str, Any]]:
    rows = []
    for campaign, set_up in CAMPAIGNS.items():
        if only and only.lower() not in campaign.lower():
            continue
        begin = time.perf_counter()
        scale = set_up.get("scale", 1.0)
        fitted = [read(folder, set_up["files"], n) for n in set_up["fitted"]]
        names = (*set_up["predicted"], *set_up.get("circles", ()))
        predicted = [read(folder, set_up.get("predicted_files", set_up["files"]), n) for n in names]
        predicted = [brought_to(t, scale) if scale != 1 else t for t in predicted]
        ranking = shipid.compare_models(CANDIDATES, fitted, ship=set_up["ship"], starts=starts)
        compared = time.perf_counter() - begin
        for model in dict.fromkeys([ranking.best, *(() if chosen_only else ranking.tied)]):
            begin = time.perf_counter()
            fit = shipid.identify(model, fitted, ship=set_up["ship"], starts=starts)
            seconds = time.perf_counter() - begin
            fit = shipid.assess(fit.validate(predicted), findings=False)
            zigzags = len(set_up["predicted"])
            found = measured(fit, zigzags, scale) | circle(fit, [c.trial.name for c in fit.validation[zigzags:]])
            rows.append(
                {
                    "campaign": campaign,
                    "model": model,
                    "chosen": model == ranking.best,
                    "words": list(ranking.words),
                    "found": {n: None if not np.isfinite(v) else round(v, 3) for n, v in found.items()},
                    "asked": set_up["asked"],
                    "bands": {n: [(bool(i), plain(w)) for i, w in v] for n, v in held(fit, fit.validation).items()},
                    "compare_s": round(compared, 1),
                    "fit_s": round(seconds, 1),
                }
            )
    return rows


def coverage(rows: list[dict[str, Any]]) -> list[tuple[str, int, int, float]]:
    """Of the chosen models: what the bands are of, how many hold, how many there are, and their median half-width."""
    found = []
    for what in ("open loop", "closed loop", "circle"):
        bands = [one for r in rows if r["chosen"] for one in r["bands"][what]]
        widths = [w for _, w in bands if w is not None]
        found.append((what, sum(i for i, _ in bands), len(bands), float(np.median(widths)) if widths else np.nan))
    return found


def nothing_to_identify(folder: Path) -> tuple[bool, str]:
    """Whether a record without coherence of rudder and yaw is said to determine nothing, and the words."""
    table = pd.read_csv(folder / HAKUSAN, sep=r"\s+")
    columns = {
        "t": np.arange(len(table), dtype=float),
        "r": np.deg2rad(0.001 * table["YawRate"].to_numpy(float)),
        "delta": np.deg2rad(0.01 * table["Rudder"].to_numpy(float)),
    }
    units = {n: FIELDS[n].unit for n in columns}
    trial = shipid.Trial.from_frame(pd.DataFrame(columns), name="hakusan", units=units)
    ranking = shipid.compare_models(["nomoto", "norrbin"], [trial], workers=1, starts=2)
    said = " ".join(str(n) for n in ranking.warnings)
    return ranking.best is None and any(n.serious for n in ranking.warnings), said


def verdict(value: float | None, asked: tuple[float | None, float]) -> str:
    if value is None:
        return "MISSED"
    must, stretch = asked
    if abs(value) <= stretch:
        return "stretch"
    return "shown only" if must is None else "must" if abs(value) <= must else "MISSED"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=Path(__file__).resolve().parents[2] / "shared" / "data")
    parser.add_argument("--starts", type=int, default=5)
    parser.add_argument("--only", metavar="NAME", help="one campaign, by a part of its name")
    parser.add_argument("--chosen", action="store_true", help="the chosen models only, without those tied with them")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if not options.data.is_dir():
        print(f"the trials are not at {options.data}; nothing was run (give --data).", file=sys.stderr)
        return 0
    rows = run(options.data, options.starts, options.only, options.chosen)
    none, said = (True, "") if options.only else nothing_to_identify(options.data)
    missed = not none
    if options.json:
        print(json.dumps({"rows": rows, "not_determined": none}, indent=1, allow_nan=False))
    for row in rows:
        verdicts = {n: verdict(row["found"].get(n), a) for n, a in row["asked"].items()}
        missed = missed or (row["chosen"] and "MISSED" in verdicts.values())
        if not options.json:
            mark = "chosen on the fitted trials" if row["chosen"] else "tied with it"
            print(
                f"{row['campaign']}: {row['model']} ({mark}); compared in {row['compare_s']:.0f} s, fitted in {row['fit_s']:.1f} s"
            )
            for name, value in row["found"].items():
                asked = row["asked"].get(name)
                bounds = "shown only"
                if asked:
                    must = "" if asked[0] is None else f"must {asked[0]:g}, "
                    bounds = f"{must}stretch {asked[1]:g}: {verdicts[name]}"
                print(f"    {name:20s}{'-' if value is None else f'{value:.3g}':>9s}   {bounds}")
            for sentence in row["words"] if row["chosen"] else ():
                print(f"    {sentence}")
    counted = coverage(rows)
    inside, all_ = sum(c[1] for c in counted), sum(c[2] for c in counted)
    missed = missed or (all_ > 0 and not options.only and inside / all_ < HELD[0])
    if not options.json:
        for what, inside_, count, width in (c for c in counted if c[2]):
            shown = f"{width:.0%} of the prediction" if what == "circle" else f"{width:.2g} deg"
            print(f"bands, {what}: {inside_} of {count} hold, median half-width {shown}")
        print(f"bands, all campaigns: {inside / max(all_, 1):.0%} hold   must {HELD[0]:.0%}, stretch {HELD[1]:.0%}")
        if not options.only:
            print(f"hakusan: {'not determined' if none else 'MISSED'}   {said}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
