"""Sound records as people bring them, of many ships, through the plain `shipid identify`: do the 95 % intervals hold the truth?

Ships of every family sail zig-zags in small steps, with a rudder that moves at the rate of its machine, and the records are thinned
out: what the rudder does between two samples is not in them. A record is a 20/20 zig-zag, or that and a 10/10; it begins on an
offset course and with a rate of turn of its own, its rudder indicator is off by half a degree, and its log shows a noisy speed, of
which a model that takes the speed as given sees no more. Noise of the sensors:

- fine: 0.1 deg, 0.01 deg/s, log 0.05 m/s, positions 2 m;
- coarse: 0.5 deg, 0.05 deg/s, log 0.15 m/s, positions 5 m;
- waves: a ship's yaw in waves on heading and rate, as in `coverage.py`, and the log of the fine ones.

Everything is left to the defaults. A coefficient that is called not determined, or a fit with a serious notice, does not count; both are
counted beside it, and so are sound records of which a missing effect is told.

Asked: 93 to 97 % of the truths of determined coefficients, together and for each noise, sampling and model, the band widened by two
binomial errors of so many fits (coefficients of one fit are correlated).

    python studies/sound_records.py [--runs 4] [--only WORD] [--noise fine,coarse,waves] [--sampling 0.1,1,2,4] [--short] [--json]
"""

from __future__ import annotations

import argparse
import functools
import json
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import pandas as pd
from coverage import noise_on
from threadpoolctl import threadpool_limits

import shipid
from shipid.declaration.vocabulary import FIELDS
from shipid.generation.record import make_record
from shipid.identification.evidence.missing_effect import EFFECT_MISSING

#: Standard deviations of the sensors, SI.
SENSORS = {
    "fine": {"psi": np.deg2rad(0.1), "r": np.deg2rad(0.01), "u": 0.05, "v": 0.05, "x": 2.0, "y": 2.0},
    "coarse": {"psi": np.deg2rad(0.5), "r": np.deg2rad(0.05), "u": 0.15, "v": 0.15, "x": 5.0, "y": 5.0},
}
SENSORS["waves"] = SENSORS["fine"]
SAMPLINGS = (0.1, 1.0, 2.0, 4.0)
#: Steps in which a ship sails, s; the slowest sampling is so large a share of L/U.
FINE, SLOWEST = 0.05, 0.25
#: Sailed to the full; a record holds the first of them, or both.
MANOEUVRES = ("zigzag:20/20", "zigzag:10/10")
#: How much less the rudder indicator shows, rad; share of the largest rate of turn with which a record may begin.
OFFSET, BEGINS = np.deg2rad(0.5), 0.05
LOW, HIGH = 0.93, 0.97


@dataclass(frozen=True)
class Ship:
    """A ship whose truth is known.

    Attributes
    ----------
    model, ship : str
        Their names.
    across : bool
        Whether her log shows the speed to the side as well.
    length : float
        Factor on the noise of speed and position: of a model ship both are measured more exactly.
    """

    model: str
    ship: str
    across: bool = False
    length: float = 1.0


SHIPS = (
    Ship("nomoto", "mariner"),
    Ship("nomoto", "gunnerus"),
    Ship("nomoto-second-order", "mariner"),
    Ship("norrbin", "zeefakkel"),
    Ship("bech", "kvlcc2-7m", length=0.1),
    Ship("cubic", "kvlcc2"),
    Ship("cubic", "gunnerus"),
    Ship("de-keizer", "soesterberg"),
    Ship("de-keizer", "zeefakkel"),
    Ship("pershitz", "semerdjiev"),
    Ship("davidson-schiff", "mariner", across=True),
    Ship("cross-flow", "kvlcc2", across=True),
    Ship("mmg", "kvlcc2-7m", across=True, length=0.1),
)


@dataclass(frozen=True)
class Counted:
    """One coefficient of one fit.

    Attributes
    ----------
    model, ship, noise : str
        What was sailed.
    sampling : float
        In s.
    trials : int
        Records that were fitted together.
    fit : int
        Number of the fit.
    name : str
        The coefficient.
    truth, value : float
        SI.
    std : float
        Standard deviation that is printed; NaN without one.
    inside : bool
        Whether the interval holds the truth.
    said : {"determined", "not determined", "told"}
        What the fit says of it.
    effect : bool
        Whether the fit tells of a missing effect.
    """

    model: str
    ship: str
    noise: str
    sampling: float
    trials: int
    fit: int
    name: str
    truth: float
    value: float
    std: float
    inside: bool
    said: str
    effect: bool


