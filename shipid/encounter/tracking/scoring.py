"""Tracks beside the truth: how much of the time a ship is held, how far off, how honest, and what is no ship at all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from shipid.encounter.plots.plots import Plots, Scan
from shipid.encounter.plots.ship_path import ShipPath
from shipid.encounter.tracking.target_track import TargetTrack
from shipid.foundation.aliases import Plain
from shipid.foundation.result import Result, table
from shipid.foundation.statistics import plain

if TYPE_CHECKING:
    import pandas as pd

#: A track is a ship's within so many standard deviations of a plot; no ship within this distance, and it is a false one.
_NEAR, _FAR = 5.0, 250.0
#: A false track that moves more slowly may be a buoy or a pier, m/s.
_MOVING = 0.7
#: How far ahead tracks are judged, s.
HORIZONS = (0.0, 10.0, 30.0)


@dataclass(frozen=True)
class ShipScore:
    """How one ship was tracked.

    Attributes
    ----------
    name : str
        Of the ship.
    visible : int
        Scans in which she was visible: a plot near her in two of three scans around.
    held : float or None
        Share of them with a confirmed track near her; None where she was never visible.
    rmse : tuple of float or None
        Error of the position now and ahead, by `HORIZONS`, m; None where there is none.
    nees : float or None
        Mean normalised squared error of the position; 2 where the covariance is honest.
    tracks : int
        How many tracks held her, one after the other.
    scans : int
        Scans in which she was held.
    bearing_offset, range_offset : (float, float) or None
        How far the tracks lie off as the sensor sees it, mean and standard deviation: to the right in deg, and beyond in m.
    """

    name: str
    visible: int
    held: float | None
    rmse: tuple[float | None, ...]
    nees: float | None
    tracks: int
    scans: int = 0
    bearing_offset: tuple[float, float] | None = None
    range_offset: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False, repr=False)
class TrackingScore(Result):
    """How the tracks of a log compare with the truth.

    Attributes
    ----------
    ships : tuple of ShipScore
        Those that were visible, and those that were not.
    false_tracks : int
        Confirmed tracks with more than 0.7 m/s where no ship is within 250 m.
    false_movers : int
        Those of them that surely move: the speed of the others may be that of a buoy or a shore.
    minutes : float
        Length of the log.
    near : float
        Distance within which a track is a ship's, m.
    """

    ships: tuple[ShipScore, ...]
    false_tracks: int
    minutes: float
    near: float
    false_movers: int = 0

    @property
    def false_rate(self) -> float | None:
        """False tracks a minute; None for a log of no length."""
        return self.false_tracks / self.minutes if self.minutes > 0 else None

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON."""
        return {
            "ships": [
                {
                    "name": s.name,
                    "visible_scans": s.visible,
                    "held": s.held,
                    "rmse": [{"ahead": h, "value": v, "unit": "m"} for h, v in zip(HORIZONS, s.rmse) if v is not None],
                    "nees": s.nees,
                    "tracks": s.tracks,
                    "bearing_offset": _plain_offset(s.bearing_offset, "deg"),
                    "range_offset": _plain_offset(s.range_offset, "m"),
                }
                for s in self.ships
            ],
            "false_tracks": self.false_tracks,
            "false_tracks_per_minute": self.false_rate,
            "false_movers": self.false_movers,
            "near": {"value": self.near, "unit": "m"},
        }

    def text(self) -> str:
        """Return the result in lines of text."""
        rate = "" if self.false_rate is None else f", {self.false_rate:.2f} a minute"
        lines = [
            f"beside the truth: {self.false_tracks} moving track{'' if self.false_tracks == 1 else 's'} without a ship within {_FAR:.0f} m{rate}, "
            f"of which {self.false_movers} surely move; "
            f"a track within {self.near:.0f} m is a ship's"
        ]
        for s in self.ships:
            if s.held is None:
                continue
            errors = ", ".join("none" if e is None else f"{e:.1f} m" for e in s.rmse)
            nees = "" if s.nees is None else f", NEES {s.nees:.1f}"
            ahead = "/".join(f"{h:.0f}" for h in HORIZONS)
            lines.append(
                f"{s.name}: held {100 * s.held:.0f} % of {s.visible} scans, RMSE {ahead} s ahead {errors}{nees}"
            )
        never = sum(s.held is None for s in self.ships)
        return "\n".join(
            lines + ([f"{never} of {len(self.ships)} true ships never visible to the sensor"] if never else [])
        )

    def to_frame(self) -> pd.DataFrame:
        """Return the ships as a pandas table: how long each was held, errors now and ahead in m."""
        rows = (
            {
                "ship": s.name,
                "visible_scans": s.visible,
                "held": s.held,
                **{f"rmse_{h:.0f}_s [m]": e for h, e in zip(HORIZONS, s.rmse)},
                "nees": s.nees,
                "tracks": s.tracks,
            }
            for s in self.ships
        )
        return table(rows, "ship", ("visible_scans", "held", "nees", "tracks"))


def _plain_offset(offset: tuple[float, float] | None, unit: str) -> dict[str, Plain] | None:
    return None if offset is None else {"value": offset[0], "unit": unit, "std": offset[1]}


