"""A campaign of many runs: does its memory grow with their number, and is it the same after it was killed and gone on with?

Each run is 400 scans of a target that turns, filtered by the three-mode tracker of the speed benchmark, and measured scan by scan
(the error of its position and its normalised square). Campaigns of different sizes are run by processes of their own, which tell
the most memory that they took; then a large one is killed (SIGKILL) several times on its way, gone on with by ``--resume``, and
compared file by file with one that nobody touched.

Asked: the largest campaign takes at most 20 % more memory than one of a hundredth of its runs; runs and statistics are
identical, bit by bit, and no run that was finished is made again.

    python studies/campaign_endurance.py [--runs 10000] [--kills 3] [--json]
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from _other_ships import nees
from _table import Row, show
from bench_tracking import tracker
from semerdjiev_2000_ct import ORDER, SIGMA, flown

from shipid import Campaign, Measure
from shipid.estimation.multiple.first_state import FirstState

BATCH = 100
#: The largest campaign takes at most this much of the memory of the smallest.
GROWTH = 1.2


def _batch(rngs: Sequence[np.random.Generator]) -> dict[str, np.ndarray]:
    """Sail and track a batch of runs: the first two plots start the filter, the others are tracked."""
    _, truth = flown()
    where = truth[1:, [0, 2]]
    z = truth[:, [0, 2]] + SIGMA * np.stack([r.standard_normal((len(truth), 2)) for r in rngs])
    mean = np.zeros((len(rngs), 4))
    mean[:, [0, 2]], mean[:, [1, 3]] = z[:, 1], z[:, 1] - z[:, 0]
    start = FirstState(ORDER, mean, SIGMA**2 * np.kron(np.eye(2), [[1.0, 1.0], [1.0, 2.0]]))
    record = {"t": np.arange(1.0, len(truth)), "x": z[:, 1:, 0], "y": z[:, 1:, 1]}
    runs = tracker().filter_runs(record, first=start)
    columns = [runs.states.index(n) for n in ("x", "y")]
    apart = runs.x[..., columns] - where
    spread = runs.covariance[..., columns, :][..., columns]
    return {"position": np.hypot(apart[..., 0], apart[..., 1]), "nees": nees(apart, spread)}


turning = Campaign(
    "turning target",
    None,
    {
        "position": Measure("error", "m", "distance of the estimate from the truth"),
        "nees": Measure("nees", "1", degrees=2),
    },
    runs=_batch,
    batch=BATCH,
)


def command(runs: int, out: Path, *more: str) -> list[str]:
    """Return the command that runs the campaign."""
    study = f"{Path(__file__).resolve()}:turning"
    return [sys.executable, "-m", "shipid", "campaign", study, "--runs", str(runs), "--out", str(out), *more]


def memory(runs: int, out: Path) -> float:
    """Run a campaign and return the most memory that its process took, in MB."""
    with subprocess.Popen(command(runs, out), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as child:
        errors = child.stderr.read() if child.stderr else ""
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise SystemExit(f"a campaign of {runs} runs ended with exit code {child.returncode}:\n{errors}")
    return usage.ru_maxrss / 1024


def finished(out: Path) -> dict[str, float]:
    """Return when each kept batch was written."""
    return {p.name: p.stat().st_mtime for p in sorted(out.rglob("*")) if p.suffix in {".npz", ".parquet"}}


def killed(runs: int, out: Path, kills: int) -> tuple[int, int]:
    """Kill a campaign on its way, go on with it; return how often it was killed and how many finished batches were made again."""
    done, again = 0, 0
    before: dict[str, float] = {}
    for k in range(kills + 1):
        more = ["--resume"] if before else ["--overwrite"]
        share = (k + 1) / (kills + 1) * runs / BATCH
        with subprocess.Popen(command(runs, out, *more), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as child:
            while k < kills and child.poll() is None:
                if len(finished(out)) >= share:
                    child.send_signal(signal.SIGKILL)
                    done += 1
                    break
                time.sleep(0.02)
            child.wait()
        now = finished(out)
        again += sum(now.get(n) != at for n, at in before.items())
        before = now
    return done, again


def contents(out: Path) -> dict[str, str]:
    """Return a hash of every kept batch, and of the statistics."""
    found = {n: hashlib.sha256(next(out.rglob(n)).read_bytes()).hexdigest() for n in finished(out)}
    result = json.loads((out / "result.json").read_text())
    found["statistics"] = json.dumps(result["campaign"], sort_keys=True)
    return found


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--kills", type=int, default=3)
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    sizes = sorted({max(1, given.runs // 100), max(1, given.runs // 10), given.runs})
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        memory(sizes[0], folder / "first")  # compiles the filters, which the others find in the cache
        took = {n: memory(n, folder / str(n)) for n in sizes}
        done, again = killed(given.runs, folder / "killed", given.kills)
        whole, resumed = contents(folder / str(given.runs)), contents(folder / "killed")
    most = took[sizes[-1]] / took[sizes[0]]
    wrong = sorted(n for n in whole.keys() | resumed.keys() if whole.get(n) != resumed.get(n))
    show(
        f"A campaign of {given.runs} runs of 400 scans",
        [
            Row(
                "memory of " + ", ".join(f"{n}" for n in sizes) + " runs",
                f"the last at most {GROWTH:g} times the first",
                ", ".join(f"{m:.0f}" for m in took.values()) + f" MB: {most:.2f} times",
                most <= GROWTH,
            ),
            Row("killed on its way", f"{given.kills} times", f"{done} times", done == given.kills),
            Row("finished batches that were made again", "0", f"{again}", again == 0),
            Row(
                f"{len(whole) - 1} batches and the statistics, beside those of a campaign that nobody touched",
                "identical",
                "identical" if not wrong else f"differ: {', '.join(wrong[:5])}",
                not wrong and len(whole) > 1,
            ),
        ],
        as_json=given.json,
    )


if __name__ == "__main__":
    main()
