"""Gains at one speed: poles placed by heading and rate of turn alone, LQR, and with an integral for a steady moment.

An autopilot feeds back heading and rate of turn, and nothing else a model may have as its state. Two gains place two poles
of a ship of any order exactly, and with an integral three: the characteristic polynomial has to be divisible by the one asked
for, which is linear in the gains. For a ship of first order these are Passenier (1989), eq. (5.79)-(5.80).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.linalg import solve_continuous_lyapunov
from scipy.optimize import brentq, minimize

from shipid.autopilot.design.plant import Plant
from shipid.autopilot.errors import NotSteerableError, UnstableDesignError
from shipid.foundation.result import ResultEntry

#: A pole that grows more slowly than this, in units of its size or that of the poles requested, counts as on the axis.
_AXIS = 1e-9


@dataclass(frozen=True, repr=False)
class Gains(ResultEntry):
    """Gains of the law ``delta = Kp (psi_order - psi) - Kd r + Ki integral(psi_order - psi)``.

    Attributes
    ----------
    Kp : float
        Rudder per heading error.
    Kd : float
        Rudder per rate of turn, in s.
    Ki : float
        Rudder per heading error and second, in 1/s.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"Kp": "1", "Kd": "s", "Ki": "1/s"}

    Kp: float
    Kd: float
    Ki: float = 0.0


def pole_pair(omega: float, damping: float) -> np.ndarray:
    """Return ``s^2 + 2 zeta omega s + omega^2``, highest power first.

    Parameters
    ----------
    omega : float
        Natural frequency in rad/s.
    damping : float
        Damping ratio.
    """
    return np.array([1.0, 2 * damping * omega, omega**2])


def closed_polynomial(plant: Plant, gains: Gains) -> np.ndarray:
    """Return the characteristic polynomial of the loop of one plant, highest power first.

    Parameters
    ----------
    plant : Plant
        One condition.
    gains : Gains
        The law.
    """
    heading, rate = plant.numerators
    closed = plant.denominator.copy()
    closed[1:] += gains.Kp * heading + gains.Kd * rate
    if gains.Ki == 0.0:
        return closed
    closed = np.append(closed, 0.0)
    closed[2:] += gains.Ki * heading
    return closed


def closed_poles(plant: Plant, gains: Gains) -> np.ndarray:
    """Return the poles of the loop of one plant in rad/s, slowest decay first.

    Parameters
    ----------
    plant : Plant
        One condition.
    gains : Gains
        The law.
    """
    poles = np.roots(closed_polynomial(plant, gains))
    # Where two real parts agree to rounding, the pair keeps its order: positive frequency first.
    return poles[np.lexsort((-poles.imag, -np.round(poles.real, 12)))]


def place(plant: Plant, wanted: np.ndarray) -> Gains:
    """Return the gains that give the loop the poles of a polynomial.

    Parameters
    ----------
    plant : Plant
        One condition.
    wanted : ndarray, shape (3,) or (4,)
        Two poles requested, or three where the law has an integral, as a polynomial; highest power first.

    Raises
    ------
    NotSteerableError
        If no gains do it: the ship is uncontrollable there.
    """
    order = len(wanted) - 1
    heading, rate = plant.numerators
    # s times the loop where there is an integral, so that all of it is one polynomial.
    open_loop = plant.denominator if order == 2 else np.append(plant.denominator, 0.0)
    columns = [heading, rate] if order == 2 else [np.append(heading, 0.0), np.append(rate, 0.0), heading]
    # Time in units of the fastest pole requested, in which all numbers are near one.
    scale = float(abs(wanted[-1]) ** (1 / order))
    rest = _remainder(open_loop, wanted, scale)
    matrix = np.stack([_remainder(c, wanted, scale) for c in columns], axis=1)
    size = np.abs(matrix).max(axis=0)
    if (size == 0).any() or np.linalg.cond(matrix / size) > 1e12:
        raise NotSteerableError(
            "no gains of heading and rate place these poles: a requested pole is a zero of the ship, or the ship is "
            "uncontrollable there."
        )
    found = -np.linalg.solve(matrix / size, rest) / size
    return Gains(float(found[0]), float(found[1]), float(found[2]) if order == 3 else 0.0)


def _remainder(polynomial: np.ndarray, by: np.ndarray, scale: float) -> np.ndarray:
    """Remainder of a division in time units of 1/scale; its coefficients from the highest power of the divisor's less one."""
    scaled = polynomial * scale ** np.arange(len(polynomial) - 1, -1, -1.0)
    divisor = by * scale ** np.arange(len(by) - 1, -1, -1.0)
    order = len(by) - 1
    if len(scaled) <= order:
        return np.concatenate([np.zeros(order - len(scaled)), scaled])
    # Not numpy's, which treats values below 1e-8 as zero.
    rest = scaled.astype(float)
    for k in range(len(rest) - order):
        rest[k : k + order + 1] -= rest[k] * divisor / divisor[0]
    return rest[-order:]


