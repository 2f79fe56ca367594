"""Hulls whose linear derivatives are published: what the scatter of a regression is measured on.

Derivatives are in the prime system (L, U and rho L^2 / 2), about midship, with sway, rate of turn, side force and moment positive
to starboard. The centrifugal terms -m and -m x_G are not in them.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class HullForm:
    """The proportions of a hull that regressions read.

    Attributes
    ----------
    L, B, T : float
        Length between perpendiculars, beam and draught in m.
    C_b : float
        Block coefficient.
    """

    L: float
    B: float
    T: float
    C_b: float

    @property
    def mass(self) -> float:
        """Mass in the prime system: 2 C_b B T / L^2."""
        return 2 * self.C_b * self.B * self.T / self.L**2


@dataclass(frozen=True)
class Derivatives:
    """Linear sway and yaw derivatives of a hull in the prime system; added masses are negative.

    Attributes
    ----------
    Y_v, Y_r, N_v, N_r : float
        Force and moment per sway speed and rate of turn.
    Y_vdot, N_rdot : float
        Force per sway acceleration, and moment per yaw acceleration.
    Y_rdot, N_vdot : float
        Force per yaw acceleration, and moment per sway acceleration.
    x_G : float
        Centre of gravity before midship, in lengths.
    """

    Y_v: float
    Y_r: float
    N_v: float
    N_r: float
    Y_vdot: float
    N_rdot: float
    Y_rdot: float = 0.0
    N_vdot: float = 0.0
    x_G: float = 0.0


@dataclass(frozen=True)
class TestedHull:
    """A hull with its published derivatives.

    Attributes
    ----------
    name : str
        The ship.
    form : HullForm
        Its proportions.
    derivatives : Derivatives
        As published.
    source : str
        Where they are published.
    """

    name: str
    form: HullForm
    derivatives: Derivatives
    source: str


#: Two bare hulls (KVLCC2 and the container ship) and two ships with rudder and propeller (Mariner in captive tests, the Esso Osaka
#: in her trials at sea): what rudder and propeller add is a part of the scatter.
TESTED_HULLS = (
    # Printed over rho L T / 2, here times T/L = 0.065.
    TestedHull(
        "KVLCC2",
        HullForm(320.0, 58.0, 20.8, 0.810),
        Derivatives(-0.020475, 0.005395, -0.008905, -0.003185, -0.014495, -0.000715, x_G=0.0348),
        "Yasukawa and Yoshimura (2015)",
    ),
    # Printed with the centrifugal terms, which are taken out here.
    TestedHull(
        "Mariner",
        HullForm(160.93, 23.17, 7.47, 0.60),
        Derivatives(-0.0116, 0.00299, -0.00264, -0.0018435, -0.00748, -0.000438, -9.354e-5, 4.646e-5, -0.023),
        "Chislett and Stroem-Tejsen (1965)",
    ),
    TestedHull(
        "container ship of 175 m",
        HullForm(175.0, 25.4, 8.5, 0.562),
        Derivatives(-0.0116, 0.00242, -0.0038545, -0.00222, -0.007049, -0.000419),
        "Son and Nomoto (1982)",
    ),
    # Printed are m = 0.0181, m - Y_vdot = 0.0352 and I_z - N_rdot = 0.00222; I_z is m/16 here.
    TestedHull(
        "Esso Osaka",
        HullForm(325.0, 53.0, 21.73, 0.831),
        Derivatives(-0.0261, 0.00365, -0.0105, -0.0048, -0.0171, -0.00108875, x_G=0.0317),
        "Abkowitz (1980)",
    ),
)
