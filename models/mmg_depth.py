"""The depth of the water in the MMG model: deep, or shallow with a flat bottom and without banks.

In shallow water, what is known in deep water is multiplied by the ratio of regressions at the depth h and in deep water. Linear
derivatives: the effective aspect ratio of Hirano, Takashina, Moriya and Nakamura (1985) in the regressions of Yoshimura and
Masumoto (2012). Added masses: Sheng (1981). Resistance: Furukawa, Ibaragi, Nakiri and Kijima (2016). The damping of the yaw by
drift and rate together: as in Tang, Zhang and Wang (2020), who use all of them. The other derivatives, wake, thrust deduction and
the flow at the rudder stay those of deep water. So this is the first effect of depth and no more: the circle of KVLCC2 at 35 degrees
grows from 3.1 to 4.3 lengths at 1.2 draughts, and no measured circle was compared.
"""

from __future__ import annotations

import numpy as np

from shipid import Component, constant, derived, given, guard

#: Depth over draught down to which the correction is used; below, water is very shallow (PIANC 1992).
SHALLOWEST = 1.2


class AnyDepth(Component):
    """What the depth of the water changes; it states nothing itself."""

    R_0 = given("1", "resistance ahead in deep water", latex="R_0'")
    Y_v = given("1", "sway force per v in deep water", latex="Y_v'")
    Y_r = given("1", "sway force per r in deep water", latex="Y_r'")
    N_v = given("1", "yaw moment per v in deep water", latex="N_v'")
    N_r = given("1", "yaw moment per r in deep water", latex="N_r'")
    N_vvr = given("1", "yaw moment per v^2 r in deep water", latex="N_{vvr}'")
    N_vrr = given("1", "yaw moment per v r^2 in deep water", latex="N_{vrr}'")
    m_y = given("1", "added mass in sway in deep water", latex="m_y'")
    J_z = given("1", "added moment of inertia in yaw in deep water", latex="J_z'")


class DeepWater(AnyDepth):
    """Water so deep that the bottom is not felt: more than about three draughts (PIANC 1992)."""

    R_0_at_depth = derived("1", "resistance ahead at the depth of the water", latex="R_0'(h)")
    Y_v_at_depth = derived("1", "sway force per v at the depth of the water", latex="Y_v'(h)")
    Y_r_at_depth = derived("1", "sway force per r at the depth of the water", latex="Y_r'(h)")
    N_v_at_depth = derived("1", "yaw moment per v at the depth of the water", latex="N_v'(h)")
    N_r_at_depth = derived("1", "yaw moment per r at the depth of the water", latex="N_r'(h)")
    N_vvr_at_depth = derived("1", "yaw moment per v^2 r at the depth of the water", latex="N_{vvr}'(h)")
    N_vrr_at_depth = derived("1", "yaw moment per v r^2 at the depth of the water", latex="N_{vrr}'(h)")
    m_y_at_depth = derived("1", "added mass in sway at the depth of the water", latex="m_y'(h)")
    J_z_at_depth = derived("1", "added moment of inertia in yaw at the depth of the water", latex="J_z'(h)")

    @R_0_at_depth.equals
    def at_depth_R_0(self):
        """Yasukawa and Yoshimura (2015): as measured in deep water."""
        return self.R_0

    @Y_v_at_depth.equals
    def at_depth_Y_v(self):
        """Yasukawa and Yoshimura (2015): as measured in deep water."""
        return self.Y_v

    @Y_r_at_depth.equals
    def at_depth_Y_r(self):
        """Yasukawa and Yoshimura (2015): as measured in deep water."""
        return self.Y_r

    @N_v_at_depth.equals
    def at_depth_N_v(self):
        """Yasukawa and Yoshimura (2015): as measured in deep water."""
        return self.N_v

    @N_r_at_depth.equals
    def at_depth_N_r(self):
        """Yasukawa and Yoshimura (2015): as measured in deep water."""
        return self.N_r

    @N_vvr_at_depth.equals
    def at_depth_N_vvr(self):
        """Yasukawa and Yoshimura (2015): as measured in deep water."""
        return self.N_vvr

    @N_vrr_at_depth.equals
    def at_depth_N_vrr(self):
        """Yasukawa and Yoshimura (2015): as measured in deep water."""
        return self.N_vrr

    @m_y_at_depth.equals
    def at_depth_m_y(self):
        """Yasukawa and Yoshimura (2015): as measured in deep water."""
        return self.m_y

    @J_z_at_depth.equals
    def at_depth_J_z(self):
        """Yasukawa and Yoshimura (2015): as measured in deep water."""
        return self.J_z


