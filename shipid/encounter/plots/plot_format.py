"""Format files of plots: what a trial format says of columns, and beside it sensors, records of JSON, truth and own ship.

A table names its columns as a trial format does, with ``t`` and ``range``, ``bearing`` or ``x``, ``y`` or ``lat``, ``lon``; the
position of own ship may stand beside them as ``own_x``, ``own_y``. A JSON list of records is described by ``[records]``::

    [records]
    time = "time"             # the keys of a record
    position = "measurement"  # a pair, or several plots
    layout = "rows"           # all norths in one row, then all easts; or "pairs", one pair a plot
    own = "ownshipPosition"
    sensor = "sensorID"
    relative = true           # positions count from own ship, north up

    [sensors.radar]
    value = 2                 # what the key of the sensor holds
    position_std = "5 m"      # or range_std and bearing_std
    bias_std = "3 m"          # what all plots of a target may be off together: the place of the sensor, the length of a ship
    bearing_bias_std = "1 deg"  # the same of all bearings: the heading that they count from
    latency = "2.2 s"
    detection = 0.9           # probability of a plot of a target in sight, in one scan
    sight = 0.8               # share of the time that a target is in sight
    scan = "2.5 s"            # of an antenna that turns, where plots come one by one

    [truth]                   # where the true tracks stand, in a file of their own
    time = "time"
    position = "position"
    name = "targetID"
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from shipid.declaration.tables import Table
from shipid.encounter.plots.plots import Sensor
from shipid.trials.errors import FormatFileError
from shipid.trials.logs.format import TrialFormat, parse_format, read_format_table

_OWN = ("records", "sensors", "truth", "own")
_RECORDS = ("time", "position", "layout", "own", "sensor", "relative", "unit", "time_unit")
_SENSOR = (
    "value", "position_std", "range_std", "bearing_std", "bias_std", "bearing_bias_std", "latency", "latency_std", "detection", "sight", "scan",
)  # fmt: skip
_TRUTH = ("time", "time_unit", "position", "unit", "lonlat", "name", "struct")


@dataclass(frozen=True)
class RecordFormat:
    """The keys of a JSON record that holds plots.

    Attributes
    ----------
    time, position : str
        Keys.
    own, sensor : str or None
        Keys, where there are such.
    layout : {"rows", "pairs"}
        How several plots of one record are written.
    relative : bool
        Whether positions count from own ship.
    unit, time_unit : str
        Of positions and times.
    """

    time: str
    position: str
    own: str | None = None
    sensor: str | None = None
    layout: str = "rows"
    relative: bool = False
    unit: str = "m"
    time_unit: str = "s"


@dataclass(frozen=True)
class TruthFormat:
    """Where a file of true tracks holds what.

    Attributes
    ----------
    time : str
        Key or field of the times.
    position, lonlat : str or None
        North and east, or longitude and latitude in deg.
    name : str or None
        What tells the ships apart.
    struct : str or None
        The array of structs in a MATLAB file.
    unit, time_unit : str
        Of positions and times.
    """

    time: str
    position: str | None = None
    lonlat: str | None = None
    name: str | None = None
    struct: str | None = None
    unit: str = "m"
    time_unit: str = "s"


@dataclass(frozen=True)
class PlotFormat:
    """A format file of plots, read and checked.

    Attributes
    ----------
    name : str
        The file's stem.
    table : TrialFormat or None
        The columns, where the plots stand in a table.
    records : RecordFormat or None
        The keys, where they stand in JSON.
    sensors : tuple of Sensor
        In the order of the file.
    values : Mapping of object to int
        Which sensor a value in the records or in the column ``sensor`` stands for.
    truth : TruthFormat or None
        Of the file of true tracks.
    own : str or None
        Name of own ship among the tracks of the file of own ship.
    title : str or None
        What the plots are.
    """

    name: str
    table: TrialFormat | None = None
    records: RecordFormat | None = None
    sensors: tuple[Sensor, ...] = ()
    values: Mapping[object, int] = field(default_factory=dict)
    truth: TruthFormat | None = None
    own: str | None = None
    title: str | None = None


def read_plot_format(path: str | Path) -> PlotFormat:
    """Read a format file of plots.

    Parameters
    ----------
    path : str or Path
        The TOML file.

    Returns
    -------
    PlotFormat

    Raises
    ------
    MissingFileError
        If the file is not there.
    FormatFileError
        If it is not TOML, has a key that is not known, or a value that cannot be meant.
    """
    table = read_format_table(path)
    sensors, values = _sensors(table.table("sensors"))
    own = table.table("own")
    own.check_keys(("name",))
    rest = {k: v for k, v in table.content.items() if k not in _OWN}
    records = None
    if "records" in table:
        records = _records(table.table("records"))
        Table(rest, table.file, table.error).check_keys(("title", "source"))
    return PlotFormat(
        Path(path).stem,
        None if records else parse_format(replace(table, content=rest), Path(path).stem),
        records,
        sensors,
        values,
        _truth(table.table("truth")) if "truth" in table else None,
        own.value("name", str),
        table.value("title", str),
    )


def _records(table: Table) -> RecordFormat:
    table.check_keys(_RECORDS, ("time", "position"))
    return RecordFormat(
        table.value("time", str),
        table.value("position", str),
        table.value("own", str),
        table.value("sensor", str),
        table.choice("layout", ("rows", "pairs"), "rows") or "rows",
        table.value("relative", bool, False),
        table.value("unit", str, "m"),
        table.value("time_unit", str, "s"),
    )


def _truth(table: Table) -> TruthFormat:
    table.check_keys(_TRUTH, ("time",))
    if ("position" in table) == ("lonlat" in table):
        raise table.fail("it needs either position, north and east, or lonlat, longitude and latitude.")
    texts = {key: table.value(key, str) for key in _TRUTH if key in table}
    return TruthFormat(**texts)


def _sensors(table: Table) -> tuple[tuple[Sensor, ...], dict[object, int]]:
    sensors, values = [], {}
    for k, (name, inside) in enumerate(table.tables()):
        inside.check_keys(_SENSOR)
        range_std = inside.quantity("range_std", "m", positive=True)
        bearing_std = inside.quantity("bearing_std", "rad", positive=True)
        if (range_std is None) != (bearing_std is None):
            raise inside.fail("range_std and bearing_std belong together: it has one of the two.")
        usual = Sensor(name)
        chances = {key: inside.value(key, float, getattr(usual, key)) for key in ("detection", "sight")}
        for key, chance in chances.items():
            if not 0 < chance < 1:
                raise inside.fail(f"'{key}' is {chance:g}, and has to be a probability between zero and one.")
        sensors.append(
            Sensor(
                name,
                inside.quantity("position_std", "m", usual.position_std, positive=True) or usual.position_std,
                range_std,
                bearing_std,
                inside.quantity("bias_std", "m", positive=True) or 0.0,
                inside.quantity("bearing_bias_std", "rad", positive=True) or 0.0,
                inside.quantity("latency", "s", 0.0) or 0.0,
                inside.quantity("latency_std", "s", 0.0) or 0.0,
                chances["detection"],
                chances["sight"],
                inside.quantity("scan", "s", positive=True),
            )
        )
        value = inside.content.get("value", name)
        if isinstance(value, (dict, list)) or value in values:
            raise inside.fail(f"'value' is {value!r}, and has to be a number or a text that no other sensor has.")
        values[value] = k
    return tuple(sensors), values


def failed(format_: PlotFormat, message: str) -> FormatFileError:
    """Return the error that a file is not as its format says.

    Parameters
    ----------
    format_ : PlotFormat
        The format.
    message : str
        What is wrong.
    """
    return FormatFileError(f"{message} The format file '{format_.name}' says otherwise: correct one of the two.")
