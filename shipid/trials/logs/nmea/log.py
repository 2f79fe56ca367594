"""A whole log: every sentence or message sorted by its origin, and everything that is not one counted and named."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np


class Origin(NamedTuple):
    """Where values come from.

    Attributes
    ----------
    kind : str
        The sentence, ``HDT``, or the PGN, ``127250``.
    talker : str
        The talker, ``HE``; empty for a PGN.
    stream : str
        Which of several devices with one talker; the source address of a PGN.
    """

    kind: str
    talker: str = ""
    stream: str = ""

    @property
    def name(self) -> str:
        """As a format file writes it: ``HEHDT``, ``GPGGA#2``, ``127250#52``."""
        return self.talker + self.kind + (f"#{self.stream}" if self.stream else "")


@dataclass(frozen=True)
class Records:
    """All sentences of one origin.

    Attributes
    ----------
    order : ndarray of int, shape (n,)
        Which sentence of the log each is, counted from 0.
    values : ndarray, shape (n, k)
        What they carry; NaN where empty or not valid.
    fields : tuple of str
        The names of the k fields, as in `shipid.trials.logs.nmea.sentences.fields.CARRIED`.
    """

    order: np.ndarray
    values: np.ndarray
    fields: tuple[str, ...]

    def column(self, name: str) -> np.ndarray:
        """Return the values of a field, shape (n,).

        Parameters
        ----------
        name : str
            One of `fields`.
        """
        return np.asarray(self.values[:, self.fields.index(name)])

    def keep(self, mask: np.ndarray) -> Records:
        """Return some of the sentences.

        Parameters
        ----------
        mask : ndarray of bool, shape (n,)
            Which.
        """
        return Records(self.order[mask], self.values[mask], self.fields)


@dataclass(frozen=True)
class NmeaLog:
    """A log, read.

    Attributes
    ----------
    where : str
        The file, for messages.
    numbers : ndarray of int, shape (n,)
        Line of each sentence or message, counted from 1.
    stamps : ndarray, shape (n,)
        The logger's stamps [s]; NaN where there is none.
    dated : bool
        Whether the stamps count from 1970; otherwise from midnight.
    exact : bool
        Whether the stamps show parts of a second.
    records : dict of Origin to Records
        The sentences that are read.
    others : Counter
        How often each address occurs that is not read.
    head : tuple of str
        The comment lines before the first sentence.
    notes : list of str
        What was left out, with line numbers.
    """

    where: str
    numbers: np.ndarray
    stamps: np.ndarray
    dated: bool
    exact: bool
    records: dict[Origin, Records]
    others: Counter[str]
    head: tuple[str, ...]
    notes: list[str] = field(default_factory=list)

    def seen(self) -> str:
        """Return the sentences of the log in words: ``HEHDT (1200), GPZDA (60)``."""
        counts = Counter({origin.name: len(r.order) for origin, r in self.records.items()}) + self.others
        shown = ", ".join(f"{address} ({n})" for address, n in counts.most_common(12))
        return shown + (f" and {len(counts) - 12} others" if len(counts) > 12 else "")


def named_lines(lines: list[int], what: str) -> list[str]:
    """Return a note on lines that were left out, none where there are none.

    Parameters
    ----------
    lines : list of int
        Their numbers.
    what : str
        What happened to them.
    """
    if not lines:
        return []
    first = ", ".join(str(n) for n in lines[:5]) + (", ..." if len(lines) > 5 else "")
    return [f"{len(lines)} {'lines were' if len(lines) > 1 else 'line was'} {what}: {first}."]
