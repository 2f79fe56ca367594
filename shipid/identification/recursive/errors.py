"""Errors of recursive identification: one class for each cause."""

from __future__ import annotations

from shipid.foundation.errors import UsageError
from shipid.identification.errors import IdentificationError


class NonlinearParameterError(IdentificationError):
    """A parameter that enters the equation nonlinearly, so that no regression is linear in it."""


class NoRegressionError(IdentificationError):
    """A model or a choice of parameters of which no equation of one measured state can be made."""


class ForgettingError(UsageError):
    """A forgetting factor out of range, or given to a method that has none."""
