"""The result of a design: gains against speed, the poles they give, and the request."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from shipid.autopilot.design.closed_loop import PARTS, Part, schedule_poles, to_control
from shipid.autopilot.design.placement import Gains
from shipid.autopilot.design.schedule import GAINS, Schedule
from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.notices import plain_notices
from shipid.foundation.numbers import brief, fixed, number, quantity
from shipid.foundation.result import DrawnResult
from shipid.parameters.parameter_set import ParameterSet

if TYPE_CHECKING:
    import control
    import pandas as pd

#: How the gains are found.
Design = Literal["pole", "lqr", "pid"]
#: What the autopilot holds: a course, or a rate of turn.
Mode = Literal["course", "rate"]
#: The quantities of a request, and the unit each is in.
REQUEST_UNITS = {"omega_n": "rad/s", "damping": "1", "integral": "1", "rudder_weight": "1"}


@dataclass(frozen=True, eq=False, repr=False)
class Autopilot(DrawnResult):
    """A gain-scheduled autopilot; made by `design_autopilot`, or read with `read_schedule`.

    It is data. Made from it are systems of python-control (`to_control`), its closed loop as a model
    (`shipid.autopilot.design.closed_loop`), its judgement (`shipid.judge`), its file (`shipid.write_schedule`).

    Attributes
    ----------
    model : Model
        The ship's model.
    ships : tuple of ParameterSet
        The ship, once for each load condition.
    actuator : type[Component]
        The steering machine between order and rudder.
    design : {"pole", "lqr", "pid"}
        How the gains were found.
    mode : {"course", "rate"}
        Whether it holds a course or a rate of turn.
    request : mapping of str to float
        The request, SI: ``omega_n`` [rad/s] at the service speed, ``damping``, ``integral``, ``rudder_weight``.
    service_speed : float
        In m/s.
    rudder_limit : float
        Largest rudder angle it orders, in rad.
    limits : mapping of str to float
        Constants of the steering machine, SI.
    schedule : Schedule
        Speeds and gains.
    poles : tuple of tuple of ndarray
        Poles of the loop in rad/s at each speed of the schedule, for each load condition; the steering machine left out.
    warnings : tuple of str
        Notes for its user.
    """

    model: Model
    ships: tuple[ParameterSet, ...]
    actuator: type[Component]
    design: Design
    mode: Mode
    request: Mapping[str, float]
    service_speed: float
    rudder_limit: float
    limits: Mapping[str, float]
    schedule: Schedule
    poles: tuple[tuple[np.ndarray, ...], ...]
    warnings: tuple[str, ...] = ()

    @property
    def ship(self) -> ParameterSet:
        """The ship in its first load condition."""
        return self.ships[0]

    @property
    def speeds(self) -> np.ndarray:
        """Speeds of the schedule in m/s."""
        return self.schedule.speeds

    @property
    def own_speed(self) -> float:
        """The service speed in m/s, or the end of the schedule that is nearest to it."""
        return float(np.clip(self.service_speed, self.speeds[0], self.speeds[-1]))

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of the load conditions."""
        return tuple(s.name for s in self.ships)

    @property
    def length(self) -> float:
        """Length of the ship in m; the distance it covers in a second at its service speed where the set has no length."""
        return self.ship.particular("L", "m") or self.service_speed

    def pace(self, speed: float) -> float:
        """Return u/L in 1/s at a speed.

        Parameters
        ----------
        speed : float
            In m/s.
        """
        return speed / self.length

    def gains(self, speed: float, condition: int = 0) -> Gains:
        """Return the gains at a speed.

        Parameters
        ----------
        speed : float
            In m/s; beyond the schedule the gains of its ends.
        condition : int
            Which load condition.
        """
        return self.schedule.gains_at(speed, condition)

    def with_schedule(self, schedule: Schedule) -> Autopilot:
        """Return the autopilot with other gains, its poles computed anew.

        Parameters
        ----------
        schedule : Schedule
            Speeds and gains, for the same load conditions.
        """
        return replace(self, schedule=schedule, poles=schedule_poles(self.model, self.ships, schedule))

    def to_control(
        self, speed: str | None = None, of: Part = "loop", condition: int = 0, nonlinear: bool = False
    ) -> control.StateSpace | control.NonlinearIOSystem:
        """Return the closed loop, the controller or the steered ship as a system of python-control, SI: s, rad.

        Parameters
        ----------
        speed : str, optional
            Forward speed with its unit, such as ``"9 kn"``; the service speed by default.
        of : {"loop", "controller", "ship"}
            The loop, from the order to ``psi``, ``r`` and ``delta``; the control law with its gains at this speed, from the order and
            what is measured to ``delta_order``; or the ship with her steering machine, from ``delta_order`` to ``psi``, ``r`` and
            ``delta``. The controller and the ship, connected by their names, are the loop.
        condition : int
            Which load condition.
        nonlinear : bool
            Whether it is the nonlinear system, with its limits and every input of the model.

        Returns
        -------
        control.StateSpace or control.NonlinearIOSystem

        Raises
        ------
        UnknownNameError
            If there is no such part.
        """
        if of not in PARTS:
            raise UnknownNameError("part of an autopilot called", of, PARTS)
        return to_control(self, None if speed is None else to_si(speed, "m/s", "the speed"), condition, nonlinear, of)

    def to_frame(self, condition: int = 0) -> pd.DataFrame:
        """Return the schedule as a pandas table: gains and poles against speed.

        Parameters
        ----------
        condition : int
            Which load condition.
        """
        frame = self.schedule.to_frame(condition)
        frame["poles [rad/s]"] = list(self.poles[condition])
        return frame

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON, SI, free of NaN; lists run along the speeds of the schedule."""
        found: dict[str, Plain] = {
            "model": self.model.name,
            "ship": self.ship.name,
            "design": self.design,
            "mode": self.mode,
            "request": {n: {"value": v, "unit": REQUEST_UNITS[n]} for n, v in self.request.items()},
            "service_speed": quantity(self.service_speed, "m/s"),
            "rudder_limit": quantity(to_display(self.rudder_limit, "delta"), "deg"),
            "actuator": self.actuator.__name__,
            "speeds": quantity(self.speeds.tolist(), "m/s"),
            "gains": self._gains(0),
            "poles": self._poles(0),
        }
        if len(self.ships) > 1:
            found["conditions"] = {
                name: {"gains": self._gains(j), "poles": self._poles(j)} for j, name in enumerate(self.conditions)
            }
        return found | {"warnings": plain_notices(self.warnings)}

    def _gains(self, condition: int) -> dict[str, Plain]:
        return {n: quantity(g[condition].tolist(), GAINS[n][0]) for n, g in self.schedule.gains.items()}

    def _poles(self, condition: int) -> dict[str, Plain]:
        """Real and imaginary part of each pole at each speed."""
        return quantity([[[p.real, p.imag] for p in poles.tolist()] for poles in self.poles[condition]], "rad/s")

    def text(self) -> str:
        """Return the result in lines of text."""
        asked = ", ".join(_with_unit(v, n) for n, v in self.request.items())
        holds = "" if self.mode == "course" else f", {self.mode}"
        lines = [f"autopilot of {self.ship.name} ({self.model.name}){holds}, {self.design}: {asked}"]
        for j, name in enumerate(self.conditions):
            if len(self.ships) > 1:
                lines.append(f"  {name}")
            lines.append("     u [m/s]  " + "".join(f"{n} [{GAINS[n][0]}]".rjust(15) for n in self.schedule.gains))
            for i, speed in enumerate(self.speeds):
                # As on the page: four digits of a gain, two decimals of a speed.
                row = "".join(number(g[j][i]).replace("−", "-").rjust(15) for g in self.schedule.gains.values())
                lines.append(f"  {fixed(speed, 2):>10s}  {row}")
        return "\n".join([*lines, *(f"  {w}" for w in self.warnings)])


def _with_unit(value: float, name: str) -> str:
    unit = "" if REQUEST_UNITS[name] == "1" else f" {REQUEST_UNITS[name]}"
    return f"{name} {brief(value, 4)}{unit}"
