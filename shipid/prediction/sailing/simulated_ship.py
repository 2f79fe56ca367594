"""A ship under her autopilot that sails on step by step, her orders and surroundings changing in between."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal, TypeAlias

import casadi as ca
import numpy as np

from shipid.autopilot.course_changes.run_course_changes import PACE, stiffest
from shipid.autopilot.course_changes.turn_order import RADIUS, TurnOrder
from shipid.autopilot.course_changes.weather import CALM
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import closed_loop, coefficients_of, steered_ship
from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.foundation.aliases import CasadiFunction
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.numbers import brief
from shipid.generation.loop import Loop, make_loop
from shipid.generation.simulator import initial_state, input_rows
from shipid.generation.step import make_step
from shipid.generation.system import System, generate
from shipid.parameters.parameter_set import ParameterSet, missing_values
from shipid.parts.rudder_delay import at_rest
from shipid.prediction.sailing.sail import steering
from shipid.trials.manoeuvres.simulate import NotSailedError

#: What is told of the ship; the last two are heading and rate of turn as the autopilot sees them, with waves.
_SHOWN = ("x", "y", "psi", "r", "u", "v", "delta", "delta_order", "psi_seen", "r_seen")
#: How she is steered: to a heading, to a heading at a rate of turn, or by a rudder angle that is held.
SteeredBy: TypeAlias = Literal["heading", "rate", "rudder"]


def _steered(pilot: Autopilot, by: SteeredBy, parts: Sequence[type[Component]]) -> Model:
    if by == "rudder":
        whole = steered_ship(pilot)
        return join(whole.name, whole, *parts) if parts else whole
    if by == "rate":
        return closed_loop(replace(pilot, mode="rate"), TurnOrder, *parts)
    return closed_loop(pilot, *parts)


def _shown_by(system: System, shown: tuple[str, ...]) -> CasadiFunction:
    """What is shown as a function of states, inputs, coefficients and interval: the order of a turn depends on that."""
    return ca.Function("shown", [system.x, system.u, system.p, system.T], [system.expression(shown)])


@functools.lru_cache(maxsize=32)
def _loop(model: Model, shown: tuple[str, ...]) -> Loop:
    """The step in time, its inputs held; what is shown is that at its end."""
    system = generate(model)
    step = make_step(system, "rk4", "zero")
    out = _shown_by(system, shown)(step.x_next, system.u, system.p, system.T)
    control = ca.vertcat(system.u, system.T)
    return make_loop(ca.Function("ahead", [system.x, control, system.p], [ca.densify(step.x_next), ca.densify(out)]))


class SimulatedShip:
    """A simulated ship under her autopilot.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot.
    model : Model, component class or str, optional
        The ship that sails, where it is not the one the autopilot was designed on.
    ship : ParameterSet, str or Path, optional
        Its coefficients; the autopilot's own ship by default.
    speed : float, optional
        Speed before the first manoeuvre in m/s; by default the ship's own.
    start : mapping of str to float, optional
        States at the beginning, SI.
    values : mapping of str to float, optional
        Coefficients that replace those of the ship, SI.
    inputs : mapping of str to float, optional
        Inputs, SI: current, wind.
    parts : sequence of type[Component]
        Components joined to it: wind, waves.
    steered_by : {"heading", "rate", "rudder"}
        How she is steered. The order of a rudder is the input ``delta_order``; the rate of a turn is the coefficient ``turn_rate``.

    Attributes
    ----------
    t : float
        Time in s since the beginning.
    inputs : dict of str to float
        Inputs, SI; they may be changed between two steps.

    Raises
    ------
    UnknownNameError
        If a value is none of the model's coefficients.
    UnstatedInputError
        If the model reads an input that nothing states and that declares no default.
    """

    def __init__(
        self,
        pilot: Autopilot,
        *,
        model: Model | type[Component] | str | None = None,
        ship: ParameterSet | str | Path | None = None,
        speed: float | None = None,
        start: Mapping[str, float] | None = None,
        values: Mapping[str, float] | None = None,
        inputs: Mapping[str, float] | None = None,
        parts: Sequence[type[Component]] = (),
        steered_by: SteeredBy = "heading",
    ) -> None:
        self.pilot, truth = steering(pilot, model, ship, values)
        self.speed = self.pilot.own_speed if speed is None else speed
        self.model = _steered(self.pilot, steered_by, parts)
        self.t = 0.0
        known = coefficients_of(self.pilot, self.model, self.speed)
        if steered_by == "rate":
            known["turn_rate"] = self.speed / (RADIUS * self.pilot.length)
        self._system = generate(self.model)
        lost = [n for n in values or {} if n not in self._system.coefficients]
        if lost:
            raise UnknownNameError(f"coefficient of model {truth.name} called", lost[0], truth.parameters)
        if (
            lacking := missing_values(self.model, {**known, **(values or {})}, f"ship {self.pilot.ship.name}")
        ) is not None:
            raise lacking
        self._p = self._system.vector(self._system.coefficients, {**known, **(values or {})})
        begin = {"u": self.speed, **(start or {})}
        begin.setdefault("psi_ramp", begin.get("psi", 0.0))
        self._x = initial_state(self.model, at_rest(self.model, begin))
        self.inputs: dict[str, float] = {
            **CALM,
            "u": self.speed,
            "cruise": self.speed,
            "psi_order": begin.get("psi", 0.0),
            "delta_order": begin.get("delta", 0.0),
            **(inputs or {}),
        }
        self._longest = min(
            stiffest(self.pilot, self.model, np.array([self.speed])), PACE / self.pilot.pace(self.speed)
        )
        self._shown = tuple(n for n in _SHOWN if n in self.model)
        self._loop = _loop(self.model, self._shown)
        rows = input_rows(self.model, self.inputs, 1)[:, 0]
        first = _shown_by(self._system, self._shown)(self._x, rows, self._p, self._longest).full()[:, 0]
        self._now = dict(zip(self._shown, first.tolist()))

    @property
    def longest_step(self) -> float:
        """Longest step in s in which the ship is sailed on; a longer time is divided."""
        return self._longest

    @property
    def now(self) -> dict[str, float]:
        """What the ship does now: position, heading, speeds, rudder and its order, and what the autopilot sees of them, SI."""
        return dict(self._now)

    @property
    def states(self) -> dict[str, float]:
        """The states of the model, SI: where another ship of it may begin."""
        return dict(zip(self.model.states, self._x.tolist()))

    @property
    def coefficients(self) -> dict[str, float]:
        """The coefficients of the model as they are now, SI."""
        return dict(zip(self._system.coefficients, self._p.tolist()))

    def set(self, name: str, value: float) -> None:
        """Change a coefficient of the ship.

        Parameters
        ----------
        name : str
            A coefficient of the model.
        value : float
            SI.

        Raises
        ------
        UnknownNameError
            If the model has no such coefficient.
        """
        if name not in self._system.coefficients:
            raise UnknownNameError(f"coefficient of model {self.model.name} called", name, self._system.coefficients)
        self._p[self._system.coefficients.index(name)] = value

    def advance(
        self, seconds: float, heading: float | None = None, rudder_limit: float | None = None
    ) -> dict[str, float]:
        """Sail on under an order.

        Parameters
        ----------
        seconds : float
            How long.
        heading : float, optional
            Heading that is ordered from now on in rad, unwrapped as the ship's own.
        rudder_limit : float, optional
            Largest rudder angle from now on in rad.

        Returns
        -------
        dict of str to float
            As `now`, at the end.

        Raises
        ------
        NotSailedError
            If the model runs away.
        """
        if heading is not None:
            self.inputs["psi_order"] = heading
        if rudder_limit is not None:
            self.set("rudder_limit", rudder_limit)
        count = max(1, int(np.ceil(seconds / self._longest - 1e-9)))
        row = np.append(input_rows(self.model, self.inputs, 1)[:, 0], seconds / count)
        self._x, out = self._loop(self._x, np.repeat(row[None], count, axis=0), self._p)
        if not np.isfinite(self._x).all():
            raise NotSailedError(
                f"model {self.model.name} runs away {brief(self.t + seconds, 4)} s into the voyage. A smaller rudder limit keeps it within "
                "the range the model describes."
            )
        self.t += seconds
        self._now = dict(zip(self._shown, out[-1].tolist()))
        return self.now
