"""What all results have in common: printed in ten lines, shown as a table in a notebook, drawn as the report draws them.

A result is data and knows nothing of reports. The figures are asked for by the name ``shipid.plot``: the face of the package
knows where that is at home, and loads it then.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import number, uncertain
from shipid.foundation.printable import printable

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

#: Most lines, and most characters of one, that a result prints.
LINES, WIDTH = 10, 160
#: Most rows of a table in a notebook.
_ROWS = 20


class Result:
    """A result of the toolbox. A class with more to say states `text`, one with a table ``to_frame``."""

    def text(self) -> str:
        """Return everything the result says, in lines of text; what is printed are the first of them."""
        return "\n".join([type(self).__name__, *_field_lines(self)])

    def __repr__(self) -> str:
        return shortened(self.text(), _serious(self))

    def _repr_html_(self) -> str:
        """The result in a notebook: its first line, serious warnings, its table, and everything else folded."""
        text = printable(self.text())
        head, _, rest = text.partition("\n")
        parts = [f"<p><strong>{escape(head)}</strong></p>"]
        if serious := _serious(self):
            parts.append(f"<ul>{''.join(f'<li>{escape(printable(str(w)))}</li>' for w in serious)}</ul>")
        frame = getattr(self, "to_frame", None)
        if frame is not None:
            parts.append(_table(frame()))
        if rest:
            folded = f"<pre>{escape(rest)}</pre>"
            parts.append(folded if frame is None else f"<details><summary>In words</summary>{folded}</details>")
        return f"<div>{''.join(parts)}</div>"


class Printed:
    """What is no result and has no table, such as a filter: a notebook shows it as it prints, without running over the page."""

    def _repr_html_(self) -> str:
        return f'<pre style="white-space: pre-wrap">{escape(printable(repr(self).strip("<>")))}</pre>'


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
    warned = [f"  WARNING   {warning}" for warning in first[: LINES - 4]] if len(lines) > LINES else []
    if len(lines) > LINES:
        kept = lines[1 : LINES - 1 - len(warned)]
        lines = [lines[0], *warned, *kept, f"  … {len(lines) - 1 - len(kept)} more lines: print(….text())"]
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


def _serious(result: Result) -> tuple[Notice, ...]:
    warnings = getattr(result, "warnings", ())
    return tuple(w for w in warnings if isinstance(w, Notice) and w.serious)


def _field_lines(result: Result) -> Iterator[str]:
    """A line for each field of a dataclass."""
    if not dataclasses.is_dataclass(result):
        return
    for field in dataclasses.fields(result):
        if not field.name.startswith("_"):
            yield f"  {field.name:<16s} {described(getattr(result, field.name))}"


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
    if isinstance(value, bool | None | str):
        return str(value)
    if isinstance(value, float | int):
        return f"{value:.6g}"
    if isinstance(value, Result):
        return value.text().partition("\n")[0]
    if isinstance(value, Mapping):
        parts = [f"{k} {described(v)}" for k, v in value.items()]
        return _listed(parts)
    if isinstance(value, tuple | list):
        return _listed([described(v) for v in value])
    return type(value).__name__


def _listed(parts: list[str]) -> str:
    shown = ", ".join(parts[:LINES])
    return shown if len(parts) <= LINES else f"{shown} and {len(parts) - LINES} more"


def _table(frame: pd.DataFrame) -> str:
    """A pandas table as HTML: values with the digits that their standard deviations allow, few of many rows."""
    shown = frame.copy()
    if {"value", "std"} <= set(shown.columns):
        shown["value"] = [uncertain(v, s) for v, s in zip(shown["value"], shown["std"])]
        shown = shown.drop(columns="std")
    for column in shown.columns:
        if shown[column].dtype == object:
            shown[column] = [described(v) for v in shown[column]]
    found: str = shown.to_html(max_rows=_ROWS, float_format=number, border=0, na_rep="")
    return found
