#!/usr/bin/env python3
"""Small faults planted in the sources one at a time (mutants): how many do the tests notice?

The mutants are drawn over all rooms (folders of the packages) in proportion to their statements, among the statements that tests
execute: at most one of a line, none in annotations, imports, decorators, errors, warnings and docstrings. Which test executes which line
is recorded by one run of the whole suite under Coverage.py, kept in the cache folder until sources or tests change. Each mutant then
runs in a scratch copy of the tree against the tests that execute its line, cheapest first, then those of its file and its room, until one
fails or the budget is spent. A mutant that runs into the time limit counts as killed.

Results are appended to ``--out`` as they come: an interrupted run goes on where it stopped, and a run with new tests, or with a larger
budget, tries again only what survived. A survivor that changes no result is explained in ``equivalent_mutants.toml`` and leaves the
count. The study fails below 95 % killed.

The operators are Cosmic Ray's with a few of our own (`_mutants.py`). Its runner is not used: it runs one command for every mutant,
the whole suite of some minutes, and knows nothing of the tests that execute a line.

    python studies/mutation.py [--mutants 200] [--seed 0] [--only ROOM] [--out FILE] [--list] [--json]
"""

from __future__ import annotations

import argparse
import contextlib
import json
import resource
import signal
import sqlite3
import sys
import tempfile
import tomllib
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from _executions import Executions, measure, tree_digest
from _kills import Result, Runner, as_line, control, proof_of, read_results
from _mutants import Mutant, draw, quotas, room_of
from _scratch import Scratch

from shipid.foundation.cache import cache_folder

ROOT = Path(__file__).resolve().parents[1]
EQUIVALENT = Path(__file__).with_name("equivalent_mutants.toml")
ASKED = 0.95
MEMORY = 8 << 30  # bytes for each process: a mutant that allocates without end must not take the machine with it


@dataclass(frozen=True)
class Room:
    """The count of a room.

    Attributes
    ----------
    name : str
        Its folder.
    statements, executed : int
        How many statements it has, and how many a test executes.
    mutants, killed, timeouts, survived, equivalent : int
        How many mutants, and what became of them; ``killed`` counts the timeouts, ``survived`` not the equivalent ones.
    """

    name: str
    statements: int
    executed: int
    mutants: int
    killed: int
    timeouts: int
    survived: int
    equivalent: int

    @property
    def share(self) -> float | None:
        """Killed of those that change a result."""
        return self.killed / (self.killed + self.survived) if self.killed + self.survived else None


def reasons() -> dict[tuple[str, str, str], str]:
    """Read why mutants change no result: (file, line, changed line) -> reason; entries that fit no line are named."""
    found = {}
    for entry in tomllib.loads(EQUIVALENT.read_text(encoding="utf-8")).get("mutant", []):
        path = ROOT / entry["file"]
        lines = {line.strip() for line in path.read_text(encoding="utf-8").splitlines()} if path.is_file() else set()
        if entry["before"] not in lines:
            print(f"{EQUIVALENT.name}: no such line any more in {entry['file']}: {entry['before']}", file=sys.stderr)
        if not entry["why"].strip():
            raise SystemExit(f"{EQUIVALENT.name}: {entry['file']}: {entry['after']}: a reason is missing")
        found[entry["file"], entry["before"], entry["after"]] = entry["why"]
    return found


def count(
    executions: Executions, results: Sequence[Result], why: Mapping[tuple[str, str, str], str], only: str
) -> list[Room]:
    """Count by room, of the rooms with a text in their name; the last row is the whole."""
    tally: dict[str, Counter[str]] = defaultdict(Counter)
    for file, executed in executions.executed.items():
        missing = executions.missing[file]
        if only in room_of(file) and (executed or missing):
            for room in (room_of(file), "all"):
                tally[room].update(executed=len(executed), statements=len(executed) + len(missing))
    for result in results:
        equivalent = (result.file, result.before, result.after) in why
        kind = "killed" if result.killed else "equivalent" if equivalent else "survived"
        for room in (room_of(result.file), "all"):
            tally[room].update(["mutants", kind])
            tally[room]["timeouts"] += result.status == "timeout"
    names = ("statements", "executed", "mutants", "killed", "timeouts", "survived", "equivalent")
    return [Room(room, *(tally[room][n] for n in names)) for room in (*sorted(tally.keys() - {"all"}), "all")]


