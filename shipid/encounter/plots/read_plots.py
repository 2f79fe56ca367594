"""Read the plots of a log, own ship's path and the true tracks, and put them into one frame and one clock."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.plots.column_doubts import bearings_possible, doubts, possible, two_stamps
from shipid.encounter.plots.given_paths import first_fix, own_among, own_heading, own_path, true_paths
from shipid.encounter.plots.json_records import plots_of_json
from shipid.encounter.plots.plot_format import PlotFormat, failed, read_plot_format
from shipid.encounter.plots.plots import Plots, Sensor, make_plots
from shipid.encounter.plots.raw_plots import NAMES, OWN, RawPlots, columns_of, file_of, named
from shipid.encounter.plots.sentences import holds_plots, plots_of_sentences
from shipid.encounter.plots.ship_path import CARRIED, ShipPath, path_doubts, path_of
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, notice_of
from shipid.foundation.numbers import moment
from shipid.trials.errors import EmptyFileError, ForeignFileError, UnknownColumnError
from shipid.trials.logs.geodesy import to_local
from shipid.trials.logs.nmea.opening import is_nmea
from shipid.trials.logs.positions import pair_of
from shipid.trials.logs.tables.reading import read_table
from shipid.trials.logs.tables.table import record_of


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
        If own ship's path or the true tracks and the plots have no time in common, or nothing says where they lie beside the plots.
    """
    fmt = read_plot_format(format) if isinstance(format, (str, Path)) else format
    file = file_of(path)
    raw = possible(_from_north(bearings_possible(_raw(file, fmt)), own, file))
    origin = _origin(raw)
    if own is None and truth is not None and "own_x" not in raw.columns and "own_lat" not in raw.columns:
        own = own_among(truth, fmt)
    if origin is None and own is not None:
        origin = first_fix(own, fmt)
    begin = _begin(raw.t, raw.looks)
    paths = own_path(own, fmt, origin)
    ship = paths if paths is not None else _own_in(raw, origin)
    relative = ship is None and "range" in raw.columns
    if ship is not None:
        raw = _beside(raw, ship, begin)
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
    found = tuple(_shifted(p, begin) for p in (true_paths(file_of(truth), fmt, origin) if truth is not None else ()))
    ship = None if ship is None else _shifted(ship, begin)
    if found and not any(p.covers(np.array([s.t for s in plots])).any() for p in found):
        raise EncounterRequestError(
            f"the true tracks in '{truth}' run from {moment(min(p.t[0] for p in found))} to {moment(max(p.t[-1] for p in found))} s after the first "
            "plot, and no plot lies in them. Give them by the clock of the plots."
        )
    plots = replace(plots, notes=(*(notice_of(n) for n in raw.notes), *plots.notes))
    return Detections(file.stem, plots, ship, relative, found)


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
    t, columns = columns_of(record)
    found = {k: v for k, v in ((k, named(columns, n)) for k, n in (NAMES | OWN).items()) if v is not None}
    pair = pair_of(columns)
    bearings = {"bearing", "relative_bearing"} & set(found) if "range" in found else set()
    if not bearings and not {"x", "y"} <= set(found):
        if pair is None:
            raise UnknownColumnError(
                f"{record.where} holds no positions of targets: it needs range and bearing (or relative_bearing, from the bow), x and y, or "
                f"lat and lon, each with its unit, and has {', '.join(columns)}."
            )
        found |= {"lat": columns[pair[0]], "lon": columns[pair[1]]}
    sensor = np.zeros(t.size, int)
    if fmt is not None and len(fmt.sensors) > 1:
        if "sensor" not in columns:
            raise failed(fmt, f"{record.where} has no column 'sensor' that tells its {len(fmt.sensors)} sensors apart.")
        # 2.0 and 2 are one key; a plot of a sensor that the format does not name is left out, as one without a time.
        sensor = np.array([fmt.values.get(v, -1) for v in columns["sensor"]], int)
        t = np.where(sensor >= 0, t, np.nan)
    said = [*doubts(record.values, found, len(fmt.sensors) if fmt else 0), *two_stamps(t)]
    return RawPlots(t, found, sensor, notes=(*(record.notes if fmt is None else ()), *said))


def _from_north(raw: RawPlots, own: str | Path | None, file: Path) -> RawPlots:
    """Bearings from the bow made bearings from north, by the heading at each plot."""
    if "relative_bearing" not in raw.columns or "bearing" in raw.columns:
        return raw
    psi = raw.columns.get("own_psi", own_heading(own, raw.t))
    if psi is None:
        raise EncounterRequestError(
            f"the bearings in '{file}' count from the bow, and nothing says how own ship headed: give her path with psi (--own), or a column "
            "own_psi beside the plots."
        )
    return replace(raw, columns=raw.columns | {"bearing": raw.columns["relative_bearing"] + psi})


def _origin(raw: RawPlots) -> tuple[float, float] | None:
    """Latitude and longitude of the first position, rad."""
    for lat, lon in (("own_lat", "own_lon"), ("lat", "lon")):
        if lat in raw.columns and lon in raw.columns:
            known = np.isfinite(raw.columns[lat]) & np.isfinite(raw.columns[lon])
            if known.any():
                k = int(known.argmax())
                return float(raw.columns[lat][k]), float(raw.columns[lon][k])
    return None


def _beside(raw: RawPlots, own: ShipPath, begin: float) -> RawPlots:
    """The plots that own ship's path says something of, and what it leaves open: where she was not is not where her path ends."""
    known = own.covers(raw.t - CARRIED) | own.covers(raw.t + CARRIED) | own.covers(raw.t)
    runs = f"the path of own ship runs from {moment(own.t[0] - begin)} to {moment(own.t[-1] - begin)} s after the first plot"
    if np.isfinite(raw.t).any() and not known.any():
        raise EncounterRequestError(f"{runs}, and no plot lies in it. Give own ship by the clock of the plots.")
    counted = "range" in raw.columns
    notes = [*raw.notes, *path_doubts(_shifted(own, begin), counted)]
    without = np.isfinite(raw.t) & ~known
    if not counted or not without.any():
        return replace(raw, notes=tuple(notes))
    count = int(without.sum())
    told = f"{count} plot{'s' * (count > 1)} left out that count from own ship before or after her path: {runs}."
    notes.append(Notice(told, "plots-without-own-ship", count=count))
    columns = {name: values[~without] for name, values in raw.columns.items()}
    return replace(raw, t=raw.t[~without], columns=columns, sensor=raw.sensor[~without], notes=tuple(notes))


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
        x = here[:, 0] + columns["range"] * np.cos(columns["bearing"])
        y = here[:, 1] + columns["range"] * np.sin(columns["bearing"])
        return x, y, here, "own ship" if own is None else frame
    if "x" in columns and "y" in columns:
        return columns["x"], columns["y"], here, frame
    # Without an origin no position is known.
    return *to_local(columns["lat"], columns["lon"], origin or (0.0, 0.0)), here, frame
