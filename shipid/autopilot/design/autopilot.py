"""The result of a design: gains against speed, and the closed loop as a model like any other."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from shipid.autopilot.design.control_law import CourseController, IntegralCourseController, Measured
from shipid.autopilot.design.placement import Gains
from shipid.autopilot.design.plant import Plant, coefficients_at, linear_plant
from shipid.autopilot.design.schedule import GAINS, Schedule
from shipid.declaration.component import Component
from shipid.declaration.join import join
from shipid.declaration.model import Model
from shipid.generation.linearisation import linearise
from shipid.generation.system import generate
from shipid.parameters.parameter_set import ParameterSet

if TYPE_CHECKING:
    from shipid.autopilot.judgement.judgement import Judgement


@dataclass(frozen=True, eq=False)
class Autopilot:
    """A gain-scheduled autopilot; made by `design_autopilot`, or read with `read_schedule`.

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
    request : mapping of str to float
        What was asked for, SI: ``omega_n`` [rad/s] at the service speed, ``damping``, ``integral``, ``rudder_weight``.
    service_speed : float
        In m/s.
    rudder_limit : float
        Largest rudder angle it orders, in rad.
    limits : mapping of str to float
        Constants of the steering machine, SI.
    schedule : Schedule
        Speeds and gains.
    warnings : tuple of str
        What its user has to know.
    """

    model: Model
    ships: tuple[ParameterSet, ...]
    actuator: type[Component]
    design: str
    request: Mapping[str, float]
    service_speed: float
    rudder_limit: float
    limits: Mapping[str, float]
    schedule: Schedule
    warnings: tuple[str, ...] = ()

    def __getstate__(self) -> dict[str, Any]:
        # What is worked out when asked for holds components made on the fly, which another process makes anew.
        return {f.name: getattr(self, f.name) for f in fields(self)}

    @property
    def ship(self) -> ParameterSet:
        """The ship in its first load condition."""
        return self.ships[0]

    @property
    def speeds(self) -> np.ndarray:
        """Speeds of the schedule in m/s."""
        return self.schedule.speeds

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of the load conditions."""
        return tuple(s.name for s in self.ships)

    @property
    def length(self) -> float:
        """Length of the ship in m; what it sails in a second at its own speed where the set does not say."""
        return self.ship.particular("L", "m") or self.service_speed

    def pace(self, speed: float) -> float:
        """Return u/L in 1/s at a speed in m/s."""
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
        return Gains(**{n: float(v) for n, v in self.schedule.at(speed, condition).items()})

    @functools.cached_property
    def closed_loop(self) -> Model:
        """Ship, steering machine, measurement and law as one declared model; its input is ``psi_order``."""
        return self.loop()

    @property
    def law(self) -> type[Component]:
        """The control law."""
        return IntegralCourseController if "Ki" in self.schedule.gains else CourseController

    def loop(self, *parts: type[Component], measured: type[Component] | None = Measured) -> Model:
        """Return the closed loop with more in it: wind, waves, a meter; or with a filter in the place of the measurement.

        Parameters
        ----------
        *parts : type[Component]
            Components to join.
        measured : type[Component] or None
            What states ``psi_seen``, ``r_seen`` and ``speed_seen``; None where one of the parts does.
        """
        seen = () if measured is None else (measured,)
        name = f"{self.model.name}-autopilot"
        return join(name, self.model, self.actuator, *seen, self.law, self.schedule.component, *parts)

    @functools.cached_property
    def steered_ship(self) -> Model:
        """The ship with its steering machine; its input is ``delta_order``."""
        return join(f"{self.model.name}-steered", self.model, self.actuator)

    def values(self, model: Model, speed: float, condition: int = 0) -> dict[str, float]:
        """Return the coefficients of a model that holds this ship at a speed, SI.

        Parameters
        ----------
        model : Model
            The ship's own model, `closed_loop`, or another one it was joined into.
        speed : float
            In m/s.
        condition : int
            Which load condition.
        """
        ship, own = self.ships[condition], coefficients_at(self.model, self.ships[condition], speed).values
        known: dict[str, float] = {}
        for name in model.parameters + model.constants:
            found, default = ship.find(model, name), model[name].number("default")
            if name in own:
                known[name] = own[name]
            elif name in self.limits:
                known[name] = self.limits[name]
            elif found is not None and not found.speed:
                known[name] = found.at(None, model[name].unit, f"ship {ship.name}")
            elif default is not None:
                known[name] = default
        return known | ({"rudder_limit": self.rudder_limit} if "rudder_limit" in model else {})

    def plants(self, speeds: np.ndarray, condition: int = 0, steered: bool = False) -> Plant:
        """Return the linear ship at several speeds, with or without its steering machine.

        Parameters
        ----------
        speeds : ndarray, shape (n,)
            In m/s.
        condition : int
            Which load condition.
        steered : bool
            Whether the input is the rudder order, through the steering machine.
        """
        model = self.steered_ship if steered else self.model
        system = generate(model)
        p = [system.vector(system.coefficients, self.values(model, float(v), condition)) for v in np.atleast_1d(speeds)]
        by = "delta_order" if steered else "delta"
        return linear_plant(model, np.atleast_1d(speeds), np.stack(p, axis=1), by)

    def poles(self, speed: float, condition: int = 0) -> np.ndarray:
        """Return the poles of the loop in rad/s at a speed, the steering machine inside its limits left out.

        Parameters
        ----------
        speed : float
            In m/s.
        condition : int
            Which load condition.
        """
        from shipid.autopilot.design.placement import closed_poles

        return closed_poles(self.plants(np.array([speed]), condition).at(0), self.gains(speed, condition))

    def natural_frequency(self, speed: float) -> float:
        """Return the natural frequency of the heading in rad/s: the one asked for, or that of the two slowest poles.

        Parameters
        ----------
        speed : float
            In m/s.
        """
        if "omega_n" in self.request:
            return self.request["omega_n"] * speed / self.service_speed
        return float(np.sqrt(np.prod(np.sort(np.abs(self.poles(speed)))[:2])))

    def to_control(self, speed: float | None = None, condition: int = 0, nonlinear: bool = False) -> Any:
        """Return the closed loop for python-control, from ``psi_order`` to ``psi``, ``r`` and ``delta``.

        Parameters
        ----------
        speed : float, optional
            In m/s; the service speed by default.
        condition : int
            Which load condition.
        nonlinear : bool
            Whether it is the whole nonlinear loop as an `nlsys` with every input of the model, or a `StateSpace`.
        """
        speed = self.service_speed if speed is None else speed
        model = self.closed_loop
        known = self.values(model, speed, condition)
        known |= {"u": speed, "cruise": speed, "loading": float(condition)}
        outputs = ["psi", "r", "delta"]
        if not nonlinear:
            plant = linear_plant(model, np.array([speed]), _column(generate(model), known), "psi_order")
            return linearise(model, known, plant.states, ["psi_order"], outputs).to_state_space()
        return _nonlinear(model, known, outputs)

    @functools.cached_property
    def judgement(self) -> Judgement:
        """Margins, robustness and course changes, worked out when they are asked for."""
        return self.judge()

    def judge(self, samples: int = 200, seed: int = 0, progress: Any = None) -> Judgement:
        """Judge the design at and between its speeds, over the uncertainty of the ship, and in course changes.

        Parameters
        ----------
        samples : int
            Draws of the ship's coefficients.
        seed : int
            Of the draws and of the waves.
        progress : callable, optional
            Called with a line of text before each part.
        """
        from shipid.autopilot.judgement.judge import judge

        return judge(self, samples, seed, progress)

    def write(self, path: str | Path) -> None:
        """Write the schedule as TOML, with the ship it was designed for; `read_schedule` reads it.

        Parameters
        ----------
        path : str or Path
            The file; it is replaced in one step.
        """
        from shipid.autopilot.design.read_schedule import write_schedule

        write_schedule(self, path)

    def to_frame(self, condition: int = 0) -> Any:
        """Return the schedule as a pandas table: gains and poles against speed.

        Parameters
        ----------
        condition : int
            Which load condition.
        """
        import pandas as pd

        table = {f"{n} [{GAINS[n][0]}]": g[condition] for n, g in self.schedule.gains.items()}
        frame = pd.DataFrame(table, index=pd.Index(self.speeds, name="u [m/s]"))
        frame["poles [rad/s]"] = [self.poles(float(v), condition) for v in self.speeds]
        return frame

    def to_dict(self) -> dict[str, Any]:
        """Return plain values for JSON, SI, free of NaN; lists run along the speeds of the schedule."""
        found: dict[str, Any] = {
            "model": self.model.name,
            "ship": self.ship.name,
            "design": self.design,
            "request": dict(self.request),
            "service_speed": self.service_speed,
            "rudder_limit_deg": float(np.rad2deg(self.rudder_limit)),
            "actuator": self.actuator.__name__,
            "speeds": self.speeds.tolist(),
            "gains": self._gains(0),
            "poles": self._poles(0),
        }
        if len(self.ships) > 1:
            found["conditions"] = {
                name: {"gains": self._gains(j), "poles": self._poles(j)} for j, name in enumerate(self.conditions)
            }
        return found | {"warnings": list(self.warnings)}

    def _gains(self, condition: int) -> dict[str, list[float]]:
        return {n: g[condition].tolist() for n, g in self.schedule.gains.items()}

    def _poles(self, condition: int) -> list[list[list[float]]]:
        return [[[p.real, p.imag] for p in self.poles(float(v), condition)] for v in self.speeds]

    def __repr__(self) -> str:
        asked = ", ".join(f"{n} {v:.4g}" for n, v in self.request.items())
        lines = [f"autopilot of {self.ship.name} ({self.model.name}), {self.design}: {asked}"]
        for j, name in enumerate(self.conditions):
            if len(self.ships) > 1:
                lines.append(f"  {name}")
            lines.append("     u [m/s]  " + "".join(f"{n} [{GAINS[n][0]}]".rjust(12) for n in self.schedule.gains))
            for i, speed in enumerate(self.speeds):
                row = "".join(f"{g[j][i]:12.4g}" for g in self.schedule.gains.values())
                lines.append(f"  {speed:10.3f}  {row}")
        return "\n".join([*lines, *(f"  {w}" for w in self.warnings)])


def _column(system: Any, known: Mapping[str, float]) -> np.ndarray:
    return np.asarray(system.vector(system.coefficients, known))[:, None]


def _nonlinear(model: Model, known: Mapping[str, float], outputs: list[str]) -> Any:
    import control

    system = generate(model)
    rates, shown = system.right_hand_side, system.function(outputs)
    p = system.vector(system.coefficients, known)

    def update(_t: float, x: np.ndarray, u: np.ndarray, _params: Any) -> np.ndarray:
        return np.asarray(rates(x, u, p)).ravel()

    def output(_t: float, x: np.ndarray, u: np.ndarray, _params: Any) -> np.ndarray:
        return np.asarray(shown(x, u, p)).ravel()

    return control.nlsys(
        update, output, inputs=list(system.inputs), outputs=outputs, states=list(system.states), name=model.name
    )
