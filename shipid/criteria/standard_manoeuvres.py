"""The manoeuvres of the standard, simulated fast enough for a few dozen ships: turning circle, 10/10 and 20/20 zig-zag.

Measured as in IMO MSC.137(76) 4.2: distances from the order, overshoots from the heading at the second and third execute.
The simulation has no noise, so that the numbers are read off the samples and the line between them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.foundation.numbers import brief
from shipid.generation.simulator import Simulator, make_simulator
from shipid.parts.manoeuvring_range import manoeuvring_range
from shipid.parts.rudder_delay import gear_of
from shipid.trials.manoeuvres.manoeuvre import parse_manoeuvre, plan

#: Clock of the simulation in L/U.
_STEP = 0.01
#: Heading change in degrees after which the rudder of the turn goes amidships: never.
_ROUND = 10**6
_SHOWN = ("psi", "x", "y", "delta_order")
#: What a turn is held against, as far as the model has it.
_TURNED = ("r", "u", "v")
KINDS = ("turn", "10/10", "20/20")
#: Length of each manoeuvre in L/U, after an approach of one. The turn is held for a hundred ship lengths: an unstable one is
#: lost slowly, and its first half shows nothing of it.
LENGTHS = {"turn": 100.0, "10/10": 25.0, "20/20": 25.0}


@dataclass(frozen=True)
class ManoeuvreNumbers:
    """Numbers of the manoeuvres to one side; SI, None where one was not reached.

    Attributes
    ----------
    values : mapping of str to float or None
        By quantity: advance, transfer, tactical_diameter, initial_turning, first_overshoot_10, second_overshoot_10,
        first_overshoot_20.
    lost : mapping of str to str
        Manoeuvres that the model does not sail, and why; they have no numbers.
    turned : mapping of str to ndarray, shape (N,)
        Rate of turn and speeds in the turn, as far as the model has them; empty where it is not sailed.
    """

    values: Mapping[str, float | None]
    lost: Mapping[str, str] = field(default_factory=dict)
    turned: Mapping[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class _Steered:
    """A ship with its helmsman in one manoeuvre to one side."""

    simulator: Simulator
    constants: Mapping[str, float]


class StandardManoeuvres:
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
        self._steered: dict[tuple[str, int], _Steered] = {}
        for kind in KINDS:
            for side in (1, -1):
                angle = {"turn": degrees, "10/10": 10.0, "20/20": 20.0}[kind] * side
                text = f"turn:{angle:.12g}/{_ROUND}" if kind == "turn" else f"zigzag:{angle:g}/{abs(angle):g}"
                planned = plan(parse_manoeuvre(text), self._unit_time, 0.0, abs(rudder), 0)
                whole = join(model.name, model, *gear_of(model), planned.helm, *manoeuvring_range(model))
                turned = [n for n in _TURNED if n in whole] if kind == "turn" else []
                simulator = make_simulator(whole, (*_SHOWN, *turned), hold="zero")
                self._steered[kind, side] = _Steered(simulator, {"L": length, **steering, **planned.constants})

    def __call__(self, values: Mapping[str, float], side: int) -> ManoeuvreNumbers:
        """Simulate all of them.

        Parameters
        ----------
        values : mapping of str to float
            Coefficients of the model, SI.
        side : {1, -1}
            Side of the first execute: 1 for starboard.

        Returns
        -------
        ManoeuvreNumbers

        Raises
        ------
        UnstatedInputError
            If the model reads an input that nothing states.
        """
        found: dict[str, float | None] = {}
        lost: dict[str, str] = {}
        turned: dict[str, np.ndarray] = {}
        approach = {"u": self._speed, "cruise": self._speed}
        for kind in KINDS:
            steered = self._steered[kind, side]
            begin = steered.constants["helm_start"]
            span = LENGTHS[kind] * self._unit_time
            t = np.arange(0.0, begin + span, _STEP * self._unit_time)
            run = steered.simulator(t, {**values, **steered.constants}, approach, approach)
            psi = run["psi"]
            if run.departure is not None:
                after = (run.departure.time - begin) / self._unit_time
                lost[kind] = f"{run.departure.reason}, {brief(after)} L/V after the order"
                psi = np.full_like(psi, np.nan)
            if kind == "turn":
                turned = {} if kind in lost else {n: run[n] for n in _TURNED if n in run.columns}
                found |= _turn(t, side * psi, run["x"], side * run["y"], begin)
            else:
                found |= _zigzag(kind, t, side * psi, run["x"], run["y"], side * run["delta_order"], begin)
        return ManoeuvreNumbers(found, lost, turned)


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
        track = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(north), np.diff(east)))])
        end = _at(track, reached)
        found |= {
            "second_overshoot_10": overshoots[1],
            "initial_turning": None if end is None else end - float(track[start]),
        }
    return found
