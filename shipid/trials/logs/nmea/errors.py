"""What can be wrong with an NMEA log besides what can be wrong with any trial."""

from __future__ import annotations

from shipid.trials.errors import TrialError


class NmeaError(TrialError):
    """Base of what can be wrong with an NMEA log."""


class NotNmeaError(NmeaError):
    """The file holds neither an NMEA 0183 sentence nor an NMEA 2000 message in canboat's form."""


class BrokenLogError(NmeaError):
    """Most lines of the log are broken."""


class NoTimeError(NmeaError):
    """Nothing in the log says when a line was written."""


class NoSignalError(NmeaError):
    """No sentence of the log carries anything that a trial can hold."""


class NoRudderError(NmeaError):
    """The format file asks for a rudder that the log does not hold."""


class CalibrationError(NmeaError):
    """The values of a sentence cannot be what they are taken for, and need a calibration."""


class NoOverlapError(NmeaError):
    """Heading and rudder were not recorded at the same time."""


class NoSuchSourceError(NmeaError):
    """The format file asks for a sentence or talker that the log does not hold."""
