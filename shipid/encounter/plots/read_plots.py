"""Read the plots of a log, own ship's path and the true tracks, and put them into one frame and one clock."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.plots.column_doubts import DAY, doubts, midnights, possible
from shipid.encounter.plots.json_records import plots_of_json, truth_of_json
from shipid.encounter.plots.plot_format import PlotFormat, failed, read_plot_format
from shipid.encounter.plots.plots import Plots, Sensor, make_plots
from shipid.encounter.plots.raw_plots import RawPlots
from shipid.encounter.plots.sentences import holds_plots, plots_of_sentences
from shipid.encounter.plots.ship_path import ShipPath, path_of
from shipid.encounter.plots.structs import truth_of_structs
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingFileError
from shipid.foundation.notices import notice_of
from shipid.trials import columns as spelling
from shipid.trials.errors import ClockError, EmptyFileError, ForeignFileError, NoUnitError, UnknownColumnError
from shipid.trials.logs.geodesy import to_local
from shipid.trials.logs.nmea.opening import is_nmea
from shipid.trials.logs.positions import pair_of
from shipid.trials.logs.reading import read_record
from shipid.trials.logs.record import LenientRecord
from shipid.trials.logs.tables.reading import read_table
from shipid.trials.logs.tables.table import record_of

#: How far before and after own ship's path she is taken to lie where it begins and ends, s.
_BEYOND = 5.0
#: What a column may be called.
_NAMES = {
    "range": ("range", "distance", "rng", "dist"),
    "bearing": ("bearing", "azimuth", "brg"),
    "x": ("x", "north", "n"),
    "y": ("y", "east", "e"),
}
_OWN = {
    "own_x": ("own_x", "own_north"),
    "own_y": ("own_y", "own_east"),
    "own_lat": ("own_lat",),
    "own_lon": ("own_lon",),
}


@dataclass(frozen=True, eq=False)
class Detections:
    """What is known of an encounter; made by `read_detections`.

    Attributes
    ----------
    name : str
        Of the log.
    plots : Plots
        What the sensors saw.
    own : ShipPath or None
        Own ship.
    relative : bool
        Whether positions count from own ship, whose own path is not known.
    truth : tuple of ShipPath
        The true tracks, where they are known.
    """

    name: str
    plots: Plots
    own: ShipPath | None = None
    relative: bool = False
    truth: tuple[ShipPath, ...] = ()


def read_detections(
    path: str | Path,
    *,
    format: str | Path | PlotFormat | None = None,
    own: str | Path | None = None,
    truth: str | Path | None = None,
    sensors: Sequence[Sensor] = (),
    sensor_values: Mapping[str, float] | None = None,
) -> Detections:
    """Read the plots of a log, with own ship and the truth where they are given.

    Parameters
    ----------
    path : str or Path
        A table with ``t`` and ``range``, ``bearing`` or ``x``, ``y`` or ``lat``, ``lon`` (any kind of file that a trial may be);
        a log of NMEA 0183 with TTM or AIS; JSON or a MATLAB file that a format file describes.
    format : str, Path or PlotFormat, optional
        See `shipid.encounter.plots.plot_format`.
    own : str or Path, optional
        Own ship's path: a trial with x and y, or latitude and longitude.
    truth : str or Path, optional
        The true tracks: a table with ``t``, a position and a column ``ship``, or a file that the format describes.
    sensors : sequence of Sensor, optional
        Instead of what the file says of its sensors.
    sensor_values : mapping of str to float, optional
        What else is known of every sensor, by the attributes of `Sensor`, SI; an accuracy of positions replaces those of range
        and bearing.

    Returns
    -------
    Detections

    Raises
    ------
    MissingFileError
        If a file is not there.
    EmptyFileError
        If there is no plot.
    ForeignFileError
        If it is a file of another kind, such as JSON without a format.
    UnknownColumnError
        If a table lacks a column.
    FormatFileError
        If the format file does not fit.
    EncounterRequestError
        If own ship's path and the plots have no time in common, or nothing says where own ship or the true tracks lie beside the plots.
    """
    fmt = read_plot_format(format) if isinstance(format, (str, Path)) else format
    file = _file(path)
    raw = possible(_raw(file, fmt))
    origin = _origin(raw)
    if own is None and truth is not None and "own_x" not in raw.columns and "own_lat" not in raw.columns:
        own = _own_among(truth, fmt)
    if origin is None and own is not None:
        origin = _first_fix(own, fmt)
    begin = _begin(raw.t, raw.looks)
    paths = _own_paths(own, fmt, origin)
    ship = paths if paths is not None else _own_in(raw, origin)
    relative = ship is None and "range" in raw.columns
    x, y, here, frame = _placed(raw, origin, ship)
    known = sensors or (fmt.sensors if fmt else ()) or raw.sensors or (Sensor(),)
    if sensor_values:
        values: dict[str, Plain] = dict(sensor_values)
        if "position_std" in values:
            values |= {"range_std": None, "bearing_std": None}
        known = tuple(replace(s, **values) for s in known)
    plots = make_plots(
        raw.t - begin, x, y, own=here, sensor=raw.sensor, sensors=known, looks=raw.looks - begin,
        looks_sensor=raw.looks_sensor, one_by_one=raw.one_by_one, frame=frame, origin=None if origin is None else tuple(np.rad2deg(origin).tolist()),
        start=begin,
    )  # fmt: skip
    if not len(plots):
        why = "".join(f" {note[:1].upper()}{note[1:]}" for note in (*raw.notes, *plots.notes))
        raise EmptyFileError(f"'{file}' holds no plot with a time and a position.{why}")
    found = tuple(_shifted(p, begin) for p in (_truth(_file(truth), fmt, origin) if truth is not None else ()))
    ship = None if ship is None else _shifted(ship, begin)
    if ship is not None and not ship.covers(np.array([s.t for s in plots])).any():
        raise EncounterRequestError(
            f"the path of own ship runs from {ship.t[0]:.6g} to {ship.t[-1]:.6g} s after the first plot, and no plot lies in it. "
            "Give own ship by the clock of the plots."
        )
    plots = replace(plots, notes=(*(notice_of(n) for n in raw.notes), *plots.notes))
    return Detections(file.stem, plots, ship, relative, found)


def _file(path: str | Path) -> Path:
    file = Path(path)
    if not file.is_file():
        what = "is a folder" if file.is_dir() else "is not there"
        raise MissingFileError(f"'{file}' {what}. Name a log of plots.")
    if not file.stat().st_size:
        raise EmptyFileError(f"'{file}' is empty (0 bytes). Check that the log was written and copied completely.")
    return file


def _begin(t: np.ndarray, looks: np.ndarray) -> float:
    both = np.concatenate([t, looks])
    return float(np.nanmin(both)) if np.isfinite(both).any() else 0.0


def _shifted(path: ShipPath, begin: float) -> ShipPath:
    return replace(path, t=path.t - begin)


def _raw(file: Path, fmt: PlotFormat | None) -> RawPlots:
    if fmt is not None and fmt.records is not None:
        return plots_of_json(file, fmt)
    if fmt is None and (is_nmea(file) or (file.suffix.lower() in (".nmea", ".ais") and holds_plots(file))):
        return plots_of_sentences(file)
    if fmt is None and file.suffix.lower() == ".json":
        raise ForeignFileError(
            f"'{file}' is a JSON file, and nothing says which of its keys are times and positions. Describe them in a format file "
            "(--format), as studies/formats/autoferry.toml does."
        )
    table = read_table(file, fmt.table if fmt else None)
    record = record_of(table, fmt.table if fmt else None)
    t, columns = _columns(record)
    found = {k: v for k, v in ((k, _named(columns, n)) for k, n in (_NAMES | _OWN).items()) if v is not None}
    pair = pair_of(columns)
    if not {"range", "bearing"} <= set(found) and not {"x", "y"} <= set(found):
        if pair is None:
            raise UnknownColumnError(
                f"{record.where} holds no positions of targets: it needs range and bearing, x and y, or lat and lon, "
                f"each with its unit, and has {', '.join(columns)}."
            )
        found |= {"lat": columns[pair[0]], "lon": columns[pair[1]]}
    sensor = np.zeros(t.size, int)
    if fmt is not None and len(fmt.sensors) > 1:
        if "sensor" not in columns:
            raise failed(fmt, f"{record.where} has no column 'sensor' that tells its {len(fmt.sensors)} sensors apart.")
        # 2.0 and 2 are one key; a plot of a sensor that the format does not name is left out, as one without a time.
        sensor = np.array([fmt.values.get(v, -1) for v in columns["sensor"]], int)
        t = np.where(sensor >= 0, t, np.nan)
    said = doubts(record.values, found, len(fmt.sensors) if fmt else 0)
    return RawPlots(t, found, sensor, notes=(*(record.notes if fmt is None else ()), *said))


def _columns(record: LenientRecord) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Times that count from where the log's clock does, and the columns, SI."""
    for fault in record.faults:
        # A trial may not have a time that stands still, nor a column without a unit; plots may, where it is not theirs.
        if not isinstance(fault, (ClockError, NoUnitError)):
            raise fault
    pair = pair_of(record.values) or ()
    known = {"t", *pair, *(n for names in (_NAMES | _OWN).values() for n in names)}
    bare = next((n for n in record.values if n not in record.stated and (n in pair or n.lower() in known)), None)
    if bare is not None:
        raise spelling.no_unit(bare, f"{record.where}, ")
    values = {
        name: column * spelling.to_inside(name, record.stated[name], f"{record.where}: ")
        for name, column in record.values.items()
        if name in record.stated
    }
    t = values.get("t", record.values["t"])
    t = t + DAY * midnights(t)
    if record.source.start:
        moment = datetime.fromisoformat(record.source.start)
        t = t + (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
    return t, values


def _named(columns: dict[str, np.ndarray], names: Sequence[str]) -> np.ndarray | None:
    lowered = {name.lower(): values for name, values in columns.items()}
    return next((lowered[name] for name in names if name in lowered), None)


def _origin(raw: RawPlots) -> tuple[float, float] | None:
    """Latitude and longitude of the first position, rad."""
    for lat, lon in (("own_lat", "own_lon"), ("lat", "lon")):
        if lat in raw.columns and lon in raw.columns:
            known = np.isfinite(raw.columns[lat]) & np.isfinite(raw.columns[lon])
            if known.any():
                k = int(known.argmax())
                return float(raw.columns[lat][k]), float(raw.columns[lon][k])
    return None


def _own_in(raw: RawPlots, origin: tuple[float, float] | None) -> ShipPath | None:
    """Own ship as the plots themselves tell it."""
    columns = raw.columns
    if "own_x" in columns and "own_y" in columns:
        return path_of("own ship", raw.t, columns["own_x"], columns["own_y"])
    if origin is not None and "own_lat" in columns and "own_lon" in columns:
        return path_of("own ship", raw.t, *to_local(columns["own_lat"], columns["own_lon"], origin))
    return None


def _placed(
    raw: RawPlots, origin: tuple[float, float] | None, own: ShipPath | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray, str]:
    """Positions in one frame, where the sensor was, and what the frame is."""
    columns = raw.columns
    # Ranges count from own ship. Of positions in a frame of their own, nothing tells where the sensor is.
    unknown = 0.0 if "range" in columns else np.nan
    here = np.full((raw.t.size, 2), unknown) if own is None else own.at(raw.t)
    frame = "the first position" if origin is not None else "the origin of the log"
    if "range" in columns and "bearing" in columns:
        range_ = columns["range"]
        if own is not None:
            # Where own ship was not is not where her path ends: such a plot has no position.
            known = own.covers(raw.t - _BEYOND) | own.covers(raw.t + _BEYOND) | own.covers(raw.t)
            range_ = np.where(known, range_, np.nan)
        x = here[:, 0] + range_ * np.cos(columns["bearing"])
        y = here[:, 1] + range_ * np.sin(columns["bearing"])
        return x, y, here, "own ship" if own is None else frame
    if "x" in columns and "y" in columns:
        return columns["x"], columns["y"], here, frame
    # Without an origin no position is known.
    return *to_local(columns["lat"], columns["lon"], origin or (0.0, 0.0)), here, frame


def _first_fix(own: str | Path, fmt: PlotFormat | None) -> tuple[float, float] | None:
    """Latitude and longitude where own ship's file begins, rad."""
    if fmt is not None and fmt.own is not None:
        lonlat = fmt.truth is not None and fmt.truth.lonlat
        fixes = truth_of_structs(_file(own), fmt).get(fmt.own) if lonlat else None
        return None if fixes is None else (float(fixes[0, 1]), float(fixes[0, 2]))
    fixes = _fixes(own)
    return None if fixes is None else (float(fixes[0, 1]), float(fixes[0, 2]))


def _fixes(path: str | Path) -> np.ndarray | None:
    """Time, latitude and longitude of a trial, rad; None where it holds none."""
    record = read_record(path)
    t, columns = _columns(record)
    pair = pair_of(columns)
    if pair is None:
        return None
    found = np.stack([t, columns[pair[0]], columns[pair[1]]], axis=1)
    found = found[np.isfinite(found).all(axis=1)]
    return found if len(found) else None


def _own_among(truth: str | Path, fmt: PlotFormat | None) -> str | Path | None:
    """The file of the true tracks, where own ship is one of them by the format; else None."""
    if fmt is None or fmt.own is None or fmt.truth is None:
        return None
    return truth if fmt.own in _true_tables(_file(truth), fmt) else None


def _true_tables(file: Path, fmt: PlotFormat) -> dict[str, np.ndarray]:
    """Times and positions of the true tracks, own ship's among them, of a file that the format describes."""
    assert fmt.truth is not None, "called for a format with a truth only"
    return truth_of_structs(file, fmt) if fmt.truth.struct else truth_of_json(file, fmt)


def _own_paths(own: str | Path | None, fmt: PlotFormat | None, origin: tuple[float, float] | None) -> ShipPath | None:
    """Own ship from a file of her own."""
    if own is None:
        return None
    if fmt is not None and fmt.own is not None:
        if fmt.own not in _true_tables(_file(own), fmt):
            raise failed(fmt, f"'{own}' holds no ship called '{fmt.own}'.")
        return {p.name: p for p in _truth(_file(own), replace(fmt, own=None), origin)}[fmt.own]
    record = read_record(own)
    t, columns = _columns(record)
    pair = pair_of(columns)
    if origin is not None and pair is not None:
        return path_of("own ship", t, *to_local(columns[pair[0]], columns[pair[1]], origin))
    if "x" in columns and "y" in columns:
        if origin is not None:
            raise _apart(own, "positions of own ship")
        return path_of("own ship", t, columns["x"], columns["y"])
    raise UnknownColumnError(
        f"'{own}' holds no positions of own ship: it needs x and y, or lat and lon, with their units."
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


def _truth(file: Path, fmt: PlotFormat | None, origin: tuple[float, float] | None) -> tuple[ShipPath, ...]:
    """The true tracks of a file, without own ship's."""
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
    t, columns = _columns(record)
    labels = next(
        (c for h, c in zip(table.headers, table.columns) if h.lower() in ("ship", "target", "name", "id")), None
    )
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
    paths = [path_of(str(n), t[names == n], x[names == n], y[names == n]) for n in np.unique(names)]
    return tuple(p for p in paths if p is not None)
