"""The features of a GeoJSON text (RFC 7946), bounded and checked."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.prediction.charts.errors import ChartFileError, ChartSizeError

#: Most features, and most points of them together.
MOST_FEATURES, MOST_POINTS = 200_000, 2_000_000
#: Names of the reference system that GeoJSON has.
_WGS84 = re.compile(r"CRS84\b|EPSG:(?:[\d.]*:)?4326\b")
#: Collections of geometries in collections.
_DEEPEST = 4
#: How deep the lists of a geometry's points lie.
_DEPTHS = {"Point": 0, "MultiPoint": 1, "LineString": 1, "MultiLineString": 2, "Polygon": 2, "MultiPolygon": 3}


@dataclass(frozen=True, eq=False)
class Shape:
    """A part of a feature's geometry.

    Attributes
    ----------
    kind : {"point", "line", "polygon"}
        What it is.
    parts : list of ndarray, shape (N, 2)
        Longitude and latitude in rad: points in one array, a line, or the rings of a polygon, the outer one first.
    """

    kind: str
    parts: list[np.ndarray]


def features_of(data: bytes, where: str) -> Iterator[tuple[Mapping[str, Plain], list[Shape]]]:
    """Yield the properties and shapes of each feature.

    Parameters
    ----------
    data : bytes
        The text.
    where : str
        What it is called in messages.

    Yields
    ------
    properties : mapping of str to plain values
    shapes : list of Shape

    Raises
    ------
    ChartFileError
        If it is no GeoJSON, or a position is none.
    ChartSizeError
        If it has more features or points than are read.
    """
    whole = _parsed(data, where)
    features = whole.get("features") if whole.get("type") == "FeatureCollection" else [whole]
    if not isinstance(features, list) or whole.get("type") not in ("FeatureCollection", "Feature"):
        raise ChartFileError(f"{where} is JSON, and no GeoJSON: it holds neither a FeatureCollection nor a Feature.")
    _check_reference(whole, where)
    if len(features) > MOST_FEATURES:
        raise ChartSizeError(
            f"{where} has {len(features)} features, and at most {MOST_FEATURES} are read. Cut out the area that is sailed."
        )
    budget = _Budget(where)
    for number, feature in enumerate(features, start=1):
        if not isinstance(feature, dict):
            raise ChartFileError(f"{where}: feature {number} is none.")
        properties, geometry = feature.get("properties"), feature.get("geometry")
        _check_reference(feature, f"{where}, feature {number}")
        shapes = _shapes(geometry, f"{where}, feature {number}", budget) if isinstance(geometry, dict) else []
        yield (properties if isinstance(properties, dict) else {}), shapes


def _parsed(data: bytes, where: str) -> dict[str, Plain]:
    try:
        whole = json.loads(data.decode("utf-8-sig"), parse_constant=_no_number)
    except UnicodeDecodeError:
        raise ChartFileError(f"{where} is no text in UTF-8.") from None
    except json.JSONDecodeError as error:
        raise ChartFileError(
            f"{where} is no complete JSON, line {error.lineno}: {error.msg}. Check that it was copied completely."
        ) from None
    except (ValueError, RecursionError) as error:
        said = "lists in lists without an end" if isinstance(error, RecursionError) else str(error)[:80]
        raise ChartFileError(f"{where} is no JSON: {said}.") from None
    if not isinstance(whole, dict):
        raise ChartFileError(f"{where} is JSON, and no GeoJSON: it holds neither a FeatureCollection nor a Feature.")
    return whole


def _no_number(text: str) -> float:
    raise ValueError(f"'{text}' is no number of JSON")


def _check_reference(whole: Mapping[str, Plain], where: str) -> None:
    """Refuse coordinates of another system, which the older GeoJSON could state."""
    stated = whole.get("crs")
    if stated is not None:
        said = json.dumps(stated)[:200]
        if not _WGS84.search(said):
            raise ChartFileError(
                f"{where} states the reference system {said[:80]}. A chart has longitude and latitude in degrees (WGS84): convert it."
            )


class _Budget:
    """How many points may still be read.

    Parameters
    ----------
    where : str
        What the file is called in messages.
    """

    def __init__(self, where: str) -> None:
        self.where, self.left = where, MOST_POINTS

    def take(self, count: int) -> None:
        self.left -= count
        if self.left < 0:
            raise ChartSizeError(
                f"{self.where} has more than {MOST_POINTS} points, and no more are read. Cut out the area that is sailed."
            )


def _shapes(geometry: Mapping[str, Plain], where: str, budget: _Budget, depth: int = 0) -> list[Shape]:
    kind = geometry.get("type")
    if kind == "GeometryCollection":
        inner = geometry.get("geometries")
        if not isinstance(inner, list) or depth >= _DEEPEST:
            raise ChartFileError(f"{where}: its collection of geometries is none.")
        budget.take(len(inner))
        return [s for g in inner if isinstance(g, dict) for s in _shapes(g, where, budget, depth + 1)]
    lists = geometry.get("coordinates")
    if not isinstance(kind, str) or kind not in _DEPTHS or not isinstance(lists, list):
        raise ChartFileError(f"{where}: its geometry is none that GeoJSON knows.")
    if not lists:
        return []
    if kind == "Point":
        return [Shape("point", [_points([lists], where, budget)])]
    if kind == "MultiPoint":
        return [Shape("point", [_points(lists, where, budget)])]
    if kind == "LineString":
        return [Shape("line", [_points(lists, where, budget)])]
    if kind == "MultiLineString":
        return [Shape("line", [_points(line, where, budget)]) for line in lists]
    polygons = [lists] if kind == "Polygon" else lists
    found = []
    for rings in polygons:
        if not isinstance(rings, list):
            raise ChartFileError(f"{where}: its polygon is none.")
        if rings:
            found.append(Shape("polygon", [_points(ring, where, budget) for ring in rings]))
    return found


def _points(lists: Plain, where: str, budget: _Budget) -> np.ndarray:
    """Positions as longitude and latitude in rad."""
    if not isinstance(lists, list):
        raise ChartFileError(f"{where}: its positions are none.")
    budget.take(len(lists) + 1)
    try:
        pairs = np.array([(p[0], p[1]) for p in lists]).reshape(-1, 2)
        # A text that looks like a number, true and null are no coordinates.
        wrong_kind = len(pairs) > 0 and pairs.dtype.kind not in "iuf"
    except (TypeError, ValueError, IndexError, KeyError, OverflowError):
        wrong_kind = True
    if wrong_kind:
        raise ChartFileError(f"{where}: one of its positions is no pair of numbers.")
    points = pairs.astype(float)
    wrong = ~(np.isfinite(points).all(axis=1) & (np.abs(points[:, 1]) <= 90.0) & (np.abs(points[:, 0]) <= 540.0))
    if wrong.any():
        lon, lat = points[int(np.argmax(wrong))]
        raise ChartFileError(
            f"{where}: longitude {lon:.7g}, latitude {lat:.7g} deg is no place on the earth. GeoJSON writes the longitude first."
        )
    return np.asarray(np.deg2rad(points))