def default_natural_frequency(plant: Plant, damping: float, pace: float) -> float:
    """Return the natural frequency at which the rudder angle equals the heading error, Kp = 1, in rad/s.

    Where the rate gain would be negative there, or the loop unstable, it is the nearest frequency at which neither is.

    Parameters
    ----------
    plant : Plant
        One condition.
    damping : float
        Damping ratio of the pair.
    pace : float
        u/L in 1/s, about which it is searched.

    Raises
    ------
    UnstableDesignError
        If no frequency gives a stable loop with gains of one sign.
    """
    grid = pace * np.geomspace(0.02, 20.0, 121)
    good = [(abs(np.log(abs(g.Kp))), omega, g) for omega, g in _candidates(plant, grid, damping)]
    if not good:
        raise UnstableDesignError(
            f"no pair of poles of damping {damping:g} leaves the loop of this ship stable with gains of one sign."
        )
    _, near, _ = min(good, key=lambda c: c[0])
    step = np.log(grid[1] / grid[0])

    def excess(x: float) -> float:
        return float(np.log(abs(place(plant, pole_pair(np.exp(x), damping)).Kp)))

    ends = np.log(near) - step, np.log(near) + step
    if excess(ends[0]) * excess(ends[1]) < 0:
        found = float(np.exp(brentq(excess, *ends, xtol=1e-14, rtol=1e-14)))
        if list(_candidates(plant, np.array([found]), damping)):
            return found
    return float(near)


def _candidates(plant: Plant, grid: np.ndarray, damping: float) -> Iterator[tuple[float, Gains]]:
    """Frequencies at which the loop is stable and both gains have the same sign."""
    for omega in grid:
        try:
            gains = place(plant, pole_pair(omega, damping))
        except NotSteerableError:
            continue
        if gains.Kp * gains.Kd >= 0 and gains.Kp != 0 and closed_poles(plant, gains).real.max() < 0:
            yield float(omega), gains


def lqr_gains(plant: Plant, weight: float, pace: float) -> Gains:
    """Return the gains of least cost of heading error and rudder, ``integral(psi^2 + weight delta^2)``, in a course change.

    It is Norrbin's and Koyama's criterion of the loss by steering without its term in the rate. A ship of first order is fed
    back in full by heading and rate, and gets the gains of LQR; of a ship of higher order, whose other states are not
    measured, the two gains are found that cost least.

    Parameters
    ----------
    plant : Plant
        One condition.
    weight : float
        Of the rudder squared against the heading error squared.
    pace : float
        u/L in 1/s, the time unit in which the regulator is computed.

    Raises
    ------
    UnstableDesignError
        If no gains of heading and rate stabilise the ship.
    """
    # Rates count a ship length: all numbers are near one.
    scale = np.array([1.0 if s == "psi" else pace for s in plant.states])
    A, B, C = plant.A / pace * scale[None, :] / scale[:, None], plant.B / pace / scale, plant.C * scale
    C[1] /= pace
    if len(plant.states) == 2:
        import control

        feedback, _, _ = control.lqr(A, B[:, None], np.outer(C[0], C[0]), np.array([[weight]]))
        kp, kd = np.linalg.solve(C.T, np.asarray(feedback).ravel())
        return Gains(float(kp), float(kd / pace))
    start = np.array([1.0 if s == "psi" else 0.0 for s in plant.states])

    def cost(gains: np.ndarray) -> float:
        closed = A - np.outer(B, gains @ C)
        if np.linalg.eigvals(closed).real.max() >= 0:
            return float("inf")
        weights = np.outer(C[0], C[0]) + weight * np.outer(gains @ C, gains @ C)
        return float(start @ solve_continuous_lyapunov(closed.T, -weights) @ start)

    grid = pace * np.geomspace(0.05, 10.0, 25)
    tried = [np.array([g.Kp, g.Kd * pace]) for _, g in _candidates(plant, grid, 0.9)]
    if not tried:
        raise UnstableDesignError("no gains of heading and rate were found that stabilise this ship.")
    found = minimize(cost, min(tried, key=cost), method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-12})
    return Gains(float(found.x[0]), float(found.x[1] / pace))


def check_stable(poles: Sequence[complex] | np.ndarray, where: str) -> None:
    """Raise an error for a loop with a pole that does not decay.

    Parameters
    ----------
    poles : sequence of complex
        In rad/s.
    where : str
        Put into the message: of what, at which speed.

    Raises
    ------
    UnstableDesignError
        If one grows, or stands on the axis.
    """
    worst = max(poles, key=lambda p: p.real)
    if worst.real >= -_AXIS * max(abs(p) for p in poles):
        raise UnstableDesignError(
            f"{where} is unstable: besides the requested poles there is one at {worst.real:.3g}{worst.imag:+.3g}i rad/s. Take "
            "a lower natural frequency, or a higher damping."
        )
