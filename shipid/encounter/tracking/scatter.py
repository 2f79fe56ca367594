"""How far plots scatter: a log is tracked with the stated accuracy, and again with a wider one where its residuals ask for that.

Plots that scatter farther than stated fall out of the gate of their own track. Then few tracks are confirmed, they break, and those
that stand are too sure. Residuals that are too large and not correlated tell this from a target that manoeuvres (Mehra, 1970).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from shipid.encounter.plots.plots import Plots, Sensor
from shipid.encounter.tracking.filters.alpha_beta_filters import AlphaBetaFilters
from shipid.encounter.tracking.filters.target_filters import TargetFilters
from shipid.encounter.tracking.tracker import Standing, Tracker, TrackerSettings
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief

#: Residuals that say something of a sensor, the power of one axis that is too large, and the one at which a wider sensor is wide enough.
_ENOUGH, _TOO_LARGE, _SETTLED = 20, 1.3, 1.05
#: Correlated residuals may be those of a target that manoeuvres: then a wider sensor has to explain so many times the plots.
_CORRELATED, _MORE = 0.2, 1.1
#: Below this power a widened sensor is too wide.
_TOO_SMALL = 0.7
#: Runs over the log, and the largest factor of one step where tracks stand, and where none does: what lies outside the gate is not seen.
_RUNS, _STEP, _LEAP = 9, 2.0, 4.0


def tracked(
    filters: TargetFilters | AlphaBetaFilters, plots: Plots, rules: TrackerSettings
) -> tuple[Tracker, list[Standing], list[Notice]]:
    """Track a log, with sensors that are as accurate as their residuals allow.

    Parameters
    ----------
    filters : TargetFilters or AlphaBetaFilters
        The filters of no target yet.
    plots : Plots
        The log.
    rules : TrackerSettings
        What decides on tracks.

    Returns
    -------
    engine : Tracker
        At the end of the log.
    standings : list of Standing
        After each scan.
    notices : list of Notice
        Which sensors are less accurate than stated.
    """
    stated = tuple(plots.sensors)
    first = Tracker(filters, stated, rules)
    at_first = first.run(plots)
    scale = np.ones(len(stated))
    engine, standings = first, at_first
    for _ in range(_RUNS - 1):
        step = _steps(engine, len(plots.scans), _TOO_LARGE if engine is first else _SETTLED, scale > 1)
        if (step == 1.0).all():
            break
        scale = np.maximum(scale * step, 1.0)
        if (scale == 1.0).all():
            break
        engine = Tracker(filters, widened(stated, scale), rules)
        standings = engine.run(plots)
    if (scale == 1.0).all() or not _better(engine, first, len(plots.scans), scale > 1):
        # What the tracks of the stated accuracy leave unexplained widens each of them.
        return first, at_first, []
    return engine, standings, [_told(s, float(k)) for s, k in zip(stated, scale) if k > 1]


def widened(sensors: Sequence[Sensor], scale: np.ndarray) -> tuple[Sensor, ...]:
    """Return sensors that scatter more than stated.

    Parameters
    ----------
    sensors : sequence of Sensor
        As stated.
    scale : ndarray, shape (sensors,)
        Factor of the standard deviations.
    """
    return tuple(
        replace(
            s,
            position_std=s.position_std * k,
            range_std=None if s.range_std is None else s.range_std * k,
            bearing_std=None if s.bearing_std is None else s.bearing_std * k,
        )
        for s, k in zip(sensors, scale.tolist())
    )


def _steps(engine: Tracker, scans: int, limit: float, wider: np.ndarray) -> np.ndarray:
    """By how much each sensor has to be less accurate, one where it need not, and less than that where it was made too wide."""
    power, _, count = engine.residuals.of_sensor.T
    enough = count >= _ENOUGH
    if not enough.any():
        # Hardly a track is confirmed: either there is no target, or the gates are much too narrow for her plots.
        return np.full(count.size, _LEAP if scans >= _ENOUGH else 1.0)
    mean = power / np.maximum(count, 1.0)
    wrong = (mean > limit) | (wider & (mean < _TOO_SMALL))
    return np.where(enough & wrong, np.minimum(np.sqrt(mean), _STEP), 1.0)


def _better(engine: Tracker, first: Tracker, scans: int, wider: np.ndarray) -> bool:
    """Whether wider sensors agree with their residuals, and explain the plots better than the stated ones."""
    power, serial, count = engine.residuals.of_sensor.sum(axis=0)
    if count < _ENOUGH or (_steps(engine, scans, _TOO_LARGE, wider) != 1.0).any():
        return False
    before_power, before_serial, before = first.residuals.of_sensor.sum(axis=0)
    scattered = before_serial < _CORRELATED * before_power
    return bool(count > _MORE * before or (scattered and serial < _CORRELATED * power))


def _told(sensor: Sensor, scale: float) -> Notice:
    if sensor.range_std is None or sensor.bearing_std is None:
        stated, found = f"{brief(sensor.position_std, 3)} m", f"{brief(scale * sensor.position_std, 3)} m"
    else:
        stated, found = (
            f"{brief(k * sensor.range_std, 3)} m in range and {brief(k * np.rad2deg(sensor.bearing_std), 2)} deg in bearing"
            for k in (1.0, scale)
        )
    return Notice(
        f"the plots of sensor {sensor.name} scatter {scale:.1f} times as far as stated ({stated}): {found} are taken, and all "
        "covariances are so much wider. State the accuracy of the sensor.",
        "plots-scatter-more",
        sensor=sensor.name,
        factor=scale,
    )
