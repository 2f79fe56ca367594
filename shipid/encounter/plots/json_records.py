"""Plots and true tracks in JSON: lists of records, with the keys that a format file names."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from shipid.declaration.units import factor
from shipid.encounter.plots.plot_format import PlotFormat, failed
from shipid.encounter.plots.raw_plots import RawPlots
from shipid.foundation.aliases import Plain
from shipid.trials.errors import DamagedFileError
from shipid.trials.logs.tables.opening import opened


def read_json(file: Path) -> Plain:
    """Return what a JSON file holds.

    Parameters
    ----------
    file : Path
        The file, compressed or not.

    Raises
    ------
    DamagedFileError
        If it is no JSON.
    """
    data, _ = opened(file)
    try:
        return json.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise DamagedFileError(f"'{file}' is no JSON: {error}. Check that it was copied completely.") from None


def plots_of_json(file: Path, format_: PlotFormat) -> RawPlots:
    """Read the plots of a JSON list of records.

    Parameters
    ----------
    file : Path
        The file.
    format_ : PlotFormat
        With the keys.

    Returns
    -------
    RawPlots

    Raises
    ------
    DamagedFileError
        If it is no JSON.
    FormatFileError
        If it is no list of such records.
    """
    keys = format_.records
    assert keys is not None, "called for a format of records only"
    data = read_json(file)
    if not isinstance(data, list):
        raise failed(format_, f"'{file}' is no list of records.")
    t, z, own, sensor, looks, looked = [], [], [], [], [], []
    length, second = factor(keys.unit, "m"), factor(keys.time_unit, "s")
    for number, record in enumerate(data):
        if not isinstance(record, Mapping) or keys.time not in record or keys.position not in record:
            raise failed(format_, f"'{file}', record {number}, has no '{keys.time}' or no '{keys.position}'.")
        which = 0
        if keys.sensor is not None:
            found = format_.values.get(_key(record.get(keys.sensor)))
            if found is None:  # a sensor that the format does not name, such as a camera without range
                continue
            which = found
        try:
            at = float(record[keys.time]) * second
            here = np.asarray(record[keys.own] if keys.own else (0.0, 0.0), float).ravel()[:2] * length
            pairs = _pairs(record[keys.position], keys.layout) * length
        except (TypeError, ValueError, KeyError):
            here = np.zeros(0)
        if here.size != 2:
            raise failed(
                format_, f"'{file}', record {number}: its time, position or own position is no number, or no pair."
            )
        if not len(pairs):
            looks.append(at)
            looked.append(which)
        for pair in pairs:
            t.append(at)
            z.append(pair + here if keys.relative else pair)
            own.append(here)
            sensor.append(which)
    columns = dict(zip("xy", np.array(z, float).reshape(-1, 2).T))
    if keys.own:
        columns |= dict(zip(("own_x", "own_y"), np.array(own, float).reshape(-1, 2).T))
    return RawPlots(
        np.array(t, float),
        columns,
        np.array(sensor, int),
        np.array(looks, float),
        np.array(looked, int),
        one_by_one=False,
    )


def _key(value: Plain) -> Plain:
    return value if isinstance(value, (str, int, float)) else None


def _pairs(value: Plain, layout: str) -> np.ndarray:
    """The plots of a record, one a row; a single pair is one in either layout."""
    found = np.asarray(value, float)
    if not found.size:
        return np.zeros((0, 2))
    if found.ndim == 1:
        found = found[None, :]
    elif layout == "rows":
        found = found.T
    if found.ndim != 2 or found.shape[1] < 2:
        raise ValueError
    return found[:, :2]


def truth_of_json(file: Path, format_: PlotFormat) -> dict[str, np.ndarray]:
    """Read the true tracks of a JSON file: lists, however deep, of records with a time, a position and a name.

    Parameters
    ----------
    file : Path
        The file.
    format_ : PlotFormat
        With the keys.

    Returns
    -------
    dict of str to ndarray, shape (N, 3)
        Time, north and east by name, SI.

    Raises
    ------
    DamagedFileError
        If it is no JSON.
    FormatFileError
        If it holds no such record.
    """
    keys = format_.truth
    assert keys is not None, "called for a format with a truth only"
    length, second = factor(keys.unit, "m"), factor(keys.time_unit, "s")
    found: dict[str, list[tuple[float, float, float]]] = {}
    for record in _leaves(read_json(file)):
        try:
            north, east = (float(v) * length for v in record[keys.position or ""][:2])
            row = float(record[keys.time]) * second, north, east
        except (KeyError, TypeError, ValueError):
            continue
        name = record.get(keys.name) if keys.name else "truth"
        found.setdefault(f"target {name}" if isinstance(name, int) else str(name), []).append(row)
    if not found:
        raise failed(format_, f"'{file}' holds no record with '{keys.time}' and '{keys.position}'.")
    return {name: np.unique(np.array(rows), axis=0) for name, rows in found.items()}


def _leaves(data: Plain) -> Iterator[Mapping[str, Plain]]:
    if isinstance(data, Mapping):
        yield data
    elif isinstance(data, list):
        for part in data:
            yield from _leaves(part)
