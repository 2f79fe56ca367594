"""What waves leave unknown of a ship's state: the instruments show her heading and her rate of turn with the yaw by waves in them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np

from shipid.autopilot.course_changes.weather import standard_weather
from shipid.foundation.errors import UsageError
from shipid.prediction.situations.situation import Situation
from shipid.trials.manoeuvres.flows import Flow, flow_of

#: What the yaw by waves shows in.
_SHOWN = ("psi", "r")


def in_waves(values: Mapping[str, float], read: Collection[str], waves: Flow, length: float, speed: float) -> Situation:
    """Return a situation whose heading and rate of turn are read from instruments in waves.

    The waves move no track (`shipid.parts.waves.Waves`): they make the beginning uncertain. The standard deviations are those of the
    stationary motion of that component, which Passenier (1989), section 5.3, gives: of the heading that of the ship at rest, less
    where she meets the waves faster, with the power 3/2 of the frequency; of the rate of turn that times the frequency.

    Parameters
    ----------
    values : mapping of str to float
        What is known of the ship, SI; ``psi`` and ``u`` at least.
    read : collection of str
        Which of them are read from instruments; of these heading and rate of turn become uncertain.
    waves : str or tuple
        Root mean square of the heading by waves, the ship at rest, and the direction they run TO, with units or in SI.
    length, speed : float
        Of the ship, in m and her own speed in m/s: they say how long the waves are, as in `shipid.simulate`.

    Raises
    ------
    UsageError
        If the waves are negative, or neither heading nor rate of turn is read.
    """
    size, direction = flow_of(waves, "waves", "rad") or (0.0, 0.0)
    if not 0 <= size < np.inf:
        raise UsageError("the yaw by waves is a size: give zero or more, as in '0.5 deg from 300 deg'.")
    shown = tuple(n for n in _SHOWN if n in read)
    if not shown or "psi" not in values:
        raise UsageError(
            "waves make the heading uncertain that is read: give it in the state, as in --from 'psi=40 deg'."
        )
    sea = replace(standard_weather(length, speed), wave_heading=size)
    met = float(sea.encounter(np.array([values["u"]]), np.array([direction - values["psi"]]))[0])
    met = max(met, sea.damping * sea.wave_frequency)
    heading = size * min(1.0, (sea.wave_frequency / met) ** 1.5)
    variances = {"psi": heading**2, "r": (met * heading) ** 2}
    return Situation(dict(values), shown, np.diag([variances[n] for n in shown]))
