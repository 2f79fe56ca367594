"""Whether the loop of ship and autopilot cycles at the rate limit of the rudder, asked of a course change in calm water."""

from __future__ import annotations

from collections.abc import Mapping

from shipid.autopilot.design.autopilot import Autopilot
from shipid.foundation.errors import ShipidError
from shipid.foundation.notices import Notice
from shipid.prediction.sailing.rudder_at_rate import CYCLES
from shipid.prediction.sailing.sail import sail
from shipid.trials.manoeuvres.flows import Flow

#: The course change in rad by which a loop that cycles shows it.
_ASKED = 0.2


def loop_cycles(
    pilot: Autopilot,
    speed: float | None = None,
    *,
    current: Flow | None = None,
    wind: Flow | None = None,
    inputs: Mapping[str, str | float] | None = None,
    values: Mapping[str, str | float] | None = None,
) -> list[Notice]:
    """Return what has to be said of an autopilot whose gains are too high for the steering gear of its ship.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot, with the ship.
    speed : float, optional
        In m/s; the ship's own by default.
    current, wind : str or tuple, optional
        Speed and direction it flows TO, with units or in SI.
    inputs, values : mapping of str to str or float, optional
        Constant inputs, and coefficients that replace those of the ship, with units or in SI.

    Returns
    -------
    list of Notice
        None or one, as of `shipid.prediction.sailing.rudder_at_rate`; none where the ship cannot be sailed so.
    """
    try:
        run = sail(pilot, _ASKED, speed=speed, current=current, wind=wind, inputs=inputs, values=values)
    except ShipidError:
        return []
    return [n for n in run.source.notes if isinstance(n, Notice) and n.kind == CYCLES]
