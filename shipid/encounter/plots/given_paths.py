"""Own ship's path and the true tracks, out of files beside a log of plots."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.plots.json_records import truth_of_json
from shipid.encounter.plots.plot_format import PlotFormat, failed
from shipid.encounter.plots.raw_plots import columns_of, file_of
from shipid.encounter.plots.ship_path import ShipPath, path_of
from shipid.encounter.plots.structs import truth_of_structs
from shipid.trials.errors import UnknownColumnError
from shipid.trials.logs.geodesy import to_local
from shipid.trials.logs.positions import pair_of
from shipid.trials.logs.reading import read_record
from shipid.trials.logs.tables.reading import read_table
from shipid.trials.logs.tables.table import record_of

#: Names of the column that tells true ships apart; positions of one ship at one time lie no farther apart than this, m, but for this share.
_SHIP, _ONE_PLACE, _SELDOM = ("ship", "target", "name", "id", "vessel", "mmsi"), 100.0, 0.05


def first_fix(own: str | Path, fmt: PlotFormat | None) -> tuple[float, float] | None:
    """Return latitude and longitude where own ship's file begins, rad; None where it counts in metres.

    Parameters
    ----------
    own : str or Path
        The file.
    fmt : PlotFormat or None
        That of the plots, which may describe it.
    """
    if fmt is not None and fmt.own is not None:
        lonlat = fmt.truth is not None and fmt.truth.lonlat
        fixes = truth_of_structs(file_of(own), fmt).get(fmt.own) if lonlat else None
        return None if fixes is None else (float(fixes[0, 1]), float(fixes[0, 2]))
    fixes = _fixes(own)
    return None if fixes is None else (float(fixes[0, 1]), float(fixes[0, 2]))


def own_heading(own: str | Path | None, t: np.ndarray) -> np.ndarray | None:
    """Return own ship's heading at some times in rad; None where no file is given, or it holds no ``psi``.

    Parameters
    ----------
    own : str, Path or None
        The file.
    t : ndarray, shape (N,)
        On the clock of the file, s.
    """
    if own is None:
        return None
    clock, columns = columns_of(read_record(own))
    psi = columns.get("psi", np.zeros(0))
    known = np.isfinite(psi) & np.isfinite(clock) if psi.size else np.zeros(0, bool)
    if not known.any():
        return None
    order = np.argsort(clock[known], kind="stable")
    return np.asarray(np.interp(t, clock[known][order], np.unwrap(psi[known][order])))


def _fixes(path: str | Path) -> np.ndarray | None:
    """Time, latitude and longitude of a trial, rad; None where it holds none."""
    record = read_record(path)
    t, columns = columns_of(record)
    pair = pair_of(columns)
    if pair is None:
        return None
    found = np.stack([t, columns[pair[0]], columns[pair[1]]], axis=1)
    found = found[np.isfinite(found).all(axis=1)]
    return found if len(found) else None


def own_among(truth: str | Path, fmt: PlotFormat | None) -> str | Path | None:
    """Return the file of the true tracks, where own ship is one of them by the format; else None.

    Parameters
    ----------
    truth : str or Path
        The file.
    fmt : PlotFormat or None
        That of the plots.
    """
    if fmt is None or fmt.own is None or fmt.truth is None:
        return None
    return truth if fmt.own in _true_tables(file_of(truth), fmt) else None


def _true_tables(file: Path, fmt: PlotFormat) -> dict[str, np.ndarray]:
    """Times and positions of the true tracks, own ship's among them, of a file that the format describes."""
    assert fmt.truth is not None, "called for a format with a truth only"
    return truth_of_structs(file, fmt) if fmt.truth.struct else truth_of_json(file, fmt)


def own_path(own: str | Path | None, fmt: PlotFormat | None, origin: tuple[float, float] | None) -> ShipPath | None:
    """Return own ship's path from a file of her own; None where no file is given.

    Parameters
    ----------
    own : str, Path or None
        The file.
    fmt : PlotFormat or None
        That of the plots, which may describe it.
    origin : tuple of float or None
        Latitude and longitude of x = y = 0, rad.

    Raises
    ------
    EncounterRequestError
        If nothing says where the path lies beside the plots, or the file holds several ships.
    UnknownColumnError
        If it holds no positions.
    FormatFileError
        If the format names a ship that it does not hold.
    """
    if own is None:
        return None
    if fmt is not None and fmt.own is not None:
        if fmt.own not in _true_tables(file_of(own), fmt):
            raise failed(fmt, f"'{own}' holds no ship called '{fmt.own}'.")
        return {p.name: p for p in true_paths(file_of(own), replace(fmt, own=None), origin)}[fmt.own]
    record = read_record(own)
    t, columns = columns_of(record)
    pair = pair_of(columns)
    if origin is not None and pair is not None:
        x, y = to_local(columns[pair[0]], columns[pair[1]], origin)
        _one_ship(own, "", t, x, y)
        return path_of("own ship", t, x, y)
    if "x" in columns and "y" in columns:
        if origin is not None:
            raise _apart(own, "positions of own ship")
        _one_ship(own, "", t, columns["x"], columns["y"])
        return path_of("own ship", t, columns["x"], columns["y"])
    raise UnknownColumnError(
        f"'{own}' holds no positions of own ship: it needs x and y, or lat and lon, with their units."
    )


