"""A log as it is written, of whatever kind: a table, NMEA 0183 or NMEA 2000, by the format or by its first line."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.live.following import LiveFollowing
from shipid.trials.logs.live.messages import LiveMessages
from shipid.trials.logs.live.nmea import LiveNmea
from shipid.trials.logs.live.table import LiveSample, LiveTable, is_sample_line
from shipid.trials.logs.nmea.messages.canboat import is_message
from shipid.trials.logs.nmea.sentences.collecting import is_sentence
from shipid.trials.logs.nmea.settings import NmeaFormat, chosen_format

#: Lines that may stand above the first sentence.
_HEAD = 20


class LiveLog:
    """The samples of a log as it is written.

    Parameters
    ----------
    lines : iterable of str
        Its lines as they come.
    where : str
        The log, for messages.
    format : str, Path, TrialFormat or None
        As for `shipid.read_trial`.
    tell : callable
        Takes what there is to say of a line: a line that is no sample is told with its number and left out.

    Raises
    ------
    FormatFileError, MissingFileError
        If the format file cannot be read.
    """

    def __init__(
        self,
        lines: Iterable[str],
        where: str,
        format: str | Path | TrialFormat | None,
        tell: Callable[[str], None],
    ) -> None:
        self._lines, self._where, self._tell = lines, where, tell
        self._format = chosen_format(format)
        self._reader: LiveTable | LiveNmea | None = None
        self._following = LiveFollowing(where, tell)

    @property
    def names(self) -> tuple[str, ...]:
        """The channels that are known so far."""
        return (*self._reader.names, *self._following.names) if self._reader is not None else ()

    @property
    def units(self) -> dict[str, str]:
        """The unit in which a table holds each of its channels; sentences have their own, and nothing stands here."""
        return self._reader.units if isinstance(self._reader, LiveTable) else {}

    @property
    def settled(self) -> bool:
        """Whether no further channel can come: a table names them all in its header."""
        return isinstance(self._reader, LiveTable)

    def __iter__(self) -> Iterator[LiveSample]:
        """Yield the samples, with the speeds and the true wind that follow from them.

        Raises
        ------
        TrialError
            If the header cannot be read as that of a log, or nothing comes before the log ends.
        """
        yield from map(self._following.complete, self._samples())

    def _samples(self) -> Iterator[LiveSample]:
        before: list[str] = []
        for number, line in enumerate(self._lines, start=1):
            if self._reader is not None:
                yield from self._reader.take(number, line)
                continue
            before.append(line)
            if line.strip() and not line.lstrip().startswith("#"):
                self._reader = self._choose(line, last=len(before) >= _HEAD)
                yield from self._again(before)
        if self._reader is None:
            self._reader = LiveTable(self._format, self._where, self._tell)
            yield from self._again(before)
        yield from self._reader.end()

    def _again(self, before: list[str]) -> Iterator[LiveSample]:
        """What the lines hold that came before it was known what they are."""
        if self._reader is not None:
            for k, text in enumerate(before, start=1):
                yield from self._reader.take(k, text)

    def _choose(self, line: str, last: bool) -> LiveTable | LiveNmea | None:
        """What the log is, by a line; None where it stands above sentences or samples, and nothing is decided."""
        fmt, text = self._format, line.strip()
        if is_message(text) and (fmt is None or isinstance(fmt, NmeaFormat)):
            return LiveMessages(fmt or NmeaFormat("nmea", {}), self._where, self._tell)
        if isinstance(fmt, NmeaFormat) or (fmt is None and is_sentence(text)):
            fmt = fmt if isinstance(fmt, NmeaFormat) else NmeaFormat("nmea", {})
            return LiveNmea(fmt, self._where, self._tell)
        if fmt is None and not last and not is_sample_line(text):
            return None
        return LiveTable(fmt, self._where, self._tell)
