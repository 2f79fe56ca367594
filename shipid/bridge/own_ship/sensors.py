"""The sensors as they are heard: the last value of each, how old it is, and whether it is lost."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from shipid.bridge.shown.plain_values import number
from shipid.foundation.aliases import Plain

#: By the name of a trial's column: what the sensor is called, and its unit; those a bridge has come first.
_SENSORS: Mapping[str, tuple[str, str]] = {
    "psi": ("heading", "rad"), "r": ("rate of turn", "rad/s"), "u": ("speed through the water", "m/s"),
    "x": ("position", "m"), "delta": ("rudder angle", "rad"), "delta_order": ("rudder order", "rad"),
    "SOG": ("speed over ground", "m/s"), "COG": ("course over ground", "rad"), "wind_speed": ("wind", "m/s"),
    "wind_direction": ("direction the wind blows to", "rad"),
    "wind_speed_relative": ("relative wind", "m/s"),
    "wind_direction_relative": ("direction the relative wind blows to, from the bow", "rad"), "v": ("sway speed", "m/s"),
}  # fmt: skip
#: Those that are missed where they were never heard.
EXPECTED = ("psi", "r", "u", "x", "delta")
#: A sensor is lost after so many of its own intervals, and after so many seconds at least.
_INTERVALS, _LEAST = 5.0, 5.0
#: Share of the newest interval in the usual one.
_NEWEST = 0.2


@dataclass
class _Heard:
    value: float
    t: float
    interval: float = 0.0


class Sensors:
    """What the sensors showed last."""

    def __init__(self) -> None:
        self._heard: dict[str, _Heard] = {}
        self._t: float | None = None
        self._began: float | None = None

    def take(self, t: float, values: Mapping[str, float]) -> None:
        """Take what was heard up to a time.

        Parameters
        ----------
        t : float
            In s on the bridge's clock.
        values : mapping of str to float
            By the names of a trial's columns, SI.
        """
        self._t = t
        self._began = t if self._began is None else self._began
        for name in _SENSORS:
            value = values.get(name, math.nan)
            if not math.isfinite(value):
                continue
            before = self._heard.get(name)
            if before is None:
                self._heard[name] = _Heard(value, t)
                continue
            # A pause is no interval: else a sensor that came back would never be missed again.
            step = min(t - before.t, 4 * before.interval) if before.interval else t - before.t
            before.interval += (_NEWEST if before.interval else 1.0) * (step - before.interval)
            before.value, before.t = value, t

    def age(self, name: str) -> float | None:
        """Return how old the last value of a sensor is in s; None where there was none.

        Parameters
        ----------
        name : str
            The name of a trial's column.
        """
        heard = self._heard.get(name)
        return None if heard is None or self._t is None else self._t - heard.t

    def value(self, name: str) -> float | None:
        """Return the last value of a sensor, SI; None where there was none.

        Parameters
        ----------
        name : str
            The name of a trial's column.
        """
        heard = self._heard.get(name)
        return None if heard is None else heard.value

    def fresh(self, name: str) -> float | None:
        """Return the last value of a sensor that is not lost, SI; None otherwise.

        Parameters
        ----------
        name : str
            The name of a trial's column.
        """
        return None if name in self.lost else self.value(name)

    @property
    def youngest(self) -> float | None:
        """Seconds since anything was heard; None where nothing was."""
        ages = [a for a in (self.age(n) for n in self._heard) if a is not None]
        return min(ages, default=None)

    @property
    def lost(self) -> dict[str, str]:
        """The sensors that are lost, by name, with what they are called."""
        found = {}
        for name, (label, _) in _SENSORS.items():
            heard, age = self._heard.get(name), self.age(name)
            if heard is not None and age is not None:
                if age > max(_LEAST, _INTERVALS * heard.interval):
                    found[name] = label
            elif name in EXPECTED and self._t is not None and self._t - (self._began or 0.0) > _LEAST:
                found[name] = label
        return found

    def to_list(self) -> list[Plain]:
        """Return plain values, SI: those a bridge has, and those that were heard."""
        lost = self.lost
        return [
            {
                "name": "position" if name == "x" else name,
                "label": label,
                "value": None if name == "x" else number(self.value(name), 6),
                "unit": unit,
                "age": number(self.age(name), 4),
                "lost": name in lost,
            }
            for name, (label, unit) in _SENSORS.items()
            if name in EXPECTED or name in self._heard
        ]
