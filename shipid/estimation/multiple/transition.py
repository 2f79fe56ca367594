"""The Markov chain of the modes: its transition matrix, read once, and over intervals of any length."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.estimation.errors import TransitionError

#: Rows sum to one within rounding of printed probabilities.
_ROUNDING = 1e-9


def read_transition(rows: Sequence[Sequence[float]] | np.ndarray, modes: tuple[str, ...]) -> np.ndarray:
    """Return a transition matrix, shape (modes, modes): entry (i, j) is the probability to go from mode i to mode j.

    Parameters
    ----------
    rows : sequence of sequence of float
        One row for each mode, in their order.
    modes : tuple of str
        Their names.

    Raises
    ------
    TransitionError
        If it has another shape, a negative entry, or a row that does not sum to one.
    """
    try:
        matrix = np.array(rows, dtype=float)
    except (TypeError, ValueError):
        raise TransitionError("the transition matrix is not a table of numbers: give one row for each mode.") from None
    count = len(modes)
    if matrix.shape != (count, count):
        raise TransitionError(
            f"the transition matrix has the shape {matrix.shape}, and there are {count} modes ({', '.join(modes)}): give {count} rows "
            f"of {count} probabilities."
        )
    for name, row in zip(modes, matrix):
        if not np.isfinite(row).all() or (row < 0).any():
            raise TransitionError(
                f"the transitions from mode '{name}' are {_text(row)}: a probability lies between 0 and 1."
            )
        if abs(row.sum() - 1) > _ROUNDING:
            raise TransitionError(
                f"the transitions from mode '{name}' are {_text(row)} and sum to {row.sum():.10g}: a row must sum to 1."
            )
    return matrix


def read_probabilities(values: Sequence[float] | None, modes: tuple[str, ...]) -> np.ndarray:
    """Return the mode probabilities before the first sample, shape (modes,).

    Parameters
    ----------
    values : sequence of float, optional
        In the order of the modes; equal ones by default.
    modes : tuple of str
        Their names.

    Raises
    ------
    TransitionError
        If they are not one for each mode, negative, or do not sum to one.
    """
    if values is None:
        return np.full(len(modes), 1 / len(modes))
    found = np.array(values, dtype=float)
    if found.shape != (len(modes),) or not (found >= 0).all() or abs(found.sum() - 1) > _ROUNDING:
        raise TransitionError(
            f"the first mode probabilities are {_text(found.ravel())}: give one for each of {', '.join(modes)}; they sum to 1."
        )
    return found


def over_intervals(matrix: np.ndarray, per: float | None, intervals: np.ndarray) -> np.ndarray:
    """Return the transition matrix over each interval, shape (N, modes, modes).

    Parameters
    ----------
    matrix : ndarray, shape (modes, modes)
        As given.
    per : float or None
        The interval in s it holds for; None where it holds from one sample to the next, however long that takes.
    intervals : ndarray, shape (N,)
        In s; where no time passes, no mode changes.
    """
    count = len(matrix)
    if per is None:
        return np.where((intervals > 0)[:, None, None], matrix, np.eye(count))
    lengths, which = np.unique(intervals, return_inverse=True)
    powers = np.array([_power(matrix, length / per) for length in lengths])
    return np.asarray(powers.reshape(-1, count, count)[which])


def _power(matrix: np.ndarray, exponent: float) -> np.ndarray:
    """A power of a stochastic matrix, which is one again: a root of it may have small negative entries, which are left out."""
    if exponent <= 0:
        return np.eye(len(matrix))
    if exponent == 1:
        return matrix
    from scipy.linalg import fractional_matrix_power

    power = np.clip(np.real(fractional_matrix_power(matrix, exponent)), 0.0, None)
    return np.asarray(power / power.sum(axis=1, keepdims=True))


def _text(row: np.ndarray) -> str:
    return ", ".join(f"{v:g}" for v in row)
