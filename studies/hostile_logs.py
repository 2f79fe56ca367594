"""Hostile logs: what the plain `measure` makes of logs whose truth is known, spoiled as real logs are.

Zig-zags and turns of three ships are simulated and written to files with the columns, clocks and noise of loggers: sound ones, and
ones with a fault. Each file is read and measured as ``shipid measure FILE`` does, and compared with the run it was made of. A number
is right within 0.5 deg, 2 % of the largest distance, or the uncertainty stated with it; it is told where it is not known, where a
warning stands beside it, or a note that the sound log does not have; else it is bare.

What no column contradicts is not among them: positions that are late, where no sway is logged to tell the delay from the drift angle;
an aerial ahead of midships; feet called metres, where no speed is logged.

Asked: no bare wrong number, and on sound logs at most 2 % of warnings and refusals.

    python studies/hostile_logs.py [--runs N] [--kind KIND]... [--list] [--json]

``--runs`` is how often each kind is tried, with another ship, manoeuvre, logger and noise each time. ``--list`` prints each run that is
not right or told.
"""

from __future__ import annotations

import argparse
import re
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
from _loggers import INTERVALS, LAYOUTS, SHIPS, Log, sailed, truth
from _spoiled import KINDS, Kind
from _table import Row, show

import shipid
from shipid.foundation.errors import ShipidError
from shipid.foundation.notices import notice_of
from shipid.trials.measuring.measure import measure
from shipid.trials.measuring.results.measures import Measures

ANGLES = {"zigzag": ((20, 20), (10, 10), (-20, 20)), "turn": ((35, 540), (-35, 540), (25, 400))}
DISTANCES = ("advance", "transfer", "tactical_diameter")
_DEGREES, _SHARE = 0.5, 0.02
Verdict = tuple[str, str]


def number(found: Measures, name: str) -> tuple[float | None, float]:
    """A measured number in deg, m or s, and the uncertainty stated with it."""
    base, _, place = name.partition("[")
    value, stated = getattr(found, base, None), 0.0
    if place:
        k = int(place[:-1]) - 1
        value = value[k] if value is not None and k < len(value) else None
        if base == "overshoots":
            stated = np.degrees(((found.overshoot_uncertainties or ())[k : k + 1] or (0.0,))[0] or 0.0)
            value = None if value is None else float(np.degrees(value))
    return value, float(stated)


def words(found: Measures, serious: bool) -> set[str]:
    """What is said beside the numbers, without its numbers."""
    notes = [notice_of(note) for note in found.notes]
    return {re.sub(r"-?\d[\d.]*", "#", str(note)) for note in notes if note.serious or not serious}


def wrong_numbers(found: Measures, true: dict[str, float]) -> list[str]:
    """The numbers that are not right, in words."""
    largest = max((v for n, v in true.items() if n.startswith(DISTANCES)), default=0.0)
    said = []
    for name, value in true.items():
        measured, stated = number(found, name)
        if measured is None:
            continue
        if "time" in name:
            # From one execute to another.
            within = max(_SHARE * value, 1.0, 2 * (found.execute_within or 0.0))
        else:
            within = max(_DEGREES, stated) if name.startswith("overshoots") else _SHARE * largest
        if abs(measured - value) > within:
            said.append(f"{name} {measured:.4g} (true {value:.4g})")
    return said


def judged(
    text: str, true: dict[str, float], still: dict[str, float] | None, sound: set[str], scratch: Path
) -> Verdict:
    """The verdict on a log: right, told, bare or alarm, and what was seen."""
    path = scratch / "log.csv"
    path.write_text(text, encoding="utf-8")
    try:
        found = measure(shipid.read_trial(path))
    except ShipidError as error:
        return "refused", str(error)[:300]
    warned = "; ".join(sorted(words(found, serious=True)))
    if ({"advance"} & set(true) and found.kind != "turning circle") or (
        "advance" not in true and found.kind != "zig-zag"
    ):
        return "told" if warned else "bare", f"measured as a {found.kind}; {warned}"
    wrong = wrong_numbers(found, true)
    if still is not None:
        # In a current the numbers in still water are asked for, or a word.
        drifting = {f"{n}_still_water": v for n, v in still.items() if n in DISTANCES}
        wrong += wrong_numbers(found, drifting)
        if found.advance_still_water is None and "advance_still_water" not in found.reasons:  # type: ignore[attr-defined]
            wrong.append("no word on still water")
    if wrong:
        more = words(found, serious=False) - sound
        return "told" if warned or more else "bare", f"{', '.join(wrong)}; {warned or '; '.join(sorted(more))}"
    return ("warned" if warned else "right"), warned


