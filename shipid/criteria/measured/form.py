"""The ratios of the form in which a trial is reported (MSC/Circ.1053), and what the standard asks of the surroundings beside what is stated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from shipid.criteria.criteria import DEEP
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import quantity
from shipid.foundation.result import Result
from shipid.trials.conditions import Conditions
from shipid.trials.measuring.results.measures import Measures

#: Density of sea water [kg/m³], for the block coefficient.
_SEA_WATER = 1025.0
#: Wind speed at which each number of the Beaufort scale begins, from 1 on [m/s] (WMO).
_BEAUFORT = (0.3, 1.6, 3.4, 5.5, 8.0, 10.8, 13.9, 17.2, 20.8, 24.5, 28.5, 32.7)
#: What the standard asks (MSC/Circ.1053, 2.2): wind of at most this number of Beaufort.
_WINDY = 5


@dataclass(frozen=True, repr=False)
class FormEntry(Result):
    """One entry of the form.

    Attributes
    ----------
    name, label, unit : str
        Its name, what a table calls it, and its unit.
    value : float or None
        None where what it is made of is not stated or measured: a blank.
    asked : str
        What the standard asks of it; empty where it asks nothing.
    met : bool or None
        Whether that holds; None where it is not known or nothing is asked.
    """

    name: str
    label: str
    unit: str
    value: float | None
    asked: str = ""
    met: bool | None = None

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        more = {"asked": self.asked, "met": self.met} if self.asked else {}
        return {"name": self.name, "label": self.label, **quantity(self.value, self.unit), **more}


def form_of(conditions: Conditions, length: float | None, measured: Sequence[Measures]) -> tuple[FormEntry, ...]:
    """Return the entries of the form that follow from others.

    Parameters
    ----------
    conditions : Conditions
        What is stated.
    length : float or None
        Ship length in m.
    measured : sequence of Measures
        The manoeuvres; the mean of their approach speeds is that of the form.
    """
    return tuple(_entries(conditions, length, measured))


def _entries(stated: Conditions, length: float | None, measured: Sequence[Measures]) -> Iterator[FormEntry]:
    speeds = [m.approach_speed for m in measured if m.approach_speed]
    speed = float(np.mean(speeds)) if speeds else None
    breadth, draught = stated.number("breadth"), stated.loading.get("draught")
    fore, aft = stated.number("draught_forward"), stated.number("draught_aft")
    mass, rudder = stated.number("displacement"), stated.number("rudder_area")
    depth = _ratio(stated.number("depth"), draught)
    wind = stated.number("wind_speed")
    volume = None if mass is None else mass / _SEA_WATER
    yield FormEntry("test_speed", "Test speed, mean of the approaches", "m/s", speed)
    yield FormEntry("length_over_speed", "Length / test speed", "s", _ratio(length, speed))
    yield FormEntry("length_over_breadth", "Length / breadth", "1", _ratio(length, breadth))
    yield FormEntry("breadth_over_draught", "Breadth / draught", "1", _ratio(breadth, draught))
    yield FormEntry(
        "block_coefficient", "Block coefficient, in sea water", "1", _ratio(volume, length, breadth, draught)
    )
    yield FormEntry("rudder_area_ratio", "Rudder area / (length × draught)", "1", _ratio(rudder, length, draught))
    trim = None if fore is None or aft is None else aft - fore
    yield FormEntry("trim", "Trim by the stern", "m", trim)
    deep = None if depth is None else depth > DEEP
    yield FormEntry("depth_over_draught", "Water depth / draught", "1", depth, f"more than {DEEP:g}", deep)
    number = None if wind is None else float(np.searchsorted(_BEAUFORT, wind, side="right"))
    calm = None if number is None else number <= _WINDY
    yield FormEntry("beaufort", "Beaufort number of the wind", "1", number, f"at most {_WINDY}", calm)


def _ratio(value: float | None, *by: float | None) -> float | None:
    if value is None or any(not b for b in by):
        return None
    return float(value / np.prod([b for b in by if b]))
