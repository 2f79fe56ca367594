"""Other ships out of the radar's sentences TTM."""

from __future__ import annotations

import math

from shipid.bridge.core.source import Target

#: Metres, and metres a second, of one unit of distance and of speed: kilometres, nautical miles, statute miles.
_UNITS = {"K": (1000.0, 1000 / 3600), "N": (1852.0, 1852 / 3600), "S": (1609.344, 1609.344 / 3600)}
#: A radar sees no farther than this in m, and no ship is faster than this in m/s.
_FARTHEST, _FASTEST = 200_000.0, 60.0


def target_of(text: str, t: float, heading: float | None) -> Target | None:
    """Return the ship of a TTM sentence; None where it is lost, not valid, or its bearing cannot be known.

    Parameters
    ----------
    text : str
        The sentence up to the checksum: ``$RATTM,01,...``.
    t : float
        When it was heard, in s.
    heading : float or None
        Of the own ship in rad, for what counts from the bow.
    """
    f = text.split(",")
    if len(f) < 13 or f[10] not in _UNITS or f[12] not in ("T", "Q"):
        return None
    distance, bearing = _number(f[2]), _angle(f[3], f[4], heading)
    if not math.isfinite(distance + bearing):
        return None
    metres, speeds = _UNITS[f[10]]
    speed, course = _number(f[5]) * speeds, _angle(f[6], f[7], heading)
    if not 0 < distance * metres < _FARTHEST or speed < 0 or speed > _FASTEST:
        return None
    return Target(f[1][:4], f[11][:20], distance * metres, bearing, course, speed, t)


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        return math.nan
    return value if abs(value) < 1e6 else math.nan


def _angle(text: str, reference: str, heading: float | None) -> float:
    """An angle from north in rad; NaN where it counts from a bow that is not known."""
    value = math.radians(_number(text))
    if reference == "R":
        value += math.nan if heading is None else heading
    elif reference != "T":
        return math.nan
    return value % (2 * math.pi) if math.isfinite(value) else math.nan
