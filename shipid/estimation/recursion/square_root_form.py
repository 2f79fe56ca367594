"""The Kalman recursion on a square root of the covariance: positive in any precision.

The root is a full matrix S with ``P = S S'``. Prediction makes it square again by orthogonalisation (modified Gram-Schmidt;
Bierman 1977, chapter VI), a sensor updates it by Potter's formula for one scalar (Bierman 1977, chapter II). It costs a few
times the covariance form, and single precision then holds as many digits of P as double does without it.
"""

from __future__ import annotations

import casadi as ca

from shipid.estimation.recursion.equations import Equations
from shipid.foundation.aliases import Expression

#: Replaces a norm of zero, where the variance is zero, to avoid a division by zero.
_TINY = 1e-30


def size(n: int) -> int:
    """Return the length of the carried vector.

    Parameters
    ----------
    n : int
        Number of unknowns.
    """
    return n * n


def symbol(n: int) -> tuple[Expression, Expression]:
    """Return the carried vector as a symbol, and the root it stands for.

    Parameters
    ----------
    n : int
        Number of unknowns.
    """
    packed = ca.SX.sym("S", size(n))
    return packed, unpack(packed, n)


def unpack(packed: Expression, n: int) -> Expression:
    """Return the root of a carried vector.

    Parameters
    ----------
    packed : casadi.SX, shape (n n,)
        Its columns one after the other.
    n : int
        Number of unknowns.
    """
    return ca.reshape(packed, n, n)


def pack(root: Expression) -> Expression:
    """Return the root as one column.

    Parameters
    ----------
    root : casadi.SX, shape (n, n)
        The root.
    """
    return ca.vec(ca.densify(root))


def predicted(equations: Equations, root: Expression) -> Expression:
    """Return the root at the end of the interval (see `shipid.estimation.recursion.covariance_form.predicted`).

    Parameters
    ----------
    equations : Equations
        The model.
    root : casadi.SX, shape (n + m, n + m)
        At its start.
    """
    n, total = equations.system.x.shape[0], root.shape[0]
    driven = [i for i in range(n) if not equations.spread[i].is_zero()]
    half = ca.SX.zeros(n, len(driven))
    for k, i in enumerate(driven):
        half[i, k] = ca.sqrt(equations.spread[i])
    parts = [equations.transition @ root, equations.transition[:, :n] @ half, half]
    parts += [column * ca.sqrt(variance) for column, variance in equations.added]
    result = ca.SX.zeros(total, total)
    result[:n, :n] = _triangular(ca.densify(ca.horzcat(*parts)))
    for k, variance in enumerate(equations.carried_variance(), start=n):
        result[k, k] = ca.sqrt(variance)
    return result


def _triangular(wide: Expression) -> Expression:
    """Return the lower triangle L with ``L L' = A A'``."""
    n = wide.shape[0]
    rows = [wide[i, :] for i in range(n)]
    lower = ca.SX.zeros(n, n)
    for i in range(n):
        norm = ca.sqrt(ca.sumsqr(rows[i]))
        lower[i, i] = norm
        direction = rows[i] / ca.fmax(norm, _TINY)
        for j in range(i + 1, n):
            lower[j, i] = ca.dot(rows[j], direction)
            rows[j] = rows[j] - lower[j, i] * direction
    return lower


def innovation(root: Expression, row: Expression, variance: Expression) -> Expression:
    """Return the innovation variance of a sensor (see the covariance form).

    Parameters
    ----------
    root, row, variance
        See `updated`.
    """
    return ca.sumsqr(root.T @ row.T) + variance


def inflated(root: Expression, index: int, factor: Expression) -> Expression:
    """Return the root in which the standard deviation of one unknown is so many times larger.

    Parameters
    ----------
    root : casadi.SX
        As it was.
    index : int
        Which unknown.
    factor : casadi.SX
        How many times.
    """
    wider = root + 0
    wider[index, :] = wider[index, :] * factor
    return wider


def updated(
    root: Expression, row: Expression, variance: Expression, taken: Expression, adapting: Expression = None
) -> tuple[Expression, Expression, Expression]:
    """Return gain, new root and innovation variance of one sensor (see the covariance form).

    Parameters
    ----------
    root : casadi.SX
        Before the update.
    row : casadi.SX, shape (1, n + m)
        Jacobian of the sensor.
    variance : casadi.SX
        Of its noise.
    taken : casadi.SX
        1 or 0.
    adapting : None
        Not available: the square-root form supports the optimal gain only.
    """
    seen = root.T @ row.T
    spread = ca.sumsqr(seen) + variance
    gain = (root @ seen) / spread * taken
    return gain, root - gain @ seen.T / (1 + ca.sqrt(variance / spread)), spread


def covariance_of(root: Expression) -> Expression:
    """Return the covariance ``S S'``.

    Parameters
    ----------
    root : casadi.SX, shape (n, n)
        The root S.
    """
    return root @ root.T


def variances(root: Expression, n: int) -> Expression:
    """Return the variances of the first unknowns.

    Parameters
    ----------
    root : casadi.SX
        The root.
    n : int
        How many.
    """
    return ca.vertcat(*(ca.sumsqr(root[i, :]) for i in range(n)))
