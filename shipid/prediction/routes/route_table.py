"""Routes as CSV: one row a waypoint, units in the header.

    name,lat [deg],lon [deg],radius [m],xtd_port [m],xtd_starboard [m],geometry,speed [kn]

Positions are ``lat`` and ``lon``, in degrees or as degrees and minutes (``53 30.5 N``), or ``x`` and ``y`` in metres. As in RTZ, what a
leg has stands in the row of the waypoint it leads to. A log may have rows above its samples that are no samples, and the reader of
logs passes over them; here every row counts, and one that cannot be read is refused.
"""

from __future__ import annotations

import csv
import difflib
import math
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Literal

import numpy as np
import pandas as pd

from shipid.declaration import units
from shipid.foundation.errors import UnitError
from shipid.foundation.notices import Notice
from shipid.prediction.routes.errors import RouteError, RouteFileError, RouteSizeError, WaypointError
from shipid.prediction.routes.route import MOST_WAYPOINTS, LegGeometry, Route, Waypoint
from shipid.prediction.routes.rtz import decimal
from shipid.prediction.routes.sailings import counted_eastward
from shipid.trials import columns
from shipid.trials.logs.positions import with_degrees
from shipid.trials.logs.tables.cell_units import number_and_unit, same_unit
from shipid.trials.logs.tables.numerals import MISSING, read_numbers, sign_of_file

#: The columns, with the names they go by, and the unit of those that have one.
_NAMES = {
    "name": ("name", "waypoint", "wp", "id"),
    "lat": ("lat", "latitude"),
    "lon": ("lon", "long", "lng", "longitude"),
    "x": ("x", "north"),
    "y": ("y", "east"),
    "radius": ("radius", "turnradius"),
    "xtd_port": ("xtdport", "portxtd", "portsidextd"),
    "xtd_starboard": ("xtdstarboard", "starboardxtd", "stbdxtd", "xtdstbd"),
    "geometry": ("geometry", "geometrytype", "legtype"),
    "speed": ("speed", "plannedspeed"),
}
_UNITS = {"lat": "rad", "lon": "rad", "x": "m", "y": "m", "radius": "m", "xtd_port": "m", "xtd_starboard": "m", "speed": "m/s"}  # fmt: skip
_GEOMETRIES: dict[str, LegGeometry] = {
    "": "loxodrome", "loxodrome": "loxodrome", "rhumb line": "loxodrome", "rl": "loxodrome",
    "great circle": "great circle", "orthodrome": "great circle", "gc": "great circle",
}  # fmt: skip
#: A turn of so many nanometres is none: what navigators write as nm is the nautical mile.
_MILE = re.compile(r"^(nm|NM|n\.?m\.?i?|miles?)$")
_LONGEST_LINE = 10_000
_ANGLE = re.compile(
    r"(?P<before>[NSEW])?\s*(?P<sign>[-+])?\s*(?P<deg>[0-9]{1,3}(?:[.,][0-9]+)?)\s*(?:°|º|deg)?"
    r"(?:[\s-]*(?P<min>[0-9]{1,2}(?:[.,][0-9]+)?)\s*(?:['′’]|min)?(?:\s*(?P<sec>[0-9]{1,2}(?:[.,][0-9]+)?)\s*(?:\"|″|'')?)?)?"
    r"\s*(?P<after>[NSEW])?",
    re.IGNORECASE,
)


