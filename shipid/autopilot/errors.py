"""Errors of the autopilot: one class for each cause."""

from __future__ import annotations

from shipid.foundation.errors import ShipidError, UsageError
from shipid.foundation.exit_codes import ExitCode


class NotSteerableError(ShipidError):
    """A model that has no rudder, no heading or no rate of turn, or whose heading the rudder does not move."""


class NoStraightCourseError(ShipidError):
    """A ship that does not go straight with its rudder amidships, where an autopilot is linearised."""


class UnstableDesignError(ShipidError):
    """A request that leaves the loop of this ship unstable."""

    exit_code = ExitCode.NO_CONVERGENCE


class DesignRequestError(UsageError):
    """A request that cannot be designed for: its speeds, frequencies, dampings or limits are out of range or do not fit together."""


class ScheduleError(ShipidError):
    """A schedule file with an entry that is wrong, or whose gains do not stabilise the ship."""


class ModelFileError(ScheduleError):
    """A schedule that names a model file, which is code and is not run."""
