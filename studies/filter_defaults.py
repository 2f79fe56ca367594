"""`shipid filter` with every default, beside the batch estimate of the same record.

Simulated zig-zags of the shipped ships, whose gain and time constant are not those of the ship that the filter is given, with
noise of 0.1 to 2 degrees on the heading; the same of a ship of another structure than the filter's; and the zig-zags of four
measured campaigns. For each record the plain command is run, and output error fits the same model to the same record.

Asked: each coefficient inside the 95 % interval of output error, or a sentence in the text and in the JSON and an exit code that
is not zero; and less than a tenth of each sensor's samples rejected, or said so. Of the simulated records of the filter's own
structure, most have to end without a word.

The measured trials are not part of the project; the script looks for them in ``../shared/data`` or ``--data``, and leaves them out
where they are not.

    python studies/filter_defaults.py [--short] [--data FOLDER] [--json]
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from _table import Row, show

import shipid
from shipid import cli
from shipid.trials.logs.writing import write_trial

FORMATS = Path(__file__).parent / "formats"
#: Ships whose own values a filter with Nomoto's model starts from, and the factors on gain and time constant of the ship that sails.
SHIPS = ("zeefakkel", "soesterberg", "gunnerus", "mariner", "esso-osaka-3m", "kvlcc2-7m")
FACTORS = {"K": 1.2, "tau": 0.8}
HEADING_NOISE = (0.1, 0.2, 0.5, 1.0, 2.0)
#: Ships that sail with another model than the filter's.
OTHERS = (("de-keizer", "soesterberg"), ("bech", "kvlcc2-7m"), ("nomoto-second-order", "mariner"))
#: Measured zig-zags: file or pattern, windows or runs, format, ship.
CAMPAIGNS = (
    ("gunnerus/RVG_ManeuveringTests_part1.csv@{}", ("1958:2195", "1622:1712", "2690:2900"), "gunnerus"),
    ("kvlcc2-marin/MARIN_FREE_KVLCC2_{}_m.dat", ("zz_20", "zz_-20", "zz_10"), "kvlcc2"),
    ("kvlcc2-hsva/HSVA_CPMC_KVLCC2_Z_{}.dat", ("20_10_P", "20_10_S", "10_10_P", "35_05"), "kvlcc2-7m"),
    ("esso-osaka/zigzag_31-Jul-2020_{}", ("14_03_39.csv@33.6:146", "13_29_19.csv@41:134"), "esso-osaka-3m"),
)
NAMES = ("K", "tau")


@dataclass(frozen=True)
class Record:
    """A record to filter.

    Attributes
    ----------
    title : str
        What it is.
    arguments : tuple of str
        The trial, and its format where it needs one.
    ship : str
        The ship that filter and fit are given.
    exact : bool
        Whether the model of the filter is that of the ship.
    """

    title: str
    arguments: tuple[str, ...]
    ship: str
    exact: bool = False


def simulated(folder: Path, short: bool) -> Iterator[Record]:
    """Sail the simulated records."""
    for k, ship in enumerate(SHIPS[:2] if short else SHIPS):
        known = shipid.find_ship(ship)
        own = known.values(shipid.find_model("nomoto"), speed=known.particular("speed", "m/s"))
        units = {"K": "1/s", "tau": "s"}
        values = {n: f"{own[n] * f!r} {units[n]}" for n, f in FACTORS.items()}
        for level in HEADING_NOISE[1::3] if short else HEADING_NOISE:
            noise = {"psi": f"{level} deg", "r": "0.02 deg/s"}
            trial = shipid.simulate("nomoto", ship, "zigzag:20/20", values=values, noise=noise, seed=10 * k)
            yield Record(f"{ship}, heading {level} deg", (_written(trial, folder),), ship, True)
    for model, ship in OTHERS[:1] if short else OTHERS:
        for level in HEADING_NOISE[1:2] if short else HEADING_NOISE[::2]:
            noise = {"psi": f"{level} deg", "r": "0.02 deg/s"}
            trial = shipid.simulate(model, ship, "zigzag:20/20", noise=noise, seed=7)
            yield Record(f"{ship} by {model}, heading {level} deg", (_written(trial, folder),), ship)


def _written(trial: shipid.Trial, folder: Path) -> str:
    path = folder / f"{len(list(folder.iterdir()))}.csv"
    write_trial(trial, path)
    return str(path)


def measured(data: Path, short: bool) -> Iterator[Record]:
    """Find the measured records."""
    for pattern, runs, ship in CAMPAIGNS:
        for run in runs[:1] if short else runs:
            file = data / pattern.format(run)
            if Path(str(file).partition("@")[0]).is_file():
                name = {"gunnerus": "gunnerus", "kvlcc2": "kvlcc2-marin", "kvlcc2-7m": "kvlcc2-hsva"}.get(
                    ship, "esso-osaka"
                )
                yield Record(f"{name} {run}", (str(file), "--format", str(FORMATS / f"{name}.toml")), ship)


def filtered(record: Record) -> tuple[int, dict[str, object], str]:
    """Run the plain command; return its exit code, its JSON and its text."""
    told = []
    for tail in (["--json"], []):
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
            code = cli.run(["filter", *record.arguments, "--model", "nomoto", "--ship", record.ship, *tail])
        told.append(out.getvalue())
    return code, json.loads(told[0]) if told[0] else {}, told[1]


def judged(record: Record) -> Row:
    """Compare the filter of a record with output error."""
    trial = shipid.read_trial(record.arguments[0], format=record.arguments[2] if len(record.arguments) > 1 else None)
    fit = shipid.identify("nomoto", [trial], ship=record.ship)
    code, result, text = filtered(record)
    asked, found, inside = [], [], bool(result)
    for name in NAMES:
        ends, value = fit.parameters[name].ci95, result.get("parameters", {}).get(name, {}).get("value")
        asked.append("-" if ends is None else f"{ends[0]:.4g} to {ends[1]:.4g}")
        found.append("-" if value is None else f"{value:.4g}")
        inside = inside and ends is not None and value is not None and ends[0] <= value <= ends[1]
    shares = [i["rejected"] / max(i["samples"], 1) for i in result.get("innovations", {}).values()]
    rejected = max(shares, default=1.0)
    serious = [d["message"] for d in result.get("warnings", []) if d["serious"]]
    told = code != 0 and bool(serious) and all(d in text for d in serious)
    word = "inside" if inside else "outside"
    return Row(
        record.title,
        f"K {asked[0]}, tau {asked[1]}",
        f"K {found[0]}, tau {found[1]}, {word}, rejected {rejected:.0%}{', told' if told else ''}, exit {code}",
        told or (inside and rejected < 0.1),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true", help="a few records of each kind")
    parser.add_argument("--data", type=Path, default=Path(__file__).resolve().parents[2] / "shared" / "data")
    parser.add_argument("--json", action="store_true")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        records = list(simulated(Path(folder), chosen.short))
        real = list(measured(chosen.data, chosen.short))
        rows = [judged(r) for r in [*records, *real]]
    quiet = [r.measured.endswith("exit 0") for r, record in zip(rows, records) if record.exact]
    share = sum(quiet) / len(quiet)
    rows.append(
        Row("simulated, own structure", "9 of 10 without a word", f"{sum(quiet)} of {len(quiet)}", share >= 0.9)
    )
    absent = "" if real else f"The measured trials are not at {chosen.data}; they were left out."
    show("shipid filter with its defaults, beside output error", rows, absent, chosen.json)


if __name__ == "__main__":
    main()
