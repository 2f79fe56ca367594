"""The verbs: read a route, and write one."""

from __future__ import annotations

from pathlib import Path

from shipid.foundation.errors import MissingFileError, UsageError
from shipid.foundation.replacing import check_place, write_text
from shipid.prediction.routes.errors import RouteSizeError
from shipid.prediction.routes.route import Route
from shipid.prediction.routes.route_table import read_route_table, route_table
from shipid.prediction.routes.rtz import Version, read_rtz, rtz_text

#: Bytes of a file that are read.
LARGEST = 10_000_000


def read_route(path: str | Path) -> Route:
    """Read a route: RTZ 1.0 to 1.2, or CSV with units in its header.

    Parameters
    ----------
    path : str or Path
        The file; what it holds says which of the two it is.

    Returns
    -------
    Route

    Raises
    ------
    MissingFileError
        If it cannot be opened.
    RouteSizeError
        If it is larger than 10 MB, or has more than 10,000 waypoints.
    RouteFileError
        If it is no route, is cut short, or declares entities.
    RouteError
        If a waypoint or the route cannot be.
    """
    file = Path(path)
    try:
        if not file.is_file():
            raise MissingFileError(f"there is no file '{file}'. Check its name.")
        with file.open("rb") as stream:
            data = stream.read(LARGEST + 1)
    except OSError as error:
        raise MissingFileError(f"'{file}' cannot be read: {error.strerror}. Check the path.") from None
    if len(data) > LARGEST:
        raise RouteSizeError(f"'{file}' is larger than {LARGEST // 1_000_000} MB, which no route is.")
    where = f"'{file}'"
    # An XML file may begin with a byte order mark, of UTF-8 or of UTF-16.
    head = data[:200].removeprefix(b"\xef\xbb\xbf").lstrip()
    if head.startswith((b"<", b"\xff\xfe<", b"\xfe\xff\0<")):
        return read_rtz(data, where)
    return read_route_table(data, where, file.stem)


def write_route(route: Route, path: str | Path, *, version: Version = "1.2", overwrite: bool = False) -> Path:
    """Write a route so that `read_route` reads it back.

    Parameters
    ----------
    route : Route
        What to write.
    path : str or Path
        Where: ``.rtz`` or ``.xml`` writes RTZ, ``.csv`` a table.
    version : {"1.0", "1.2"}
        Of RTZ.
    overwrite : bool
        Whether a file of that name may be replaced.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    UsageError
        If the ending names no format, or there is no such version.
    RouteError
        If RTZ is asked for and the positions are local metres.
    OverwriteError
        If the file exists and `overwrite` is not set.
    MissingFileError
        If the folder does not exist or cannot be written to.
    """
    file = Path(path)
    ending = file.suffix.lower()
    if ending not in (".rtz", ".xml", ".csv"):
        raise UsageError(f"'{file}' does not say which format: end its name in .rtz or .csv.")
    if version not in ("1.0", "1.2"):
        raise UsageError(f"RTZ {version} is not written: choose version 1.0 or 1.2.")
    text = route_table(route) if ending == ".csv" else rtz_text(route, version)
    check_place(file, overwrite)
    write_text(file, text)
    return file
