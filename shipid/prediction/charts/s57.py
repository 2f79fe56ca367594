"""Cells of S-57, turned into GeoJSON by GDAL in a process of its own."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from shipid.foundation.errors import MissingExtraError
from shipid.foundation.notices import Notice
from shipid.foundation.processes.apart import NotStartedError, run_apart
from shipid.prediction.charts.errors import ChartError, ChartFileError, ChartSizeError
from shipid.prediction.charts.geojson import MOST_FEATURES, MOST_POINTS
from shipid.prediction.charts.meaning import CLASSES
from shipid.prediction.charts.s57_records import check_records, updates_of

#: Processor time and time by the clock [s] after which reading is given up; a cell of 5 MB takes 2 s.
_SECONDS, _LONGEST = 20, 60
#: Bytes; an update is much smaller than its cell.
_LARGEST_UPDATE = 10_000_000
_READER = Path(__file__).with_name("s57_apart.py")
_OPTIONS = {"OGR_S57_OPTIONS": "RETURN_PRIMITIVES=OFF,RETURN_LINKAGES=OFF,LNAM_REFS=OFF,UPDATES=APPLY,RECODE_BY_DSSI=ON"}  # fmt: skip


def s57_as_geojson(file: Path, data: bytes, where: str) -> tuple[bytes, list[Notice]]:
    """Return what is drawn of a cell as GeoJSON, and what is told of its updates.

    Parameters
    ----------
    file : Path
        The cell; its updates lie beside it.
    data : bytes
        What is in the file.
    where : str
        What it is called in messages.

    Returns
    -------
    bytes
        GeoJSON.
    list of Notice
        Updates that are not applied.

    Raises
    ------
    MissingExtraError
        If pyogrio is not installed.
    ChartError
        If the process that reads it cannot be started.
    ChartFileError
        If it or one of its updates is damaged or incomplete.
    ChartSizeError
        If it has more features or points than are read.
    """
    missing = MissingExtraError(f"the S-57 chart {where}", "pyogrio", "chart", "GeoJSON needs nothing else.")
    if importlib.util.find_spec("pyogrio") is None:
        raise missing
    check_records(data, f"{where}, a cell of S-57,")
    updates, told = updates_of(file)
    for update in updates:
        with update.open("rb") as stream:
            change = stream.read(_LARGEST_UPDATE + 1)
        if len(change) > _LARGEST_UPDATE:
            raise ChartSizeError(
                f"'{update}', an update of the cell {where}, is larger than {_LARGEST_UPDATE // 1_000_000} MB."
            )
        check_records(change, f"'{update}', an update of the cell {where},")
    arguments = [str(file.resolve()), ",".join(CLASSES), str(MOST_FEATURES), str(MOST_POINTS), str(_SECONDS)]
    try:
        answer = run_apart(_READER, arguments, longest=_LONGEST, surroundings=_OPTIONS)
    except NotStartedError as error:
        raise ChartError(
            f"{where} was not read: the process that reads S-57 could not be started ({error}). Convert the chart to GeoJSON."
        ) from None
    if answer.startswith(b"no pyogrio"):
        raise missing
    if answer.startswith(b"too large"):
        raise ChartSizeError(
            f"{where} has more than {MOST_FEATURES} features or {MOST_POINTS} points, and no more are read. Take a smaller cell."
        )
    if not answer.rstrip().endswith(b"]}"):
        among = f", or one of its {len(updates)} updates is damaged or not of this edition" if updates else ""
        raise ChartFileError(f"{where} is a damaged cell of S-57{among}. Check that it was copied completely.")
    return answer, told
