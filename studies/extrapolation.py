#!/usr/bin/env python3
"""Every shipped model and ship through the standard manoeuvres and a 35/20 zig-zag: sailed, or not sailed by this model.

python studies/extrapolation.py [--short] [--json]

The turning circle at 35 degrees (or the ship's largest angle, held for a hundred ship lengths), 10/10 and 20/20 zig-zags to
both sides and the spiral are those of MSC.137(76) as `shipid criteria` evaluates them; the 35/20 zig-zag is simulated at three
speeds. A run that is called sailed is looked at again without the guards of the models: its numbers are finite, it keeps a
fifth of its approach speed, and turns no faster than r L/U = 1.5. The short form takes one ship of each model.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np
from _container import container_ship
from _table import Row, show

import shipid
from shipid.criteria.criteria import Criteria
from shipid.criteria.manoeuvring_criteria import manoeuvring_criteria
from shipid.declaration.guard import NOT_SAILED
from shipid.declaration.model import Model
from shipid.foundation.errors import ParameterSetError
from shipid.parameters.catalogue import known_models, known_ships
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.manoeuvres.simulate import NotSailedError, simulate

#: Shares of the ship's own speed.
SPEEDS = (0.6, 0.8, 1.0)
HARD = "zigzag:35/20"
#: Quantities of each manoeuvre of the standard.
TURN, GENTLE, MEDIUM = (
    ("advance", "tactical_diameter"),
    ("first_overshoot_10", "second_overshoot_10"),
    ("first_overshoot_20",),
)
READING = (
    "sailed: the model stays within the range in which it is valid; that it is right there is another matter (see the range of "
    "speeds and rudder angles that every command names). A set that is tabulated against speed has none outside its table."
)


def pairs(short: bool) -> Iterator[tuple[Model, ParameterSet]]:
    """Yield every shipped model that reads a rudder with every ship that has a set for it."""
    seen = set()
    for ship in known_ships().values():
        for name, model in known_models().items():
            if name not in ship.models or "delta" not in model.inputs or "psi" not in model:
                continue
            if short and name in seen:
                continue
            seen.add(name)
            yield model, ship


def outcome(found: Criteria, keys: tuple[str, ...]) -> tuple[str, bool]:
    """Say how a manoeuvre of the standard went, and whether the word and the numbers fit together."""
    rows = [r for r in found.rows if r.key in keys]
    sides = [side for r in rows for side in (r.starboard, r.port)]
    if all(s.value is not None and np.isfinite(s.value) for s in sides):
        beyond = any(r.within is False for r in rows)
        return "sailed" + (", beyond a limit" if beyond else ""), True
    if any(s.words.startswith(NOT_SAILED) for s in sides):
        return NOT_SAILED, all(r.within is None for r in rows)
    words = next(s.words for s in sides if s.value is None)
    return words.partition(":")[0], all(r.within is None for r in rows if r.starboard.value is None)


def hard_zigzag(model: Model, ship: ParameterSet, share: float) -> tuple[str, bool]:
    """Sail the 35/20 zig-zag at a share of the ship's speed, and look at the run without the guards."""
    speed = share * (ship.particular("speed", "m/s") or 0.0)
    try:
        trial = simulate(model, ship, HARD, speed=speed)
    except NotSailedError as error:
        return NOT_SAILED, NOT_SAILED in str(error)
    except ParameterSetError:
        return "outside its table", True
    return "sailed", is_of_a_ship(trial, speed, ship.particular("L", "m") or 0.0)


def is_of_a_ship(trial: shipid.Trial, speed: float, length: float) -> bool:
    """Whether a simulated run is finite, keeps a fifth of its speed, and turns like a ship."""
    finite = all(np.isfinite(trial[n]).all() for n in trial.table.columns)
    kept = not trial.has("u") or trial["u"].min() >= 0.2 * speed
    turns = not trial.has("r") or np.abs(trial["r"]).max() * length / speed <= 1.5
    return bool(finite and kept and turns)


def row_of(model: Model, ship: ParameterSet) -> Row:
    """Evaluate one pair."""
    found = manoeuvring_criteria(model, ship=ship, draws=0)
    turn, *gentle = (outcome(found, keys) for keys in (TURN, GENTLE, MEDIUM))
    circle = f"turn {np.rad2deg(found.rudder):.0f}"
    if turn[0].startswith("sailed"):
        # Once more by another way: the simulated trial of the same turn.
        trial = simulate(model, ship, f"turn:{np.rad2deg(found.rudder):.6g}")
        turn = turn[0], turn[1] and is_of_a_ship(trial, found.speed, found.length)
    hard = [hard_zigzag(model, ship, share) for share in SPEEDS]
    spiral = "no spiral" if found.spiral is None else "stable" if found.spiral["stable"] else "unstable, with its loop"
    said = [f"{circle} {turn[0]}", f"10/10 {gentle[0][0]}", f"20/20 {gentle[1][0]}", spiral]
    said += [f"35/20 at {share:g} U: {word}" for share, (word, _) in zip(SPEEDS, hard)]
    holds = all(good for _, good in (turn, *gentle, *hard))
    return Row(f"{ship.name}, {model.name}", "sailed, or named", "; ".join(said), holds)


def lost_ships() -> list[Row]:
    """Ships that do not sail their circle: the container with the loss of speed of the prototypes, and one that runs away."""
    rows = []
    container = container_ship()
    for name in ("de-keizer", "de-keizer-minimal", "de-keizer-cubic", "gain-scheduled"):
        word, good = outcome(manoeuvring_criteria(name, ship=container, draws=0), TURN)
        rows.append(Row(f"soesterberg with K_u* 0.9, {name}, turn 35", NOT_SAILED, word, good and word == NOT_SAILED))
    for name, ship, wrong in (("norrbin", "zeefakkel", "b3=-400 s/rad^2"), ("bech", "kvlcc2", "c3=-9 1/rad^2")):
        key, _, value = wrong.partition("=")
        try:
            simulate(name, ship, "turn:30", values={key: value})
            word = "sailed"
        except NotSailedError as error:
            word = NOT_SAILED if NOT_SAILED in str(error) else str(error)
        rows.append(Row(f"{ship} with {wrong}, {name}, turn 30", NOT_SAILED, word, word == NOT_SAILED))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--short", action="store_true", help="one ship of each model")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    chosen = parser.parse_args()
    rows = [row_of(model, ship) for model, ship in pairs(chosen.short)] + lost_ships()
    show("Every shipped model and ship through the standard manoeuvres", rows, READING, chosen.json)


if __name__ == "__main__":
    main()
