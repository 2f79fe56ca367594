#!/usr/bin/env python3
"""Attacks on what shipid reads, keeps and writes: nothing torn, nothing run, nothing lost, exit codes as in the README.

Entries of the cache are cut, edited and replaced; saved states, schedules and ship files are mutated; results are written over
devices, onto a full disk, and by three processes at once; commands are killed (SIGKILL) and interrupted (SIGINT) at many places of
their lives. A place is counted from where shipid begins: before that the interpreter answers.

    python studies/attacks.py [--short] [--places 150] [--stopped NAME ...] [--signal kill] [--seed 0] [--json]

``--stopped`` does nothing but stop these: a command that writes, ``cache`` while it is built, ``state`` while it is saved; ``none``
stops nothing. ``--signal`` sends only that one.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import tomli_w
from _table import Row, show

import shipid
from shipid.autopilot.design.write_schedule import schedule_table
from shipid.estimation.errors import FilterDivergedError, SavedStateError
from shipid.estimation.online.saving import checksum_of
from shipid.parameters.parameter_file import parameter_table

TRIAL = Path(__file__).parent / "trials" / "container-20-20.csv"
BEGIN = "import sys; from shipid.cli import entry; print('begin', file=sys.stderr, flush=True); entry()"
IDENTIFY = ("identify", str(TRIAL), "--model", "nomoto", "--ship", "soesterberg", "--starts", "1")
TUNE = ("tune", "de-keizer", "--ship", "soesterberg", "--samples", "10", "--speeds", "7,9.5 m/s")
FILTER = ("filter", str(TRIAL), "--model", "nomoto", "--ship", "soesterberg")
SIGNALS = {"interrupt": signal.SIGINT, "kill": signal.SIGKILL}
#: The commands that write, and by which option.
WRITERS = {
    "identify": (*IDENTIFY, "--out"),
    "filter": (*FILTER, "--out"),
    "tune": (*TUNE, "--out"),
    "simulate": ("simulate", "norrbin", "--ship", "zeefakkel", "--manoeuvre", "zigzag:20/20", "--output"),
}
SAVE = """
import sys, shipid
kalman = shipid.ExtendedKalmanFilter("nomoto", "soesterberg", measured={"psi": "0.2 deg"}, estimated=["K"])
online = kalman.start()
print("begin", file=sys.stderr, flush=True)
for k in range(60):
    online.update({"t": 0.5 * k, "psi": 0.1, "delta": 0.05})
    online.save(sys.argv[1])
