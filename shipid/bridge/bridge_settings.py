"""What a bridge is opened with."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

#: The ship of a bridge that is told none.
SHIP = "soesterberg"


@dataclass(frozen=True)
class BridgeSettings:
    """What a bridge is opened with; SI.

    Attributes
    ----------
    ship, model : str or None
        As on the command line; by default the container ship of the thesis, and a model that the ship knows.
    schedule : str or None
        The autopilot's file; one is designed by default.
    source : str
        Where the samples come from.
    format : str or None
        Trial format file of the source.
    route, chart : str or None
        Files of the planned route and of the chart.
    scenario, condition : str or None
        Track and condition of the tracking experiment.
    record : Path or None
        The trial file that the samples are added to.
    clock_factor : float
        Seconds of a simulation or a replay a second.
    filter_interval, prediction_interval : float
        In s.
    current, wind : tuple of float or None
        Of a simulation: speed and the direction it flows TO.
    waves : tuple of float or None
        Of a simulation: root mean square of the heading by waves, and the direction they run TO, in rad.
    seed : int
        Of the noise of a simulation.
    values, inputs : tuple of (str, str)
        Values of the ship that are replaced, and inputs of the model that are held, with their units.
    """

    ship: str | None = None
    model: str | None = None
    schedule: str | None = None
    source: str = "simulate"
    format: str | None = None
    route: str | None = None
    chart: str | None = None
    scenario: str | None = None
    condition: str | None = None
    record: Path | None = None
    clock_factor: float = 1.0
    filter_interval: float = 0.4
    prediction_interval: float = 2.0
    current: tuple[float, float] | None = None
    wind: tuple[float, float] | None = None
    waves: tuple[float, float] | None = None
    seed: int = 0
    values: tuple[tuple[str, str], ...] = ()
    inputs: tuple[tuple[str, str], ...] = ()
