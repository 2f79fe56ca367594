"""Manoeuvres by name: ``zigzag:20/20``, ``turn:35``, ``spiral:25``, ``course:60``, ``telegraph:10``."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from shipid.declaration.component import Component
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.foundation.numbers import counted
from shipid.parts.helm import CourseHelm, RateHelm, ScheduledOrder, TurningHelm, ZigzagHelm

_DEG = np.pi / 180
_NUMBERS = re.compile(r"^[-+]?\d+(\.\d*)?(/[-+]?\d+(\.\d*)?)*$")


@dataclass(frozen=True)
class Manoeuvre:
    """A manoeuvre to simulate.

    Attributes
    ----------
    kind : str
        One of `KINDS`.
    numbers : tuple of float
        Angles in rad (for a reversed spiral: the largest rate of turn, as r* = r L/U).
    approach : float
        Length of the straight approach, in ship lengths' time L/U.
    """

    kind: str
    numbers: tuple[float, ...]
    approach: float = 1.0

    def __str__(self) -> str:
        scale = 1.0 if self.kind == "reversed-spiral" else 1 / _DEG
        return f"{self.kind}:{'/'.join(f'{n * scale:g}' for n in self.numbers)}"


@dataclass(frozen=True)
class PlannedManoeuvre:
    """A manoeuvre worked out for a ship: helmsman, constants, schedule and duration.

    Attributes
    ----------
    helm : type[Component]
        The helmsman.
    constants : dict of str to float
        Numbers of the helmsman, SI.
    duration : float
        In s.
    schedule : list of (float, float)
        Begin of each step in s and value of ``helm_schedule`` from then on; empty where the helmsman reads none.
    """

    helm: type[Component]
    constants: dict[str, float]
    duration: float
    schedule: list[tuple[float, float]] = field(default_factory=list)

    def scheduled(self, t: np.ndarray) -> np.ndarray:
        """Return the schedule at some times.

        Parameters
        ----------
        t : ndarray, shape (n,)
            Times in s.

        Returns
        -------
        ndarray, shape (n,)
        """
        begins, values = (np.array(c) for c in zip(*self.schedule))
        return values[np.clip(np.searchsorted(begins, t + 1e-9, side="right") - 1, 0, None)]


#: Kind: example and meaning, for help texts.
KINDS: dict[str, tuple[str, str]] = {
    "zigzag": ("zigzag:20/20", "zig-zag with rudder and heading angle in degrees; zigzag:-20/20 begins to port"),
    "turn": ("turn:35", "turning circle through 540 degrees with pull-out; turn:-35/360 to port through 360"),
    "spiral": ("spiral:25", "direct (Dieudonne) spiral from 25 degrees of rudder down to -25 and back"),
    "reversed-spiral": ("reversed-spiral:0.6", "reversed (Bech) spiral: steady rates up to r* = r L/U = 0.6"),
    "course": ("course:60", "course change by 60 degrees; course:60/15 with at most 15 degrees of rudder"),
    "telegraph": ("telegraph:10", "random telegraph of 10 degrees of rudder to either side"),
}


def parse_manoeuvre(text: str) -> Manoeuvre:
    """Read a manoeuvre such as ``"zigzag:20/20"``.

    Parameters
    ----------
    text : str
        Kind, a colon, and numbers in degrees separated by slashes.

    Returns
    -------
    Manoeuvre

    Raises
    ------
    UnknownNameError
        If the kind is unknown.
    UsageError
        If the numbers do not fit the kind.
    """
    kind, _, rest = text.strip().partition(":")
    if kind not in KINDS:
        raise UnknownNameError("manoeuvre", kind, KINDS, f"Write one as {', '.join(e for e, _ in KINDS.values())}.")
    example = KINDS[kind][0]
    if not _NUMBERS.match(rest):
        raise UsageError(f"the manoeuvre '{text}' does not say its numbers. Write it as {example}.")
    numbers = [float(n) for n in rest.split("/")]
    wanted = {"zigzag": (2, 2), "turn": (1, 2), "course": (1, 2)}.get(kind, (1, 1))
    if not wanted[0] <= len(numbers) <= wanted[1]:
        raise UsageError(f"the manoeuvre '{text}' has {counted(len(numbers), 'number')}. Write it as {example}.")
    if numbers[0] == 0 or any(n <= 0 for n in numbers[1:]):
        raise UsageError(f"the manoeuvre '{text}' needs numbers other than zero, the second positive, as in {example}.")
    scale = 1.0 if kind == "reversed-spiral" else _DEG
    return Manoeuvre(kind, tuple(n * scale for n in numbers))


def plan(
    manoeuvre: Manoeuvre,
    unit_time: float,
    course: float,
    limit: float,
    seed: int,
    duration: float | None = None,
    rate: float | None = None,
) -> PlannedManoeuvre:
    """Work a manoeuvre out for a ship.

    Parameters
    ----------
    manoeuvre : Manoeuvre
        The manoeuvre.
    unit_time : float
        L/U in s: it sets approach, steps and duration.
    course : float
        Heading of the approach in rad.
    limit : float
        Largest rudder angle of the ship in rad.
    seed : int
        Of the random telegraph.
    duration : float, optional
        In s; by default long enough for five executes, a full circle with pull-out, or all steps. The stages of a direct spiral share
        the one that is stated.
    rate : float, optional
        What the rudder of the ship turns in rad/s: no order of the random telegraph stands shorter than the rudder takes to follow it.

    Returns
    -------
    PlannedManoeuvre
    """
    asked = _Asked(manoeuvre.numbers, manoeuvre.approach * unit_time, unit_time, course, limit, seed, duration, rate)
    return _PLANS[manoeuvre.kind](asked)


def steps_of_helm(interval: float, unit_time: float) -> int:
    """Return how many steps of helmsman and steering machine one sample of the record takes: they want a finer clock.

    Parameters
    ----------
    interval : float
        Sampling interval of the record in s.
    unit_time : float
        L/U in s.
    """
    return max(1, int(np.ceil(interval / min(0.02 * unit_time, 0.25) - 1e-9)))


@dataclass(frozen=True)
class _Asked:
    """What a plan is made of: the numbers of the manoeuvre, begin of the manoeuvre in s, and the arguments of `plan`."""

    numbers: tuple[float, ...]
    start: float
    unit: float
    course: float
    limit: float
    seed: int
    duration: float | None
    rate: float | None = None

    def second(self, otherwise: float) -> float:
        """Return the second number of the manoeuvre, which may be left out."""
        return self.numbers[1] if len(self.numbers) > 1 else otherwise

    def approach(self) -> dict[str, float]:
        """Return the constants of a helmsman who begins after a straight approach."""
        return {"helm_start": self.start, "helm_course": self.course, "helm_rudder": self.numbers[0]}


def _zigzag(asked: _Asked) -> PlannedManoeuvre:
    constants = asked.approach() | {"helm_heading": asked.numbers[1]}
    return PlannedManoeuvre(ZigzagHelm, constants, asked.duration or asked.start + 30 * asked.unit)


def _turn(asked: _Asked) -> PlannedManoeuvre:
    constants = asked.approach() | {"helm_turn": asked.second(3 * np.pi)}
    return PlannedManoeuvre(TurningHelm, constants, asked.duration or asked.start + 60 * asked.unit)


_DOWN = np.array([1.0, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0.0, -0.05, -0.1, -0.2, -0.4, -0.6, -0.8, -1.0])
#: Down and back up in steps that get finer near amidships, where a loop would show.
_STAIRS = np.concatenate([_DOWN, _DOWN[-2::-1]])


def _stairs(largest: float, start: float, step: float) -> list[tuple[float, float]]:
    """Each stage of a spiral with its begin and its level, after the straight approach."""
    return [(0.0, 0.0), *((start + i * step, float(v)) for i, v in enumerate(largest * _STAIRS))]


def _spiral(asked: _Asked) -> PlannedManoeuvre:
    step = 12 * asked.unit
    if asked.duration is not None and asked.duration > asked.start:
        # A time that is stated is that of all stages: where the loop of an unstable ship ends, she needs long to settle.
        step = (asked.duration - asked.start) / len(_STAIRS)
    schedule = _stairs(asked.numbers[0], asked.start, step)
    return PlannedManoeuvre(ScheduledOrder, {}, asked.duration or schedule[-1][0] + step, schedule)


def _reversed_spiral(asked: _Asked) -> PlannedManoeuvre:
    step = 15 * asked.unit
    schedule = _stairs(asked.numbers[0] / asked.unit, asked.start, step)
    constants = {"helm_limit": asked.limit, "helm_gain": 3 * asked.unit, "helm_reset": 2 * asked.unit}
    return PlannedManoeuvre(RateHelm, constants, asked.duration or schedule[-1][0] + step, schedule)


def _course(asked: _Asked) -> PlannedManoeuvre:
    constants = {"helm_limit": asked.second(asked.limit), "helm_damping": 1.5 * asked.unit}
    schedule = [(0.0, asked.course), (asked.start, asked.course + asked.numbers[0])]
    return PlannedManoeuvre(CourseHelm, constants, asked.duration or asked.start + 30 * asked.unit, schedule)


def _telegraph(asked: _Asked) -> PlannedManoeuvre:
    length = asked.duration or asked.start + 40 * asked.unit
    rng = np.random.default_rng([asked.seed, 1])
    # Exponential holding times with a mean of 2 L/U, but long enough for the rudder to arrive from the other side.
    swing = 2 * abs(asked.numbers[0]) / asked.rate if asked.rate else 0.0
    least = max(0.3 * asked.unit, swing)
    holds = np.maximum(rng.exponential(2 * asked.unit, size=int(length / asked.unit) + 2), least)
    levels = np.where(np.arange(holds.size) % 2 == 0, asked.numbers[0], -asked.numbers[0])
    begins = asked.start + np.concatenate([[0.0], np.cumsum(holds)[:-1]])
    return PlannedManoeuvre(ScheduledOrder, {}, length, [(0.0, 0.0), *zip(begins.tolist(), levels.tolist())])


_PLANS: dict[str, Callable[[_Asked], PlannedManoeuvre]] = {
    "zigzag": _zigzag,
    "turn": _turn,
    "spiral": _spiral,
    "reversed-spiral": _reversed_spiral,
    "course": _course,
    "telegraph": _telegraph,
}
