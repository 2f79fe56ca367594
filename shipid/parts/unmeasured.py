"""What acts on a ship unmeasured and changes slowly, as a filter estimates it: a yaw acceleration, and a current.

The noise levels are this project's tuning for a 226 m container ship at 9.5 m/s.
"""

from __future__ import annotations

from shipid.declaration.component import Component
from shipid.declaration.quantity import state
from shipid.foundation.aliases import Expression


class SlowDisturbance(Component):
    """An unmeasured yaw acceleration that changes slowly: the wind, or a bias of the rudder angle."""

    r_disturbance = state(
        "rad/s^2",
        "yaw acceleration by wind or another disturbance",
        nominal="1e-4 rad/s^2",
        spread="2.5e-4 rad/s^2",
        noise="1.6e-6 rad/s^2.5",
        latex="N_w",
    )

    @r_disturbance.rate
    def keeps(self) -> Expression:
        """Passenier (1989), eq. (5.20): constant except for the process noise."""
        return 0.0


class SlowResidual(Component):
    """What a measured wind does not explain of the yaw: a yaw acceleration that changes slowly, as `SlowDisturbance` does."""

    r_residual = state(
        "rad/s^2",
        "yaw acceleration by anything but the wind",
        nominal="1e-4 rad/s^2",
        spread="2.5e-4 rad/s^2",
        noise="1.6e-6 rad/s^2.5",
        latex=r"\dot r_{res}",
    )

    @r_residual.rate
    def keeps(self) -> Expression:
        """Passenier (1989), eq. (5.20): constant except for the process noise."""
        return 0.0


class SlowCurrent(Component):
    """An unmeasured current that changes slowly."""

    current_north = state(
        "m/s", "current, component to the north", spread="1 m/s", noise="0.014 m/s^1.5", latex="U_{c,N}"
    )
    current_east = state(
        "m/s", "current, component to the east", spread="1 m/s", noise="0.014 m/s^1.5", latex="U_{c,E}"
    )

    @current_north.rate
    def north_keeps(self) -> Expression:
        """Passenier (1989), eq. (5.52): constant except for the process noise."""
        return 0.0

    @current_east.rate
    def east_keeps(self) -> Expression:
        """Passenier (1989), eq. (5.53): constant except for the process noise."""
        return 0.0
