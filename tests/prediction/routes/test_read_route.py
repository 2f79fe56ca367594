from __future__ import annotations

import pytest

import shipid
from shipid.foundation.errors import MissingFileError, OverwriteError, UsageError
from shipid.prediction.routes.errors import RouteError, RouteFileError, RouteSizeError
from shipid.prediction.routes.read_route import LARGEST
from shipid.prediction.routes.route import Route, Waypoint, route_through


@pytest.fixture
def route():
    return Route("r", (Waypoint((0.9, 0.1), "A"), Waypoint((0.901, 0.1), "B", 500.0)))


@pytest.mark.parametrize("name", ["a.rtz", "a.xml", "a.csv"])
def test_both_formats_are_read_back(route, tmp_path, name):
    path = shipid.write_route(route, tmp_path / name)
    read = shipid.read_route(path)
    assert [w.name for w in read.waypoints] == ["A", "B"] and read.waypoints[1].radius == pytest.approx(500, abs=1e-3)
    with pytest.raises(OverwriteError):
        shipid.write_route(route, path)
    shipid.write_route(route, path, overwrite=True, version="1.0")


def test_content_says_which_format_it_is(route, tmp_path):
    path = shipid.write_route(route, tmp_path / "a.rtz")
    text = path.read_text(encoding="utf-8")
    for name, data in (
        ("u8", b"\xef\xbb\xbf\n" + text.partition("\n")[2].encode()),
        ("u16", text.replace("UTF-8", "UTF-16").encode("utf-16")),
    ):
        (tmp_path / name).write_bytes(data)
        assert len(shipid.read_route(tmp_path / name)) == 2


def test_local_metres_are_no_rtz(tmp_path):
    with pytest.raises(RouteError, match="local metres, and RTZ holds"):
        shipid.write_route(route_through([(0, 0), (1000, 0)]), tmp_path / "a.rtz")


def test_what_cannot_be_written_or_read(route, tmp_path):
    with pytest.raises(UsageError, match=r"end its name in \.rtz or \.csv"):
        shipid.write_route(route, tmp_path / "a.gpx")
    with pytest.raises(UsageError, match="RTZ 3 is not written"):
        shipid.write_route(route, tmp_path / "a.rtz", version="3")
    with pytest.raises(MissingFileError, match="there is no file"):
        shipid.read_route(tmp_path / "none.rtz")
    with pytest.raises(MissingFileError, match="there is no file"):
        shipid.read_route(tmp_path)
    (tmp_path / "big.rtz").write_bytes(b"<route>" + b" " * LARGEST)
    with pytest.raises(RouteSizeError, match="larger than 10 MB"):
        shipid.read_route(tmp_path / "big.rtz")
    (tmp_path / "a.zip").write_bytes(b"PK\x03\x04\0\0\0\0")
    with pytest.raises(RouteFileError, match="neither RTZ nor a text table"):
        shipid.read_route(tmp_path / "a.zip")
