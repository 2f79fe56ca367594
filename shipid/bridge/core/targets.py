"""Other ships, as the radar reports them: where they are now, and how old that is."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from shipid.bridge.core.source import Target
from shipid.bridge.shown.plain_values import number
from shipid.foundation.aliases import Plain

#: A ship that was not heard of for so long [s] is forgotten; so many are kept.
_FORGOTTEN, _MOST = 60.0, 200


class Targets:
    """The other ships."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[Target, float, float]] = {}

    def take(self, heard: Sequence[Target], own: Mapping[str, float]) -> None:
        """Take what was heard of other ships.

        Parameters
        ----------
        heard : sequence of Target
            By range and bearing from the own ship.
        own : mapping of str to float
            ``x`` and ``y`` of the own ship, m.
        """
        for target in heard:
            x = own["x"] + target.range * math.cos(target.bearing)
            y = own["y"] + target.range * math.sin(target.bearing)
            if target.id in self._known or len(self._known) < _MOST:
                self._known[target.id] = (target, x, y)

    def to_list(self, t: float) -> list[Plain]:
        """Return plain values, SI; ships that were not heard of for a minute are forgotten.

        Parameters
        ----------
        t : float
            Now, in s.
        """
        self._known = {k: v for k, v in self._known.items() if t - v[0].t <= _FORGOTTEN}
        return [
            {
                "id": target.id, "name": target.name, "x": number(x, 8), "y": number(y, 8),
                "course": number(target.course, 5), "speed": number(target.speed, 4), "age": number(t - target.t, 4),
            }
            for target, x, y in self._known.values()
        ]  # fmt: skip
