"""Choosing manoeuvres within a time: greedy from several beginnings, then exchange, over a table of candidates.

Information matrices of manoeuvres add, so that a choice is a sum of rows of the table and its criterion costs one
determinant or one inverse. The exchange is Fedorov's (1972, "Theory of optimal experiments") with a budget of time: one
manoeuvre against any other that fits, and two manoeuvres against each other's time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from shipid.foundation.errors import UnknownNameError

Criterion = Literal["D", "A"]
CRITERIA: tuple[Criterion, ...] = get_args(Criterion)
#: Information that is there before any trial, in units of the size of each coefficient: a standard deviation of a
#: thousand times its size. It keeps criteria finite where a choice does not determine a direction.
BEFOREHAND = 1e-6
_BETTER = 1e-9


@dataclass(frozen=True, eq=False)
class CandidateTable:
    """Candidates, each a manoeuvre of one length.

    Attributes
    ----------
    information : ndarray, shape (candidates, draws, n, n)
        In units of the size of the coefficients, under each draw of them.
    duration, speed, gap : ndarray, shape (candidates,)
        Length in s, speed in m/s, and the steady approach in s that goes before it.
    run : ndarray of int, shape (candidates,)
        Candidates of one run are its lengths.
    time : float
        The time available, in s.
    criterion : {"D", "A"}
        Determinant, or mean relative variance.
    worst : bool
        Whether the worst draw counts, or the average.
    """

    information: np.ndarray
    duration: np.ndarray
    speed: np.ndarray
    gap: np.ndarray
    run: np.ndarray
    time: float
    criterion: Criterion = "D"
    worst: bool = False

    def value(self, information: np.ndarray) -> np.ndarray:
        """Return the criterion of sums of information, shape (..., draws, n, n) -> (...); more is better.

        Parameters
        ----------
        information : ndarray, shape (..., draws, n, n)
            Sums of rows of the table.
        """
        return value_of(information, self.criterion, self.worst)

    def total(self, chosen: list[int]) -> np.ndarray:
        """Return the time in s of a choice with each candidate added, shape (candidates,).

        A steady approach goes before each manoeuvre but the first, and another one before a change of speed.

        Parameters
        ----------
        chosen : list of int
            Rows of the table.
        """
        spent = np.array([self.duration[i] + self.gap[i] for i in chosen]).sum()
        speeds = {float(self.speed[i]): float(self.gap[i]) for i in chosen}
        new = ~np.isin(self.speed, list(speeds))
        fastest = np.maximum(self.speed, max(speeds, default=0.0))
        first = np.where(fastest == self.speed, self.gap, speeds[max(speeds)] if speeds else 0.0)
        changes = sum(speeds.values()) + np.where(new, self.gap, 0.0)
        return np.asarray(spent + self.duration + self.gap + changes - 2 * first)

    def fitting(self, chosen: list[int]) -> np.ndarray:
        """Return the candidates that still fit beside a choice.

        Parameters
        ----------
        chosen : list of int
            Rows of the table.

        Returns
        -------
        ndarray of int
        """
        return np.flatnonzero(self.total(chosen) <= self.time + 1e-6)

    def of(self, chosen: list[int]) -> float:
        """Return the criterion of a choice.

        Parameters
        ----------
        chosen : list of int
            Rows of the table.
        """
        return float(self.value(self.information[chosen].sum(axis=0)))


def value_of(information: np.ndarray, criterion: Criterion, worst: bool = False) -> np.ndarray:
    """Return a criterion of information matrices under several draws of the coefficients; more is better.

    Parameters
    ----------
    information : ndarray, shape (..., draws, n, n)
        In units of the size of the coefficients.
    criterion : {"D", "A"}
        ``D``: logarithm of the determinant, for each coefficient; ``A``: less the logarithm of the mean relative variance.
    worst : bool
        Whether the worst draw counts, or the average.

    Raises
    ------
    UnknownNameError
        If there is no such criterion.
    """
    n = information.shape[-1]
    whole = information + BEFOREHAND * np.eye(n)
    if criterion == "D":
        each = np.linalg.slogdet(whole)[1] / n
    elif criterion == "A":
        each = -np.log(np.trace(np.linalg.inv(whole), axis1=-2, axis2=-1) / n)
    else:
        raise UnknownNameError("criterion", criterion, CRITERIA, "D: determinant, A: mean relative variance.")
    return np.asarray(each.min(axis=-1) if worst else each.mean(axis=-1))


def choose(table: CandidateTable, beginnings: list[list[int]], most: int = 6) -> list[int]:
    """Return the best choice found.

    Parameters
    ----------
    table : CandidateTable
        Candidates.
    beginnings : list of list of int
        Choices to begin with as well; the result is no worse than any of them.
    most : int
        Largest number of equal shares of the time that greedy choices begin with.
    """
    found = [list(b) for b in beginnings if b]
    longest = float(table.duration.max())
    for parts in range(1, most + 1):
        share = max(table.time / parts, float(table.duration.min()))
        if share <= longest or parts == 1:
            found.append(_greedy(table, [], share))
    found.append(_greedy(table, [], np.inf, by_time=True))
    ranked = sorted((c for c in found if c), key=table.of, reverse=True)
    better = [_exchange(table, c) for c in ranked[:3]]
    return max([*better, *ranked[:1]], key=table.of, default=[])


def _greedy(table: CandidateTable, chosen: list[int], longest: float, by_time: bool = False) -> list[int]:
    """Add the candidate with the largest gain (or gain for its time), while one fits."""
    chosen = list(chosen)
    have = table.information[chosen].sum(axis=0)
    while True:
        rows = table.fitting(chosen)
        rows = rows[table.duration[rows] <= longest]
        if not rows.size:
            return chosen
        gain = table.value(have + table.information[rows]) - table.value(have)
        if by_time and chosen:
            gain = gain / (table.duration[rows] + table.gap[rows])
        best = rows[int(np.argmax(gain))]
        chosen.append(int(best))
        have = have + table.information[best]


def _exchange(table: CandidateTable, chosen: list[int]) -> list[int]:
    """Exchange one manoeuvre, or the time of two, while the criterion grows; then fill the time that is left."""
    value = table.of(chosen)
    for _ in range(50):
        before = value
        for i in range(len(chosen)):
            rest = chosen[:i] + chosen[i + 1 :]
            rows = table.fitting(rest)
            values = table.value(table.information[rest].sum(axis=0) + table.information[rows])
            best = int(np.argmax(values))
            if values[best] > value + _BETTER:
                chosen, value = [*rest[:i], int(rows[best]), *rest[i:]], float(values[best])
        for i in range(len(chosen)):
            for j in range(i + 1, len(chosen)):
                chosen, value = _share(table, chosen, value, i, j)
        filled = _greedy(table, chosen, np.inf)
        if table.of(filled) > value + _BETTER:
            chosen, value = filled, table.of(filled)
        if value <= before + _BETTER:
            break
    return chosen


def _share(table: CandidateTable, chosen: list[int], value: float, i: int, j: int) -> tuple[list[int], float]:
    """Share the time of two manoeuvres anew between them."""
    first, second = (np.flatnonzero(table.run == table.run[chosen[k]]) for k in (i, j))
    over = float(table.total([c for k, c in enumerate(chosen) if k != i])[chosen[i]]) - table.time
    spare = table.duration[chosen[i]] + table.duration[chosen[j]] - over
    fits = table.duration[first][:, None] + table.duration[second][None, :] <= spare + 1e-6
    a, b = np.nonzero(fits)
    if not a.size:
        return chosen, value
    rest = table.information[[c for k, c in enumerate(chosen) if k not in (i, j)]].sum(axis=0)
    values = table.value(rest + table.information[first[a]] + table.information[second[b]])
    best = int(np.argmax(values))
    if values[best] <= value + _BETTER:
        return chosen, value
    new = list(chosen)
    new[i], new[j] = int(first[a[best]]), int(second[b[best]])
    return new, float(values[best])
