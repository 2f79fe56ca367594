"""The honest measure of a band: predictions from past instants, along the rudder angles since, beside the voyage that was sailed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from shipid.autopilot.design.autopilot import Autopilot
from shipid.declaration.component import Component
from shipid.foundation.errors import UsageError
from shipid.foundation.notices import Notice
from shipid.parts.helm import DirectRudder
from shipid.parts.rudder_delay import actuator_of
from shipid.prediction.situations.past import LOOKED_AT, RUN_AWAY, Past, errors_of, told_of
from shipid.prediction.situations.ship_spread import with_coefficients
from shipid.prediction.situations.situation import PastErrors, Situation
from shipid.prediction.situations.trial_situation import known_before
from shipid.prediction.tracks.predicted_track import PredictedTrack
from shipid.prediction.tracks.track_predictor import TrackPredictor, wind_parts
from shipid.trials.trial import Trial

#: Steps of a past prediction for each ship length.
_STEPS = 20


def situation_with_past(
    pilot: Autopilot, trial: Trial, at: float | None = None, stated: Mapping[str, float] | None = None
) -> tuple[Situation, list[Notice]]:
    """Return what is known of a ship at an instant of a trial, and how far off predictions before that instant were.

    Parameters
    ----------
    pilot : Autopilot
        The ship with her model; how she is steered does not matter.
    trial : Trial
        The record.
    at : float, optional
        Time in s on the clock of the record; its last sample by default.
    stated : mapping of str to float, optional
        Inputs that go before those of the record, SI.

    Returns
    -------
    situation : Situation
    told : list of Notice
        What is not known, and that the band is widened.
    """
    known, told, past = known_before(pilot.model, pilot.ship, trial, at, stated)
    errors = past_errors(pilot, past, wind_parts(pilot, known))
    return replace(known, past=errors), [*told, *told_of(errors)]


def past_errors(pilot: Autopilot, past: Past, parts: tuple[type[Component], ...] = ()) -> PastErrors:
    """Predict from past instants along the rudder angles since, and return by how much the bands were too narrow.

    Parameters
    ----------
    pilot : Autopilot
        The ship with her model.
    past : Past
        What was known then, and how she sailed on.
    parts : tuple of type[Component]
        Components that act on the ship besides: the wind.

    Returns
    -------
    PastErrors
        Of no prediction, where there is no past instant.
    """
    nothing = np.full((1, LOOKED_AT.size), np.nan)
    if not past.situations:
        return errors_of(nothing, nothing)
    predictor = TrackPredictor(replace(pilot, actuator=actuator_of(pilot.model, DirectRudder)), parts=parts)
    begun = np.interp([s.t for s in past.situations], past.t, past.sailed)
    horizon = float(LOOKED_AT[-1])
    s = np.arange(round(horizon * _STEPS)) / _STEPS * pilot.length
    rudders = np.interp(begun[:, None] + s, past.sailed, past.delta)
    known = [with_coefficients(situation, pilot) for situation in past.situations]
    tracks = _tracks(predictor, known, rudders, horizon)
    off = np.stack([_off(track, past, start, pilot.length) for track, start in zip(tracks, begun)])
    lost = int((np.isposinf(off[:, 0]).any(axis=1)).sum())
    off[np.isposinf(off)] = RUN_AWAY
    return errors_of(off[:, 0], off[:, 1], lost)


def _tracks(
    predictor: TrackPredictor, known: list[Situation], rudders: np.ndarray, horizon: float
) -> list[PredictedTrack | None]:
    """The tracks, together where all can be predicted; None for one that cannot."""
    try:
        return list(predictor.along(known, rudders, horizon))
    except UsageError:
        if len(known) == 1:
            return [None]
    return [track for k, one in enumerate(known) for track in _tracks(predictor, [one], rudders[k : k + 1], horizon)]


def _off(track: PredictedTrack | None, past: Past, begun: float, length: float) -> np.ndarray:
    """Distances across the track and of the heading in standard deviations, at `LOOKED_AT`, shape (2, distances).

    They are infinite where the ship sailed on and the track has ended, and not a number where she has not sailed so far.
    """
    reached = begun + LOOKED_AT * length <= past.sailed[-1]
    found = np.where(reached, np.inf, np.nan) * np.ones((2, 1))
    if track is None:
        return found
    assert track.covariance is not None
    # Of a track without an end the last node is a step short of the horizon.
    right = np.nan if track.ended else track.s.size - 1.0
    node = np.interp(LOOKED_AT, track.s_star, np.arange(track.s.size), right=right)
    node[~reached] = np.nan
    for k in np.flatnonzero(np.isfinite(node)):
        i = round(node[k])
        x, y, psi = (np.interp(begun + track.s[i], past.sailed, c) for c in (past.x, past.y, past.psi))
        normal, covariance = track.normal[i], track.covariance[i]
        across = normal @ np.array([x - track.x[i], y - track.y[i]]) / np.sqrt(normal @ covariance @ normal)
        found[:, k] = across, (psi - track.psi[i]) / track.std["psi"][i]
    return found
