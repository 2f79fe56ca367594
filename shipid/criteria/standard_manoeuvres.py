"""The manoeuvres of the standard, simulated fast enough for a few dozen ships: turning circle, 10/10 and 20/20 zig-zag.

Measured as in IMO MSC.137(76) 4.2: distances from the order, overshoots from the heading at the second and third execute.
The simulation has no noise, so that the numbers are read off the samples and the line between them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from shipid.declaration.join import join
from shipid.declaration.model import Model
from shipid.generation.record import Record, make_record
from shipid.parts.steering_machine import SteeringMachine
from shipid.trials.manoeuvres.manoeuvre import parse_manoeuvre, plan

#: Clock and length of a manoeuvre, in L/U, after an approach of one.
_STEP, _LENGTH = 0.01, 25.0
#: Rate of turn, as r L/V, that no ship has: the model has run away.
_FASTEST = 30.0
_SHOWN = ("psi", "x", "y", "delta_order")


@dataclass(frozen=True)
class Numbers:
    """What the manoeuvres to one side amount to; SI, None where one was not reached.

    Attributes
    ----------
    values : mapping of str to float or None
        By quantity: advance, transfer, tactical_diameter, initial_turning, first_overshoot_10, second_overshoot_10,
        first_overshoot_20.
    lost : tuple of str
        Manoeuvres in which the model ran away.
    """

    values: Mapping[str, float | None]
    lost: tuple[str, ...] = field(default=())


class Standard:
    """The manoeuvres of the standard for one model and one speed.

    Parameters
    ----------
    model : Model
        A ship model that reads the rudder angle.
    speed, length : float
        Of the ship, in m/s and m.
    rudder : float
        Rudder angle of the turning circle in rad.
    steering : mapping of str to float
        ``delta_max`` and ``delta_rate`` of the steering machine, SI.
    """

    def __init__(self, model: Model, speed: float, length: float, rudder: float, steering: Mapping[str, float]) -> None:
        self._speed, self._unit_time = speed, length / speed
        degrees = float(np.rad2deg(rudder))
        self._steering = dict(steering)
        self._records: dict[str, tuple[Model, Record, dict[str, float], float]] = {}
        for kind in ("turn", "10/10", "20/20"):
            for side in (1, -1):
                angle = {"turn": degrees, "10/10": 10.0, "20/20": 20.0}[kind] * side
                text = f"turn:{angle:.12g}/540" if kind == "turn" else f"zigzag:{angle:g}/{abs(angle):g}"
                sailed = plan(parse_manoeuvre(text), self._unit_time, 0.0, abs(rudder), 0)
                whole = join(model.name, model, SteeringMachine, sailed.helm)
                record = make_record(whole, _SHOWN, hold="zero")
                self._records[f"{kind} {side}"] = (whole, record, sailed.constants, sailed.constants["helm_start"])

    def __call__(self, values: Mapping[str, float], side: int) -> Numbers:
        """Sail all of them.

        Parameters
        ----------
        values : mapping of str to float
            Coefficients of the model, SI.
        side : {1, -1}
            Side of the first execute: 1 for starboard.
        """
        found: dict[str, float | None] = {}
        lost = []
        for kind in ("turn", "10/10", "20/20"):
            t, y, begin = self._sail(f"{kind} {side}", values)
            psi, north, east, order = y
            if not np.isfinite(y).all() or np.abs(np.diff(psi)).max() > _FASTEST * _STEP:
                lost.append(kind)
                psi = np.full_like(psi, np.nan)
            if kind == "turn":
                found |= _turn(t, side * psi, north, side * east, begin)
            else:
                found |= _zigzag(kind, t, side * psi, north, east, side * order, begin)
        return Numbers(found, tuple(lost))

    def _sail(self, key: str, values: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray, float]:
        model, record, constants, begin = self._records[key]
        t = np.arange(0.0, begin + _LENGTH * self._unit_time, _STEP * self._unit_time)
        system = record.system
        known = {"u": self._speed, "cruise": self._speed}
        start = np.array([known.get(n, model[n].number("start") or 0.0) for n in system.states])
        inputs = np.array([[known.get(n, model[n].number("default") or 0.0)] for n in system.inputs])
        p = system.vector(system.coefficients, {**values, **self._steering, **constants})
        y, _ = record(start, np.broadcast_to(inputs, (len(inputs), t.size)), np.diff(t, append=t[-1]), p)
        return t, y, begin


def _until(y: np.ndarray, level: float, first: int = 0) -> float | None:
    """Sample, with its fraction, at which a series first reaches a level; None where it never does, or is lost before."""
    reached = y[first:] >= level
    if not reached.any():
        return None
    k = first + int(np.argmax(reached))
    if not np.isfinite(y[: k + 1]).all():
        return None
    return float(k) if k == 0 or y[k] == y[k - 1] else k - 1 + (level - y[k - 1]) / (y[k] - y[k - 1])


def _at(y: np.ndarray, sample: float | None) -> float | None:
    return None if sample is None else float(np.interp(sample, np.arange(len(y)), y))


def _turn(
    t: np.ndarray, turned: np.ndarray, along: np.ndarray, across: np.ndarray, begin: float
) -> dict[str, float | None]:
    start = int(np.searchsorted(t, begin - 1e-6))
    quarter, half = _until(turned, np.pi / 2), _until(turned, np.pi)

    def travelled(y: np.ndarray, sample: float | None) -> float | None:
        reached = _at(y, sample)
        return None if reached is None else reached - float(y[start])

    return {
        "advance": travelled(along, quarter),
        "transfer": travelled(across, quarter),
        "tactical_diameter": travelled(across, half),
    }


def _zigzag(
    kind: str,
    t: np.ndarray,
    psi: np.ndarray,
    north: np.ndarray,
    east: np.ndarray,
    order: np.ndarray,
    begin: float,
) -> dict[str, float | None]:
    amplitude = kind.partition("/")[0]
    start = int(np.searchsorted(t, begin - 1e-6))
    switches = np.flatnonzero(np.diff(np.sign(order[start + 1 :]))) + start + 2
    overshoots: list[float | None] = []
    for number, sign in ((0, 1.0), (1, -1.0)):
        if switches.size <= number:
            overshoots.append(None)
            continue
        first = int(switches[number])
        last = int(switches[number + 1]) + 1 if switches.size > number + 1 else len(t)
        swing = sign * psi[first:last]
        top = int(np.argmax(swing)) if np.isfinite(swing).all() else len(swing) - 1
        overshoots.append(float(swing[top] - swing[0]) if top < len(swing) - 1 else None)
    found = {f"first_overshoot_{amplitude}": overshoots[0]}
    if amplitude == "10":
        reached = _until(psi, np.deg2rad(10.0))
        sailed = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(north), np.diff(east)))])
        end = _at(sailed, reached)
        found |= {
            "second_overshoot_10": overshoots[1],
            "initial_turning": None if end is None else end - float(sailed[start]),
        }
    return found
