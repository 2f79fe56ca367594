"""Several devices that share a talker, told apart as their sentences come: found by the rules of a whole log, then followed."""

from __future__ import annotations

import itertools
import math
from collections import deque
from collections.abc import Iterable, Mapping
from typing import TypeAlias

import numpy as np

from shipid.trials.logs.nmea.log import Origin, Records
from shipid.trials.logs.nmea.streams import FEWEST, TELLING, devices_of

#: What tells two devices apart: a heading, a speed, an angle, or a latitude and a longitude.
Values: TypeAlias = tuple[float, ...]
#: So many sentences are looked at together.
_WINDOW = 400
#: Samples of a device that tell where it goes, and such that tell how far it is from another.
_TRACK, _OFFSETS = 5, 3
#: A device does not speak again before so much of its beat is over, where another one is due.
_DUE = 0.4
#: Metres of a degree of latitude.
_DEGREE = 111_120.0


class LiveDevices:
    """The devices behind one origin.

    Parameters
    ----------
    origin : Origin
        Sentence and talker.

    Attributes
    ----------
    count : int
        How many devices there are, as far as is known.
    apart : str
        How far they are apart, in words.
    """

    def __init__(self, origin: Origin) -> None:
        self.count = 1
        self.apart = ""
        self._kind = origin.kind
        self._names, self._least = TELLING.get(origin.kind, ((), 0.0))
        self._rows: deque[tuple[float, ...]] = deque(maxlen=_WINDOW)
        self._heard, self._look = 0, FEWEST
        self._before: tuple[float, ...] = ()
        self._device = 0
        self._tracks: list[deque[tuple[float, Values]]] = []
        self._offsets: list[deque[Values]] = []
        self._beats: list[float] = []

    def heard(self, time: float, fields: Mapping[str, float]) -> int:
        """Return which device a sentence is of, counted from 0.

        Parameters
        ----------
        time : float
            When it came [s].
        fields : Mapping of str to float
            What it says.
        """
        says = tuple(fields.values())
        if not self._names or ("utc" in fields and str(says) == str(self._before)):
            return self._device  # a multiplexer sends it twice
        self._before = says
        values = tuple(fields[name] for name in self._names)
        if not all(map(math.isfinite, values)):
            return self._device
        if self.count > 1:
            self._device = self._nearest(time, values)
            return self._device
        self._rows.append((time, *says))
        self._heard += 1
        if self._heard >= self._look:
            # Seldom: a fast log has to be followed.
            self._look = min(2 * self._heard, self._heard + _WINDOW // 4)
            self._tell_apart(tuple(fields))
        return self._device

    def _tell_apart(self, names: tuple[str, ...]) -> None:
        """Look at what was heard so far as at a whole log."""
        rows = np.array(self._rows)
        records = Records(np.arange(len(rows)), rows[:, 1:], names)
        labels, self.apart = devices_of(self._kind, records, rows[:, 0])
        if labels is None:
            return
        self.count = int(labels.max()) + 1
        self._tracks = [deque(maxlen=_TRACK) for _ in range(self.count)]
        self._offsets = [deque(maxlen=_OFFSETS) for _ in range(self.count)]
        told = np.column_stack([records.column(name) for name in self._names]).tolist()
        for label, time, values in zip(labels.tolist(), rows[:, 0].tolist(), map(tuple, told)):
            self._add(label, time, values, self._expected(time))
        beats = [np.median(np.diff(rows[labels == k, 0])) for k in range(self.count)]
        self._beats = [max(float(beat), 1e-3) for beat in beats]
        self._rows.clear()
        # What stands at the end of a record has a neighbour on one side only.
        *_, (time, values) = self._tracks[int(labels[-1])]
        self._tracks[int(labels[-1])].pop()
        self._device = self._nearest(time, values)

    def _nearest(self, time: float, values: Values) -> int:
        """The device that is expected where a sample is; where two are expected there, the one that is due."""
        known = self._expected(time)
        if known is None:
            self._add(0, time, values, None)
            return 0
        offsets = [self._offset(k) for k in range(self.count)]
        base = offsets[self._freshest()]
        off = [
            self._size(self._difference(values, tuple(e - b + o for e, b, o in zip(known, base, offset))), values[0])
            for offset in offsets
        ]
        due = [k for k in range(self.count) if self._silent(k, time) > _DUE] or [*range(self.count)]
        best = min(due, key=lambda k: off[k])
        near = [
            k for k in due if self._size(self._difference(offsets[k], offsets[best]), values[0]) < 0.5 * self._least
        ]
        device = max(near, key=lambda k: self._silent(k, time))
        self._add(device, time, values, known)
        return device

    def _add(self, device: int, time: float, values: Values, expected: Values | None) -> None:
        freshest = self._freshest()
        if expected is not None and device and freshest != device:
            rest = self._difference(values, expected)
            self._offsets[device].append(tuple(r + b for r, b in zip(rest, self._offset(freshest))))
        self._tracks[device].append((time, values))

    def _offset(self, device: int) -> Values:
        """How far a device is from the first one."""
        known = self._offsets[device]
        return tuple(map(_middle, zip(*known))) if known else (0.0,) * len(self._names)

    def _freshest(self) -> int:
        return max(range(self.count), key=lambda k: self._tracks[k][-1][0] if self._tracks[k] else -math.inf)

    def _expected(self, time: float) -> Values | None:
        """Where the device that spoke last would be now: a wild sample in its track does not count."""
        track = self._tracks[self._freshest()]
        if len(track) < 2:
            return None
        last = track[-1][1]
        times = [then for then, _ in track]
        steps = [max(b - a, 1e-3) for a, b in itertools.pairwise(times)]
        found = []
        for k, rest in enumerate(zip(*(self._difference(values, last) for _, values in track))):
            slope = _middle((b - a) / step for (a, b), step in zip(itertools.pairwise(rest), steps))
            found.append(last[k] + _middle(r + slope * (time - then) for r, then in zip(rest[-3:], times[-3:])))
        return tuple(found)

    def _silent(self, device: int, time: float) -> float:
        """For how many beats of its own a device has been silent."""
        return (time - self._tracks[device][-1][0]) / self._beats[device]

    def _difference(self, values: Values, base: Values) -> Values:
        """From one value to another; headings by the shorter way."""
        if self._names == ("heading",):
            return ((values[0] - base[0] + 180) % 360 - 180,)
        return tuple(v - b for v, b in zip(values, base))

    def _size(self, off: Values, lat: float) -> float:
        """How large a difference is; that of positions in metres."""
        if len(off) == 1:
            return abs(off[0])
        return _DEGREE * math.hypot(off[0], off[1] * math.cos(math.radians(lat)))


def _middle(values: Iterable[float]) -> float:
    """The median, in the cheap way of a few numbers."""
    ordered = sorted(values)
    return ordered[len(ordered) // 2]
