"""Text tables: the numbers are parsed by pandas' C engine; what it cannot read is looked at cell by cell."""

from __future__ import annotations

import io
import itertools
import re
import warnings
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from shipid.trials.errors import ForeignFileError, RaggedRowError, SeparatorError
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.tables.files.encodings import legacy_encoding
from shipid.trials.logs.tables.files.text_fields import MOST_LINES_IN_QUOTES, fields, in_quotes, is_comment
from shipid.trials.logs.tables.files.text_layout import TextLayout, lay_out, no_samples
from shipid.trials.logs.tables.kinds import is_utf16
from shipid.trials.logs.tables.numerals import MISSING
from shipid.trials.logs.tables.table import RawTable, decimals_shown

#: A line of a log: ten thousand columns of a hundred characters.
LONGEST_LINE = 1_000_000
#: What no line of text holds: control characters but for tab, new line and form feed.
_GARBLED = re.compile(rb"[\x00-\x08\x0e-\x1f\x7f]")
_MARKS = sorted(
    {form for mark in MISSING for form in (mark, mark.upper(), mark.capitalize())} | {"NaN", "-NaN", "NaT", "<NA>"}
)
# Words of a spreadsheet that begin with the usual sign of a comment.
_HASH_WORDS = rb"(?!N/A|NA\b|NV\b|DIV/0!|NUM!|VALUE!|REF!|NAME\?|NULL!)"


def read_text(data: bytes, file: Path, fmt: TrialFormat | None) -> RawTable:
    """Read a text file.

    Parameters
    ----------
    data : bytes
        What it holds, expanded.
    file : Path
        The file, for messages.
    fmt : TrialFormat or None
        What is known about it.

    Returns
    -------
    RawTable

    Raises
    ------
    EmptyFileError, HeaderError, SeparatorError, RaggedRowError
        If it holds no samples, no header, columns that cannot be told apart, or a row that is too long.
    """
    text, notes = _in_utf8(data, fmt.encoding if fmt else None)
    text = text.replace(b"\r\n", b"\n").replace(b"\r", b"\n").replace(b"\x0c", b"").rstrip(b"\0\x1a \n")
    if not text:
        raise no_samples(file)
    _check_lines(text, file)
    layout = lay_out(text, file, fmt)
    header = text.split(b"\n", layout.row)[max(layout.row - 1, 0)]
    commented = layout.row > 0 and is_comment(header.decode("utf-8", "replace"), layout.comment)
    text, more = _without_garbled(text, layout, file)
    text = _with_whole_rows(_without_comments(text, layout), layout)
    columns = _columns(text, layout, file)
    decimal = layout.decimal
    if decimal is None and decimals_shown(columns):
        decimal = "."
    if decimal is None and any(column.dtype.kind == "f" for column in columns.values()):
        # No number shows for certain which sign is the decimal one: look at all of them as they are written.
        columns = _columns(text, layout, file, as_text=True)
    return RawTable(
        name=file.stem,
        where=f"'{file}'",
        headers=layout.headers,
        columns=tuple(columns.values()),
        units=layout.units,
        header=f", line {layout.row}",
        row="line",
        line=partial(line_of, text, layout),
        comments=layout.comments,
        notes=(*notes, *layout.notes, *more),
        decimal=decimal,
        printed=lambda k: _columns(text, layout, file, as_text=True)[k],
        separator=layout.separator,
        skip=None if commented else layout.skip,
    )