def score_tracks(
    tracks: Sequence[TargetTrack],
    plots: Plots,
    truth: Sequence[ShipPath],
    own: ShipPath | None = None,
    near: float | None = None,
) -> TrackingScore:
    """Compare tracks with the truth, at the scans of the sensor that reaches farthest.

    Parameters
    ----------
    tracks : sequence of TargetTrack
        The tracks.
    plots : Plots
        What they were made from.
    truth : sequence of ShipPath
        The true tracks, in the frame and on the clock of the plots.
    own : ShipPath, optional
        Own ship: a track on her is not a false one.
    near : float, optional
        Distance within which a plot or a track is a ship's, m; by default five standard deviations of a plot, 20 m at least.

    Returns
    -------
    TrackingScore
    """
    judge = judging_sensor(plots)
    scans = [s for s in plots if s.sensor == judge]
    sensor = plots.sensors[judge]
    limit = near
    if limit is None:
        spreads = [
            np.sqrt(np.trace(sensor.covariance(s.z, np.broadcast_to(s.own, s.z.shape)), axis1=1, axis2=2) / 2)
            for s in scans
        ]
        typical = np.concatenate(spreads) if spreads else np.zeros(0)
        limit = max(_NEAR * float(np.median(typical)) if typical.size else 0.0, 20.0)
    times = np.array([s.t for s in scans])
    estimates = [_estimates(tracks, t) for t in times]
    ships = tuple(_score_ship(path, scans, times, estimates, limit) for path in truth)
    others = [*truth, *([own] if own is not None else [])]
    false = [_moving_far(one, times, others) for one in tracks]
    minutes = (plots.span[1] - plots.span[0]) / 60
    return TrackingScore(
        ships,
        sum(bool(m.any()) for m in false),
        minutes,
        limit,
        sum(bool((m & one.moves).any()) for m, one in zip(false, tracks)),
    )


def judging_sensor(plots: Plots) -> int:
    """Return the sensor at whose scans tracks are judged: the one that reaches farthest, by the median of its plots.

    Parameters
    ----------
    plots : Plots
        The plots.
    """
    reach = np.zeros(len(plots.sensors))
    for k in range(len(plots.sensors)):
        away = [np.hypot(*(s.z - s.own).T) for s in plots if s.sensor == k and len(s.z)]
        together = np.concatenate(away) if away else np.zeros(1)
        reach[k] = float(np.nanmedian(together)) if np.isfinite(together).any() else 0.0
    return int(reach.argmax())


def _moving_far(track: TargetTrack, times: np.ndarray, ships: Sequence[ShipPath]) -> np.ndarray:
    """When a track moves and no ship is near, of shape (N,), at the scans that are judged."""
    which = track.held & np.isin(track.t, times) & (track.speed > _MOVING)
    for k in np.flatnonzero(which):
        which[k] = not _ship_near(track.x[k], float(track.t[k]), ships)
    return np.asarray(which)


def _ship_near(state: np.ndarray, t: float, ships: Sequence[ShipPath]) -> bool:
    """Whether a ship was near; one whose path has begun or ended a little before is still there."""
    return any(np.hypot(*(state[:2] - path.at(t))) < _FAR for path in ships if path.t[0] - 10 <= t <= path.t[-1] + 10)


def _estimates(tracks: Sequence[TargetTrack], t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers, states and covariances of the tracks that are held after the scan of a time."""
    found = []
    for track in tracks:
        k = int(np.searchsorted(track.t, t, side="right")) - 1
        if k >= 0 and track.t[k] == t and track.held[k]:
            found.append((track.number, track.x[k], track.P[k]))
    if not found:
        return np.zeros(0, int), np.zeros((0, 4)), np.zeros((0, 4, 4))
    numbers, x, P = zip(*found)
    return np.array(numbers), np.array(x), np.array(P)


def _score_ship(
    path: ShipPath,
    scans: Sequence[Scan],
    times: np.ndarray,
    estimates: Sequence[tuple[np.ndarray, ...]],
    limit: float,
) -> ShipScore:
    inside = path.covers(times)
    detected = np.array([len(s.z) > 0 and np.hypot(*(s.z - path.at(s.t)).T).min() < limit for s in scans]) & inside
    visible = np.convolve(detected.astype(float), np.ones(3), "same") >= 2
    visible = visible & inside
    held = np.zeros(times.size, bool)
    squares: list[list[float]] = [[] for _ in HORIZONS]
    nees, numbers, offsets = [], [], []
    for k in np.flatnonzero(inside).tolist():
        number, x, P = estimates[k]
        if not len(number):
            continue
        error = x[:, :2] - path.at(times[k])
        i = int(np.hypot(*error.T).argmin())
        if np.hypot(*error[i]) > limit:
            continue
        held[k] = True
        numbers.append(int(number[i]))
        offsets.append([*error[i], *(path.at(times[k]) - scans[k].own)])
        nees.append(float(error[i] @ np.linalg.solve(P[i, :2, :2], error[i])))
        for row, ahead in zip(squares, HORIZONS):
            if path.covers(times[k] + ahead):
                off = x[i, :2] + ahead * x[i, 2:] - path.at(times[k] + ahead)
                row.append(float(off @ off))
    return ShipScore(
        path.name,
        int(visible.sum()),
        float(held[visible].mean()) if visible.any() else None,
        tuple(plain(float(np.sqrt(np.mean(row)))) if row else None for row in squares),
        float(np.mean(nees)) if nees else None,
        len(set(numbers)),
        int(held.sum()),
        *_offsets(np.array(offsets).reshape(-1, 4)),
    )


def _offsets(off: np.ndarray) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
    """Mean and spread of errors in bearing, deg, and in range, m, from errors and positions relative to the sensor."""
    known = off[np.isfinite(off).all(axis=1) & (np.hypot(off[:, 2], off[:, 3]) > 1.0)]
    if not len(known):
        return None, None
    (x, y), (north, east) = known[:, :2].T, known[:, 2:].T
    away = np.hypot(north, east)
    bearing = np.rad2deg(np.arctan2(north * y - east * x, away**2 + north * x + east * y))
    along = np.hypot(north + x, east + y) - away
    return (float(bearing.mean()), float(bearing.std())), (float(along.mean()), float(along.std()))