@dataclass(frozen=True, eq=False)
class Sailed:
    """A manoeuvre in small steps, and what sails it again from another start.

    Attributes
    ----------
    rudder : ndarray, shape (N,)
        Rudder angles, rad.
    run : callable
        From course (rad) and rate of turn (rad/s) at the start to columns.
    largest : float
        Rate of turn, rad/s.
    """

    rudder: np.ndarray
    run: Callable[[float, float], dict[str, np.ndarray]]
    largest: float


@functools.cache
def sailed(ship: Ship, manoeuvre: str) -> Sailed:
    """Sail a manoeuvre with the ship's steering machine."""
    model, own = shipid.find_model(ship.model), shipid.find_ship(ship.ship)
    speed = own.particular("speed", "m/s")
    first = shipid.simulate(model, own, manoeuvre, sampling=FINE)
    t, count = first["t"], len(first)
    held = {"u": speed, "cruise": speed}
    inputs = np.array([first["delta"] if n == "delta" else np.full(count, held.get(n, 0.0)) for n in model.inputs])
    shown = tuple(n for n in ("psi", "r", "u", "v", "x", "y") if n in model and n not in model.inputs)
    record = make_record(model, shown)
    p = record.system.vector(record.system.coefficients, own.values(model, speed=speed))

    def run(course: float, rate: float) -> dict[str, np.ndarray]:
        start = {"u": speed, "psi": course, "r": rate}
        y, _ = record(np.array([start.get(s, 0.0) for s in model.states]), inputs, np.diff(t, append=t[-1]), p)
        return {"t": t, "u": np.full(count, speed), **dict(zip(shown, y))}

    return Sailed(first["delta"], run, float(np.abs(first["r"]).max()))


def record_of(ship: Ship, manoeuvre: str, noise: str, sampling: float, rng: np.random.Generator) -> shipid.Trial:
    """Sail a manoeuvre from a start of its own, and log it."""
    own = sailed(ship, manoeuvre)
    columns = own.run(rng.uniform(-np.pi, np.pi), BEGINS * own.largest * rng.uniform(-1.0, 1.0))
    columns["delta"] = own.rudder - OFFSET
    every = round(sampling / FINE)
    # The clock of the log knows nothing of the helmsman's.
    first = int(rng.integers(every))
    logged = {n: values[first::every] for n, values in columns.items() if n != "v" or ship.across}
    count = logged["t"].size
    for name, deviation in SENSORS[noise].items():
        if name in logged:
            smaller = ship.length if name in ("u", "v", "x", "y") else 1.0
            logged[name] = logged[name] + smaller * deviation * rng.standard_normal(count)
    if noise == "waves":
        for name, values in noise_on(("psi", "r"), "waves", count, sampling, rng).items():
            logged[name] = logged[name] + values
    units = {n: FIELDS[n].unit for n in logged}
    return shipid.Trial.from_frame(pd.DataFrame(logged), name=manoeuvre, units=units)


def counted(ship: Ship, noise: str, sampling: float, run: int, number: int) -> Iterator[Counted]:
    """Identify one ship from one set of records by the defaults; nothing where the search does not converge."""
    rng = np.random.default_rng([2026, run, number])
    manoeuvres = MANOEUVRES[: 1 + (run + number) % 2]
    trials = [record_of(ship, m, noise, sampling, rng) for m in manoeuvres]
    fit = shipid.identify(ship.model, trials, ship=ship.ship)
    if not fit.converged:
        return
    known = shipid.find_ship(ship.ship)
    truth = known.values(fit.model, speed=known.particular("speed", "m/s"))
    told = any(n.serious for n in fit.warnings)
    effect = any(n.kind == EFFECT_MISSING for n in fit.warnings)
    for name in fit.estimated:
        e = fit.parameters[name]
        inside = e.ci95 is not None and e.ci95[0] <= truth[name] <= e.ci95[1]
        said = "told" if told else "determined" if e.identifiable and e.ci95 is not None else "not determined"
        value, std = (np.nan if x is None else float(x) for x in (e.value, e.std))
        yield Counted(
            ship.model, ship.ship, noise, sampling, len(trials), number, name, truth[name], value, std, inside, said, effect,
        )  # fmt: skip


