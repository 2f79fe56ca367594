"""Plots: positions that radar, lidar or AIS report, scan by scan, without names."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from shipid.encounter.errors import EncounterRequestError
from shipid.foundation.notices import Notice

#: A plot nearer than this to its sensor is its own echo, m.
_OWN_ECHO = 1.0
#: Half way round the Earth, m: no plot lies farther from anywhere.
_FARTHEST = 2e7
#: An antenna that turns clockwise sees a plot so little before the one before, rad, in this share of all at most.
_BACKWARD, _SELDOM = 0.5, 0.05
#: A plot comes no later than this after those of its time, s; a clock that goes back farther has begun again, so often at most.
_LATE, _PARTS = 30.0, 10


@dataclass(frozen=True)
class Sensor:
    """What is known of a sensor.

    Attributes
    ----------
    name : str
        What it is called.
    position_std : float
        Standard deviation of a position along each axis, m.
    range_std, bearing_std : float or None
        Instead of it: of range in m and bearing in rad.
    bias_std : float
        Standard deviation of what all plots of a target are off together, along each axis, m: the sensor out of place, or a long
        target whose echo comes from one end.
    bearing_bias_std : float
        The same of all bearings, rad: the heading that they are counted from.
    latency : float
        How old a position is at its time stamp, s.
    latency_std : float
        How well the latency is known, s; above zero it is estimated with the tracks.
    detection : float
        Probability that a target in its sight gives a plot in a scan.
    sight : float
        Share of the time that a target is in its sight.
    period : float or None
        Time of a scan in s, for plots that come one by one; None takes plots of one time as a scan, or finds it from the bearings.
    """

    name: str = "radar"
    position_std: float = 5.0
    range_std: float | None = None
    bearing_std: float | None = None
    bias_std: float = 0.0
    bearing_bias_std: float = 0.0
    latency: float = 0.0
    latency_std: float = 0.0
    detection: float = 0.9
    sight: float = 0.8
    period: float | None = None

    def __post_init__(self) -> None:
        """Refuse numbers that no sensor has."""
        stds = [s for s in (self.position_std, self.range_std, self.bearing_std) if s is not None]
        if not all(np.isfinite(s) and s > 0 for s in stds) or (self.range_std is None) != (self.bearing_std is None):
            raise EncounterRequestError(
                f"the accuracy of sensor '{self.name}' has to be a standard deviation above zero: of positions, or of range and bearing together."
            )
        if not all(np.isfinite(s) and s >= 0 for s in (self.bias_std, self.bearing_bias_std)):
            raise EncounterRequestError(
                f"the bias of sensor '{self.name}' has to be a standard deviation of zero or more."
            )
        if not (0 < self.detection < 1 and 0 < self.sight < 1):
            raise EncounterRequestError(
                f"detection and sight of sensor '{self.name}' are probabilities between zero and one, and are {self.detection:g} and {self.sight:g}."
            )
        if not (np.isfinite(self.latency) and self.latency_std >= 0) or (
            self.period is not None and not self.period > 0
        ):
            raise EncounterRequestError(
                f"the latency of sensor '{self.name}' has to be a finite time, and its scan a time above zero."
            )

    def covariance(self, z: np.ndarray, own: np.ndarray) -> np.ndarray:
        """Return the covariance of plots, shape (m, 2, 2), m^2.

        Parameters
        ----------
        z : ndarray, shape (m, 2)
            North and east, m.
        own : ndarray, shape (m, 2)
            Where the sensor was.
        """
        if self.range_std is None or self.bearing_std is None:
            return np.tile(self.position_std**2 * np.eye(2), (len(z), 1, 1))
        away = np.where(np.isfinite(own), z - own, z)
        range_ = np.maximum(np.hypot(*away.T), _OWN_ECHO)
        along = away / range_[:, None]
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        both = [np.einsum("mi,mj->mij", v, v) for v in (along, across)]
        spread = (range_ * self.bearing_std)[:, None, None]
        return np.asarray(self.range_std**2 * both[0] + spread**2 * both[1])


@dataclass(frozen=True, eq=False)
class Scan:
    """The plots of one look around.

    Attributes
    ----------
    t : float
        Time of the last plot, s.
    sensor : int
        Which sensor.
    z : ndarray, shape (m, 2)
        North and east, m.
    ago : ndarray, shape (m,)
        How long before `t` each plot was stamped, s.
    own : ndarray, shape (2,)
        Where the sensor was, m; NaN where that is not known.
    """

    t: float
    sensor: int
    z: np.ndarray
    ago: np.ndarray
    own: np.ndarray


@dataclass(frozen=True, eq=False)
class Plots:
    """The plots of a log; made by `make_plots`.

    Attributes
    ----------
    scans : sequence of Scan
        In the order of time.
    sensors : sequence of Sensor
        By index.
    frame : str
        Where x and y are counted from.
    origin : tuple of float or None
        Latitude and longitude of the point x = y = 0, deg.
    start : float or None
        Time of day or of 1970 of t = 0, s, where the log says it.
    notes : tuple of Notice
        What was left out or put right.
    """

    scans: Sequence[Scan]
    sensors: Sequence[Sensor]
    frame: str = "the origin of the log"
    origin: tuple[float, float] | None = None
    start: float | None = None
    notes: tuple[Notice, ...] = field(default=())

    def __len__(self) -> int:
        return sum(len(s.z) for s in self.scans)

    def __iter__(self) -> Iterator[Scan]:
        return iter(self.scans)

    @property
    def span(self) -> tuple[float, float]:
        """Time of the first and the last scan, s."""
        return self.scans[0].t, self.scans[-1].t


def make_plots(
    t: np.ndarray,
    x: np.ndarray,
    y: np.ndarray,
    *,
    own: np.ndarray | None = None,
    sensor: np.ndarray | None = None,
    sensors: Sequence[Sensor] = (Sensor(),),
    looks: np.ndarray | None = None,
    looks_sensor: np.ndarray | None = None,
    one_by_one: bool = True,
    frame: str = "the origin of the log",
    origin: tuple[float, float] | None = None,
    start: float | None = None,
) -> Plots:
    """Return plots in scans; duplicates, missing values and echoes of the sensor itself are left out with a note.

    Parameters
    ----------
    t, x, y : ndarray, shape (N,)
        Times in s and positions north and east in m, in any order.
    own : ndarray, shape (N, 2), optional
        Where the sensor was at each plot, NaN where that is not known; the origin by default.
    sensor : ndarray of int, shape (N,), optional
        Which sensor each plot is from; the first by default.
    sensors : sequence of Sensor
        The sensors.
    looks, looks_sensor : ndarray, shape (K,), optional
        Times at which a sensor looked and saw nothing, s, and which sensor.
    one_by_one : bool
        Whether plots may come one after the other as an antenna turns; False takes those of one time as a scan.
    frame, origin, start
        See `Plots`.

    Returns
    -------
    Plots

    Raises
    ------
    EncounterRequestError
        If the arrays are not equally long.
    """
    t, x, y = (np.asarray(a, float).ravel() for a in (t, x, y))
    own = np.zeros((t.size, 2)) if own is None else np.asarray(own, float)
    sensor = np.zeros(t.size, int) if sensor is None else np.asarray(sensor, int)
    if not (t.size == x.size == y.size == sensor.size == len(own)):
        raise EncounterRequestError("times, positions, sensors and own positions of plots have to be equally many.")
    notes = []
    known = np.isfinite(t) & np.isfinite(x) & np.isfinite(y)
    if not known.all():
        notes.append(
            Notice(
                f"{_count(~known)} without a time or a position left out.", "plots-missing", count=int((~known).sum())
            )
        )
    beyond = known & (np.maximum(np.abs(x), np.abs(y)) > _FARTHEST)
    if beyond.any():
        notes.append(
            Notice(
                f"{_count(beyond)} farther than half way round the Earth left out.",
                "plots-beyond",
                count=int(beyond.sum()),
            )
        )
    known &= ~beyond
    strange = known & ((sensor < 0) | (sensor >= len(sensors)))
    if strange.any():
        told = f"{_count(strange)} of a sensor that is not described left out."
        notes.append(Notice(told, "plots-of-no-sensor", count=int(strange.sum())))
    known &= ~strange
    echo = known & (np.hypot(x - own[:, 0], y - own[:, 1]) < _OWN_ECHO)
    if echo.any():
        notes.append(
            Notice(
                f"{_count(echo)} at the position of the sensor itself left out: own ship's echo has no bearing.",
                "plots-at-own-position",
                count=int(echo.sum()),
            )
        )
    notes += _out_of_order(t[known], sensor[known])
    rows = np.flatnonzero(known & ~echo)
    rows = rows[np.lexsort((sensor[rows], t[rows]))]
    table = np.stack([t[rows], x[rows], y[rows], sensor[rows]], axis=1)
    _, first = np.unique(table, axis=0, return_index=True)
    if first.size < rows.size:
        twice = rows.size - first.size
        notes.append(
            Notice(
                f"{twice} plot{'s' * (twice > 1)} that the log holds twice counted once.", "plots-twice", count=twice
            )
        )
        rows = rows[np.sort(first)]
    scans: list[Scan] = []
    for k, one in enumerate(sensors):
        mine = rows[sensor[rows] == k]
        z = np.stack([x[mine], y[mine]], axis=1)
        edges = _scan_starts(t[mine], z - own[mine], one.period, one_by_one)
        for a, b in zip(edges, [*edges[1:], mine.size]):
            last = float(t[mine[b - 1]])
            scans.append(Scan(last, k, z[a:b], last - t[mine[a:b]], own[mine[b - 1]]))
    if looks is not None and looks_sensor is not None:
        ears = np.asarray(looks, float)
        for at, k in zip(ears[np.isfinite(ears)], np.asarray(looks_sensor, int)[np.isfinite(ears)]):
            scans.append(Scan(float(at), int(k), np.zeros((0, 2)), np.zeros(0), np.zeros(2)))
    scans.sort(key=lambda s: (s.t, s.sensor))
    return Plots(tuple(scans), tuple(sensors), frame, origin, start, tuple(notes))


def _out_of_order(t: np.ndarray, sensor: np.ndarray) -> list[Notice]:
    """Plots that come late are put in their place; a clock that begins again lays one time over another."""
    if not (np.diff(t) < 0).any():
        return []
    for k in np.unique(sensor):
        mine = t[sensor == k]
        back = np.flatnonzero(np.diff(mine) < -_LATE)
        # Within a log of several parts each goes on for long; single late plots do not.
        parts = np.split(mine, back + 1)
        if 0 < back.size <= _PARTS and min(np.ptp(part) for part in parts) > _LATE:
            ago = float(mine[back[0]] - mine[back[0] + 1])
            return [
                Notice(
                    f"the clock goes back by {ago:.0f} s within the log: plots that are listed target by target, or a radar or a logger that "
                    "began again. They were sorted; where a clock began again, plots of different times lie over one another, and one ship "
                    "is two tracks: cut the log there.",
                    "clock-goes-back",
                    seconds=ago,
                )
            ]
    return [Notice("the plots are not in the order of time; they were sorted.", "plots-out-of-order")]


def _count(which: np.ndarray) -> str:
    n = int(which.sum())
    return f"{n} plot{'s' * (n > 1)}"


def _scan_starts(t: np.ndarray, away: np.ndarray, period: float | None, one_by_one: bool) -> list[int]:
    """Where a new scan begins: with a new time, or with a new turn of the antenna."""
    if not t.size:
        return []
    if period is None:
        turned = _turns(t, away) if one_by_one and np.isfinite(away).all() else None
        new = np.diff(t) > 0 if turned is None else np.diff(np.floor(turned)) > 0
        return [0, *(np.flatnonzero(new) + 1).tolist()]
    edges = [0]
    # One plot further at least: a period may be lost in the digits of the time.
    while (following := max(int(np.searchsorted(t, t[edges[-1]] + period)), edges[-1] + 1)) < t.size:
        edges.append(following)
    return edges


def _turns(t: np.ndarray, away: np.ndarray) -> np.ndarray | None:
    """How often an antenna has turned at each plot; None where plots do not come one after the other round the horizon.

    A turning antenna goes through the bearings one way, a few at least in a turn. The bearing of one target goes to and fro.
    """
    if t.size < 20 or np.mean(np.diff(t) > 0) < 0.7:
        return None
    steps = np.diff(np.arctan2(away[:, 1], away[:, 0])) % (2 * np.pi)
    backward = steps > 2 * np.pi - _BACKWARD
    # A small step backward is one, and not nearly a whole turn.
    steps[backward] -= 2 * np.pi
    if backward.mean() > _SELDOM or not 0.05 < steps.mean() < 2 * np.pi / 2.5:
        return None
    # A little past the first plot, so that a target that is seen just before it does not begin a turn of her own.
    return np.maximum.accumulate(np.concatenate([[0.0], np.cumsum(steps)])) / (2 * np.pi) + 1e-3