def runs_of(name: str, kind: Kind, runs: int, scratch: Path) -> list[tuple[str, str, str]]:
    """The verdicts of a kind: verdict, log and what was seen."""
    result = []
    for k in range(runs):
        rng = np.random.default_rng([sum(map(ord, name)), k])
        what = kind.only or ("zigzag", "turn")[k % 2]
        model, ship = next((pair for pair in SHIPS if pair[1] == kind.ship), SHIPS[(k // 2 + len(name)) % len(SHIPS)])
        angles = kind.angles or ANGLES[what][int(rng.integers(3))]
        run = sailed(model, ship, what, angles, **kind.met)
        true = truth(run)
        still = truth(sailed(model, ship, what, angles)) if "current" in kind.met else None
        layout = kind.layout or LAYOUTS[int(rng.integers(len(LAYOUTS)))]
        interval = float(rng.choice(INTERVALS[ship]))
        log = Log(run, interval, layout, rng)
        kind.change(log)
        said = words_of_sound(model, ship, what, angles, layout, interval, scratch)
        where = (
            f"{ship} {what} {'/'.join(f'{a:g}' for a in angles)}, every {interval:g} s, {' '.join(layout)} (run {k})"
        )
        result.append((*judged(log.text(), true, still, said, scratch), where))
    return [(verdict, where, seen) for verdict, seen, where in result]


_SOUND: dict[tuple[object, ...], set[str]] = {}


def words_of_sound(
    model: str, ship: str, what: str, angles: tuple[float, ...], layout: tuple[str, ...], interval: float, scratch: Path
) -> set[str]:
    """What is said beside the numbers of the sound log of the same logger."""
    key = (model, ship, what, angles, layout, interval)
    if key not in _SOUND:
        path = scratch / "sound.csv"
        path.write_text(
            Log(sailed(model, ship, what, angles), interval, layout, np.random.default_rng(0)).text(), encoding="utf-8"
        )
        _SOUND[key] = words(measure(shipid.read_trial(path)), serious=False)
    return _SOUND[key]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=6, help="runs of each kind")
    parser.add_argument(
        "--kind", action="append", default=[], choices=list(KINDS), metavar="KIND", help="only this kind"
    )
    parser.add_argument("--list", action="store_true", help="print each run that is neither right nor told")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    rows, total, alarms = [], Counter(), Counter()
    with tempfile.TemporaryDirectory() as folder:
        for name, kind in KINDS.items():
            if options.kind and name not in options.kind:
                continue
            found = runs_of(name, kind, options.runs, Path(folder))
            count = Counter(verdict for verdict, _, _ in found)
            total += count
            bad = {"bare", "warned", "refused"} if kind.sound else {"bare"}
            if kind.sound:
                alarms += Counter({"sound": len(found), "alarms": count["warned"] + count["refused"] + count["told"]})
            if options.list:
                for verdict, where, seen in found:
                    if verdict in bad or (options.kind and verdict != "right"):
                        print(f"{name}: {verdict}: {where}: {seen}", flush=True)
            asked = "right" if kind.sound else "right or told"
            measured = ", ".join(f"{n} {verdict}" for verdict, n in sorted(count.items()))
            rows.append(Row(name, asked, measured, not any(count[b] for b in bad)))
    share = alarms["alarms"] / max(alarms["sound"], 1)
    rows.append(Row("bare wrong, all kinds", "0", str(total["bare"]), not total["bare"]))
    rows.append(
        Row(
            "alarms on sound logs",
            "at most 2 %",
            f"{alarms['alarms']} of {alarms['sound']} ({share:.1%})",
            share <= 0.02,
        )
    )
    show("Logs spoiled as real ones are, measured by default", rows, as_json=options.json)


if __name__ == "__main__":
    main()
