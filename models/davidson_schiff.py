"""The linear model of sway and yaw of Davidson and Schiff, in hydrodynamic derivatives.

Davidson and Schiff (1946), as in Passenier (1989), eq. (2.20)-(2.21), with the terms of a centre of gravity that does
not lie amidships added. The derivatives are in the prime system: forces divided by (rho/2) L^2 U^2, masses by
(rho/2) L^3, speeds by U, rates by U/L. They count the rudder positive to port; delta = -delta' by (2.23).
"""

from __future__ import annotations

from shipid import Component, constant, derived, given, join, parameter, state
from shipid.parts.planar_motion import PlanarMotion


class DavidsonSchiff(Component):
    """Sway and yaw at constant forward speed.

    Y_r and N_r do not contain the centrifugal terms -m and -m x_G; published tables often do.
    """

    v = state("m/s", "sway speed through the water, positive to starboard", nominal=0.5)
    r = state("rad/s", "rate of turn, positive to starboard", nominal="0.5 deg/s")
    delta = given("rad", "rudder angle, positive turns to starboard", latex=r"\delta")
    u = given("m/s", "forward speed through the water")
    r_disturbance = given("rad/s^2", "yaw acceleration by wind or another disturbance", default=0.0, latex=r"\dot r_d")
    L = constant("m", "length between perpendiculars")
    Y_v = parameter("1", "sway force per sway speed", start=-0.012, low=-0.2, high=0.0, latex="Y_v'")
    Y_r = parameter("1", "sway force per rate of turn", start=0.003, low=-0.1, high=0.1, latex="Y_r'")
    Y_delta = parameter(
        "1", "sway force per rudder angle to port", start=0.003, low=0.0, high=0.05, latex=r"Y_{\delta'}'"
    )
    N_v = parameter("1", "yaw moment per sway speed", start=-0.003, low=-0.1, high=0.05, latex="N_v'")
    N_r = parameter("1", "yaw moment per rate of turn", start=-0.002, low=-0.1, high=0.05, latex="N_r'")
    N_delta = parameter(
        "1", "yaw moment per rudder angle to port", start=-0.0014, low=-0.05, high=0.0, latex=r"N_{\delta'}'"
    )
    m = parameter("1", "mass", start=0.008, low=0.001, high=0.1, estimated=False, latex="m'")
    I_z = parameter("1", "moment of inertia about the yaw axis", start=4e-4, low=1e-5, high=0.01, estimated=False)
    x_G = parameter(
        "1", "centre of gravity ahead of amidships, in ship lengths", start=0.0, low=-0.2, high=0.2, estimated=False
    )
    Y_vdot = parameter(
        "1",
        "added mass in sway (negative)",
        start=-0.0075,
        low=-0.1,
        high=0.0,
        estimated=False,
        latex=r"Y_{\dot v}'",
    )
    Y_rdot = parameter(
        "1",
        "sway force per yaw acceleration",
        start=0.0,
        low=-0.01,
        high=0.01,
        estimated=False,
        latex=r"Y_{\dot r}'",
    )
    N_vdot = parameter(
        "1",
        "yaw moment per sway acceleration",
        start=0.0,
        low=-0.01,
        high=0.01,
        estimated=False,
        latex=r"N_{\dot v}'",
    )
    N_rdot = parameter(
        "1",
        "added moment of inertia (negative)",
        start=-4e-4,
        low=-0.01,
        high=0.0,
        estimated=False,
        latex=r"N_{\dot r}'",
    )

    Y = derived("1", "sway force less the centrifugal force", latex="Y'")
    N = derived("1", "yaw moment less the centrifugal moment", latex="N'")

    @property
    def mass_matrix(self):
        """The four entries of the mass matrix, rows sway and yaw."""
        coupling = self.m * self.x_G
        return self.m - self.Y_vdot, coupling - self.Y_rdot, coupling - self.N_vdot, self.I_z - self.N_rdot

    @property
    def motion(self):
        """The sway speed, the rate of turn and the rudder angle of the derivatives, in the prime system."""
        return self.v / self.u, self.r * self.L / self.u, -self.delta

    @Y.equals
    def sway_force(self):
        """Passenier (1989), eq. (2.20), the right side less m u r, with (2.23)."""
        v, r, rudder = self.motion
        return self.Y_v * v + (self.Y_r - self.m) * r + self.Y_delta * rudder

    @N.equals
    def yaw_moment(self):
        """Passenier (1989), eq. (2.21), the right side less m x_G u r, with (2.23)."""
        v, r, rudder = self.motion
        return self.N_v * v + (self.N_r - self.m * self.x_G) * r + self.N_delta * rudder

    @v.rate
    def sway(self):
        """Passenier (1989), eq. (2.20) and (2.21) solved for the acceleration, in prime form."""
        vv, vr, rv, rr = self.mass_matrix
        return self.u**2 / self.L * (rr * self.Y - vr * self.N) / (vv * rr - vr * rv)

    @r.rate
    def yaw(self):
        """Passenier (1989), eq. (2.20) and (2.21) solved for the acceleration, in prime form."""
        vv, vr, rv, rr = self.mass_matrix
        turning = (vv * self.N - rv * self.Y) / (vv * rr - vr * rv)
        return (self.u / self.L) ** 2 * turning + self.r_disturbance


davidson_schiff = join("davidson-schiff", DavidsonSchiff, PlanarMotion)
