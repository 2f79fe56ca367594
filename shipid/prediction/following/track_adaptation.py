"""A predicted track that follows the ship: translated by its heading, scaled by its rate of turn, moved by the current.

Passenier (1989), sections 3.2.3, 5.6.2.2 and 6.3.4. The prediction is made once, in still water, when the order is given; while
the ship turns, its remaining part is laid where the ship is. Predicting anew from the filter's estimate is the other way
(`shipid.prediction.tracks.track_predictor`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.quantity import given, output, state
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.online.online_filter import OnlineFilter
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import UsageError
from shipid.prediction.tracks.predicted_track import COLUMNS, PredictedTrack

#: Share of the largest rudder angle below which the rudder has left it, and the counter-rudder part begins.
_LEFT = 0.95
#: The scale of a track may lie between these: a ship that turns at another rate than half or double is another ship.
LEAST_SCALE, LARGEST_SCALE = 0.5, 2.0


class TrackScale(Component):
    """The factor K_rho between the rate of turn and the predicted one, a constant that changes slowly."""

    K_rho = state(
        "1", "rate of turn over the predicted one", nominal=1.0, start=1.0, spread="0.3", noise="0.02 1/s^0.5"
    )
    r_star_predicted = given("1", "predicted rate of turn at the present heading, made dimensionless")
    r_star_seen = output("1", "rate of turn, made dimensionless: r L/u", noise="0.02")

    @K_rho.rate
    def keeps(self) -> Expression:
        """Passenier (1989), eq. (5.110): constant except for the noise."""
        return 0.0

    @r_star_seen.equals
    def observed(self) -> Expression:
        """Passenier (1989), eq. (5.111)."""
        return self.K_rho * self.r_star_predicted


track_scale = join("track-scale", TrackScale)


class TrackFollower:
    """Follows a manoeuvre along its predicted track: estimates K_rho and lays the remaining track where the ship is.

    Parameters
    ----------
    track : PredictedTrack
        As it was predicted when the order was given, in still water.
    literal : bool
        Whether the scaling is the one of section 6.3.4 of the thesis: the whole track, the times left as they are. By default the
        sway part keeps its size (5.108), the times are divided as the distances are, and the scale is 1 as soon as the ship is under
        counter-rudder, where the autopilot decides the shape of the rest and not the gain of the ship.

    Attributes
    ----------
    K_rho : float
        The estimate; 1 before the first update.

    Raises
    ------
    UsageError
        If the track contains a current.
    """

    def __init__(self, track: PredictedTrack, *, literal: bool = False) -> None:
        if any(track.current):
            raise UsageError(
                "a track is followed from its prediction in still water: the current is added while it is followed."
            )
        self.track, self.literal = track, literal
        self.K_rho = 1.0
        self._filter: OnlineFilter = ExtendedKalmanFilter(track_scale, estimated=(), gate=None).start()
        self._node = 0.0

    def update(self, t: float, psi: float, r: float, u: float) -> float:
        """Take the ship's estimated heading and rate of turn; return K_rho.

        Parameters
        ----------
        t : float
            In s.
        psi, r, u : float
            Heading in rad, unwrapped as the track's, rate of turn in rad/s, forward speed in m/s.

        Returns
        -------
        float
        """
        self._node = node_at_heading(self.track, psi, self._node)
        if self._node < counter_rudder(self.track):
            predicted = np.interp(
                self._node, np.arange(self.track.s.size), self.track.r * self.track.length / self.track.u
            )
            # Passenier (1989), eq. (5.112).
            seen = r * self.track.length / u
            estimate = self._filter.update({"t": t, "r_star_seen": seen, "r_star_predicted": float(predicted)})
            self.K_rho = float(np.clip(estimate["K_rho"], LEAST_SCALE, LARGEST_SCALE))
        return self.K_rho

    @property
    def limited(self) -> bool:
        """Whether the estimate of K_rho is held at the end of its range, beyond which the ship is another one than was predicted."""
        return self.K_rho in (LEAST_SCALE, LARGEST_SCALE)

    def remaining(
        self, x: float, y: float, psi: float, current: tuple[float, float] = (0.0, 0.0), *, scaled: bool = True
    ) -> PredictedTrack:
        """Return the rest of the track from where the ship is.

        Parameters
        ----------
        x, y : float
            Estimated position in m.
        psi : float
            Estimated heading in rad, unwrapped as the track's.
        current : tuple of float
            Estimated current to the north and to the east in m/s.
        scaled : bool
            Whether K_rho scales it.
        """
        node = node_at_heading(self.track, psi, self._node)
        K_rho = self.K_rho if scaled else 1.0
        return adapted(self.track, node, x, y, K_rho=K_rho, current=current, literal=self.literal)


def counter_rudder(track: PredictedTrack) -> int:
    """Return the node at which the rudder leaves its largest angle, after which the autopilot decides the shape of the track.

    Parameters
    ----------
    track : PredictedTrack
        The track of a change of heading.
    """
    size = np.abs(track.delta)
    peak = int(size.argmax())
    left = np.flatnonzero(size[peak:] < _LEFT * size[peak])
    return peak + int(left[0]) if left.size else track.s.size


def node_at_heading(track: PredictedTrack, psi: float, begin: float = 0.0) -> float:
    """Return the node of a track at which its heading is the ship's, with a fraction: Passenier (1989), eq. (3.30).

    Parameters
    ----------
    track : PredictedTrack
        The track.
    psi : float
        Heading of the ship in rad, unwrapped as the track's.
    begin : float
        Node the ship has reached before: it does not go back.

    Returns
    -------
    float
        The node reached before while the ship has not turned so far; the last node once it has turned farther than the track does.
    """
    side = 1.0 if track.psi[-1] >= track.psi[0] else -1.0
    turned, wanted = side * (track.psi - track.psi[0]), side * (psi - track.psi[0])
    # Up to its largest heading the track turns one way; beyond it, it swings back onto its course.
    peak = int(turned.argmax())
    farthest = np.maximum.accumulate(turned[: peak + 1])
    if wanted >= farthest[-1]:
        return float(max(begin, peak))
    i = int(np.searchsorted(farthest, wanted, side="right"))
    if i == 0:
        return begin
    share = (wanted - farthest[i - 1]) / (farthest[i] - farthest[i - 1])
    return float(max(begin, i - 1 + share))


def adapted(
    track: PredictedTrack,
    node: float,
    x: float,
    y: float,
    *,
    K_rho: float = 1.0,
    current: tuple[float, float] = (0.0, 0.0),
    literal: bool = False,
) -> PredictedTrack:
    """Return the rest of a track behind a node, laid where the ship is, scaled and in a current.

    Parameters
    ----------
    track : PredictedTrack
        In still water.
    node : float
        From `node_at_heading`.
    x, y : float
        Position of the ship in m.
    K_rho : float
        Rate of turn over the predicted one.
    current : tuple of float
        To the north and to the east in m/s.
    literal : bool
        See `TrackFollower`.

    Returns
    -------
    PredictedTrack

    Notes
    -----
    Passenier (1989), eq. (5.102), (5.108), (5.113)-(5.116) and section 6.3.4. There the times are not scaled; a ship that turns K_rho
    times as fast sails 1/K_rho of the distance, and drifts for 1/K_rho of the time.
    """
    numbers = np.arange(track.s.size)
    nodes = np.concatenate([[min(node, numbers[-1])], numbers[numbers > node]])
    rest = replace(track, **{n: np.interp(nodes, numbers, getattr(track, n)) for n in COLUMNS}, covariance=None, std={})
    scale = np.full(nodes.size - 1, 1.0 / K_rho)
    if not literal and node >= counter_rudder(track):
        scale[:] = 1.0
    seconds = np.diff(rest.t)
    sway = _between(-rest.v * np.sin(rest.psi)) * seconds, _between(rest.v * np.cos(rest.psi)) * seconds
    ahead = np.diff(rest.x) - sway[0], np.diff(rest.y) - sway[1]
    lasting = seconds if literal else seconds * scale
    moved = [
        (a + s) * scale + c * lasting if literal else a * scale + s + c * lasting
        for a, s, c in zip(ahead, sway, current)
    ]
    return replace(
        rest,
        s=np.concatenate([[0.0], np.cumsum(np.diff(rest.s) * scale)]),
        t=np.concatenate([[0.0], np.cumsum(lasting)]),
        x=x + np.concatenate([[0.0], np.cumsum(moved[0])]),
        y=y + np.concatenate([[0.0], np.cumsum(moved[1])]),
        current=current,
        source=f"{track.source}, adapted",
    )


def _between(values: np.ndarray) -> np.ndarray:
    return np.asarray(0.5 * (values[1:] + values[:-1]))
