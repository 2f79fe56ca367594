"""What every source of samples has in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol, TypeAlias, runtime_checkable

from shipid.bridge.core.console import SteeringOrder
from shipid.foundation.aliases import Plain

#: Where the samples come from.
SourceKind: TypeAlias = Literal["simulate", "replay", "nmea", "signalk"]
#: Whether samples come.
SourceState: TypeAlias = Literal["running", "paused", "ended", "lost"]


@dataclass(frozen=True)
class Target:
    """Another ship, as the radar follows her; SI.

    Attributes
    ----------
    id : str
        Her number.
    name : str
        Her name, or nothing.
    range, bearing : float
        From the own ship, in m and rad; the bearing is from north.
    course, speed : float
        In rad and m/s; NaN where they are not known.
    t : float
        When she was heard of, in s on the bridge's clock.
    """

    id: str
    name: str
    range: float
    bearing: float
    course: float
    speed: float
    t: float


@dataclass(frozen=True)
class SourceReading:
    """What was heard since the reading before.

    Attributes
    ----------
    values : mapping of str to float
        What the sensors showed, by the names of a trial's columns, SI; what was not heard is not there.
    targets : sequence of Target
        Other ships that were heard of.
    told : sequence of str
        What there is to say of the source.
    """

    values: Mapping[str, float] = field(default_factory=dict)
    targets: Sequence[Target] = ()
    told: Sequence[str] = ()


class SampleSource(Protocol):
    """Where the samples of the bridge come from.

    Attributes
    ----------
    kind : str
        Which kind of source.
    timed : bool
        Whether its time can run faster than the clock on the wall, and be paused.
    """

    kind: SourceKind
    timed: bool

    @property
    def state(self) -> SourceState:
        """Whether samples come."""

    def take(self, t: float) -> SourceReading:
        """Return what was heard up to a time.

        Parameters
        ----------
        t : float
            In s on the bridge's clock.
        """

    async def start(self) -> None:
        """Begin to listen."""

    async def stop(self) -> None:
        """Listen no more."""


@runtime_checkable
class Steered(Protocol):
    """A source that can be steered: the simulated ship."""

    @property
    def now(self) -> dict[str, float]:
        """What the ship does, without the noise of the sensors; SI."""

    def steer(self, steering: SteeringOrder) -> None:
        """Take an order.

        Parameters
        ----------
        steering : SteeringOrder
            What is ordered.
        """

    def change(self, wanted: Mapping[str, Plain]) -> None:
        """Change the surroundings or the ship.

        Parameters
        ----------
        wanted : mapping
            As in the command ``simulation``.
        """

    def to_dict(self) -> dict[str, Plain]:
        """Return what can be changed, SI."""
