"""Make the pictures of the README and of the documentation: each report, and the bridge, as Chromium shows them.

    python studies/pictures.py [NAME ...]

Each picture comes from a command that a reader can run: the script prints it, runs it in an empty folder and takes the page from the
top. Chromium and `pip install -e '.[test]'` are needed. The pictures go to `.docs/pictures`, each below 80 kB.
"""

from __future__ import annotations

import argparse
import contextlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
from _browser import chromium, keep
from playwright.sync_api import Browser

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / ".docs" / "pictures"
TRIALS = "container-20-20.csv", "container-10-10.csv"
#: The command of each report, in a folder that holds the two trials, also in a folder of their own, a faulty log and the plots; how high the picture is.
REPORTS = {
    "identification": (
        "identify container-20-20.csv --model de-keizer --ship soesterberg --validate container-10-10.csv --out out",
        1500,
    ),
    "trial-day": ("report container-20-20.csv container-10-10.csv --length '226 m' --out out", 1500),
    "filter": ("filter container-20-20.csv --model yaw-filter --ship soesterberg --out out", 1500),
    "tuning": ("tune de-keizer --ship soesterberg --out out", 1500),
    "prediction": (
        "predict de-keizer --ship soesterberg --from container-20-20.csv@200 --heading '60 deg' --out out",
        1500,
    ),
    "tracking": ("track plots.csv --position-std '15 m' --own container-20-20.csv --out out", 1500),
    "check": ("check faulty.csv --ship soesterberg --out out", 1100),
    "comparison": (
        "compare container-20-20.csv container-10-10.csv --models nomoto,norrbin,de-keizer --ship soesterberg --out out",
        1500,
    ),
    "plan": ("plan --model norrbin --ship zeefakkel --time 20min --out out", 1100),
    "criteria": ("criteria de-keizer --ship soesterberg --out out", 1000),
    "campaign": ("campaign trials --model de-keizer --ship soesterberg --out out", 1300),
}
BRIDGE = "bridge --scenario T3 --clock-factor 10 --port 0"


def plots() -> str:
    """Return plots of one ship that turns to starboard, seen every 3 s with an error of 15 m."""
    t = np.arange(0.0, 360.0, 3.0)
    course = np.deg2rad(20.0) + np.deg2rad(0.6) * np.clip(t - 150.0, 0.0, 150.0)
    x, y = 2500.0 + np.cumsum(21.0 * np.cos(course)), -1500.0 + np.cumsum(21.0 * np.sin(course))
    seen = np.column_stack([x, y]) + np.random.default_rng(1).normal(0.0, 15.0, (t.size, 2))
    return "\n".join(["t [s],x [m],y [m]", *(f"{a:g},{b:.1f},{c:.1f}" for a, (b, c) in zip(t, seen))]) + "\n"


def faulty() -> str:
    """Return the 20/20 zig-zag as a log with two faults: the rudder is positive to port, and the heading stands still for a while."""
    table = pd.read_csv(ROOT / "studies" / "trials" / TRIALS[0], comment="#")
    for name in ("delta [deg]", "delta_order [deg]"):
        table[name] = -table[name]
    table.loc[300:340, "psi [deg]"] = table.loc[300, "psi [deg]"]
    return table.to_csv(index=False)


def report(browser: Browser, name: str) -> None:
    """Run the command of a report and take its page."""
    command, height = REPORTS[name]
    print(f"shipid {command}")
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "trials").mkdir()
        for trial in TRIALS:
            shutil.copy(ROOT / "studies" / "trials" / trial, folder)
            shutil.copy(ROOT / "studies" / "trials" / trial, Path(folder) / "trials")
        (Path(folder) / "faulty.csv").write_text(faulty(), encoding="utf-8")
        (Path(folder) / "plots.csv").write_text(plots(), encoding="utf-8")
        program = [sys.executable, "-m", "shipid", *shlex.split(command)]
        done = subprocess.run(program, cwd=folder, capture_output=True, text=True)
        # 3 is the verdict of a check that found something serious, 5 that of a result with a serious warning.
        if done.returncode not in ((0, 3) if name == "check" else (0, 5)):
            raise SystemExit(done.stderr)
        page = browser.new_page(viewport={"width": 1000, "height": height})
        page.goto((Path(folder) / "out" / "report.html").as_uri())
        keep(page.screenshot(), KEPT / f"{name}.webp")
        page.close()


@contextlib.contextmanager
def served(command: str) -> Iterator[str]:
    """Run ``shipid bridge`` and give its address."""
    program = [sys.executable, "-m", "shipid", *shlex.split(command)]
    process = subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stderr is not None
        for line in process.stderr:
            if found := re.search(r"http://\S+", line):
                yield found[0]
                return
        raise SystemExit("the bridge did not open")
    finally:
        process.terminate()
        process.wait()


def bridge(browser: Browser) -> None:
    """Sail the tracking experiment until the ship has left some past track, try a heading, and take the page."""
    print(f"shipid {BRIDGE}")
    with served(BRIDGE) as address:
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.goto(address, wait_until="commit", timeout=120_000)
        page.wait_for_selector("body[data-connected=yes]", timeout=120_000)
        page.wait_for_timeout(20_000)
        for _ in range(30):
            page.keyboard.press("ArrowRight")
        page.wait_for_timeout(1_500)
        keep(page.screenshot(), KEPT / "bridge.webp")
        page.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(REPORTS)}, bridge; all by default")
    names = parser.parse_args().names or [*REPORTS, "bridge"]
    if unknown := set(names) - {*REPORTS, "bridge"}:
        parser.error(f"there is no picture called {', '.join(sorted(unknown))}")
    with chromium() as browser:
        for name in names:
            if name == "bridge":
                bridge(browser)
            else:
                report(browser, name)


if __name__ == "__main__":
    main()
