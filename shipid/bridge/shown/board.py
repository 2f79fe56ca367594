"""What the page shows, key by key, each with the number of its last change: a client is sent what changed since it was served."""

from __future__ import annotations

from collections.abc import Iterable

from shipid.bridge.shown.plain_values import strict_json
from shipid.foundation.aliases import Plain


class Board:
    """The newest value of every key as JSON.

    Attributes
    ----------
    version : int
        Counts the changes.
    """

    def __init__(self) -> None:
        self.version = 0
        self._texts: dict[str, str] = {}
        self._changed: dict[str, int] = {}

    def put(self, key: str, value: Plain) -> None:
        """Set a key; an equal value is no change.

        Parameters
        ----------
        key : str
            The key.
        value : plain values
            What JSON can hold; a number that is not finite becomes null.
        """
        self.put_text(key, strict_json(value))

    def put_text(self, key: str, text: str) -> None:
        """Set a key whose value is JSON already; an equal text is no change.

        Parameters
        ----------
        key : str
            The key.
        text : str
            Strict JSON.
        """
        if self._texts.get(key) != text:
            self.version += 1
            self._texts[key], self._changed[key] = text, self.version

    def since(self, version: int) -> Iterable[tuple[str, str]]:
        """Return the keys that have changed since a version, with their values as JSON.

        Parameters
        ----------
        version : int
            The version a client has; 0 for all.
        """
        return [(k, self._texts[k]) for k, changed in self._changed.items() if changed > version]
