"""How a text table is laid out: separator, header, units, decimal sign; detected, or taken from the format file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from shipid.trials.errors import EmptyFileError, HeaderError, RaggedRowError, SeparatorError
from shipid.trials.logs.format import SEPARATORS, TrialFormat
from shipid.trials.logs.tables.cell_units import unit_of_cell
from shipid.trials.logs.tables.files.text_fields import (
    SEPARATORS_TRIED,
    fields,
    header_fields,
    in_quotes,
    is_comment,
)
from shipid.trials.logs.tables.header_rows import HeaderBlock, find_heading, is_sample_row
from shipid.trials.logs.tables.numerals import Decimal, certain_sign
from shipid.trials.logs.tables.table import MOST_COLUMNS

_NAMES = {pattern: name for name, pattern in SEPARATORS.items()}
#: How much of a file is looked at to find its layout: lines, and characters.
_HEAD_LINES, _HEAD_SIZE = 300, 400_000
#: Header lines that a format file may state.
_MOST_HEADER_LINES = 10_000


@dataclass(frozen=True)
class TextLayout:
    """How a text file is laid out.

    Attributes
    ----------
    separator : str
        Regular expression of the separator.
    decimal : str or None
        The decimal sign, stated or seen; None where no number of the first rows shows it.
    comment : str
        What starts a comment line.
    skip : int
        Lines before the first sample.
    row : int
        Line of the header; 0 where there is none.
    headers : tuple of str
        The header's fields; none, where there is no header.
    units : tuple of str or None
        The units in a row of their own, one a column.
    comments : tuple of str
        The comment lines at the head.
    width : int
        Number of columns.
    notes : tuple of str
        What was found out and not stated.
    """

    separator: str
    decimal: Decimal | None
    comment: str
    skip: int
    row: int
    headers: tuple[str, ...]
    units: tuple[str | None, ...]
    comments: tuple[str, ...]
    width: int
    notes: tuple[str, ...] = field(default=())


@dataclass(frozen=True)
class _Row:
    """A row of the head: its first and last line in the file (from 1), its text and its fields."""

    first: int
    last: int
    text: str
    cells: list[str]


def lay_out(data: bytes, path: Path, fmt: TrialFormat | None) -> TextLayout:
    """Find out how a text file is laid out.

    Parameters
    ----------
    data : bytes
        The text in UTF-8, its lines end in a line feed.
    path : Path
        The file, for messages.
    fmt : TrialFormat or None
        What is known about it.

    Returns
    -------
    TextLayout

    Raises
    ------
    EmptyFileError, HeaderError, SeparatorError, RaggedRowError
        If it holds no samples, no header, columns that cannot be told apart, or header and samples do not fit.
    """
    comment = fmt.comment if fmt else "#"
    stated = fmt.header_lines if fmt else None
    lines = _head(data, _HEAD_LINES + min(stated or 0, _MOST_HEADER_LINES))
    if fmt is not None and stated is not None:
        return _stated(path, fmt, stated, lines)
    return _detected(path, fmt, comment, lines)


def _head(data: bytes, count: int) -> list[str]:
    """The first lines of a file."""
    lines = data[:_HEAD_SIZE].split(b"\n", count)
    if len(lines) > count or (len(data) > _HEAD_SIZE and len(lines) > 1):
        lines.pop()  # it is not whole
    return [line.decode("utf-8", "replace") for line in lines]


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


def _rows(lines: Sequence[str], separator: str, comment: str) -> list[_Row]:
    """The rows of the head without comments and blank lines; a field in quotes may run over several lines."""
    rows: list[_Row] = []
    k = 0
    while k < len(lines):
        first, text = k, lines[k]
        k += 1
        if not text.strip() or is_comment(text, comment):
            continue
        if text.count('"') % 2:
            whole = in_quotes(lines, first)
            text, k = " ".join(lines[first:whole]), whole
        rows.append(_Row(first + 1, k, text, fields(text, separator)))
    return rows


def _stated(path: Path, fmt: TrialFormat, skip: int, lines: list[str]) -> TextLayout:
    named = [column.column for column in fmt.columns.values() if column.column is not None]
    first = next((line for line in lines[skip:] if line.strip() and not line.startswith(fmt.comment)), None)
    if first is None:
        raise no_samples(path)
    separator = fmt.separator or _separator(path, max(skip, 1), lines[skip - 1] if skip else first, first)
    row = fields(first, separator)
    if len(row) < 2:
        raise _one_column(path, skip + 1, separator, first)
    _check_width(path, len(row))
    heads = [header_fields(line, separator, len(row)) for line in lines[:skip]]
    # The last header line names the columns, or the last one that holds every name of the format file.
    whole = [k for k, head in enumerate(heads) if named and set(named) <= set(head) and len(head) == len(row)]
    at = whole[-1] if whole else skip - 1
    headers = tuple(heads[at]) if skip else ()
    if named and len(headers) != len(row):
        raise HeaderError(
            f"'{path}', line {skip}: the header names {len(headers)} columns and the first sample has {len(row)}. "
            f"Correct header_lines (now {skip}) or separator in the format file '{fmt.name}', or address columns by "
            "index."
        )
    comments = tuple(line[len(fmt.comment) :].strip() for line in lines[:skip] if line.startswith(fmt.comment))
    cells = [cell for line in lines[skip:] for cell in fields(line, separator)] if fmt.decimal is None else []
    decimal = _decimal(fmt, cells)
    none = (None,) * len(row)
    return TextLayout(separator, decimal, fmt.comment, skip, at + 1, headers, none, comments, len(row))


def _detected(path: Path, fmt: TrialFormat | None, comment: str, lines: list[str]) -> TextLayout:
    wanted = {column.column for column in fmt.columns.values() if column.column} if fmt else set()
    marks = f"{comment}%/" if comment == "#" else comment
    written = [(k, line.strip().lstrip(marks).strip()) for k, line in enumerate(lines) if is_comment(line, comment)]
    separator, rows, heading = _best(path, fmt, comment, lines, wanted)
    if heading is None:
        raise _without_samples(path, rows, separator)
    width, first = heading.width, rows[heading.first]
    if width < 2:
        raise _one_column(path, first.first, separator, first.text)
    _check_width(path, width)
    units: tuple[str | None, ...] = (None,) * width
    comments = [text for k, text in written if k < first.first]
    notes: list[str] = []
    if heading.row is None:
        # NumPy's savetxt writes the header as a comment.
        headers, units, at = _commented(written, rows[heading.first :], separator, width, path)
        comments.remove(written[at][1])
        row = written[at][0] + 1
    else:
        headers, units = list(heading.names), heading.units
        row = rows[heading.row].last
        if len(headers) != width:  # a header with commas over samples between blanks
            text = rows[heading.row].text
            if '"' not in text:
                headers = next(
                    (h for s in SEPARATORS_TRIED if len(h := header_fields(text, s, width)) == width), headers
                )
            elif len(headers) == width - 1 and first.text.lstrip().startswith('"1"'):
                headers = ["", *headers]  # R's write.table names all columns but that of the row names
        if len(headers) == width + 1 and headers[-1].lower() == "comment":
            headers = headers[:-1]  # LabVIEW writes the word and, where nothing was said, no field below it
        _check_fit(path, row, headers, rows[heading.first], separator)
        headers += [""] * (width - len(headers))  # every row ends with a separator
        notes += _unused(rows, heading)
    twice = sorted({name for name in headers if name and headers.count(name) > 1})
    if twice and fmt is None:
        raise HeaderError(f"'{path}', line {row}: the header names '{twice[0]}' twice. Rename one of the two columns.")
    cells = [cell for sample in rows[heading.first :] for cell in sample.cells]
    decimal = _decimal(fmt, cells)
    if decimal == "," and (fmt is None or fmt.decimal is None):
        notes.append("The numbers are written with a decimal comma.")
    return TextLayout(
        separator, decimal, comment, first.first - 1, row, tuple(headers), units, tuple(comments), width, tuple(notes)
    )


def _best(
    path: Path, fmt: TrialFormat | None, comment: str, lines: list[str], wanted: set[str]
) -> tuple[str, list[_Row], HeaderBlock | None]:
    """The separator at which most cells are numbers under a header that fits, with its rows and its header."""
    best: tuple[str, list[_Row], HeaderBlock | None] | None = None
    most = (-1, -1.0)
    for separator in (fmt.separator,) if fmt and fmt.separator else SEPARATORS_TRIED:
        rows = _rows(lines, separator, comment)
        if separator == r"\s+":
            sample = [is_sample_row(row.cells) for row in rows]
            lengths = Counter(len(row.cells) for row, plain in zip(rows, sample) if plain)
            width = lengths.most_common(1)[0][0] if lengths else None
            words = [header_fields(row.text, separator, width) for row in rows]
            cells = [row.cells if plain else head for row, plain, head in zip(rows, sample, words)]
            rows = [_Row(row.first, row.last, row.text, new) for row, new in zip(rows, cells)]
        heading = find_heading([row.cells for row in rows], wanted, f"'{path}'")
        if heading is None or (heading.width < 2 and not (fmt and fmt.separator)):
            rating = (-1, 0.0) if heading is None else (0, 0.0)
        else:
            rating = (1 + (len(heading.names) in (heading.width, heading.width - 1)), heading.sound)
        if best is None or rating > most:
            best, most = (separator, rows, heading), rating
    assert best is not None
    return best


def _without_samples(path: Path, rows: Sequence[_Row], separator: str) -> EmptyFileError | SeparatorError:
    """The error for a file without a row of numbers."""
    if len(rows) > 1 and not any(len(fields(row.text, s)) > 1 for row in rows for s in SEPARATORS_TRIED[:-1]):
        shown = rows[0].text
        return _one_column(path, rows[0].first, separator if len(shown.split()) > 1 else None, shown)
    return no_samples(path)


def _commented(
    written: Sequence[tuple[int, str]], samples: Sequence[_Row], separator: str, width: int, path: Path
) -> tuple[list[str], tuple[str | None, ...], int]:
    """Names and units in comment lines above the samples, and which line holds the names."""
    above = [k for k, (number, _) in enumerate(written) if number < samples[0].first]
    for candidate in dict.fromkeys((separator, ",", r"\s+")):
        heads = {k: header_fields(written[k][1], candidate, width) for k in above}
        fitting = [k for k in above if len(heads[k]) == width]
        block = find_heading([*(heads[k] for k in fitting), *(row.cells for row in samples)], (), f"'{path}'")
        if block is not None and block.row is not None and block.row < len(fitting):
            bracketed = any("[" in name or "(" in name for name in block.names)
            if bracketed or any(unit is not None for unit in block.units):
                return list(block.names), block.units, fitting[block.row]
    raise HeaderError(
        f"'{path}', line {samples[0].first}: the first row is a sample, so there is no header to name the columns. "
        "Write a header line such as 't [s],psi [deg],r [deg/s],delta [deg]', or describe the columns by index "
        "in a format file: shipid format FILE drafts one."
    )


def _check_fit(path: Path, row: int, headers: Sequence[str], first: _Row, separator: str) -> None:
    sample = first.cells
    if len(headers) == len(sample) or (len(sample) == len(headers) + 1 and sample[-1] == ""):
        return
    apart = "Give every column a header and every row as many fields."
    # Between blanks a number and the unit behind it are two fields.
    behind = [f"{cell} {unit}" for cell, unit in pairwise(sample) if unit_of_cell(f"{cell} {unit}") is not None]
    if separator == r"\s+" and behind:
        apart = (
            f"Units stand behind the numbers, as in '{behind[-1]}', and blanks separate the columns too: write the units in the header, "
            "as in 'u[kn]', and leave them out of the rows, or separate the columns by semicolons."
        )
    raise RaggedRowError(
        f"'{path}': the header (line {row}) names {len(headers)} columns and the first sample (line {first.first}) has "
        f"{len(sample)}. {apart}"
    )


def _check_width(path: Path, width: int) -> None:
    if width > MOST_COLUMNS:
        raise SeparatorError(
            f"'{path}' has {width} columns, and at most {MOST_COLUMNS} are read. Check the separator, or leave columns out."
        )


def _unused(rows: Sequence[_Row], heading: HeaderBlock) -> list[str]:
    """A note about lines above the samples that are neither names nor units."""
    if not heading.unused:
        return []
    at = [rows[k].first for k in heading.unused]
    text = rows[heading.unused[0]].text.strip()
    shown = text if len(text) <= 40 else f"{text[:40]}..."
    which = f"Line {at[0]}" if len(at) == 1 else f"Lines {', '.join(map(str, at[:5]))}{', ...' if len(at) > 5 else ''}"
    return [f"{which} above the samples {'was' if len(at) == 1 else 'were'} not used: '{shown}'."]


def _decimal(fmt: TrialFormat | None, cells: Sequence[str]) -> Decimal | None:
    """The decimal sign: stated, or that of the many cells that can be read in one way only."""
    if fmt is not None and fmt.decimal is not None:
        return "," if fmt.decimal == "," else "."
    signs = [certain_sign(cell) for cell in cells]
    comma, point = signs.count(","), signs.count(".")
    return None if comma == point else "," if comma > point else "."


def _separator(path: Path, number: int, header: str, first: str) -> str:
    """Choose the separator at which header and first sample fall into the same number of fields."""
    for separator in SEPARATORS_TRIED:
        row = fields(first, separator)
        count = len(header_fields(header, separator))
        if len(row) > 1 and count > 1 and count in (len(row), len(row) - (row[-1] == "")):
            return separator
    for separator in (";", "\t", ","):  # the header and the rows disagree: the caller says how
        if separator in header and separator in first:
            return separator
    raise _one_column(path, number, None, header)


def _one_column(path: Path, number: int, separator: str | None, line: str) -> SeparatorError:
    shown = line.strip()[:60]
    used = f"with separator '{_NAMES.get(separator, separator)}' " if separator else ""
    return SeparatorError(
        f"'{path}', line {number}: {used}there is only one column, '{shown}'. Separate the columns by comma, semicolon, "
        "tab or white space, the same in header and rows, or state the separator in a format file."
    )
