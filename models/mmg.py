"""The MMG standard model: surge, sway and yaw from the forces of hull, propeller and rudder.

Yasukawa and Yoshimura (2015), "Introduction of MMG standard method for ship maneuvering predictions", Journal of Marine Science
and Technology 20, 37-52. Forces are divided by rho L^2 d / 2 and moments by rho L^4 d / 2, with the draught d, called T here; so
the density of the water drops out. The coefficients are the paper's. Speeds are those of midship, and the rudder is positive when
it turns the ship to starboard, as in the paper.

Where a coefficient is not known, the search starts from KVLCC2 as published. The spreads are this project's own: about a quarter
of the value, which is how far the regressions of Yoshimura and Masumoto (2012) miss the tests of single hulls.
"""

from __future__ import annotations

import numpy as np

from shipid import Component, constant, derived, given, join, parameter, state
from shipid.models.mmg_depth import DeepWater, ShallowWater
from shipid.models.mmg_stern import ConstantRevolutions, MmgPropeller, MmgRudder
from shipid.parts.planar_motion import LEAST_WAY, PlanarMotion, SpeedScaled


class MmgMotion(SpeedScaled):
    """Hull, propeller and rudder (MMG standard method), at the shaft speed of the log."""

    u = state("m/s", "forward speed through the water", nominal=1.0)
    v = state("m/s", "sway speed through the water, positive to starboard", nominal=0.5)
    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    u_disturbance = given(
        "m/s^2", "forward acceleration by wind or another disturbance", default=0.0, latex=r"\dot u_d"
    )
    v_disturbance = given("m/s^2", "sway acceleration by wind or another disturbance", default=0.0, latex=r"\dot v_d")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    X_H = given("m/s^2", "surge force of the hull, over rho L^2 d / 2")
    Y_H = given("m/s^2", "sway force of the hull, over rho L^2 d / 2")
    N_H = given("rad/s^2", "yaw moment of the hull, over rho L^4 d / 2")
    X_P = given("m/s^2", "surge force of the propeller, over rho L^2 d / 2")
    X_R = given("m/s^2", "surge force by steering, over rho L^2 d / 2")
    Y_R = given("m/s^2", "sway force by steering, over rho L^2 d / 2")
    N_R = given("rad/s^2", "yaw moment by steering, over rho L^4 d / 2")
    m_y_at_depth = given("1", "added mass in sway at the depth of the water", latex="m_y'(h)")
    J_z_at_depth = given("1", "added moment of inertia in yaw at the depth of the water", latex="J_z'(h)")
    T = constant("m", "draught", latex="d")
    nabla = constant("m^3", "volume of the displacement", latex=r"\nabla")
    x_G = constant("m", "centre of gravity before midship")
    k_G = constant("1", "radius of gyration in yaw, in lengths", default=0.25)
    m_x = parameter("1", "added mass in surge", start=0.022, low=0.0, high=0.3, estimated=False, latex="m_x'")
    m_y = parameter("1", "added mass in sway", start=0.223, low=0.01, high=1.0, estimated=False, latex="m_y'")
    J_z = parameter(
        "1", "added moment of inertia in yaw", start=0.011, low=0.0, high=0.1, estimated=False, latex="J_z'"
    )

    @property
    def mass(self):
        """The mass of the ship over rho L^2 d / 2: Yasukawa and Yoshimura (2015), equations of motion."""
        return 2 * self.nabla / (self.L**2 * self.T)

    @property
    def coupling(self):
        """x_G m, in lengths: Yasukawa and Yoshimura (2015), equations of motion."""
        return self.mass * self.x_G / self.L

    @property
    def accelerations(self):
        """Sway and yaw, the two that x_G couples: Yasukawa and Yoshimura (2015), equations of motion, solved for both."""
        inertia = self.mass * (self.k_G**2 + (self.x_G / self.L) ** 2) + self.J_z_at_depth
        aside = self.Y_H + self.Y_R - (self.mass + self.m_x) * self.u * self.r
        turning = (self.N_H + self.N_R) * self.L - self.coupling * self.u * self.r
        sway_mass = self.mass + self.m_y_at_depth
        determinant = sway_mass * inertia - self.coupling**2
        sway = (inertia * aside - self.coupling * turning) / determinant
        yaw = (sway_mass * turning - self.coupling * aside) / determinant
        return sway, yaw / self.L

    @u.rate
    def surge(self):
        """Yasukawa and Yoshimura (2015), equations of motion, first line, with a disturbance added.

        X_vr is measured together with m_y v r, so this m_y is that of deep water, as X_vr is.
        """
        inertial = (self.mass + self.m_y) * self.v * self.r + self.coupling * self.L * self.r**2
        return (self.X_H + self.X_P + self.X_R + inertial) / (self.mass + self.m_x) + self.u_disturbance

    @v.rate
    def sway(self):
        """Yasukawa and Yoshimura (2015), equations of motion, second line, with a disturbance added."""
        return self.accelerations[0] + self.v_disturbance

    @r.rate
    def yaw(self):
        """Yasukawa and Yoshimura (2015), equations of motion, third line, with a disturbance added."""
        return self.accelerations[1] + self.r_disturbance


