"""What the truth says of the covariances of tracks: where they are much too small, the page and the text say so."""

from __future__ import annotations

from shipid.encounter.tracking.scoring import ShipScore, TrackingScore
from shipid.foundation.notices import Notice

#: Mean squared error of the position in standard deviations above which a covariance is too small, and that at which nobody should use it; 2 is honest.
_TOO_SMALL, _MUCH_TOO_SMALL = 4.0, 10.0
#: Scans that are not chance.
_ENOUGH = 20


def contradictions(score: TrackingScore) -> list[Notice]:
    """Return a notice for each ship whose tracks are surer than they are right.

    Parameters
    ----------
    score : TrackingScore
        The tracks beside the truth.

    Returns
    -------
    list of Notice
        Serious ones where standard deviations are more than two times too small.
    """
    found = [s for s in score.ships if s.nees is not None and s.nees > _TOO_SMALL and s.scans >= _ENOUGH]
    return [_told(s) for s in found]


def _told(ship: ShipScore) -> Notice:
    assert ship.nees is not None and ship.rmse[0] is not None, "of a ship that was held"
    factor = (ship.nees / 2) ** 0.5
    offset = ""
    if ship.bearing_offset is not None and ship.range_offset is not None:
        (bearing, spread), (along, along_spread) = ship.bearing_offset, ship.range_offset
        offset = f" Bearings are {bearing:+.1f} ± {spread:.1f} deg off and ranges {along:+.0f} ± {along_spread:.0f} m."
    return Notice(
        f"{ship.name}: the tracks lie {ship.rmse[0]:.0f} m from the truth, and their standard deviations are {factor:.1f} times "
        f"too small for that (NEES {ship.nees:.0f}, 2 is right).{offset} Plots do not show what they all have in common: a heading or a "
        "clock that is off, the length of the ship. State it as bias_std and bearing_bias_std of the sensor, or correct the latency.",
        "covariance-too-small",
        serious=ship.nees > _MUCH_TOO_SMALL,
        ship=ship.name,
        factor=factor,
    )
