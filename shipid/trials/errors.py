"""What can be wrong with a trial record: one class a cause, each message names file, row, column and remedy."""

from __future__ import annotations

from collections.abc import Mapping

from shipid.foundation.errors import ShipidError, UsageError


class TrialError(ShipidError):
    """Base of everything that can be wrong with a trial record, its format file or its contents."""


class ForeignFileError(TrialError):
    """A file that is no table that can be read: named for what it is."""


class FileSizeError(TrialError):
    """A file that is larger, or expands to more, than is read."""


class DamagedFileError(TrialError):
    """A file of a known kind that cannot be read as one."""


class ReaderNotStartedError(TrialError):
    """The process that reads a file of some kind cannot be started."""


class ChoiceError(TrialError):
    """A sheet, struct or group that is not there, or that has to be named because several hold a table."""


class EmptyFileError(TrialError):
    """The file holds no samples."""


class HeaderError(TrialError):
    """The file has no header that names the columns, or the header names one twice."""


class SeparatorError(TrialError):
    """The columns could not be told apart."""


class RaggedRowError(TrialError):
    """A row has more fields than the header."""


class UnknownColumnError(TrialError):
    """A column that is asked for is not in the record."""


class NoUnitError(TrialError):
    """A column says no unit; shipid does not guess one."""


class ColumnUnitError(TrialError):
    """A column's unit is unknown, or does not fit what the column measures."""


class TextInColumnError(TrialError):
    """A numeric column contains text.

    Parameters
    ----------
    message : str
        The whole message.
    cells : Mapping of int or str to Mapping of int to str, optional
        By column, as the reader counts or names them, and by row the text of the cells.
    """

    def __init__(self, message: str, cells: Mapping[int | str, Mapping[int, str]] | None = None) -> None:
        super().__init__(message)
        self.cells: Mapping[int | str, Mapping[int, str]] = cells or {}


class AmbiguousNumberError(TrialError):
    """Numbers such as 1,234 that can be read in two ways, with nothing to tell which."""


class NonFiniteError(TrialError):
    """A sample is empty, NaN or infinite."""


class ClockError(TrialError):
    """The time stamps repeat or run backwards."""


class NotALiveLogError(TrialError):
    """What is to be followed line by line is no text, or a line of it has no end."""


class NoTableError(TrialError):
    """A log that is no table, where one is needed."""


class DateOrderError(TrialError):
    """Which number of a date is the day and which the month is not decided, and the clock depends on it."""


class NoStretchError(TrialError):
    """What drives a model has so many holes that no stretch of the record is long enough."""


class LooksLikeDegreesError(TrialError):
    """An angle that is said to be in radians has the values of degrees, or the other way round.

    Parameters
    ----------
    message : str
        The whole message.
    finding : str
        What in the values says so.
    """

    def __init__(self, message: str, finding: str = "") -> None:
        super().__init__(message)
        self.finding = finding


class TooShortError(TrialError):
    """The record has too few samples to be a trial."""


class NoRudderMovementError(TrialError):
    """The rudder does not move, so the response to it cannot be identified."""


class WindowError(TrialError):
    """The window does not lie inside the record, or has no such name."""


class FormatFileError(TrialError):
    """A trial format file that cannot be read, or says something it cannot mean."""


class NotAManoeuvreError(TrialError):
    """The record is neither a zig-zag nor a turning circle, so it cannot be measured as one."""


class SeveralManoeuvresError(UsageError):
    """The record holds several manoeuvres and none is chosen, or there is none with the number asked for."""


class NotAheadError(TrialError):
    """A trial of a ship that goes astern or lies still, for a model that holds ahead."""
