"""What a file says of its plots, SI, before they are put into one frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from shipid.encounter.plots.plots import Sensor


@dataclass(frozen=True, eq=False)
class RawPlots:
    """Plots as a file holds them.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Seconds of 1970, of the day, or of a beginning of the log's own.
    columns : dict of str to ndarray, shape (N,)
        ``range`` and ``bearing`` [m, rad], ``x`` and ``y`` [m], or ``lat`` and ``lon`` [rad]; ``own_x`` and ``own_y``, or
        ``own_lat`` and ``own_lon``, where own ship is known.
    sensor : ndarray of int, shape (N,)
        Which sensor.
    looks, looks_sensor : ndarray, shape (K,)
        When a sensor looked and saw nothing, and which.
    one_by_one : bool
        Whether plots may come one after the other, as an antenna turns.
    sensors : tuple of Sensor
        What the file tells of the sensors; empty where it tells nothing.
    notes : tuple of str
        What was done to it.
    """

    t: np.ndarray
    columns: dict[str, np.ndarray]
    sensor: np.ndarray
    looks: np.ndarray = field(default_factory=lambda: np.zeros(0))
    looks_sensor: np.ndarray = field(default_factory=lambda: np.zeros(0, int))
    one_by_one: bool = True
    sensors: tuple[Sensor, ...] = ()
    notes: tuple[str, ...] = ()
