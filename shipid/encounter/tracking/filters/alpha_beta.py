"""A bank of alpha-beta filters with memories of two to J steps, and the fuzzy detector that chooses among them.

Grinyak and Trofimov, "Multi-model target tracking with fuzzy logic maneuver detector". The paper leaves the scan interval, the
measurement error, the slope and the centre of the membership functions and J open: they are settings here. Its third rule
is printed as the second with another consequence; it is read as "good up to J - 2, bad beyond".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.encounter.errors import EncounterRequestError


@dataclass(frozen=True)
class FuzzySettings:
    """The bank and its detector.

    Attributes
    ----------
    longest : int
        J, the longest memory in steps.
    slope : float
        a of the membership functions of "good" and "bad".
    centre : float
        c, the residual in standard deviations that is as good as bad.
    """

    longest: int = 10
    slope: float = 8.0
    centre: float = 2.5

    def __post_init__(self) -> None:
        """Refuse settings that cannot be meant."""
        if self.longest < 2 or not (np.isfinite(self.slope) and self.slope > 0 and np.isfinite(self.centre)):
            raise EncounterRequestError(
                "a bank of alpha-beta filters needs a longest memory of two steps or more, and a positive slope."
            )

    @property
    def memories(self) -> np.ndarray:
        """2 to J."""
        return np.arange(2, self.longest + 1)


def gains(k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the gains alpha and beta of step k, those of a straight line fitted to k + 1 positions.

    Parameters
    ----------
    k : ndarray of int
        From 1 on; 1 starts a track from two positions.
    """
    k = np.asarray(k, float)
    divisor = (k + 2) * (k + 1)
    return 2 * (2 * k + 1) / divisor, 6 / divisor


def advance(
    x: np.ndarray, z: np.ndarray, count: np.ndarray, interval: np.ndarray, settings: FuzzySettings
) -> tuple[np.ndarray, np.ndarray]:
    """Predict and update all filters of the bank.

    Parameters
    ----------
    x : ndarray, shape (n, J - 1, 4)
        North and east position and velocity of each filter.
    z : ndarray, shape (n, 2)
        Positions measured, m.
    count : ndarray of int, shape (n,)
        Which update this is, from 1 on: before a filter's memory is full, its gains are those of a growing memory.
    interval : ndarray, shape (n,)
        Since the update before, s.
    settings : FuzzySettings
        The bank.

    Returns
    -------
    x : ndarray, shape (n, J - 1, 4)
        After the update, eq. (3).
    residual : ndarray, shape (n, J - 1)
        Distance of the measured position from the updated one, eq. (6), m.
    """
    alpha, beta = (g[..., None] for g in gains(np.minimum(count[:, None], settings.memories)))
    tau = interval[:, None, None]
    ahead = x[..., :2] + tau * x[..., 2:]
    e = z[:, None] - ahead
    position = ahead + alpha * e
    updated = np.concatenate([position, x[..., 2:] + beta / tau * e], axis=2)
    return updated, np.hypot(*np.moveaxis(z[:, None] - position, -1, 0))


def rule_shares(residual: np.ndarray, sigma: np.ndarray, settings: FuzzySettings) -> np.ndarray:
    """Return how far each memory is called for, shape (n, J - 1); rows sum to one.

    Parameters
    ----------
    residual : ndarray, shape (n, J - 1)
        Of each filter, m.
    sigma : ndarray, shape (n,)
        Standard deviation of a measured position, m.
    settings : FuzzySettings
        The detector.

    Notes
    -----
    Table 1 of the paper with products: memory m where the filters up to m are good and all longer ones are bad; and 2 where
    all are bad.
    """
    off = settings.slope * (residual / sigma[:, None] - settings.centre)
    bad = 1 / (1 + np.exp(-np.clip(off, -700, 700)))
    good = 1 - bad
    up_to = np.cumprod(good, axis=1)
    beyond = np.cumprod(bad[:, ::-1], axis=1)[:, ::-1]
    after = np.concatenate([beyond[:, 1:], np.ones((len(bad), 1))], axis=1)
    shares = up_to * after
    shares[:, 0] += beyond[:, 0]
    total = shares.sum(axis=1, keepdims=True)
    # Where no rule fires, the shortest memory is the safe one.
    none = np.zeros_like(shares)
    none[:, 0] = 1.0
    return np.asarray(np.where(total > 0, shares / np.where(total > 0, total, 1.0), none))


def chosen_memory(shares: np.ndarray, settings: FuzzySettings) -> np.ndarray:
    """Return the memory that is taken before it is rounded, shape (n,): Sugeno's weighted mean of the rules.

    Parameters
    ----------
    shares : ndarray, shape (n, J - 1)
        See `rule_shares`.
    settings : FuzzySettings
        The detector.
    """
    return np.asarray(shares @ settings.memories)
