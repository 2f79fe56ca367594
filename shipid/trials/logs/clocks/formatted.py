"""The clock of a log whose columns a format file names."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import pandas as pd

from shipid.foundation.errors import nearest
from shipid.trials import columns as headers
from shipid.trials.errors import UnknownColumnError
from shipid.trials.logs.clocks.reading import Clock, read_clock, same_row, written_twice
from shipid.trials.logs.format import TrialFormat


def clock_columns(fmt: TrialFormat, found: Mapping[str, int], names: Sequence[str], where: str) -> tuple[int, ...]:
    """Return the columns that the clock is written in: that of the date, where there is one, and that of the time.

    Parameters
    ----------
    fmt : TrialFormat
        The format.
    found : Mapping of str to int
        Index of each column that it names.
    names : sequence of str
        Headers of the log.
    where : str
        File, for messages.

    Returns
    -------
    tuple of int
        Indices; none, where the format file states an interval instead of a clock.

    Raises
    ------
    UnknownColumnError
        If the log has no column with the date that the format file names.
    """
    if "t" not in found:
        return ()
    if fmt.clock.date is None:
        return (found["t"],)
    bare = [headers.split_header(name)[0] for name in names]
    for listed in (list(names), bare):
        if fmt.clock.date in listed:
            return (listed.index(fmt.clock.date), found["t"])
    raise UnknownColumnError(
        f"{where} has no column '{fmt.clock.date}', which the format file '{fmt.name}' names for the date of the clock. "
        f"{nearest(fmt.clock.date, bare)}".rstrip()
    )


def formatted_clock(
    fmt: TrialFormat,
    column: Callable[[int], pd.Series],
    found: Mapping[str, int],
    stated: dict[str, str],
    names: Sequence[str],
    where: str,
    line: Callable[[int], int] = same_row,
) -> Clock | None:
    """Read the clock of a log whose columns a format file names.

    Parameters
    ----------
    fmt : TrialFormat
        The format.
    column : callable
        Gives a column by its index, as printed.
    found : Mapping of str to int
        Index of each column that the format file names.
    stated : dict of str to str
        Units by name; that of ``t`` becomes s where the clock is no plain number.
    names : sequence of str
        Headers of the log.
    where, line
        As for `read_clock`.

    Returns
    -------
    Clock or None
        None for plain numbers, which keep their unit, and where the format file states an interval instead of a clock.

    Raises
    ------
    NoUnitError
        If the clock is plain numbers and nothing says their unit.
    UnknownColumnError
        If the log lacks the column with the date.
    ClockError
        If no cell of the clock has a time.
    """
    indices = clock_columns(fmt, found, names, where)
    if not indices:
        return None
    *beside, main = indices
    shown = {_header(k, names, None): column(k) for k in beside} | {_header(main, names, stated.get("t")): column(main)}
    others = (column(k) for k in found.values() if k not in indices)
    clock = read_clock(shown, where, fmt.clock, line, written_twice(others))
    if clock is None and "t" not in stated:
        raise headers.no_unit("t", f"{where}, format file '{fmt.name}': ")
    if clock is not None:
        stated["t"] = "s"
    return clock


def _header(index: int, names: Sequence[str], unit: str | None) -> str:
    """Header of a column, with the unit that the format file states."""
    name = names[index] if index < len(names) else f"number {index}"
    return headers.header(headers.split_header(name)[0], unit) if unit else name
