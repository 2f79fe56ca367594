"""Run the tests that can notice a mutant, the likeliest and cheapest first, until one fails."""

from __future__ import annotations

import json
import re
from collections.abc import Generator, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath
from queue import SimpleQueue
from time import perf_counter

from _executions import Executions
from _mutants import Mutant
from _scratch import Outcome, Scratch, digest

#: Most tests [s] of the first run, which kills most mutants; the second takes the rest of the budget.
FIRST = 4.0
#: A run may take so many times what its tests took without a change, and so long [s] besides.
PATIENCE, GRACE = 5.0, 90.0
#: Pytest's exit code where a test or a conftest file is not to be had.
NOT_FOUND = 4


@dataclass(frozen=True)
class Result:
    """What became of a mutant.

    Attributes
    ----------
    file, scope, before, after : str
        The mutant.
    nth, line : int
        Which of equal lines it is, and the line number.
    status : {"killed", "timeout", "survived", "doubtful"}
        Doubtful: the test that failed also fails without the change.
    by : str
        The test that failed, ``collection`` where a file of tests could not be imported, or the exit code of pytest.
    tests, of : int
        How many tests ran at most, and how many execute the line.
    budget : float
        Allowance [s] for the tests.
    seconds : float
        Duration of the run.
    proof : str
        Hash of the files on which the result rests.
    """

    file: str
    scope: str
    before: str
    after: str
    nth: int
    line: int
    status: str
    by: str
    tests: int
    of: int
    budget: float
    seconds: float
    proof: str

    @property
    def key(self) -> tuple[str, str, str, str, int]:
        """What identifies the mutant."""
        return self.file, self.scope, self.before, self.after, self.nth

    @property
    def killed(self) -> bool:
        """Whether the tests noticed."""
        return self.status in ("killed", "timeout")


def choose(executions: Executions, mutant: Mutant, budget: float) -> tuple[list[str], int]:
    """Return the tests to run for a mutant in their order, and how many execute its line.

    Those that execute the line come first, then those that execute its file, then those of its room: what one test builds and keeps,
    another uses without executing it again. In each group the room's own tests come first, and cheaper ones before dearer.

    Parameters
    ----------
    executions : Executions
        Which test executes which line.
    mutant : Mutant
        The mutant.
    budget : float
        Allowance [s]; one test is chosen in any case.
    """
    seconds = executions.seconds
    home = mirror(mutant.room, seconds)
    own = {t for t in seconds if t.startswith(home)}
    line = executions.tests_of(mutant.file, {mutant.line, mutant.statement})
    file = executions.tests_of(mutant.file)
    ranks = ((line & own, 0), (line, 1), (file & own, 2), (file, 3), (own, 4))
    rank: dict[str, int] = {}
    for group, place in ranks:
        for test in group:
            rank.setdefault(test, place)
    chosen: list[str] = []
    spent = 0.0
    for test in sorted(rank, key=lambda t: (rank[t], seconds[t], t)):
        if chosen and spent + seconds[test] > budget:
            break
        chosen.append(test)
        spent += seconds[test]
    return chosen, len(line)


def mirror(room: str, tests: Iterable[str]) -> str:
    """Return the folder of tests that mirrors a room, or the nearest one above it that has tests.

    Parameters
    ----------
    room : str
        Folder of sources, relative to the root.
    tests : iterable of str
        Names of tests.
    """
    top, *rest = PurePosixPath(room).parts
    folder = PurePosixPath("tests", *([] if top == "shipid" else [top]), *rest)
    folders = {PurePosixPath(t.partition("::")[0]).parent for t in tests}
    held = {above for f in folders for above in (f, *f.parents)}
    while folder not in held and folder.parent != folder:
        folder = folder.parent
    return f"{folder}/"


