"""Symmetric matrices kept as their packed upper triangles, columns one after the other."""

from __future__ import annotations

import functools

import numpy as np


def unpacked(packed: np.ndarray, n: int) -> np.ndarray:
    """Return the symmetric matrices of packed upper triangles, shape (N, n, n).

    Parameters
    ----------
    packed : ndarray, shape (N, n (n + 1) / 2)
        Columns one after the other.
    n : int
        Size of the matrices.
    """
    rows, columns = _places(n)
    full = np.empty((packed.shape[0], n, n))
    full[:, rows, columns] = full[:, columns, rows] = packed
    return full


def packed_of(full: np.ndarray) -> np.ndarray:
    """Return the packed upper triangles of symmetric matrices, shape (..., n (n + 1) / 2).

    Parameters
    ----------
    full : ndarray, shape (..., n, n)
        The matrices.
    """
    rows, columns = _places(full.shape[-1])
    return np.asarray(full[..., rows, columns])


@functools.lru_cache(maxsize=64)
def _places(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns of the entries of a packed upper triangle; kept, as a sample that arrives alone asks for them every time."""
    rows = np.concatenate([np.arange(j + 1) for j in range(n)]) if n else np.zeros(0, dtype=int)
    return rows, np.repeat(np.arange(n), np.arange(1, n + 1))


def diagonal_of(n: int) -> np.ndarray:
    """Return where the diagonal of a matrix stands in its packed upper triangle, shape (n,).

    Parameters
    ----------
    n : int
        Size of the matrix.
    """
    return np.cumsum(np.arange(1, n + 1)) - 1


def deviations_of(packed: np.ndarray, n: int) -> np.ndarray:
    """Return the standard deviations of packed covariances, shape (..., n); rounding below zero counts as zero.

    Parameters
    ----------
    packed : ndarray, shape (..., n (n + 1) / 2)
        Packed upper triangles.
    n : int
        Size of the covariances.
    """
    return np.asarray(np.sqrt(np.maximum(packed[..., diagonal_of(n)], 0.0)))
