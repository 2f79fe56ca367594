"""Multiple-model filters of many targets at once: mixing, the generated prediction, and the update with weighted plots.

The interacting multiple-model recursion is that of Blom and Bar-Shalom (1988); the update with several plots, each with its
probability, is that of Musicki and Suvorova (2008). Arrays have one row a target and one column a mode.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from shipid.encounter.tracking.filters.generated import SIZE, mixed, moved
from shipid.encounter.tracking.filters.motion import Motion, moves_of
from shipid.estimation.multiple.cycle.moves import GridMoves

#: A mode is never held impossible: it could not come back.
_LEAST = 1e-6
#: Velocity of a new track in m/s: a ship that lies still has no course, and a circle needs one.
_HARDLY = 1e-3


@dataclass(frozen=True, eq=False)
class Expected:
    """What the plots of a scan are expected to show of each target in each mode.

    Attributes
    ----------
    e : ndarray, shape (n, modes, plots, 2)
        Plot less expected position, m.
    S : ndarray, shape (n, modes, plots, 2, 2)
        Its covariance.
    inverse : ndarray, shape (n, modes, plots, 2, 2)
        Of `S`.
    density : ndarray, shape (n, modes, plots)
        Likelihood of the plot, 1/m^2.
    distance : ndarray, shape (n, modes, plots)
        Squared, in standard deviations.
    R : ndarray, shape (plots, 2, 2)
        Covariance of each plot.
    """

    e: np.ndarray
    S: np.ndarray
    inverse: np.ndarray
    density: np.ndarray
    distance: np.ndarray
    R: np.ndarray


@dataclass(frozen=True, eq=False)
class TargetFilters:
    """The estimates of many targets.

    Attributes
    ----------
    motion : Motion
        The modes.
    x : ndarray, shape (n, modes, 5)
        By mode: north and east position and velocity, and the estimated part of the turn.
    P : ndarray, shape (n, modes, 5, 5)
        Covariances.
    mu : ndarray, shape (n, modes)
        MotionMode probabilities.
    turn : ndarray, shape (n, modes)
        The turn of each mode.
    """

    motion: Motion
    x: np.ndarray
    P: np.ndarray
    mu: np.ndarray
    turn: np.ndarray

    @classmethod
    def none(cls, motion: Motion) -> TargetFilters:
        """Return the filters of no target.

        Parameters
        ----------
        motion : Motion
            The modes.
        """
        m = len(motion.modes)
        return cls(motion, np.zeros((0, m, SIZE)), np.zeros((0, m, SIZE, SIZE)), np.zeros((0, m)), np.zeros((0, m)))

    def __len__(self) -> int:
        return int(self.x.shape[0])

    def select(self, rows: np.ndarray) -> TargetFilters:
        """Return some of the targets.

        Parameters
        ----------
        rows : ndarray
            Indices, or True and False.
        """
        return replace(self, x=self.x[rows], P=self.P[rows], mu=self.mu[rows], turn=self.turn[rows])

    def begin(self, z: np.ndarray, R: np.ndarray, delay: np.ndarray, speed: float) -> TargetFilters:
        """Return the filters with new targets, each from one plot, with a velocity that is hardly known.

        Parameters
        ----------
        z : ndarray, shape (k, 2)
            Plots, m.
        R : ndarray, shape (k, 2, 2)
            Their covariances.
        delay : ndarray, shape (k,)
            How long ago each position was, s.
        speed : float
            Standard deviation of the velocity along each axis, m/s.
        """
        k, modes = len(z), self.motion.modes
        x = np.zeros((k, len(modes), SIZE))
        x[:, :, :2], x[:, :, 2] = z[:, None], _HARDLY
        P = np.zeros((k, len(modes), SIZE, SIZE))
        P[:, :, :4, :4] = first_spread(R, delay, speed)[:, None]
        P[:, :, 4, 4] = np.array([m.more**2 for m in modes])
        new = (x, P, np.tile(self.motion.first_probabilities, (k, 1)), np.tile([m.turn for m in modes], (k, 1)))
        old = (self.x, self.P, self.mu, self.turn)
        return TargetFilters(self.motion, *(np.concatenate(pair) for pair in zip(old, new)))

    def predict(self, interval: float) -> TargetFilters:
        """Return the filters after an interval: the modes mixed, then each predicted by the generated function.

        Parameters
        ----------
        interval : float
            In s; nothing changes over none.
        """
        if interval <= 0 or not len(self):
            return self
        before = self
        if len(self.motion.modes) > 1:
            switching = self.motion.switching(interval)
            mu = self.mu @ switching
            weights = self.mu[:, :, None] * switching / np.maximum(mu, _LEAST)[:, None, :]
            x, P = mixed(weights, self.x, self.P)
            before = replace(self, x=x, P=P, mu=np.maximum(mu, _LEAST))
        x, P = self.motion.predict(before.x, before.P, before.turn, interval)
        return replace(before, x=x, P=P)

    def expect(self, z: np.ndarray, R: np.ndarray, delay: np.ndarray) -> Expected:
        """Return what plots are expected to show: a position as it was some time ago.

        Parameters
        ----------
        z : ndarray, shape (m, 2)
            Plots, m.
        R : ndarray, shape (m, 2, 2)
            Their covariances.
        delay : ndarray, shape (m,)
            How long before the time of the filters each position was, s.
        """
        return expected_of(self.x, self.P, z, R, delay)

    @property
    def mode_shares(self) -> np.ndarray:
        """The mode probabilities, shape (n, modes)."""
        return self.mu

    @property
    def labels(self) -> tuple[str, ...]:
        """Of the modes."""
        return tuple(m.label for m in self.motion.modes)

    def update(self, expected: Expected, delay: np.ndarray, shares: np.ndarray) -> TargetFilters:
        """Return the filters after a scan.

        Parameters
        ----------
        expected : Expected
            Of its plots.
        delay : ndarray, shape (m,)
            As for `expect`.
        shares : ndarray, shape (n, m + 1)
            Probability that no plot is the target's (first), and that each is; rows sum to one.
        """
        if not expected.e.shape[2] or not len(self):
            return self
        density = self.mu[:, :, None] * expected.density
        whole = density.sum(axis=1, keepdims=True)
        # Where a plot says nothing of the modes, they keep their probabilities.
        by_mode = np.where(whole > 0, density / np.where(whole > 0, whole, 1.0), self.mu[:, :, None])
        joint = by_mode * shares[:, None, 1:]
        mu = joint.sum(axis=2) + self.mu * shares[:, None, 0]
        weights = joint / np.maximum(mu, 1e-300)[:, :, None]
        gain = np.einsum("nkmsi,nkmij->nkmsj", _cross(self.P, delay), expected.inverse)
        moves = np.einsum("nkmsi,nkmi->nkms", gain, expected.e)
        move = np.einsum("nkm,nkms->nks", weights, moves)
        less = np.einsum("nkm,nkmsi,nkmij,nkmtj->nkst", weights, gain, expected.S, gain, optimize=True)
        spread = np.einsum("nkm,nkms,nkmt->nkst", weights, moves, moves) - move[..., :, None] * move[..., None, :]
        P = self.P - less + spread
        mu = np.maximum(mu, _LEAST)
        return replace(
            self,
            x=self.x + move,
            P=0.5 * (P + P.swapaxes(-1, -2)),
            mu=mu / mu.sum(axis=1, keepdims=True),
        ).adapted()

    def adapted(self) -> TargetFilters:
        """Return the filters with their turns adjusted, where the structure says so."""
        moves = moves_of(self.motion)
        if moves is None or not len(self):
            return self
        x = self.x.copy()
        turn, x[:, :, 4] = moved(moves, self.turn, self.mu, x[:, :, 4])
        mu = carried_over(moves.order, self.turn, self.mu, turn) if isinstance(moves, GridMoves) else self.mu
        return replace(self, x=x, turn=turn, mu=mu)

    def combined(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the estimates over all modes.

        Returns
        -------
        x : ndarray, shape (n, 4)
            North and east position and velocity, m and m/s.
        P : ndarray, shape (n, 4, 4)
            Covariance, with the spread of the modes.
        """
        x, P = mixed(self.mu[:, :, None], self.x, self.P)
        return x[:, 0, :4], P[:, 0, :4, :4]

    def turn_rates(self) -> np.ndarray:
        """Return the rate of turn over all modes, shape (n,), rad/s."""
        turn = self.turn + self.x[:, :, 4]
        if self.motion.turn == "curvature":
            turn = turn * np.hypot(self.x[:, :, 2], self.x[:, :, 3])
        return np.asarray((self.mu * turn).sum(axis=1))