def _in_utf8(data: bytes, stated: str | None) -> tuple[bytes, list[str]]:
    """The text in UTF-8: from the encoding that is stated, else from UTF-16, UTF-8 or an older one (a logger's degree sign)."""
    if stated is None and (wide := is_utf16(data)):
        return data.decode(wide, "replace").lstrip("\ufeff").encode("utf-8", "replace"), [
            f"The text is {wide.upper()[:6]}."
        ]
    if stated is not None:
        return data.decode(stated, "replace").lstrip("\ufeff").encode("utf-8", "replace"), []
    head = data[:65536]
    try:
        (head if len(data) <= len(head) else head[: head.rfind(b"\n") + 1]).decode("utf-8")
    except UnicodeDecodeError:
        encoding = legacy_encoding(head)
        return data.decode(encoding, "replace").encode("utf-8"), [f"The text is not UTF-8; it was read as {encoding}."]
    return data.removeprefix(b"\xef\xbb\xbf"), []


def _check_lines(text: bytes, file: Path) -> None:
    ends = np.flatnonzero(np.frombuffer(text, dtype=np.uint8) == 10)
    lengths = np.diff(ends, prepend=-1, append=len(text)) - 1
    if lengths.max() > LONGEST_LINE:
        number = int(np.argmax(lengths > LONGEST_LINE)) + 1
        raise SeparatorError(
            f"'{file}', line {number} has {int(lengths[number - 1])} characters, and at most {LONGEST_LINE} are read. "
            "Check that it is a log with one row for every sample."
        )


def _without_garbled(text: bytes, layout: TextLayout, file: Path) -> tuple[bytes, list[str]]:
    """Empty the lines that hold control characters: what a bad connection or a failing disk leaves of a row."""
    if not _GARBLED.search(text):
        return text, []
    lines = text.split(b"\n")
    at = [k for k, line in enumerate(lines) if k >= layout.skip and _GARBLED.search(line)]
    if len(at) > 0.1 * (len(lines) - layout.skip) + 1:
        raise ForeignFileError(
            f"'{file}' is no text: {len(at)} of {len(lines)} lines hold control characters, the first is line {at[0] + 1}. "
            "Check that it was copied completely."
        )
    for k in at:
        lines[k] = b""
    shown = ", ".join(str(k + 1) for k in at[:5]) + (", ..." if len(at) > 5 else "")
    many = "1 line holds" if len(at) == 1 else f"{len(at)} lines hold"
    notes = [f"{many} control characters and {'was' if len(at) == 1 else 'were'} left out: line {shown}."] if at else []
    return b"\n".join(lines), notes


def _without_comments(text: bytes, layout: TextLayout) -> bytes:
    """Empty comment lines, and cut comments behind samples; the numbers of the lines stay."""
    sign = re.escape(layout.comment.encode())
    if layout.comment == "#":
        text = re.sub(rb"(?m)^[ \t]*(?:%|//)[^\n]*", b"", text)
        sign += _HASH_WORDS
    return re.sub(rb"(?m)(^[ \t]*|[ \t]+)" + sign + rb"[^\n]*", b"", text)


def _with_whole_rows(text: bytes, layout: TextLayout) -> bytes:
    """Write rows whose fields in quotes hold line ends in one line each; the numbers of the lines stay."""
    body = text.split(b"\n") if b'"' in text else []
    odd = [k for k, line in enumerate(body) if k >= layout.skip and line.count(b'"') % 2]
    if not odd:
        return text
    behind = layout.skip
    for k in odd:
        if k < behind:
            continue
        lines = [line.decode("utf-8", "replace") for line in body[k : k + MOST_LINES_IN_QUOTES]]
        behind = k + in_quotes(lines, 0)
        body[k:behind] = [b" ".join(body[k:behind]), *[b""] * (behind - k - 1)]
    return b"\n".join(body)


