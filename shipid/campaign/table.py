"""The runs of a campaign as one table, written one batch at a time: NumPy's npz, Parquet or text."""

from __future__ import annotations

import csv
import json
import math
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from shipid.campaign.campaign import RUN, Rows
from shipid.campaign.store import Store, read_store
from shipid.foundation.errors import MissingExtraError, UnknownNameError
from shipid.foundation.replacing import replacing

#: Kinds of tables: text for a spreadsheet, or numbers for a program.
TableKind = Literal["csv", "npz", "parquet"]


def read_runs(folder: str | Path, runs: int | None = None) -> Rows:
    """Return the runs of a campaign, all in memory.

    Parameters
    ----------
    folder : str or Path
        Of the campaign.
    runs : int, optional
        How many; by default all that are finished.

    Returns
    -------
    dict of str to ndarray, shape (runs, ...)
        The measures, and ``run``, their numbers.

    Raises
    ------
    CampaignFolderError
        If there is no campaign, or runs are missing.
    """
    store = read_store(Path(folder))
    parts = list(store.batches(store.done() if runs is None else runs))
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def write_table(folder: str | Path, runs: int, path: str | Path, kind: TableKind) -> None:
    """Write the runs of a campaign as one file, with its provenance; the file appears when it is complete.

    Parameters
    ----------
    folder : str or Path
        Of the campaign.
    runs : int
        How many.
    path : str or Path
        The file to write.
    kind : {"csv", "npz", "parquet"}
        A measure with several places has one column a place in text, one array in npz, and a list in Parquet.

    Raises
    ------
    UnknownNameError
        If there is no such kind.
    MissingExtraError
        If pyarrow is not installed, for Parquet.
    """
    if kind not in get_args(TableKind):
        raise UnknownNameError("kind of table", kind, get_args(TableKind))
    writers: dict[str, Callable[[Store, int, Path], None]] = {"csv": _text, "npz": _numpy, "parquet": _parquet}
    with replacing(Path(path)) as temporary:
        writers[kind](read_store(Path(folder)), runs, temporary)


def _about(store: Store) -> str:
    return json.dumps({key: store.head[key] for key in ("campaign", "seed", "batch", "identity", "provenance")})


def _text(store: Store, runs: int, path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        for k, rows in enumerate(store.batches(runs)):
            if not k:
                writer.writerow([h for n, column in rows.items() for h in _headers(store, n, column)])
            flat = [c[:, None] if c.ndim == 1 else c for c in rows.values()]
            writer.writerows([_cell(v) for part in flat for v in part[i]] for i in range(len(rows[RUN])))


def _headers(store: Store, name: str, column: np.ndarray) -> list[str]:
    unit = store.measures[name].unit if name in store.measures else "1"
    tail = "" if unit == "1" else f" [{unit}]"
    return [f"{name}{tail}"] if column.ndim == 1 else [f"{name}_{k}{tail}" for k in range(column.shape[1])]


def _cell(value: object) -> object:
    """What is missing is an empty cell."""
    if isinstance(value, (float, np.floating)):
        return repr(float(value)) if math.isfinite(value) else ""
    return value


def _numpy(store: Store, runs: int, path: Path) -> None:
    """One array after the other, and each batch by batch: the file is as large as the campaign, the memory is not."""
    first = next(iter(store.batches(runs)))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, column in first.items():
            width = max((rows[name].dtype.itemsize for rows in store.batches(runs)), default=0)
            kind = np.dtype(f"<U{max(1, width // 4)}") if column.dtype.kind == "U" else column.dtype
            header = {
                "descr": np.lib.format.dtype_to_descr(kind),
                "fortran_order": False,
                "shape": (runs, *column.shape[1:]),
            }
            with archive.open(f"{name}.npy", "w", force_zip64=True) as stream:
                np.lib.format.write_array_header_1_0(stream, header)
                for rows in store.batches(runs):
                    stream.write(np.ascontiguousarray(rows[name].astype(kind)).tobytes())
        with archive.open("provenance.npy", "w") as stream:
            np.save(stream, np.array(_about(store)))


def _parquet(store: Store, runs: int, path: Path) -> None:
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise MissingExtraError(
            "a Parquet table", "pyarrow", "parquet", "A table as csv or npz needs nothing."
        ) from None
    writer = None
    try:
        for rows in store.batches(runs):
            columns = {n: pa.array(list(c) if c.ndim == 2 else c, from_pandas=True) for n, c in rows.items()}
            table = pa.table(columns)
            if writer is None:
                schema = table.schema.with_metadata({"shipid": _about(store)})
                writer = pq.ParquetWriter(path, schema)
            writer.write_table(table.cast(writer.schema))
    finally:
        if writer is not None:
            writer.close()