def table(rooms: Sequence[Room]) -> str:
    """Lay the rooms out as a table."""
    heads = (
        "room",
        "statements",
        "executed",
        "mutants",
        "killed",
        "of them by time",
        "survived",
        "equivalent",
        "share",
    )
    lines: list[tuple[str, ...]] = [heads]
    for r in rooms:
        executed = f"{100 * r.executed / r.statements:.1f} %"
        share = "-" if r.share is None else f"{100 * r.share:.1f} %"
        numbers = (r.mutants, r.killed, r.timeouts, r.survived, r.equivalent)
        lines.append((r.name, str(r.statements), executed, *map(str, numbers), share))
    widths = [max(len(line[i]) for line in lines) for i in range(len(heads))]
    lines.insert(1, tuple("-" * w for w in widths))
    return "\n".join(
        "  ".join(cell.rjust(w) if i else cell.ljust(w) for i, (cell, w) in enumerate(zip(line, widths)))
        for line in lines
    )


def shown(result: Result) -> str:
    """Return where a mutant is, and its change in two lines."""
    ran = f"{result.tests} tests ran, {result.of} execute the line" if result.status == "survived" else result.status
    return f"{result.file}:{result.line} ({ran})\n    - {result.before}\n    + {result.after}"


def report(executions: Executions, results: Sequence[Result], only: str, as_json: bool) -> int:
    """Print table and survivors; return the exit code."""
    why = reasons()
    rooms = count(executions, results, why, only)
    whole = rooms[-1]
    holds = whole.share is not None and whole.share >= ASKED
    alive = [r for r in results if not r.killed]
    unexplained = [r for r in alive if (r.file, r.before, r.after) not in why]
    if as_json:
        made: dict[str, Any] = {
            "rooms": [asdict(r) | {"share": r.share} for r in rooms],
            "survivors": [asdict(r) | {"why": why.get((r.file, r.before, r.after))} for r in alive],
            "asked": ASKED,
            "share": whole.share,
            "holds": holds,
        }
        print(json.dumps(made, indent=1, ensure_ascii=False))
        return 0 if holds else 1
    print(f"Mutants that the tests notice\n\n{table(rooms)}")
    if unexplained:
        print("\nSurvived:\n" + "\n".join(shown(r) for r in unexplained))
    equivalent = [r for r in alive if r not in unexplained]
    if equivalent:
        print("\nEquivalent, not counted:")
        print("\n".join(f"{shown(r)}\n    {why[r.file, r.before, r.after]}" for r in equivalent))
    never = whole.statements - whole.executed
    print(f"\n{never} of {whole.statements} statements are executed by no test; no mutant is drawn from them.")
    share = "no mutant" if whole.share is None else f"{100 * whole.share:.1f} %"
    print(f"killed {share}, asked {100 * ASKED:.0f} %: {'holds' if holds else 'MISSED'}")
    return 0 if holds else 1


def drawn(root: Path, executions: Executions, options: argparse.Namespace) -> list[Mutant]:
    """Draw the mutants of the rooms that are asked for."""
    sizes: Counter[str] = Counter()
    for file, executed in executions.executed.items():
        if options.only in room_of(file):
            sizes[room_of(file)] += len(executed) + len(executions.missing[file])
    if not sizes:
        raise SystemExit(f"no room has '{options.only}' in its name")
    return draw(root, executions.executed, quotas(sizes, options.mutants), options.seed)