def _columns(text: bytes, layout: TextLayout, file: Path, *, as_text: bool = False) -> dict[int, pd.Series]:
    """Parse the samples: columns of numbers as numbers, the others as text, NaN where a field is empty."""
    try:
        table = _parsed(text, layout, layout.width, as_text)
    except pd.errors.EmptyDataError:
        raise no_samples(file) from None
    except (pd.errors.ParserError, pd.errors.ParserWarning, ValueError, OverflowError) as error:
        _check_quotes(text, layout, file)
        widest = _widest(text, layout, file)
        try:
            table = _parsed(text, layout, max(widest, layout.width), as_text)
        except (pd.errors.ParserError, pd.errors.ParserWarning, ValueError, OverflowError):
            raise RaggedRowError(
                f"'{file}' could not be parsed: {' '.join(str(error).split())}. Check its rows, or state a format file."
            ) from None
    if table.empty:
        raise no_samples(file)
    _check_quotes(text, layout, file)
    if layout.separator == r"\s+" and bool(table[layout.width - 1].isna().any()):
        _check_short(text, layout, file)
    return {k: table[k] for k in range(layout.width)}


def _parsed(text: bytes, layout: TextLayout, width: int, as_text: bool) -> pd.DataFrame:
    with warnings.catch_warnings():
        warnings.simplefilter("error", pd.errors.ParserWarning)
        # No usecols: told which columns to use, pandas drops what a row has too much of without a word.
        return pd.read_csv(
            _body(text, layout.skip),
            sep=layout.separator,
            header=None,
            names=list(range(width)),
            index_col=False,
            dtype="str" if as_text else None,
            decimal=layout.decimal or ".",
            na_values=_MARKS,
            keep_default_na=False,
            skipinitialspace=True,
            encoding="utf-8",
            encoding_errors="replace",
            engine="c",
            low_memory=False,
        )


def _body(text: bytes, skip: int) -> io.BytesIO:
    """The text behind some lines: a header in quotes may run over several, which pandas would count as one."""
    body = io.BytesIO(text)
    for _ in range(skip):
        body.readline()
    return body


def _samples(text: bytes, layout: TextLayout) -> Iterator[tuple[int, str]]:
    """Yield line number (from 1) and text of every sample line: only walked to explain what is wrong."""
    for number, line in enumerate(io.BytesIO(text), start=1):
        if number > layout.skip and line.strip():
            yield number, line.decode("utf-8", "replace").rstrip("\n")


def line_of(text: bytes, layout: TextLayout, row: int) -> int:
    """Return the line number in the file (from 1) of a sample (from 0).

    Parameters
    ----------
    text : bytes
        The text.
    layout : TextLayout
        How it is laid out.
    row : int
        The sample.
    """
    return next(itertools.islice((number for number, _ in _samples(text, layout)), row, None), row)


def _widest(text: bytes, layout: TextLayout, file: Path) -> int:
    """Return the largest number of fields of a row; a row that holds more than there are columns is refused."""
    widest = 0
    for number, line in _samples(text, layout):
        row = fields(line, layout.separator)
        if any(row[layout.width :]):
            raise RaggedRowError(
                f"'{file}', line {number}: the row has {len(row)} fields, the first sample {layout.width}. "
                "Complete or remove the row; a text field must not contain the separator."
            )
        widest = max(widest, len(row))
    return widest


def _check_short(text: bytes, layout: TextLayout, file: Path) -> None:
    """Refuse a row with a hole between blanks, where nothing tells which field is missing; the last row may be cut short."""
    short = None
    for number, line in _samples(text, layout):
        if short is not None:
            raise RaggedRowError(
                f"'{file}', line {short}: the row has fewer fields than the {layout.width} of the first sample, and between blanks "
                "nothing tells which one is missing. Write nan for it, or separate the columns by commas."
            )
        short = number if len(fields(line, layout.separator)) < layout.width else None


def _check_quotes(text: bytes, layout: TextLayout, file: Path) -> None:
    """Refuse a quote that is not closed in its line, where the line is a whole row: it would swallow the rows behind it."""
    if b'"' not in text:
        return
    for number, line in _samples(text, layout):
        if line.count('"') % 2 and len(fields(line.replace('"', ""), layout.separator)) >= layout.width:
            raise RaggedRowError(
                f"'{file}', line {number}: a quote is opened or closed alone. Remove it, or write the other one."
            )
