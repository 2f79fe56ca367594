"""What is known of a track before its first scan: a mean and a covariance, by the names of the states."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.estimation.errors import CovarianceError


@dataclass(frozen=True, eq=False)
class FirstState:
    """A first estimate, SI.

    Attributes
    ----------
    states : tuple of str
        Names of the states it knows.
    mean : ndarray, shape (states,) or (runs, states)
        Their values; one row for each run of a campaign.
    covariance : ndarray, shape (states, states)
        Their covariance.

    Raises
    ------
    CovarianceError
        If the shapes do not fit, a value is not finite, or the covariance is not symmetric with positive variances.
    """

    states: tuple[str, ...]
    mean: np.ndarray
    covariance: np.ndarray

    def __post_init__(self) -> None:
        n = len(self.states)
        mean, covariance = np.asarray(self.mean, dtype=float), np.asarray(self.covariance, dtype=float)
        if mean.shape[-1:] != (n,) or mean.ndim > 2 or covariance.shape != (n, n):
            raise CovarianceError(
                f"a first state of {', '.join(self.states)} needs {n} values and a covariance of shape ({n}, {n}); it has "
                f"{mean.shape} and {covariance.shape}."
            )
        if not (np.isfinite(mean).all() and np.isfinite(covariance).all()):
            raise CovarianceError(f"the first state of {', '.join(self.states)} has values that are not finite.")
        check_covariance(covariance, f"the first covariance of {', '.join(self.states)}")
        object.__setattr__(self, "mean", mean)
        object.__setattr__(self, "covariance", covariance)

    def places_in(self, states: tuple[str, ...]) -> tuple[list[int], list[int]]:
        """Return which of its states a mode has, and where they stand there.

        Parameters
        ----------
        states : tuple of str
            Of the mode.
        """
        own = [k for k, n in enumerate(self.states) if n in states]
        return own, [states.index(self.states[k]) for k in own]

    def put_into(self, states: tuple[str, ...], x: np.ndarray, covariance: np.ndarray) -> None:
        """Write it over the estimate of a mode, in place; states it does not know keep theirs.

        Parameters
        ----------
        states : tuple of str
            Of the mode.
        x, covariance : ndarray, shapes (n,) and (n, n)
            Its estimate.
        """
        own, at = self.places_in(states)
        x[at] = self.mean[..., own]
        covariance[at, :] = covariance[:, at] = 0.0
        covariance[np.ix_(at, at)] = self.covariance[np.ix_(own, own)]


def check_covariance(covariance: np.ndarray, what: str) -> None:
    """Raise an error for matrices that are no covariances.

    Parameters
    ----------
    covariance : ndarray, shape (..., n, n)
        One or several.
    what : str
        What it is, for the message.

    Raises
    ------
    CovarianceError
        If one is not symmetric, or not positive definite.
    """
    scale = np.sqrt(np.abs(np.einsum("...ii->...i", covariance)))
    bound = 1e-9 * scale[..., :, None] * scale[..., None, :]
    if (np.abs(covariance - np.swapaxes(covariance, -1, -2)) > bound + 1e-300).any():
        raise CovarianceError(f"{what} is not symmetric.")
    if not (np.linalg.eigvalsh(covariance) > 0).all():
        raise CovarianceError(f"{what} is not positive definite: every standard deviation must be greater than zero.")


def packed(covariance: np.ndarray) -> np.ndarray:
    """Return the upper triangle of a covariance as the cycle carries it, shape (n (n + 1) / 2,).

    Parameters
    ----------
    covariance : ndarray, shape (n, n)
        Symmetric.
    """
    return np.asarray(covariance.T[np.tril_indices(len(covariance))])
