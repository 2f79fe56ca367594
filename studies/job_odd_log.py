#!/usr/bin/env python3
"""From the log of a German bridge to a tuned ship that is sailed in wind, command by command.

python studies/job_odd_log.py [--short] [--json]

The log is what a bridge logger writes: semicolons, decimal commas, cp1252, a title above the header, German names, date and time of day
over midnight, knots, degrees, a rudder that counts to port, a course that could be two things. It is written from a simulated 20/20
zig-zag of a container ship, so the truth is known. Everything behind it is a command, in an empty folder; what is not a command is what
the user writes into the format file.
"""

from __future__ import annotations

import argparse
import datetime
from pathlib import Path

import numpy as np
from _commands import answer, empty_folder, shipid
from _table import Row, close, show

from shipid import Trial, find_model, find_ship, measure, read_trial, simulate
from shipid.trials.logs.geodesy import to_geographic

#: Where the ship was, in degrees.
OFF = (54.25, 7.5)


def write_log(path: str) -> Trial:
    """Sail the zig-zag, write it as the logger of the bridge does, and return it as it was."""
    trial = simulate(
        find_model("de-keizer"),
        "soesterberg",
        "zigzag:20/20",
        noise="standard",
        seed=1,
        sampling="1 s",
        heading="347 deg",
    )
    begin = datetime.datetime(2026, 3, 14, 23, 52, 10)
    stamps = [begin + datetime.timedelta(seconds=float(t)) for t in trial["t"]]
    north, east = to_geographic(trial["x"], trial["y"], np.radians(OFF))
    columns = {
        "Datum": [f"{s:%d.%m.%Y}" for s in stamps],
        "Uhrzeit": [f"{s:%H:%M:%S}" for s in stamps],
        "Breite [°]": [f"{v:.6f}" for v in np.degrees(north)],
        "Länge [°]": [f"{v:.6f}" for v in np.degrees(east)],
        "Kurs [°]": [f"{v:.1f}" for v in np.degrees(trial["psi"]) % 360],
        "Drehgeschwindigkeit [°/min]": [f"{v:.1f}" for v in np.degrees(trial["r"]) * 60],
        "Ruderlage Bb+ [°]": [f"{v:.1f}" for v in -np.degrees(trial["delta"])],
        "Fahrt durchs Wasser [Knoten]": [f"{v:.2f}" for v in trial["u"] * 3600 / 1852],
        "Drehzahl [U/min]": ["92.4"] * len(stamps),
        "Bemerkung": [""] * len(stamps),
    }
    rows = [";".join(cells).replace(".", ",") for cells in zip(*list(columns.values())[1:], strict=True)]
    lines = [f"{day};{row}" for day, row in zip(columns["Datum"], rows, strict=True)]
    text = "\n".join(["Bordlogger MS Beispiel;Probefahrt 1", "", ";".join(columns), *lines, ""])
    Path(path).write_text(text, encoding="cp1252")
    return trial


def fill_in(path: str) -> None:
    """Write into the drafted format file what the log does not say: 'Kurs' is the gyro, the rudder counts to port."""
    text = Path(path).read_text(encoding="utf-8")
    open_ones = '# [columns.psi]\n# [columns.COG]\n# column = "Kurs"\n# unit = "°"'
    assert open_ones in text, text
    text = text.replace(open_ones, '[columns.psi]\ncolumn = "Kurs"\nunit = "°"')
    text = text.replace("[columns.delta]\n", "[columns.delta]\nsign = -1\n")
    Path(path).write_text(text, encoding="utf-8")


def rows(short: bool) -> list[Row]:
    """Do the job in an empty folder."""
    found = []
    write_log("probefahrt.csv")

    # Is the log sound? The doctor reads the German headers, and says that nothing else does.
    seen = answer("check probefahrt.csv", code=3)
    kinds = {f["kind"] for f in seen["findings"]}
    found.append(
        Row(
            "check: the log as it is",
            "rudder-sign and name, exit code 3",
            ", ".join(sorted(kinds)),
            {"rudder-sign", "name"} <= kinds,
        )
    )

    # A format file, drafted and filled in. With it the log is sound.
    shipid("format probefahrt.csv -o probefahrt.toml")
    fill_in("probefahrt.toml")
    code = shipid("check probefahrt.csv --format probefahrt.toml")
    found.append(Row("check: with the format file", "exit code 0", f"exit code {code}", code == 0))

    # What did the ship do?
    measured = answer("measure probefahrt.csv --format probefahrt.toml")
    true = measure(simulate(find_model("de-keizer"), "soesterberg", "zigzag:20/20", sampling="1 s"))
    first, unit = measured["overshoots"]["value"][0], measured["overshoots"]["unit"]
    found.append(close("measure: first overshoot", true.to_dict()["overshoots"]["value"][0], first, 0.5, unit, 3))

    # The ship, and her coefficients.
    shipid(
        "ship --new coaster --length '226 m' --speed '18.5 kn' --rudder '35 deg' --rudder-rate '2.5 deg/s' --source 'general "
        "arrangement' -o coaster.toml"
    )
    starts = " --starts 2" if short else ""
    fit = answer(
        f"identify probefahrt.csv --format probefahrt.toml --model de-keizer --ship coaster.toml --out found{starts}"
    )
    truth = find_ship("soesterberg").values(find_model("de-keizer"))
    for name in ("K", "tau", "K_u", "gamma"):
        value, std = fit["parameters"][name]["value"], fit["parameters"][name]["std"]
        found.append(close(f"identify: {name}", truth[name], value, 3 * std, digits=3))

    # An autopilot for her, and a change of course under it in wind.
    samples = " --samples 20" if short else ""
    tuned = answer(f"tune de-keizer --ship found/ship.toml --out tuning{samples}")
    margin = min(tuned["margins"]["disk"])
    found.append(Row("tune: least disk margin", "above 0.6", f"{margin:.2f}", margin > 0.6))
    wind = "--wind '15 m/s from 100 deg' --set 'N_w=3.3e-7 rad/m^2' --set 'F_w=3.5e-7 1/m^2'"
    code = shipid(
        f"simulate de-keizer --ship found/ship.toml --autopilot tuning/schedule.toml --course '30 deg' {wind} --duration '1500 s' -o voyage.csv"
    )
    voyage = read_trial("voyage.csv")
    last = voyage["t"] > voyage["t"][-1] - 120
    heading, rudder = (float(np.degrees(np.mean(voyage[n][last]))) for n in ("psi", "delta"))
    found.append(close("simulate: heading under the autopilot in wind", 30.0, heading, 0.3, "deg", 3))
    found.append(
        Row(
            "simulate: rudder that holds it",
            "not zero, below 15 deg",
            f"{rudder:.2f} deg",
            0.2 < abs(rudder) < 15 and code == 0,
        )
    )
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--short", action="store_true", help="fewer starts of the search, fewer draws of the judgement")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    chosen = parser.parse_args()
    with empty_folder():
        found = rows(chosen.short)
    show("From a German bridge log to a ship that is sailed in wind", found, "", chosen.json)


if __name__ == "__main__":
    main()
