"""Measures of course changes: of many runs as arrays in SI, and of one run in display units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import ClassVar

import numpy as np

from shipid.declaration.vocabulary import to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import with_units
from shipid.foundation.result import ResultEntry
from shipid.foundation.statistics import plain


@dataclass(frozen=True, repr=False)
class CourseChange(ResultEntry):
    """One course change, or one course kept; angles in degrees.

    Attributes
    ----------
    speed, change_deg : float
        Speed before it in m/s, and the change; 0 where a course is kept.
    weather : str
        "calm", or the weather.
    overshoot_deg, settling_s : float or None
        None where the run diverged, or the heading does not settle.
    rms_error_deg, mean_error_deg, rms_rudder_deg : float or None
        Over the run; in weather, after it has begun.
    reversals : float or None
        Of the rudder by more than half a degree, a minute.
    travel_deg_s : float or None
        Rudder travel in a second, to and fro.
    cross_track_m : float or None
        Width of the track across the new course once the heading is reached; None where it is not.
    sea_filter : bool
        Whether heading and rate went through the sea filter.
    lost : bool
        Whether the run diverged.
    waves_met : float or None
        Waves the ship meets in a minute on the course it keeps; None in calm.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"speed": "m/s", "reversals": "1/min", "waves_met": "1/min"}

    speed: float
    change_deg: float
    weather: str
    overshoot_deg: float | None
    settling_s: float | None
    rms_error_deg: float | None
    mean_error_deg: float | None
    rms_rudder_deg: float | None
    reversals: float | None
    travel_deg_s: float | None
    cross_track_m: float | None
    sea_filter: bool = False
    lost: bool = False
    waves_met: float | None = None

    def without_measures(self) -> CourseChange:
        """Return the change as one of which nothing is measured, as the run was lost."""
        return CourseChange(
            self.speed, self.change_deg, self.weather, *(None,) * 8, sea_filter=self.sea_filter, lost=True
        )

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return with_units(asdict(self), speed="m/s", reversals="1/min", waves_met="1/min")


@dataclass(frozen=True, eq=False)
class CourseChanges:
    """Measures of many runs; SI, one entry a run, not a number where a run diverged.

    Attributes
    ----------
    speed, change : ndarray
        Of the run: m/s, rad.
    overshoot : ndarray
        Largest heading beyond the one ordered, in rad.
    settling : ndarray
        Time until the heading stays within 2 % of the change, at least half a degree, in s; infinite where it does not.
    mean_error, rms_error, rms_rudder : ndarray
        In rad.
    reversals : ndarray
        Of the rudder, by more than half a degree, a minute.
    travel : ndarray
        Rudder travel in rad per second.
    cross_track : ndarray
        Width of the track across the new course once the heading is reached, the drift of the current taken out, in m.
    duration : ndarray
        Of the run in s.
    """

    speed: np.ndarray
    change: np.ndarray
    overshoot: np.ndarray
    settling: np.ndarray
    mean_error: np.ndarray
    rms_error: np.ndarray
    rms_rudder: np.ndarray
    reversals: np.ndarray
    travel: np.ndarray
    cross_track: np.ndarray
    duration: np.ndarray

    def at(self, index: int | np.ndarray | slice) -> CourseChanges:
        """Return one run, or some.

        Parameters
        ----------
        index : int, ndarray or slice
            Of the runs.
        """
        return CourseChanges(**{f.name: np.atleast_1d(getattr(self, f.name)[index]) for f in fields(self)})

    def one(self, index: int, weather: str, sea_filter: bool = False) -> CourseChange:
        """Return one run in display units.

        Parameters
        ----------
        index : int
            Of the run.
        weather : str
            "calm", or the weather; in weather no heading settles, and no settling time is given.
        sea_filter : bool
            Whether heading and rate went through the sea filter.
        """

        def degrees(values: np.ndarray) -> float | None:
            return plain(to_display(float(values[index]), "psi"))

        return CourseChange(
            speed=float(self.speed[index]),
            change_deg=round(to_display(float(self.change[index]), "psi"), 9),
            weather=weather,
            overshoot_deg=degrees(self.overshoot),
            settling_s=plain(self.settling[index]) if "calm" in weather else None,
            rms_error_deg=degrees(self.rms_error),
            mean_error_deg=degrees(self.mean_error),
            rms_rudder_deg=degrees(self.rms_rudder),
            reversals=plain(self.reversals[index]),
            travel_deg_s=degrees(self.travel),
            cross_track_m=plain(self.cross_track[index]),
            sea_filter=sea_filter,
            lost=not np.isfinite(self.overshoot[index]),
        )