class ShallowWater(DeepWater):
    """Hull, propeller and rudder (MMG standard method) above a flat bottom, in water not less than 1.2 draughts deep."""

    L = constant("m", "length between perpendiculars")
    B = constant("m", "breadth")
    T = constant("m", "draught", latex="d")
    nabla = constant("m^3", "volume of the displacement", latex=r"\nabla")
    depth = constant("m", "depth of the water", latex="h")
    deep_enough = guard("m", "the water is less than 1.2 draughts deep, where the correction for shallow water ends")

    @property
    def draught_over_depth(self):
        """Draught over depth, kept below 1: a ship aground is not sailed, and `deep_enough` says so."""
        return np.minimum(self.T / self.depth, 0.99)

    def aspect(self, power):
        """Effective aspect ratio over that in deep water: Hirano et al. (1985).

        Parameters
        ----------
        power : {0.7, 1.7, 2.3}
            For the derivatives by r, N_v and Y_v.
        """
        half = self.draught_over_depth / 2
        angle = np.pi * half
        return 1 / (half + (angle / np.tan(angle)) ** power)

    @property
    def slenderness(self):
        """The aspect ratio in deep water, 2 d/L: Yoshimura and Masumoto (2012)."""
        return 2 * self.T / self.L

    @deep_enough.equals
    def keel_clearance(self):
        """The range in which the correction is used."""
        return self.depth - SHALLOWEST * self.T

    def at_depth_R_0(self):
        """Furukawa et al. (2016)."""
        return self.R_0 * (1 + 0.388 * self.draught_over_depth**2)

    def at_depth_Y_v(self):
        """Yoshimura and Masumoto (2012), pi k/2 + 1.4 C_b B/L, with the k of Hirano et al. (1985)."""
        fullness = 1.4 * self.nabla / (self.L**2 * self.T)
        k = np.pi / 2 * self.slenderness
        return self.Y_v * (k * self.aspect(2.3) + fullness) / (k + fullness)

    def at_depth_Y_r(self):
        """Hirano et al. (1985): in proportion to k."""
        return self.Y_r * self.aspect(0.7)

    def at_depth_N_v(self):
        """Yoshimura and Masumoto (2012), k, with that of Hirano et al. (1985)."""
        return self.N_v * self.aspect(1.7)

    def at_depth_N_r(self):
        """Yoshimura and Masumoto (2012), 0.54 k - k^2, with the k of Hirano et al. (1985)."""
        deep, here = self.slenderness, self.slenderness * self.aspect(0.7)
        return self.N_r * (0.54 * here - here**2) / (0.54 * deep - deep**2)

    def at_depth_N_vvr(self):
        """Tang et al. (2020)."""
        return self.N_vvr * (1 + 6 * self.draught_over_depth**2.5)

    def at_depth_N_vrr(self):
        """Tang et al. (2020)."""
        return self.N_vrr * (1 + 6 * self.draught_over_depth**2.5)

    def at_depth_m_y(self):
        """Sheng (1981); it goes to 1 as the depth grows."""
        ratio = self.B / self.T
        return self.m_y * (1 + (0.413 + 0.032 * ratio + 0.0129 * ratio**2) / self.clearance)

    def at_depth_J_z(self):
        """Sheng (1981); it goes to 1 as the depth grows."""
        ratio = self.B / self.T
        return self.J_z * (1 + (0.413 + 0.0192 * ratio + 0.00554 * ratio**2) / self.clearance)

    @property
    def clearance(self):
        """(h/d - 1)^0.82 of Sheng (1981)."""
        return (1 / self.draught_over_depth - 1) ** 0.82
