"""The result of looking for an avoiding course: the course, the track own ship sails to it, and how near the others come."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from shipid.declaration.vocabulary import compass
from shipid.encounter.errors import TargetError
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.result import Result, ResultEntry, table
from shipid.foundation.statistics import NORMAL_95, plain
from shipid.prediction.tracks.predicted_track import PredictedTrack

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class OtherShip:
    """Another ship, at the instant of own ship's situation and in its frame.

    Attributes
    ----------
    name : str
        What she is called.
    motion : ndarray, shape (4,)
        North and east position in m, north and east velocity over the ground in m/s.
    covariance : ndarray, shape (4, 4), or None
        Of its errors, in that order.
    """

    name: str
    motion: np.ndarray
    covariance: np.ndarray | None = None

    def __post_init__(self) -> None:
        sound = np.shape(self.motion) == (4,) and np.isfinite(self.motion).all()
        if sound and self.covariance is not None:
            sound = np.shape(self.covariance) == (4, 4) and bool(np.isfinite(self.covariance).all())
        if not sound:
            raise TargetError(
                f"the motion of {self.name} is not known: give four finite numbers, north and east position and velocity, "
                "and a covariance of 4 rows and 4 columns or none."
            )
        if self.covariance is not None:
            least = float(np.linalg.eigvalsh((self.covariance + self.covariance.T) / 2)[0])
            # What rounding leaves of a zero is no negative variance.
            if least < -1e-9 * float(np.abs(self.covariance).max()):
                raise TargetError(
                    f"the covariance of {self.name} has a variance below zero along some direction, which none has."
                )


@dataclass(frozen=True, repr=False)
class Passing(ResultEntry):
    """How near another ship comes to own ship's track.

    Attributes
    ----------
    name : str
        Of the other ship.
    distance : float
        Smallest distance, m.
    t : float
        When, s from now.
    share : float
        The same in shares of her domain: below 1 own ship enters it.
    std : float or None
        Standard deviation of the distance by what is known of both ships, m; None where nothing says how sure they are.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"distance": "m", "t": "s", "std": "m", "share": "1"}

    name: str
    distance: float
    t: float
    share: float
    std: float | None = None

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {
            "distance": {"value": self.distance, "std": plain(self.std), "unit": "m"},
            "time": {"value": self.t, "unit": "s"},
            "share_of_domain": plain(self.share),
        }


@dataclass(frozen=True, eq=False, repr=False)
class Avoidance(Result):
    """An avoiding course that own ship can sail, or the best there is.

    Attributes
    ----------
    heading : float
        To steer, rad.
    alteration : float
        From the wanted heading, positive to starboard, rad.
    clear : bool
        Whether own ship keeps out of every domain as far as the tracks reach.
    track : PredictedTrack
        How own ship sails to it.
    passings : tuple of Passing
        The other ships along this track.
    tried : mapping of float to float
        Share of the domains that is kept, by heading in rad.
    at_once : float
        The share that would be kept if own ship turned to the heading at once.
    refused : mapping of float to str
        Headings that own ship cannot be predicted to sail to, with the reason.
    """

    heading: float
    alteration: float
    clear: bool
    track: PredictedTrack
    passings: tuple[Passing, ...]
    tried: Mapping[float, float]
    at_once: float
    refused: Mapping[float, str]

    @property
    def share(self) -> float:
        """The share of the domains that is kept along the track; infinite with no other ship."""
        return min((p.share for p in self.passings), default=np.inf)

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """What is wrong with this course."""
        found = []
        if not self.clear:
            near = min(self.passings, key=lambda p: p.share)
            words = f"no course that was tried keeps clear: this one passes {near.name} at {near.distance:.0f} m"
            found.append(Notice(f"{words}, inside her domain.", "no-clear-course", serious=True, name=near.name))
        unsure = [p for p in self.passings if p.std and p.distance - NORMAL_95 * p.std < p.distance / p.share]
        if self.clear and unsure:
            names = " and ".join(p.name for p in unsure)
            found.append(
                Notice(
                    f"within the 95 % interval of her distance {names} may pass inside her domain: clear is not sure.",
                    "clear-not-sure",
                    names=[p.name for p in unsure],
                )
            )
        if self.clear and self.at_once >= 1 and self.refused:
            words = f"{len(self.refused)} of {len(self.tried) + len(self.refused)} headings were left out"
            found.append(Notice(f"{words}: {next(iter(self.refused.values()))}.", "headings-refused"))
        return tuple(found)

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON, free of NaN."""
        return {
            "heading": {"value": float(self.heading % (2 * np.pi)), "unit": "rad"},
            "alteration": {"value": float(self.alteration), "unit": "rad"},
            "clear": self.clear,
            "share_of_domain": plain(self.share),
            "share_of_domain_turned_at_once": plain(self.at_once),
            "passings": {p.name: p.to_dict() for p in self.passings},
            "warnings": plain_notices(self.warnings),
        }

    def text(self) -> str:
        """Return the result in lines of text."""
        side = (
            "as wanted"
            if not self.alteration
            else f"{abs(np.rad2deg(self.alteration)):.0f} deg to " + ("starboard" if self.alteration > 0 else "port")
        )
        lines = [f"steer {compass(self.heading)} deg, {side}: {'clear of all domains' if self.clear else 'NOT CLEAR'}"]
        lines += [
            f"  {p.name}: {p.distance:.0f} m in {p.t:.0f} s, {p.share:.2f} of her domain"
            + ("" if p.std is None else f", standard deviation {p.std:.0f} m")
            for p in self.passings
        ]
        return "\n".join([*lines, *(f"  warning: {w}" for w in self.warnings)])

    def to_frame(self) -> pd.DataFrame:
        """Return the other ships along the avoiding track as a pandas table."""
        rows = (
            {"ship": p.name, "distance [m]": p.distance, "std [m]": p.std, "time [s]": p.t, "share_of_domain": p.share}
            for p in self.passings
        )
        return table(rows, "ship", ("distance [m]", "std [m]", "time [s]", "share_of_domain"))
