"""Propeller and rudder of the MMG standard model, and what turns the propeller.

Yasukawa and Yoshimura (2015), forces by the propeller and by steering. The formulas are those of the paper, with the advance ratio J multiplied out:
nothing is divided by the revolutions or by the speed, so that a propeller that starts and a ship at rest are in their range.
Forces are divided by rho L^2 d / 2, with the draught d, called T here.
"""

from __future__ import annotations

import numpy as np

from shipid import Component, constant, derived, given, guard, parameter


class MmgPropeller(Component):
    """Thrust of a propeller that turns ahead, in the wake of a ship that drifts and turns."""

    u = given("m/s", "forward speed through the water")
    r = given("rad/s", "rate of turn, positive to starboard")
    n = given("1/s", "propeller revolutions")
    V = given("m/s", "speed through the water, not below a twentieth of the cruise", latex="U")
    drift = given("rad", "drift angle at midship, positive when the flow comes from port", latex=r"\beta")
    L = constant("m", "length between perpendiculars")
    T = constant("m", "draught", latex="d")
    D_P = constant("m", "diameter of the propeller")
    t_P = parameter("1", "thrust deduction", start=0.22, low=0.0, high=0.6, estimated=False)
    w_P0 = parameter(
        "1", "wake fraction at the propeller, straight ahead", start=0.4, low=0.0, high=0.8, estimated=False
    )
    x_P = parameter("1", "place of the propeller for its drift angle", start=-0.48, low=-1.0, high=0.0, estimated=False)
    C_1 = parameter(
        "1", "how fast the wake changes with the drift angle", start=2.0, low=0.0, high=20.0, estimated=False
    )
    C_2_port = parameter("1", "wake in flow from port", start=1.6, low=0.5, high=3.0, estimated=False, latex="C_2^+")
    C_2_starboard = parameter(
        "1", "wake in flow from starboard", start=1.1, low=0.5, high=3.0, estimated=False, latex="C_2^-"
    )
    k_0 = parameter("1", "thrust coefficient at J = 0", start=0.2931, low=0.05, high=1.0, estimated=False)
    k_1 = parameter("1", "thrust coefficient per J", start=-0.2753, low=-1.0, high=0.2, estimated=False)
    k_2 = parameter("1", "thrust coefficient per J^2", start=-0.1385, low=-1.0, high=0.5, estimated=False)
    wake_left = derived("1", "share of the ship's speed that reaches the propeller: 1 - w_P")
    slipstream = derived("m^2/s^2", "thrust coefficient times n^2 D^2: what accelerates the flow to the rudder")
    X_P = derived("m/s^2", "surge force of the propeller, over rho L^2 d / 2")
    turns_ahead = guard("1/s", "the propeller turns astern, and its thrust is known ahead only")
    moves_ahead = guard("m/s", "the ship moves astern, and the thrust of its propeller is known ahead only")

    @wake_left.equals
    def wake(self):
        """Yasukawa and Yoshimura (2015), propeller: the wake in manoeuvring motions."""
        at_propeller = self.drift - self.x_P * self.r * self.L / self.V
        change = np.where(at_propeller > 0, self.C_2_port, self.C_2_starboard) - 1
        grown = 1 + (1 - np.exp(-self.C_1 * np.abs(at_propeller))) * change
        return (1 - self.w_P0) * grown

    @slipstream.equals
    def thrust_function(self):
        """Yasukawa and Yoshimura (2015), propeller: the open-water curve, the function Passenier (1989) names below eq. (2.29): K_T n^2 D^2."""
        tip, inflow = self.n * self.D_P, self.u * self.wake_left
        return self.k_0 * tip**2 + self.k_1 * tip * inflow + self.k_2 * inflow**2

    @X_P.equals
    def thrust(self):
        """Yasukawa and Yoshimura (2015), propeller: (1 - t_P) rho n^2 D^4 K_T."""
        return 2 * (1 - self.t_P) * self.slipstream * self.D_P**2 / (self.L**2 * self.T)

    @turns_ahead.equals
    def ahead(self):
        """The open-water test is one of a propeller that turns ahead."""
        return self.n

    @moves_ahead.equals
    def first_quadrant(self):
        """The open-water test is one of a propeller that moves ahead."""
        return self.u


