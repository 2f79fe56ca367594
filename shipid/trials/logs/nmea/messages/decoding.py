"""What each NMEA 2000 message carries, by its PGN: where its fields lie, and what a unit of them is.

The fields and units are those of the sentences (`shipid.trials.logs.nmea.sentences.fields`): degrees, knots, degrees a minute.
Positions and factors are those of canboat's description of the messages. The highest values of a field are no numbers
(not available, out of range, reserved): they are missing.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np

_DEG = 180 / pi
_KNOTS = 3600 / 1852
_ANGLE = 1e-4 * _DEG
_SPEED = 0.01 * _KNOTS
_CODES = 3
"""So many of the highest values are no numbers."""

#: Bytes of a batch of messages with one PGN, shape (n, width).
Bytes = np.ndarray


def _integer(data: Bytes, at: int, size: int, signed: bool) -> tuple[np.ndarray, np.ndarray]:
    """Little-endian integers of `size` bytes, and which of them are numbers."""
    raw = np.ascontiguousarray(data[:, at : at + size]).view(f"<{'i' if signed else 'u'}{size}")[:, 0]
    return raw, raw <= np.iinfo(raw.dtype).max - _CODES


def _number(data: Bytes, at: int, size: int, factor: float, signed: bool = False) -> np.ndarray:
    raw, there = _integer(data, at, size, signed)
    return np.where(there, raw * factor, np.nan)


def _bits(data: Bytes, at: int, first: int, count: int) -> np.ndarray:
    return np.asarray((data[:, at] >> first) & ((1 << count) - 1))


def _where(condition: np.ndarray, *columns: np.ndarray) -> tuple[np.ndarray, ...]:
    return tuple(np.where(condition, column, np.nan) for column in columns)


def _system_time(d: Bytes) -> tuple[np.ndarray, ...]:
    return _number(d, 4, 4, 1e-4), _number(d, 2, 2, 1.0)


def _rudder(d: Bytes) -> tuple[np.ndarray, ...]:
    return _number(d, 4, 2, _ANGLE, signed=True), _number(d, 2, 2, _ANGLE, signed=True)


def _heading(d: Bytes) -> tuple[np.ndarray, ...]:
    heading, reference = _number(d, 1, 2, _ANGLE), _bits(d, 7, 0, 2)
    deviation = np.nan_to_num(_number(d, 3, 2, _ANGLE, signed=True))
    true, magnetic = _where(reference == 0, heading) + _where(reference == 1, heading + deviation)
    return true, magnetic, _number(d, 5, 2, _ANGLE, signed=True)


def _rate_of_turn(d: Bytes) -> tuple[np.ndarray, ...]:
    return (_number(d, 1, 4, 3.125e-8 * _DEG * 60, signed=True),)


def _attitude(d: Bytes) -> tuple[np.ndarray, ...]:
    return tuple(_number(d, at, 2, _ANGLE, signed=True) for at in (1, 3, 5))


def _variation(d: Bytes) -> tuple[np.ndarray, ...]:
    return (_number(d, 4, 2, _ANGLE, signed=True),)


def _engine(d: Bytes) -> tuple[np.ndarray, ...]:
    return (_number(d, 1, 2, 0.25),)


def _speed(d: Bytes) -> tuple[np.ndarray, ...]:
    return (_number(d, 1, 2, _SPEED),)


def _position(d: Bytes) -> tuple[np.ndarray, ...]:
    return _number(d, 0, 4, 1e-7, signed=True), _number(d, 4, 4, 1e-7, signed=True)


def _course(d: Bytes) -> tuple[np.ndarray, ...]:
    true = _bits(d, 1, 0, 2) == 0
    return _number(d, 4, 2, _SPEED), *_where(true, _number(d, 2, 2, _ANGLE))


def _fix(d: Bytes) -> tuple[np.ndarray, ...]:
    method = _bits(d, 31, 4, 4)
    fix = (method >= 1) & (method <= 5)  # as the quality of GGA
    place = _where(fix, _number(d, 7, 8, 1e-16, signed=True), _number(d, 15, 8, 1e-16, signed=True))
    return *place, _number(d, 3, 4, 1e-4), _number(d, 1, 2, 1.0), *_where(fix, method.astype(float))


def _wind(d: Bytes) -> tuple[np.ndarray, ...]:
    speed, angle, reference = _number(d, 1, 2, _SPEED), _number(d, 3, 2, _ANGLE), _bits(d, 5, 0, 3)
    apparent, true = _where(reference == 2, angle, speed), _where((reference == 3) | (reference == 4), angle, speed)
    return *apparent, *true, *_where(reference == 0, angle, speed)


#: PGN: bytes that are read, the fields, and the function that takes them from the bytes.
CARRIED: dict[int, tuple[int, tuple[str, ...], Callable[[Bytes], tuple[np.ndarray, ...]]]] = {
    126992: (8, ("utc", "day"), _system_time),
    127245: (8, ("position", "order"), _rudder),
    127250: (8, ("heading", "magnetic", "variation"), _heading),
    127251: (8, ("rate",), _rate_of_turn),
    127257: (8, ("yaw", "pitch", "roll"), _attitude),
    127258: (8, ("variation",), _variation),
    127488: (8, ("rpm",), _engine),
    128259: (8, ("u",), _speed),
    129025: (8, ("lat", "lon"), _position),
    129026: (8, ("sog", "cog"), _course),
    129029: (33, ("lat", "lon", "utc", "day", "quality"), _fix),
    130306: (8, ("angle", "speed", "true_angle", "true_speed", "north_angle", "north_speed"), _wind),
}
#: PGNs with several devices behind one source, told apart by the first byte: rudders and engines.
INSTANCES = (127245, 127488)
#: PGNs that take more than one frame.
FAST_PACKETS = (129029,)


def decoded(pgn: int, data: Bytes) -> np.ndarray:
    """Return the fields of messages, shape (n, k); NaN where they are not available.

    Parameters
    ----------
    pgn : int
        One of `CARRIED`.
    data : ndarray of uint8, shape (n, width)
        Their bytes.
    """
    columns = np.column_stack(CARRIED[pgn][2](data))
    names = CARRIED[pgn][1]
    for name, limit in (("lat", 90.0), ("lon", 180.0)):
        if name in names:
            k = names.index(name)
            columns[np.abs(columns[:, k]) > limit] = np.nan
    return columns