def known(
    path: Path, mutants: Sequence[Mutant], tree: str, budget: float
) -> dict[tuple[str, str, str, str, int], Result]:
    """Return results of earlier runs that still stand."""
    earlier = read_results(path)
    found = {m.key: replace(earlier[m.key], line=m.line) for m in mutants if m.key in earlier}
    return {
        k: r
        for k, r in found.items()
        if r.status != "doubtful" and r.proof == proof_of(ROOT, r.file, r.by, tree) and (r.killed or r.budget >= budget)
    }


def work(
    executions: Executions, mutants: Sequence[Mutant], copies: Sequence[Scratch], options: argparse.Namespace
) -> list[Result]:
    """Run what is not known yet, and write each result as it comes."""
    done = known(options.out, mutants, executions.tree, options.budget)
    ahead = [m for m in mutants if m.key not in done]
    if done:
        print(f"{len(done)} of {len(mutants)} mutants are known from {options.out}", file=sys.stderr)
    fresh: list[Result] = []
    options.out.parent.mkdir(parents=True, exist_ok=True)
    runner = Runner(copies, executions, options.budget)
    with options.out.open("a", encoding="utf-8") as sink, contextlib.closing(runner.run(ahead)) as results:
        for result in results:
            fresh.append(result)
            sink.write(as_line(result))
            sink.flush()
            by = f" by {result.by}" if result.by else ""
            place = f"{result.file}:{result.line}"
            print(f"{len(fresh)}/{len(ahead)} {result.seconds:.0f} s  {place}  {result.status}{by}", file=sys.stderr)
        faulty = control(copies[0], fresh)
        for result in fresh:
            if result.by in faulty:
                doubt = replace(result, status="doubtful")
                sink.write(as_line(doubt))
                print(f"fails without any change: {result.by}", file=sys.stderr)
                result = doubt
            done[result.key] = result
    return [done[m.key] for m in mutants]


def main() -> int:
    """Read the options, run, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mutants", type=int, default=200, help="how many (default 200)")
    parser.add_argument("--seed", type=int, default=0, help="another seed draws others (default 0)")
    parser.add_argument("--only", metavar="ROOM", default="", help="rooms with this in their name")
    parser.add_argument(
        "--budget", type=float, default=60.0, metavar="S", help="seconds of tests a mutant (default 60)"
    )
    parser.add_argument("--workers", type=int, default=2, help="mutants at a time (default 2)")
    parser.add_argument("--out", type=Path, metavar="FILE", help="results as JSON lines (default: in the cache folder)")
    parser.add_argument("--coverage", type=Path, metavar="FILE", help="the recorded run (default: in the cache folder)")
    parser.add_argument("--list", action="store_true", help="print the mutants and run none")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    options = parser.parse_args()
    if min(options.mutants, options.workers, options.budget) <= 0:
        parser.error("--mutants, --workers and --budget have to be greater than zero")
    cache = cache_folder().resolve()
    recorded = options.coverage or cache / "mutation" / "coverage"
    options.out = options.out or cache / "mutation" / "results.jsonl"
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        if not recorded.is_file() or Executions(recorded).tree != tree_digest(ROOT):
            print("the whole suite runs once, to record which test executes which line ...", file=sys.stderr)
            measure(ROOT, recorded, cache, options.workers)
        executions = Executions(recorded)
        if options.list:
            for m in drawn(ROOT, executions, options):
                print(f"{m.file}:{m.line} {m.operator}\n    - {m.before}\n    + {m.after}")
            return 0
        with tempfile.TemporaryDirectory(prefix="shipid-mutation-") as name:
            copies = [Scratch(ROOT, Path(name) / str(k), cache) for k in range(options.workers)]
            mutants = drawn(copies[0].folder, executions, options)
            results = work(executions, mutants, copies, options)
    except sqlite3.Error as error:
        raise SystemExit(f"{recorded} is no recorded run of the tests ({error}); delete it, or name another") from None
    except KeyboardInterrupt:
        print(f"interrupted; what was done stands in {options.out}", file=sys.stderr)
        return 130
    return report(executions, results, options.only, options.json)


if __name__ == "__main__":
    sys.exit(main())
