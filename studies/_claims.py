"""Print what a study makes of the claims of a paper: as a table, as JSON, and as a figure in SVG."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

HOLDS, UNDER_A_READING, FAILS = "holds", "holds under a reading", "does not hold"


@dataclass(frozen=True)
class Claim:
    """One row.

    Attributes
    ----------
    claim : str
        Which claim, and what of it.
    published : str
        What the paper prints, or what is asked here where it prints no number.
    ours : str
        What was measured.
    spread : str
        How far the runs scatter.
    verdict : {"holds", "holds under a reading", "does not hold"}
    reading : str
        What was assumed where the paper is silent.
    promised : bool
        Whether the study fails when it does not hold.
    """

    claim: str
    published: str
    ours: str
    spread: str
    verdict: str
    reading: str = ""
    promised: bool = True


def claim(what: str, published: str, ours: str, holds: bool, spread: str = "", reading: str = "") -> Claim:
    """Return a row; one that holds and has a reading holds under that reading."""
    verdict = FAILS if not holds else UNDER_A_READING if reading else HOLDS
    return Claim(what, published, ours, spread, verdict, reading)


def options(doc: str, runs: int | None = None, **numbers: int) -> argparse.Namespace:
    """Read the options every study of a paper has.

    Parameters
    ----------
    doc : str
        The docstring of the study.
    runs : int, optional
        How many noise runs it makes unless told otherwise.
    **numbers : int
        Further whole numbers with their defaults.
    """
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    if runs is not None:
        parser.add_argument("--runs", type=int, default=runs, help=f"noise runs (default {runs})")
    for name, value in numbers.items():
        parser.add_argument(f"--{name}", type=int, default=value)
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    parser.add_argument("--figure", type=Path, metavar="FILE", help="write the figure to this file, as SVG")
    return parser.parse_args()


def show(title: str, rows: Sequence[Claim], as_json: bool, notes: str = "") -> None:
    """Print the rows and exit: 0 when every claim holds, 1 otherwise.

    Parameters
    ----------
    title : str
        Heading of the table.
    rows : sequence of Claim
        The rows.
    as_json : bool
        Whether to print them as JSON.
    notes : str
        Printed below the table.
    """
    if as_json:
        plain = [{k: v for k, v in asdict(r).items() if k != "promised"} for r in rows]
        print(json.dumps(plain, indent=1, ensure_ascii=False))
    else:
        heads = ("claim", "published or asked", "ours", "spread", "verdict")
        lines = [heads, *((r.claim, r.published, r.ours, r.spread, r.verdict) for r in rows)]
        widths = [max(len(line[i]) for line in lines) for i in range(len(heads))]
        print(title + "\n")
        for k, line in enumerate(lines):
            print("  ".join(cell.ljust(w) for cell, w in zip(line, widths)).rstrip())
            if k == 0:
                print("  ".join("-" * w for w in widths))
        readings = list(dict.fromkeys(r.reading for r in rows if r.reading))
        if readings:
            print("\nReadings:\n" + "\n".join(f"- {r}" for r in readings))
        missed = sum(r.verdict == FAILS for r in rows)
        print(f"\n{len(rows) - missed} of {len(rows)} rows hold." + (f"\n\n{notes}" if notes else ""))
    sys.exit(0 if all(r.verdict != FAILS for r in rows if r.promised) else 1)


def figure(path: Path | None, panels: int, draw: Callable[[Any], None]) -> None:
    """Write a figure of panels above each other, if a file is asked for.

    Parameters
    ----------
    path : Path or None
        The SVG file.
    panels : int
        How many.
    draw : callable
        Takes the axes, an array, and draws into them.
    """
    if path is None:
        return
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "shipid", "svg.fonttype": "none", "font.size": 8.0})
    import matplotlib.pyplot as plt

    made, axes = plt.subplots(panels, 1, figsize=(6.5, 1.6 * panels + 0.4), squeeze=False)
    for axis in axes[:, 0]:
        axis.grid(alpha=0.3, linewidth=0.5)
    draw(axes[:, 0])
    made.tight_layout()
    made.savefig(path, format="svg", metadata={"Date": None})
    plt.close(made)
