"""Errors of identification: one class for each cause."""

from __future__ import annotations

from shipid.foundation.errors import ShipidError


class IdentificationError(ShipidError):
    """The trials and the model do not give a problem that can be solved."""


class TrialTooShortError(IdentificationError):
    """A trial shorter than the slowest time constant of the ship."""


class NoAnswerError(IdentificationError):
    """A fitted heading or rate of turn that never changes, although the rudder moves."""


class NothingToFitError(IdentificationError):
    """The trials measure nothing that the model predicts."""


class NotRegressableError(IdentificationError):
    """A method by regression was asked for, and an equation reads a state that is not measured."""


class PosteriorError(IdentificationError):
    """A posterior that cannot be sampled: no sampler, too many unknowns, or an improper density."""
