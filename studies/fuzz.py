#!/usr/bin/env python3
"""Seeded mutations of logs, format files, windows and live streams through the commands: what breaks?

Every input is made of its number and the seed, and runs through the command line in a worker process of its own. It passes where the
command ends with an exit code of the table (never 70), within 10 s of a processor and 2 GB, says what it has to say without a traceback and
without a control character, prints strict JSON, reads back what ``check --fix`` wrote, and counts every row of a table that
it leaves out.

    python studies/fuzz.py [--inputs 50000] [--seed 0] [--family NAME] [--only NUMBER] [--keep FOLDER] [--json]

``--only`` runs one input again in this process and prints what it is and what was answered; ``--keep`` writes the inputs that fail.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import multiprocessing as mp
import os
import random
import re
import resource
import signal
import sys
import tempfile
import time
import unicodedata
from collections import Counter, defaultdict
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

import _fuzz_inputs as inputs
from _table import Row, show

#: What an input may take of a processor; in all, so that other work on the machine is no fault; and of memory.
SECONDS, LONGEST, MEMORY = 10.0, 60.0, 2 << 30
#: How often each family comes.
FAMILIES = {"text": 24, "tables": 16, "nmea": 10, "messages": 6, "formats": 10, "doctor": 18, "windows": 6, "live": 10}


@dataclass(frozen=True)
class Case:
    """An input: the command, the files it needs, what it reads from standard input, and the rows of a sound table."""

    family: str
    arguments: tuple[str, ...]
    files: dict[str, bytes]
    stdin: bytes = b""
    rows: int | None = None


def case(number: int, seed: int, family: str | None = None) -> Case:
    """Return the input of a number."""
    chance = random.Random(seed * 1_000_003 + number)
    family = family or chance.choices(list(FAMILIES), list(FAMILIES.values()))[0]
    strength = chance.choice((1, 1, 2, 3, 6, 20))
    reading = chance.choice((("check",), ("check",), ("measure",)))
    if family == "text":
        data = inputs.mutated(inputs.text(chance.choice(inputs.TEXT)), chance, strength)
        name = "log.csv"
        if chance.random() < 0.1:
            data, suffix = inputs.compressed(data, chance)
            name += suffix
        return Case(family, (*reading, name, "--json"), {name: data})
    if family == "tables":
        suffix = chance.choice((".parquet", ".parquet", ".xlsx", ".mat", ".h5"))
        data = inputs.mutated(inputs.binary(suffix), chance, strength)
        name = f"log{suffix if chance.random() < 0.9 else chance.choice(('.csv', '.xls', '.parquet', '.mat', ''))}"
        return Case(family, (*reading, name, "--json"), {name: data})
    if family == "nmea":
        data = inputs.mutated(inputs.nmea() if chance.random() < 0.7 else inputs.canboat(), chance, strength)
        stated = ("--format", "nmea") if chance.random() < 0.5 else ()
        return Case(family, (*reading, "log.nmea", *stated, "--json"), {"log.nmea": data})
    if family == "messages":
        data = inputs.messages(chance, strength)
        data = inputs.mutated(data, chance, 1) if chance.random() < 0.3 else data
        return Case(family, (*reading, "log.raw", "--json"), {"log.raw": data})
    if family == "formats":
        data = inputs.mutated(inputs.FORMAT, chance, strength)
        return Case(
            family,
            (*reading, "log.csv", "--format", "f.toml", "--json"),
            {"log.csv": inputs.text("comma"), "f.toml": data},
        )
    if family == "doctor":
        frame = inputs.changed_table(chance)
        data = inputs.written(frame)
        if chance.random() < 0.6:
            return Case(
                family, ("check", "log.csv", "--fix", "-o", "fixed.csv", "--json"), {"log.csv": data}, rows=len(frame)
            )
        return Case(family, (*reading, "log.csv", "--json"), {"log.csv": data}, rows=len(frame))
    if family == "windows":
        form = chance.choice(("comma", "dates"))
        return Case(family, (*reading, f"log.csv@{inputs.window(chance)}", "--json"), {"log.csv": inputs.text(form)})
    form = ("--json",) if chance.random() < 0.3 else ()
    arguments = ("filter", "--follow", "-", "--model", "nomoto", "--ship", "zeefakkel", "--estimate", "none", *form)
    return Case("live", arguments, {}, stdin=inputs.stream(chance))


def foul(text: str) -> str | None:
    """A control character that would reach a terminal."""
    bad = next(
        (
            c
            for c in text
            if c not in "\n\t"
            and (unicodedata.category(c) in ("Cc", "Cs") or c in "\u202a\u202b\u202d\u202e\u2066\u2067\u2068")
        ),
        None,
    )
    return None if bad is None else f"control character {bad!r} in the output"


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} in the JSON")


def run(one: Case, folder: Path) -> tuple[list[str], str, str, int | None]:
    """Run an input in this process; returns its faults, what was printed, and the exit code."""
    from shipid.cli import run as shipid_run

    for old in folder.iterdir():
        old.unlink()
    for name, data in one.files.items():
        (folder / name).write_bytes(data)
    out, err = io.StringIO(), io.StringIO()
    faults: list[str] = []
    code: int | None = None
    before, sys.stdin = sys.stdin, io.TextIOWrapper(io.BytesIO(one.stdin), encoding="utf-8", errors="strict")
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = int(shipid_run(list(one.arguments)))
    except BaseException as error:  # nothing may leave the command line
        faults.append(f"{type(error).__name__} left the command line: {error}"[:200])
    finally:
        sys.stdin = before
    printed, said = out.getvalue(), err.getvalue()
    if code not in (0, 2, 3, 4, 5):
        faults.append(f"exit code {code}: {' '.join(said.split())[:300]}")
    faults += [f"'{word}' in the output" for word in ("Traceback", "Warning:") if word in printed + said]
    if (bad := foul(printed + said)) is not None:
        faults.append(bad)
    if code not in (0, None) and not said.strip() and not printed.strip():
        faults.append("refused without a word")
    if "--json" in one.arguments and printed.strip():
        texts = printed.splitlines() if "--follow" in one.arguments else [printed]
        try:
            for text in texts:
                json.loads(text, parse_constant=_no_constant)
        except ValueError as error:
            faults.append(f"no strict JSON: {error}"[:200])
    elif "--follow" in one.arguments and re.search(r"\b(nan|inf)\b", printed):
        faults.append("NaN in the estimates")
    if not faults and one.rows is not None:
        faults += lost_rows(one, folder, printed, code)
    return faults, printed, said, code


def lost_rows(one: Case, folder: Path, printed: str, code: int | None) -> list[str]:
    """Rows that are neither in what was read or written nor counted in a note."""
    import shipid
    from shipid.foundation.errors import ShipidError

    fixed = folder / "fixed.csv"
    if "--fix" in one.arguments and code == 0:
        if not fixed.exists():
            return ["--fix wrote no file"]
        with fixed.open() as file:
            kept = sum(not line.startswith("#") for line in file) - 1
        counted = re.findall(r"(\d+) (?:[a-z ]*)rows?\b", printed)
        if kept < (one.rows or 0) and not counted:
            return [f"--fix kept {kept} of {one.rows} rows without a word"]
        try:
            shipid.read_trial(fixed)
        except ShipidError as error:
            return [f"what --fix wrote is refused: {error}"[:300]]
        return []
    try:
        trial = shipid.read_trial(folder / "log.csv")
    except ShipidError:
        return []  # the commands say so
    counts = [int(n) for note in trial.source.notes for n in re.findall(r"(\d+) (?:[a-z ]*)rows?\b", note)]
    if len(trial) != one.rows and (one.rows or 0) - len(trial) not in counts:
        return [f"{len(trial)} of {one.rows} rows were read, and the notes count {counts}"]
    return []


def forgotten_peak() -> bool:
    """Let the peak of memory begin anew, so that making an input does not count; returns whether this system can."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return False
    return True