class MmgRudder(Component):
    """Rudder in the slipstream of the propeller, with the force it raises on the hull."""

    u = given("m/s", "forward speed through the water")
    r = given("rad/s", "rate of turn, positive to starboard")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    cruise = given("m/s", "cruising speed, the speed before the manoeuvre", latex="U_0")
    V = given("m/s", "speed through the water, not below a twentieth of the cruise", latex="U")
    drift = given("rad", "drift angle at midship, positive when the flow comes from port", latex=r"\beta")
    wake_left = given("1", "share of the ship's speed that reaches the propeller: 1 - w_P")
    slipstream = given("m^2/s^2", "thrust coefficient times n^2 D^2: what accelerates the flow to the rudder")
    L = constant("m", "length between perpendiculars")
    T = constant("m", "draught", latex="d")
    D_P = constant("m", "diameter of the propeller")
    H_R = constant("m", "span of the rudder")
    A_R = constant("m^2", "area of the rudder")
    f_alpha = parameter("1", "lift gradient of the rudder", start=2.747, low=0.5, high=6.0, estimated=False)
    t_R = parameter("1", "steering resistance deduction", start=0.387, low=0.0, high=0.9, estimated=False)
    a_H = parameter("1", "force on the hull per rudder force", start=0.312, low=0.0, high=1.5, spread=0.08)
    x_H = parameter(
        "1", "place of that force, from midship", start=-0.464, low=-0.8, high=0.0, estimated=False, latex="x_H'"
    )
    x_R = parameter(
        "1", "place of the rudder, from midship", start=-0.5, low=-0.6, high=-0.3, estimated=False, latex="x_R'"
    )
    l_R = parameter(
        "1", "place of the rudder for its drift angle", start=-0.71, low=-1.5, high=0.0, estimated=False, latex="l_R'"
    )
    gamma_port = parameter(
        "1", "flow straightening in flow from port", start=0.64, low=0.05, high=1.5, spread=0.15, latex=r"\gamma_R^+"
    )
    gamma_starboard = parameter(
        "1",
        "flow straightening in flow from starboard",
        start=0.395,
        low=0.05,
        high=1.5,
        spread=0.1,
        latex=r"\gamma_R^-",
    )
    epsilon = parameter(
        "1",
        "wake at the rudder over that at the propeller",
        start=1.09,
        low=0.3,
        high=2.5,
        spread=0.15,
        latex=r"\epsilon",
    )
    kappa = parameter(
        "1",
        "share of the propeller's acceleration at the rudder",
        start=0.5,
        low=0.0,
        high=1.0,
        estimated=False,
        latex=r"\kappa",
    )
    F_N = derived("m/s^2", "normal force on the rudder, over rho L^2 d / 2")
    X_R = derived("m/s^2", "surge force by steering, over rho L^2 d / 2")
    Y_R = derived("m/s^2", "sway force by steering, over rho L^2 d / 2")
    N_R = derived("rad/s^2", "yaw moment by steering, over rho L^4 d / 2")

    @property
    def inflow(self):
        """Flow along and across the rudder: Yasukawa and Yoshimura (2015), steering: inflow at the rudder."""
        wake = self.u * self.wake_left
        # The small speed keeps the root, and its derivative, finite for a ship and a propeller at rest.
        least = (1e-9 * self.cruise) ** 2
        behind = np.sqrt(np.maximum(wake**2 + 8 / np.pi * self.slipstream, least))
        in_stream = (1 - self.kappa) * wake + self.kappa * behind
        share = self.D_P / self.H_R
        along = self.epsilon * np.sqrt(share * in_stream**2 + (1 - share) * wake**2 + least)
        at_rudder = self.drift - self.l_R * self.r * self.L / self.V
        straightening = np.where(at_rudder > 0, self.gamma_port, self.gamma_starboard)
        return along, self.V * straightening * at_rudder

    @F_N.equals
    def normal_force(self):
        """Yasukawa and Yoshimura (2015), steering: f_alpha U_R^2 sin(alpha_R), alpha_R = delta - atan(v_R/u_R)."""
        along, across = self.inflow
        angle = self.delta - np.arctan(across / along)
        return self.A_R / (self.L**2 * self.T) * self.f_alpha * (along**2 + across**2) * np.sin(angle)

    @X_R.equals
    def steering_resistance(self):
        """Yasukawa and Yoshimura (2015), steering: its surge force."""
        return -(1 - self.t_R) * self.F_N * np.sin(self.delta)

    @Y_R.equals
    def side_force(self):
        """Yasukawa and Yoshimura (2015), steering: its sway force."""
        return -(1 + self.a_H) * self.F_N * np.cos(self.delta)

    @N_R.equals
    def steering_moment(self):
        """Yasukawa and Yoshimura (2015), steering: its yaw moment."""
        return -(self.x_R + self.a_H * self.x_H) * self.F_N * np.cos(self.delta) / self.L


class ConstantRevolutions(Component):
    """Hull, propeller and rudder (MMG standard method), at the revolutions that hold the cruising speed on a straight course."""

    cruise = given("m/s", "cruising speed, the speed before the manoeuvre", latex="U_0")
    R_0_at_depth = given("1", "resistance ahead at the depth of the water", latex="R_0'(h)")
    t_P = given("1", "thrust deduction")
    w_P0 = given("1", "wake fraction at the propeller, straight ahead")
    k_0 = given("1", "thrust coefficient at J = 0")
    k_1 = given("1", "thrust coefficient per J")
    k_2 = given("1", "thrust coefficient per J^2")
    L = constant("m", "length between perpendiculars")
    T = constant("m", "draught", latex="d")
    D_P = constant("m", "diameter of the propeller")
    n = derived("1/s", "propeller revolutions")

    @n.equals
    def balance(self):
        """Yasukawa and Yoshimura (2015), on a straight course: thrust and resistance balance, solved for n."""
        inflow = self.cruise * (1 - self.w_P0)
        wanted = self.R_0_at_depth * self.cruise**2 * self.L * self.T
        wanted = wanted / (2 * (1 - self.t_P) * self.D_P**2) - self.k_2 * inflow**2
        root = np.sqrt((self.k_1 * inflow) ** 2 + 4 * self.k_0 * wanted)
        return (root - self.k_1 * inflow) / (2 * self.k_0) / self.D_P
