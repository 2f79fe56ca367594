"""What of an order a ship does not reach: a track that stops short of it is no answer to what was asked."""

from __future__ import annotations

import numpy as np

from shipid.autopilot.design.autopilot import Autopilot
from shipid.declaration.vocabulary import shown
from shipid.foundation.notices import Notice
from shipid.prediction.tracks.order import unwrapped
from shipid.prediction.tracks.predicted_track import PredictedTrack

#: A turn has ended where she turns at less than this share of the rate that was ordered; short of the heading by so much, in rad.
_ENDED, _SHORT = 0.1, np.deg2rad(3.0)
#: A rate is reached with this share of it, and has its time in so many ship lengths.
_REACHED, _SETTLED = 0.9, 8.0


def not_reached(pilot: Autopilot, track: PredictedTrack) -> list[Notice]:
    """Return what of the order of a track the ship does not reach.

    Parameters
    ----------
    pilot : Autopilot
        The autopilot, with the ship's limits.
    track : PredictedTrack
        The track.
    """
    order, most = track.order, pilot.limits.get("delta_max", np.inf)
    told = []
    limit = order.rudder_limit if order.rudder is None else None  # a rudder that is held has no other limit to tell of
    for angle, serious in ((order.rudder, True), (limit, False)):
        if angle is not None and abs(angle) > most * (1 + 1e-9):
            told.append(
                Notice(
                    f"{shown(abs(angle), 'delta')} of rudder is more than the ship has: the track is that of {shown(most, 'delta')}.",
                    "beyond-the-rudder",
                    serious=serious,
                )
            )
    if order.rate is None or track.ended:
        return told
    wanted, remedy = shown(abs(order.rate), "r"), "order a slower turn, or allow more rudder."
    if order.heading is None:
        fastest = float(np.abs(track.r).max())
        if track.s_star[-1] >= _SETTLED and fastest < _REACHED * abs(order.rate):
            said = f"a rate of turn of {wanted} is not reached, but {shown(fastest, 'r')} at most: {remedy}"
            told.append(Notice(said, "rate-not-reached", serious=True))
        return told
    short = abs(unwrapped(order.heading, float(track.psi[0])) - track.psi[-1])
    if short > _SHORT and abs(track.r[-1]) < _ENDED * order.rate:
        said = f"the turn ends {shown(short, 'psi')} from its heading: the ship does not come to a rate of {wanted} in time; {remedy}"
        told.append(Notice(said, "rate-not-reached", serious=True))
    return told
