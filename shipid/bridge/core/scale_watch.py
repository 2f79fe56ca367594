"""The factor K_rho between the rate of turn and the predicted one, followed through a turn that was executed.

Passenier (1989), section 5.6.2.2. It is shown beside the coefficients of the filter; the tracks on the page are predicted anew from the
filter's estimate, which holds the adapted coefficients already.
"""

from __future__ import annotations

from collections.abc import Mapping

from shipid.bridge.core.console import SteeringOrder
from shipid.bridge.shown.plain_values import number
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ShipidError
from shipid.prediction.following.track_adaptation import TrackFollower
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import TrackPredictor

#: A change of heading smaller than this, in rad, says nothing of the scale.
_SMALLEST = 0.1


class ScaleWatch:
    """Follows K_rho.

    Parameters
    ----------
    predictor : TrackPredictor
        Predicts the turn in still water when it is executed.
    """

    def __init__(self, predictor: TrackPredictor) -> None:
        self._predictor = predictor
        self._follower: TrackFollower | None = None
        self._K_rho: float | None = None

    def begin(self, known: Situation, steering: SteeringOrder) -> None:
        """Begin to follow a turn to a heading; under another order nothing is followed.

        Parameters
        ----------
        known : Situation
            What is known of the ship.
        steering : SteeringOrder
            What is executed.
        """
        self._follower = self._K_rho = None
        if steering.mode != "heading":
            return
        still = {n: v for n, v in known.values.items() if not n.startswith("current_")}
        try:
            track = self._predictor.predict(Situation(still), **steering.order(), band="none")
            if abs(track.psi[-1] - track.psi[0]) >= _SMALLEST:
                self._follower = TrackFollower(track)
        except ShipidError:
            self._follower = None

    def update(self, t: float, values: Mapping[str, float]) -> None:
        """Take the ship's estimated state.

        Parameters
        ----------
        t : float
            In s.
        values : mapping of str to float
            ``psi``, ``r`` and ``u``, SI.
        """
        if self._follower is None:
            return
        try:
            self._K_rho = self._follower.update(t, values["psi"], values.get("r", 0.0), values["u"])
        except ShipidError:
            self._follower = None

    def to_list(self) -> list[Plain]:
        """Return K_rho as a value of the adaptation; nothing where no turn was followed."""
        if self._K_rho is None or self._follower is None:
            return []
        return [{
            "name": "K_rho", "label": "K_ρ", "value": number(self._K_rho, 4), "sd": None, "unit": "1",
            "standing": "at the end of its range" if self._follower.limited else "of this turn",
        }]  # fmt: skip