def read_route_table(data: bytes, where: str, name: str) -> Route:
    """Read a route.

    Parameters
    ----------
    data : bytes
        The file.
    where : str
        What it is called in messages.
    name : str
        Name of the route.

    Returns
    -------
    Route

    Raises
    ------
    RouteFileError
        If it is no such table.
    RouteSizeError
        If it has too many rows.
    WaypointError, RouteError
        If a waypoint or the route cannot be.
    NoUnitError, ColumnUnitError, AmbiguousNumberError
        If a column says no unit or one of another kind, or its numbers can be read in two ways.
    """
    header, rows, lines = _table(data, where)
    found = _columns(header, where)
    geographic = "lat" in found and "lon" in found
    if not geographic and not ("x" in found and "y" in found):
        raise RouteFileError(
            f"{where} has no columns lat and lon, or x and y: its header is '{', '.join(header)[:80]}'. Write, for example, "
            "name,lat [deg],lon [deg],radius [m]."
        )
    if geographic and ("x" in found or "y" in found):
        raise RouteFileError(f"{where} has columns of both kinds, lat and lon, and x and y: leave out one pair.")
    cells = {n: [row[k].strip() for row in rows] for n, k in found.items()}
    for n in _UNITS.keys() & found:
        cells[n], header[found[n]] = _apart(cells[n], header[found[n]])
    place = ("lat", "lon") if geographic else ("x", "y")
    used = [n for n in _UNITS if n in found and (n in place or n not in ("lat", "lon", "x", "y"))]
    notes: list[str] = []
    angles: dict[str, np.ndarray] = {}
    if geographic and any(_is_angle(c) for n in place for c in cells[n]):
        angles = {n: np.array([_angle(c, n, where, lines[i]) for i, c in enumerate(cells[n])]) for n in place}
    plain = [n for n in used if n not in angles]
    text = {n: pd.Series(cells[n], dtype="str", name=header[found[n]]).replace("", np.nan) for n in plain}
    sign = sign_of_file(list(text.values()), None, where)
    headers = {n: header[found[n]] for n in plain}
    if geographic and not angles:
        numbers = {headers[n]: pd.Series(read_numbers(text[n], sign)[0]) for n in place}
        stated, told = with_degrees(numbers)
        headers |= dict(zip(place, stated))
        notes += told
    values: dict[str, np.ndarray] = {
        n: _numbers(text[n], sign, lines, f"{where}, column '{header[found[n]]}'") * _factor(headers[n], n, where)
        for n in plain
    }
    values |= angles
    for n in place:
        gone = np.flatnonzero(~np.isfinite(values[n]))
        if gone.size:
            raise WaypointError(f"{where}, line {lines[gone[0]]}: the waypoint has no {header[found[n]]}.")

    if geographic:
        values["lon"] = counted_eastward(values["lon"])

    def of(n: str, k: int) -> float | None:
        """What a row states; zero is how tables say that there is none."""
        return None if n not in values or not np.isfinite(values[n][k]) else float(values[n][k]) or None

    points = [
        Waypoint(
            (float(values[place[0]][k]), float(values[place[1]][k])),
            cells["name"][k] if "name" in cells else "",
            of("radius", k),
            of("xtd_port", k),
            of("xtd_starboard", k),
            _geometry(cells["geometry"][k], where, lines[k]) if "geometry" in cells else "loxodrome",
            of("speed", k),
        )
        for k in range(len(rows))
    ]
    lost = [h for i, h in enumerate(header) if h and i not in found.values()]
    if lost:
        known = {form: n for n, forms in _NAMES.items() for form in (*forms, n) if n not in found}
        named = [h + _meant(h, known) for h in lost]
        notes.append(
            Notice(f"columns that no route has were not read: {', '.join(named)[:300]}.", "route-not-understood")
        )
    try:
        return Route(name, tuple(points), geographic, tuple(notes))
    except RouteError as error:
        raise type(error)(f"{where}: {error}") from None


def route_table(route: Route) -> str:
    """Return a route as CSV.

    Parameters
    ----------
    route : Route
        The route.
    """
    geographic = route.geographic
    place = ("lat [deg]", "lon [deg]") if geographic else ("x [m]", "y [m]")
    optional: list[tuple[str, Callable[[Waypoint], float | None]]] = [
        ("radius [m]", lambda w: w.radius),
        ("xtd_port [m]", lambda w: w.xtd_port),
        ("xtd_starboard [m]", lambda w: w.xtd_starboard),
        ("speed [m/s]", lambda w: w.speed),
    ]
    heads = ["name", *place, *(h for h, _ in optional), "geometry"]
    lines = [heads]
    for w in route.waypoints:
        at = [decimal(math.degrees(c), 9) if geographic else decimal(c, 4) for c in w.position]
        sizes = [(g(w)) for _, g in optional]
        lines.append([w.name, *at, *("" if s is None else decimal(s, 6) for s in sizes), w.geometry])
    return "\n".join(",".join(map(_cell, line)) for line in lines) + "\n"


def _cell(text: str) -> str:
    flat = " ".join(text.split())
    return '"' + flat.replace('"', '""') + '"' if any(c in flat for c in ',";#') else flat


