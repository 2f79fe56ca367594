"""Text tables: the layout is detected or taken from the format file, the numbers are parsed by pandas' C engine."""

from __future__ import annotations

import itertools
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from shipid.trials.errors import (
    EmptyFileError,
    HeaderError,
    RaggedRowError,
    SeparatorError,
    TextInColumnError,
)
from shipid.trials.logs.format import SEPARATORS, TrialFormat

_NAMES = {pattern: name for name, pattern in SEPARATORS.items()}
_NUMBER = re.compile(r"^[-+]?(\d+([.,]\d*)?|[.,]\d+)([eE][-+]?\d+)?$|^[-+]?(nan|inf(inity)?)$|^$", re.IGNORECASE)
# A header in white space: a name, and after it perhaps a unit in brackets that belongs to it.
_HEADER_WORD = re.compile(r"[^\s\[\(]+\s*(?:\[[^\]]*\]|\([^)]*\))|\S+")


@dataclass(frozen=True)
class Layout:
    """How a text file is laid out: what pandas has to be told, and what stands before the samples."""

    separator: str
    decimal: str
    encoding: str
    comment: str
    skip: int
    headers: tuple[str, ...]
    comments: tuple[str, ...]
    width: int
    notes: tuple[str, ...] = field(default=())


def fields(line: str, separator: str) -> list[str]:
    """Split one line at a separator; quotes around a field are dropped."""
    parts = line.split() if separator == r"\s+" else line.split(separator)
    return [part.strip().strip("\"'") for part in parts]


def header_fields(line: str, separator: str) -> list[str]:
    """Split a header line; with white space as separator a unit in brackets stays with its name."""
    return _HEADER_WORD.findall(line) if separator == r"\s+" else fields(line, separator)


def lay_out(path: Path, fmt: TrialFormat | None) -> Layout:
    """Find out how a text file is laid out.

    Parameters
    ----------
    path : Path
        The file.
    fmt : TrialFormat or None
        What is known about it.

    Returns
    -------
    Layout

    Raises
    ------
    EmptyFileError, HeaderError, SeparatorError
        If it holds no samples, no header, or columns that cannot be told apart.
    """
    encoding, notes = _encoding(path, fmt.encoding if fmt else None)
    comment = fmt.comment if fmt else "#"
    if fmt is not None and fmt.header_lines is not None:
        return _stated(path, fmt, fmt.header_lines, encoding, notes)
    return _detected(path, fmt, comment, encoding, notes)


def _encoding(path: Path, stated: str | None) -> tuple[str, tuple[str, ...]]:
    """Choose the encoding: as stated, else UTF-8, else cp1252 (a logger's degree sign), by a look at the head."""
    if stated:
        return stated, ()
    with path.open("rb") as file:
        head = file.read(65536)
    try:
        head[: head.rfind(b"\n") + 1].decode("utf-8-sig")
    except UnicodeDecodeError:
        return "cp1252", ("The text is not UTF-8; it was read as cp1252.",)
    return "utf-8-sig", ()


def _lines(path: Path, encoding: str) -> Iterator[str]:
    with path.open(encoding=encoding, errors="replace", newline=None) as file:
        for line in file:
            yield line.rstrip("\r\n")


def _empty(path: Path) -> EmptyFileError:
    return EmptyFileError(
        f"'{path}' holds no samples. A trial file has a header line such as 't [s],psi [deg],r [deg/s],delta [deg]' "
        "and one row for every sample: check that the log was written and copied completely."
    )


def _stated(path: Path, fmt: TrialFormat, skip: int, encoding: str, notes: tuple[str, ...]) -> Layout:
    head = list(itertools.islice(_lines(path, encoding), skip + 200))
    first = next((line for line in head[skip:] if line.strip() and not line.startswith(fmt.comment)), None)
    if first is None:
        raise _empty(path)
    separator = fmt.separator or _separator(path, head[skip - 1] if skip else first, first)
    row = fields(first, separator)
    if len(row) < 2:
        raise _one_column(path, separator, first)
    headers = tuple(header_fields(head[skip - 1], separator)) if skip else ()
    named = any(column.column is not None for column in fmt.columns.values())
    if named and len(headers) != len(row):
        raise HeaderError(
            f"'{path}', line {skip}: the header names {len(headers)} columns and the first sample has {len(row)}. "
            f"Correct header_lines (now {skip}) or separator in the format file '{fmt.name}', or address columns by "
            "index."
        )
    comments = tuple(line[len(fmt.comment) :].strip() for line in head[:skip] if line.startswith(fmt.comment))
    decimal = fmt.decimal or "."
    return Layout(separator, decimal, encoding, fmt.comment, skip, headers, comments, len(row), notes)


