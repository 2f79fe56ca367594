"""How a text table is laid out: separator, header, decimal sign and encoding, detected or taken from the format file."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from shipid.trials.errors import (
    EmptyFileError,
    HeaderError,
    RaggedRowError,
    SeparatorError,
)
from shipid.trials.logs.clocks.stamps import is_stamp
from shipid.trials.logs.format import SEPARATORS, TrialFormat

_NAMES = {pattern: name for name, pattern in SEPARATORS.items()}
#: What a field of a column of numbers may hold; an empty one holds nothing.
NUMBER = re.compile(r"^[-+]?(\d+([.,]\d*)?|[.,]\d+)([eE][-+]?\d+)?$|^[-+]?(nan|inf(inity)?)$|^$", re.IGNORECASE)
# A header in white space: a name, and after it perhaps a unit in brackets that belongs to it.
_HEADER_WORD = re.compile(r"[^\s\[\(]+\s*(?:\[[^\]]*\]|\([^)]*\))|\S+")


@dataclass(frozen=True)
class TextLayout:
    """How a text file is laid out.

    Attributes
    ----------
    separator : str
        Regular expression of the separator.
    decimal : str
        The decimal sign.
    encoding : str
        The text encoding.
    comment : str
        What starts a comment line.
    skip : int
        Lines before the first sample.
    headers : tuple of str
        The header's fields; none, where there is no header.
    comments : tuple of str
        The comment lines at the head.
    width : int
        Number of columns.
    notes : tuple of str
        What was found out and not stated.
    """

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
    """Return the fields of a line; quotes around a field are dropped.

    Parameters
    ----------
    line : str
        The line.
    separator : str
        Regular expression of the separator.
    """
    parts = line.split() if separator == r"\s+" else line.split(separator)
    return [part.strip().strip("\"'") for part in parts]


def header_fields(line: str, separator: str) -> list[str]:
    """Return the fields of a header line; with white space as separator a unit in brackets stays with its name.

    Parameters
    ----------
    line : str
        The line.
    separator : str
        Regular expression of the separator.
    """
    return _HEADER_WORD.findall(line) if separator == r"\s+" else fields(line, separator)


def lay_out(path: Path, fmt: TrialFormat | None) -> TextLayout:
    """Find out how a text file is laid out.

    Parameters
    ----------
    path : Path
        The file.
    fmt : TrialFormat or None
        What is known about it.

    Returns
    -------
    TextLayout

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


def lines_of(path: Path, encoding: str) -> Iterator[str]:
    """Yield the lines of a text file.

    Parameters
    ----------
    path : Path
        The file.
    encoding : str
        Its encoding.

    Yields
    ------
    str
        Without the end of the line.
    """
    with path.open(encoding=encoding, errors="replace", newline=None) as file:
        for line in file:
            yield line.rstrip("\r\n")


def no_samples(path: Path) -> EmptyFileError:
    """Return the error for a file without samples.

    Parameters
    ----------
    path : Path
        The file.
    """
    return EmptyFileError(
        f"'{path}' holds no samples. A trial file has a header line such as 't [s],psi [deg],r [deg/s],delta [deg]' "
        "and one row for every sample: check that the log was written and copied completely."
    )


def _stated(path: Path, fmt: TrialFormat, skip: int, encoding: str, notes: tuple[str, ...]) -> TextLayout:
    head = list(itertools.islice(lines_of(path, encoding), skip + 200))
    first = next((line for line in head[skip:] if line.strip() and not line.startswith(fmt.comment)), None)
    if first is None:
        raise no_samples(path)
    separator = fmt.separator or _separator(path, max(skip, 1), head[skip - 1] if skip else first, first)
    row = fields(first, separator)
    if len(row) < 2:
        raise _one_column(path, skip + 1, separator, first)
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
    return TextLayout(separator, decimal, encoding, fmt.comment, skip, headers, comments, len(row), notes)


def _detected(path: Path, fmt: TrialFormat | None, comment: str, encoding: str, notes: tuple[str, ...]) -> TextLayout:
    comments: list[str] = []
    header: tuple[int, str] | None = None
    first = None
    for number, line in enumerate(lines_of(path, encoding)):
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
        raise no_samples(path)
    skip, text = header[0] + 1, header[1]
    stated = fmt.separator if fmt else None
    if _is_sample(text, stated):
        # NumPy's savetxt writes the header as a comment: take the last comment if it fits.
        separator = stated or _separator(path, skip, text, text)
        names = header_fields(comments[-1], separator) if comments else []
        if len(names) != len(fields(text, separator)) or not any("[" in n or "(" in n for n in names):
            raise HeaderError(
                f"'{path}', line {skip}: the first row is a sample, so there is no header to name the columns. "
                "Write a header line such as 't [s],psi [deg],r [deg/s],delta [deg]', or describe the columns by index "
                "in a format file with header_lines = 0."
            )
        skip, text, first, comments = header[0], comments[-1], text, comments[:-1]
    if first is None:
        raise no_samples(path)
    separator = stated or _separator(path, skip, text, first)
    headers, row = header_fields(text, separator), fields(first, separator)
    if len(headers) == 1 or len(row) == 1:
        raise _one_column(path, skip, separator, text)
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
        numbers = [value for value in row if not is_stamp(value)]
        if separator != "," and any("," in value for value in numbers) and not any("." in value for value in numbers):
            decimal, notes = ",", (*notes, "The numbers are written with a decimal comma.")
    return TextLayout(separator, decimal, encoding, comment, skip, tuple(headers), tuple(comments), len(row), notes)


def _is_sample(line: str, separator: str | None) -> bool:
    """Whether a line holds numbers only, at any separator it may have."""
    candidates = [separator] if separator else list(SEPARATORS.values())
    return any(all(NUMBER.match(value) for value in fields(line, candidate)) for candidate in candidates)


def _separator(path: Path, number: int, header: str, first: str) -> str:
    """Choose the separator at which header and first sample fall into the same number of fields."""
    for separator in (";", "\t", ",", r"\s+"):
        row = fields(first, separator)
        count = len(header_fields(header, separator))
        if len(row) > 1 and count > 1 and count in (len(row), len(row) - (row[-1] == "")):
            return separator
    for separator in (";", "\t", ","):  # the header and the rows disagree: the caller says how
        if separator in header and separator in first:
            return separator
    raise _one_column(path, number, None, header)


def _one_column(path: Path, number: int, separator: str | None, line: str) -> SeparatorError:
    shown = "".join(c if c.isprintable() else "?" for c in line.strip()[:60])
    used = f"with separator '{_NAMES.get(separator, separator)}' " if separator else ""
    return SeparatorError(
        f"'{path}', line {number}: {used}there is only one column, '{shown}'. Separate the columns by comma, semicolon, "
        "tab or white space, the same in header and rows, or state the separator in a format file."
    )
