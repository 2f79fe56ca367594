"""RTZ read and written; what comes from outside may be hostile."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipid.prediction.routes.errors import RouteError, RouteFileError, RouteSizeError, WaypointError
from shipid.prediction.routes.route import Route, Waypoint
from shipid.prediction.routes.rtz import decimal, read_rtz, rtz_text

HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
WHOLE = (
    HEAD
    + """<route version="1.0" xmlns="http://www.cirm.org/RTZ/1/0">
  <routeInfo routeName="Elbe"/>
  <waypoints>
    <defaultWaypoint radius="0.5"><leg portsideXTD="0.1" starboardXTD="0.2" geometryType="Orthodrome"/></defaultWaypoint>
    <waypoint id="7"><position lat="53.5" lon="8.1"/></waypoint>
    <waypoint id="8" name="Buoy 5" radius="0.8"><position lat="53.6" lon="8.1"/><leg portsideXTD="0.05" geometryType="Loxodrome"/></waypoint>
    <waypoint id="9" radius="0"><position lat="53.6" lon="8.3"/></waypoint>
  </waypoints>
  <schedules><schedule id="1">
    <manual><scheduleElement waypointId="7" etd="2026-01-01T00:00:00Z"/></manual>
    <calculated><scheduleElement waypointId="8" speed="10"/><scheduleElement waypointId="9" speed="0"/></calculated>
  </schedule></schedules>