def peak_memory(begun: bool) -> int:
    """Return the most memory that this process took, in bytes, since `forgotten_peak` where it could."""
    if begun:
        found = re.search(r"^VmHWM:\s+(\d+) kB$", Path("/proc/self/status").read_text(), re.MULTILINE)
        if found:
            return int(found[1]) * 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def work(pipe: Connection, seed: int, family: str | None) -> None:
    """Run the inputs whose numbers come through the pipe."""
    resource.setrlimit(resource.RLIMIT_AS, (4 * MEMORY, 4 * MEMORY))
    with tempfile.TemporaryDirectory() as folder:
        while (number := pipe.recv()) is not None:
            one = case(number, seed, family)
            pipe.send(("began", number, one.family, ""))
            before = forgotten_peak()
            # At its end the process dies, also where it is busy in a library.
            signal.setitimer(signal.ITIMER_PROF, SECONDS)
            faults, *_ = run(one, Path(folder))
            signal.setitimer(signal.ITIMER_PROF, 0)
            if (peak := peak_memory(before)) > MEMORY:
                faults.append(f"{peak / 2**30:.1f} GB of memory")
            pipe.send(("done", number, one.family, "; ".join(faults)))
        os.chdir("/")


class Worker:
    """A process that runs inputs, replaced when it dies, hangs or has grown."""

    def __init__(self, seed: int, family: str | None) -> None:
        self.settings = (seed, family)
        self.start()

    def start(self) -> None:
        """Start a new process."""
        context = mp.get_context("spawn")
        self.pipe, other = context.Pipe()
        self.process = context.Process(target=work, args=(other, *self.settings), daemon=True)
        self.process.start()
        other.close()
        self.number: int | None = None
        self.family, self.since = "", float("inf")

    def give(self, number: int) -> None:
        """Hand over the next input."""
        self.number, self.since = number, float("inf")
        self.pipe.send(number)

    def replace(self) -> None:
        """Stop the process and start another one."""
        self.process.kill()
        self.process.join()
        self.start()


