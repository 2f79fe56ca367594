"""Angles as people write them: ``48°17.9957'N``, ``12.3 P``, ``5.0 STBD``: degrees, minutes, seconds, and a letter in place of a sign."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
import pandas as pd

from shipid.trials.logs.tables.numerals import MISSING

#: Letters of the two sides: the positive one, the negative one. A column that holds both is read as that pair.
_PAIRS = (
    ("N", "S"), ("E", "W"), ("E", "O"), ("O", "W"), ("S", "P"), ("SB", "PS"), ("SB", "BB"), ("STB", "BB"), ("STBD", "PORT"),
    ("STBD", "P"), ("STB", "P"), ("STB", "PORT"), ("SB", "P"), ("SB", "PORT"), ("STBD", "PT"), ("T", "B"), ("S", "B"), ("R", "L"),
)  # fmt: skip
#: Letters that say one thing also alone. ``S`` is south or starboard, ``T`` also true, ``O`` east or west.
_ALONE = {"N": 1, "E": 1, "W": -1, "P": -1, "PORT": -1, "PS": -1, "BB": -1, "SB": 1, "STB": 1, "STBD": 1}
_WORDS = "|".join(sorted({word for pair in _PAIRS for word in pair}, key=len, reverse=True))
#: Units in lower case.
_DEGREES = ("", "deg", "degs", "degree", "degrees", "°", "º", "grad", "graden", "grados", "degré", "degrés")
#: A rate of turn has letters as well.
_PER_TIME = re.compile(r"\s*/\s*(s|sec|min)$")
_NUMBER = r"[0-9]+(?:[.,][0-9]*)?"
#: Degrees and minutes stand apart by a mark, a blank or a hyphen; what ends the minutes and the seconds is often left out.
_CELL = (
    rf"(?i)^(?P<before>{_WORDS})?\s*(?P<sign>[-+])?(?P<whole>{_NUMBER})(?:(?:\s*(?P<mark>[°º])\s*|[ -](?=\d))"
    rf"(?:(?P<minutes>{_NUMBER})(?:\s*['′’]\s*|[ -](?=\d)|(?=\s*[A-Z]|$))"
    rf"(?:(?P<seconds>{_NUMBER})\s*(?:[\"″”]|''|(?=[A-Z]|$)))?)?)?\s*(?P<behind>{_WORDS})?$"
)
#: Minutes without a mark of degrees are minutes beside one of these: 52 30.123 N.
_OF_PLACES = {"N", "S", "E", "W"}


def may_be_lettered(*units: str | None) -> bool:
    """Return whether a column can hold angles with letters: the marks are of degrees, and beside another unit nothing is certain.

    Parameters
    ----------
    *units : str or None
        What its header and a row of units say.
    """
    bare = [_PER_TIME.sub("", (unit or "").strip(". ").lower()) for unit in units]
    return all(unit in _DEGREES for unit in bare)


def read_lettered(column: pd.Series) -> tuple[np.ndarray, str] | None:
    """Read the cells of a column of angles with letters for their sides, or with degrees and minutes.

    Parameters
    ----------
    column : pandas.Series of str, shape (n,)
        The cells; NaN where one is empty.

    Returns
    -------
    values : ndarray, shape (n,)
        NaN where a cell is empty or stands for a missing sample; degrees where the cells have minutes.
    note : str
        What was read, for the notes of the trial. None for both where any cell is written in another way, where none has a letter
        or a mark, or where the letters leave the side open.
    """
    cells = column.astype("str").str.strip()
    there = (cells.notna() & ~cells.str.lower().isin(list(MISSING))).to_numpy(dtype=bool)
    if not there.any():
        return None
    cells = cells[there]
    if cells.iloc[:1].str.fullmatch(_CELL).fillna(False).sum() == 0:  # most text is none: the first cell tells
        return None
    parts = cells.str.extract(_CELL)
    side = parts["before"].where(parts["before"].notna(), parts["behind"]).astype(object).str.upper()
    marked = parts["mark"].notna()
    if (
        parts["whole"].isna().any()
        or (parts["before"].notna() & parts["behind"].notna()).any()
        or (parts["minutes"].notna() & ~marked & ~side.isin(_OF_PLACES)).any()
        or (side.notna() & parts["sign"].notna()).any()
        or not (side.notna() | marked).any()
    ):
        return None
    whole, minutes, seconds = (_numbers(parts[name]) for name in ("whole", "minutes", "seconds"))
    factor = _factors(side, parts["minutes"].notna().all())
    # 59.9996 seconds are written as 60.00.
    if factor is None or (minutes > 60).any() or (seconds > 60).any():
        return None
    # Without a letter a cell is a zero, or no cell has one.
    if side.notna().any() and (whole[side.isna().to_numpy()] != 0).any():
        return None
    sign = np.where(parts["sign"].eq("-").to_numpy(dtype=bool), -1.0, 1.0)
    values = np.full(len(column), np.nan)
    values[there] = (whole + minutes / 60 + seconds / 3600) * factor * sign
    return values, "; ".join(_said(side, parts))


def _factors(side: pd.Series, geographic: bool) -> np.ndarray | None:
    """1 or -1 by row; None where the letters do not tell."""
    seen = set(side.dropna())
    pair = next((p for p in _PAIRS if seen == set(p)), None)
    known = dict(zip(pair, (1, -1), strict=True)) if pair else {**_ALONE, **({"S": -1} if geographic else {})}
    if not pair and (len(seen) > 1 or not seen <= set(known)):
        return None
    found: np.ndarray = side.map(known).fillna(1).to_numpy(dtype=float)
    return found


def _said(side: pd.Series, parts: pd.DataFrame) -> Iterator[str]:
    if parts["minutes"].notna().any():
        yield "read as degrees and minutes"
    elif parts["mark"].notna().any():
        yield "read without the mark of degrees"
    seen = sorted(set(side.dropna()))
    if seen:
        factors = _factors(side, bool(parts["minutes"].notna().all()))
        assert factors is not None
        negative = sorted(set(side[factors < 0].dropna()))
        one, several = f"the letter {seen[0]} is the sign", f"the letters {' and '.join(seen)} are the sign"
        yield (one if len(seen) == 1 else several) + (f", {negative[0]} counts negative" if negative else "")


def _numbers(part: pd.Series) -> np.ndarray:
    text = part.str.replace(",", ".", regex=False)
    return np.asarray(pd.to_numeric(text.astype(object), errors="coerce").fillna(0.0).to_numpy(dtype=float))
