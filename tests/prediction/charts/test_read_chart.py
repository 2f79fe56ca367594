"""Charts out of GeoJSON and S-57: what is drawn, where it lies, and what is refused."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipid.foundation.errors import MissingExtraError, MissingFileError, UsageError
from shipid.prediction.charts import geojson, read_chart, s57
from shipid.prediction.charts.errors import ChartError, ChartFileError, ChartSizeError
from shipid.prediction.charts.read_chart import read_chart as read
from shipid.trials.logs.geodesy import to_local

#: Six features at 53.5 N, 8.1 E, written with GDAL.
CELL = Path(__file__).parent / "cases" / "synthetic.000"
ORIGIN = tuple(np.deg2rad([53.51, 8.11]))
SQUARE = [[8.10, 53.50], [8.12, 53.50], [8.12, 53.51], [8.10, 53.51], [8.10, 53.50]]
HOLE = [[8.105, 53.503], [8.115, 53.503], [8.115, 53.507], [8.105, 53.507], [8.105, 53.503]]


def records_of(data: bytes) -> list[bytes]:
    found, at = [], 0
    while at < len(data):
        found.append(data[at : at + int(data[at : at + 5])])
        at += len(found[-1])
    return found


def deletion(number: bytes = b"1") -> bytes:
    """An update that takes the last feature away, the beacon."""
    head, stated, *_, beacon = records_of(CELL.read_bytes())
    at = int(beacon[12:17]) + 3
    beacon = beacon[: at + 9] + bytes([2, 0, 2]) + beacon[at + 12 :]
    return head + stated.replace(b"\x1f2\x1f0\x1f", b"\x1f2\x1f" + number + b"\x1f") + beacon


def feature(kind: str, points, **properties) -> dict:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": points}, "properties": properties}


def written(folder: Path, features: list | dict, name: str = "chart.geojson") -> Path:
    whole = {"type": "FeatureCollection", "features": features} if isinstance(features, list) else features
    path = folder / name
    path.write_text(json.dumps(whole), encoding="utf-8")
    return path


def local(lon: float, lat: float) -> tuple[float, float]:
    x, y = to_local(*np.deg2rad([lat, lon]), ORIGIN)
    return pytest.approx((float(x), float(y)), abs=0.01)


def test_features_by_number_acronym_and_word(tmp_path):
    chart = read(
        written(
            tmp_path,
            [
                feature("Polygon", [SQUARE, HOLE], OBJL=71),
                feature("MultiPolygon", [[SQUARE], [HOLE]], layer="DEPARE", DRVAL1=-1.5, DRVAL2="5"),
                feature("Polygon", [HOLE], layer="depth area", min_depth=10),
                feature("LineString", SQUARE[:3], objectClass="DEPCNT", VALDCO=5.0),
                feature("MultiLineString", [SQUARE[:2], SQUARE[2:4]], natural="coastline"),
                feature("Point", [8.11, 53.51], OBJL="17", CATLAM=2, BOYSHP=1, COLOUR="4", OBJNAM="A 2"),
                feature("Point", [8.11, 53.52, 3.0], **{"seamark:type": "beacon_cardinal", "seamark:beacon_cardinal:category": "west",
                        "seamark:beacon_cardinal:colour": "yellow;black;yellow", "seamark:name": "Reef"}),
                feature("Point", [8.12, 53.52], layer="LNDARE"),
                feature("Point", [8.12, 53.52], layer="SOUNDG"),
            ],
        ),
        ORIGIN,
    )  # fmt: skip
    assert len(chart.land) == 2 and [len(p) for p in chart.land] == [2, 1]
    assert tuple(chart.land[0][0][1]) == local(*SQUARE[1])
    # The deepest first.
    assert [(a.low, a.high) for a in chart.depth_areas] == [(10.0, None), (-1.5, 5.0), (-1.5, 5.0)]
    assert chart.contours[0].depth == 5.0 and len(chart.coast) == 2
    green, west = chart.buoys
    assert (green.x, green.y) == local(8.11, 53.51)
    assert (green.kind, green.colour, green.shape, green.name, green.structure) == (
        "starboard",
        ("green",),
        "conical",
        "A 2",
        "buoy",
    )
    assert (west.kind, west.quarter, west.structure, west.name) == ("cardinal", "west", "beacon", "Reef")
    assert west.colour == ("yellow", "black", "yellow")
    assert [n.kind for n in chart.notes] == ["chart-not-drawn"]
    assert "1 features of other classes are not drawn: SOUNDG (1)." in chart.notes[0]


def test_what_is_not_understood_is_told(tmp_path):
    found = read(
        written(
            tmp_path,
            [
                feature("Polygon", [SQUARE], layer="DEPARE", shoalest=2.0),
                feature("LineString", SQUARE[:3], layer="DEPARE", DRVAL1=2.0),
                feature("LineString", SQUARE[:3], layer="DEPCNT", VALDCO="deep"),
                feature("Point", [8.11, 53.51], layer="BOYLAT", CATLAM="left"),
                feature("Point", [8.11, 53.52], layer="BOYCAR"),
                {"type": "Feature", "geometry": None, "properties": {"layer": "BOYCAR"}},
                feature("LineString", SQUARE[:1], layer="COALNE"),
                feature("Polygon", [SQUARE[:2]], layer="LNDARE"),
                *[feature("Point", [8.12, 53.52], layer="WRECKS")] * 2,
            ],
        ),
        ORIGIN,
    )
    elsewhere, formless, incomplete = found.notes
    assert "2 features of other classes are not drawn: WRECKS (2)." in elsewhere
    assert formless.kind == "chart-formless" and "DEPARE (1), BOYCAR (1), COALNE (1), LNDARE (1)" in formless
    assert all(f"1 {what}" in incomplete for what in ("depth areas", "contours", "lateral", "cardinal"))


def test_a_chart_as_plain_values(tmp_path):
    chart = read(written(tmp_path, [feature("Polygon", [SQUARE], layer="DEPARE")]), ORIGIN)
    plain = json.loads(json.dumps(chart.to_dict(), allow_nan=False))
    assert plain["depth_areas"][0]["min"] is None and plain["land"] == []
    assert plain["depth_areas"][0]["rings"][0][0] == [
        pytest.approx(c, abs=0.05) for c in chart.depth_areas[0].rings[0][0]
    ]


def test_a_cell_of_s57():
    pytest.importorskip("pyogrio")
    chart = read(CELL, ORIGIN)
    assert [len(p) for p in (chart.land, chart.depth_areas, chart.contours, chart.coast)] == [1, 1, 1, 1]
    assert {tuple(p) for p in np.round(chart.land[0][0], 3).tolist()} == {
        tuple(np.round(to_local(*np.deg2rad([lat, lon]), ORIGIN), 3).tolist()) for lon, lat in SQUARE[:4]
    }
    assert (chart.depth_areas[0].low, chart.depth_areas[0].high, chart.contours[0].depth) == (5.0, 10.0, 10.0)
    east, port = chart.buoys
    assert (east.kind, east.quarter, east.structure, east.name) == ("cardinal", "east", "beacon", "East")
    assert east.colour == ("black", "yellow", "black")
    assert (port.kind, port.colour, port.shape, port.name) == ("port", ("red",), "can", "A 1")


def test_without_the_library_s57_says_what_to_install(monkeypatch):
    monkeypatch.setattr(s57.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match=r"needs pyogrio.*shipid\[chart\].*GeoJSON needs nothing else"):
        read(CELL, ORIGIN)


@pytest.mark.parametrize("end", [2000, 30])
def test_a_damaged_cell(tmp_path, end):
    pytest.importorskip("pyogrio")
    (tmp_path / "a.000").write_bytes(CELL.read_bytes()[:end])
    with pytest.raises(ChartFileError, match="a cell of S-57, is damaged"):
        read(tmp_path / "a.000", ORIGIN)


def test_a_cell_that_only_gdal_finds_damaged(tmp_path):
    pytest.importorskip("pyogrio")
    (tmp_path / "a.000").write_bytes(CELL.read_bytes()[:2200].replace(b"DSID", b"DXID") + CELL.read_bytes()[2200:])
    with pytest.raises(ChartFileError, match=r"damaged cell of S-57\. Check"):
        read(tmp_path / "a.000", ORIGIN)


def test_updates_beside_a_cell(tmp_path):
    pytest.importorskip("pyogrio")
    (tmp_path / "a.000").write_bytes(CELL.read_bytes())
    (tmp_path / "a.001").write_bytes(deletion())
    (tmp_path / "a.003").write_bytes(deletion())
    chart = read(tmp_path / "a.000", ORIGIN)
    assert [b.name for b in chart.buoys] == ["A 1"]
    assert chart.notes[0].kind == "chart-not-updated" and "a.002 is missing" in chart.notes[0]
    (tmp_path / "a.001").write_bytes(deletion()[:-20])
    with pytest.raises(ChartFileError, match=r"a\.001', an update of the cell .* is damaged"):
        read(tmp_path / "a.000", ORIGIN)
    (tmp_path / "a.001").write_bytes(deletion(number=b"7"))
    with pytest.raises(ChartFileError, match="or one of its 1 updates is damaged or not of this edition"):
        read(tmp_path / "a.000", ORIGIN)


def test_a_cell_with_too_much_in_it(monkeypatch):
    pytest.importorskip("pyogrio")
    monkeypatch.setattr(s57, "MOST_FEATURES", 3)
    with pytest.raises(ChartSizeError, match="more than 3 features"):
        read(CELL, ORIGIN)


def test_a_reader_that_does_not_start(monkeypatch):
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    pytest.importorskip("pyogrio")
    with pytest.raises(ChartError, match=r"could not be started \(No such file or directory\)"):
        read(CELL, ORIGIN)


def test_the_edge_of_the_world_in_the_window(tmp_path):
    whole = [[-180, -90], [180, -90], [180, 90], [-180, 90], [-180, -90]]
    lake = [[179.95, 9.99], [179.96, 9.99], [179.96, 10.01], [179.95, 10.01]]
    path = written(tmp_path, [feature("Polygon", [whole, lake], layer="LNDARE")])
    west, east = sorted(read(path, tuple(np.deg2rad([10.0, 179.99])), reach=10e3).land, key=lambda p: p[0][:, 1].min())
    assert np.ptp(west[0][:, 1]) + np.ptp(east[0][:, 1]) == pytest.approx(20e3, rel=0.01)
    assert len(west) == 2 and len(east) == 1


def test_a_ring_is_cut_to_the_window_wherever_it_begins(tmp_path):
    around = [[-180, -85], [180, -85], [180, 85], [-180, 85], [-180, -85]]
    for places in (around, [[p[0] * 0.4, p[1]] for p in around]):
        chart = read(written(tmp_path, [feature("Polygon", [places], layer="LNDARE")]), ORIGIN, reach=1000.0)
        ring = np.array(chart.land[0][0])
        assert np.abs(ring).max() == pytest.approx(1000, rel=0.02) and np.ptp(ring, axis=0) == pytest.approx(
            [2000, 2000], rel=0.02
        )


def test_lines_are_cut_where_they_leave_the_window(tmp_path):
    chart = read(
        written(tmp_path, [feature("LineString", [[8.0, 53.51], [8.2, 53.51], [8.2, 53.512], [8.0, 53.512]], layer="COALNE")]),
        ORIGIN, reach=1000.0,
    )  # fmt: skip
    assert len(chart.coast) == 2
    assert all(np.ptp(line[:, 1]) == pytest.approx(2000, rel=0.01) for line in chart.coast)


@pytest.mark.parametrize("shift", [0.0, 360.0, -360.0])
def test_the_dateline_is_no_edge(tmp_path, shift):
    origin = tuple(np.deg2rad([10.0, 179.99]))
    points = [[179.98 + shift, 10.0], [-179.98 + shift, 10.0]]
    chart = read(
        written(tmp_path, [feature("LineString", points, layer="COALNE"), feature("Point", points[1], layer="BOYSPP")]),
        origin,
    )
    assert np.ptp(chart.coast[0][:, 1]) == pytest.approx(4386, abs=5) and chart.buoys[0].y == pytest.approx(3290, abs=5)


def test_a_chart_of_another_place_says_so(tmp_path):
    chart = read(written(tmp_path, [feature("Polygon", [SQUARE], layer="LNDARE")]), tuple(np.deg2rad([40.0, 8.0])))
    assert chart.empty and chart.notes[0].kind == "chart-elsewhere" and "50 km of latitude 40" in chart.notes[0]


def test_much_is_simplified_and_told(tmp_path, monkeypatch):
    monkeypatch.setattr(read_chart, "_SHOWN", 50)
    angle = np.linspace(0, 2 * np.pi, 2000)
    ring = np.stack([8.11 + 0.01 * np.cos(angle), 53.51 + 0.006 * np.sin(angle)], axis=1).tolist()
    chart = read(written(tmp_path, [feature("Polygon", [ring], layer="LNDARE")]), ORIGIN)
    assert 10 < len(chart.land[0][0]) <= 50 and chart.notes[0].kind == "chart-simplified"
    # Nothing of it has moved farther than the tolerance that is told.
    x, y = chart.land[0][0].T
    size = np.hypot(x / 668, y / 663)
    assert np.abs(size - 1).max() < 0.01
    monkeypatch.setattr(read_chart, "_SHOWN", 1)
    with pytest.raises(ChartSizeError, match="after it was simplified"):
        read(written(tmp_path, [feature("Polygon", [ring], layer="LNDARE")] * 3), ORIGIN)


def collection(*features: dict) -> bytes:
    return json.dumps({"type": "FeatureCollection", "features": features}).encode()


@pytest.mark.parametrize(
    ("data", "error", "says"),
    [
        (b"hello", ChartFileError, "neither GeoJSON nor a cell"),
        (b'{"type": "FeatureCollection", "features": [', ChartFileError, "no complete JSON, line 1"),
        (b'{"a":' * 100_000, ChartFileError, "lists in lists without an end|no complete JSON"),
        (b'{"type": "Topology"}', ChartFileError, "neither a FeatureCollection nor a Feature"),
        (b'{"type": "FeatureCollection", "features": 3}', ChartFileError, "neither a FeatureCollection"),
        (b'{"type": "FeatureCollection", "features": [3]}', ChartFileError, "feature 1 is none"),
        (b'{"type":"Feature","properties":{"x":NaN}}', ChartFileError, "'NaN' is no number"),
        (b'{"type":"Feature","properties":{"x":"\xff"}}', ChartFileError, "no text in UTF-8"),
        (b'{"type":"Feature","crs":{"name":"EPSG:25832"}}', ChartFileError, "reference system"),
        (collection(feature("Circle", [1, 2], OBJL=71)), ChartFileError, "feature 1: its geometry is none"),
        (collection(feature("Point", ["a", 2], OBJL=71)), ChartFileError, "no pair of numbers"),
        (collection(feature("Point", ["8.1", "53.5"], OBJL=71)), ChartFileError, "no pair of numbers"),
        (collection(feature("Point", [None, None], OBJL=71)), ChartFileError, "no pair of numbers"),
        (collection(feature("Point", [True, False], OBJL=71)), ChartFileError, "no pair of numbers"),
        (b'{"type":"Feature","crs":{"name":"EPSG::43260"}}', ChartFileError, "reference system"),
        (collection({"crs": {"name": "EPSG:25832"}}), ChartFileError, "feature 1 states the reference system"),
        (collection(feature("LineString", [[1, 2], [3]], OBJL=71)), ChartFileError, "no pair of numbers"),
        (collection(feature("LineString", [1, 2], OBJL=71)), ChartFileError, "no pair of numbers"),
        (collection(feature("MultiLineString", [1], OBJL=71)), ChartFileError, "its positions are none"),
        (collection(feature("MultiPolygon", [1], OBJL=71)), ChartFileError, "its polygon is none"),
        (collection(feature("Point", [8.1, 1e999], OBJL=71)).replace(b"Infinity", b"1e999"), ChartFileError, "no place on the earth"),
        (collection(feature("Point", [53.5, 91.0], OBJL=71)), ChartFileError, "latitude 91 deg is no place"),
        (collection(feature("Point", [8.1, 53.5], house=1)), ChartFileError, "1 features, and none says what it is"),
        (collection({"geometry": {"type": "GeometryCollection"}, "properties": {"OBJL": 71}}), ChartFileError, "collection of geometries"),
    ],
)  # fmt: skip
def test_what_is_no_chart_is_refused(tmp_path, data, error, says):
    (tmp_path / "a.geojson").write_bytes(data)
    with pytest.raises(error, match=says):
        read(tmp_path / "a.geojson", ORIGIN)


def test_what_is_too_large_is_refused(tmp_path, monkeypatch):
    path = written(tmp_path, [feature("LineString", SQUARE, layer="COALNE")] * 3)
    monkeypatch.setattr(geojson, "MOST_FEATURES", 2)
    with pytest.raises(ChartSizeError, match="has 3 features, and at most 2"):
        read(path, ORIGIN)
    monkeypatch.undo()
    monkeypatch.setattr(geojson, "MOST_POINTS", 10)
    with pytest.raises(ChartSizeError, match="more than 10 points"):
        read(path, ORIGIN)
    monkeypatch.undo()
    monkeypatch.setattr(read_chart, "LARGEST", 100)
    with pytest.raises(ChartSizeError, match="larger than"):
        read(path, ORIGIN)


def test_what_cannot_be_asked_for(tmp_path):
    with pytest.raises(MissingFileError, match="there is no file"):
        read(tmp_path / "none.000", ORIGIN)
    with pytest.raises(UsageError, match="not so near to a pole"):
        read(tmp_path, (1.57, 0.0))
    with pytest.raises(UsageError, match="is none: ask for up to 300 km"):
        read(tmp_path, ORIGIN, reach=1e6)


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-400, 400) | st.floats(-400, 400) | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(["type", "coordinates", "geometries"]), inner, max_size=3),
    max_leaves=12,
)  # fmt: skip


@settings(max_examples=80, deadline=None)
@given(st.sampled_from(["Point", "LineString", "Polygon", "MultiPolygon", "GeometryCollection", "x"]), VALUES, VALUES)
def test_any_feature_is_drawn_or_refused_in_words(tmp_path_factory, kind, coordinates, value):
    data = feature(kind, coordinates, OBJL=71, DRVAL1=value)
    data["geometry"]["geometries"] = coordinates
    path = written(
        tmp_path_factory.mktemp("any"), [data, feature("Point", [8.1, 53.5], OBJL=17, COLOUR=value, OBJNAM=value)]
    )
    try:
        json.dumps(read(path, ORIGIN).to_dict(), allow_nan=False)
    except ChartError as error:
        assert str(path) in str(error)