"""
ODD = (
    None,
    True,
    0,
    -1,
    10**400,
    float("nan"),
    float("inf"),
    "",
    "nan",
    "1 m",
    "0x1p+2000",
    "../own.py:Own",
    [],
    {},
    [[1]],
    "x" * 300,
)


def start(arguments: tuple[str, ...], code: str = BEGIN, limit: int | None = None, **changes: str) -> Any:
    """Start a command, and return when it has begun; a shell may have told it to ignore SIGINT."""

    def before() -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    process = subprocess.Popen(
        [sys.executable, "-c", code, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, **changes},
        preexec_fn=before,
    )
    assert process.stderr is not None
    process.stderr.readline()
    return process


def ended(process: Any) -> tuple[int, str, str]:
    """Wait for a command: its exit code, what it printed, what it said."""
    out, err = process.communicate(timeout=600)
    return process.returncode, out, err


def mutated(table: Any, chance: random.Random) -> Any:
    """The same table with one to three entries changed, at any depth."""
    for _ in range(chance.choice((1, 1, 2, 3))):
        place, key = table, chance.choice(list(table))
        while isinstance(place[key], (dict, list)) and place[key] and chance.random() < 0.8:
            place = place[key]
            key = chance.choice(list(place)) if isinstance(place, dict) else chance.randrange(len(place))
        if chance.random() < 0.2 and not (place is table and len(table) < 2):
            del place[key]
        else:
            place[key] = chance.choice(ODD)
    return table


def cache(count: int, chance: random.Random, folder: Path) -> Row:
    """Damage each entry of a cache and run the command again: it has to print the same."""
    home = {"SHIPID_CACHE": str(folder / "cache")}
    model = (*FILTER, "--json")
    code, asked, _ = ended(start(model, **home))
    same = 0
    for _ in range(count):
        for entry in (folder / "cache").iterdir():
            whole = entry.read_bytes()
            k = chance.randrange(len(whole))
            harmed = (whole[:k], whole[:k] + bytes([whole[k] ^ 255]) + whole[k + 1 :], bytes(len(whole)), b"")
            entry.write_bytes(chance.choice(harmed))
        same += (code, asked) == ended(start(model, **home))[:2]
    return Row("cache: entries cut, edited, replaced", f"{count} the same result", str(same), same == count)


def refused(what: str, count: int, attack: Callable[[], str]) -> Row:
    """Run an attack many times: it returns what happened, or raises what a user would see as a traceback."""
    tracebacks = 0
    for _ in range(count):
        try:
            attack()
        except Exception:  # whatever it is, it is counted
            tracebacks += 1
    return Row(what, f"0 tracebacks of {count}", str(tracebacks), tracebacks == 0)


def states(count: int, chance: random.Random, folder: Path) -> Row:
    """Mutate a saved state, with and without a checksum that fits."""
    kalman = shipid.ExtendedKalmanFilter("nomoto", "soesterberg", measured={"psi": "0.2 deg"}, estimated=["K"])
    online = kalman.start()
    for k in range(9):
        online.update({"t": 0.5 * k, "psi": 0.1, "delta": 0.05})
    online.save(path := folder / "state.json")
    text = path.read_text()

    def attack() -> str:
        if chance.random() < 0.3:
            path.write_text(text[: chance.randrange(len(text))])
        else:
            state = mutated(json.loads(text), chance)
            path.write_text(json.dumps(state | {"checksum": checksum_of(state)}))
        try:
            kalman.restore(path).update({"t": 5.0, "psi": 0.1, "delta": 0.05})
        except (SavedStateError, FilterDivergedError) as error:
            return str(error)
        return ""

    return refused("saved states: cut and edited", count, attack)


def tables(count: int, chance: random.Random, folder: Path) -> list[Row]:
    """Mutate schedules and ship files; none may run the model file that lies beside them."""
    (folder / "own.py").write_text(f"open({str(folder / 'ran')!r}, 'w')")
    pilot = shipid.design_autopilot("de-keizer", "soesterberg", speeds="7,9.5 m/s")
    model, path = shipid.find_model("de-keizer"), folder / "edited.toml"

    def attack(make: Callable[[], Any], read: Callable[[], Any]) -> Callable[[], str]:
        def once() -> str:
            table = mutated(make(), chance)
            if chance.random() < 0.1:
                table["model"] = f"{folder}/own.py:Own"
            path.write_text(tomli_w.dumps(_without_none(table)))
            try:
                read()
            except shipid.ShipidError as error:
                return str(error)
            return ""

        return once

    schedule = attack(lambda: schedule_table(pilot), lambda: shipid.read_schedule(path))
    ship = attack(
        lambda: parameter_table(shipid.find_ship("soesterberg")),
        lambda: shipid.read_parameter_set(path).values(model, speed=9.5),
    )
    rows = [refused("schedules: edited", count, schedule), refused("ship files: edited", count, ship)]
    ran = (folder / "ran").exists()
    return [*rows, Row("model files named by them", "none run", "run" if ran else "none run", not ran)]


def _without_none(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: _without_none(v) for k, v in value.items() if v is not None}
    return [_without_none(v) for v in value if v is not None] if isinstance(value, list) else value


def places(folder: Path) -> Row:
    """Ask for a result in the place of something that is no file."""
    kinds: dict[str, Callable[[Path], object]] = {
        "pipe": os.mkfifo,
        "folder": Path.mkdir,
        "link to a device": lambda path: path.symlink_to("/dev/null"),
        "link to nothing": lambda path: path.symlink_to(folder / "nothing"),
    }
    found = []
    for kind, make in kinds.items():
        out = folder / kind
        out.mkdir()
        make(out / "ship.toml")
        before = (out / "ship.toml").lstat()
        code, printed, _ = ended(start((*IDENTIFY, "--out", str(out), "--overwrite")))
        held = (code, printed) == (3, "") and (out / "ship.toml").lstat().st_mode == before.st_mode
        found.append(held and [p.name for p in out.iterdir()] == ["ship.toml"])
    return Row("--overwrite on pipe, folder, device, dead link", "4 refused with 3", str(sum(found)), all(found))


def full_disk(folder: Path) -> Row:
    """Write beyond the largest file that the system allows: the result is printed, and no file is left."""
    out = folder / "full"
    ended(start(IDENTIFY))  # compiled and kept before
    code, printed, said = ended(start((*IDENTIFY, "--out", str(out)), limit=2000))
    held = code == 3 and "K" in printed and "Traceback" not in said and list(out.iterdir()) == []
    return Row("disk full", "result printed, no file, exit 3", f"exit {code}, {len(list(out.iterdir()))} files", held)


def writers(folder: Path) -> Row:
    """Let three processes write to one folder: the files that are left are of one of them."""
    out = folder / "three"
    models = ("nomoto", "norrbin", "de-keizer")
    started = [
        start(("identify", str(TRIAL), "--model", m, *IDENTIFY[4:], "--out", str(out), "--overwrite")) for m in models
    ]
    codes = [ended(p)[0] for p in started]
    left = whole(out)
    ship = tomllib.loads((out / "ship.toml").read_text()) if left else {}
    model = json.loads((out / "result.json").read_text())["model"] if left else None
    held = set(codes) <= {0, 4} and left and model in ship["identified"]
    return Row("three writers", "the files of one", f"exit {codes}, {model}", bool(held))


def whole(out: Path, rows: dict[str, int] | None = None) -> bool:
    """Whether each file of a result is there, and whole; tables by name have so many rows."""
    try:
        for path in (out / name for name in (rows or ("result.json", "report.html", "ship.toml"))):
            text = path.read_text(encoding="utf-8")
            if path.suffix == ".json":
                json.loads(text)
            elif path.suffix == ".toml":
                tomllib.loads(text)
            elif path.suffix == ".html" and not text.rstrip().endswith("</html>"):
                raise ValueError("no end")
            elif path.suffix == ".csv" and rows and text.count("\n") != rows[path.name]:
                raise ValueError("another number of rows")
    except (OSError, ValueError):
        return False
    return True


def stopped(command: tuple[str, ...], number: int, after: float, **changes: str) -> str:
    """Send a signal to a command; returns what is wrong with how it ended, or nothing."""
    process = start(command, **changes)
    time.sleep(after)
    process.send_signal(number)
    code, _, said = ended(process)
    allowed = {signal.SIGINT: {0, 130}, signal.SIGKILL: {0, -signal.SIGKILL}}[signal.Signals(number)]
    return "" if code in allowed and "Traceback" not in said else f"exit {code}, {said[-200:]!r}"


def life(name: str, number: int, count: int, folder: Path) -> Row:
    """Stop a command at places spread over its life: files are all there and whole, or none is; the next run sweeps."""
    out = folder / f"{name}-{signal.Signals(number).name}"
    out.mkdir()
    command = (*WRITERS[name], str(out / "trial.csv" if name == "simulate" else out), "--overwrite")
    began = time.perf_counter()
    ended(start(command))
    seconds, bad = time.perf_counter() - began, []
    rows = {path.name: path.read_bytes().count(b"\n") for path in out.iterdir()}
    for i in range(count):
        # Later ones meet the files of the first run, which stay whole; every third begins with an empty folder.
        if i % 3 == 0:
            for path in out.iterdir():
                path.unlink() if path.is_file() else None
        wrong = stopped(command, number, seconds * (i + 0.5) / count)
        files = [p for p in out.iterdir() if not p.name.startswith(".shipid-")]
        if wrong or (files and not whole(out, rows)):
            bad.append(f"{i}: {wrong}, {len(files)} files")
    code = ended(start(command))[0]
    left = [p for folder in (out, out.parent) for p in folder.iterdir() if p.name.startswith(".shipid-")]
    swept = bool(rows) and code == 0 and whole(out, rows) and not left
    words = f"{len(bad)} bad, {'swept' if swept else 'not swept'}{'; ' + bad[0] if bad else ''}"
    return Row(f"{name}: {signal.Signals(number).name} at {count} places", "0 bad, swept", words, swept and not bad)


def building(number: int, count: int, folder: Path) -> Row:
    """Stop a filter while it compiles into an empty cache: what is left serves the next run, or is made anew, and is swept."""
    command, bad = (*FILTER, "--json"), []
    began = time.perf_counter()
    asked = ended(start(command, SHIPID_CACHE=str(folder / f"cold-{number}")))[:2]
    seconds = time.perf_counter() - began
    for i in range(count):
        home = folder / f"cold-{number}-{i}"
        wrong = stopped(command, number, seconds * (i + 0.5) / count, SHIPID_CACHE=str(home))
        same = asked == ended(start(command, SHIPID_CACHE=str(home)))[:2]
        left = [p.name for p in home.iterdir() if p.name.startswith(".shipid-")]
        if wrong or not same or left:
            bad.append(f"{i}: {wrong}, {'the same' if same else 'another'} result, {len(left)} left")
        shutil.rmtree(home)
    words = f"{len(bad)} bad{'; ' + bad[0] if bad else ''}"
    return Row(f"cache being built: {signal.Signals(number).name} at {count} places", "0 bad", words, not bad)


def saving(number: int, count: int, folder: Path) -> Row:
    """Stop a filter that saves its state with every sample: the state is whole."""
    path, bad = folder / f"live-{number}.json", 0
    kalman = shipid.ExtendedKalmanFilter("nomoto", "soesterberg", measured={"psi": "0.2 deg"}, estimated=["K"])
    began = time.perf_counter()
    ended(start((str(path),), SAVE))
    seconds = time.perf_counter() - began
    for i in range(count):
        process = start((str(path),), SAVE)
        time.sleep(seconds * (i + 0.5) / count / 2)
        process.send_signal(number)
        ended(process)
        try:
            kalman.restore(path)
        except SavedStateError:
            bad += 1
    ended(start((str(path),), SAVE))
    left = [p.name for p in folder.iterdir() if p.name.startswith(".shipid-")]
    return Row(
        f"saved state: {signal.Signals(number).name} at {count} places",
        "0 torn, swept",
        f"{bad} torn, {len(left)} left",
        not bad and not left,
    )


def attacks(short: bool, chance: random.Random, folder: Path) -> list[Row]:
    """Everything but the signals."""
    rows = [cache(1 if short else 40, chance, folder), states(500 if short else 4000, chance, folder)]
    rows += tables(60 if short else 1000, chance, folder)
    return [*rows, places(folder), full_disk(folder), writers(folder)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true", help="for every change: fewer of each, in less than a minute")
    parser.add_argument("--places", type=int, default=150, help="where each command is stopped")
    parser.add_argument(
        "--stopped", action="append", choices=[*WRITERS, "cache", "state", "none"], help="nothing but stop these"
    )
    parser.add_argument("--signal", choices=SIGNALS, action="append", help="by default both")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    given = parser.parse_args()
    chance, short = random.Random(given.seed), given.short
    count = 2 if short else given.places
    with tempfile.TemporaryDirectory(prefix="shipid-attacks-") as name:
        folder = Path(name)
        rows = [] if given.stopped and given.stopped != ["none"] else attacks(short, chance, folder)
        names = given.stopped or (["identify", "state"] if short else [*WRITERS, "cache", "state"])
        for number in (SIGNALS[name] for name in given.signal or SIGNALS):
            for what in (n for n in names if n != "none"):
                stop = {"cache": building, "state": saving}.get(what)
                rows.append(stop(number, count, folder) if stop else life(what, number, count, folder))
                print(rows[-1].what, rows[-1].measured, file=sys.stderr, flush=True)
    show("Attacks on what is read, kept and written", rows, as_json=given.json)


if __name__ == "__main__":
    main()
