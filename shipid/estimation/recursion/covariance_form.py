"""The Kalman recursion on the covariance matrix, kept as its upper triangle: symmetric by construction.

Sensors are taken one after the other, so that nothing is inverted but a number. All are linearised at the same point, the
predicted one, which makes the result that of the joint update.
"""

from __future__ import annotations

import casadi as ca

from shipid.estimation.recursion.equations import Equations
from shipid.foundation.aliases import Expression


def size(n: int) -> int:
    """Return the length of the carried vector.

    Parameters
    ----------
    n : int
        Number of unknowns.
    """
    return n * (n + 1) // 2


def symbol(n: int) -> tuple[Expression, Expression]:
    """Return the carried vector as a symbol, and the covariance it stands for.

    Parameters
    ----------
    n : int
        Number of unknowns.
    """
    packed = ca.SX.sym("P", size(n))
    return packed, unpack(packed, n)


def unpack(packed: Expression, n: int) -> Expression:
    """Return the symmetric matrix of a packed upper triangle.

    Parameters
    ----------
    packed : casadi.SX, shape (n (n + 1) / 2,)
        The columns of the triangle one after the other.
    n : int
        Size of the matrix.
    """
    full = ca.SX(n, n)
    k = 0
    for j in range(n):
        for i in range(j + 1):
            full[i, j] = full[j, i] = packed[k]
            k += 1
    return full


def pack(covariance: Expression) -> Expression:
    """Return the upper triangle of a symmetric matrix as one column.

    Parameters
    ----------
    covariance : casadi.SX, shape (n, n)
        The matrix.
    """
    n = covariance.shape[0]
    return ca.vertcat(*(covariance[i, j] for j in range(n) for i in range(j + 1))) if n else ca.SX(0, 1)


def predicted(equations: Equations, covariance: Expression) -> Expression:
    """Return the covariance of the joint vector at the end of the interval.

    Parameters
    ----------
    equations : Equations
        The model.
    covariance : casadi.SX, shape (n + m, n + m)
        Of the joint vector at its start.
    """
    n, total = equations.system.x.shape[0], covariance.shape[0]
    before = covariance + 0
    for i in range(n):
        before[i, i] += equations.spread[i]
    block = symmetric(equations.transition @ before @ equations.transition.T)
    for column, variance in equations.added:
        block = block + symmetric((column * variance) @ column.T)
    for i in range(n):
        block[i, i] += equations.spread[i]
    result = ca.SX.zeros(total, total)
    result[:n, :n] = block
    for k, variance in enumerate(equations.carried_variance(), start=n):
        result[k, k] = variance
    return result


def innovation(covariance: Expression, row: Expression, variance: Expression) -> Expression:
    """Return the innovation variance of a sensor.

    Parameters
    ----------
    covariance, row, variance
        See `updated`.
    """
    return (row @ covariance @ row.T) + variance


def inflated(covariance: Expression, index: int, factor: Expression) -> Expression:
    """Return the covariance in which the standard deviation of one unknown is so many times larger.

    Parameters
    ----------
    covariance : casadi.SX
        As it was; correlations stay.
    index : int
        Which unknown.
    factor : casadi.SX
        How many times.
    """
    wider = covariance + 0
    wider[index, :] = wider[index, :] * factor
    wider[:, index] = wider[:, index] * factor
    return wider


def updated(
    covariance: Expression, row: Expression, variance: Expression, taken: Expression, adapting: Expression = None
) -> tuple[Expression, Expression, Expression]:
    """Return gain, new covariance and innovation variance of one sensor.

    Parameters
    ----------
    covariance : casadi.SX
        Before the update.
    row : casadi.SX, shape (1, n + m)
        Jacobian of the sensor.
    variance : casadi.SX
        Of its noise.
    taken : casadi.SX
        1 where the sample counts and 0 where it does not.
    adapting : casadi.SX, optional
        Factor on each unknown's gain. Where it is not 1 the gain is not the optimal one, and the covariance takes
        Joseph's form.
    """
    column = covariance @ row.T
    spread = (row @ column) + variance
    gain = column / spread * taken
    if adapting is None:
        return gain, symmetric(covariance - gain @ column.T), spread
    gain = gain * adapting
    # (I - K H) P (I - K H)' + K R K' for one sensor, with S = H P H' + R.
    joseph = covariance - gain @ column.T - column @ gain.T + (gain * spread) @ gain.T
    return gain, symmetric(joseph), spread


def symmetric(matrix: Expression) -> Expression:
    """Return the upper triangle of a matrix and its mirror image: the lower one is never computed.

    Parameters
    ----------
    matrix : casadi.SX, shape (n, n)
        A matrix that is symmetric but for rounding.
    """
    return ca.densify(ca.triu2symm(ca.triu(matrix)))


def covariance_of(covariance: Expression) -> Expression:
    """Return the covariance that is carried: in this form itself.

    Parameters
    ----------
    covariance : casadi.SX, shape (n, n)
        The matrix.
    """
    return covariance


def variances(covariance: Expression, n: int) -> Expression:
    """Return the variances of the first unknowns.

    Parameters
    ----------
    covariance : casadi.SX
        The matrix.
    n : int
        How many.
    """
    return ca.vertcat(*(covariance[i, i] for i in range(n)))
