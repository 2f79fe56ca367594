"""How sure the coefficients of a ship are, as a part of the situation a prediction begins from."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np

from shipid.autopilot.course_changes.run_course_changes import scaled_draws
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import coefficients_of
from shipid.identification.problem.prior import INDEPENDENT, STRUCTURE_ANGLE, STRUCTURE_SPEED
from shipid.parameters.draws import Drawn, draw_coefficients
from shipid.prediction.situations.situation import Situation

#: Draws whose covariance is taken; it is known to 3 % by them.
_DRAWS = 2000


def with_coefficients(situation: Situation, pilot: Autopilot, condition: int = 0) -> Situation:
    """Return a situation with the coefficients of the ship and their covariance, as her set states it.

    Where the set states how sure they are, they were identified, and a model of low order is not the ship: its rate of turn is off
    by `STRUCTURE_ANGLE` in L/U, its drift angle by `STRUCTURE_ANGLE` and its speed by `STRUCTURE_SPEED`, as its fit takes them to
    be, and this lasts for 1.5 L/U. On the heading, the position and the time that acts as noise.

    Parameters
    ----------
    situation : Situation
        What is known of the ship; coefficients it holds already stay as they are.
    pilot : Autopilot
        The autopilot, with the ship.
    condition : int
        Which load condition.
    """
    drawn = _drawn(pilot, condition)
    if not drawn.names:
        return situation
    speed = situation.values.get("cruise", situation.values["u"])
    known = coefficients_of(pilot, pilot.model, speed, condition)
    places = [i for i, n in enumerate(drawn.names) if n not in situation.values]
    names = tuple(drawn.names[i] for i in places)
    values = scaled_draws(drawn, {n: np.full(1, known[n]) for n in drawn.names})
    covariance = np.cov(np.stack([values[n] for n in names])) if names else np.zeros((0, 0))
    before = len(situation.uncertain)
    whole = np.zeros((before + len(names),) * 2)
    whole[:before, :before] = situation.covariance
    whole[before:, before:] = covariance
    noise = dict(situation.noise)
    structural = structural_noise(situation.values["u"], pilot.length)
    for name, density in structural.items():
        noise[name] = float(np.hypot(noise.get(name, 0.0), density))
    return replace(
        situation,
        noise=noise,
        structural=structural,
        values={**situation.values, **{n: known[n] for n in names}},
        uncertain=(*situation.uncertain, *names),
        covariance=whole,
    )


@functools.lru_cache(maxsize=16)
def _drawn(pilot: Autopilot, condition: int) -> Drawn:
    return draw_coefficients(pilot.model, pilot.ships[condition], _DRAWS)


def structural_noise(speed: float, length: float) -> dict[str, float]:
    """Return the noise that acts on a track as the error of a model of low order does, per root second, SI.

    Parameters
    ----------
    speed : float
        Of the ship in m/s.
    length : float
        Of the ship in m.

    Returns
    -------
    dict of str to float
        Of the heading, by the error of the rate of turn; of the position, by that of the drift angle; and of the time at which a
        distance is sailed, by that of the speed.
    """
    # An error with variance s^2 that lasts for tau moves its integral as white noise of density s sqrt(2 tau) does.
    lasts = np.sqrt(2 * INDEPENDENT * length / speed)
    densities = {
        "psi": STRUCTURE_ANGLE * speed / length,
        "x": STRUCTURE_ANGLE * speed,
        "y": STRUCTURE_ANGLE * speed,
        "track_t": STRUCTURE_SPEED,
    }
    return {name: float(s * lasts) for name, s in densities.items()}