def row(kind: str, what: str, every: Sequence[Counted]) -> dict[str, Any]:
    """Count how many truths intervals hold, of the determined ones and beside them."""
    sure = [c for c in every if c.said == "determined"]
    fits = len({c.fit for c in sure})
    error = float(np.sqrt(0.95 * 0.05 / max(1, fits)))
    share = float(np.mean([c.inside for c in sure])) if sure else None
    return {
        "of": kind,
        "what": what,
        "fits": len({c.fit for c in every}),
        "determined": len(sure),
        "coverage": share,
        "binomial_error": error,
        "asked": [LOW - 2 * error, min(1.0, HIGH + 2 * error)],
        "not_determined": sum(c.said == "not determined" for c in every),
        "not_determined_inside": sum(c.said == "not determined" and c.inside for c in every),
        "told": len({c.fit for c in every if c.said == "told"}),
        "effect_missing": len({c.fit for c in every if c.effect}),
        "holds": bool(share is None or LOW - 2 * error <= share <= HIGH + 2 * error),
    }


def rows_of(every: Sequence[Counted]) -> list[dict[str, Any]]:
    """All together, and by noise, sampling and model."""
    kinds: tuple[tuple[str, Callable[[Counted], str]], ...] = (
        ("all", lambda c: "records"),
        ("noise", lambda c: c.noise),
        ("sampling", lambda c: f"{c.sampling:g} s"),
        ("noise and sampling", lambda c: f"{c.noise}, {c.sampling:g} s"),
        ("model", lambda c: f"{c.model}, {c.ship}"),
    )
    return [
        row(kind, what, [c for c in every if of(c) == what])
        for kind, of in kinds
        for what in dict.fromkeys(of(c) for c in every)
    ]


def show(result: dict[str, Any]) -> None:
    """Print one row."""
    low, high = result["asked"]
    share = "none determined" if result["coverage"] is None else f"{result['coverage']:6.1%}"
    print(
        f"{result['of'] + ': ' + result['what']:32s}{share} of {result['determined']:4d} (asked {low:.1%} to {high:.1%}), {result['fits']:3d} fits; "
        f"not determined {result['not_determined']} ({result['not_determined_inside']} hold), {result['told']} told, "
        f"{result['effect_missing']} miss an effect: {'holds' if result['holds'] else 'DOES NOT HOLD'}"
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=4, help="records of each ship, noise and sampling")
    parser.add_argument("--only", default="", help="models and ships whose words hold this")
    parser.add_argument("--noise", default="fine,coarse,waves")
    parser.add_argument("--sampling", default=",".join(f"{s:g}" for s in SAMPLINGS), help="in s")
    parser.add_argument("--short", action="store_true", help="two ships, one sampling, one record each")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if options.short:
        options.runs, options.sampling, options.only = 1, "2", "mariner"
    begin, every, tried = time.perf_counter(), [], 0
    lost = 0
    with threadpool_limits(1, "blas"):
        for run in range(options.runs):
            for ship in (s for s in SHIPS if options.only in f"{s.model}, {s.ship}"):
                own = shipid.find_ship(ship.ship)
                unit_time = own.particular("L", "m") / own.particular("speed", "m/s")
                for sampling in (s for s in map(float, options.sampling.split(",")) if s <= SLOWEST * unit_time):
                    for noise in options.noise.split(","):
                        found = list(counted(ship, noise, sampling, run, tried))
                        every += found
                        tried += 1
                        lost += not found
    rows = rows_of(every)
    if options.json:
        records = [asdict(c) | {n: None for n in ("value", "std") if not np.isfinite(getattr(c, n))} for c in every]
        print(json.dumps({"not_converged": lost, "rows": rows, "coefficients": records}, indent=1, allow_nan=False))
    else:
        for one in rows:
            show(one)
        print(f"{tried} fits, {lost} not converged, {time.perf_counter() - begin:.0f} s")
    return 0 if rows and all(r["holds"] for r in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
