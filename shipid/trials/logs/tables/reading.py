"""Read the table of a file, whatever kind of file it is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from shipid.trials.errors import ChoiceError
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.tables.archive import in_archive
from shipid.trials.logs.tables.cell_units import stated_units, with_cell_units
from shipid.trials.logs.tables.files.arrays import read_arrays
from shipid.trials.logs.tables.files.excel import read_excel
from shipid.trials.logs.tables.files.hdf5 import hdf5_arrays
from shipid.trials.logs.tables.files.matlab import matlab_arrays
from shipid.trials.logs.tables.files.own_clocks import on_one_clock
from shipid.trials.logs.tables.files.parquet import read_parquet
from shipid.trials.logs.tables.files.text import read_text
from shipid.trials.logs.tables.kinds import Kind, kind_of
from shipid.trials.logs.tables.no_samples import samples_only
from shipid.trials.logs.tables.opening import opened
from shipid.trials.logs.tables.table import RawTable


def read_table(file: Path, fmt: TrialFormat | None = None, part: str | None = None) -> RawTable:
    """Read the table of a file.

    Parameters
    ----------
    file : Path
        The file: text, an Excel workbook, a MATLAB, HDF5 or Parquet file, compressed or not.
    fmt : TrialFormat, optional
        What is known about it.
    part : str, optional
        The sheet, struct or group that is wanted; by default that of the format file, or the only one that looks like a trial. Of a
        zip archive the file in it, and behind a '#' the table in that.

    Returns
    -------
    RawTable

    Raises
    ------
    ForeignFileError
        If it is none of these; the message names what it is.
    ChoiceError
        If it holds several tables and nothing tells which one, or `part` is none of them.
    TrialError
        If it is damaged, too large, or holds no table.
    """
    member, wanted = in_archive(file, part if part is not None else fmt.table if fmt else None)
    data, notes = opened(file, member)
    file = file if member is None else Path(f"{file}#{member}")
    kind = kind_of(data, file)
    columns = {column.column for column in fmt.columns.values() if column.column} if fmt else set()
    if wanted is not None and kind in (Kind.TEXT, Kind.PARQUET):
        raise ChoiceError(
            f"'{file}' is a {kind.value} file: it holds one table, and '{wanted}' names one of several. Leave it out."
        )
    if kind is Kind.EXCEL:
        table = read_excel(data, file, wanted, columns)
    elif kind is Kind.PARQUET:
        table = read_parquet(data, file)
    elif kind is Kind.TEXT:
        table = read_text(data, file, fmt)
    else:
        old = kind is Kind.MATLAB and b"\x89HDF" not in data[:4104]
        arrays = matlab_arrays(data, file) if old else hdf5_arrays(data, file)
        table = read_arrays(on_one_clock(arrays), file, wanted, columns, "struct" if kind is Kind.MATLAB else "group")
    return with_cell_units(samples_only(replace(table, notes=(*notes, *table.notes))), stated_units(fmt))
