"""Linear derivatives of a hull from its proportions, with the scatter and the range of the regression.

The formulas are those of Clarke, Gedling and Hine (1983), "The application of manoeuvring criteria in hull design using linear
theory", Transactions of RINA 125, 45-68: least squares on rotating-arm and planar-motion tests of many models. The scatter is
measured here, on the published derivatives of four ships (`TESTED_HULLS`), and the formulas are used only for proportions
near theirs. The regressions of Yoshimura and Masumoto (2012) give the same linear derivatives of KVLCC2 within 6 %. No regression
is used for cubic terms and drag: those that are published belong to other laws than the models here, or are cited with different
signs.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from shipid.parameters.hull.tested_hulls import TESTED_HULLS, Derivatives, HullForm

SOURCE = "Clarke, Gedling and Hine 1983"
#: Radius of gyration in yaw, in lengths.
GYRATION = 0.25
#: Share by which a proportion may lie outside those of the tested hulls.
MARGIN = 0.1
#: Proportions: what they are called, and how they follow.
PROPORTIONS: Mapping[str, Callable[[HullForm], float]] = {
    "L/B": lambda h: h.L / h.B,
    "B/T": lambda h: h.B / h.T,
    "C_b": lambda h: h.C_b,
}


def derivatives_of(form: HullForm) -> Derivatives:
    """Return the derivatives by the regression of Clarke, Gedling and Hine (1983).

    Their regressions of Y_rdot and N_vdot are left out, as is the place of the centre of gravity, which ships seldom state: with
    them the coefficients of the tested hulls scatter by 18 to 28 %, without them by 14 to 19 %.

    Parameters
    ----------
    form : HullForm
        The proportions.

    Returns
    -------
    Derivatives
    """
    scale = -math.pi * (form.T / form.L) ** 2
    wide, deep = form.B / form.L, form.B / form.T
    return Derivatives(
        Y_v=scale * (1 + 0.40 * form.C_b * deep),
        Y_r=scale * (-0.5 + 2.2 * wide - 0.080 * deep),
        N_v=scale * (0.5 + 2.4 * form.T / form.L),
        N_r=scale * (0.25 + 0.039 * deep - 0.56 * wide),
        Y_vdot=scale * (1 + 0.16 * form.C_b * deep - 5.1 * wide**2),
        N_rdot=scale * (1 / 12 + 0.017 * form.C_b * deep - 0.33 * wide),
    )


def _solved(form: HullForm, d: Derivatives) -> tuple[float, float, float, float]:
    """Accelerations in sway per v and r, then in yaw: the equations of motion solved for them, in the prime system."""
    m, x = form.mass, form.mass * d.x_G
    sway, yaw = m - d.Y_vdot, m * (GYRATION**2 + d.x_G**2) - d.N_rdot
    up, down = x - d.Y_rdot, x - d.N_vdot
    whole = sway * yaw - up * down
    force, moment = (d.Y_v, d.Y_r - m), (d.N_v, d.N_r - x)
    aside = [(yaw * f - up * n) / whole for f, n in zip(force, moment)]
    turning = [(sway * n - down * f) / whole for f, n in zip(force, moment)]
    return aside[0], aside[1], turning[0], turning[1]


@dataclass(frozen=True)
class HullRegression:
    """A coefficient that follows from the linear derivatives of a hull.

    Attributes
    ----------
    meaning : str
        What it is.
    value_of : callable
        The coefficient of a hull with these derivatives.
    """

    meaning: str
    value_of: Callable[[HullForm, Derivatives], float]

    def estimate(self, form: HullForm) -> float:
        """Return the coefficient by the regression.

        Parameters
        ----------
        form : HullForm
            The proportions of the hull.
        """
        return self.value_of(form, derivatives_of(form))


#: By name: derivatives in the prime system, and the coefficients of Pershitz (1973), which are divided by
#: masses that include the added ones.
REGRESSIONS: Mapping[str, HullRegression] = {
    "Y_v": HullRegression("sway force per sway speed, over rho L^2 / 2", lambda _, d: d.Y_v),
    "Y_r": HullRegression("sway force per rate of turn, over rho L^2 / 2", lambda _, d: d.Y_r),
    "N_v": HullRegression("yaw moment per sway speed, over rho L^2 / 2", lambda _, d: d.N_v),
    "N_r": HullRegression("yaw moment per rate of turn, over rho L^2 / 2", lambda _, d: d.N_r),
    "q21": HullRegression("sway force per drift angle, over mass", lambda h, d: -_solved(h, d)[0]),
    "r21": HullRegression("sway force per rate of turn, over mass", lambda h, d: _solved(h, d)[1]),
    "q31": HullRegression("yaw moment per drift angle, over moment of inertia", lambda h, d: _solved(h, d)[2]),
    "r31": HullRegression("yaw damping, over moment of inertia", lambda h, d: -_solved(h, d)[3]),
}


@functools.cache
def scatter_of(name: str) -> float:
    """Return the standard deviation of a regression about a single hull, as a share of its value.

    The root-mean-square of the logarithm of published over estimated, and more for the small number of hulls: the
    variance of Student's distribution with as many degrees of freedom.

    Parameters
    ----------
    name : str
        One of `REGRESSIONS`.

    Returns
    -------
    float
    """
    one = REGRESSIONS[name]
    errors = [math.log(one.value_of(h.form, h.derivatives) / one.estimate(h.form)) for h in TESTED_HULLS]
    count = len(errors)
    return math.sqrt(math.fsum(e * e for e in errors) / (count - 2))


@functools.cache
def ranges() -> dict[str, tuple[float, float]]:
    """Return the lowest and the highest value of each proportion for which the regression is used."""
    found = {}
    for name, read in PROPORTIONS.items():
        values = [read(h.form) for h in TESTED_HULLS]
        found[name] = (1 - MARGIN) * min(values), (1 + MARGIN) * max(values)
    return found
