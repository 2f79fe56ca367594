"""Which column of a table is what: by its header, or by the format file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

from shipid.foundation.errors import UnknownNameError, nearest
from shipid.trials import columns
from shipid.trials.errors import ClockError, HeaderError, TrialError, UnknownColumnError
from shipid.trials.logs.clocks.headers import NAMES, short
from shipid.trials.logs.format import TrialFormat

T = TypeVar("T")


def by_header(
    found: Mapping[str, T], units: Mapping[str, str], where: str, unread: Mapping[str, str] | None = None
) -> tuple[dict[str, T], dict[str, str], list[TrialError]]:
    """Read names and units from headers.

    Parameters
    ----------
    found : Mapping
        Columns by header; headers without a name are skipped.
    units : Mapping of str to str
        Units by name or header, for headers that say none.
    where : str
        File or table, for messages.
    unread : Mapping of str to str, optional
        Headers of a clock over text that was not read, with a cell of each.

    Returns
    -------
    values : dict
        The columns by name.
    stated : dict of str to str
        Their units, by name; without those of columns that say none.
    faults : list of TrialError
        Columns without a unit, a name that stands twice (the first column is kept), the lack of a column ``t``.

    Raises
    ------
    UnknownNameError
        If `units` names a column that is not there.
    """
    values: dict[str, T] = {}
    stated: dict[str, str] = {}
    faults: list[TrialError] = []
    clocks: list[str] = []
    for header, column in found.items():
        name, unit = columns.split_header(header)
        if not name:
            continue
        if name in values:
            faults.append(HeaderError(f"{where}: the header names '{name}' twice. Rename one of the two columns."))
            continue
        values[name] = column
        unit = unit or units.get(name) or units.get(header)
        if unit:
            stated[name] = unit
        elif name != "t" and short(header) in NAMES:
            clocks.append(name)
        else:
            faults.append(columns.no_unit(name, where + ", "))
    for name in units:
        if name not in values and name not in found:
            raise UnknownNameError("column", name, values)
    if "t" not in values and clocks:
        faults.insert(0, columns.no_unit(clocks[0], where + ", ", "t"))
    elif "t" not in values and unread:
        name, cell = next(iter(unread.items()))
        faults.append(
            ClockError(
                f"{where}, column '{name}': '{cell[:40]}' is no date or time in a form that is known. State its layout in [clock] of a "
                "format file, as in layout = '%d.%m.%Y %H:%M:%S'; or write seconds under 't [s]'."
            )
        )
    elif "t" not in values and not values:
        faults.append(
            UnknownColumnError(
                f"{where}: its columns have no names. Describe them by their place (index = 0, 1, ...) in a format file, or name "
                "them beside the table."
            )
        )
    elif "t" not in values:
        faults.append(
            UnknownColumnError(
                f"{where}: there is no time column 't' among {', '.join(values)}. Name the time column 't [s]', or map the "
                "columns in a format file: shipid format LOG -o FORMAT.toml drafts one."
            )
        )
    else:
        faults += [columns.no_unit(name, where + ", ", "t") for name in clocks]
    return values, stated, faults


def by_format(
    fmt: TrialFormat, headers: Sequence[str], width: int, where: str, units: Mapping[str, str]
) -> tuple[dict[str, int], dict[str, str]]:
    """Find the columns that a format file names.

    Parameters
    ----------
    fmt : TrialFormat
        The format.
    headers : sequence of str
        The headers; none, where the log has none.
    width : int
        Number of columns.
    where : str
        File, for messages.
    units : Mapping of str to str
        Units by header, for columns of which neither the format nor the header says one.

    Returns
    -------
    found : dict of str to int
        Index of each column, by name.
    stated : dict of str to str
        Unit of each column, by name; without that of a clock that states none.

    Raises
    ------
    UnknownColumnError
        If the log has no such column.
    NoUnitError
        If nothing says the unit of a column.
    """
    by_name = {header: k for k, header in enumerate(headers)}
    bare = {columns.split_header(header)[0]: k for k, header in enumerate(headers)}
    found, stated = {}, {}
    for name, column in fmt.columns.items():
        if column.column is not None:
            index = by_name.get(column.column, bare.get(column.column))
            if index is None:
                raise UnknownColumnError(
                    f"{where} has no column '{column.column}', which the format file '{fmt.name}' names for {name}. "
                    f"{nearest(column.column, bare)}".rstrip()
                )
        else:
            assert column.index is not None
            index = column.index
            if index >= width:
                raise UnknownColumnError(
                    f"{where} has {width} columns, counted from 0, and the format file '{fmt.name}' wants number "
                    f"{index} for {name}. Correct the index, or the separator."
                )
        header = headers[index] if index < len(headers) == width else ""
        unit = column.unit or units.get(column.column or "") or columns.split_header(header)[1]
        found[name] = index
        if unit:
            stated[name] = unit
        elif name != "t":  # a clock may be no number: `shipid.trials.logs.clocks`
            raise columns.no_unit(name, f"{where}, format file '{fmt.name}': ")
    return found, stated
