"""Every message: bytes that are packed here by the standard's layout, and what "not available" leaves out."""

import struct

import numpy as np
import pytest

from shipid.trials.logs.nmea.messages.decoding import CARRIED, decoded

NAN = float("nan")


def fields(pgn, *messages):
    width, names, _ = CARRIED[pgn]
    data = b"".join(m[:width] for m in messages)
    values = decoded(pgn, np.frombuffer(data, dtype=np.uint8).reshape(-1, width))
    return {name: column.tolist() for name, column in zip(names, values.T)}


def radians(angle):
    return round(np.radians(angle) * 1e4)


def compare(found, expected):
    for name, values in expected.items():
        # Angles are counted in 0.0001 rad, and a heading is the sum of two.
        np.testing.assert_allclose(found[name], values, rtol=1e-9, atol=0.006, err_msg=name)


def test_heading():
    pack = struct.Struct("<BHhhB").pack
    found = fields(
        127250,
        pack(1, radians(123), 0x7FFF, radians(-2.5), 0xFC),
        pack(1, radians(123), radians(1.5), radians(-2.5), 0xFD),
        pack(1, 0xFFFF, 0x7FFF, 0x7FFF, 0xFC),
        pack(1, radians(123), 0x7FFF, 0x7FFF, 0xFE),  # an error instead of a reference
    )
    compare(
        found,
        {"heading": [123, NAN, NAN, NAN], "magnetic": [NAN, 124.5, NAN, NAN], "variation": [-2.5, -2.5, NAN, NAN]},
    )


@pytest.mark.parametrize("code", [0x7FFFFFFF, 0x7FFFFFFE, 0x7FFFFFFD])
def test_rate_of_turn(code):
    pack = struct.Struct("<BiBH").pack
    found = fields(127251, *(pack(0, rate, 0xFF, 0xFFFF) for rate in (round(np.radians(-0.5) / 3.125e-8), code)))
    compare(found, {"rate": [-30, NAN]})  # degrees a minute, as ROT


def test_rudder():
    pack = struct.Struct("<BBhhH").pack
    found = fields(127245, pack(0, 0xF8, radians(-10), radians(-9.5), 0xFFFF), pack(0, 0xF8, 0x7FFF, 0x7FFF, 0xFFFF))
    compare(found, {"order": [-10, NAN], "position": [-9.5, NAN]})


def test_attitude_and_variation():
    found = fields(127257, struct.pack("<BhhhB", 1, radians(-78), 0x7FFF, radians(-3), 0xFF))
    compare(found, {"yaw": [-78], "pitch": [NAN], "roll": [-3]})
    compare(fields(127258, struct.pack("<BBHhH", 1, 0xF1, 20000, radians(4), 0xFFFF)), {"variation": [4]})


def test_speed_and_engine():
    compare(fields(128259, struct.pack("<BHHBH", 1, 514, 0xFFFF, 0, 0xFFFF)), {"u": [5.14 * 3600 / 1852]})
    compare(fields(128259, struct.pack("<BHHBH", 1, 0xFFFF, 514, 0, 0xFFFF)), {"u": [NAN]})
    compare(fields(127488, struct.pack("<BHHBH", 0, 7200, 0xFFFF, 0, 0xFFFF)), {"rpm": [1800]})


def test_positions():
    found = fields(129025, struct.pack("<ii", 344059678, -1335412083), struct.pack("<ii", 0x7FFFFFFF, 0x7FFFFFFF))
    compare(found, {"lat": [34.4059678, NAN], "lon": [-133.5412083, NAN]})
    np.testing.assert_allclose(found["lon"][0], -133.5412083, rtol=1e-12)
    compare(fields(129025, struct.pack("<ii", 950000000, 0)), {"lat": [NAN]})  # there is no such latitude


@pytest.mark.parametrize(("method", "quality"), [(0, NAN), (1, 1), (2, 2), (4, 4), (6, NAN), (8, NAN)])
def test_a_fix_obeys_its_method(method, quality):
    fix = struct.pack("<BHIqqqBB", 1, 20577, 329000000, 34 * 10**16, -(10**18), 10**6, method << 4, 0xFC)
    there = quality == quality
    found = fields(129029, fix)
    compare(found, {"lat": [34 if there else NAN], "lon": [-100 if there else NAN], "quality": [quality]})
    compare(found, {"utc": [32900], "day": [20577]})


def test_course():
    pack = struct.Struct("<BBHHH").pack
    found = fields(
        129026,
        pack(1, 0xFC, radians(281.6), 319, 0xFFFF),
        pack(1, 0xFD, radians(281.6), 319, 0xFFFF),  # magnetic
        pack(1, 0xFC, 0xFFFF, 0xFFFF, 0xFFFF),
    )
    compare(found, {"cog": [281.6, NAN, NAN], "sog": [3.19 * 3600 / 1852, 3.19 * 3600 / 1852, NAN]})


def test_wind_by_its_reference():
    found = fields(130306, *(struct.pack("<BHHBH", 1, 720, radians(30), ref | 0xF8, 0xFFFF) for ref in range(5)))
    knots = 7.2 * 3600 / 1852
    compare(
        found,
        {
            "angle": [NAN, NAN, 30, NAN, NAN],
            "speed": [NAN, NAN, knots, NAN, NAN],
            "true_angle": [NAN, NAN, NAN, 30, 30],
            "true_speed": [NAN, NAN, NAN, knots, knots],
            "north_angle": [30, NAN, NAN, NAN, NAN],
        },
    )


def test_system_time():
    compare(fields(126992, struct.pack("<BBHI", 1, 0xF0, 20577, 329000000)), {"utc": [32900], "day": [20577]})
