"""One line of a text table: its fields, in quotes or not, and where they run over several lines."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence

from shipid.trials.logs.tables.header_rows import is_sample_row

#: The surer ones first.
SEPARATORS_TRIED = (";", "\t", ",", "|", r"\s+")
# A header in white space: a name, and after it perhaps a unit in brackets that belongs to it.
# Possessive and bounded: a line without a blank would take the square of its length.
_HEADER_WORD = re.compile(r"[^\s\[\(]++\s*+(?:\[[^\]]{0,100}\]|\([^)]{0,100}\))|\S+")
#: Lines over which the fields of one row in quotes may run.
MOST_LINES_IN_QUOTES = 50


def fields(line: str, separator: str) -> list[str]:
    """Return the fields of a line; quotes around a field are dropped (RFC 4180).

    Parameters
    ----------
    line : str
        The line.
    separator : str
        Regular expression of the separator.
    """
    if separator == r"\s+" and '"' not in line:
        return [part.strip("'") for part in line.split()]
    # csv takes the line apart at quotes; white space counts as one blank.
    text = re.sub(r"\s+", " ", line.strip()) if separator == r"\s+" else line
    try:
        found = next(csv.reader([text], delimiter=" " if separator == r"\s+" else separator, skipinitialspace=True), [])
    except csv.Error:  # a field longer than csv takes: this is not the separator, or no line of a table
        found = [text]
    return [part.strip().strip("'") for part in found]


def header_fields(line: str, separator: str, width: int | None = None) -> list[str]:
    """Return the fields of a header line; with white space as separator a unit in brackets stays with its name.

    Parameters
    ----------
    line : str
        The line.
    separator : str
        Regular expression of the separator.
    width : int, optional
        Number of columns: names of several words are taken apart at wider spaces where that gives as many.
    """
    if separator != r"\s+":
        return fields(line, separator)
    words: list[str] = _HEADER_WORD.findall(line)
    spaced = re.split(r"\s{2,}|\t", line.strip())
    return spaced if len(words) != width and len(spaced) == width else words


def is_comment(line: str, sign: str) -> bool:
    """Return whether a line is a comment: it begins with the sign, or with that of MATLAB or C where the usual one is meant.

    Parameters
    ----------
    line : str
        The line.
    sign : str
        What starts a comment line.
    """
    start = line.lstrip()
    return start.startswith(sign) or (sign == "#" and start.startswith(("%", "//")))


def in_quotes(lines: Sequence[str], first: int) -> int:
    """Return the index behind the line in which a field in quotes ends that is opened in a line (RFC 4180).

    Parameters
    ----------
    lines : sequence of str
        The lines.
    first : int
        Index of the line with the open quote.

    Returns
    -------
    int
        ``first + 1`` where the quote is not closed in the next lines, or where a row of samples would be swallowed.
    """
    is_open = False
    for k in range(first, min(first + MOST_LINES_IN_QUOTES, len(lines))):
        is_open ^= lines[k].count('"') % 2 == 1
        if k > first and any(
            len(row := fields(lines[k].replace('"', ""), s)) > 2 and is_sample_row(row) for s in SEPARATORS_TRIED
        ):
            break
        if not is_open:
            return k + 1
    return first + 1