class MmgHull(Component):
    """Forces on the hull by drift and rate of turn, cubic in both."""

    u = given("m/s", "forward speed through the water")
    v = given("m/s", "sway speed through the water, positive to starboard")
    r = given("rad/s", "rate of turn, positive to starboard")
    cruise = given("m/s", "cruising speed, the speed before the manoeuvre", latex="U_0")
    R_0_at_depth = given("1", "resistance ahead at the depth of the water", latex="R_0'(h)")
    Y_v_at_depth = given("1", "sway force per v at the depth of the water", latex="Y_v'(h)")
    Y_r_at_depth = given("1", "sway force per r at the depth of the water", latex="Y_r'(h)")
    N_v_at_depth = given("1", "yaw moment per v at the depth of the water", latex="N_v'(h)")
    N_r_at_depth = given("1", "yaw moment per r at the depth of the water", latex="N_r'(h)")
    N_vvr_at_depth = given("1", "yaw moment per v^2 r at the depth of the water", latex="N_{vvr}'(h)")
    N_vrr_at_depth = given("1", "yaw moment per v r^2 at the depth of the water", latex="N_{vrr}'(h)")
    L = constant("m", "length between perpendiculars")
    R_0 = parameter("1", "resistance ahead", start=0.022, low=0.002, high=0.1, spread=0.005, latex="R_0'")
    X_vv = parameter("1", "surge force per v^2", start=-0.04, low=-0.5, high=0.3, estimated=False, latex="X_{vv}'")
    X_vr = parameter("1", "surge force per v r", start=0.002, low=-0.5, high=0.5, estimated=False, latex="X_{vr}'")
    X_rr = parameter("1", "surge force per r^2", start=0.011, low=-0.3, high=0.3, estimated=False, latex="X_{rr}'")
    X_vvvv = parameter("1", "surge force per v^4", start=0.771, low=-3.0, high=5.0, estimated=False, latex="X_{vvvv}'")
    Y_v = parameter("1", "sway force per v", start=-0.315, low=-1.5, high=-0.02, spread=0.08, latex="Y_v'")
    Y_r = parameter("1", "sway force per r", start=0.083, low=-0.3, high=0.5, spread=0.02, latex="Y_r'")
    Y_vvv = parameter("1", "sway force per v^3", start=-1.607, low=-10.0, high=2.0, spread=0.4, latex="Y_{vvv}'")
    Y_vvr = parameter("1", "sway force per v^2 r", start=0.379, low=-5.0, high=5.0, spread=0.2, latex="Y_{vvr}'")
    Y_vrr = parameter("1", "sway force per v r^2", start=-0.391, low=-5.0, high=5.0, spread=0.2, latex="Y_{vrr}'")
    Y_rrr = parameter("1", "sway force per r^3", start=0.008, low=-1.0, high=1.0, estimated=False, latex="Y_{rrr}'")
    N_v = parameter("1", "yaw moment per v", start=-0.137, low=-0.6, high=0.1, spread=0.03, latex="N_v'")
    N_r = parameter("1", "yaw moment per r", start=-0.049, low=-0.3, high=0.0, spread=0.012, latex="N_r'")
    N_vvv = parameter("1", "yaw moment per v^3", start=-0.03, low=-2.0, high=2.0, spread=0.1, latex="N_{vvv}'")
    N_vvr = parameter("1", "yaw moment per v^2 r", start=-0.294, low=-3.0, high=1.0, spread=0.08, latex="N_{vvr}'")
    N_vrr = parameter("1", "yaw moment per v r^2", start=0.055, low=-1.0, high=1.0, spread=0.05, latex="N_{vrr}'")
    N_rrr = parameter("1", "yaw moment per r^3", start=-0.013, low=-0.5, high=0.5, estimated=False, latex="N_{rrr}'")
    drift = derived("rad", "drift angle at midship, positive when the flow comes from port", latex=r"\beta")
    V = derived("m/s", "speed through the water, not below a twentieth of the cruise", latex="U")
    X_H = derived("m/s^2", "surge force of the hull, over rho L^2 d / 2")
    Y_H = derived("m/s^2", "sway force of the hull, over rho L^2 d / 2")
    N_H = derived("rad/s^2", "yaw moment of the hull, over rho L^4 d / 2")

    @V.equals
    def speed(self):
        """Yasukawa and Yoshimura (2015), coordinate systems, but at least a twentieth of `cruise`: a hull that only turns has no r'."""
        return np.sqrt(np.maximum(self.u**2 + self.v**2, (LEAST_WAY * self.cruise) ** 2))

    @drift.equals
    def drift_angle(self):
        """Yasukawa and Yoshimura (2015), coordinate systems: atan(-v/u)."""
        return np.arctan(-self.v / np.maximum(self.u, LEAST_WAY * self.cruise))

    @property
    def dimensionless(self):
        """The motions v' and r': Yasukawa and Yoshimura (2015), forces on the hull."""
        return self.v / self.V, self.r * self.L / self.V

    @X_H.equals
    def surge_force(self):
        """Yasukawa and Yoshimura (2015), forces on the hull, first lines."""
        v, r = self.dimensionless
        # U^2 is u^2 + v^2, and u |u| keeps the resistance against the motion of a ship that moves astern.
        resistance = self.R_0_at_depth * (self.u * np.abs(self.u) + self.v**2)
        turning = self.X_vv * v**2 + self.X_vr * v * r + self.X_rr * r**2 + self.X_vvvv * v**4
        return (turning * self.V**2 - resistance) / self.L

    @Y_H.equals
    def sway_force(self):
        """Yasukawa and Yoshimura (2015), forces on the hull, second lines."""
        v, r = self.dimensionless
        linear = self.Y_v_at_depth * v + self.Y_r_at_depth * r
        cubic = self.Y_vvv * v**3 + self.Y_vvr * v**2 * r + self.Y_vrr * v * r**2 + self.Y_rrr * r**3
        return (linear + cubic) * self.V**2 / self.L

    @N_H.equals
    def yaw_moment(self):
        """Yasukawa and Yoshimura (2015), forces on the hull, third lines."""
        v, r = self.dimensionless
        linear = self.N_v_at_depth * v + self.N_r_at_depth * r
        cubic = self.N_vvv * v**3 + self.N_vvr_at_depth * v**2 * r + self.N_vrr_at_depth * v * r**2 + self.N_rrr * r**3
        return (linear + cubic) * (self.V / self.L) ** 2


mmg_revolutions = join("mmg-revolutions", MmgMotion, MmgHull, MmgPropeller, MmgRudder, DeepWater, PlanarMotion)
mmg = join("mmg", ConstantRevolutions, MmgMotion, MmgHull, MmgPropeller, MmgRudder, DeepWater, PlanarMotion)
mmg_shallow = join(
    "mmg-shallow", ShallowWater, ConstantRevolutions, MmgMotion, MmgHull, MmgPropeller, MmgRudder, PlanarMotion
)
