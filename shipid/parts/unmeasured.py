"""What acts on a ship unmeasured and changes slowly, as a filter estimates it: a yaw acceleration, a current, and errors of model and log.

The noise levels are this project's tuning for a 226 m container ship at 9.5 m/s.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.quantity import constant, derived, given, output, state
from shipid.foundation.aliases import Expression
from shipid.parts.planar_motion import PlanarMotion


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


class SlowSurge(Component):
    """What acts on the speed unmeasured and changes slowly: other revolutions, or a cruising speed that is not the ship's."""

    u_disturbance = state(
        "m/s^2",
        "forward acceleration by wind or another disturbance",
        nominal="1e-2 m/s^2",
        spread="2.5e-2 m/s^2",
        noise="1.6e-4 m/s^2.5",
        latex=r"\dot u_d",
    )

    @u_disturbance.rate
    def keeps(self) -> Expression:
        """Constant except for the process noise, as Passenier (1989), eq. (5.20), has it for the yaw."""
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


#: The errors of a model of low order last for so many L/U.
_LASTS = 1.5
#: The states below that are errors of the model and of the log.
ERRORS = ("drift_error", "sway_error", "log_error")


class UncertainMotion(PlanarMotion):
    """Position and heading of a ship whose sway speed the model does not state exactly.

    The error of the sway speed is the sum of an error of the drift angle and of a share of the rate of turn: a filter that does not
    know of it reads it as a current, above all while the ship turns.
    """

    L = constant("m", "length between perpendiculars")
    drift_error = state("rad", "error of the model's drift angle", nominal="1 deg", latex=r"\beta_e")
    sway_error = state("1", "error of the model's sway constant", nominal=0.1, latex=r"\gamma_e")
    sway_of_turn = derived("m/s", "rate of turn times the length", latex="L r")
    sway_missed = derived("m/s", "sway speed that the model does not state", latex="v_e")
    sway_log = output("m/s", "sway speed shown by the log", measures="v", noise="0.1 m/s")

    @sway_of_turn.equals
    def turning_by_length(self) -> Expression:
        """The sway speed of Passenier (1989), eq. (2.60), for a sway constant of -1."""
        return self.L * self.r

    @sway_missed.equals
    def missed(self) -> Expression:
        """The sign of the second term is that of Passenier (1989), eq. (2.60): sway to port in a turn to starboard."""
        return self.u * self.drift_error - self.sway_of_turn * self.sway_error

    @sway_log.equals
    def sway_shown(self) -> Expression:
        """The log shows the sway speed of the ship, not that of the model."""
        return self.v + self.sway_missed

    @drift_error.rate
    def drift_fades(self) -> Expression:
        """A Gauss-Markov process of first order: Gelb (1974), eq. (2.2-64)."""
        return -self.drift_error * self.u / (_LASTS * self.L)

    @sway_error.rate
    def share_fades(self) -> Expression:
        """A Gauss-Markov process of first order: Gelb (1974), eq. (2.2-64)."""
        return -self.sway_error * self.u / (_LASTS * self.L)

    def north(self) -> Expression:
        """Return the speed to the north: Passenier (1989), eq. (2.71), with the sway speed of the ship."""
        sway = self.v + self.sway_missed
        return self.u * np.cos(self.psi) - sway * np.sin(self.psi) + self.current_north

    def east(self) -> Expression:
        """Return the speed to the east: Passenier (1989), eq. (2.72), with the sway speed of the ship."""
        sway = self.v + self.sway_missed
        return self.u * np.sin(self.psi) + sway * np.cos(self.psi) + self.current_east


class UncertainLog(Component):
    """A log whose scale is not known exactly; on one heading its error and a current look alike."""

    u = given("m/s", "forward speed through the water")
    log_error = state("1", "error of the log, as a share of the speed", nominal=0.01, latex="e_u")
    log = output("m/s", "forward speed shown by the log", measures="u", noise="0.1 m/s")

    @log_error.rate
    def keeps(self) -> Expression:
        """Constant except for the process noise."""
        return 0.0

    @log.equals
    def reading(self) -> Expression:
        """Passenier (1989), section 5.4, with an error of the scale."""
        return self.u * (1 + self.log_error)