class Runner:
    """Runs mutants in scratch copies, as many at a time as there are copies.

    Parameters
    ----------
    copies : sequence of Scratch
        The copies.
    executions : Executions
        Which test executes which line.
    budget : float
        Allowance [s] for the tests of a mutant.
    """

    def __init__(self, copies: Sequence[Scratch], executions: Executions, budget: float) -> None:
        self.copies, self.executions, self.budget = copies, executions, budget
        self._free: SimpleQueue[Scratch] = SimpleQueue()
        for copy in copies:
            self._free.put(copy)

    def run(self, mutants: Iterable[Mutant]) -> Generator[Result, None, None]:
        """Yield results as they come.

        Parameters
        ----------
        mutants : iterable of Mutant
            The mutants.
        """
        pool = ThreadPoolExecutor(len(self.copies))
        try:
            for done in as_completed([pool.submit(self._one, mutant) for mutant in mutants]):
                yield done.result()
        except BaseException:  # an interruption, too, ends what runs
            for copy in self.copies:
                copy.stop()
            raise
        finally:
            pool.shutdown(cancel_futures=True)

    def _one(self, mutant: Mutant) -> Result:
        begin = perf_counter()
        tests, of = choose(self.executions, mutant, self.budget)
        copy = self._free.get()
        place = copy.folder / mutant.file
        original = place.read_text(encoding="utf-8")
        try:
            place.write_text(mutant.code, encoding="utf-8")
            status, by = self._notice(copy, tests)
        finally:
            place.write_text(original, encoding="utf-8")
            proof = proof_of(copy.folder, mutant.file, by, self.executions.tree)
            self._free.put(copy)
        what = {k: getattr(mutant, k) for k in ("file", "scope", "before", "after", "nth", "line")}
        spent = round(perf_counter() - begin, 1)
        return Result(
            **what, status=status, by=by, tests=len(tests), of=of, budget=self.budget, seconds=spent, proof=proof
        )

    def _notice(self, copy: Scratch, tests: list[str]) -> tuple[str, str]:
        """Run the tests until one fails: what became of the mutant, and which test failed."""
        spent, first = 0.0, 0
        while first < len(tests) and (first == 0 or spent + self.executions.seconds[tests[first]] <= FIRST):
            spent += self.executions.seconds[tests[first]]
            first += 1
        for part in filter(None, (tests[:first], tests[first:])):
            done = self._pytest(copy, part)
            if done.code == NOT_FOUND:  # a test whose parameters the change takes away is not there to fail
                gone = set(re.findall(r"not found: \S*?(tests/[^\n]+)", done.output))
                part = [t for t in part if t not in gone]
                done = self._pytest(copy, part) if part else Outcome({}, [], 0, "")
            elif done.code and not done.failed:  # a crash, unless it was stopped from outside: seen twice, it counts
                done = self._pytest(copy, part)
            if done.code is None:
                return "timeout", ""
            if done.code != 0:
                return "killed", done.failed[0] if done.failed else f"exit code {done.code}"
        return "survived", ""

    def _pytest(self, copy: Scratch, tests: list[str]) -> Outcome:
        allowed = GRACE + PATIENCE * sum(self.executions.seconds[t] for t in tests)
        return copy.pytest(["-n", "0", "-x", *tests], allowed)


def proof_of(root: Path, file: str, by: str, tree: str) -> str:
    """Return a hash of what a result rests on: the source file and the test that killed, or the whole tree.

    Parameters
    ----------
    root : Path
        Root of the tree.
    file : str
        The source file.
    by : str
        What killed: a test, or something else.
    tree : str
        Hash of the whole tree.
    """
    return digest(root, [file, by.partition("::")[0]]) if "::" in by else tree


def control(copy: Scratch, results: Iterable[Result]) -> set[str]:
    """Return the tests that killed mutants and fail without a change as well.

    Parameters
    ----------
    copy : Scratch
        A copy without a change.
    results : iterable of Result
        The results.
    """
    killers = sorted({r.by for r in results if "::" in r.by})
    return set(copy.pytest(["-n", "0", *killers]).failed) if killers else set()


def read_results(path: Path) -> dict[tuple[str, str, str, str, int], Result]:
    """Read what an earlier run wrote; of several results of a mutant the last counts.

    Parameters
    ----------
    path : Path
        A file of JSON lines. A last line that was cut off by an interruption is left out.
    """
    found = {}
    for line in path.read_text(encoding="utf-8").splitlines() if path.is_file() else []:
        try:
            result = Result(**json.loads(line))
        except (ValueError, TypeError):
            continue
        found[result.key] = result
    return found


def as_line(result: Result) -> str:
    """Return a result as a line of JSON.

    Parameters
    ----------
    result : Result
        The result.
    """
    return json.dumps(asdict(result), ensure_ascii=False) + "\n"
