"""Latitude and longitude of a table: x and y in metres from the first fix."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from shipid.declaration.vocabulary import FIELDS
from shipid.trials import columns
from shipid.trials.errors import ColumnUnitError
from shipid.trials.logs.geodesy import to_local
from shipid.trials.logs.record import LenientRecord

_LATITUDES = ("lat", "latitude", "breite", "breitengrad", "gpslat", "latdeg", "latitudedeg")
_LONGITUDES = ("lon", "lng", "long", "longitude", "laenge", "länge", "längengrad", "gpslon", "londeg", "longitudedeg")
#: More samples beyond the poles than this share, and the column is not what its unit says.
_FEW = 0.1


def pair_of(names: Iterable[str]) -> tuple[str, str] | None:
    """Return which columns are latitude and longitude, or None where there are not both.

    Parameters
    ----------
    names : iterable of str
        Names of the columns, without units.
    """
    by_short = {"".join(c for c in name.lower() if c.isalnum()): name for name in names}
    lat = next((by_short[name] for name in _LATITUDES if name in by_short), None)
    lon = next((by_short[name] for name in _LONGITUDES if name in by_short), None)
    return None if lat is None or lon is None else (lat, lon)


def with_degrees(table: Mapping[str, pd.Series]) -> tuple[dict[str, pd.Series], tuple[str, ...]]:
    """State the unit of latitude and longitude where their header does not and their size leaves no doubt.

    Parameters
    ----------
    table : Mapping of str to pandas.Series
        Columns by header, as numbers.

    Returns
    -------
    table : dict of str to pandas.Series
        With ``[deg]`` in the two headers, where one of them is too large for radians.
    notes : tuple of str
        That this was done.
    """
    pair = pair_of(table)
    if pair is None or any(columns.split_header(name)[1] for name in pair):
        return dict(table), ()
    lat, lon = (
        np.abs(pd.to_numeric(table[name], errors="coerce").to_numpy(dtype=float, na_value=np.nan)) for name in pair
    )
    largest = np.nanmax(lat, initial=0.0), np.nanmax(lon, initial=0.0)
    if largest[0] > 90 or largest[1] > 360 or not (largest[0] > np.pi / 2 or largest[1] > 2 * np.pi):
        return dict(table), ()
    headers = {name: columns.header(name, "deg") for name in pair}
    note = f"'{pair[0]}' and '{pair[1]}' say no unit; they are degrees, because they are too large for radians."
    return {headers.get(name, name): column for name, column in table.items()}, (note,)


def with_positions(record: LenientRecord) -> LenientRecord:
    """Turn latitude and longitude into x and y, metres north and east of the first fix.

    Parameters
    ----------
    record : LenientRecord
        In the units inside a trial.

    Returns
    -------
    LenientRecord
        Unchanged where it has no such pair of angles, or x or y already.

    Raises
    ------
    ColumnUnitError
        If the two cannot be what their units say.
    """
    pair = pair_of(record.values)
    if pair is None or {"x", "y"} & set(record.values):
        return record
    if any(columns.inside_unit(name, record.stated[name]) != FIELDS["psi"].unit for name in pair):
        return record
    lat, lon = (record.values[name] for name in pair)
    there = np.isfinite(lat) & np.isfinite(lon)
    outside = there & ((np.abs(lat) > np.pi / 2) | (np.abs(lon) > 2 * np.pi))
    if outside.sum() > _FEW * max(1, there.sum()):
        k = int(np.flatnonzero(outside)[0])
        raise ColumnUnitError(
            f"{record.where}, row {record.line(k)}: {pair[0]} {np.degrees(lat[k]):.7g} deg, {pair[1]} {np.degrees(lon[k]):.7g} deg is "
            "no place on the earth. Degrees and minutes in one number (dddmm.mmmm) have to be converted; otherwise correct the unit."
        )
    # 0, 0 is what receivers write before they have a fix.
    nowhere = there & (lat == 0) & (lon == 0)
    sound = there & ~outside & ~(nowhere & bool(np.any(there & ~nowhere & (np.hypot(lat, lon) > np.radians(1.0)))))
    notes = [*record.notes]
    values = {name: column for name, column in record.values.items() if name not in pair}
    if not sound.any():
        return replace(record, values=values, notes=(*notes, f"{pair[0]} and {pair[1]} hold no fix and were left out."))
    first = int(np.flatnonzero(sound)[0])
    origin = float(lat[first]), float(lon[first])
    x, y = np.full(len(lat), np.nan), np.full(len(lat), np.nan)
    x[sound], y[sound] = to_local(lat[sound], lon[sound], origin)
    notes.append(
        f"x, y: {pair[0]} and {pair[1]}; metres in the plane that touches the WGS84 ellipsoid at the first fix, latitude "
        f"{np.degrees(origin[0]):.7f}, longitude {np.degrees(origin[1]):.7f}."
    )
    if lost := int((there & ~sound).sum()):
        notes.append(f"x, y: {lost} fixes that are no place of this voyage (0, 0, or beyond the poles) are missing.")
    stated = {**record.stated, "x": "m", "y": "m"}
    source = replace(record.source, origin=origin)
    return replace(record, values={**values, "x": x, "y": y}, stated=stated, notes=tuple(notes), source=source)
