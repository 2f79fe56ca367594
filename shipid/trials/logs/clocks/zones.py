"""Where a clock stands: its zone, the moments it says in UTC, and how they are told."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from shipid.trials.logs.clocks.course import hour_back
from shipid.trials.logs.clocks.settings import moment_text, zone_of


@dataclass(frozen=True, eq=False)
class Zone:
    """The zone of a clock.

    Attributes
    ----------
    name : str
        As it was stated; empty where nothing states it, or the stamps say their offsets.
    ahead : ndarray, shape (n,)
        Seconds ahead of UTC, of each stamp; empty where they are not known.
    converted : bool
        Whether the seconds are UTC.
    undecided : bool
        Whether the day is not known.
    assumed : bool
        Whether the stamps lie in the hour that summer time repeats, and were taken for the second one.
    """

    name: str = ""
    ahead: np.ndarray = field(default_factory=lambda: np.zeros(0))
    converted: bool = False
    undecided: bool = False
    assumed: bool = False

    @property
    def remark(self) -> str:
        """What is to be said of it behind the moment of t = 0."""
        if self.converted and not self.undecided:
            return f" ({self.name})" if self.name and self.name != "UTC" else ""
        if self.name:
            return f", zone {self.name}"
        return ", zone unknown"

    def moment(self, seconds: float, row: int) -> str:
        """Return a moment as text, with the offset of its zone where that is known.

        Parameters
        ----------
        seconds : float
            Since 1970.
        row : int
            Its sample.
        """
        if not self.converted:
            return moment_text(seconds)
        ahead = float(self.ahead[row])
        minutes = round(abs(ahead) / 60)
        sign = "-" if ahead < 0 else "+"
        tail = "Z" if not minutes else f"{sign}{minutes // 60:02d}:{minutes % 60:02d}"
        return moment_text(seconds + ahead, tail)


def to_utc(seconds: np.ndarray, name: str | None) -> tuple[np.ndarray, Zone, tuple[str, ...]]:
    """Turn local moments into UTC where their zone is known.

    Parameters
    ----------
    seconds : ndarray, shape (n,)
        Local time, since 1970; NaN where there is none.
    name : str or None
        The zone as it was stated.

    Returns
    -------
    seconds : ndarray, shape (n,)
        UTC, or as they were where the zone is not known.
    zone : Zone
        The zone.
    notes : tuple of str
        What was assumed.
    """
    zone = zone_of(name) if name else None
    if zone is None:
        return seconds, Zone(name or ""), ()
    known = np.flatnonzero(np.isfinite(seconds))
    local = pd.DatetimeIndex((np.floor(seconds[known]) * 1e9).astype("int64").astype("datetime64[ns]"))
    twice = local.tz_localize(zone, ambiguous="NaT", nonexistent="shift_forward").isna()
    summer = np.zeros(len(local), dtype=bool)
    notes: tuple[str, ...] = ()
    if twice.any():
        # The hour that summer time repeats: the clock jumps back between the two, or runs into the first or out of the second.
        back = hour_back(seconds[known])
        if back is not None:
            summer[:back] = True
        elif not twice[0]:
            summer[:] = True
        elif twice.all():
            notes = (f"WARNING: the log lies in the hour that {name} counts twice; it was taken for the second one.",)
    utc = local.tz_localize(zone, ambiguous=summer, nonexistent="shift_forward")
    ahead = np.full(len(seconds), np.nan)
    utc_ns = utc.tz_convert("UTC").tz_localize(None).to_numpy(dtype="datetime64[ns]")
    ahead[known] = (local.to_numpy(dtype="datetime64[ns]") - utc_ns).astype("int64") / 1e9
    return seconds - ahead, Zone(str(name), ahead, converted=True, assumed=bool(notes)), notes
