"""Errors of the encounter: one class for each cause."""

from __future__ import annotations

from shipid.foundation.errors import ShipidError, UsageError


class TargetError(ShipidError):
    """What is known of another ship, or of own ship beside her, is not a motion: wrong size, missing or infinite numbers."""


class EncounterRequestError(UsageError):
    """A setting of a prediction or of an avoidance that is out of range."""