def fuzz(
    count: int, seed: int, family: str | None, workers: int = 2
) -> tuple[Counter[str], dict[str, list[tuple[int, str]]]]:
    """Run inputs 0 to count - 1; returns how many each family had, and its faults with their numbers."""
    done: Counter[str] = Counter()
    faults: dict[str, list[tuple[int, str]]] = defaultdict(list)
    numbers = iter(range(count))
    pool = [Worker(seed, family) for _ in range(min(workers, count))]
    open_ = 0
    for worker in pool:
        worker.give(next(numbers))
        open_ += 1

    def end(worker: Worker, fault: str) -> None:
        nonlocal open_
        done[worker.family or "start"] += 1
        if fault:
            faults[worker.family or "start"].append((int(worker.number or 0), fault))
        if (following := next(numbers, None)) is None:
            open_ -= 1
            worker.number = None
        else:
            worker.give(following)

    while open_:
        ready = wait([w.pipe for w in pool if w.number is not None], timeout=0.5)
        for worker in pool:
            if worker.number is None:
                continue
            if worker.pipe in ready:
                try:
                    what, _, worker.family, fault = worker.pipe.recv()
                except EOFError:
                    number, family_ = worker.number, worker.family
                    worker.process.join(1.0)  # it may wait for processes of its own
                    late = worker.process.exitcode == -signal.SIGPROF
                    worker.replace()
                    worker.number, worker.family = number, family_
                    end(worker, f"no answer within {SECONDS:g} s of a processor" if late else "the process died")
                    continue
                if what == "began":
                    worker.since = time.monotonic()
                    continue
                if "GB of memory" in fault:
                    number, family_ = worker.number, worker.family
                    worker.replace()
                    worker.number, worker.family = number, family_
                end(worker, fault)
            elif time.monotonic() - worker.since > LONGEST:
                number, family_ = worker.number, worker.family
                worker.replace()
                worker.number, worker.family = number, family_
                end(worker, f"no answer within {LONGEST:g} s")
        if sys.stderr.isatty():
            print(f"\r{sum(done.values())}/{count}, {sum(map(len, faults.values()))} faults", end="", file=sys.stderr)
    for worker in pool:
        worker.process.kill()
    return done, faults


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--inputs", type=int, default=50_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--family", choices=list(FAMILIES))
    parser.add_argument("--only", type=int)
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    if given.only is not None:
        one = case(given.only, given.seed, given.family)
        with tempfile.TemporaryDirectory() as folder:
            faults, printed, said, code = run(one, Path(folder))
            os.chdir("/")
        keep(one, given.only, given.keep)
        print(one.family, *one.arguments, one.stdin[:2000] if one.stdin else "", sep="\n")
        print(f"exit {code}\n{printed[:3000]}\n{said}\n{faults or 'no fault'}")
        return
    done, faults = fuzz(given.inputs, given.seed, given.family)
    for family, found in faults.items():
        for number, fault in found[:10]:
            print(f"{family} {number}: {fault}", file=sys.stderr)
        for number, _ in found:
            keep(case(number, given.seed, given.family), number, given.keep)
    rows = [
        Row(f"{family}: {done[family]} inputs", "0 faults", f"{len(faults[family])} faults", not faults[family])
        for family in (*FAMILIES, "start")
        if done[family]
    ]
    show(f"Seeded mutations through the commands, seed {given.seed}", rows, as_json=given.json)


def keep(one: Case, number: int, folder: Path | None) -> None:
    """Write the files of an input."""
    if folder is not None:
        here: Any = folder / f"{one.family}-{number}"
        here.mkdir(parents=True, exist_ok=True)
        for name, data in {**one.files, **({"stdin": one.stdin} if one.stdin else {})}.items():
            (here / name).write_bytes(data)


if __name__ == "__main__":
    main()
