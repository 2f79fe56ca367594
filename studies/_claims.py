"""Claims of a paper beside what this project finds: printed as a table, or with ``--json`` as rows."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, dataclass

HOLDS, UNDER, NOT = "holds", "holds under a reading", "does not hold"


@dataclass(frozen=True)
class Claim:
    """One row.

    Attributes
    ----------
    claim : str
        Its id, with what is looked at.
    published : str
        What is printed, or asked for where nothing is.
    ours : str
        What is found.
    spread : str
        Over seeds or cases.
    verdict : str
        "holds", "holds under a reading" or "does not hold".
    reading : str
        What was taken where the print is silent.
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


def options(title: str, **numbers: int) -> argparse.Namespace:
    """Read the command line: ``--json``, and whole numbers with their defaults."""
    parser = argparse.ArgumentParser(description=title)
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    for name, value in numbers.items():
        parser.add_argument(f"--{name}", type=int, default=value)
    return parser.parse_args()


def show(title: str, claims: list[Claim], as_json: bool, notes: str = "") -> None:
    """Print the claims and exit: 0 when every promised one holds, 1 otherwise."""
    if as_json:
        rows = [{k: v for k, v in asdict(c).items() if k != "promised"} for c in claims]
        print(json.dumps(rows, indent=1, ensure_ascii=False))
    else:
        heads = ("claim", "published or asked", "ours", "spread", "verdict")
        lines = [heads, *((c.claim, c.published, c.ours, c.spread, c.verdict) for c in claims)]
        widths = [max(len(line[i]) for line in lines) for i in range(5)]
        print(title + "\n")
        for k, line in enumerate(lines):
            print("  ".join(cell.ljust(w) for cell, w in zip(line, widths)).rstrip())
            if k == 0:
                print("  ".join("-" * w for w in widths))
        for reading in dict.fromkeys(c.reading for c in claims if c.reading):
            print(f"\n{reading}")
        print(f"\n{notes}" if notes else "")
    sys.exit(0 if all(c.verdict != NOT for c in claims if c.promised) else 1)
