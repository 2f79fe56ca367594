"""Every tracker on real detections: the radar and lidar of a slow ferry, and a ship-borne radar in dense clutter.

Plots are associated by the tracker itself, with one set of settings for all. Beside the satellite positions of two targets
(Helgesen et al., 2022) stands a constant-velocity filter that the truth associates: radar only, the plot nearest to the truth
within 20 m, acceleration noise of 0.1 m^2/s^3, 5 m each way, a velocity of 5 m/s that is not known at the first plot. Both are
judged at the same radar scans, the start included. AIS stands for the truth of the second campaign (rcdaudt/maritime-phd).

The data are not part of the project; the script looks for them in ``../shared/data`` or ``--data``.

    python studies/real_tracking.py [--data FOLDER] [--tracker NAME ...] [--short] [--json]
"""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from _table import Row, show

from shipid.encounter.plots.plots import Plots
from shipid.encounter.plots.read_plots import Detections, read_detections
from shipid.encounter.plots.ship_path import ShipPath
from shipid.encounter.tracking.filters.trackers import NAMES
from shipid.encounter.tracking.scoring import HORIZONS
from shipid.encounter.tracking.track import track
from shipid.encounter.tracking.tracking import Tracking

FORMATS = Path(__file__).parent / "formats"
#: Two targets in one plot for a third of the time: they are reported by themselves.
UNRESOLVED = ("scenario17",)
#: Share of the visible time held, ratio to the base by horizon, bounds of the NEES, false tracks a minute.
HELD, HELD_UNRESOLVED, RATIOS, NEES, FALSE = 0.95, 0.80, (0.85, 0.9, 1.0), (1.0, 4.0), 0.5
#: The ships the second radar sees well: share held, error of the position in m, unmatched tracks a minute.
SEEN, HELD_SEEN, ERROR_SEEN, FALSE_SEEN = ("RED EAGLE", "CHARLESTON EXPRESS"), 0.95, (60.0, 90.0), 4.0


@dataclass
class Tally:
    """What one tracker did."""

    held: list[float] = field(default_factory=list)
    unresolved: list[float] = field(default_factory=list)
    ratios: list[tuple[float, ...]] = field(default_factory=list)
    nees: list[float] = field(default_factory=list)
    false: int = 0
    minutes: float = 0.0


def base(path: ShipPath, plots: Plots) -> dict[float, np.ndarray]:
    """Return the state of the base after each radar scan, by time: the truth chooses its plots."""
    x, P, last = None, np.zeros((4, 4)), 0.0
    found = {}
    for scan in plots:
        if plots.sensors[scan.sensor].name != "radar" or scan.t > path.t[-1]:
            continue
        if x is not None:
            dt = scan.t - last
            F = np.eye(4)
            F[0, 2] = F[1, 3] = dt
            Q = 0.1 * np.kron([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]], np.eye(2))
            x, P = F @ x, F @ P @ F.T + Q
        last = scan.t
        away = np.hypot(*(scan.z - path.at(scan.t)).T)
        if away.size and away.min() < 20.0:
            z = scan.z[away.argmin()]
            if x is None:
                x, P = np.array([*z, 0.0, 0.0]), 25.0 * np.eye(4)
            else:
                gain = np.linalg.solve(P[:2, :2] + 25.0 * np.eye(2), P[:2]).T
                x, P = x + gain @ (z - x[:2]), P - gain @ P[:2]
        if x is not None:
            found[scan.t] = x
    return found


def ratios(found: Tracking, path: ShipPath, near: float) -> tuple[float, ...]:
    """Return the error of the tracks over that of the base by horizon, where both have an estimate."""
    states = base(path, found.plots)
    ours: list[list[float]] = [[] for _ in HORIZONS]
    theirs: list[list[float]] = [[] for _ in HORIZONS]
    for t, state in states.items():
        rows = [one.x[k] for one in found.tracks for k in np.flatnonzero((one.t == t) & one.held)]
        away = [float(np.hypot(*(x[:2] - path.at(t)))) for x in rows]
        if not away or min(away) > near:
            continue
        x = rows[int(np.argmin(away))]
        for k, ahead in enumerate(HORIZONS):
            if path.covers(t + ahead):
                there = path.at(t + ahead)
                ours[k].append(float(np.sum((x[:2] + ahead * x[2:] - there) ** 2)))
                theirs[k].append(float(np.sum((state[:2] + ahead * state[2:] - there) ** 2)))
    return tuple(math.sqrt(np.mean(a) / np.mean(b)) if b else math.nan for a, b in zip(ours, theirs))


def scenarios(folder: Path) -> list[Detections]:
    """Read every scenario there is."""
    files = sorted(folder.glob("*_detections.json"), key=lambda f: (len(f.name), f.name))
    return [
        read_detections(
            f, format=FORMATS / "autoferry.toml", truth=f.with_name(f.name.replace("detections", "groundTruth"))
        )
        for f in files
    ]


