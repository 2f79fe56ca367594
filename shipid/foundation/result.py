"""What all results have in common: printed in ten lines, shown as a table in a notebook, drawn as the report draws them.

A result is data and knows nothing of reports. The figures are asked for by the name ``shipid.plot``: the face of the package
knows where that is at home, and loads it then.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief, interval, number, uncertain, unit_of_name
from shipid.foundation.printable import printable

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

#: Most lines, and most characters of one, that a result prints.
LINES, WIDTH = 10, 160
#: Rows of a table that a notebook shows in full, and how many it shows of a longer one.
_ALL_ROWS, _ROWS = 60, 20
#: What a person reads instead of a unit of SI, and how many of it are one.
_READ = {"rad": ("deg", 180 / np.pi), "rad/s": ("deg/s", 180 / np.pi)}
#: A smaller number in a file is what arithmetic leaves of zero: no quantity of a ship is so small in any unit.
_LEAST = 1e-30


class Result:
    """A result of the toolbox: every one has a text and a table.

    Both are made of the fields of the dataclass. A class with more to say states `text`, one with another table `to_frame`.

    Attributes
    ----------
    TABLE : str
        The field along which the table runs: entries of a result (a row each), or an array beside which others stand. Where there
        is none, the table has a row for each field.
    UNITS : mapping of str to str
        Units of the numbers, by field, where the name does not end in the unit; ``"1"`` for a pure number, ``"SI"`` where it
        depends on what is looked at, empty for a count or a flag. Where a field ``unit`` says it, nothing is stated.
    """

    TABLE: ClassVar[str] = ""
    UNITS: ClassVar[Mapping[str, str]] = {}

    def text(self) -> str:
        """Return everything the result says, in lines of text; what is printed are the first of them."""
        return "\n".join([type(self).__name__, *_field_lines(self)])

    def to_frame(self) -> pd.DataFrame:
        """Return the result as a pandas table, SI, units beside the numbers."""
        if not self.TABLE:
            rows = [{"name": n, "value": _cell(v), "unit": _unit(self, n, v)} for n, v in _fields(self)]
            return table(rows, "name", ("value", "unit"))
        along = getattr(self, self.TABLE)
        if isinstance(along, tuple) and all(dataclasses.is_dataclass(e) for e in along):
            return table(
                [{_header(e, n, v): _cell(v) for n, v in _fields(e)} | {"": k} for k, e in enumerate(along)], ""
            )
        return _beside(self, len(along))

    def __repr__(self) -> str:
        return shortened(self.text(), _serious(self))

    def _repr_html_(self) -> str:
        """The result in a notebook: its first line, serious warnings, its table, and everything else folded."""
        text = printable(self.text())
        head, _, rest = text.partition("\n")
        parts = [f"<p><strong>{escape(head)}</strong></p>"]
        if serious := _serious(self):
            parts.append(f"<ul>{''.join(f'<li>{escape(printable(str(w)))}</li>' for w in serious)}</ul>")
        frame, words = self.to_frame(), f"<pre>{escape(rest)}</pre>" if rest else ""
        if frame.empty:
            parts.append(words)
        else:
            parts.append(_table(frame))
            # Where the text is made of the fields, as the table is, it says nothing more.
            if words and (self.TABLE or type(self).text is not Result.text):
                parts.append(f"<details><summary>In words</summary>{words}</details>")
        return f"<div>{''.join(parts)}</div>"


class Printed:
    """What is no result and has no table, such as a filter: a notebook shows it as it prints, without running over the page."""

    def _repr_html_(self) -> str:
        return f'<pre style="white-space: pre-wrap">{escape(printable(repr(self).strip("<>")))}</pre>'


class ResultEntry:
    """A single entry of a result, such as an estimate: it prints as a line of words, its numbers with their units.

    A class with words of its own states ``__str__``; units are stated as those of a result (`Result.UNITS`).
    """

    UNITS: ClassVar[Mapping[str, str]] = {}

    def __repr__(self) -> str:
        own = type(self).__str__ is not object.__str__
        words = (
            str(self) if own else f"{type(self).__name__}: {', '.join(' '.join(f.split()) for f in _field_lines(self))}"
        )
        return shortened(words)

    def _repr_html_(self) -> str:
        return f'<pre style="white-space: pre-wrap">{escape(printable(repr(self)))}</pre>'


class DrawnResult(Result):
    """A result with a report, and so with figures."""

    def plot(self, which: str | None = None) -> Figure:
        """Return a figure of the result's report as a matplotlib figure; a notebook shows it.

        Parameters
        ----------
        which : str, optional
            Words out of the title of the figure, such as ``"track"``; by default the first figure of the report.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        UnknownNameError
            If no figure has these words in its title; the message lists the figures there are.
        """
        import shipid

        figure: Figure = shipid.plot(self, which)
        return figure


def shortened(text: str, first: tuple[Notice, ...] = ()) -> str:
    """Return a text in at most ten lines; where some are left out, the last line says how many there are.

    Parameters
    ----------
    text : str
        Any number of lines.
    first : tuple of Notice
        Warnings that are not left out: they follow the first line where the text is shortened.
    """
    lines = text.splitlines()
    if len(lines) > LINES:
        warned = [f"  WARNING   {warning}" for warning in first[: LINES - 4]]
        # What a warning says is said once.
        rest = [line for line in lines[1:] if not any(str(warning) in line for warning in first[: LINES - 4])]
        kept = rest[: LINES - 2 - len(warned)]
        lines = [
            lines[0],
            *warned,
            *kept,
            *([f"  … {len(rest) - len(kept)} more lines: print(….text())"] if len(kept) < len(rest) else ()),
        ]
    return "\n".join(line if len(line) <= WIDTH else f"{line[: WIDTH - 1]}…" for line in lines)


def table(rows: Iterable[Mapping[str, Plain]], index: str | list[str], columns: Sequence[str] = ()) -> pd.DataFrame:
    """Return rows as a pandas table.

    Parameters
    ----------
    rows : iterable of mapping
        The cells of each row by column.
    index : str or list of str
        The column, or columns, that name the rows.
    columns : sequence of str
        The other columns, where there may be no row.
    """
    import pandas as pd

    found = list(rows)
    names = [index] if isinstance(index, str) else index
    frame = pd.DataFrame(found, columns=None if found else [*names, *columns])
    return frame.set_index(index)


def rested(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table as it is written to a file: without the sign of a zero, and without what a decay leaves of a zero (4e-318).

    Parameters
    ----------
    frame : DataFrame
        Any columns; words and flags stay as they are.
    """
    plain = frame.copy()
    for k, kind in enumerate(plain.dtypes):
        if kind.kind == "f":
            column = plain.iloc[:, k].to_numpy()
            plain.isetitem(k, settled(column))
    return plain


