"""The script that reads S-57, called as a function: geometries and bounds."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from shipid.prediction.charts.s57_apart import Geometries, TooManyPointsError, plain

POINT = struct.pack("<BIdd", 1, 1, 8.0, 53.0)
RING = struct.pack("<I8d", 4, 0, 0, 1, 0, 1, 1, 0, 0)


@pytest.mark.parametrize(
    ("data", "geometry"),
    [
        (POINT, {"type": "Point", "coordinates": [8.0, 53.0]}),
        (struct.pack(">BIddd", 0, 1001, 8.0, 53.0, 2.5), {"type": "Point", "coordinates": [8.0, 53.0]}),
        (struct.pack("<BIddd", 1, 0x80000001, 8.0, 53.0, 2.5), {"type": "Point", "coordinates": [8.0, 53.0]}),
        (struct.pack("<BII4d", 1, 2, 2, 1, 2, 3, 4), {"type": "LineString", "coordinates": [[1, 2], [3, 4]]}),
        (struct.pack("<BII", 1, 3, 1) + RING, {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]}),
        (struct.pack("<BII", 1, 4, 1) + POINT, {"type": "MultiPoint", "coordinates": [[8.0, 53.0]]}),
        (struct.pack("<BII", 1, 7, 1) + POINT, {"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [8.0, 53.0]}]}),
        (struct.pack("<BII", 1, 15, 1) + POINT, None),
    ],
)  # fmt: skip
def test_geometries_of_well_known_binary(data, geometry):
    assert Geometries(100).read(data) == geometry


def test_more_points_than_are_read():
    with pytest.raises(TooManyPointsError):
        Geometries(3).read(struct.pack("<BII", 1, 3, 1) + RING)


def test_attributes_as_json_has_them():
    assert plain(np.float64(np.nan)) is None and plain(np.array(["2", "6"])) == ["2", "6"]
    assert plain(np.int32(3)) == 3 and plain(b"x") is None and plain(None) is None
