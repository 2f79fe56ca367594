"""The two middle points on a curve that change the acceleration least, near where they were observed: exactly, or by a swarm.

Song et al. (2018), equations 12 to 14. Four points lie on a curve ``y = P(x)`` at equal intervals of time, ``p3`` the oldest
and ``p0`` the newest. The ends are fixed. The abscissas of ``p1`` and ``p2`` are chosen so that the jerk
``|p0 - 3 p1 + 3 p2 - p3|`` is smallest, with both points within a radius of where they were observed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: The curve is a straight line or a parabola: for these the list of candidates below is complete.
MOST_DEGREE = 2
#: More than any jerk: what a point outside its circle costs in the swarm, so that the circle comes first.
_OUTSIDE = 1e12


@dataclass(frozen=True)
class MiddleProblem:
    """The two-variable problem, for many targets at once.

    Attributes
    ----------
    curve : ndarray, shape (..., degree + 1)
        Coefficients of the curve, the constant first; metres.
    ends : ndarray, shape (..., 2)
        Abscissas of the newest and the oldest point, m.
    observed : ndarray, shape (..., 2, 2)
        Where the newer and the older middle point were observed, m.
    radius : float
        How far each may be moved, m.
    """

    curve: np.ndarray
    ends: np.ndarray
    observed: np.ndarray
    radius: float

    def height(self, x: np.ndarray) -> np.ndarray:
        """Return the ordinates of the curve.

        Parameters
        ----------
        x : ndarray, shape (..., k)
            Abscissas, m.
        """
        powers = x[..., None] ** np.arange(self.curve.shape[-1])
        return np.asarray(np.sum(self.curve[..., None, :] * powers, axis=-1))

    def jerk(self, middle: np.ndarray) -> np.ndarray:
        """Return the squared jerk.

        Parameters
        ----------
        middle : ndarray, shape (..., 2, k)
            Abscissas of the newer and the older middle point for k candidates, m.

        Returns
        -------
        ndarray, shape (..., k)
            m^2.
        """
        newer, older = middle[..., 0, :], middle[..., 1, :]
        ends = self.height(self.ends)
        along = (self.ends[..., :1] - self.ends[..., 1:]) - 3 * (newer - older)
        across = (ends[..., :1] - ends[..., 1:]) - 3 * (self.height(newer) - self.height(older))
        return np.asarray(along**2 + across**2)

    def distance(self, middle: np.ndarray) -> np.ndarray:
        """Return how far the points are from where they were observed.

        Parameters
        ----------
        middle : ndarray, shape (..., 2, k)
            As for `jerk`.

        Returns
        -------
        ndarray, shape (..., 2, k)
            m.
        """
        across = np.stack([self.height(middle[..., i, :]) for i in (0, 1)], axis=-2)
        return np.asarray(np.hypot(middle - self.observed[..., :, 0, None], across - self.observed[..., :, 1, None]))


def exact_middle(problem: MiddleProblem) -> np.ndarray:
    """Return the solution, found among all points where it can be.

    A point has a range of abscissas within its circle: the ends of that range are roots of a polynomial. Inside the rectangle
    of both ranges the jerk of a parabola vanishes at equal spacing and has no other minimum; on its edges it is a polynomial
    of one variable. Where the curve misses a circle, the point nearest to the observed one is taken.

    Parameters
    ----------
    problem : MiddleProblem
        For any number of targets.

    Returns
    -------
    ndarray, shape (..., 2)
        Abscissas of the newer and the older middle point, m.
    """
    newest, oldest = problem.ends[..., 0], problem.ends[..., 1]
    low, high = _ranges(problem)
    equal = np.stack([newest + (oldest - newest) / 3, newest + (oldest - newest) * 2 / 3], axis=-1)
    candidates = [np.clip(equal, low, high)]
    ends = problem.height(problem.ends)
    for edge in (low, high):
        for held in (0, 1):
            at = edge[..., held]
            here = problem.height(at[..., None])[..., 0]
            sign = 1.0 if held == 0 else -1.0
            # The jerk along an edge: (c + s x)^2 + (d + s P(x))^2 with s = 3 or -3.
            c = newest - oldest - sign * 3 * at
            d = ends[..., 0] - ends[..., 1] - sign * 3 * here
            free = _stationary(problem.curve, sign * 3, c, d)
            other = 1 - held
            for x in (*np.moveaxis(free, -1, 0), low[..., other], high[..., other]):
                inside = np.clip(x, low[..., other], high[..., other])
                candidates.append(np.stack([at, inside] if held == 0 else [inside, at], axis=-1))
    middle = np.stack(candidates, axis=-1)
    best = np.argmin(problem.jerk(middle), axis=-1)
    return np.asarray(np.take_along_axis(middle, best[..., None, None], axis=-1)[..., 0])


def swarm_middle(problem: MiddleProblem, seed: int = 0, particles: int = 30, iterations: int = 40) -> np.ndarray:
    """Return the solution that a particle swarm finds, as in the paper; its settings are not printed there.

    Inertia 0.7 and both attractions 1.5; a particle outside a circle is worse than any inside, by how far it is outside.

    Parameters
    ----------
    problem : MiddleProblem
        For any number of targets.
    seed : int
        Of the swarm.
    particles, iterations : int
        Size of the swarm and how often it moves.

    Returns
    -------
    ndarray, shape (..., 2)
        Abscissas of the newer and the older middle point, m.
    """
    rng = np.random.default_rng(seed)
    shape = (*problem.ends.shape[:-1], 2, particles)
    here = problem.observed[..., :, 0, None] + problem.radius * rng.uniform(-1, 1, shape)
    moving = problem.radius * rng.uniform(-0.5, 0.5, shape)
    best, fitness = here, _fitness(problem, here)
    for _ in range(iterations):
        leader = np.take_along_axis(best, np.argmin(fitness, axis=-1)[..., None, None], axis=-1)
        own, common = rng.uniform(size=shape), rng.uniform(size=shape)
        moving = 0.7 * moving + 1.5 * own * (best - here) + 1.5 * common * (leader - here)
        here = here + moving
        now = _fitness(problem, here)
        better = now < fitness
        best, fitness = np.where(better[..., None, :], here, best), np.where(better, now, fitness)
    return np.asarray(np.take_along_axis(best, np.argmin(fitness, axis=-1)[..., None, None], axis=-1)[..., 0])


def _fitness(problem: MiddleProblem, middle: np.ndarray) -> np.ndarray:
    """Equation 12, its two branches made comparable: first into the circles, then the jerk."""
    outside = np.max(problem.distance(middle), axis=-2) / problem.radius
    return np.where(outside > 1, _OUTSIDE * outside**2, problem.jerk(middle))


def _ranges(problem: MiddleProblem) -> tuple[np.ndarray, np.ndarray]:
    """Abscissas at which the curve is within the circle of each middle point, next to where that was observed."""
    low, high = [], []
    for i in (0, 1):
        x, y = problem.observed[..., i, 0], problem.observed[..., i, 1]
        squared = _squared_distance(problem.curve, x, y)
        squared[..., 0] -= problem.radius**2
        ends = _real_roots(squared)
        nearest = _nearest(problem, squared, x)
        inside = _value(squared, nearest) < 0
        below = np.max(np.where(ends <= nearest[..., None], ends, -np.inf), axis=-1)
        above = np.min(np.where(ends >= nearest[..., None], ends, np.inf), axis=-1)
        low.append(np.where(inside, below, nearest))
        high.append(np.where(inside, above, nearest))
    return np.stack(low, axis=-1), np.stack(high, axis=-1)


def _nearest(problem: MiddleProblem, squared: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The abscissa of the point of the curve that is nearest to the observed one."""
    slope = squared[..., 1:] * np.arange(1, squared.shape[-1])
    candidates = _real_roots(slope)
    value = np.where(
        np.isfinite(candidates), _value(squared, np.where(np.isfinite(candidates), candidates, 0.0)), np.inf
    )
    best = np.take_along_axis(candidates, np.argmin(value, axis=-1)[..., None], axis=-1)[..., 0]
    return np.where(np.isfinite(best), best, x)


