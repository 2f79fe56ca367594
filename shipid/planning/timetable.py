"""The timetable of a plan: rudder orders with their times and conditions, and the sea room that the trials take.

Times and tracks are those of the ship as it is known before the trials, simulated in calm or in a current and a wind that are stated. An order with a condition is given when it is
met, not by the clock: the trials are sailed to find out how the ship turns.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.vocabulary import angle, to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import brief, quantity
from shipid.foundation.result import Result
from shipid.parameters.parameter_set import ParameterSet
from shipid.planning.leg import Leg
from shipid.trials.manoeuvres.manoeuvre import parse_manoeuvre
from shipid.trials.manoeuvres.simulate import NotSailedError, simulate
from shipid.trials.trial import Trial


@dataclass(frozen=True, repr=False)
class TimetableOrder(Result):
    """One line of a timetable.

    Attributes
    ----------
    time : float
        In s of the plan.
    leg : int
        Which manoeuvre of the plan, from 1.
    action : str
        What is done.
    when : str
        The condition at which it is done; empty where it is done at the time.
    rudder : float or None
        The rudder angle ordered in rad, positive to starboard; None where none is ordered.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"time": "s", "rudder": "rad"}

    time: float
    leg: int
    action: str
    when: str = ""
    rudder: float | None = None

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {
            "time": quantity(round(self.time, 3), "s"),
            "manoeuvre": self.leg,
            "action": self.action,
            "when": self.when,
            "rudder": None if self.rudder is None else quantity(round(to_display(self.rudder, "delta"), 6), "deg"),
        }


