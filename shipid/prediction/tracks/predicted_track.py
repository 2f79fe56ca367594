"""A predicted track: nodes along the distance sailed, and how far from it the ship may be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.vocabulary import to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import brief
from shipid.foundation.result import DrawnResult
from shipid.foundation.statistics import NORMAL_95
from shipid.prediction.tracks.order import Order

if TYPE_CHECKING:
    import pandas as pd

#: The columns of a track, with the unit of each.
COLUMNS: Mapping[str, str] = {
    "s": "m", "t": "s", "x": "m", "y": "m", "psi": "rad", "r": "rad/s", "u": "m/s", "v": "m/s", "delta": "rad",
}  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class PredictedTrack(DrawnResult):
    """Where a ship goes under an order; N nodes, SI.

    Attributes
    ----------
    s, t : ndarray, shape (N,)
        Distance sailed ahead through the water in m and time in s, both from the beginning of the prediction.
    x, y, psi, r, u, v, delta : ndarray, shape (N,)
        Position north and east in m, heading in rad, rate of turn in rad/s, speeds through the water in m/s, rudder angle in rad.
    order : Order
        What was ordered.
    length : float
        Length of the ship in m.
    limit : float
        Rudder angle in rad beyond which the order was cut; infinite where nothing cuts it.
    covariance : ndarray, shape (N, 2, 2), or None
        Of the position in m^2, of tracks at equal distance sailed; None where no spread was asked for.
    std : mapping of str to ndarray
        Standard deviations of ``psi`` [rad] and ``t`` [s] at equal distance; empty where no spread was asked for.
    current : tuple of float
        To the north and to the east in m/s, as it is contained in the positions.
    ended : str
        Why the track is shorter than was asked for; empty where it is not.
    source : str
        Which model predicted it.
    grown : float
        How many times as large as within the fitted amplitudes the error of the model is taken in the band.
    """

    s: np.ndarray
    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    psi: np.ndarray
    r: np.ndarray
    u: np.ndarray
    v: np.ndarray
    delta: np.ndarray
    order: Order
    length: float
    limit: float = np.inf
    covariance: np.ndarray | None = None
    std: Mapping[str, np.ndarray] = field(default_factory=dict)
    current: tuple[float, float] = (0.0, 0.0)
    ended: str = ""
    source: str = ""
    grown: float = 1.0

    @property
    def s_star(self) -> np.ndarray:
        """Distance sailed in ship lengths, shape (N,)."""
        return self.s / self.length

    @property
    def course(self) -> np.ndarray:
        """Course over the ground along the track in rad, shape (N,)."""
        east, north = self._ground()
        return np.unwrap(np.arctan2(east, north))

    @property
    def normal(self) -> np.ndarray:
        """Unit vectors to starboard of the track over the ground, shape (N, 2)."""
        course = self.course
        return np.stack([-np.sin(course), np.cos(course)], axis=1)

    @property
    def half_width(self) -> np.ndarray | None:
        """Half the width of the 95 % band across the track in m, shape (N,); None without a spread."""
        if self.covariance is None:
            return None
        n = self.normal
        return np.asarray(NORMAL_95 * np.sqrt(np.maximum(np.einsum("ni,nij,nj->n", n, self.covariance, n), 0.0)))

    def _ground(self) -> tuple[np.ndarray, np.ndarray]:
        north = self.u * np.cos(self.psi) - self.v * np.sin(self.psi) + self.current[0]
        east = self.u * np.sin(self.psi) + self.v * np.cos(self.psi) + self.current[1]
        return east, north

    def part(self, begin: int, end: int | None = None) -> PredictedTrack:
        """Return some of the nodes.

        Parameters
        ----------
        begin, end : int
            First node, and the one after the last.
        """
        return self._at(np.arange(self.s.size)[begin:end])

    def every(self, step: int) -> PredictedTrack:
        """Return one node in so many, and the last one.

        Parameters
        ----------
        step : int
            From one node to the next.
        """
        return self._at(np.unique(np.append(np.arange(0, self.s.size, step), self.s.size - 1)))

    def _at(self, nodes: np.ndarray) -> PredictedTrack:
        cut = {n: getattr(self, n)[nodes] for n in COLUMNS}
        spread = None if self.covariance is None else self.covariance[nodes]
        return replace(self, **cut, covariance=spread, std={n: a[nodes] for n, a in self.std.items()})

    def at_time(self, t: float | np.ndarray) -> dict[str, np.ndarray]:
        """Return the columns at given times, by straight lines between the nodes; SI.

        Parameters
        ----------
        t : float or ndarray
            In s from the beginning; beyond the ends of the track not a number.
        """
        return {n: np.interp(t, self.t, getattr(self, n), np.nan, np.nan) for n in COLUMNS}

    def distance_to(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return how far points are from the track, and beside which of its nodes they lie.

        Parameters
        ----------
        x, y : ndarray, shape (M,)
            Positions in m.

        Returns
        -------
        across : ndarray, shape (M,)
            Distance to the nearest point of the track in m, positive to starboard.
        node : ndarray, shape (M,)
            Number of the node, with a fraction.
        """
        points = np.stack([np.atleast_1d(x), np.atleast_1d(y)], axis=1).astype(float)
        begin = np.stack([self.x, self.y], axis=1)
        along = np.diff(begin, axis=0)
        square = np.maximum((along**2).sum(axis=1), 1e-12)
        away = points[:, None, :] - begin[None, :-1]
        share = np.clip((away * along).sum(axis=2) / square, 0.0, 1.0)
        left = away - share[..., None] * along
        gap = (left**2).sum(axis=2)
        nearest = gap.argmin(axis=1)
        rows = np.arange(len(points))
        side = along[nearest, 0] * left[rows, nearest, 1] - along[nearest, 1] * left[rows, nearest, 0]
        return np.sqrt(gap[rows, nearest]) * np.where(side < 0, -1.0, 1.0), nearest + share[rows, nearest]

    def to_frame(self) -> pd.DataFrame:
        """Return the track as a pandas table, one row a node, in the units people read."""
        import pandas as pd

        from shipid.declaration.vocabulary import display_unit

        table = {f"{n} [{display_unit(n, unit)}]": to_display(getattr(self, n), n, unit) for n, unit in COLUMNS.items()}
        width = self.half_width
        if width is not None:
            table["half width of the 95 % band [m]"] = width
        return pd.DataFrame(table)

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON, SI, free of NaN."""
        width = self.half_width
        columns = {n: {"unit": unit, "values": getattr(self, n).tolist()} for n, unit in COLUMNS.items()}
        return {
            "order": self.order.to_dict(),
            "source": self.source,
            "length": {"value": self.length, "unit": "m"},
            "current_north": {"value": self.current[0], "unit": "m/s"},
            "current_east": {"value": self.current[1], "unit": "m/s"},
            "ended": self.ended,
            "track": columns,
            "half_width_95": None if width is None else {"unit": "m", "values": width.tolist()},
            "grown": None if width is None else self.grown,
        }

    def text(self) -> str:
        """Return the result in lines of text."""
        end = f", then {self.ended}" if self.ended else ""
        width = self.half_width
        band = "" if width is None else f", 95 % band {brief(width[-1], 3)} m to each side at its end"
        return f"track predicted by {self.source}: {self.order}; {brief(self.s_star[-1], 3)} ship lengths, {brief(self.t[-1], 3)} s{band}{end}"
