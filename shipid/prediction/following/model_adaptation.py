"""The prediction model follows the ship: its coefficients come from the running yaw filter.

Passenier (1989), section 5.6.2.1. The filter estimates K*/tau* and 1/tau* (and the position filter gamma*); the prediction model takes
them over at once (K_R = 1), slowly (5.91), or not at all (K_R = 0). What it does not take over is left for compensation by rudder
(5.92), as `shipid.run_on_board` does with ``adapt="reference"``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from shipid.foundation.errors import UsageError
from shipid.prediction.situations.situation import Situation

#: Bounds of K* and tau* in a prediction, those that are declared: an estimate beyond them is no first-order ship.
_LOW, _HIGH = 0.05, 50.0


class ModelAdaptation:
    """The coefficients K*, tau* and gamma* of the prediction model, following those of a yaw filter.

    Parameters
    ----------
    K, tau : float
        Where they start: as the ship's set states them.
    gamma : float, optional
        The sway constant; the predictor's own where neither it nor an estimate is given.
    following : float
        The model follows the estimates in so many seconds, 1/K_R; zero takes them over at once, infinity never.

    Attributes
    ----------
    a, b1 : float
        K*/tau* and 1/tau* of the prediction model.
    gamma : float or None
        Its sway constant.
    held : bool
        Whether the last estimates were those of no first-order ship, so that the model was kept as it was.

    Raises
    ------
    UsageError
        If it starts from no first-order ship, or follows in a negative time.
    """

    def __init__(self, K: float, tau: float, gamma: float | None = None, *, following: float = 0.0) -> None:
        if not (_LOW <= K <= _HIGH and _LOW <= tau <= _HIGH):
            raise UsageError(
                f"K* = {K:g} and tau* = {tau:g} are no first-order ship: both are from {_LOW:g} to {_HIGH:g}."
            )
        if not following >= 0:
            raise UsageError(f"a model follows its estimates in {following:g} s: give zero or more.")
        self.a, self.b1, self.gamma, self.following = K / tau, 1 / tau, gamma, following
        self.held = False
        self._t: float | None = None
        self._std: dict[str, float] = {}
        self._beyond = (0.0, 0.0)

    def update(
        self,
        t: float,
        a: float,
        b1: float,
        gamma: float | None = None,
        *,
        std: Mapping[str, float] | None = None,
    ) -> dict[str, float]:
        """Take estimates; return the coefficients of the prediction model.

        Parameters
        ----------
        t : float
            In s.
        a, b1 : float
            Estimates of K*/tau* and 1/tau*.
        gamma : float, optional
            Estimate of the sway constant gamma*.
        std : mapping of str to float, optional
            Standard deviations of ``a``, ``b1`` and ``gamma`` as the filter states them.

        Returns
        -------
        dict of str to float
            As `values`.

        Notes
        -----
        Passenier (1989), eq. (5.91), of 1/tau* and K*/tau*, in which the sampling interval and u/L drop out.
        """
        elapsed = np.inf if self._t is None else t - self._t
        share = 1.0 if self.following == 0 else float(-np.expm1(-max(elapsed, 0.0) / self.following))
        if self._t is None and self.following > 0:
            share = 0.0
        self._t = t
        good = np.isfinite([a, b1]).all() and b1 > 0 and _LOW <= a / b1 <= _HIGH and _LOW <= 1 / b1 <= _HIGH
        self.held = not bool(good)
        if good:
            self.a += share * (a - self.a)
            self.b1 += share * (b1 - self.b1)
            self._beyond = (a - self.a, b1 - self.b1)
            self._std = {n: float(s) for n, s in (std or {}).items()}
        if gamma is not None and np.isfinite(gamma):
            self.gamma = gamma if self.gamma is None else self.gamma + share * (gamma - self.gamma)
        return self.values

    @property
    def values(self) -> dict[str, float]:
        """``K``, ``tau`` and, where it is known, ``gamma`` of the prediction model."""
        found = {"K": self.a / self.b1, "tau": 1 / self.b1}
        return found if self.gamma is None else found | {"gamma": self.gamma}

    @property
    def left(self) -> tuple[float, float]:
        """What the estimates of K*/tau* and 1/tau* are beyond the model, for compensation: Passenier (1989), eq. (5.92)-(5.93)."""
        return self._beyond

    def situation(self, known: Situation) -> Situation:
        """Return a situation with the coefficients of the prediction model in it, and how sure they are.

        Parameters
        ----------
        known : Situation
            What is known of the ship.

        Returns
        -------
        Situation
            Errors of K*/tau* and 1/tau* are taken as independent, which is wider than they are: a filter's are correlated, so that
            those of K* are smaller.
        """
        values = self.values
        std = {}
        if "a" in self._std and "b1" in self._std:
            of_tau = self._std["b1"] / self.b1
            std = {"K": values["K"] * float(np.hypot(self._std["a"] / self.a, of_tau)), "tau": values["tau"] * of_tau}
        if "gamma" in self._std and "gamma" in values:
            std["gamma"] = self._std["gamma"]
        kept = [i for i, n in enumerate(known.uncertain) if n not in values]
        names = tuple(known.uncertain[i] for i in kept)
        covariance = np.zeros((len(kept) + len(std),) * 2)
        covariance[: len(kept), : len(kept)] = known.covariance[np.ix_(kept, kept)]
        covariance[len(kept) :, len(kept) :] = np.diag(np.square(list(std.values())))
        return replace(known, values={**known.values, **values}, uncertain=(*names, *std), covariance=covariance)
