"""Memory: a 10 Hz log of 24 hours (864,000 rows) is read, windowed and measured within 1.5 GB.

The log is simulated (a zig-zag of a 45 m ship, over and over) and written to a temporary folder.

    python studies/memory.py [--hours 24] [--json]
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas as pd

import shipid


def write_log(path: Path, hours: float) -> int:
    """Write the log: whole periods of one simulated zig-zag, with noise that does not repeat."""
    cycle = shipid.simulate(
        shipid.find_model("norrbin"), "zeefakkel", "zigzag:20/20", speed="5 m/s", sampling="0.1 s", duration="400 s"
    )
    marks = shipid.measure(cycle)
    executes = [e for e in marks.executes if e is not None]
    period = cycle.window(executes[0], executes[2]).table
    rows = round(hours * 36000)
    index = np.arange(rows) % (len(period) - 1)
    rng = np.random.default_rng(0)
    columns = {"t [s]": np.arange(rows) / 10}
    for name, unit, scale, noise in (
        ("psi", "deg", 180 / np.pi, 0.05),
        ("r", "deg/s", 180 / np.pi, 0.01),
        ("u", "m/s", 1.0, 0.02),
        ("delta", "deg", 180 / np.pi, 0.0),
    ):
        columns[f"{name} [{unit}]"] = np.round(
            period[name].to_numpy()[index] * scale + noise * rng.standard_normal(rows), 4
        )
    pd.DataFrame(columns).to_csv(path, index=False)
    return rows


def work(path: str) -> None:
    """What the child process does: read, window, measure; prints its own peak."""
    begin = time.perf_counter()
    trial = shipid.read_trial(path)
    read = time.perf_counter()
    part = trial.window(3600.0, 3900.0)
    cut = time.perf_counter()
    whole = shipid.measure(trial)
    done = time.perf_counter()
    print(
        json.dumps(
            {
                "rows": len(trial),
                "window_rows": len(part),
                "executes": len(whole.executes),
                "read_s": read - begin,
                "window_s": cut - read,
                "measure_s": done - cut,
                "peak_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
            }
        )
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hours", type=float, default=24.0)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--work", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.work:
        work(options.work)
        return 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.csv"
        write_log(path, options.hours)
        command = [sys.executable, __file__, "--work", str(path)]
        result = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    good = result["peak_gb"] <= 1.5
    if options.json:
        print(json.dumps(result, indent=1, allow_nan=False))
    else:
        print(
            f"{result['rows']} rows: read {result['read_s']:.1f} s, windowed {result['window_s']:.2f} s, measured "
            f"{result['measure_s']:.1f} s ({result['executes']} executes)"
        )
        print(f"peak {result['peak_gb']:.2f} GB, asked 1.5 GB: {'holds' if good else 'MISSED'}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