def settled(values: np.ndarray) -> np.ndarray:
    """Return numbers with zero in the place of what a file holds as none: the same when a table is read as when it is written.

    Parameters
    ----------
    values : ndarray
        Any numbers; NaN stays.
    """
    return np.where(np.abs(values) < _LEAST, 0.0, values)


def csv_of(frame: pd.DataFrame, digits: int | None = None) -> str:
    """Return a table as the text of a CSV file.

    Parameters
    ----------
    frame : DataFrame
        The table; its index is left out. Units by column in ``attrs["units"]`` are written into the headers: a file has nothing else
        that says them.
    digits : int, optional
        Significant digits of a number; by default as many as tell it from every other.
    """
    units: Mapping[str, str] = frame.attrs.get("units", {})
    frame = frame.rename(columns={n: f"{n} [{u}]" for n, u in units.items() if u not in ("", "1")})
    text: str = rested(frame).to_csv(
        index=False, lineterminator="\n", float_format=None if digits is None else f"%.{digits}g"
    )
    return text


def _serious(result: Result) -> tuple[Notice, ...]:
    warnings = getattr(result, "warnings", ())
    return tuple(w for w in warnings if isinstance(w, Notice) and w.serious)


def _field_lines(result: Result | ResultEntry) -> Iterator[str]:
    """A line for each field of a dataclass, in the units that a person reads."""
    for name, value in _fields(result):
        unit, times = _READ.get(unit := _unit(result, name, value), (unit, 1.0))
        shown = f" {unit}" if unit not in ("", "1", "SI") else ""
        yield f"  {name:<16s} {described(value if times == 1.0 else _scaled(value, times))}{shown}"


def _fields(entry: Plain) -> Iterator[tuple[str, Plain]]:
    """The public fields of a dataclass, by name."""
    if dataclasses.is_dataclass(entry):
        yield from ((f.name, getattr(entry, f.name)) for f in dataclasses.fields(entry) if not f.name.startswith("_"))