def _stationary(curve: np.ndarray, s: float, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Where ``(c + s x)^2 + (d + s P(x))^2`` has no slope; NaN in the place of complex roots."""
    across = s * curve.copy()
    across[..., 0] += d
    whole = _times(across, across)
    along = np.stack([c**2, 2 * c * s, np.full_like(c, s**2)], axis=-1)
    whole[..., : min(3, whole.shape[-1])] += along[..., : min(3, whole.shape[-1])]
    roots = _real_roots(whole[..., 1:] * np.arange(1, whole.shape[-1]))
    return np.where(np.isfinite(roots), roots, 0.0)


def _squared_distance(curve: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Coefficients of the squared distance of the points of the curve from a point."""
    across = curve.copy()
    across[..., 0] -= y
    squared = _times(across, across)
    squared[..., 0] += x**2
    squared[..., 1] -= 2 * x
    squared[..., 2] += 1
    return squared


def _times(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The product of two polynomials."""
    product = np.zeros((*a.shape[:-1], a.shape[-1] + b.shape[-1] - 1))
    for i in range(a.shape[-1]):
        product[..., i : i + b.shape[-1]] += a[..., i, None] * b
    return product


def _value(coefficients: np.ndarray, x: np.ndarray) -> np.ndarray:
    """A polynomial at one abscissa each, or at several where `x` has one dimension more."""
    several = x.ndim == coefficients.ndim
    powers = (x if several else x[..., None])[..., None] ** np.arange(coefficients.shape[-1])
    value = np.sum(coefficients[..., None, :] * powers, axis=-1)
    return np.asarray(value if several else value[..., 0])


def _real_roots(coefficients: np.ndarray) -> np.ndarray:
    """Real roots as eigenvalues of companion matrices; NaN in the place of complex ones.

    A polynomial whose highest coefficients vanish has fewer roots: the others come out very large, and do no harm.
    """
    degree = coefficients.shape[-1] - 1
    size = np.max(np.abs(coefficients), axis=-1)
    highest = coefficients[..., -1]
    tiny = 1e-14 * np.where(size > 0, size, 1.0)
    highest = np.where(np.abs(highest) < tiny, np.where(highest < 0, -tiny, tiny), highest)
    matrix = np.zeros((*coefficients.shape[:-1], degree, degree))
    matrix[..., np.arange(1, degree), np.arange(degree - 1)] = 1.0
    matrix[..., :, -1] = -coefficients[..., :-1] / highest[..., None]
    roots = np.linalg.eigvals(matrix)
    real = np.abs(roots.imag) <= 1e-7 * np.maximum(1.0, np.abs(roots))
    return np.where(real, roots.real, np.nan)
