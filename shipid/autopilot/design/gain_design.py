"""The design at one speed: the poles requested, and the gains that place them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from shipid.autopilot.design.autopilot import Design
from shipid.autopilot.design.placement import (
    Gains,
    check_stable,
    closed_poles,
    default_natural_frequency,
    lqr_gains,
    place,
    pole_pair,
)
from shipid.autopilot.design.plant import Plant, ship_plants
from shipid.autopilot.errors import DesignRequestError
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.foundation.numbers import brief
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.ship_coefficients import coefficients_at

#: Largest natural frequency by default, over one in the dead time of the rudder: the loop crosses over at about twice that frequency, and
#: loses so much phase there, 23 deg.
DEAD_ANGLE = 0.2


@dataclass(frozen=True, eq=False)
class GainDesign:
    """The design of the gains of one ship in its load conditions.

    Attributes
    ----------
    model : Model
        The ship's model.
    ships : tuple of ParameterSet
        The ship, once for each load condition.
    design : {"pole", "lqr", "pid"}
        How the gains are found.
    request : mapping of str to float
        The request, SI; see `shipid.autopilot.design.autopilot.Autopilot`.
    service_speed : float
        In m/s.
    """

    model: Model
    ships: tuple[ParameterSet, ...]
    design: Design
    request: Mapping[str, float]
    service_speed: float

    def plants(self, speeds: np.ndarray, condition: int) -> Plant:
        """Return the ship alone at several speeds.

        Parameters
        ----------
        speeds : ndarray, shape (n,)
            In m/s.
        condition : int
            Which load condition.
        """
        return ship_plants(self.model, self.ships[condition], speeds)

    def polynomial(self, speed: float) -> np.ndarray:
        """Return the polynomial of the poles requested, highest power first.

        Parameters
        ----------
        speed : float
            In m/s.
        """
        omega = self.request["omega_n"] * speed / self.service_speed
        pair = pole_pair(omega, self.request["damping"])
        return np.polymul(pair, [1.0, self.request["integral"] * omega]) if self.design == "pid" else pair

    def wanted_poles(self, plant: Plant, speed: float) -> np.ndarray:
        """Return the poles requested in rad/s; for a design of least cost all its poles.

        Parameters
        ----------
        plant : Plant
            One condition.
        speed : float
            In m/s.
        """
        if self.design == "lqr":
            return closed_poles(plant, self.gains(plant, speed))
        return np.roots(self.polynomial(speed))

    def gains(self, plant: Plant, speed: float) -> Gains:
        """Return the gains at a speed; the other poles are checked.

        Parameters
        ----------
        plant : Plant
            One condition.
        speed : float
            In m/s.
        """
        ship = self.ships[0]
        if self.design == "lqr":
            # A ship without a length is scaled by the distance it covers in a second at its service speed.
            pace = speed / (ship.particular("L", "m") or self.service_speed)
            return lqr_gains(plant, self.request["rudder_weight"], pace)
        found = place(plant, self.polynomial(speed))
        check_stable(closed_poles(plant, found), f"the loop of {ship.name} at {brief(speed, 4)} m/s")
        return found


def read_request(
    model: Model,
    ships: tuple[ParameterSet, ...],
    service: float,
    design: str,
    omega_n: str | float | None,
    damping: float | None,
    integral: float,
    weight: float,
) -> dict[str, float]:
    """Return the request, SI.

    Parameters
    ----------
    model : Model
        The ship's model.
    ships : tuple of ParameterSet
        The ship, once for each load condition.
    service : float
        The service speed in m/s.
    design : {"pole", "lqr", "pid"}
        How the gains are found.
    omega_n, damping, integral, weight : str, float or None
        As for `design_autopilot`.

    Raises
    ------
    DesignRequestError
        If a number is out of range, or does not belong to the design.
    """
    if design == "lqr":
        if omega_n is not None or damping is not None:
            raise DesignRequestError(
                "lqr has no frequency and damping to set: give rudder_weight, or take pole or pid."
            )
        if not 0 < weight < np.inf:
            raise DesignRequestError(f"a rudder weight of {weight:g} is out of range: give one greater than zero.")
        return {"rudder_weight": float(weight)}
    zeta = 0.9 if damping is None else float(damping)
    if not 0.05 <= zeta <= 10:
        raise DesignRequestError(f"a damping ratio of {zeta:g} is out of range: give one from 0.05 to 10.")
    if omega_n is None:
        omega = _default_omega(model, ships[0], service, zeta)
    else:
        omega = to_si(omega_n, "rad/s", "omega_n") if isinstance(omega_n, str) else float(omega_n)
    if not 0 < omega < np.inf:
        raise DesignRequestError(f"a natural frequency of {omega:g} rad/s is out of range: give one greater than zero.")
    found = {"omega_n": omega, "damping": zeta}
    if design == "pid":
        if not 0.01 <= integral <= 1:
            raise DesignRequestError(f"a third pole of {integral:g} omega_n is out of range: give 0.01 to 1.")
        found["integral"] = float(integral)
    return found


def dead_time_of(model: Model, ship: ParameterSet, speed: float) -> float:
    """Return how much later the rudder of a ship acts in s; zero where it acts at once.

    Parameters
    ----------
    model : Model
        The ship's model.
    ship : ParameterSet
        The ship.
    speed : float
        In m/s.
    """
    name = model.delays.get("delta")
    return 0.0 if name is None else max(0.0, coefficients_at(model, ship, speed).values[name])


def _default_omega(model: Model, ship: ParameterSet, service: float, damping: float) -> float:
    plant = ship_plants(model, ship, np.array([service])).at(0)
    omega = default_natural_frequency(plant, damping, service / (ship.particular("L", "m") or service))
    dead_time = dead_time_of(model, ship, service)
    return min(omega, DEAD_ANGLE / dead_time) if dead_time else omega
