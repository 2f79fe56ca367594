"""A chart in local metres, for looking at: what lies below a track."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.notices import plain_notices
from shipid.foundation.numbers import counted
from shipid.foundation.result import Result

#: A line, shape (N, 2): metres to the north and to the east. A polygon is its outer ring and the rings of its holes.
Line: TypeAlias = np.ndarray
Polygon: TypeAlias = tuple[Line, ...]


@dataclass(frozen=True, eq=False)
class DepthArea:
    """An area between two depths.

    Attributes
    ----------
    low, high : float or None
        Least and greatest depth in m, negative where it dries; None where the chart does not say.
    rings : tuple of ndarray
        The outer ring, and those of its holes.
    """

    low: float | None
    high: float | None
    rings: Polygon


@dataclass(frozen=True, eq=False)
class Contour:
    """A line of one depth.

    Attributes
    ----------
    depth : float or None
        In m; None where the chart does not say.
    line : ndarray, shape (N, 2)
        In m.
    """

    depth: float | None
    line: Line


@dataclass(frozen=True)
class Buoy:
    """A buoy or a beacon.

    Attributes
    ----------
    x, y : float
        To the north and to the east in m.
    kind : str or None
        ``port``, ``starboard``, ``cardinal``, ``isolated``, ``safe``, ``special``; None where the chart does not say which.
    quarter : str or None
        Of a cardinal mark: ``north``, ``east``, ``south``, ``west``.
    structure : str
        ``buoy`` or ``beacon``.
    colour : tuple of str
        From top to bottom; empty where the chart does not say.
    shape : str or None
        Such as ``can``, ``conical``, ``spar``.
    name : str or None
        Its name.
    """

    x: float
    y: float
    kind: str | None = None
    quarter: str | None = None
    structure: str = "buoy"
    colour: tuple[str, ...] = ()
    shape: str | None = None
    name: str | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Chart(Result):
    """Land, depths, coastlines and buoys in local metres about an origin; made by `read_chart`.

    Lines are simplified for a screen. Nothing here says whether a place is safe.

    Attributes
    ----------
    name : str
        Of the chart.
    origin : tuple of float
        Latitude and longitude in rad of the place that is (0, 0).
    land : tuple of polygons
        Each its outer ring and those of its holes.
    depth_areas : tuple of DepthArea
        The deepest first, so that a shoal drawn later is seen.
    contours : tuple of Contour
        Lines of one depth.
    coast : tuple of ndarray
        Coastlines and built shores.
    buoys : tuple of Buoy
        Buoys and beacons.
    notes : tuple of str or Notice
        What was left out, and how much was simplified.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"origin": "rad"}

    name: str
    origin: tuple[float, float]
    land: tuple[Polygon, ...] = ()
    depth_areas: tuple[DepthArea, ...] = ()
    contours: tuple[Contour, ...] = ()
    coast: tuple[Line, ...] = ()
    buoys: tuple[Buoy, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def empty(self) -> bool:
        """Whether nothing of it lies near the origin."""
        return not (self.land or self.depth_areas or self.contours or self.coast or self.buoys)

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON: metres, rounded to 0.1 m; null where the chart does not say."""
        return {
            "name": self.name,
            "origin": {n: {"value": float(np.rad2deg(c)), "unit": "deg"} for n, c in zip(("lat", "lon"), self.origin)},
            "land": [[_points(r) for r in rings] for rings in self.land],
            "depth_areas": [
                {"min": a.low, "max": a.high, "rings": [_points(r) for r in a.rings]} for a in self.depth_areas
            ],
            "contours": [{"depth": c.depth, "line": _points(c.line)} for c in self.contours],
            "coast": [_points(line) for line in self.coast],
            "buoys": [
                {
                    "x": round(b.x, 1),
                    "y": round(b.y, 1),
                    "kind": b.kind,
                    "quarter": b.quarter,
                    "structure": b.structure,
                    "colour": list(b.colour) or None,
                    "shape": b.shape,
                    "name": b.name,
                }
                for b in self.buoys
            ],
            "warnings": plain_notices(self.notes),
        }

    def text(self) -> str:
        """Return the result in lines of text."""
        return (
            f"chart '{self.name}': {counted(len(self.land), 'land area')}, {counted(len(self.depth_areas), 'depth area')}, {counted(len(self.contours), 'contour')}, "
            f"{counted(len(self.coast), 'coastline')}, {counted(len(self.buoys), 'buoy or beacon', 'buoys and beacons')}"
        )


def _points(line: Line) -> list[list[float]]:
    rounded: list[list[float]] = np.round(line, 1).tolist()
    return rounded
