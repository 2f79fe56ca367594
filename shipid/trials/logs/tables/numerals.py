"""Numbers as they are written: decimal point or comma, thousands, exponents of Fortran, and the marks of a missing sample.

One convention holds for a file. It is stated in a format file, or follows from cells that can be read in one way only:
``0,6`` has a decimal comma, ``1,002.56`` a decimal point and commas between thousands. ``1,234`` alone can be both, and is
refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd

from shipid.trials.errors import AmbiguousNumberError

Decimal = Literal[".", ","]

#: What stands for a missing sample, in small letters. Spreadsheets write the words with # where a formula found no number.
MISSING = frozenset(
    ("", "-", "--", "---", "nan", "-nan", "na", "n/a", "n.a.", "nil", "none", "null", "<na>", "nat", "missing", "n/v", "ovf",
     "#n/a", "#na", "#nv", "#div/0!", "#num!", "#value!", "#ref!", "#name?", "#null!", "1.#qnan", "-1.#ind", "1.#ind")
)  # fmt: skip

_EXPONENT = r"(?:[eEdD][-+]?[0-9]{1,4})?"
# Fortran leaves the letter out of an exponent of three digits.
_FORTRAN = r"[-+]?[0-9]*\.[0-9]+[-+][0-9]{3}"
_INFINITE = r"[-+]?[iI][nN][fF](?:[iI][nN][iI][tT][yY])?"
#: Cells of a column that are looked at first.
_FIRST = 10_000
_SPACES = " '’\u00a0\u2009\u202f"


def _plain(decimal: str) -> str:
    return rf"[-+]?(?:[0-9]+(?:{re.escape(decimal)}[0-9]*)?|{re.escape(decimal)}[0-9]+){_EXPONENT}"


def _grouped(separator: str, tail: str) -> str:
    """Thousands in groups of three; a number does not begin with a group of zeros."""
    return rf"[-+]?[1-9][0-9]{{0,2}}(?:[{separator}][0-9]{{3}})+{tail}"


_OTHER: dict[str, Decimal] = {".": ",", ",": "."}


@dataclass(frozen=True)
class _Patterns:
    """How numbers are written with one decimal sign."""

    #: Every number that can be read.
    number: str
    #: What can be read with this sign only, but for `one_group`.
    certain: str
    #: Three decimals, which can be thousands.
    one_group: str
    #: Thousands in one group and nothing behind it: with the other sign it would be a decimal number.
    doubtful: str
    #: Thousands for certain.
    thousands: str


def _patterns(decimal: Decimal) -> _Patterns:
    # No look-ahead in them: Arrow's engine, which is ten times as fast as Python's, has none.
    sign, other = re.escape(decimal), re.escape(_OTHER[decimal])
    fortran = (_FORTRAN,) if decimal == "." else ()
    tail = rf"(?:{sign}[0-9]*)?{_EXPONENT}"
    several = rf"[-+]?[1-9][0-9]{{0,2}}(?:{other}[0-9]{{3}}){{2,}}"
    numbers = (_plain(decimal), _grouped(other, tail), _grouped(_SPACES, tail), *fortran, _INFINITE)
    certain = (
        rf"[-+]?(?:[0-9]+{sign}[0-9]*|{sign}[0-9]+){_EXPONENT}",
        _grouped(other, rf"{sign}[0-9]*{_EXPONENT}"),
        several,
        _grouped(_SPACES, rf"{sign}[0-9]*{_EXPONENT}"),
        *fortran,
    )
    return _Patterns(
        number="|".join(numbers),
        certain="|".join(certain),
        one_group=rf"[-+]?[1-9][0-9]{{0,2}}{sign}[0-9]{{3}}",
        doubtful=rf"[-+]?[1-9][0-9]{{0,2}}{other}[0-9]{{3}}",
        thousands=rf"{_grouped(other, sign)}[0-9]*|{several}",
    )


_BY_SIGN: dict[Decimal, _Patterns] = {".": _patterns("."), ",": _patterns(",")}
_ANY_NUMBER = re.compile(f"{_BY_SIGN['.'].number}|{_BY_SIGN[','].number}")
_CERTAIN = {sign: re.compile(patterns.certain) for sign, patterns in _BY_SIGN.items()}
_ONE_GROUP = {sign: re.compile(patterns.one_group) for sign, patterns in _BY_SIGN.items()}


def is_number(text: str) -> bool:
    """Return whether a cell is a number, however it is written.

    Parameters
    ----------
    text : str
        The cell.
    """
    return _ANY_NUMBER.fullmatch(tidy(text)) is not None


def is_missing(text: str) -> bool:
    """Return whether a cell stands for a missing sample.

    Parameters
    ----------
    text : str
        The cell.
    """
    return text.strip().lower() in MISSING


def certain_sign(text: str) -> Decimal | None:
    """Return the decimal sign of a number that can be read in one way only.

    Parameters
    ----------
    text : str
        The cell.

    Returns
    -------
    str or None
    """
    text = tidy(text)
    found = (s for s in _BY_SIGN if _CERTAIN[s].fullmatch(text) and not _ONE_GROUP[s].fullmatch(text))
    return next(found, None)


def tidy(text: str) -> str:
    """Return a cell without blanks and quotes around it, with a plain minus sign.

    Parameters
    ----------
    text : str
        The cell.
    """
    return text.strip().strip("\"'").strip().replace("\u2212", "-")


def shows_decimals(values: np.ndarray) -> bool:
    """Return whether numbers that were read have decimals, and cannot be thousands in groups of three.

    Parameters
    ----------
    values : ndarray of float
        Numbers, read with one decimal sign.
    """
    values = np.abs(values[np.isfinite(values)])
    broken = values[values != np.round(values)]
    thousandths = broken * 1000
    return bool(np.any((broken < 1) | (broken >= 1000) | (np.abs(thousandths - np.round(thousandths)) > 1e-6)))


def sign_of_file(columns: Sequence[pd.Series], seen: Decimal | None, where: str) -> Decimal:
    """Return the decimal sign of the numbers in cells of text.

    Parameters
    ----------
    columns : sequence of pandas.Series of str
        The cells, by column; NaN where a cell is empty.
    seen : str or None
        The sign of numbers with decimals that were read already.
    where : str
        File, for messages.

    Returns
    -------
    str
        The sign that cells which can be read in one way only have; where there are some of both kinds, that of the many.

    Raises
    ------
    AmbiguousNumberError
        If cells such as ``1,234`` are there and nothing tells how they are meant.
    """
    cells = [_tidied(column) for column in columns]
    sign: Decimal | None = seen
    if sign is None:
        counts = {s: sum(int(_is_certain(column, s).sum()) for column in cells) for s in _BY_SIGN}
        if counts[","] != counts["."]:
            sign = "," if counts[","] > counts["."] else "."
    for column in cells:
        cell = _doubtful(column, sign)
        if cell is not None:
            bare = cell.replace(",", "").replace(".", "")
            raise AmbiguousNumberError(
                f"{where}, column '{column.name}': '{cell}' can be {bare} or {cell.replace(',', '.')}, and nothing tells. "
                "State decimal = 'comma' or decimal = 'point' in a format file."
            )
    return sign or "."


def _doubtful(column: pd.Series, sign: Decimal | None) -> str | None:
    """A cell of a column of which the sign of the file does not tell how it is meant; None where there is none."""
    if sign is None:
        comma, point = (_matches(column, _BY_SIGN[s].doubtful) for s in (".", ","))
        # 998 beside 1.002: a decimal point would have been written in both.
        found = comma if comma.any() else point & _matches(column, r"[-+]?[1-9][0-9]{2}").any()
    else:
        # One sign for the whole file is likely, not certain: a column has to have a number that can only be read with it.
        first = column.head(_FIRST)
        if (_is_certain(first, sign) | _matches(first, "[-+]?[0-9]{1,3}")).any():
            return None
        found = _matches(column, _BY_SIGN[sign].doubtful)
        if (_is_certain(column, sign) | _matches(column, "[-+]?[0-9]{1,3}")).any():
            return None
    return str(column[found].iloc[0]) if found.any() else None


def read_numbers(column: pd.Series, sign: Decimal) -> tuple[np.ndarray, np.ndarray]:
    """Read the cells of a column.

    Parameters
    ----------
    column : pandas.Series of str, shape (n,)
        The cells; NaN where one is empty.
    sign : str
        The decimal sign.

    Returns
    -------
    values : ndarray, shape (n,)
        NaN where a cell is empty, stands for a missing sample, or is no number.
    strange : ndarray of bool, shape (n,)
        Cells that are neither a number nor a mark of a missing sample.
    """
    cells = _tidied(column)
    there = cells.notna().to_numpy() & ~cells.str.lower().isin(list(MISSING)).to_numpy(dtype=bool)
    patterns = _BY_SIGN[sign]
    number = there & _matches(cells, patterns.number)
    # A thousand that others in its column write without a sign, or a number without the decimals that others have: a typing error.
    doubtful = number & _matches(cells, patterns.doubtful)
    if doubtful.any():
        others = number & ~doubtful
        decimals = others & _matches(cells, rf".*[0-9]{re.escape(sign)}[0-9].*")
        ungrouped = others & _matches(cells, r"[-+]?[0-9]{4,}.*")
        if (decimals.any() and not _matches(cells, patterns.thousands).any()) or ungrouped.any():
            number &= ~doubtful
    written = cells.where(number, "nan")
    written = written.str.replace(f"[{_SPACES}{_OTHER[sign]}]", "", regex=True).str.replace(sign, ".", regex=False)
    written = written.str.replace("[dD]", "e", regex=True)
    written = written.str.replace(r"^([-+]?[0-9.]+)([-+][0-9]{3})$", r"\1e\2", regex=True)
    values = pd.to_numeric(written.astype(object), errors="coerce").to_numpy(dtype=float, copy=True)
    return values, there & ~number


def _tidied(column: pd.Series) -> pd.Series:
    column = column.astype("str")
    return column.str.strip().str.strip("\"'").str.strip().str.replace("\u2212", "-", regex=False)


def _is_certain(cells: pd.Series, sign: Decimal) -> np.ndarray:
    return np.asarray(_matches(cells, _BY_SIGN[sign].certain) & ~_matches(cells, _BY_SIGN[sign].one_group))


def _matches(cells: pd.Series, pattern: str) -> np.ndarray:
    found: np.ndarray = cells.str.fullmatch(pattern).fillna(False).to_numpy(dtype=bool)
    return found