def carried_over(order: tuple[int, int, int], turn: np.ndarray, mu: np.ndarray, now: np.ndarray) -> np.ndarray:
    """Return the mode probabilities on a grid that has moved: mean and variance of the turn stay as they were.

    The published grid (`shipid.estimation.multiple.cycle.moves.GridMoves`) keeps the probabilities. What one scan says of the turn is
    then counted again at the next: the grid has moved by it, and the same probabilities move it once more. A fast aircraft contradicts
    that within a scan; the plots of a ship do not, and her grid wandered off a straight leg.

    Parameters
    ----------
    order : tuple of int
        The upper, the middle and the lower mode.
    turn, mu : ndarray, shape (n, 3)
        Turns and probabilities before the grid moved; its middle has moved to their mean.
    now : ndarray, shape (n, 3)
        Turns after it.

    Returns
    -------
    ndarray, shape (n, 3)
        A spread of turns that the grid cannot hold is the widest that it can.
    """
    upper, middle, lower = order
    mean = now[:, middle]
    variance = (mu * (turn - mean[:, None]) ** 2).sum(axis=1)
    above, below = now[:, upper] - mean, mean - now[:, lower]
    shares = np.stack([above * (above + below), below * (above + below)])
    shares = np.where(shares > 0, variance / np.where(shares > 0, shares, 1.0), 0.0)
    shares = np.maximum(shares / np.maximum(shares.sum(axis=0), 1.0), _LEAST)
    found = np.empty_like(mu)
    found[:, upper], found[:, lower] = shares
    found[:, middle] = np.maximum(1.0 - shares.sum(axis=0), _LEAST)
    return np.asarray(found / found.sum(axis=1, keepdims=True))