def _one_ship(file: str | Path, whose: str, t: np.ndarray, x: np.ndarray, y: np.ndarray) -> None:
    """Refuse positions of which many of one time lie far apart: those of several ships."""
    order = np.argsort(t, kind="stable")
    together = np.diff(t[order]) == 0
    apart = together & (np.hypot(np.diff(x[order]), np.diff(y[order])) > _ONE_PLACE)
    if apart.sum() > _SELDOM * t.size:
        raise EncounterRequestError(
            f"the positions{whose} in '{file}' are those of several ships: {int(apart.sum())} lie more than {_ONE_PLACE:.0f} m from another "
            f"one of the same time. Tell true ships apart in a column '{_SHIP[0]}'; own ship's file holds her alone."
        )


def _known(origin: tuple[float, float] | None, file: str | Path, what: str) -> tuple[float, float]:
    """The origin, for positions in degrees; without one nothing says where they lie beside the plots."""
    if origin is None:
        raise EncounterRequestError(
            f"the {what} in '{file}' are in latitude and longitude, and the plots count in metres from a place that is not known. "
            "Give own ship's path with lat and lon (--own)."
        )
    return origin


def _apart(file: str | Path, what: str) -> EncounterRequestError:
    """What is said where metres from an origin of their own stand beside degrees."""
    return EncounterRequestError(
        f"the {what} in '{file}' count in metres from an origin of their own, and the plots lie by latitude and longitude: nothing says "
        "where one lies beside the other. Give both in degrees, or both in metres from one origin."
    )


def true_paths(file: Path, fmt: PlotFormat | None, origin: tuple[float, float] | None) -> tuple[ShipPath, ...]:
    """Return the true tracks of a file, without own ship's.

    Parameters
    ----------
    file : Path
        The file.
    fmt : PlotFormat or None
        That of the plots, which may describe it.
    origin : tuple of float or None
        Latitude and longitude of x = y = 0, rad.

    Raises
    ------
    EncounterRequestError
        If nothing says where the tracks lie beside the plots, or which positions are those of one ship.
    UnknownColumnError
        If it holds no positions.
    """
    if fmt is not None and fmt.truth is not None:
        tables = _true_tables(file, fmt)
        if fmt.truth.lonlat:
            start = _known(origin, file, "true tracks")
            tables = {n: np.column_stack([a[:, 0], *to_local(a[:, 1], a[:, 2], start)]) for n, a in tables.items()}
        elif origin is not None:
            raise _apart(file, "true tracks")
        paths = [path_of(n, *a.T) for n, a in tables.items() if n != fmt.own]
        return tuple(p for p in paths if p is not None)
    table = read_table(file)
    record = record_of(table, None)
    t, columns = columns_of(record)
    labels = next((c for h, c in zip(table.headers, table.columns) if h.lower() in _SHIP), None)
    names = np.array(["truth"] * t.size) if labels is None else labels.astype(str).to_numpy()
    pair = pair_of(columns)
    local = "x" in columns and "y" in columns
    if pair is not None and not (local and origin is None):
        x, y = to_local(columns[pair[0]], columns[pair[1]], _known(origin, file, "true tracks"))
    elif local and origin is not None:
        raise _apart(file, "true tracks")
    elif local:
        x, y = columns["x"], columns["y"]
    else:
        raise UnknownColumnError(
            f"'{file}' holds no true positions: it needs x and y, or lat and lon, with their units."
        )
    for n in np.unique(names):
        _one_ship(file, "" if labels is None else f" of '{n}'", t[names == n], x[names == n], y[names == n])
    paths = [path_of(str(n), t[names == n], x[names == n], y[names == n]) for n in np.unique(names)]
    return tuple(p for p in paths if p is not None)
