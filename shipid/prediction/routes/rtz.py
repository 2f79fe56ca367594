"""Routes as RTZ, the route exchange format of IEC 61174, versions 1.0 to 1.2.

An RTZ file is XML. What a leg has (cross-track limits, geometry) stands at the waypoint it leads to; radii and cross-track limits are
in nautical miles, speeds in knots. A file comes from outside: a document type or an entity is refused before anything is expanded.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from dataclasses import replace
from typing import Literal
from xml.parsers import expat
from xml.sax.saxutils import quoteattr

import numpy as np

from shipid.foundation.notices import Notice
from shipid.prediction.routes.errors import RouteError, RouteFileError, RouteSizeError, WaypointError
from shipid.prediction.routes.route import MOST_WAYPOINTS, LegGeometry, Route, Waypoint
from shipid.prediction.routes.rtz_vocabulary import SCHEDULED, RtzWords
from shipid.prediction.routes.sailings import counted_eastward

#: Versions that are written, with the names of their vocabularies.
Version = Literal["1.0", "1.2"]
_SPACES = {"1.0": "http://www.cirm.org/RTZ/1/0", "1.2": "http://www.cirm.org/RTZ/1/2"}
_READ = ("1.0", "1.1", "1.2")
MILE, KNOT = 1852.0, 1852.0 / 3600
_DEEPEST = 50
_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?")
_GEOMETRIES: dict[str, LegGeometry] = {"loxodrome": "loxodrome", "orthodrome": "great circle"}


def read_rtz(data: bytes, where: str) -> Route:
    """Read a route.

    Parameters
    ----------
    data : bytes
        The file.
    where : str
        What it is called in messages.

    Returns
    -------
    Route

    Raises
    ------
    RouteFileError
        If it is no RTZ, is cut short, or declares a document type or an entity.
    RouteSizeError
        If it has too many waypoints.
    RouteError
        If a waypoint or the route cannot be.
    """
    reader = _Reader(where)
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = reader.begin
    parser.EndElementHandler = reader.end
    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = reader.refuse
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise RouteFileError(
            f"{where} is no complete XML: {expat.ErrorString(error.code)}, line {error.lineno}. Check that it was copied completely."
        ) from None
    except (LookupError, ValueError):
        raise RouteFileError(f"{where} is XML in an encoding that is not read. Export the route in UTF-8.") from None
    return reader.route()


class _Reader:
    """What the elements of a file say, in their order.

    Parameters
    ----------
    where : str
        What the file is called in messages.
    """

    def __init__(self, where: str) -> None:
        self.where = where
        self.path: list[str] = []
        self.name, self.version = "", ""
        self.default = Waypoint((math.nan, math.nan))
        self.points: list[Waypoint] = []
        self.ids: list[str] = []
        self.speeds: list[dict[str, float]] = []
        self.notes: list[str] = []
        self.ignored: Counter[str] = Counter()
        self.words = RtzWords()
        self.strange_from = _DEEPEST + 1

    def refuse(self, *_: object) -> None:
        """Refuse a document type and an entity."""
        raise RouteFileError(
            f"{self.where} declares a document type or an entity, which no route has. It is not read: export the route again."
        )

    def begin(self, name: str, attributes: dict[str, str]) -> None:
        """Take what an element says.

        Parameters
        ----------
        name : str
            Its name, behind that of its vocabulary.
        attributes : dict of str to str
            Its attributes.
        """
        space, _, local = name.rpartition(" ")
        if not self.path:
            self._root(space, local, attributes)
        self.path.append(local)
        if len(self.path) > _DEEPEST:
            raise RouteFileError(f"{self.where} has elements in elements, more than {_DEEPEST}: it is no route.")
        if "extensions" in self.path:
            if self.path[-2] == "extensions":
                self.ignored[attributes.get("name", attributes.get("manufacturer", local))[:40]] += 1
            return
        at = "/".join(self.path[1:])
        if len(self.path) > self.strange_from:
            return
        if not self.words.see(at, attributes):
            self.strange_from = len(self.path)
            return
        if at == "routeInfo":
            self.name = attributes.get("routeName", "").strip()[:200]
        elif at == "waypoints/waypoint":
            self._waypoint(attributes)
        elif at == "waypoints/waypoint/position":
            if not math.isnan(self.points[-1].position[0]):
                raise WaypointError(f"{self._last} has two positions. Leave the wrong one out.")
            place = tuple(math.radians(self._number(attributes, n, None)) for n in ("lat", "lon"))
            self.points[-1] = replace(self.points[-1], position=(place[0], place[1]))
        elif at == "waypoints/waypoint/leg":
            self.points[-1] = self._with_leg(self.points[-1], attributes)
        elif at == "waypoints/defaultWaypoint":
            if self.points:
                raise WaypointError(
                    f"{self._last}: a default waypoint stands behind it, and it holds for what comes after it. Move it to the first place."
                )
            self.default = replace(self.default, radius=self._size(attributes, "radius", None))
        elif at == "waypoints/defaultWaypoint/leg":
            self.default = self._with_leg(self.default, attributes)
        elif at in ("schedules/schedule/manual", "schedules/schedule/calculated"):
            self.speeds.append({})
        elif local in SCHEDULED and "speed" in attributes:
            speed = self._number(attributes, "speed", 0.0) * KNOT
            if speed > 0:
                self.speeds[-1][attributes.get("waypointId", "")] = speed

    def end(self, _: str) -> None:
        """Leave an element."""
        if len(self.path) == self.strange_from:
            self.strange_from = _DEEPEST + 1
        self.path.pop()

    def _root(self, space: str, local: str, attributes: dict[str, str]) -> None:
        if local != "route":
            raise RouteFileError(
                f"{self.where} is XML, and no route: it begins with <{local[:40]}>, an RTZ with <route>."
            )
        self.version = attributes.get("version", "")
        if self.version not in _READ or (space and not space.startswith("http://www.cirm.org/RTZ/")):
            said = self.version[:20] or "none"
            self.notes.append(
                Notice(f"{self.where} states version '{said}'; it is read as RTZ 1.2.", "route-version", version=said)
            )

    def _waypoint(self, attributes: dict[str, str]) -> None:
        if len(self.points) >= MOST_WAYPOINTS:
            raise RouteSizeError(
                f"{self.where} has more than {MOST_WAYPOINTS} waypoints, and no more are read. Cut the route into parts."
            )
        if self.points:
            self._check_position()
        self.ids.append(attributes.get("id", ""))
        # First the waypoint, then its radius: what is wrong with that names this waypoint.
        self.points.append(replace(self.default, name=attributes.get("name", "").strip()[:200]))
        self.points[-1] = replace(self.points[-1], radius=self._size(attributes, "radius", self.default.radius))

    def _check_position(self) -> None:
        if math.isnan(self.points[-1].position[0]):
            raise WaypointError(f"{self._last} has no position: write <position lat=.. lon=..> in it.")

    def _with_leg(self, point: Waypoint, attributes: dict[str, str]) -> Waypoint:
        geometry = point.geometry
        if "geometryType" in attributes:
            said = attributes["geometryType"].strip().lower()
            if said not in _GEOMETRIES:
                raise WaypointError(
                    f"{self._last}: '{said[:40]}' is no geometry of a leg. RTZ knows Loxodrome and Orthodrome."
                )
            geometry = _GEOMETRIES[said]
        return replace(
            point,
            xtd_port=self._size(attributes, "portsideXTD", point.xtd_port),
            xtd_starboard=self._size(attributes, "starboardXTD", point.xtd_starboard),
            geometry=geometry,
        )

    @property
    def _last(self) -> str:
        name = self.points[-1].name[:40] if self.points else ""
        called = f"waypoint {len(self.points)}" + (f" '{name}'" if name else "")
        return f"{self.where}, {called if self.points else 'default waypoint'}"

    def _size(self, attributes: dict[str, str], name: str, otherwise: float | None) -> float | None:
        """A length in nautical miles as m; zero is how programs write that there is none."""
        if name not in attributes:
            return otherwise
        value = self._number(attributes, name, None) * MILE
        if value < 0:
            raise WaypointError(f"{self._last}: {name} is '{attributes[name][:40]}', and a distance is not negative.")
        return value or None

    def _number(self, attributes: dict[str, str], name: str, otherwise: float | None) -> float:
        text = attributes.get(name)
        if text is None and otherwise is not None:
            return otherwise
        if text is None or not _NUMBER.fullmatch(text.strip()):
            said = "is missing" if text is None else f"is '{text[:40]}', which is no decimal number"
            raise WaypointError(f"{self._last}: {name} {said}.")
        return float(text)

    def route(self) -> Route:
        """Return the route that was read."""
        if self.points:
            self._check_position()
        # RTZ counts to both sides of Greenwich; some programs count on over the date line.
        lon = counted_eastward(np.array([w.position[1] for w in self.points]))
        points = [replace(w, position=(w.position[0], east)) for w, east in zip(self.points, lon.tolist())]
        notes = self.notes
        if self.speeds and any(self.speeds):
            if len(set(self.ids)) < len(self.ids):
                notes.append(
                    Notice(
                        "two waypoints have one id: the speeds of the schedule, which name them by it, were left out.",
                        "route-schedule",
                    )
                )
            else:
                # The first schedule that states speeds: what was set by hand comes before what was calculated.
                chosen = next(s for s in self.speeds if s)
                points = [replace(w, speed=chosen.get(i)) for w, i in zip(points, self.ids)]
                nowhere = [i[:40] for i in chosen if i not in self.ids]
                if nowhere:
                    shown = ", ".join(f"'{i}'" for i in nowhere[:5]) + (", ..." if len(nowhere) > 5 else "")
                    notes.append(
                        Notice(
                            f"the schedule states speeds for waypoints that are not there: {shown}. They were left out.",
                            "route-schedule",
                        )
                    )
        if self.ignored:
            shown = ", ".join(sorted(self.ignored)[:5]) + (", ..." if len(self.ignored) > 5 else "")
            notes.append(Notice(f"{sum(self.ignored.values())} extensions were not read: {shown}.", "route-extensions"))
        notes += self.words.notices()
        try:
            return Route(self.name or "route", tuple(points), notes=tuple(notes))
        except RouteError as error:
            raise type(error)(f"{self.where}: {error}") from None


def rtz_text(route: Route, version: Version = "1.2") -> str:
    """Return a route as RTZ.

    Parameters
    ----------
    route : Route
        With latitudes and longitudes.
    version : {"1.0", "1.2"}
        Of the format.

    Returns
    -------
    str

    Raises
    ------
    RouteError
        If its positions are local metres.
    """
    if not route.geographic:
        raise RouteError(
            f"route '{route.name}' has local metres, and RTZ holds latitudes and longitudes: say where (0, 0) is, with "
            "route.on_earth(origin), or write it as CSV."
        )
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<route version="{version}" xmlns="{_SPACES[version]}">',
        f"  <routeInfo routeName={_text(route.name)}/>",
        "  <waypoints>",
    ]
    for k, point in enumerate(route.waypoints, start=1):
        name = f" name={_text(point.name)}" if point.name else ""
        lat, lon = (decimal(math.degrees(c), 9) for c in point.position)
        lines.append(f'    <waypoint id="{k}" revision="0"{name}{_attribute("radius", point.radius, MILE)}>')
        lines.append(f'      <position lat="{lat}" lon="{lon}"/>')
        limits = _attribute("portsideXTD", point.xtd_port, MILE) + _attribute("starboardXTD", point.xtd_starboard, MILE)
        kind = "Loxodrome" if point.geometry == "loxodrome" else "Orthodrome"
        if k > 1:  # no leg leads to the first
            lines.append(f'      <leg{limits} geometryType="{kind}"/>')
        lines.append("    </waypoint>")
    lines.append("  </waypoints>")
    if any(w.speed for w in route.waypoints):
        lines += ["  <schedules>", '    <schedule id="1">', "      <manual>"]
        lines += [
            f'        <scheduleElement waypointId="{k}"{_attribute("speed", w.speed, KNOT)}/>'
            for k, w in enumerate(route.waypoints, start=1)
        ]
        lines += ["      </manual>", "    </schedule>", "  </schedules>"]
    return "\n".join([*lines, "</route>", ""])


def decimal(value: float, decimals: int) -> str:
    """Return a number without an exponent and without zeros at its end.

    Parameters
    ----------
    value : float
        The number.
    decimals : int
        Most decimals.
    """
    text = f"{value:.{decimals}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text


def _attribute(name: str, value: float | None, unit: float) -> str:
    return "" if value is None else f' {name}="{decimal(value / unit, 7)}"'


#: What XML 1.0 cannot hold, even escaped.
_FOREIGN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def _text(text: str) -> str:
    return quoteattr(_FOREIGN.sub("?", text), {"\n": "&#10;", "\r": "&#13;", "\t": "&#9;"})
