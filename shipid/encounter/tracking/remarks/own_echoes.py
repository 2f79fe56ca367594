"""Tracks of own ship herself: her echo, her own AIS, or plots without a range all lie where she is, and are no target."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipid.encounter.plots.read_plots import Detections
from shipid.encounter.tracking.target_track import TargetTrack
from shipid.foundation.notices import Notice

#: A track lies on own ship within so many of its standard deviations, or so many metres, and in this share of its scans.
_NEAR, _LEAST, _MOSTLY = 3.0, 15.0, 0.9


def without_own_ship(tracks: list[TargetTrack], found: Detections) -> tuple[list[TargetTrack], list[Notice]]:
    """Return the tracks, those that lie on own ship without a closest approach to her, and a notice about them.

    Parameters
    ----------
    tracks : list of TargetTrack
        All tracks.
    found : Detections
        The log, with own ship where she is known. Where nothing is known of her, the origin of plots in metres counts.

    Returns
    -------
    tracks : list of TargetTrack
        As many as before.
    notices : list of Notice
        One, or none; serious where there is no other track.
    """
    away = {one.number: stays for one in tracks if (stays := _stays(one, found)) is not None}
    if not away:
        return tracks, []
    several, known = len(away) > 1, found.own is not None or found.relative
    numbers = " and ".join(str(n) for n in away)
    where = "own ship" if known else "x = y = 0, where own ship is if plots count from her"
    told = Notice(
        f"track{'s' * several} {numbers} {'stay' if several else 'stays'} within {max(away.values()):.0f} m of {where}: her own echo, her "
        "own AIS or plots without a range, and no target, unless a ship lies alongside. No closest approach is told.",
        "track-on-own-ship",
        serious=len(away) == len(tracks),
        tracks=list(away),
    )
    return [replace(one, approach=None) if one.number in away else one for one in tracks], [told]


def _stays(track: TargetTrack, found: Detections) -> float | None:
    """How far from own ship a track is at most where it stays on her, m; None where it does not."""
    if found.own is not None:
        inside = found.own.covers(track.t) & track.held
        here = found.own.at(track.t)
    elif found.relative or found.plots.origin is None:
        inside, here = track.held, np.zeros(2)
    else:
        return None
    if not inside.any():
        return None
    away = np.hypot(*(track.x[:, :2] - here).T)[inside]
    spread = np.sqrt(0.5 * np.trace(track.P[inside, :2, :2], axis1=1, axis2=2))
    near = away < np.maximum(_NEAR * spread, _LEAST)
    # Where nothing is known of her, only what lies still at the origin is suspected: a target may pass there.
    still = found.own is not None or found.relative or not track.moves[inside].any()
    return float(np.quantile(away, 0.95)) if still and near.mean() > _MOSTLY else None