def on_the_ferry(name: str, logs: list[Detections]) -> list[Row]:
    """Return the rows of a tracker on the first campaign."""
    tally, rows = Tally(), []
    for log in logs:
        found = track(log, name)
        assert found.score is not None
        unresolved = log.name.startswith(UNRESOLVED)
        tally.false += found.score.false_tracks
        tally.minutes += found.score.minutes
        for ship, path in zip(found.score.ships, log.truth):
            (tally.unresolved if unresolved else tally.held).append(ship.held or 0.0)
            ratio = ratios(found, path, found.score.near)
            if not unresolved:
                tally.ratios.append(ratio)
            if ship.nees is not None:
                tally.nees.append(ship.nees)
            rows.append(
                Row(
                    f"{name}, {log.name.removesuffix('_detections')}, {ship.name}",
                    "reported",
                    f"held {100 * (ship.held or 0):.0f} %, ratios {'/'.join(f'{r:.2f}' for r in ratio)}, NEES {ship.nees or 0:.1f}",
                    True,
                )
            )
    mean = np.nanmean(np.array(tally.ratios), axis=0)
    held, nees = float(np.mean(tally.held)), float(np.mean(tally.nees))
    rows.append(Row(f"{name}: visible time held", f"{100 * HELD:.0f} %", f"{100 * held:.1f} %", held >= HELD))
    if tally.unresolved:
        apart = float(np.mean(tally.unresolved))
        rows.append(
            Row(f"{name}: the same, ships 10 m apart", f"{100 * HELD_UNRESOLVED:.0f} %", f"{100 * apart:.1f} %", apart >= HELD_UNRESOLVED)
        )  # fmt: skip
    for ahead, asked, ratio in zip(HORIZONS, RATIOS, mean):
        what = f"{name}: error over the base's, {f'{ahead:.0f} s ahead' if ahead else 'now'}"
        rows.append(Row(what, f"{asked:g} or less", f"{ratio:.2f}", bool(ratio <= asked)))
    rows.append(
        Row(f"{name}: NEES of the position", f"{NEES[0]:g} to {NEES[1]:g}", f"{nees:.2f}", NEES[0] <= nees <= NEES[1])
    )
    rate = tally.false / tally.minutes
    rows.append(Row(f"{name}: moving tracks without a ship", f"{FALSE:g} a minute", f"{rate:.2f}", rate <= FALSE))
    return rows


def in_the_solent(name: str, folder: Path) -> list[Row]:
    """Return the rows of a tracker on the second campaign."""
    rows, false, minutes = [], 0, 0.0
    for file in sorted(folder.glob("MarCE_Radar_Detections_*.mat")):
        ais = file.with_name(file.name.replace("MarCE_Radar_Detections", "tracksAIS"))
        found = track(read_detections(file, format=FORMATS / "marce.toml", own=ais, truth=ais), name)
        assert found.score is not None
        run = file.stem.removeprefix("MarCE_Radar_Detections_")
        for ship in found.score.ships:
            if ship.name not in SEEN or not ship.visible:
                continue
            held, error = ship.held or 0.0, ship.rmse[0] or math.inf
            rows.append(
                Row(
                    f"{name}, {run}, {ship.name}: held",
                    f"{100 * HELD_SEEN:.0f} %",
                    f"{100 * held:.1f} %",
                    held >= HELD_SEEN,
                )
            )
            rows.append(
                Row(f"{name}, {run}, {ship.name}: error", f"{ERROR_SEEN[1]:g} m or less", f"{error:.0f} m", error <= ERROR_SEEN[1])
            )  # fmt: skip
            nees = ship.nees or 0.0
            rows.append(
                Row(f"{name}, {run}, {ship.name}: NEES", f"{NEES[0]:g} to {NEES[1]:g}", f"{nees:.1f}", NEES[0] <= nees <= NEES[1])
            )  # fmt: skip
        false, minutes = false + found.score.false_tracks, minutes + found.score.minutes
        each = f"{found.score.false_rate or 0.0:.1f} a minute"
        rows.append(Row(f"{name}, {run}: moving tracks without a ship", "reported", each, True))
    if minutes:
        rate = false / minutes
        what = f"{name}: moving tracks without a ship, both runs"
        rows.append(Row(what, f"{FALSE_SEEN:g} a minute", f"{rate:.1f}", rate <= FALSE_SEEN))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=Path(__file__).resolve().parents[2] / "shared" / "data")
    parser.add_argument("--tracker", action="append", choices=NAMES, help="which trackers; all by default")
    parser.add_argument("--short", action="store_true", help="the default tracker only")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    options = parser.parse_args()
    if not (options.data / "autoferry").is_dir():
        print(f"the detections are not at {options.data}; nothing was run (give --data).", file=sys.stderr)
        sys.exit(0)
    logs = scenarios(options.data / "autoferry")
    rows = []
    for name in ("imm",) if options.short else options.tracker or NAMES:
        rows += on_the_ferry(name, logs) + in_the_solent(name, options.data / "marce")
    show("Real detections, associated by the tracker", rows, as_json=options.json)


if __name__ == "__main__":
    main()
