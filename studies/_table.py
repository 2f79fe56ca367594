"""Print a study's rows beside what was asked, as a table or as JSON, and exit non-zero on a miss."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class Row:
    """One row of a study.

    Attributes
    ----------
    what : str
        What is looked at.
    asked : str
        What it should be, with the tolerance.
    measured : str
        What it is.
    holds : bool
        Whether it does.
    """

    what: str
    asked: str
    measured: str
    holds: bool

    @property
    def verdict(self) -> str:
        """In a word or three."""
        return "holds" if self.holds else "does not hold"


def close(what: str, asked: float, measured: float, within: float, unit: str = "", digits: int = 5) -> Row:
    """Return a row that compares a number with the one asked for, within a tolerance in the same unit."""
    tail = f" {unit}" if unit else ""
    return Row(
        what,
        f"{asked:.{digits}g} ± {within:.1g}{tail}",
        f"{measured:.{digits + 1}g}{tail}",
        abs(measured - asked) <= within,
    )


def below(what: str, limit: float, measured: float, unit: str = "") -> Row:
    """Return a row that asks for a number below a limit."""
    tail = f" {unit}" if unit else ""
    return Row(what, f"below {limit:.1g}{tail}", f"{measured:.1e}{tail}", measured < limit)


def show(title: str, rows: list[Row], notes: str = "", as_json: bool | None = None) -> None:
    """Print the rows and exit: 0 when every row holds, 1 otherwise. With ``--json`` they come as JSON.

    Parameters
    ----------
    title : str
        Heading of the table.
    rows : list of Row
        The rows.
    notes : str
        Printed below the table.
    as_json : bool, optional
        Whether they come as JSON, for a study that has parsed its options.
    """
    if as_json is None:
        parser = argparse.ArgumentParser(description=title)
        parser.add_argument("--json", action="store_true", help="print the rows as JSON")
        as_json = parser.parse_args().json
    if as_json:
        print(
            json.dumps(
                [asdict(r) | {"holds": bool(r.holds), "verdict": r.verdict} for r in rows], indent=1, ensure_ascii=False
            )
        )
    else:
        heads = ("", "asked", "measured", "verdict")
        lines = [heads, *((r.what, r.asked, r.measured, r.verdict) for r in rows)]
        widths = [max(len(line[i]) for line in lines) for i in range(4)]
        print(title + "\n")
        for k, line in enumerate(lines):
            print("  ".join(cell.ljust(w) for cell, w in zip(line, widths)).rstrip())
            if k == 0:
                print("  ".join("-" * w for w in widths))
        missed = sum(not r.holds for r in rows)
        print(f"\n{len(rows) - missed} of {len(rows)} rows hold." + (f"\n\n{notes}" if notes else ""))
    sys.exit(0 if all(r.holds for r in rows) else 1)