def _table(data: bytes, where: str) -> tuple[list[str], list[list[str]], list[int]]:
    """Header, rows and their lines; comments and empty lines left out."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("cp1252", "replace")
    if "\0" in text[:10_000]:
        raise RouteFileError(f"{where} is neither RTZ nor a text table. Export the route as one of them.")
    header: list[str] = []
    rows: list[list[str]] = []
    numbers: list[int] = []
    separator = ","
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        if len(line) > _LONGEST_LINE:
            raise RouteFileError(f"{where}, line {number} is longer than {_LONGEST_LINE} characters: it is no route.")
        if not header:
            separator = max((";", "\t", ","), key=lambda s: line.count(s))
        try:
            cells = next(csv.reader([line], delimiter=separator, strict=True, skipinitialspace=True))
        except csv.Error:
            raise RouteFileError(f"{where}, line {number}: a quote is opened or closed alone.") from None
        if not header:
            header = [c.strip() for c in cells]
            continue
        if len(cells) > len(header) and any(c.strip() for c in cells[len(header) :]):
            raise RouteFileError(
                f"{where}, line {number}: the row has {len(cells)} fields, the header {len(header)}. A decimal comma needs "
                "semicolons between the columns, and a name with a comma needs quotes."
            )
        if len(rows) >= MOST_WAYPOINTS:
            raise RouteSizeError(
                f"{where} has more than {MOST_WAYPOINTS} waypoints, and no more are read. Cut the route into parts."
            )
        rows.append([*cells, *[""] * (len(header) - len(cells))])
        numbers.append(number)
    if not rows:
        raise RouteFileError(f"{where} holds no waypoints. Check that it was copied completely.")
    return header, rows, numbers


def _apart(cells: list[str], head: str) -> tuple[list[str], str]:
    """The cells of a column without the unit behind each number, and its header with it; as they are where that is not one unit."""
    name, stated = columns.split_header(head)
    parts = [number_and_unit(cell) for cell in cells if cell.lower() not in MISSING]
    seen = {part[1] for part in parts if part is not None}
    if None in parts or len(seen) != 1 or (stated is not None and not same_unit(stated, *seen)):
        return cells, head
    bare = [cell if (part := number_and_unit(cell)) is None else part[0] for cell in cells]
    return bare, columns.header(name, *seen)


def _columns(header: Sequence[str], where: str) -> dict[str, int]:
    found: dict[str, int] = {}
    for k, head in enumerate(header):
        short = "".join(c for c in columns.split_header(head)[0].lower() if c.isalnum())
        name = next((n for n, forms in _NAMES.items() if short in forms), None)
        if name is None:
            continue
        if name in found:
            raise RouteFileError(f"{where}: columns '{header[found[name]]}' and '{head}' are both the {name}.")
        found[name] = k
    return found


def _meant(head: str, known: Mapping[str, str]) -> str:
    """The column that a head may mean."""
    near = difflib.get_close_matches(columns.split_header(head)[0].lower()[:40], known, n=1, cutoff=0.75)
    return f" (is {known[near[0]]} meant?)" if near else ""


def _factor(head: str, name: str, where: str) -> float:
    unit = columns.split_header(head)[1]
    if unit is None:
        field = {"lat": "psi", "lon": "psi", "speed": "u"}.get(name, "x")
        raise columns.no_unit(head, f"{where}, ", field, formats=False)
    given = "nautical_mile" if _MILE.match(unit) and _UNITS[name] == "m" else columns.spelt(unit)
    try:
        return units.factor(given, _UNITS[name], f"column '{head}'")
    except UnitError as error:
        raise RouteFileError(f"{where}: {error}") from None


def _numbers(cells: pd.Series, sign: Literal[".", ","], lines: Sequence[int], where: str) -> np.ndarray:
    values, strange = read_numbers(cells, sign)
    strange |= np.isinf(values)
    if strange.any():
        k = int(np.flatnonzero(strange)[0])
        raise WaypointError(f"{where}, line {lines[k]}: '{cells.iloc[k][:40]}' is not a number.")
    return values


def _is_angle(cell: str) -> bool:
    """Whether a cell has degrees and minutes, or a side of the earth."""
    match = _ANGLE.fullmatch(cell)
    return match is not None and any(match[g] for g in ("before", "after", "min"))


def _angle(cell: str, name: str, where: str, line: int) -> float:
    """An angle in rad; NaN where the cell is empty."""
    if cell.lower() in MISSING:
        return math.nan
    match = _ANGLE.fullmatch(cell)
    sides = [s.upper() for s in (match["before"], match["after"]) if s] if match else []
    if (
        match is None
        or len(sides) > 1
        or any(s not in ("NS" if name == "lat" else "EW") for s in sides)
        or (sides and match["sign"])
        or float((match["min"] or "0").replace(",", ".")) >= 60
        or float((match["sec"] or "0").replace(",", ".")) >= 60
        or (match["min"] and not match["deg"].isdigit())
        or (match["sec"] and not match["min"].isdigit())
    ):
        raise WaypointError(
            f"{where}, line {line}: '{cell[:40]}' is no {name}. Write it as in 53 30.5 N or 8°06.25' E."
        )
    deg, minutes, seconds = (float((match[g] or "0").replace(",", ".")) for g in ("deg", "min", "sec"))
    value = math.radians(deg + minutes / 60 + seconds / 3600)
    return -value if match["sign"] == "-" or sides in (["S"], ["W"]) else value


def _geometry(cell: str, where: str, line: int) -> LegGeometry:
    said = " ".join(cell.lower().replace("_", " ").replace("-", " ").split())
    if said not in _GEOMETRIES:
        raise WaypointError(
            f"{where}, line {line}: '{cell[:40]}' is no geometry of a leg: write loxodrome or great circle."
        )
    return _GEOMETRIES[said]
