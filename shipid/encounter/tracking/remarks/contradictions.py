"""What the truth says of the covariances of tracks: where they are much too small, the page and the text say so."""

from __future__ import annotations

from shipid.encounter.tracking.scoring import ShipScore, TrackingScore
from shipid.foundation.notices import Notice

#: Mean squared error of the position in standard deviations, 2 where they are honest: too small, and three times too small.
_TOO_SMALL, _MUCH_TOO_SMALL = 4.0, 18.0
#: Scans that are not chance.
_ENOUGH = 20
_OFFSET = (
    "Plots do not show what they all have in common: a heading or a clock that is off, the length of the ship. State it as bias_std and "
    "bearing_bias_std of the sensor, or correct the latency."
)
_UNSEEN = Notice(
    "no plot lies near a true ship: they may be by another clock, from another origin, or with north and east exchanged. The tracks are not "
    "judged.",
    "truth-apart",
    serious=True,
)


def contradictions(score: TrackingScore) -> list[Notice]:
    """Return a notice for each ship whose tracks are surer than they are right, or one where no true ship was seen.

    Parameters
    ----------
    score : TrackingScore
        The tracks beside the truth.

    Returns
    -------
    list of Notice
        Serious ones where standard deviations are more than three times too small.
    """
    found = [s for s in score.ships if s.nees is not None and s.nees > _TOO_SMALL and s.scans >= _ENOUGH]
    unseen = [_UNSEEN] if score.ships and all(s.held is None for s in score.ships) else []
    return [*unseen, *(_told(s) for s in found)]


def _told(ship: ShipScore) -> Notice:
    assert ship.nees is not None and ship.rmse[0] is not None, "of a ship that was held"
    factor = (ship.nees / 2) ** 0.5
    cause = _OFFSET
    if ship.bearing_offset is not None and ship.range_offset is not None:
        (bearing, spread), (along, along_spread) = ship.bearing_offset, ship.range_offset
        if abs(bearing) < spread and abs(along) < along_spread:
            cause = "They lie to all sides of her: they may be another target's."
        cause = f"Bearings are {bearing:+.1f} ± {spread:.1f} deg off and ranges {along:+.0f} ± {along_spread:.0f} m. {cause}"
    return Notice(
        f"{ship.name}: the tracks lie {ship.rmse[0]:.0f} m from the truth, and their standard deviations are {factor:.1f} times "
        f"too small for that (NEES {ship.nees:.0f}, 2 is right). {cause}",
        "covariance-too-small",
        serious=ship.nees > _MUCH_TOO_SMALL,
        ship=ship.name,
        factor=factor,
    )
