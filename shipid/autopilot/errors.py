"""Errors of the autopilot: one class a cause."""

from __future__ import annotations

from shipid.foundation.errors import ShipidError, UsageError
from shipid.foundation.exit_codes import ExitCode


class NotSteerableError(ShipidError):
    """A model that has no rudder, no heading or no rate of turn, or whose heading the rudder does not move."""


class NoStraightCourseError(ShipidError):
    """A ship that does not go straight with its rudder amidships, where an autopilot is linearised."""


class UnstableDesignError(ShipidError):
    """A request that this ship cannot be given: the loop it asks for has a pole that grows."""

    exit_code = ExitCode.NO_CONVERGENCE


class DesignRequestError(UsageError):
    """A request that is none: speeds, frequencies, dampings or limits that do not fit."""


class ScheduleError(ShipidError):
    """A schedule file that says nonsense."""
