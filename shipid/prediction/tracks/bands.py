"""How far from its predicted track the ship may be: by linear propagation, or by samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipid.foundation.errors import UsageError
from shipid.generation.system import generate
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.distance_loop import NODE, SHOWN, DistanceLoop, make_distance_loop, unpacked_spread
from shipid.prediction.tracks.predicted_track import PredictedTrack
from shipid.prediction.tracks.start_of_track import spread_in
from shipid.prediction.tracks.track_run import TrackRun

#: Where the loop records what a spread is shown of.
_PLACES = [NODE.index(n) for n in SHOWN]


def linear_track(run: TrackRun, distance: float, points: int, substeps: int) -> PredictedTrack:
    """Return the track with the band that follows from the derivatives.

    Parameters
    ----------
    run : TrackRun
        What is ordered.
    distance : float
        Between two nodes in m.
    points, substeps : int
        Steps of the track, and integration steps in each.

    Returns
    -------
    PredictedTrack
    """
    extra, covariance, noise = spread_in(run.model, run.situation, run.slopes)
    loop = make_distance_loop(run.model, extra, "covariance", substeps)
    _, out = loop.loop(
        loop.carried(run.x0, covariance),
        np.full((points + 1, 1), distance),
        loop.coefficients(run.p, run.inputs, run.least, noise),
    )
    return tracked(run, loop, out)


def tracked(run: TrackRun, loop: DistanceLoop, out: np.ndarray) -> PredictedTrack:
    """Return the track and its band out of the rows of a loop that carries the covariance.

    Parameters
    ----------
    run : TrackRun
        What was ordered.
    loop : DistanceLoop
        The loop.
    out : ndarray, shape (N, outputs)
        Its rows.
    """
    track = run.track(out)
    return with_spread(track, unpacked_spread(out[: track.s.size, loop.shown :]), run.situation)


def sampled_track(
    run: TrackRun, track: PredictedTrack, distance: float, substeps: int, samples: int, seed: int
) -> PredictedTrack:
    """Return a track with the band of tracks that are drawn from what is not known.

    Parameters
    ----------
    run : TrackRun
        What is ordered.
    track : PredictedTrack
        The track of what is known best.
    distance : float
        Between two nodes in m.
    substeps, samples, seed : int
        Integration steps between two nodes, tracks, and the seed of the draws.

    Returns
    -------
    PredictedTrack

    Raises
    ------
    UsageError
        If there are fewer than two samples.
    """
    if samples < 2:
        raise UsageError(f"a band by {samples} samples is none: take at least 2, better 200.")
    extra, covariance, noise = spread_in(run.model, run.situation, run.slopes)
    driven = tuple(np.flatnonzero(noise[: len(run.model.states)]).tolist())
    loop = make_distance_loop(run.model, extra, "drawn", substeps, driven)
    random, states, nodes = np.random.default_rng(seed), len(run.model.states), track.s.size
    values, vectors = np.linalg.eigh(covariance)
    # The first is drawn from nothing: the track as these steps integrate it.
    draws = random.standard_normal((samples + 1, len(covariance))) @ (vectors * np.sqrt(np.maximum(values, 0.0))).T
    draws[0] = 0.0
    controls = np.empty((samples + 1, nodes, 1 + len(driven)))
    controls[:, :, 0] = distance
    controls[:, :, 1:] = random.standard_normal((samples + 1, nodes, len(driven)))
    controls[0, :, 1:] = 0.0
    table = np.repeat(loop.coefficients(run.p, run.inputs, run.least, noise)[None], samples + 1, axis=0)
    _draw_into(table, run, extra, draws[:, states:])
    away = loop.loop.side_by_side(run.x0 + draws[:, :states], controls, table)[:, :, _PLACES]
    away = away[1:] - away[0]
    kept = away[np.isfinite(away).all(axis=(1, 2))]
    lost = samples - len(kept)
    if len(kept) < 2:
        return replace(track, ended=track.ended or "nearly all samples run away: no band")
    spread = np.matmul(kept.transpose(1, 2, 0), kept.transpose(1, 0, 2)) / len(kept)
    shown = with_spread(track, spread, run.situation)
    return replace(shown, ended=track.ended or f"{lost} of {samples} samples run away") if lost else shown


def _draw_into(table: np.ndarray, run: TrackRun, extra: tuple[str, ...], draws: np.ndarray) -> None:
    """Write drawn coefficients and inputs into the coefficients of the loop, within their declared bounds."""
    system = generate(run.model)
    for k, name in enumerate(extra):
        if name in system.coefficients:
            place = system.coefficients.index(name)
            low, high = (run.model[name].number(b) for b in ("low", "high"))
        else:
            place, low, high = run.p.size + system.inputs.index(name), None, None
        drawn = table[:, place] + draws[:, k]
        table[:, place] = np.clip(drawn, -np.inf if low is None else low, np.inf if high is None else high)


def with_spread(track: PredictedTrack, spread: np.ndarray, situation: Situation) -> PredictedTrack:
    """Return a track with its spread, widened where earlier predictions of the ship were farther off than they should be.

    Parameters
    ----------
    track : PredictedTrack
        The track; N nodes.
    spread : ndarray, shape (N, 4, 4)
        Covariances of position, heading and time at equal distance.
    situation : Situation
        From which the track was predicted.
    """
    std = np.sqrt(np.maximum(np.einsum("nii->ni", spread), 0.0))
    covariance = spread[:, :2, :2]
    heading = std[:, 2]
    if situation.past is not None:
        wider, turned = situation.past.at(track.s_star)
        covariance, heading = covariance * wider[:, None, None] ** 2, heading * turned
    return replace(track, covariance=covariance, std={"psi": heading, "t": std[:, 3]})
