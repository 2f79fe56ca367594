"""Errors of a campaign: one class for each cause."""

from __future__ import annotations

from shipid.foundation.errors import ShipidError, UsageError


class CampaignDeclarationError(ShipidError):
    """A campaign that is not well formed, or whose runs return something else than it declares."""


class CampaignRequestError(UsageError):
    """A request for a campaign that does not fit: its number of runs, its folder, its engine."""


class RunError(ShipidError):
    """A run that failed; the message names it, so that it can be repeated alone."""


class CampaignFolderError(ShipidError):
    """A folder of results that cannot be gone on with: it holds another campaign, or damaged files."""


class WorkerLostError(ShipidError):
    """An engine that lost its workers; finished runs are kept."""
