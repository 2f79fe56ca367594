"""AIS messages out of sentences: which are ships with a position, which own ship's, and which neither."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field

from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingExtraError
from shipid.trials.logs.nmea.sentences.lines import Sentence, checksum

#: Messages with the position of a ship; beyond the pole and half way round stand for none.
_SHIPS, _POLE, _HALF_WAY = (1, 2, 3, 18, 19), 90.0, 180.0
#: Messages with a position that is no ship's, and the one that rounds a ship's to a tenth of a minute: 185 m.
_OTHERS, _COARSE = (4, 9, 11, 21), 27
#: Sentences of one message at most, and messages that are waited for at most.
_PARTS, _WAITING = 9, 64
#: What is left out, in words: one of them, several.
_WHY = {
    "broken": ("AIS message that cannot be decoded", "AIS messages that cannot be decoded"),
    "no position": ("AIS report without a position", "AIS reports without a position"),
    "no ship": (
        "AIS report of a base station, an aid to navigation or an aircraft",
        "AIS reports of base stations, aids to navigation or aircraft",
    ),
    "coarse": (
        "long-range AIS report (rounded to a tenth of a minute)",
        "long-range AIS reports (rounded to a tenth of a minute)",
    ),
    "no identity": ("AIS report without an identity (MMSI 0)", "AIS reports without an identity (MMSI 0)"),
}


@dataclass(frozen=True)
class ShipReport:
    """A ship that reports herself.

    Attributes
    ----------
    label : str
        Her MMSI.
    lat, lon : float
        rad.
    own : bool
        Whether she is own ship (VDO).
    """

    label: str
    lat: float
    lon: float
    own: bool


@dataclass
class AisReader:
    """Decodes the messages of a log, of one sentence or of several.

    Attributes
    ----------
    left_out : Counter
        How many were left out, by cause.
    """

    left_out: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        """Begin without a part of a message."""
        self._parts: dict[str, list[str]] = {}

    def take(self, fields: list[str], sentence: Sentence) -> ShipReport | None:
        """Take in a sentence.

        Parameters
        ----------
        fields : list of str
            Of the sentence.
        sentence : Sentence
            VDM or VDO.

        Returns
        -------
        ShipReport or None
            The ship that its message reports; None where it reports none.

        Raises
        ------
        MissingExtraError
            If pyais is not installed.
        """
        whole = self._whole(fields, sentence)
        if whole is None:
            return None
        message = _decoded(whole)
        if message is None:
            self.left_out["broken"] += 1
            return None
        kind = message.msg_type
        cause = "no ship" if kind in _OTHERS else "coarse" if kind == _COARSE else None
        if cause is None and kind in _SHIPS:
            lat, lon = message.lat, message.lon
            if lat is None or lon is None:
                cause = "broken"
            elif abs(lat) > _POLE or abs(lon) > _HALF_WAY:
                cause = "no position"
            else:
                cause = "report" if int(message.mmsi) else "no identity"
        if cause != "report":
            self.left_out.update([cause] if cause else [])
            return None
        own = sentence.address.endswith("VDO")
        return ShipReport(str(message.mmsi), math.radians(message.lat), math.radians(message.lon), own)

    def why(self) -> list[str]:
        """Return what was left out, a sentence a cause."""
        return [f"{n} {_WHY[cause][n > 1]} left out." for cause, n in sorted(self.left_out.items())]

    def _whole(self, fields: list[str], sentence: Sentence) -> list[str] | None:
        """The sentences of a message; None as long as some are to come."""
        count = fields[1] if len(fields) > 5 else ""
        if not (count.isdigit() and 1 <= int(count) <= _PARTS):
            self.left_out["broken"] += 1
            return None
        text = sentence.text + "*" + (sentence.checksum or checksum(sentence.text[1:]))
        if count == "1":
            return [text]
        key = f"{sentence.address}{count},{fields[3]},{fields[4]}"
        whole = [*self._parts.pop(key, []), text]
        if len(whole) == int(count):
            return whole
        self._parts[key] = whole
        if len(self._parts) > _WAITING:
            del self._parts[next(iter(self._parts))]
        return None


def _decoded(whole: list[str]) -> Plain:
    """What pyais makes of a message; None where it makes nothing of it."""
    try:
        import pyais
        from pyais.exceptions import AISBaseException
    except ImportError:
        raise MissingExtraError("reading AIS", "pyais", "ais", "Targets of a radar (TTM) need no package.") from None
    try:
        return pyais.decode(*whole)
    except (AISBaseException, ValueError, IndexError, TypeError):
        return None
