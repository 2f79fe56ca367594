"""The weather of the judgement: one wind, one sea, one current, in proportion to the ship.

A ship of 100 m and longer has a fresh wind and a sea that yaws it; for a smaller one they are scaled by Froude's law, as for a ship
model. It is a standard for comparison and no forecast: it is the same for every autopilot.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from shipid.autopilot.design.autopilot import Autopilot
from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import to_display
from shipid.foundation.errors import UnitError, UsageError
from shipid.parts.waves import Waves
from shipid.parts.wind import Wind
from shipid.trials.manoeuvres.sea import DAMPING, FREQUENCY, froude_share, wave_noise

#: Inputs of wind, waves and current that a model may read, in calm.
CALM: Mapping[str, float] = MappingProxyType({
    "wind_speed": 0.0, "wind_direction": 0.0, "wave_direction": 0.0, "current_north": 0.0, "current_east": 0.0,
    "r_disturbance": 0.0, "u_disturbance": 0.0,
})  # fmt: skip


@dataclass(frozen=True)
class Weather:
    """Wind, waves and current.

    Attributes
    ----------
    wind : float
        True wind in m/s.
    wave_frequency : float
        Frequency of the waves in rad/s.
    wave_heading : float
        Root mean square of the heading by the waves, the ship at rest, in rad.
    current : float
        In m/s, to the side of the wind.
    damping : float
        Damping ratio of the filter that makes waves of white noise.
    """

    wind: float
    wave_frequency: float
    wave_heading: float
    current: float
    damping: float = DAMPING

    def components(self, model: Model) -> tuple[type[Component], ...]:
        """Return the components to join to the loop of a model: those of wind, waves and current that it reads.

        Parameters
        ----------
        model : Model
            The ship's own model.
        """
        wind = (Wind,) if self.wind and "r_disturbance" in model.inputs else ()
        return (*wind, *((Waves,) if self.wave_heading else ()))

    def inputs(self, direction: np.ndarray) -> dict[str, np.ndarray]:
        """Return the inputs of each run.

        Parameters
        ----------
        direction : ndarray, shape (runs,)
            Direction wind and waves go to, in rad.
        """
        across = direction + np.pi / 2
        return {
            "wind_speed": np.full(direction.shape, self.wind),
            "wind_direction": direction,
            "wave_direction": direction,
            "current_north": self.current * np.cos(across),
            "current_east": self.current * np.sin(across),
        }

    def values(self, pilot: Autopilot, model: Model, condition: int = 0) -> dict[str, float]:
        """Return the coefficients of wind and waves that the ship's set does not hold, SI.

        Parameters
        ----------
        pilot : Autopilot
            The design.
        model : Model
            Its closed loop with the weather.
        condition : int
            Which load condition.
        """
        found = {"wave_frequency": self.wave_frequency, "wave_damping": self.damping}
        ship, length = pilot.ships[condition], pilot.length
        if ship.particular("L", "m") is None:
            found["L"] = length
        for name in ("N_w", "F_w"):
            if name in model.parameters and ship.find(model, name) is None:
                found[name] = Scale(length, 1.0).start_of(model[name]) or 0.0
        return {n: v for n, v in found.items() if n in model}

    def noise(self, count: int, interval: np.ndarray, seed: int) -> np.ndarray:
        """Return the white noise that drives the waves, shape (count, runs), in rad/s^2.

        Parameters
        ----------
        count : int
            Steps.
        interval : ndarray, shape (runs,)
            Length of a step in s.
        seed : int
            Of the noise; every run has noise of its own.
        """
        return wave_noise(
            count, interval, seed, frequency=self.wave_frequency, heading=self.wave_heading, damping=self.damping
        )

    def encounter(self, speeds: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """Return the frequency at which ships meet the waves in rad/s: Passenier (1989), eq. (2.90).

        Parameters
        ----------
        speeds, directions : ndarray, shape (runs,)
            Of the ship in m/s, and where the waves go to from its heading, in rad.
        """
        return np.asarray(np.abs(self.wave_frequency - self.wave_frequency**2 * speeds * np.cos(directions) / 9.81))

    @property
    def wave_rate(self) -> float:
        """Root mean square of the rate of turn by the waves, the ship at rest, in rad/s."""
        return self.wave_frequency * self.wave_heading

    def to_dict(self) -> Mapping[str, float]:
        """Return plain values."""
        return {
            "wind_m_s": self.wind,
            "wave_frequency_rad_s": self.wave_frequency,
            "wave_heading_rms_deg": to_display(self.wave_heading, "psi"),
            "wave_turning_rms_deg_s": to_display(self.wave_rate, "psi"),
            "current_m_s": self.current,
        }


def standard_weather(length: float, speed: float) -> Weather:
    """Return the weather an autopilot is judged in: 12 m/s of wind, waves of 0.6 rad/s, 1 m/s of current, or less.

    Parameters
    ----------
    length : float
        In m.
    speed : float
        The ship's own, in m/s; the wind is at most 1.5 times that, since a slow ship cannot hold a course in a stronger one.
    """
    share = froude_share(length)
    return Weather(
        min(12.0 * share, 1.5 * speed), FREQUENCY / share, float(np.deg2rad(0.2)), min(1.0 * share, 0.2 * speed)
    )


def stated_weather(
    base: Weather, *, wind: str | None = None, sea: str | None = None, current: str | None = None
) -> Weather:
    """Return a weather with some of it stated.

    Parameters
    ----------
    base : Weather
        The rest of it.
    wind, current : str, optional
        True wind, and current across it: ``"15 m/s"``; zero for none.
    sea : str, optional
        Root mean square of the heading by waves, the ship at rest, and the frequency or the period of the waves:
        ``"0.3 deg"``, ``"0.3 deg at 0.5 rad/s"``, ``"0.3 deg at 9 s"``; zero for none.

    Raises
    ------
    UsageError
        If one is negative, or has another form.
    """
    found = base
    if wind is not None:
        found = replace(found, wind=_positive(wind, "m/s", "the wind"))
    if current is not None:
        found = replace(found, current=_positive(current, "m/s", "the current"))
    if sea is not None:
        size, mark, pace = (part.strip() for part in sea.partition(" at "))
        found = replace(found, wave_heading=_positive(size, "rad", "the heading by waves"))
        found = replace(found, wave_frequency=_frequency(pace)) if mark else found
    return found


def _frequency(text: str) -> float:
    """Of waves in rad/s, stated as it is or as a period."""
    try:
        found = 2 * np.pi / to_si(text, "s", "the period of the waves")
    except UnitError:
        found = to_si(text, "rad/s", "the frequency of the waves")
    except ZeroDivisionError:
        found = np.inf
    if not 0.05 <= found <= 20:
        raise UsageError(f"waves of {text} are none that yaw a ship: give a period from 0.4 to 120 s.")
    return float(found)


def _positive(text: str, unit: str, what: str) -> float:
    found = to_si(text, unit, what)
    if not 0 <= found < np.inf:
        raise UsageError(f"{what} is {text}: give its size, zero for none. Every direction is sailed.")
    return found
