#!/usr/bin/env python3
"""NMEA 0183 as it arrives: read line by line into a filter, a prediction and the bridge.

python studies/job_live_nmea.py [--short] [--json]

The log is written from a simulated 20/20 zig-zag of a container ship, sentence by sentence with the stamps of a logger, so the truth is
known. The commands read it as a log that grows; the bridge takes the same sentences as they would come over a network, at the times
of their stamps, so that ten minutes take seconds.
"""

from __future__ import annotations

import argparse
import contextlib
import datetime
import io
import json
import shlex
import sys
from pathlib import Path

import numpy as np
from _commands import answer, empty_folder
from _table import Row, close, show

import shipid
from shipid.bridge.core.core import BridgeCore
from shipid.bridge.recorder import Recorder
from shipid.bridge.sources.listened import ListenedSource
from shipid.cli import run
from shipid.trials.logs.nmea.settings import NmeaFormat, chosen_format
from shipid.trials.logs.nmea.writing import write_nmea

#: RSA and ROR leave their units open.
FORMAT = """title = "The bridge's own NMEA"
[nmea.rudder]
scale = "1 deg"
[nmea.order]
scale = "1 deg"
"""


def lines_of(path: Path) -> list[tuple[float, bytes]]:
    """Return each sentence of a log with the time of its stamp in s from the first."""
    found, first = [], None
    for line in path.read_text(encoding="ascii").splitlines():
        stamp, _, sentence = line.partition(" ")
        if not sentence.startswith("$"):
            continue
        moment = datetime.datetime.fromisoformat(stamp.replace("Z", "+00:00")).timestamp()
        first = moment if first is None else first
        found.append((moment - first, f"{sentence}\r\n".encode()))
    return found


def on_the_bridge(lines: list[tuple[float, bytes]], form: NmeaFormat, record: Path) -> tuple[BridgeCore, int]:
    """Feed sentences to a bridge at the times of their stamps, without a clock on the wall; the core, and how many tracks it predicted."""
    pilot = shipid.design_autopilot(shipid.find_model("de-keizer"), shipid.find_ship("soesterberg"))
    source = ListenedSource("127.0.0.1", 0, "udp", form)
    recorder = Recorder(record, pilot.ship.name, "nmea", simulated=True)
    core = BridgeCore(pilot, source, recording=recorder)
    predicted, k = 0, 0
    core.command({"command": "trial", "heading": 1.0})
    while k < len(lines):
        until = core.t + core.filter_interval
        while k < len(lines) and lines[k][0] <= until:
            source.feed(lines[k][1])
            k += 1
        core.step(until)
        question = core.question()
        if question is not None:
            core.take_answer(core.forecaster.answer(question))
            predicted += 1
    recorder.close()
    core.publish()
    return core, predicted


def rows(short: bool) -> list[Row]:
    """Do the job in an empty folder."""
    found = []
    duration = "300 s" if short else "700 s"
    trial = shipid.simulate(
        "de-keizer", "soesterberg", "zigzag:20/20", noise="standard", duration=duration, sampling="1 s"
    )
    log = write_nmea(trial, "live.nmea")
    Path("nmea.toml").write_text(FORMAT, encoding="utf-8")
    heading = float(np.degrees(trial["psi"][-1]))

    # A filter that follows the log line by line.
    command = "filter --follow live.nmea --wait '1 s' --format nmea.toml --model de-keizer --ship soesterberg --json"
    print(f"$ shipid {command}", file=sys.stderr)
    caught = io.StringIO()
    with contextlib.redirect_stdout(caught):
        code = run(shlex.split(command))
    estimates = [json.loads(line) for line in caught.getvalue().splitlines()]
    found.append(
        Row(
            "filter --follow: estimates",
            f"{len(trial)} or more, exit code 0",
            f"{len(estimates)}, {code}",
            len(estimates) >= len(trial) - 10 and code == 0,
        )
    )
    last = estimates[-1]["estimates"]["psi"]
    found.append(close("filter --follow: the last heading", heading, last["value"], 0.5, last["unit"], 4))

    # Where will she go? Nothing behind the instant is read, and what came later says whether it is true.
    at = 90.0
    predicted = answer(
        f"predict de-keizer --ship soesterberg --from live.nmea@{at:g} --format nmea.toml --rudder '-20 deg' --horizon 3"
    )["prediction"]
    true = shipid.simulate("de-keizer", "soesterberg", "zigzag:20/20", duration=duration, sampling="1 s")
    ends = at + predicted["track"]["t"]["values"][-1]
    # The log's positions begin at its first fix.
    x, y = (float(np.interp(ends, true["t"], true[n])) - trial[n][0] for n in ("x", "y"))
    off = float(np.hypot(predicted["track"]["x"]["values"][-1] - x, predicted["track"]["y"]["values"][-1] - y))
    band = predicted["half_width_95"]["values"][-1]
    found.append(
        Row(
            f"predict: where she is {ends - at:.0f} s later",
            f"within the band, {band:.0f} m",
            f"{off:.0f} m off",
            off < band,
        )
    )

    # The bridge: the same sentences, its recording, and what the recording measures.
    core, tracks = on_the_bridge(lines_of(log), chosen_format("nmea.toml"), Path("voyage.csv"))
    shown = core.own_ship.situation
    assert shown is not None
    found.append(close("bridge: the last heading", heading, float(np.degrees(shown.values["psi"])), 1.0, "deg", 4))
    found.append(
        Row("bridge: predicted tracks", "one every 2 s", f"{tracks} in {core.t:.0f} s", tracks > 0.45 * core.t)
    )
    measured = answer("measure voyage.csv")["overshoots"]
    truth = shipid.measure(true).to_dict()["overshoots"]["value"]
    found.append(
        close("measure: first overshoot of the bridge's recording", truth[0], measured["value"][0], 0.5, "deg", 3)
    )
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--short", action="store_true", help="five minutes of the log")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    chosen = parser.parse_args()
    with empty_folder():
        found = rows(chosen.short)
    show("A log of NMEA 0183 as it arrives", found, "", chosen.json)


if __name__ == "__main__":
    main()
