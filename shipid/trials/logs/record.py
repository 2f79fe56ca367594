"""The lenient log: a table as it was written, every column and row kept, and what is wrong with it noted.

The one reader (`shipid.trials.logs.reading.read_record`) makes it of every kind of file. A trial is made of it where
nothing is noted (`shipid.trials.logs.strict`); the doctor examines it as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from shipid.trials.errors import TrialError
from shipid.trials.logs.format import TrialFormat
from shipid.trials.source import Source

#: Start and end of a window in seconds of the record's own clock; None is the record's own end.
Span = tuple[float | None, float | None]


def same_row(row: int) -> int:
    """Return the row itself: the number to name for a sample of a table without a file.

    Parameters
    ----------
    row : int
        Sample, counted from 0.
    """
    return row


@dataclass(frozen=True, eq=False)
class LenientRecord:
    """A log as it was written.

    Attributes
    ----------
    name : str
        The file's stem, or the name of the table.
    values : Mapping of str to ndarray, shape (n,)
        By the name in the header, or the one the format file gives; as printed, NaN where there is no number.
        `shipid.trials.logs.conversion.in_si` returns a record in the units of a trial.
    stated : Mapping of str to str
        The unit each column says; a column that says none is not in it.
    where : str
        File or table, for messages.
    source : Source
        Where it came from.
    format : TrialFormat or None
        What is known of it besides.
    ship : str or None
        Name of the ship's parameter set, where it is stated.
    window : tuple or None
        The stretch that is wanted [s, the record's own clock].
    title : str
        The name, with the window as it was asked for.
    notes : tuple of str
        What was done to it, and what the reader should know.
    faults : tuple of TrialError
        What a trial may not have, in the order in which it was found.
    unused : Mapping of int to ndarray, shape (n,)
        Columns by index that the format file does not name, where it states an interval instead of a clock.
    line : callable
        Gives the row number to name for a sample.
    words : Mapping of str to Mapping of int to str
        By column and row the text of cells that hold neither a number nor nothing; NaN in `values`.
    """

    name: str
    values: Mapping[str, np.ndarray]
    stated: Mapping[str, str]
    where: str
    source: Source = field(default_factory=Source)
    format: TrialFormat | None = None
    ship: str | None = None
    window: Span | None = None
    title: str = ""
    notes: tuple[str, ...] = ()
    faults: tuple[TrialError, ...] = ()
    unused: Mapping[int, np.ndarray] = field(default_factory=dict)
    line: Callable[[int], int] = same_row
    words: Mapping[str, Mapping[int, str]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(next(iter(self.values.values()), ()))

    def refuse(self) -> None:
        """Refuse a log that has a fault.

        Raises
        ------
        TrialError
            The fault that was found first.
        """
        for fault in self.faults:
            raise fault

    def keep(self, mask: np.ndarray) -> LenientRecord:
        """Return some rows of the log.

        Parameters
        ----------
        mask : ndarray of bool, shape (n,)
            The rows.

        Returns
        -------
        LenientRecord
        """
        kept, line = np.flatnonzero(mask), self.line
        new_row = {int(row): k for k, row in enumerate(kept)} if self.words else {}
        return replace(
            self,
            values={name: values[kept] for name, values in self.values.items()},
            unused={index: values[kept] for index, values in self.unused.items()},
            line=lambda row: line(int(kept[row])),
            words={
                name: {new_row[row]: text for row, text in cells.items() if row in new_row}
                for name, cells in self.words.items()
            },
        )


def inside(t: np.ndarray, window: Span) -> np.ndarray:
    """Return which samples lie in a window, both ends included.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time [s]; NaN lies in no window.
    window : tuple of float or None
        Start and end [s].

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    start, end = window
    slack = 1e-9 * max(1.0, *(abs(bound) for bound in window if bound is not None), 1.0)
    after = np.isfinite(t) if start is None else t >= start - slack
    return np.asarray(after if end is None else after & (t <= end + slack))