@dataclass(frozen=True, repr=False)
class SeaRoom(Result):
    """How far a ship goes from where it begins, along its first heading and across it, in m.

    Attributes
    ----------
    ahead, astern, port, starboard : float
        Each zero or more.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"ahead": "m", "astern": "m", "port": "m", "starboard": "m"}

    ahead: float
    astern: float
    port: float
    starboard: float

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {n: quantity(round(getattr(self, n), 1), "m") for n in ("ahead", "astern", "port", "starboard")}

    def text(self) -> str:
        """Return the four distances in words."""
        return (
            f"{self.ahead:.0f} m ahead, {self.astern:.0f} m astern, {self.port:.0f} m to port, "
            f"{self.starboard:.0f} m to starboard"
        )


@dataclass(frozen=True, repr=False)
class Timetable(Result):
    """The orders of a plan, and its sea room; made by `timetable_of`.

    Attributes
    ----------
    orders : tuple of TimetableOrder
        In the order of time.
    rooms : tuple of SeaRoom
        Of each manoeuvre, from its approach; empty for a model without a position.
    room : SeaRoom or None
        Of all of them one after the other, with the steady runs between them straight ahead.
    weather : str
        The current and the wind they are sailed in, in words.
    """

    TABLE: ClassVar[str] = "orders"

    orders: tuple[TimetableOrder, ...]
    rooms: tuple[SeaRoom, ...]
    room: SeaRoom | None
    weather: str = "calm"

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {
            "weather": self.weather,
            "orders": [o.to_dict() for o in self.orders],
            "sea_room": None if self.room is None else self.room.to_dict(),
            "sea_room_of_each": [r.to_dict() for r in self.rooms],
        }

    def text(self) -> str:
        """Return a line for each order, and the sea room."""
        lines = [
            f"  timetable, in {self.weather}, by what is known of the ship; an order with a condition is given when it is met:"
        ]
        lines += [f"  {clock(o.time):>7s}  {o.leg}  {o.action}{f', {o.when}' if o.when else ''}" for o in self.orders]
        if self.room is not None:
            lines.append("  sea room, from the first position and heading:")
            if len(self.rooms) > 1:
                lines += [f"           {k}  {r.text()}" for k, r in enumerate(self.rooms, start=1)]
            lines.append(f"         all  {self.room.text()}")
        return "\n".join(lines)


def clock(seconds: float) -> str:
    """Return a time as minutes and seconds, or hours too.

    Parameters
    ----------
    seconds : float
        The time.
    """
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


@dataclass(frozen=True)
class Surroundings:
    """Where and in what a plan is sailed, SI; calm water on a heading to the north by default.

    Attributes
    ----------
    heading : float
        Of the first approach, in rad.
    current, wind : tuple of float or None
        Speed in m/s and direction it flows TO, in rad.
    """

    heading: float = 0.0
    current: tuple[float, float] | None = None
    wind: tuple[float, float] | None = None

    @property
    def drift(self) -> tuple[float, float]:
        """The current to the north and to the east, in m/s."""
        speed, to = self.current or (0.0, 0.0)
        return speed * float(np.cos(to)), speed * float(np.sin(to))

    @property
    def words(self) -> str:
        """Current and wind in words."""
        told = (
            []
            if self.current is None
            else [f"a current of {brief(self.current[0])} m/s to {_bearing(self.current[1])}"]
        )
        told += (
            [] if self.wind is None else [f"a wind of {brief(self.wind[0])} m/s from {_bearing(self.wind[1] + np.pi)}"]
        )
        return f"{' and '.join(told)}, first heading {_bearing(self.heading)}" if told else "calm"


def timetable_of(
    model: Model, ship: ParameterSet, legs: Sequence[Leg], surroundings: Surroundings | None = None
) -> Timetable:
    """Return the timetable of manoeuvres sailed one after the other.

    Parameters
    ----------
    model : Model
        The ship's model, with a heading.
    ship : ParameterSet
        The ship.
    legs : sequence of Leg
        The manoeuvres.
    surroundings : Surroundings, optional
        First heading, current and wind; calm by default.

    Raises
    ------
    NotSailedError
        If the model does not sail one of them.
    """
    around = surroundings or Surroundings()
    orders: list[TimetableOrder] = []
    tracks: list[np.ndarray] = []
    heading = around.heading
    for k, leg in enumerate(legs, start=1):
        trial = simulate(
            model,
            ship,
            leg.manoeuvre,
            speed=leg.speed,
            duration=leg.duration,
            seed=leg.seed,
            heading=heading,
            current=around.current,
            wind=around.wind,
        )
        before = "" if k == 1 or legs[k - 2].speed == leg.speed else "new speed, "
        orders.append(TimetableOrder(leg.start, k, f"{before}steady on a straight course at {brief(leg.speed)} m/s"))
        orders += _orders(trial, leg, k)
        orders.append(TimetableOrder(leg.start + leg.duration, k, "end; steady the ship on a straight course"))
        if "x" in trial.table and "y" in trial.table:
            tracks.append(np.stack([trial["x"] - trial["x"][0], trial["y"] - trial["y"][0], trial["psi"]]))
        # Each begins on the heading on which the one before ended.
        heading = float(trial["psi"][-1])
    rooms = tuple(_room(track, float(track[2, 0])) for track in tracks)
    whole = _room(_whole(tracks, legs, around), around.heading) if len(tracks) == len(legs) and tracks else None
    return Timetable(tuple(orders), rooms, whole, around.words)


def sailed_timetable(
    model: Model,
    ship: ParameterSet,
    legs: Sequence[Leg],
    warnings: list[str],
    surroundings: Surroundings | None = None,
) -> Timetable | None:
    """Return the timetable of manoeuvres; None, and a warning that says why, where the model does not sail one of them.

    Parameters
    ----------
    model : Model
        The ship's model, with a heading.
    ship : ParameterSet
        The ship.
    legs : sequence of Leg
        The manoeuvres.
    warnings : list of str
        It is added to.
    surroundings : Surroundings, optional
        First heading, current and wind; calm by default.
    """
    try:
        return timetable_of(model, ship, legs, surroundings)
    except NotSailedError as error:
        warnings.append(f"there is no timetable: {error}")
        return None


def _orders(trial: Trial, leg: Leg, number: int) -> list[TimetableOrder]:
    """The steps of the rudder order; one line for a helmsman who steers all the time."""
    manoeuvre = parse_manoeuvre(leg.manoeuvre)
    order, t = trial["delta_order"], trial["t"]
    changed = np.flatnonzero(np.diff(order) != 0) + 1
    if manoeuvre.kind in ("course", "reversed-spiral"):
        return (
            [_steered(manoeuvre.kind, manoeuvre.numbers, leg.start + float(t[changed[0]]), number)]
            if len(changed)
            else []
        )
    found = []
    for n, i in enumerate(changed.tolist()):
        before, value = float(order[i - 1]), float(order[i])
        when = ""
        if manoeuvre.kind == "zigzag" and n:
            when = f"when the heading has changed by {_sided(np.copysign(manoeuvre.numbers[1], before))}"
        elif manoeuvre.kind == "turn" and n:
            turn = manoeuvre.numbers[1] if len(manoeuvre.numbers) > 1 else 3 * np.pi
            when = f"when the ship has turned by {angle(float(turn), 4)}"
        action = f"rudder {_sided(value)}" if value else "rudder amidships"
        found.append(TimetableOrder(leg.start + float(t[i]), number, action, when, value))
    return found


def _steered(kind: str, numbers: Sequence[float], time: float, number: int) -> TimetableOrder:
    if kind == "course":
        most = f" with at most {angle(numbers[1], 3)} of rudder" if len(numbers) > 1 else ""
        return TimetableOrder(time, number, f"change course by {_sided(numbers[0])}{most}, and steer it")
    return TimetableOrder(time, number, f"steer steady rates of turn up to r L/U = {numbers[0]:g}, one after the other")


def _bearing(value: float) -> str:
    """A direction from 0 to 360 degrees, in words."""
    return angle(float(value % (2 * np.pi)), 3)


def _sided(value: float) -> str:
    return f"{angle(abs(float(value)), 4)} to {'starboard' if value > 0 else 'port'}"


def _whole(tracks: Sequence[np.ndarray], legs: Sequence[Leg], around: Surroundings) -> np.ndarray:
    """All tracks (x, y, psi) one after the other, each from where the steady run behind the one before ends."""
    here = np.zeros(3)
    pieces = []
    for k, (track, leg) in enumerate(zip(tracks, legs)):
        placed = track + np.array([[here[0]], [here[1]], [0.0]])
        pieces.append(placed)
        here = placed[:, -1]
        if k + 1 < len(legs):
            after = legs[k + 1]
            time = after.start - leg.start - leg.duration
            north, east = around.drift
            ahead = after.speed * np.array([np.cos(here[2]), np.sin(here[2])]) + np.array([north, east])
            here = here + time * np.append(ahead, 0.0)
    return np.concatenate([*pieces, here[:, None]], axis=1)


def _room(track: np.ndarray, heading: float) -> SeaRoom:
    """How far a track (x, y) that begins at zero goes along a heading and across it."""
    ahead = track[0] * np.cos(heading) + track[1] * np.sin(heading)
    aside = track[1] * np.cos(heading) - track[0] * np.sin(heading)
    return SeaRoom(*(max(0.0, float(v)) for v in (ahead.max(), -ahead.min(), -aside.min(), aside.max())))
