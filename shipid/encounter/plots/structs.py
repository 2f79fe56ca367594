"""True tracks in a MATLAB file: an array of structs, one a ship, with the fields that a format file names."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from shipid.declaration.units import factor
from shipid.encounter.plots.plot_format import PlotFormat, failed
from shipid.trials.logs.tables.files.arrays import Array, Node
from shipid.trials.logs.tables.files.matlab import matlab_arrays
from shipid.trials.logs.tables.opening import opened


def truth_of_structs(file: Path, format_: PlotFormat) -> dict[str, np.ndarray]:
    """Read the true tracks of a MATLAB file.

    Parameters
    ----------
    file : Path
        The file.
    format_ : PlotFormat
        With the fields.

    Returns
    -------
    dict of str to ndarray, shape (N, 3)
        Time in s and north and east in m, or latitude and longitude in rad, by name.

    Raises
    ------
    FormatFileError
        If it holds no such struct.
    """
    keys = format_.truth
    assert keys is not None, "called for a format with a truth only"
    data, _ = opened(file)
    ships = matlab_arrays(data, file).get(keys.struct or "")
    if not isinstance(ships, Mapping):
        raise failed(format_, f"'{file}' holds no array of structs '{keys.struct}'.")
    position = keys.position or keys.lonlat or ""
    found: dict[str, np.ndarray] = {}
    for number, ship in ships.items():
        t = _numbers(ship, keys.time)
        place = _numbers(ship, position)
        if t is None or place is None or place.size != 2 * t.size:
            continue
        place = (
            place.reshape(t.size, 2) * factor(keys.unit, "m") if keys.position else place.reshape(t.size, 2)[:, ::-1]
        )
        place = place if keys.position else np.deg2rad(place)
        name = _text(ship, keys.name) or f"ship {number}"
        # Two ships of one name are two.
        found[name if name not in found else f"{name} ({number})"] = np.column_stack(
            [t.ravel() * factor(keys.time_unit, "s"), place]
        )
    if not found:
        raise failed(format_, f"no struct of '{keys.struct}' in '{file}' holds '{keys.time}' and '{position}'.")
    return found


def _numbers(ship: Node, name: str) -> np.ndarray | None:
    node = ship.get(name) if isinstance(ship, Mapping) else None
    if not isinstance(node, Array) or node.values.dtype.kind not in "fiu" or not node.values.size:
        return None
    return np.asarray(node.values, float)


def _text(ship: Node, name: str | None) -> str:
    """The text of a field, without the signs that AIS fills names up with."""
    node = ship.get(name) if isinstance(ship, Mapping) and name else None
    if not isinstance(node, Array) or node.values.size != 1:
        return ""
    return str(node.values.reshape(-1)[0]).strip(" @\0")
