"""The current that the bridge and `predict` tell along real trials, where there is none: how often its 95 % interval holds zero.

In the tank of MARIN there is no current. The speeds in the log of Gunnerus are speeds over the ground, so that none is left beside
them; her fixes lag by up to 4 s for up to a minute. Both ships are sailed by the coefficients they come with, sample by sample
through the filter of the bridge, and `predict` is asked at eight instants of each trial. Counted from three L/U on; the distance from
zero is in the standard deviation that is told, and 2.45 is the limit of a 95 % interval for two components.

The trials are not part of the project; the script looks for them in ``../shared/data`` or ``--data``.

    python studies/replayed_current.py [--data FOLDER] [--short] [--json]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from _table import Row, show
from predicted_trials import CAMPAIGNS, FORMATS

import shipid
from shipid.autopilot.design.autopilot import Autopilot
from shipid.bridge.open_bridge import preferred_model
from shipid.bridge.own_ship.own_ship import OwnShip
from shipid.bridge.sources.replayed import ReplayedSource
from shipid.parameters.catalogue import find_ship
from shipid.prediction.situations.situation import Situation
from shipid.prediction.situations.trial_situation import known_before

#: Campaigns without a current.
WITHOUT = ("KVLCC2, MARIN", "Gunnerus")
#: Seconds between two steps of the bridge's filter; L/U before estimates count; instants at which `predict` is asked.
STEP, SETTLED, INSTANTS = 0.4, 3.0, 8
#: The limit of a 95 % interval of two components, and the share of a record that may lie outside.
LIMIT, ALLOWED = 2.45, 0.05


def replayed(pilot: Autopilot, trial: shipid.Trial) -> Iterator[Situation]:
    """Sail a trial through the bridge's own ship."""
    own, source = OwnShip(pilot), ReplayedSource(trial)
    for t in np.arange(0.0, trial.duration, STEP):
        own.take(float(t), source.take(float(t)).values)
        if own.situation is not None:
            yield own.situation


def asked(pilot: Autopilot, trial: shipid.Trial) -> Iterator[Situation]:
    """Ask at some instants what `predict` begins from."""
    for share in np.arange(1, INSTANTS + 1) / INSTANTS:
        at = float(trial["t"][0] + share * trial.duration)
        yield known_before(pilot.model, pilot.ship, trial, at)[0]


def row_of(name: str, pilot: Autopilot, known: list[Situation], start: float) -> Row:
    """How often the interval holds zero, and the largest current that is told."""
    length = pilot.length
    counted = [k for k in known if k.t >= start + SETTLED * length / k.values["u"]]
    speeds = np.array([np.hypot(*k.current) / k.values["u"] for k in counted])
    off = np.array([np.hypot(*k.current) / k.current_std for k in counted])
    outside = float(np.mean(off > LIMIT))
    measured = f"{outside:.0%} outside; at most {speeds.max():.3f} U and {off.max():.1f} standard deviations"
    return Row(
        name,
        f"zero within, {1 - ALLOWED:.0%}",
        measured,
        outside <= max(ALLOWED, 1.0 / INSTANTS * (len(counted) <= INSTANTS)),
    )


def rows_of(folder: Path, short: bool) -> list[Row]:
    """Replay every trial of the campaigns without a current."""
    rows = []
    for campaign in (c for c in CAMPAIGNS if c.name in WITHOUT):
        ship = find_ship(campaign.ship)
        pilot = shipid.design_autopilot(preferred_model(ship), ship)
        for name in (*campaign.fitted, *campaign.predicted)[: 1 if short else None]:
            trial = shipid.read_trial(str(folder / name), format=str(FORMATS / campaign.form))
            rows.append(row_of(f"{trial.name}, bridge", pilot, list(replayed(pilot, trial)), 0.0))
            rows.append(row_of(f"{trial.name}, predict", pilot, list(asked(pilot, trial)), float(trial["t"][0])))
    return rows


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=Path(__file__).resolve().parents[2] / "shared" / "data")
    parser.add_argument("--short", action="store_true", help="the first trial of each campaign")
    parser.add_argument("--json", action="store_true")
    chosen = parser.parse_args()
    if not chosen.data.is_dir():
        print(f"the trials are not at {chosen.data}; nothing was run (give --data).", file=sys.stderr)
        return 0
    show("A current where there is none, along real trials", rows_of(chosen.data, chosen.short), as_json=chosen.json)
    return 0


if __name__ == "__main__":
    sys.exit(main())
