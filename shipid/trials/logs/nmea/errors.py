"""What can be wrong with an NMEA log besides what can be wrong with any trial."""

from __future__ import annotations

from shipid.trials.errors import TrialError


class NmeaError(TrialError):
    """Base of what can be wrong with an NMEA log."""


class NotNmeaError(NmeaError):
    """The file holds no NMEA 0183 sentence, or is not text."""


class BrokenLogError(NmeaError):
    """Most lines of the log are broken."""


class NoTimeError(NmeaError):
    """Nothing in the log says when a line was written."""


class NoHeadingError(NmeaError):
    """No sentence of the log carries a heading."""


class NoRudderError(NmeaError):
    """No sentence of the log carries a rudder angle or order."""


class CalibrationError(NmeaError):
    """The values of a sentence cannot be what they are taken for, and need a calibration."""


class NoOverlapError(NmeaError):
    """Heading and rudder were not recorded at the same time."""


class NoSuchSourceError(NmeaError):
    """The format file asks for a sentence or talker that the log does not hold."""
