"""A simulated ship as the source of samples: it obeys the console, and its surroundings and coefficients can be changed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from shipid.autopilot.course_changes.weather import Weather, standard_weather
from shipid.autopilot.design.autopilot import Autopilot
from shipid.bridge.core.console import SteeringOrder
from shipid.bridge.core.source import SourceKind, SourceReading, SourceState
from shipid.bridge.own_ship.own_ship import label_of
from shipid.bridge.shown.plain_values import number, number_given
from shipid.declaration.component import Component
from shipid.declaration.units import to_si
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError
from shipid.parts.waves import Waves
from shipid.parts.wind import Wind
from shipid.prediction.sailing.simulated_ship import SimulatedShip, SteeredBy
from shipid.prediction.situations.own_ship_filter import BRIDGE
from shipid.prediction.tracks.order import unwrapped
from shipid.trials.manoeuvres.sea import wave_intensity
from shipid.trials.manoeuvres.simulate import NotSailedError

#: Units of what the sensors of a bridge show, and the speeds a disturbance may have at most, in m/s.
_UNITS: Mapping[str, str] = {"psi": "rad", "r": "rad/s", "u": "m/s", "x": "m", "y": "m"}
_FASTEST: Mapping[str, float] = {"current_speed": 5.0, "wind_speed": 40.0}
#: The steering of the simulated ship by the mode of the console.
_BY: Mapping[str, SteeredBy] = {"heading": "heading", "rate": "rate", "rudder": "rudder"}


class SimulatedSource:
    """A ship under her autopilot, with the noise of her sensors.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot, with the model and the ship.
    seed : int
        Of the noise.
    heading : float
        At the beginning, in rad.
    place : tuple of float
        At the beginning, to the north and to the east in m.
    current, wind : tuple of float
        Speed in m/s and the direction it flows TO in rad.
    waves : tuple of float, optional
        Root mean square of the heading by waves, the ship at rest, and the direction they run TO, in rad. Sensors and autopilot
        see them.
    noise : bool
        Whether the sensors have noise.

    Attributes
    ----------
    ship : SimulatedShip
        The ship.
    """

    kind: SourceKind = "simulate"
    timed = True

    def __init__(
        self,
        pilot: Autopilot,
        *,
        seed: int = 0,
        heading: float = 0.0,
        place: tuple[float, float] = (0.0, 0.0),
        current: tuple[float, float] = (0.0, 0.0),
        wind: tuple[float, float] = (0.0, 0.0),
        waves: tuple[float, float] | None = None,
        noise: bool = True,
    ) -> None:
        self._windy = has_wind(pilot)
        self._parts: tuple[type[Component], ...] = (*((Wind,) if self._windy else ()), *((Waves,) if waves else ()))
        self._pilot, self._flows = pilot, {"current": current, "wind": wind}
        self._random = np.random.default_rng(seed)
        self._levels = {n: to_si(level, _UNITS[n]) for n, level in BRIDGE.items()} if noise else {}
        self._changed: dict[str, float] = {}
        self._sea: Weather | None = None
        self._waves_to = 0.0
        if waves is not None:
            self._sea = replace(standard_weather(pilot.length, pilot.own_speed), wave_heading=waves[0])
            self._waves_to = waves[1]
            self._changed = {"wave_frequency": self._sea.wave_frequency, "wave_damping": self._sea.damping}
        self._by: SteeredBy = "heading"
        self._ended = ""
        self.ship = SimulatedShip(
            pilot,
            start={"psi": heading, "x": place[0], "y": place[1]},
            parts=self._parts,
            inputs=self._acting(),
            values=self._changed,
        )
        names = (*pilot.model.parameters, *(("N_w", "F_w") if self._windy else ()))
        self._coefficients = {n: self.ship.coefficients[n] for n in names if n in self.ship.coefficients}
        self._limit = pilot.rudder_limit

    def _acting(self) -> dict[str, float]:
        (set_, towards), (wind, blows) = self._flows["current"], self._flows["wind"]
        return {
            "current_north": set_ * math.cos(towards), "current_east": set_ * math.sin(towards),
            "wind_speed": wind, "wind_direction": blows, **({"wave_direction": self._waves_to} if self._sea else {}),
        }  # fmt: skip

    @property
    def state(self) -> SourceState:
        """Running, until the model leaves the range it describes."""
        return "ended" if self._ended else "running"

    @property
    def now(self) -> dict[str, float]:
        """What the ship does, without the noise of the sensors; SI."""
        return self.ship.now

    async def start(self) -> None:
        """Nothing has to be opened."""

    async def stop(self) -> None:
        """Nothing has to be closed."""

    def steer(self, steering: SteeringOrder) -> None:
        """Take an order.

        Parameters
        ----------
        steering : SteeringOrder
            What is ordered; along a route the track pilot orders headings.
        """
        by = _BY.get(steering.mode, "heading")
        if by != self._by:
            self._by = by
            states = self.ship.states
            states["psi_ramp"] = states["psi"]
            t = self.ship.t
            self.ship = SimulatedShip(
                self._pilot, start=states, parts=self._parts, inputs=self._acting(), values=self._changed, steered_by=by,
                speed=self.ship.speed,
            )  # fmt: skip
            self.ship.t = t
        if by == "rudder":
            self.ship.inputs["delta_order"] = steering.rudder
            return
        if by == "rate":
            self.ship.set("turn_rate", steering.rate)
        self.ship.inputs["psi_order"] = unwrapped(steering.heading, self.ship.now["psi"])
        self.ship.set("rudder_limit", steering.rudder_limit)

    def take(self, t: float) -> SourceReading:
        """Return what the sensors show at a time, the ship having sailed on to it.

        Parameters
        ----------
        t : float
            In s on the bridge's clock.
        """
        if self._ended:
            return SourceReading()
        try:
            now = self._sailed(t - self.ship.t) if t > self.ship.t else self.ship.now
        except NotSailedError as error:
            self._ended = str(error)
            return SourceReading(told=(self._ended,))
        if self._sea is not None:
            moved = self.ship.states
            now = {**now, "psi": now["psi"] + moved["psi_wave"], "r": now["r"] + moved["r_wave"]}
        values = {n: v + self._levels.get(n, 0.0) * self._random.standard_normal() for n, v in now.items() if n != "v"}
        wind, blows = self._flows["wind"]
        return SourceReading(values | ({"wind_speed": wind, "wind_direction": blows} if self._windy else {}))

    def _sailed(self, seconds: float) -> dict[str, float]:
        """Sail on, the waves driven by noise that is held for a step of the ship."""
        if self._sea is None:
            return self.ship.advance(seconds)
        count = max(1, math.ceil(seconds / self.ship.longest_step - 1e-9))
        sea = self._sea
        size = math.sqrt(wave_intensity(sea.wave_frequency, sea.wave_heading, sea.damping) * count / seconds)
        now = self.ship.now
        for push in self._random.standard_normal(count):
            self.ship.inputs["wave_noise"] = size * float(push)
            now = self.ship.advance(seconds / count)
        return now

    def warm(self) -> None:
        """Build the ship once under every kind of order: what is compiled then is kept."""
        for by in _BY.values():
            SimulatedShip(self._pilot, parts=self._parts, steered_by=by)

    def change(self, wanted: Mapping[str, Plain]) -> None:
        """Change current, wind, or a coefficient of the ship.

        Parameters
        ----------
        wanted : mapping
            ``current_speed``, ``current_direction_to``, ``wind_speed``, ``wind_direction_from``, or ``coefficient`` with ``value``; SI.

        Raises
        ------
        UsageError
            If a name or a number is none; nothing is changed then.
        """
        flows = {n: list(v) for n, v in self._flows.items()}
        known = ("current_speed", "current_direction_to", "wind_speed", "wind_direction_from", "coefficient", "value")
        for name, value in wanted.items():
            if name not in known:
                raise UsageError(f"the simulation has no '{str(name)[:40]}'; it has {', '.join(known)}.")
            if name == "coefficient":
                continue
            given = number_given(value, name)
            if name == "value":
                continue
            what, _, part = name.partition("_")
            if part == "speed":
                flows[what][0] = min(max(given, 0.0), _FASTEST[name])
            else:
                flows[what][1] = (given + (math.pi if part.endswith("from") else 0.0)) % (2 * math.pi)
        if "coefficient" in wanted or "value" in wanted:
            self._set(wanted.get("coefficient"), wanted.get("value"))
        self._flows = {n: (v[0], v[1]) for n, v in flows.items()}
        self.ship.inputs |= {n: v for n, v in self._acting().items() if n in self.ship.model.inputs}

    def _set(self, name: Plain, value: Plain) -> None:
        if not isinstance(name, str) or name not in self._coefficients or value is None:
            raise UsageError(f"a coefficient is one of {', '.join(self._coefficients)}, with its value.")
        low, high = self._range(name)
        self._changed[name] = min(max(number_given(value, "value"), low), high)
        self.ship.set(name, self._changed[name])

    def _range(self, name: str) -> tuple[float, float]:
        """Half to double of the ship's own value; where that is zero, from zero to one."""
        own = self._coefficients[name]
        return (0.0, 1.0) if own == 0 else (min(0.5 * own, 2 * own), max(0.5 * own, 2 * own))

    def to_dict(self) -> dict[str, Plain]:
        """Return what can be changed, SI."""
        (set_, towards), (wind, blows) = self._flows["current"], self._flows["wind"]
        now = self.ship.coefficients
        listed = []
        for name in self._coefficients:
            low, high = self._range(name)
            unit = self.ship.model[name].unit
            listed.append({
                "name": name, "label": label_of(name, unit), "value": number(now[name], 6), "unit": unit,
                "low": number(low, 4), "high": number(high, 4),
            })  # fmt: skip
        return {
            "current_speed": number(set_, 5), "current_direction_to": number(towards % (2 * math.pi), 5),
            "wind_speed": number(wind, 5), "wind_direction_from": number((blows + math.pi) % (2 * math.pi), 5),
            "coefficients": listed,
        }  # fmt: skip


def has_wind(pilot: Autopilot) -> bool:
    """Return whether the ship's set states what the wind does to her.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot, with the ship.
    """
    return "r_disturbance" in pilot.model.inputs and any("N_w" in s for s in pilot.ship.sections.values())
