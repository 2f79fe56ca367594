"""How sure the coefficients of a ship are, as a part of the situation a prediction begins from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipid.autopilot.course_changes.run_course_changes import scaled_draws
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import coefficients_of
from shipid.identification.problem.prior import INDEPENDENT, STRUCTURE_ANGLE
from shipid.parameters.draws import draw_coefficients
from shipid.prediction.situations.situation import Situation

#: Draws whose covariance is taken; it is known to 3 % by them.
_DRAWS = 2000


def with_coefficients(situation: Situation, pilot: Autopilot, condition: int = 0) -> Situation:
    """Return a situation with the coefficients of the ship and their covariance, as her set states it.

    Where the set states how sure they are, they were identified, and a model of low order is not the ship: its rate of turn is off
    by `STRUCTURE_ANGLE` in L/U, as its fit takes it to be, and this lasts for 1.5 L/U. On the heading that acts as noise.

    Parameters
    ----------
    situation : Situation
        What is known of the ship; coefficients it holds already stay as they are.
    pilot : Autopilot
        The autopilot, with the ship.
    condition : int
        Which load condition.
    """
    model, ship = pilot.model, pilot.ships[condition]
    drawn = draw_coefficients(model, ship, _DRAWS)
    speed = situation.values.get("cruise", situation.values["u"])
    known = coefficients_of(pilot, model, speed, condition)
    places = [i for i, n in enumerate(drawn.names) if n not in situation.values]
    if not places:
        return situation
    names = tuple(drawn.names[i] for i in places)
    values = scaled_draws(drawn, {n: np.full(1, known[n]) for n in drawn.names})
    covariance = np.atleast_2d(np.cov(np.stack([values[n] for n in names])))
    before = len(situation.uncertain)
    whole = np.zeros((before + len(names),) * 2)
    whole[:before, :before] = situation.covariance
    whole[before:, before:] = covariance
    noise = dict(situation.noise)
    # Noise of the rate with variance s^2 that lasts for tau moves the heading as white noise of density s sqrt(2 tau) does.
    structure = STRUCTURE_ANGLE * np.sqrt(2 * INDEPENDENT * pilot.pace(situation.values["u"]))
    noise["psi"] = float(np.hypot(noise.get("psi", 0.0), structure))
    return replace(
        situation,
        noise=noise,
        values={**situation.values, **{n: known[n] for n in names}},
        uncertain=(*situation.uncertain, *names),
        covariance=whole,
    )
