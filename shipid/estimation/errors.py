"""Errors of filters: one class for each cause."""

from __future__ import annotations

from shipid.foundation.errors import ShipidError, UsageError
from shipid.foundation.exit_codes import ExitCode


class NoiseLevelError(UsageError):
    """A noise level that is missing, zero or negative."""


class NotMeasurableError(UsageError):
    """A measured name that the model does not have, or the record does not hold."""


class TransitionError(UsageError):
    """Transition or mode probabilities that do not fit the modes, or do not sum to one."""


class ModeError(UsageError):
    """Modes of a multiple-model filter that do not fit each other."""


class CovarianceError(UsageError):
    """A covariance that is not symmetric and positive."""


class SensorRateError(UsageError):
    """A sensor that is to be read more often than the record is sampled."""


class FilterDivergedError(ShipidError):
    """The estimate diverged: it is no longer finite."""

    exit_code = ExitCode.NO_CONVERGENCE


class SavedStateError(ShipidError):
    """A saved filter state that cannot be read, or belongs to another filter."""