def _scaled(value: Plain, times: float) -> Plain:
    if isinstance(value, tuple):
        return tuple(_scaled(v, times) for v in value)
    return None if value is None else times * value


def _first(value: Plain) -> Plain:
    """The first number of a field, or what stands there instead."""
    if isinstance(value, np.ndarray):
        return value.flat[0] if value.size else None
    if isinstance(value, tuple):
        return next((f for v in value if (f := _first(v)) is not None), None)
    return value


def _unit(entry: Plain, name: str, value: Plain) -> str:
    """The unit of the numbers of a field; empty where there are none, or none is known."""
    first = _first(value)
    if isinstance(first, bool | np.bool_) or not isinstance(first, float | np.floating | complex):
        return ""
    return str(getattr(entry, "UNITS", {}).get(name) or unit_of_name(name) or getattr(entry, "unit", ""))


def _header(entry: Plain, name: str, value: Plain, place: str = "") -> str:
    """The head of a column: its name, and its unit where the name does not say it."""
    unit = "" if unit_of_name(name) else _unit(entry, name, value)
    return f"{name}{place} [{unit}]" if unit else f"{name}{place}"


def _cell(value: Plain) -> Plain:
    """A number or a word as it is, anything larger in words."""
    return value if value is None or isinstance(value, bool | str | float | int) else described(value)


def _beside(result: Result, rows: int) -> pd.DataFrame:
    """The arrays of a result that are as long as the one along which its table runs; a column for each of their columns."""
    import pandas as pd

    columns: dict[str, Plain] = {}
    for name, value in _fields(result):
        if not isinstance(value, np.ndarray | tuple) or len(value) != rows:
            continue
        if isinstance(value, tuple) or value.ndim == 1:
            parts = [("", value)]
        else:
            parts = [(f"[{', '.join(map(str, k))}]", value[(slice(None), *k)]) for k in np.ndindex(value.shape[1:])]
        for place, part in parts:
            head = _header(result, name, value, place)
            if isinstance(part, np.ndarray) and np.iscomplexobj(part):
                columns |= {f"real part of {head}": part.real, f"imaginary part of {head}": part.imag}
            else:
                columns[head] = part if isinstance(part, np.ndarray) else [_cell(p) for p in part]
    return pd.DataFrame(columns)


def described(value: Plain) -> str:
    """Return a value of any kind in a few words: numbers as they are, arrays by their shapes, results by their first lines.

    Parameters
    ----------
    value : object
        What a field holds.
    """
    if isinstance(value, np.ndarray):
        if value.ndim == 0 or (value.ndim == 1 and value.size <= LINES):
            return ", ".join(described(v) for v in np.atleast_1d(value).tolist())
        return f"array of shape {value.shape}"
    if isinstance(value, int | None | str):
        return str(value)
    if isinstance(value, float):
        return brief(value, 6)
    if isinstance(value, complex):
        return f"{value:.4g}" if value.imag else brief(value.real, 4)
    if isinstance(value, Result):
        return value.text().partition("\n")[0]
    if isinstance(value, Mapping):
        parts = [f"{k} {described(v)}" for k, v in value.items()]
        return _listed(parts)
    if isinstance(value, tuple | list):
        return _listed([f"({described(v)})" if isinstance(v, tuple | list) else described(v) for v in value])
    told = any("__str__" in vars(kind) for kind in type(value).__mro__[:-1])
    return str(value).partition("\n")[0] if told else type(value).__name__


def _listed(parts: list[str]) -> str:
    shown = ", ".join(parts[:LINES])
    return shown if len(parts) <= LINES else f"{shown} and {len(parts) - LINES} more"


def _table(frame: pd.DataFrame) -> str:
    """A pandas table as HTML: values with the digits that their standard deviations allow, few of many rows."""
    shown = frame.copy()
    if {"value", "std"} <= set(shown.columns):
        if "interval_95" in shown:
            both = zip(shown["interval_95"], shown["std"])
            shown["interval_95"] = [interval((e[0], e[1]), s) if isinstance(e, tuple | list) else "" for e, s in both]
        shown["value"] = [uncertain(v, s) for v, s in zip(shown["value"], shown["std"])]
        shown = shown.drop(columns="std")
    for column in shown.columns:
        if shown[column].dtype == object:
            shown[column] = ["" if v is None else described(v) for v in shown[column]]
    found: str = shown.to_html(
        max_rows=None if len(shown) <= _ALL_ROWS else _ROWS, float_format=number, border=0, na_rep=""
    )
    return found
