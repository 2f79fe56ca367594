"""A ship that appears late among false plots: how much of her time she is held, how soon, and what is tracked that is no ship.

A radar sees 2.5 km around itself. For 80 s there are only false plots; then a ship sails a straight course for 160 s at 2 to 8 m/s, from a
place within 1 km. Plots err by 7 m each way. The probability of a plot in a scan, the time of a scan, and the number of false plots a
scan are varied. The tracker is the default one; it is told the accuracy of the plots, and not how often a ship is seen. Settings were not
chosen on these seeds.

Held: share of the scans in which she was visible (a plot near her in two of three scans), and of all scans since she appeared.

    python studies/late_ships.py [--runs 24] [--detection 0.9] [--tracker NAME] [--told] [--first-seed 1000] [--json]
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from _table import Row, show

from shipid.encounter.plots.plots import Sensor, make_plots
from shipid.encounter.plots.read_plots import Detections
from shipid.encounter.plots.ship_path import ShipPath
from shipid.encounter.tracking.filters.trackers import NAMES
from shipid.encounter.tracking.track import track

REACH, NOISE, EMPTY, SAILS = 2500.0, 7.0, 80.0, 160.0
DETECTION, SCAN, CLUTTER = (0.9, 0.7, 0.5), (2.5, 4.0), {"few": 2.0, "many": 12.0}
#: Asked of a ship that is seen in 9 and in 7 of 10 scans: share of her visible time. Of false tracks, a minute.
HELD, FALSE = {0.9: 0.9, 0.7: 0.85}, 0.5


def scene(detection: float, interval: float, clutter: float, seed: int, told: bool) -> Detections:
    """Return the plots of a ship that appears late."""
    chance = np.random.default_rng([seed, int(100 * detection), int(10 * interval), int(clutter)])
    times = np.arange(0.0, EMPTY + SAILS, interval)
    after = times[times >= EMPTY]
    bearing, course = chance.uniform(0, 2 * np.pi, 2)
    away, speed = chance.uniform(200, 1000), chance.uniform(2, 8)
    x = away * np.cos(bearing) + speed * np.cos(course) * (after - EMPTY)
    y = away * np.sin(bearing) + speed * np.sin(course) * (after - EMPTY)
    t, plots, looks = [], [], []
    for now in times:
        false = chance.poisson(clutter)
        angle, far = chance.uniform(0, 2 * np.pi, false), REACH * np.sqrt(chance.random(false))
        found = np.stack([far * np.cos(angle), far * np.sin(angle)], axis=1)
        if now >= EMPTY and chance.random() < detection:
            k = int(np.searchsorted(after, now))
            found = np.concatenate([found, [[x[k], y[k]] + NOISE * chance.standard_normal(2)]])
        looks += [] if len(found) else [now]
        t.append(np.full(len(found), now))
        plots.append(found)
    z = np.concatenate(plots)
    sensor = Sensor(position_std=NOISE, detection=detection) if told else Sensor(position_std=NOISE)
    log = make_plots(
        np.concatenate(t), z[:, 0], z[:, 1], sensors=(sensor,), looks=np.array(looks), looks_sensor=np.zeros(len(looks), int)
    )  # fmt: skip
    own = ShipPath("own ship", times, np.zeros(times.size), np.zeros(times.size))
    return Detections("late ship", log, own, truth=(ShipPath("late ship", after, x, y),))


@dataclass(frozen=True)
class Found:
    """What a tracker made of the scenes of one kind.

    Attributes
    ----------
    visible, always : ndarray, shape (runs,)
        Share of the scans held in which the ship was visible, and of all since she appeared.
    first : ndarray, shape (runs,)
        Time from her appearance to her track, s; infinite where there was none.
    tracks : float
        Tracks that held her, one after the other, mean.
    false, movers : float
        Moving tracks without a ship, and those of them that surely move, a minute.
    """

    visible: np.ndarray
    always: np.ndarray
    first: np.ndarray
    tracks: float
    false: float
    movers: float


def tracked(detection: float, interval: float, clutter: float, runs: range, tracker: str, told: bool) -> Found:
    """Track the scenes of one kind."""
    rows = []
    for seed in runs:
        log = scene(detection, interval, clutter, seed, told)
        found = track(log, tracker)
        assert found.score is not None
        (ship,) = found.score.ships
        path = log.truth[0]
        near = [
            one.t[k] - path.t[0]
            for one in found.tracks
            for k in np.flatnonzero(one.held & path.covers(one.t))
            if np.hypot(*(one.x[k, :2] - path.at(one.t[k]))) < found.score.near
        ]
        rows.append(
            (ship.held or 0.0, ship.scans / path.t.size, min(near, default=np.inf), ship.tracks,
             found.score.false_tracks, found.score.false_movers, found.score.minutes)
        )  # fmt: skip
    visible, always, first, tracks, false, movers, minutes = np.array(rows).T
    return Found(visible, always, first, tracks.mean(), false.sum() / minutes.sum(), movers.sum() / minutes.sum())


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=24, help="scenes of each kind")
    parser.add_argument("--tracker", choices=NAMES, default="imm")
    parser.add_argument("--detection", type=float, action="append", choices=DETECTION, help="all three by default")
    parser.add_argument("--told", action="store_true", help="tell the tracker how often a ship is seen")
    parser.add_argument("--first-seed", type=int, default=1000)
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    runs = range(given.first_seed, given.first_seed + given.runs)
    rows = []
    for detection in given.detection or DETECTION:
        for interval in SCAN:
            for name, clutter in CLUTTER.items():
                found = tracked(detection, interval, clutter, runs, given.tracker, given.told)
                what = f"seen in {detection:.0%} of scans of {interval:g} s, {name} false plots"
                held, spread = found.visible.mean(), found.visible.std() / np.sqrt(given.runs)
                asked = HELD.get(detection)
                rows.append(
                    Row(
                        f"{what}: held",
                        f"{asked:.0%} of the visible time" if asked else "reported",
                        f"{held:.0%} ± {spread:.0%}, of all her time {found.always.mean():.0%}; first after {np.median(found.first):.0f} s, "
                        f"{found.tracks:.1f} tracks",
                        asked is None or bool(held >= asked),
                    )
                )
                rows.append(
                    Row(
                        f"{what}: moving tracks without a ship",
                        f"{FALSE:g} a minute",
                        f"{found.false:.2f}, surely moving {found.movers:.2f}",
                        bool(found.false <= FALSE),
                    )
                )
    show("A ship that appears late among false plots", rows, as_json=given.json)


if __name__ == "__main__":
    main()
