from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipid.prediction.routes.errors import RouteError, RouteFileError, RouteSizeError, WaypointError
from shipid.prediction.routes.route import Route, Waypoint
from shipid.prediction.routes.route_table import read_route_table, route_table
from shipid.trials.errors import AmbiguousNumberError, NoUnitError


def read(text: str) -> Route:
    return read_route_table(text.encode(), "'a.csv'", "a")


def degrees(route: Route) -> list[tuple[float, float]]:
    return [(math.degrees(w.position[0]), math.degrees(w.position[1])) for w in route.waypoints]


def test_a_table_with_units():
    route = read(
        "# planned\nname;Latitude [deg];Longitude [deg];radius [nm];xtd_port [m];xtd starboard (NM);geometry;speed [kn];note\n"
        "A;53,5;8,1;;;;;;\nB;53,6;8,1;0,5;100;0,1;great circle;12;x\n"
    )
    second = route.waypoints[1]
    assert degrees(route) == [pytest.approx((53.5, 8.1)), pytest.approx((53.6, 8.1))]
    assert second.name == "B" and second.radius == pytest.approx(926) and second.xtd_port == 100
    assert second.xtd_starboard == pytest.approx(185.2) and second.geometry == "great circle"
    assert second.speed == pytest.approx(12 * 1852 / 3600)
    assert "note" in route.notes[0]


def test_degrees_and_minutes():
    route = read("lat,lon\n53 30.5 N,8°06.25' E\n53-36N,E 008 15\n-0 30,179°59'30\"W\n54.25 N,9.5E\n")
    assert degrees(route) == [
        pytest.approx((53 + 30.5 / 60, 8 + 6.25 / 60)), pytest.approx((53.6, 8.25)),
        pytest.approx((-0.5, -(180 - 0.5 / 60))), pytest.approx((54.25, 9.5)),
    ]  # fmt: skip


def test_degrees_that_say_no_unit_are_told():
    route = read("lat,lon\n53.5,8.1\n53.6,8.1\n")
    assert degrees(route)[0] == pytest.approx((53.5, 8.1)) and "they are degrees" in route.notes[0]


def test_local_metres():
    route = read("x [m],y [km]\n0,0\n1000,2\n")
    assert not route.geographic and route.waypoints[1].position == (1000.0, 2000.0)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.floats(-89, 89), st.floats(-180, 180)), min_size=2, max_size=5), st.booleans(),
    st.text(st.characters(exclude_categories=("Cs", "Cc", "Zs", "Zl", "Zp")), max_size=12), st.none() | st.floats(0.01, 1e5),
)  # fmt: skip
def test_what_is_written_is_read_back(places, geographic, name, size):
    points = tuple(
        Waypoint(tuple(map(math.radians, p)) if geographic else p, name, size, size, None, "great circle", 9.0)
        for p in places
    )
    try:
        route = Route("a", points, geographic)
    except RouteError:
        return  # two points in one place
    again = read(route_table(route))
    assert again.geographic == geographic and [w.name for w in again.waypoints] == [name] * len(route)
    for a, b in zip(route.waypoints, again.waypoints):
        assert a.position == pytest.approx(b.position, abs=1e-10 if geographic else 1e-3)
        assert b.radius == (None if size is None else pytest.approx(size, abs=1e-5))
        assert b.xtd_starboard is None and b.geometry == "great circle" and b.speed == 9.0


@pytest.mark.parametrize(
    ("text", "error", "says"),
    [
        ("a,b\n1,2\n", RouteFileError, "no columns lat and lon, or x and y"),
        ("lat [deg],lon [deg],x [m],y [m]\n1,2,3,4\n", RouteFileError, "both kinds"),
        ("lat [deg],lon [deg],LAT [deg]\n1,2,3\n", RouteFileError, "are both the lat"),
        ("x [m],y [m]\n", RouteFileError, "holds no waypoints"),
        ("x,y [m]\n1,2\n3,4\n", NoUnitError, r"says no unit. Write 'x \[m\]' in the header: shipid"),
        ("x [m],y [kn]\n1,2\n3,4\n", RouteFileError, "kn"),
        ("x [m],y [m]\n1,2\n3,\n", WaypointError, r"line 3: the waypoint has no y \[m\]"),
        ("x [m],y [m]\n1,2\n3,nan\n", WaypointError, "line 3"),
        ("x [m],y [m]\n1,2\n3,inf\n", WaypointError, "'inf' is not a number"),
        ("x [m],y [m]\n1,2\n3,four\n", WaypointError, "line 3: 'four' is not a number"),
        ("x [m],y [m]\n1,2\n1e9,4\n", WaypointError, "no place in local metres"),
        ("x [m],y [m]\n1,2\n1,2,3\n", RouteFileError, "line 3: the row has 3 fields, the header 2"),
        ('x [m],y [m]\n1,2\n"1,2\n', RouteFileError, "line 3: a quote"),
        ("x [m];y [m]\n1,234;2,345\n3,456;4,567\n", AmbiguousNumberError, "nothing tells"),
        ("lat [deg],lon [deg]\n53.5,8\n95,8\n", WaypointError, "no place on the earth"),
        ("lat,lon\n53 61 N,8 00 E\n54 N,8 E\n", WaypointError, "'53 61 N' is no lat"),
        ("lat,lon\n53 30 E,8 00 E\n54 N,8 E\n", WaypointError, "'53 30 E' is no lat"),
        ("lat,lon\nN -53 30,8 00 E\n54 N,8 E\n", WaypointError, "is no lat"),
        ("x [m],y [m],geometry\n1,2,\n3,4,spiral\n", WaypointError, "'spiral' is no geometry"),
        ("x [m],y [m],speed [m/s]\n1,2,\n3,4,-5\n", WaypointError, "the planned speed is -5"),
        ("x [m],y [m]\n1,2\n", RouteError, "one waypoint"),
        ("x [m],y [m]\n" + "1,2\n3,4\n" * 5001, RouteSizeError, "more than 10000"),
        ("x [m],y [m]\n" + "1" * 20_000, RouteFileError, "longer than"),
        ("x\0y\n1,2\n", RouteFileError, "neither RTZ nor a text table"),
        ("x [m],y [m],name\n1,2,a\n3,4," + "b" * 300, WaypointError, "more than 200 characters"),
    ],
)  # fmt: skip
def test_what_cannot_be_a_route_is_refused(text, error, says):
    with pytest.raises(error, match=says):
        read(text)


@settings(max_examples=60, deadline=None)
@given(st.text(st.sampled_from("latlonxy [m]deg,;\n\"'0123456789.-NSEW°"), max_size=200))
def test_any_text_is_read_or_refused_in_words(text):
    try:
        read("lat,lon\n" + text)
    except (RouteError, NoUnitError, AmbiguousNumberError) as error:
        assert "'a.csv'" in str(error)


def test_units_in_the_cells_and_longitudes_that_count_eastward():
    route = read("name,lat,lon,radius\nA,-10 deg,179.96 deg,\nB,-10 deg,180.02 deg,0.5 nm\n")
    assert degrees(route)[1] == pytest.approx((-10, -179.98)) and route.waypoints[1].radius == pytest.approx(926)
    with pytest.raises(WaypointError, match=r"'0\.5 nm' is not a number"):
        read("lat [deg],lon [deg],radius [m]\n53,8,\n53.1,8,0.5 nm\n")