</route>"""
)


def rtz(points: str, version: str = "1.2", head: str = HEAD) -> bytes:
    space = f"http://www.cirm.org/RTZ/{version.replace('.', '/')}"
    return f'{head}<route version="{version}" xmlns="{space}"><waypoints>{points}</waypoints></route>'.encode()


def point(lat="53.5", lon="8.1", more="", inside="") -> str:
    return f'<waypoint id="{lat}{lon}"{more}><position lat="{lat}" lon="{lon}"/>{inside}</waypoint>'


def test_a_leg_belongs_to_the_waypoint_it_leads_to_and_defaults_apply():
    route = read_rtz(WHOLE.encode(), "'a.rtz'")
    first, second, third = route.waypoints
    assert route.name == "Elbe" and second.name == "Buoy 5" and not route.notes
    assert math.degrees(second.position[0]) == pytest.approx(53.6) and math.degrees(third.position[1]) == pytest.approx(
        8.3
    )
    assert (first.radius, second.radius, third.radius) == (926.0, pytest.approx(1481.6), None)
    assert second.xtd_port == pytest.approx(92.6) and second.xtd_starboard == pytest.approx(370.4)
    assert second.geometry == "loxodrome" and third.geometry == "great circle"
    assert third.xtd_port == pytest.approx(185.2)
    assert second.speed == pytest.approx(10 * 1852 / 3600) and third.speed is None


LATITUDES = st.floats(-89.9, 89.9)
SIZES = st.none() | st.floats(0.5, 90e3)
POINTS = st.builds(
    Waypoint,
    position=st.tuples(LATITUDES.map(math.radians), st.floats(-180, 180).map(math.radians)),
    name=st.text(st.characters(exclude_categories=("Cs", "Cc")), max_size=20).map(str.strip),
    radius=SIZES, xtd_port=SIZES, xtd_starboard=SIZES, geometry=st.sampled_from(["loxodrome", "great circle"]),
    speed=st.none() | st.floats(0.01, 50.0),
)  # fmt: skip


def close(first: Waypoint, second: Waypoint) -> bool:
    def near(a, b, size):
        return (a is None) == (b is None) and (a is None or abs(a - b) <= size)

    at = [abs(a - b) for a, b in zip(first.position, second.position)]
    return (
        at[0] < 1e-10 and (at[1] < 1e-10 or abs(at[1] - 2 * math.pi) < 1e-10)
        and first.geometry == second.geometry and near(first.speed, second.speed, 1e-6)
        and all(near(getattr(first, n), getattr(second, n), 1e-3) for n in ("radius", "xtd_port", "xtd_starboard"))
    )  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(st.lists(POINTS, min_size=2, max_size=6), st.sampled_from(["1.0", "1.2"]))
def test_what_is_written_is_read_back(points, version):
    points[0] = Waypoint(points[0].position, points[0].name, points[0].radius)
    try:
        route = Route('from A & <B> to "C"', tuple(points))
    except RouteError:
        return  # two points in one place
    text = rtz_text(route, version)
    assert "e-" not in text.replace("</route>", "").split("<waypoints>")[1].split("name=")[0]
    read = read_rtz(text.encode(), "'a.rtz'")
    assert read.name == route.name and not read.notes and len(read) == len(route)
    assert all(close(a, b) for a, b in zip(route.waypoints, read.waypoints))
    assert [w.name for w in read.waypoints] == [w.name for w in route.waypoints]


@pytest.mark.parametrize(
    ("value", "decimals", "text"),
    [(1e-7, 7, "0.0000001"), (-1e-12, 9, "0"), (1e15, 3, "1000000000000000"), (0.50, 3, "0.5")],
)
def test_decimals_have_no_exponent(value, decimals, text):
    assert decimal(value, decimals) == text


BOMB = (
    '<?xml version="1.0"?><!DOCTYPE route [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]>'
    '<route version="1.2"><waypoints name="&b;"/></route>'
)


@pytest.mark.parametrize(
    ("data", "error", "says"),
    [
        (BOMB, RouteFileError, "document type or an entity"),
        ('<!DOCTYPE route SYSTEM "file:///etc/passwd"><route/>', RouteFileError, "document type"),
        (WHOLE[:400], RouteFileError, r"no complete XML: .*, line \d+"),
        ("<gpx><wpt/></gpx>", RouteFileError, "begins with <gpx>"),
        ('<?xml version="1.0" encoding="x-none"?><route/>', RouteFileError, "encoding|no complete XML"),
        ("<route version='1.2'>" + "<a>" * 60 + "</a>" * 60 + "</route>", RouteFileError, "more than 50"),
        (rtz(point() + point("NaN")), WaypointError, r"waypoint 2: lat is 'NaN', which is no decimal number"),
        (rtz(point() + point("inf")), WaypointError, "'inf'"),
        (rtz(point() + point("53,6")), WaypointError, "'53,6', which is no decimal number"),
        (rtz(point() + point("91")), WaypointError, "latitude 91 deg, .* no place on the earth"),
        (rtz(point() + point(lon="190.5")), WaypointError, "longitude 190.5 deg"),
        (rtz(point() + point("1e999")), WaypointError, "no pair of numbers|no place"),
        (rtz(point() + '<waypoint id="2" name="B"/>'), WaypointError, "waypoint 2 'B' has no position"),
        (rtz(point() + '<waypoint id="2"><position lat="1"/></waypoint>'), WaypointError, "lon is missing"),
        (rtz(point() + point("54", more=' radius="-1"')), WaypointError, "waypoint 2: radius .* not negative"),
        (rtz(point() + point("54", more=' radius="1e5"')), WaypointError, "It lies between 0 and 185200 m"),
        (rtz(point() + point("54", inside='<leg geometryType="Spiral"/>')), WaypointError, "'spiral' is no geometry"),
        (rtz('<defaultWaypoint radius="x"/>' + point()), WaypointError, "default waypoint: radius"),
        (rtz(point()), RouteError, "has one waypoint"),
        (rtz(""), RouteError, "has no waypoint,"),
        (rtz(point() + point()), RouteError, "waypoint 1 and waypoint 2 are one place"),
        (rtz(point(lon="180") + point(lon="-180")), RouteError, "are one place"),
        (rtz("".join(point(str(k / 1000)) for k in range(10_001))), RouteSizeError, "more than 10000 waypoints"),
    ],
)  # fmt: skip
def test_what_cannot_be_a_route_is_refused(data, error, says):
    with pytest.raises(error, match=says):
        read_rtz(data if isinstance(data, bytes) else data.encode(), "'a.rtz'")


def test_what_is_not_read_is_told():
    extension = (
        '<extensions><extension manufacturer="M" name="weather"><position lat="x" lon="y"/></extension></extensions>'
    )
    route = read_rtz(rtz(point(inside=extension) + point("54"), version="2.0"), "'a.rtz'")
    assert [n.kind for n in route.notes] == ["route-version", "route-extensions"]
    assert "weather" in route.notes[1]
    twice = WHOLE.replace('id="9"', 'id="8"')
    assert read_rtz(twice.encode(), "'a.rtz'").notes[0].kind == "route-schedule"


LIMITS = '<leg portXTD="0.05" starboardXTD="0.1" speedMax="7" legInfo="pilot"/>'


def test_a_limit_that_is_misspelt_or_not_heeded_is_told():
    data = rtz(
        point() + point("54", inside=LIMITS) + point("55", more=' turnRadius="0.5"', inside=LIMITS + "<lgg><a/></lgg>")
    )
    route = read_rtz(data, "'a.rtz'")
    assert [n.kind for n in route.notes] == ["route-not-understood", "route-not-heeded"]
    strange, unheeded = route.notes
    assert "portXTD of leg (is portsideXTD meant?) (2 times)" in strange
    assert "turnRadius of waypoint (is radius meant?)" in strange
    assert "element lgg (is leg meant?)" in strange and "element a" not in strange
    assert "speedMax (2 times)" in unheeded and "legInfo" not in unheeded
    assert route.waypoints[1].xtd_port is None and route.waypoints[1].xtd_starboard == pytest.approx(185.2)


def test_a_schedule_in_the_spelling_of_the_first_version():
    old = WHOLE.replace("scheduleElement", "sheduleElement")
    route = read_rtz(old.encode(), "'a.rtz'")
    assert route.waypoints[1].speed == pytest.approx(10 * 1852 / 3600) and not route.notes
    nowhere = read_rtz(old.replace('waypointId="8"', 'waypointId="80"').encode(), "'a.rtz'")
    assert nowhere.notes[0].kind == "route-schedule" and "not there: '80'" in nowhere.notes[0]


def test_a_default_behind_the_waypoints_is_refused():
    with pytest.raises(WaypointError, match="waypoint 1: a default waypoint stands behind it"):
        read_rtz(rtz(point() + '<defaultWaypoint radius="0.5"/>' + point("54")), "'a.rtz'")


@settings(max_examples=100, deadline=None)
@given(st.integers(0, len(WHOLE)), st.integers(0, 60), st.binary(max_size=30))
def test_a_damaged_file_is_read_or_refused_in_words(begin, gone, put):
    data = WHOLE.encode()
    try:
        read_rtz(data[:begin] + put + data[begin + gone :], "'a.rtz'")
    except RouteError as error:
        assert "'a.rtz'" in str(error)


def test_a_waypoint_with_two_positions_is_refused():
    twice = point(inside='<position lat="54" lon="8"/>')
    with pytest.raises(WaypointError, match="waypoint 2 has two positions"):
        read_rtz(rtz(point("53.4") + twice), "'a.rtz'")


def test_longitudes_that_count_eastward_over_the_date_line():
    route = read_rtz(rtz(point("-10", "179.96") + point("-10", "180.02")), "'a.rtz'")
    assert math.degrees(route.waypoints[1].position[1]) == pytest.approx(-179.98)
    with pytest.raises(WaypointError, match="no place on the earth"):
        read_rtz(rtz(point("-10", "179.96") + point("-10", "361")), "'a.rtz'")
