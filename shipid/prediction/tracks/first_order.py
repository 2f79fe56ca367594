"""The prediction model of the thesis: first order in the distance sailed, at a constant speed.

Passenier (1989), eq. (7.1)-(7.3). The full model of the ship is the other choice: it knows the loss of speed, and the nonlinear yaw.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import coefficients_of, heading_frequency, linear_ship
from shipid.autopilot.on_board.model_reference import first_order_equivalent
from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.declaration.quantity import constant, derived, given, parameter, state
from shipid.foundation.aliases import Expression
from shipid.generation.linearisation import linearise
from shipid.generation.system import generate
from shipid.parts.planar_motion import PlanarMotion
from shipid.parts.rudder_delay import RudderDelay
from shipid.prediction.situations.situation import Situation


class FirstOrderShip(Component):
    """Rate of turn of first order in the distance sailed; sway in proportion to it; the speed is given."""

    r_star = state("1", "rate of turn, made dimensionless: r L/u", nominal=0.5, latex="r^*")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    u = given("m/s", "forward speed through the water, kept")
    psi = given("rad", "heading, clockwise from north", wraps=True, latex=r"\psi")
    wind_direction = given("rad", "direction the true wind blows to", default=0.0, wraps=True, latex=r"\psi_w")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    L = constant("m", "length between perpendiculars")
    rudder_wind = constant("rad", "largest rudder angle that holds a course in the wind", default=0.0)
    K = parameter("1", "yaw gain K*", start=1.0, low=0.05, high=50.0, dimensional="1/s", latex="K^*")
    tau = parameter("1", "yaw time constant tau*", start=1.5, low=0.05, high=50.0, dimensional="s", latex=r"\tau^*")
    gamma = parameter("1", "sway constant gamma*: sway to port in a turn to starboard", start=0.45, low=-2.0, high=5.0)
    r = derived("rad/s", "rate of turn, positive to starboard")
    v = derived("m/s", "sway speed through the water, positive to starboard")

    @r_star.rate
    def yaw(self) -> Expression:
        """Passenier (1989), eq. (7.2), with the wind as in (3.79)-(3.81): K* times the rudder that holds it."""
        wind = self.K * self.rudder_wind * np.sin(2 * (self.wind_direction - self.psi))
        pace = self.u / self.L
        return pace * (self.K * self.delta - self.r_star + wind) / self.tau + self.r_disturbance / pace

    @r.equals
    def rate_of_turn(self) -> Expression:
        """Passenier (1989), eq. (2.40)."""
        return self.r_star * self.u / self.L

    @v.equals
    def sway(self) -> Expression:
        """Passenier (1989), eq. (7.3)."""
        return -self.gamma * self.u * self.r_star


def at_cruising_speed(situation: Situation) -> Situation:
    """Return a situation with the constant speed of the prediction, the cruising speed: Passenier (1989), eq. (3.96).

    The dimensionless rate of turn r L/u, which makes the track, stays what it is (5.112).

    Parameters
    ----------
    situation : Situation
        What is known of the ship; where it states no cruising speed, the present speed is kept.
    """
    values = situation.values
    if "cruise" not in values:
        return situation
    share = values["cruise"] / values["u"]
    return replace(situation, values={**values, "u": values["cruise"], "r": share * values.get("r", 0.0)})


first_order_ship = join("first-order", FirstOrderShip, PlanarMotion)
_first_order_late = join("first-order-delay", FirstOrderShip, PlanarMotion, RudderDelay)


def first_order_for(model: Model) -> Model:
    """Return the model of first order that predicts in place of a ship's own: with a dead time of the rudder where that has one.

    Parameters
    ----------
    model : Model
        The ship's own model.
    """
    return _first_order_late if "delta" in model.delays else first_order_ship


def first_order_coefficients(pilot: Autopilot, speed: float, condition: int = 0) -> dict[str, float]:
    """Return K*, tau* and gamma* of the ship of first order that answers the rudder as the ship of an autopilot does.

    They are those at the natural frequency of the heading, for small rudder angles. A ship with a nonlinear yaw has others in a
    hard turn: then take those of a yaw filter on a zig-zag of that size.

    Parameters
    ----------
    pilot : Autopilot
        The design, with the ship's own model.
    speed : float
        In m/s.
    condition : int
        Which load condition.
    """
    pace = pilot.pace(speed)
    a, b1 = first_order_equivalent(linear_ship(pilot, [speed], condition).at(0), heading_frequency(pilot, speed), pace)
    found = {"K": a / b1, "tau": 1 / b1, "gamma": 0.0, "L": pilot.length}
    if "v" in pilot.model and pilot.model["v"].quantity.kind != "given":
        known = coefficients_of(pilot, pilot.model, speed, condition) | {"u": speed, "cruise": speed}
        system = generate(pilot.model)
        driven = system.states_driven_by(["delta"])
        states = [s for s in system.states_behind(["v", "r"]) if s in driven and s != "psi"]
        linear = linearise(pilot.model, known, states, ["delta"], ["v", "r"], delayed=True)
        turning = -linear.C @ np.linalg.solve(linear.A, linear.B) + linear.D
        found["gamma"] = float(-turning[0, 0] / (turning[1, 0] * pilot.length))
    return found
