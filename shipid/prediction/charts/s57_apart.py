"""Turns a cell of S-57 into GeoJSON in a process of its own: damage can crash GDAL, and only this process ends then.

It is run as a script and imports nothing of shipid. Standard output is an empty line when it begins, and a FeatureCollection, or
``no pyogrio``, ``too large``, ``damaged``.

    python -I s57_apart.py FILE LAYERS FEATURES POINTS SECONDS PATHS

LAYERS are the object classes that are wanted, with commas between them; FEATURES and POINTS bound what is written, SECONDS the
processor time, and PATHS is the list of folders in which packages are found.
"""

from __future__ import annotations

import json
import struct
import sys
from contextlib import suppress
from typing import Any, TypeAlias

#: Memory [bytes]: the interpreter, GDAL, and what it holds of a cell.
_MEMORY = 2_500_000_000
_ATTRIBUTES = ("OBJL", "DRVAL1", "DRVAL2", "VALDCO", "OBJNAM", "COLOUR", "BOYSHP", "BCNSHP", "CATLAM", "CATCAM")
_TYPES = {1: "Point", 2: "LineString", 3: "Polygon", 4: "MultiPoint", 5: "MultiLineString", 6: "MultiPolygon"}
#: A geometry of GeoJSON.
_Geometry: TypeAlias = dict[str, Any]


class TooManyPointsError(Exception):
    """The cell holds more than is read."""


class Geometries:
    """Reads geometries out of well-known binary within bounds.

    Parameters
    ----------
    most : int
        Points of all of them together.
    """

    def __init__(self, most: int) -> None:
        self.left = most

    def read(self, data: bytes) -> _Geometry | None:
        """Return a geometry as GeoJSON has it; None for a kind that no chart needs.

        Parameters
        ----------
        data : bytes
            Well-known binary (OGC 06-103r4), with or without heights.
        """
        geometry, _ = self._read(data, 0, 0)
        return geometry

    def _read(self, data: bytes, at: int, depth: int) -> tuple[_Geometry | None, int]:
        order = "<" if data[at] == 1 else ">"
        (code,) = struct.unpack_from(order + "I", data, at + 1)
        size = 3 if code & 0x80000000 or 1000 <= code & 0xFFFF < 2000 else 2
        kind = (code & 0xFFFF) % 1000
        at += 5
        if kind == 1:
            points, at = self._points(data, at, order, size, 1)
            return {"type": "Point", "coordinates": points[0]}, at
        (count,) = struct.unpack_from(order + "I", data, at)
        at += 4
        if kind == 2:
            points, at = self._points(data, at, order, size, count)
            return {"type": "LineString", "coordinates": points}, at
        if kind == 3:
            rings = []
            for _ in range(count):
                (length,) = struct.unpack_from(order + "I", data, at)
                ring, at = self._points(data, at + 4, order, size, length)
                rings.append(ring)
            return {"type": "Polygon", "coordinates": rings}, at
        if kind not in (4, 5, 6, 7) or depth > 3:
            return None, len(data)
        parts = []
        for _ in range(count):
            part, at = self._read(data, at, depth + 1)
            if part is not None:
                parts.append(part)
        if kind == 7:
            return {"type": "GeometryCollection", "geometries": parts}, at
        return {"type": _TYPES[kind], "coordinates": [p["coordinates"] for p in parts]}, at

    def _points(self, data: bytes, at: int, order: str, size: int, count: int) -> tuple[list[list[float]], int]:
        self.left -= count + 1
        if self.left < 0:
            raise TooManyPointsError
        values = struct.unpack_from(f"{order}{size * count}d", data, at)
        points = [list(values[k : k + 2]) for k in range(0, len(values), size)]
        return points, at + 8 * size * count


def plain(value: object) -> object:
    """Return an attribute as JSON has it.

    Parameters
    ----------
    value : object
        As GDAL gives it.
    """
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float) and value != value:
        return None
    if isinstance(value, (list, tuple)):
        return [str(v) for v in value]
    return value if isinstance(value, (str, int, float)) else None


def collection(file: str, wanted: list[str], most_features: int, most_points: int) -> list[dict[str, Any]]:
    """Return the features of a cell.

    Parameters
    ----------
    file : str
        The cell.
    wanted : list of str
        Object classes.
    most_features, most_points : int
        Bounds.

    Raises
    ------
    TooManyPointsError
        If it holds more.
    """
    from pyogrio import list_layers, raw

    geometries = Geometries(most_points)
    found: list[dict[str, Any]] = []
    there = [str(name) for name, _ in list_layers(file)]
    for layer in (name for name in wanted if name in there):
        meta, _, shapes, columns = raw.read(file, layer=layer, max_features=most_features + 1 - len(found))
        names = [str(n) for n in meta["fields"]]
        kept = {n: c for n, c in zip(names, columns) if n in _ATTRIBUTES}
        for k, shape in enumerate(shapes if shapes is not None else ()):
            if len(found) >= most_features:
                raise TooManyPointsError
            geometry = geometries.read(bytes(shape)) if shape is not None else None
            properties = {n: plain(c[k]) for n, c in kept.items()} | {"layer": layer}
            found.append({"type": "Feature", "geometry": geometry, "properties": properties})
    return found


def bound(seconds: int) -> None:
    """Bound what this process may take, where the system can do so; a crash leaves no copy of the memory on the disk.

    Parameters
    ----------
    seconds : int
        Processor time in s.
    """
    try:
        import resource
    except ImportError:  # Windows
        return
    for kind, most in ((resource.RLIMIT_AS, _MEMORY), (resource.RLIMIT_CPU, seconds), (resource.RLIMIT_CORE, 0)):
        with suppress(ValueError, OSError):  # a lower bound is set already, or the system knows none of this kind
            resource.setrlimit(kind, (most, most))


def main() -> None:
    """Read a cell, and write what it holds."""
    file, wanted, features, points, seconds = sys.argv[1:6]
    sys.stdout.write("\n")
    sys.stdout.flush()
    bound(int(seconds))
    try:
        import pyogrio  # noqa: F401
    except ImportError:
        sys.stdout.write("no pyogrio")
        return
    try:
        found = collection(file, wanted.split(","), int(features), int(points))
        text = json.dumps({"type": "FeatureCollection", "features": found}, allow_nan=False)
    except (TooManyPointsError, MemoryError):
        text = "too large"
    except Exception:  # GDAL reports damage in many ways
        text = "damaged"
    sys.stdout.write(text)
    sys.stdout.flush()


if __name__ == "__main__":
    main()