def _detected(path: Path, fmt: TrialFormat | None, comment: str, encoding: str, notes: tuple[str, ...]) -> Layout:
    comments: list[str] = []
    header: tuple[int, str] | None = None
    first = None
    for number, line in enumerate(_lines(path, encoding)):
        if not line.strip():
            continue
        if line.lstrip().startswith(comment):
            if header is None:
                comments.append(line.lstrip()[len(comment) :].strip())
        elif header is None:
            header = (number, line)
        else:
            first = line
            break
    if header is None:
        raise _empty(path)
    skip, text = header[0] + 1, header[1]
    stated = fmt.separator if fmt else None
    if _is_sample(text, stated):
        # NumPy's savetxt writes the header as a comment: take the last comment if it fits.
        separator = stated or _separator(path, text, text)
        names = header_fields(comments[-1], separator) if comments else []
        if len(names) != len(fields(text, separator)) or not any("[" in n or "(" in n for n in names):
            raise HeaderError(
                f"'{path}', line {skip}: the first row is a sample, so there is no header to name the columns. "
                "Write a header line such as 't [s],psi [deg],r [deg/s],delta [deg]', or describe the columns by index "
                "in a format file with header_lines = 0."
            )
        skip, text, first, comments = header[0], comments[-1], text, comments[:-1]
    if first is None:
        raise _empty(path)
    separator = stated or _separator(path, text, first)
    headers, row = header_fields(text, separator), fields(first, separator)
    if len(headers) == 1 or len(row) == 1:
        raise _one_column(path, separator, text)
    if len(row) == len(headers) + 1 and row[-1] == "":
        headers.append("")  # every row ends with a separator
    if len(headers) != len(row):
        raise RaggedRowError(
            f"'{path}': the header (line {skip}) names {len(headers)} columns and the first sample has {len(row)}. "
            "Give every column a header and every row as many fields."
        )
    twice = sorted({name for name in headers if name and headers.count(name) > 1})
    if twice:
        raise HeaderError(f"'{path}', line {skip}: the header names '{twice[0]}' twice. Rename one of the two columns.")
    decimal = fmt.decimal if fmt else None
    if decimal is None:
        decimal = "."
        if separator != "," and any("," in value for value in row) and not any("." in value for value in row):
            decimal, notes = ",", (*notes, "The numbers are written with a decimal comma.")
    return Layout(separator, decimal, encoding, comment, skip, tuple(headers), tuple(comments), len(row), notes)


def _is_sample(line: str, separator: str | None) -> bool:
    """Whether a line holds numbers only, at any separator it may have."""
    candidates = [separator] if separator else list(SEPARATORS.values())
    return any(all(_NUMBER.match(value) for value in fields(line, candidate)) for candidate in candidates)


def _separator(path: Path, header: str, first: str) -> str:
    """Choose the separator at which header and first sample fall into the same number of fields."""
    for separator in (";", "\t", ",", r"\s+"):
        row = fields(first, separator)
        count = len(header_fields(header, separator))
        if len(row) > 1 and count > 1 and count in (len(row), len(row) - (row[-1] == "")):
            return separator
    for separator in (";", "\t", ","):  # the header and the rows disagree: the caller says how
        if separator in header and separator in first:
            return separator
    raise _one_column(path, None, header)


def _one_column(path: Path, separator: str | None, line: str) -> SeparatorError:
    shown = "".join(c if c.isprintable() else "?" for c in line.strip()[:60])
    used = f"with separator '{_NAMES.get(separator, separator)}' " if separator else ""
    return SeparatorError(
        f"'{path}': {used}there is only one column, '{shown}'. Separate the columns by comma, semicolon, "
        "tab or white space, the same in header and rows, or state the separator in a format file."
    )


def parse(path: Path, layout: Layout, wanted: Sequence[int]) -> pd.DataFrame:
    """Parse the samples of a text file.

    Parameters
    ----------
    path : Path
        The file.
    layout : Layout
        How it is laid out.
    wanted : sequence of int
        Indices of the columns to parse.

    Returns
    -------
    pandas.DataFrame
        float64, its columns named by their index in the file; NaN where a field is empty.

    Raises
    ------
    RaggedRowError, TextInColumnError, EmptyFileError
        If a row has too many fields, a field is not a number, or there are no samples.
    """
    # No usecols: told which columns to use, pandas drops what a row has too much of without a word.
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            table = pd.read_csv(
                path,
                sep=layout.separator,
                skiprows=layout.skip,
                header=None,
                names=list(range(layout.width)),
                index_col=False,
                dtype=dict.fromkeys(wanted, "float64"),
                decimal=layout.decimal,
                comment=layout.comment,
                encoding=layout.encoding,
                encoding_errors="replace",
                engine="c",
                low_memory=False,
            )
    except pd.errors.EmptyDataError:
        raise _empty(path) from None
    except (pd.errors.ParserError, pd.errors.ParserWarning, ValueError) as error:
        _explain(path, layout, wanted)
        raise RaggedRowError(
            f"'{path}' could not be parsed: {' '.join(str(error).split())}. Check its rows, or state a format file."
        ) from None
    if table.empty:
        raise _empty(path)
    return table[list(dict.fromkeys(wanted))]


def _samples(path: Path, layout: Layout) -> Iterator[tuple[int, str]]:
    """Yield line number (from 1) and text of every sample line: only walked to explain what is wrong."""
    for number, line in enumerate(_lines(path, layout.encoding), start=1):
        if number > layout.skip and line.strip() and not line.lstrip().startswith(layout.comment):
            yield number, line


def line_of(path: Path, layout: Layout, row: int) -> int:
    """Return the line number in the file (from 1) of a sample (from 0)."""
    return next(itertools.islice((number for number, _ in _samples(path, layout)), row, None), row)


def _explain(path: Path, layout: Layout, wanted: Sequence[int]) -> None:
    """Walk the file to the first row that is too long or holds text, and raise its error."""
    for number, line in _samples(path, layout):
        row = fields(line.split(layout.comment)[0], layout.separator)
        if len(row) > layout.width:
            raise RaggedRowError(
                f"'{path}', line {number}: the row has {len(row)} fields, the first sample {layout.width}. "
                "Complete or remove the row; a text field must not contain the separator."
            )
        for index in wanted:
            value = row[index] if index < len(row) else ""
            if not _NUMBER.match(value) or (layout.decimal == "." and "," in value):
                name = layout.headers[index] if index < len(layout.headers) else f"number {index}"
                decimal = " A decimal comma is stated in a format file: decimal = 'comma'." if "," in value else ""
                raise TextInColumnError(
                    f"'{path}', line {number}, column '{name}': '{value[:40]}' is not a number. "
                    "Replace it by the number, or remove the row; an empty field means that nothing was measured."
                    f"{decimal}"
                )