def first_spread(R: np.ndarray, delay: np.ndarray, speed: float) -> np.ndarray:
    """Return the covariance of position and velocity after one plot, shape (k, 4, 4).

    Parameters
    ----------
    R, delay, speed
        As for `TargetFilters.begin`.
    """
    eye = np.eye(2)
    P = np.zeros((len(R), 4, 4))
    P[:, :2, :2] = R + (delay * speed)[:, None, None] ** 2 * eye
    P[:, 2:, 2:] = speed**2 * eye
    P[:, :2, 2:] = P[:, 2:, :2] = delay[:, None, None] * speed**2 * eye
    return P


def expected_of(x: np.ndarray, P: np.ndarray, z: np.ndarray, R: np.ndarray, delay: np.ndarray) -> Expected:
    """Return what plots are expected to show of targets.

    Parameters
    ----------
    x : ndarray, shape (n, modes, >= 4)
        North and east position and velocity first.
    P : ndarray, shape (n, modes, >= 4, >= 4)
        Covariances.
    z, R, delay
        As for `TargetFilters.expect`.
    """
    shown = x[:, :, None, :2] - delay[:, None] * x[:, :, None, 2:4]
    e = z - shown
    crossed = _cross(P, delay)
    S = crossed[..., :2, :] - delay[:, None, None] * crossed[..., 2:4, :] + R
    det = S[..., 0, 0] * S[..., 1, 1] - S[..., 0, 1] ** 2
    swapped = np.stack([np.stack([S[..., 1, 1], -S[..., 0, 1]], -1), np.stack([-S[..., 0, 1], S[..., 0, 0]], -1)], -2)
    inverse = swapped / det[..., None, None]
    distance = np.einsum("nkmi,nkmij,nkmj->nkm", e, inverse, e)
    return Expected(e, S, inverse, np.exp(-0.5 * distance) / (2 * np.pi * np.sqrt(det)), distance, R)


def _cross(P: np.ndarray, delay: np.ndarray) -> np.ndarray:
    """Covariance of the states with the position of each plot, shape (n, modes, plots, states, 2)."""
    P = P[:, :, None]
    return np.asarray(P[..., :2] - delay[:, None, None] * P[..., 2:4])
