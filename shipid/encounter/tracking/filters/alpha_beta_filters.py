"""The fuzzy bank of alpha-beta filters in the place of the multiple-model filters of a tracker."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from shipid.encounter.tracking.filters.alpha_beta import FuzzySettings, advance, chosen_memory, gains, rule_shares
from shipid.encounter.tracking.filters.target_filters import Expected, expected_of, first_spread
from shipid.foundation.aliases import Plain

#: Density of the acceleration noise that widens the gate between two scans, m/s^1.5: the filters themselves know none.
_MANOEUVRE = 0.3
#: The shortest interval between two updates, s: plots of one instant say nothing of a velocity.
_SHORTEST = 0.05
#: What has one row a target.
_ROWS = ("bank", "spread", "count", "since", "usual", "mode_shares")


@dataclass(frozen=True, eq=False)
class AlphaBetaFilters:
    """The banks of many targets; arrays have one row a target.

    Attributes
    ----------
    settings : FuzzySettings
        The bank and its detector.
    bank : ndarray, shape (n, J - 1, 4)
        All filters, as of now.
    spread : ndarray, shape (n, 4, 4)
        Covariance of the chosen one: that of a straight line fitted to its memory.
    count : ndarray of int, shape (n,)
        Updates.
    since : ndarray, shape (n,)
        Time since the last one, s.
    usual : ndarray, shape (n,)
        Mean time between two, s.
    mode_shares : ndarray, shape (n, J - 1)
        How far each memory is called for.
    labels : tuple of str
        Of the memories.
    """

    settings: FuzzySettings
    bank: np.ndarray
    spread: np.ndarray
    count: np.ndarray
    since: np.ndarray
    usual: np.ndarray
    mode_shares: np.ndarray
    labels: tuple[str, ...] = field(default=())

    @classmethod
    def none(cls, settings: FuzzySettings) -> AlphaBetaFilters:
        """Return the banks of no target.

        Parameters
        ----------
        settings : FuzzySettings
            The bank and its detector.
        """
        m = settings.memories.size
        empty = np.zeros(0)
        labels = tuple(f"memory {k}" for k in settings.memories)
        return cls(
            settings, np.zeros((0, m, 4)), np.zeros((0, 4, 4)), np.zeros(0, int), empty, empty, np.zeros((0, m)), labels
        )

    def __len__(self) -> int:
        return len(self.bank)

    @property
    def mu(self) -> np.ndarray:
        """One estimate a target goes into the association, shape (n, 1)."""
        return np.ones((len(self), 1))

    @property
    def x(self) -> np.ndarray:
        """The chosen estimate, shape (n, 1, 4)."""
        memory = np.rint(chosen_memory(self.mode_shares, self.settings)).astype(int)
        return np.asarray(self.bank[np.arange(len(self)), memory - 2][:, None])

    def select(self, rows: np.ndarray) -> AlphaBetaFilters:
        """Return some of the targets.

        Parameters
        ----------
        rows : ndarray
            Indices, or True and False.
        """
        return replace(self, **{n: getattr(self, n)[rows] for n in _ROWS})

    def begin(self, z: np.ndarray, R: np.ndarray, delay: np.ndarray, speed: float) -> AlphaBetaFilters:
        """Return the banks with new targets, each from one plot.

        Parameters
        ----------
        z, R, delay, speed
            As for `shipid.encounter.tracking.filters.target_filters.TargetFilters.begin`.
        """
        k, m = len(z), self.settings.memories.size
        bank = np.zeros((k, m, 4))
        bank[..., :2] = z[:, None]
        shares = np.zeros((k, m))
        shares[:, -1] = 1.0
        new = (bank, first_spread(R, delay, speed), np.zeros(k, int), np.zeros(k), np.zeros(k), shares)
        both: dict[str, Plain] = {n: np.concatenate([getattr(self, n), value]) for n, value in zip(_ROWS, new)}
        return replace(self, **both)

    def predict(self, interval: float) -> AlphaBetaFilters:
        """Return the banks after an interval.

        Parameters
        ----------
        interval : float
            In s.
        """
        if interval <= 0 or not len(self):
            return self
        F = np.eye(4)
        F[0, 2] = F[1, 3] = interval
        Q = _MANOEUVRE**2 * np.kron([[interval**3 / 3, interval**2 / 2], [interval**2 / 2, interval]], np.eye(2))
        return replace(self, bank=self.bank @ F.T, spread=F @ self.spread @ F.T + Q, since=self.since + interval)

    def expect(self, z: np.ndarray, R: np.ndarray, delay: np.ndarray) -> Expected:
        """Return what plots are expected to show.

        Parameters
        ----------
        z, R, delay
            As for `shipid.encounter.tracking.filters.target_filters.TargetFilters.expect`.
        """
        return expected_of(self.x, self.spread[:, None], z, R, delay)

    def update(self, expected: Expected, delay: np.ndarray, shares: np.ndarray) -> AlphaBetaFilters:
        """Return the banks after a scan: each takes the mean of its plots, where one of them is more likely than none.

        Parameters
        ----------
        expected : Expected
            Of the plots.
        delay : ndarray, shape (m,)
            How old each was, s.
        shares : ndarray, shape (n, m + 1)
            Probability of no plot and of each.
        """
        found = shares[:, 0] < 0.5
        if not found.any():
            return self
        own = shares[:, 1:] / np.maximum(1 - shares[:, :1], 1e-300)
        e = np.einsum("nm,nmi->ni", own, expected.e[:, 0])[found]
        R = np.einsum("nm,mij->nij", own, expected.R)[found]
        # A plot shows where the target was; with its velocity it is brought to now.
        here = self.x[found, 0, :2] + e
        tau = np.maximum(self.since[found], _SHORTEST)
        count = self.count[found] + 1
        back = self.bank[found].copy()
        back[..., :2] -= tau[:, None, None] * back[..., 2:]
        bank, residual = advance(back, here, count, tau, self.settings)
        fired = rule_shares(residual, np.sqrt(0.5 * np.trace(R, axis1=1, axis2=2)), self.settings)
        usual = self.usual[found] + (tau - self.usual[found]) / np.minimum(count, self.settings.longest)
        memory = np.minimum(np.rint(chosen_memory(fired, self.settings)), count)
        made = self.select(np.arange(len(self)))
        made.bank[found], made.count[found], made.usual[found] = bank, count, usual
        made.since[found], made.mode_shares[found] = 0.0, fired
        made.spread[found] = _line_spread(R, memory, usual)
        return made

    def combined(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the chosen estimates, shapes (n, 4) and (n, 4, 4)."""
        return self.x[:, 0], self.spread

    def turn_rates(self) -> np.ndarray:
        """Return the rates of turn: the bank knows none, so they are zero, shape (n,)."""
        return np.zeros(len(self))


def _line_spread(R: np.ndarray, k: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """Covariance of position and velocity at the end of a line fitted to k + 1 positions, each with covariance R."""
    alpha, _ = gains(k)
    n = k + 1.0
    crossed = 6 / (tau * n * (n + 1))
    velocity = 12 / (tau**2 * (n - 1) * n * (n + 1))
    blocks = np.stack([np.stack([alpha, crossed], -1), np.stack([crossed, velocity], -1)], -2)
    return np.asarray(np.einsum("nab,nij->naibj", blocks, R).reshape(-1, 4, 4))
