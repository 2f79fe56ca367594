"""The tracking experiment on the bridge: the simulated ship at the beginning of a track, in the experiment's current and wind."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from shipid.autopilot.design.autopilot import Autopilot
from shipid.bridge.core.route_watch import BridgeRoute
from shipid.bridge.experiment.tracks import track_experiment
from shipid.bridge.experiment.voyage_score import CONDITIONS, Condition, VoyageScore
from shipid.bridge.sources.simulated import SimulatedSource
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UnknownNameError
from shipid.prediction.following.wheel_over import heading_on
from shipid.prediction.sailing.simulated_ship import SimulatedShip


@dataclass(frozen=True)
class OpenedExperiment:
    """What the bridge sails the experiment with.

    Attributes
    ----------
    source : SimulatedSource
        The ship.
    route : BridgeRoute
        The track.
    score : VoyageScore
        Judges the voyage.
    predicts : bool
        Whether the navigator sees predicted tracks.
    rudder_limit : float
        In rad.
    """

    source: SimulatedSource
    route: BridgeRoute
    score: VoyageScore
    predicts: bool
    rudder_limit: float


def open_experiment(
    pilot: Autopilot,
    scenario: str,
    condition: str,
    *,
    current: tuple[float, float] | None = None,
    wind: tuple[float, float] | None = None,
    seed: int = 0,
    ended: Callable[[VoyageScore], None] | None = None,
) -> OpenedExperiment:
    """Return what the bridge sails the experiment with.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot, with the ship.
    scenario : str
        ``T1`` to ``T6``.
    condition : str
        ``A`` to ``D``.
    current, wind : tuple of float, optional
        Instead of the experiment's: speed and direction it flows TO, SI.
    seed : int
        Of the noise of the sensors.
    ended : callable, optional
        Called with the score at the end of the track.

    Raises
    ------
    UnknownNameError
        If there is no such track or condition.
    """
    known: dict[str, Condition] = {c: c for c in CONDITIONS}
    if condition not in known:
        raise UnknownNameError("condition", condition, CONDITIONS)
    experiment = track_experiment()
    plan = experiment.reference(scenario, lambda: SimulatedShip(pilot))
    current, wind = current or experiment.current, wind or experiment.wind
    drift = current[0] * math.cos(current[1]), current[0] * math.sin(current[1])
    # Without a vector and without a predictor the navigator has no drift angle to begin with.
    heading = 0.0 if condition == "A" else heading_on(plan.legs[0], drift, pilot.own_speed)
    source = SimulatedSource(pilot, seed=seed, heading=heading, current=current, wind=wind)
    points = [(leg.x, leg.y) for leg in plan.legs] + [tuple(plan.line[-1])]
    nothing: dict[str, Plain] = {"radius": None, "xtd_port": None, "xtd_starboard": None}
    shown = tuple({"name": str(k), "x": float(x), "y": float(y), **nothing} for k, (x, y) in enumerate(points))
    return OpenedExperiment(
        source,
        BridgeRoute(scenario, plan, shown),
        VoyageScore(experiment, scenario, known[condition], plan, ended),
        condition in ("C", "D"),
        experiment.rudder_limit,
    )
