"""The verb: read a chart about an origin."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingFileError, UsageError
from shipid.foundation.notices import Notice
from shipid.prediction.charts.chart import Buoy, Chart, Contour, DepthArea, Line, Polygon
from shipid.prediction.charts.errors import ChartFileError, ChartSizeError
from shipid.prediction.charts.geojson import Shape, features_of
from shipid.prediction.charts.meaning import CLASSES, class_stated, depth_of, mark_of, object_class, short_keys
from shipid.prediction.charts.s57 import s57_as_geojson
from shipid.prediction.charts.s57_records import is_s57
from shipid.prediction.charts.window import ChartWindow, simplified

#: Bytes of a file that are read.
LARGEST = 40_000_000
#: Most points that are handed on for a screen; beyond them lines are simplified further.
_SHOWN = 200_000
#: Half the side of the square that stands for a rock, in m; least area of a ring that is seen, in squares of the tolerance.
_ROCK, _SEEN = 5.0, 2.0
_LOW = ("drval1", "mindepth", "depthmin", "min")
_HIGH = ("drval2", "maxdepth", "depthmax", "max")


#: The shapes that a class is drawn with.
_DRAWN_AS = {
    "land": ("point", "line", "polygon"), "depth": ("polygon",), "contour": ("line", "polygon"), "coast": ("line", "polygon"),
    "buoy": ("point",), "beacon": ("point",),
}  # fmt: skip


def read_chart(path: str | Path, origin: tuple[float, float], *, reach: float = 50e3, tolerance: float = 2.0) -> Chart:
    """Read a chart: S-57 (a cell, ``.000``) or GeoJSON, in local metres.

    Parameters
    ----------
    path : str or Path
        The file. S-57 needs the extra ``chart``; updates that lie beside a cell are applied.
    origin : tuple of float
        Latitude and longitude in rad of the place that is (0, 0).
    reach : float
        What lies farther than this to the north, south, east or west of it is left out, in m.
    tolerance : float
        Points of a line nearer to each other than this, in m, become one.

    Returns
    -------
    Chart

    Raises
    ------
    MissingFileError
        If it cannot be opened.
    ChartFileError
        If it is no chart or a damaged one, or nothing in it says what it is.
    ChartSizeError
        If it is larger than 40 MB, or has more features or points than are read.
    MissingExtraError
        If it is S-57 and the library that reads it is not installed.
    UsageError
        If the origin, the reach or the tolerance is none.
    """
    lat, lon = origin
    if not (abs(lat) < np.deg2rad(89.5) and abs(lon) <= 2 * np.pi):
        raise UsageError("a chart is drawn about a latitude and a longitude in rad, not so near to a pole.")
    if not (0 < reach <= 300e3 and 0 < tolerance < reach):
        raise UsageError(f"a chart of {reach:g} m, to {tolerance:g} m, is none: ask for up to 300 km.")
    file = Path(path)
    where = f"'{file}'"
    try:
        if not file.is_file():
            raise MissingFileError(f"there is no file {where}. Check its name.")
        with file.open("rb") as stream:
            data = stream.read(LARGEST + 1)
    except OSError as error:
        raise MissingFileError(f"{where} cannot be read: {error.strerror}. Check the path.") from None
    if len(data) > LARGEST:
        raise ChartSizeError(f"{where} is larger than {LARGEST // 1_000_000} MB. Cut out the area that is sailed.")
    told: list[Notice] = []
    if is_s57(data):
        data, told = s57_as_geojson(file, data, where)
    elif not data[:200].removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"{"):
        raise ChartFileError(f"{where} is neither GeoJSON nor a cell of S-57 (.000). Convert it to GeoJSON.")
    drawn = _Drawn(ChartWindow(origin, reach), tolerance)
    total = 0
    others: Counter[str] = Counter()
    for properties, shapes in features_of(data, where):
        total += 1
        stated = short_keys(properties)
        acronym = object_class(stated)
        if acronym is None:
            others[class_stated(stated) or "no class"] += 1
        else:
            drawn.add(acronym, stated, shapes)
    if total and others.total() == total:
        raise ChartFileError(
            f"{where} has {total} features, and none says what it is: a property 'OBJL' (the number of S-57), 'layer' or 'class' "
            "(DEPARE, LNDARE, DEPCNT, COALNE, BOYLAT, ...) does."
        )
    found = drawn.chart(file.stem, others)
    if found.empty:
        elsewhere = Notice(
            f"nothing of chart {where} lies within {reach / 1000:.0f} km of latitude {np.rad2deg(lat):.4f}, longitude "
            f"{np.rad2deg(lon):.4f} deg.",
            "chart-elsewhere",
        )
        told.append(elsewhere)
    return replace(found, notes=(*found.notes, *told)) if told else found


@dataclass(eq=False)
class _Drawn:
    """What is drawn of the features so far.

    Attributes
    ----------
    window : Window
        What of them is drawn.
    tolerance : float
        Of the lines in m.
    """

    window: ChartWindow
    tolerance: float
    land: list[Polygon] = field(default_factory=list)
    depths: list[DepthArea] = field(default_factory=list)
    contours: list[Contour] = field(default_factory=list)
    coast: list[Line] = field(default_factory=list)
    buoys: list[Buoy] = field(default_factory=list)
    formless: Counter[str] = field(default_factory=Counter)
    sideless: int = 0

    def add(self, acronym: str, stated: Mapping[str, Plain], shapes: Sequence[Shape]) -> None:
        """Add a feature of a class."""
        kind, mark = CLASSES[acronym]
        drawn = _DRAWN_AS[kind]
        self.formless[acronym] += not shapes or any(s.kind not in drawn or _is_too_short(s) for s in shapes)
        for shape in shapes:
            if kind in ("buoy", "beacon"):
                if shape.kind == "point":
                    places = self.window.point(shape.parts[0])
                    marked = mark_of(acronym, stated)
                    self.buoys += [Buoy(float(x), float(y), **marked) for x, y in places]
                    self.sideless += len(places) if mark == "lateral" and marked["kind"] is None else 0
            elif shape.kind == "point":
                if kind == "land":
                    square = _ROCK * np.array([[1, -1], [1, 1], [-1, 1], [-1, -1]])
                    self.land += [(p + square,) for p in self.window.point(shape.parts[0])]
            elif shape.kind == "polygon" and kind in ("land", "depth"):
                self._area(kind, stated, shape)
            elif kind == "contour":
                depth = depth_of(stated, "valdco", "depth")
                self.contours += [Contour(depth, line) for line in self._lines(shape)]
            elif kind in ("coast", "land"):
                self.coast += self._lines(shape)

    def _area(self, kind: str, stated: Mapping[str, Plain], shape: Shape) -> None:
        for rings in self.window.polygons(shape.parts):
            if kind == "land":
                self.land.append(rings)
            else:
                self.depths.append(DepthArea(depth_of(stated, *_LOW), depth_of(stated, *_HIGH), rings))

    def _lines(self, shape: Shape) -> list[Line]:
        return [line for part in shape.parts for line in self.window.lines(part)]

    def chart(self, name: str, others: Counter[str]) -> Chart:
        """Return the chart, its lines simplified until a screen can show them."""
        tolerance = self.tolerance
        whole = Chart(name, self.window.origin, tuple(self.land), tuple(self.depths), tuple(self.contours), tuple(self.coast), tuple(self.buoys))  # fmt: skip
        found = _simplified(whole, tolerance)
        while _points(found) > _SHOWN and tolerance < 500:
            tolerance *= 2
            found = _simplified(whole, tolerance)
        notes = [*_left_out(others, +self.formless), *_silent(found, self.sideless)]
        if tolerance > self.tolerance:
            notes.append(Notice(f"lines are simplified to {tolerance:g} m.", "chart-simplified", tolerance=tolerance))
        if _points(found) > _SHOWN:
            raise ChartSizeError(
                f"chart '{name}' has {_points(found)} points after it was simplified to {tolerance:g} m. Cut out the area that is sailed."
            )
        return replace(found, notes=tuple(notes))


def _is_too_short(shape: Shape) -> bool:
    """Whether a line has no length, or a polygon no area, for want of points."""
    least = {"point": 1, "line": 2, "polygon": 3}[shape.kind]
    return any(len(part) < least for part in shape.parts[: 1 if shape.kind == "polygon" else None])


def _left_out(others: Counter[str], formless: Counter[str]) -> list[Notice]:
    """What is told of features that are not drawn: those of other classes, and those whose geometry their class has not."""
    told = []
    if others:
        told.append(
            Notice(f"{others.total()} features of other classes are not drawn: {_named(others)}.", "chart-not-drawn")
        )
    if formless:
        told.append(
            Notice(
                f"{formless.total()} features have no geometry that their class is drawn with, and are left out wholly or in part: "
                f"{_named(formless)}.",
                "chart-formless",
            )
        )
    return told


def _named(counts: Counter[str]) -> str:
    shown = ", ".join(f"{name} ({n})" for name, n in counts.most_common(6))
    return shown + (f", and {len(counts) - 6} more classes" if len(counts) > 6 else "")


def _silent(chart: Chart, sideless: int) -> list[Notice]:
    """What is told of features that are drawn without what makes them worth drawing."""
    silent = {
        "depth areas state no least depth (DRVAL1)": sum(a.low is None for a in chart.depth_areas),
        "contours state no depth (VALDCO)": sum(c.depth is None for c in chart.contours),
        "lateral marks state no side (CATLAM)": sideless,
        "cardinal marks state no quarter (CATCAM)": sum(
            b.kind == "cardinal" and b.quarter is None for b in chart.buoys
        ),
    }
    counted = [f"{n} {what}" for what, n in silent.items() if n]
    if not counted:
        return []
    return [Notice(f"not understood or not stated, and drawn without: {'; '.join(counted)}.", "chart-incomplete")]


def _simplified(chart: Chart, tolerance: float) -> Chart:
    def polygon(rings: Polygon) -> Polygon:
        """The rings that are seen; none where the outer one is not."""
        outer = _ring(rings[0], tolerance)
        return () if outer is None else (outer, *(h for r in rings[1:] if (h := _ring(r, tolerance)) is not None))

    areas = [replace(a, rings=polygon(a.rings)) for a in chart.depth_areas]
    lines = [replace(c, line=simplified(c.line, tolerance)) for c in chart.contours]
    return replace(
        chart,
        land=tuple(p for rings in chart.land if (p := polygon(rings))),
        # The deepest is drawn first; what says no depth, before all.
        depth_areas=tuple(sorted((a for a in areas if a.rings), key=lambda a: -np.inf if a.low is None else -a.low)),
        contours=tuple(lines),
        coast=tuple(simplified(c, tolerance) for c in chart.coast),
    )


def _ring(ring: Line, tolerance: float) -> Line | None:
    """A ring simplified; None where it is too small to be seen. A rock stays."""
    if len(ring) == 4 and np.ptp(ring, axis=0).max() <= 2 * _ROCK:
        return ring
    less = simplified(ring, tolerance)
    x, y = less.T
    area = 0.5 * abs(float(np.dot(x - x[0], np.roll(y, 1) - np.roll(y, -1))))
    return less if len(less) > 2 and area >= _SEEN * tolerance**2 else None


def _points(chart: Chart) -> int:
    rings = [r for rings in chart.land for r in rings] + [r for a in chart.depth_areas for r in a.rings]
    return sum(map(len, [*rings, *(c.line for c in chart.contours), *chart.coast])) + len(chart.buoys)
