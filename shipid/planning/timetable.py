"""The timetable of a plan: rudder orders with their times and conditions, and the sea room that the trials take.

Times and tracks are those of the ship as it is known before the trials, simulated in calm. An order with a condition is given when it is
met, not by the clock: the trials are sailed to find out how the ship turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.vocabulary import angle, to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import quantity
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
    """

    orders: tuple[TimetableOrder, ...]
    rooms: tuple[SeaRoom, ...]
    room: SeaRoom | None

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {
            "orders": [o.to_dict() for o in self.orders],
            "sea_room": None if self.room is None else self.room.to_dict(),
            "sea_room_of_each": [r.to_dict() for r in self.rooms],
        }

    def text(self) -> str:
        """Return a line for each order, and the sea room."""
        lines = [
            "  timetable, in calm, by what is known of the ship; an order with a condition is given when it is met:"
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


def timetable_of(model: Model, ship: ParameterSet, legs: Sequence[Leg]) -> Timetable:
    """Return the timetable of manoeuvres sailed one after the other.

    Parameters
    ----------
    model : Model
        The ship's model, with a heading.
    ship : ParameterSet
        The ship.
    legs : sequence of Leg
        The manoeuvres.

    Raises
    ------
    NotSailedError
        If the model does not sail one of them.
    """
    orders: list[TimetableOrder] = []
    tracks: list[np.ndarray] = []
    for k, leg in enumerate(legs, start=1):
        trial = simulate(model, ship, leg.manoeuvre, speed=leg.speed, duration=leg.duration, seed=leg.seed)
        before = "" if k == 1 or legs[k - 2].speed == leg.speed else "new speed, "
        orders.append(TimetableOrder(leg.start, k, f"{before}steady on a straight course at {leg.speed:.3g} m/s"))
        orders += _orders(trial, leg, k)
        orders.append(TimetableOrder(leg.start + leg.duration, k, "end; steady the ship on a straight course"))
        if "x" in trial.table and "y" in trial.table:
            tracks.append(np.stack([trial["x"], trial["y"], trial["psi"]]))
    rooms = tuple(_room(_turned(track, 0.0, 0.0, 0.0)) for track in tracks)
    return Timetable(tuple(orders), rooms, _whole(tracks, legs) if len(tracks) == len(legs) and tracks else None)


def sailed_timetable(model: Model, ship: ParameterSet, legs: Sequence[Leg], warnings: list[str]) -> Timetable | None:
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
    """
    try:
        return timetable_of(model, ship, legs)
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


def _sided(value: float) -> str:
    return f"{angle(abs(float(value)), 4)} to {'starboard' if value > 0 else 'port'}"


def _whole(tracks: Sequence[np.ndarray], legs: Sequence[Leg]) -> SeaRoom:
    """All tracks one after the other, each from where the steady run behind the one before ends."""
    north = east = heading = 0.0
    pieces = []
    for k, (track, leg) in enumerate(zip(tracks, legs)):
        placed = _turned(track, north, east, heading)
        pieces.append(placed)
        north, east, heading = (float(row[-1]) for row in placed)
        if k + 1 < len(legs):
            after = legs[k + 1]
            run = after.speed * (after.start - leg.start - leg.duration)
            north, east = north + run * float(np.cos(heading)), east + run * float(np.sin(heading))
    return _room(np.concatenate([*pieces, np.array([[north], [east], [heading]])], axis=1))


def _turned(track: np.ndarray, north: float, east: float, heading: float) -> np.ndarray:
    """A track (x, y, psi) moved so that it begins at a position, on a heading."""
    x, y = track[0] - track[0, 0], track[1] - track[1, 0]
    by = heading - track[2, 0]
    return np.stack([north + x * np.cos(by) - y * np.sin(by), east + x * np.sin(by) + y * np.cos(by), track[2] + by])


def _room(track: np.ndarray) -> SeaRoom:
    ahead, aside = track[0], track[1]
    return SeaRoom(*(max(0.0, float(v)) for v in (ahead.max(), -ahead.min(), -aside.min(), aside.max())))
