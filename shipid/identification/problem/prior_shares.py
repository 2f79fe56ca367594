"""How much of what a fit knows of a coefficient is its prior, and not the trials."""

from __future__ import annotations

from collections.abc import Mapping

from shipid.estimation.estimate import Estimate
from shipid.identification.problem.prior import Prior

#: Share of the information from which a coefficient is held by its prior.
MOSTLY = 0.5


def prior_shares(prior: Prior | None, parameters: Mapping[str, Estimate]) -> dict[str, float]:
    """Return the share of the information on each coefficient that its prior is: its variance after over before, at most 1.

    Parameters
    ----------
    prior : Prior or None
        The prior of the fit, if the method has one.
    parameters : mapping of str to Estimate
        The estimates; a coefficient without a standard deviation is known by its prior alone.

    Returns
    -------
    dict of str to float
        By coefficient that has a prior, in the order of the model.
    """
    shares = {}
    for name, (_, before) in ({} if prior is None else prior.parameters).items():
        std = parameters[name].std
        shares[name] = 1.0 if std is None else min(1.0, (std / before) ** 2)
    return shares


def held_words(shares: Mapping[str, float]) -> str:
    """Return the coefficients that are known more by their prior than by the trials, the most held first: ``m (96 %), q21 (67 %)``.

    Parameters
    ----------
    shares : mapping of str to float
        See `prior_shares`.
    """
    held = sorted((n for n, share in shares.items() if share > MOSTLY), key=lambda n: -shares[n])
    return ", ".join(f"{n} ({100 * shares[n]:.0f} %)" for n in held)
