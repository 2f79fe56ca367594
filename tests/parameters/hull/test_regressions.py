"""Regressions of hull derivatives: closed forms, published derivatives beside them, scatter and range."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from shipid.parameters.hull.regressions import GYRATION, MARGIN, REGRESSIONS, derivatives_of, ranges, scatter_of
from shipid.parameters.hull.tested_hulls import TESTED_HULLS, Derivatives, HullForm

#: B/L = 0.2, B/T = 2, T/L = 0.1: the brackets of Clarke's regressions in round numbers.
ROUND = HullForm(100.0, 20.0, 10.0, 0.5)
BRACKETS = {"Y_v": 1.4, "Y_r": -0.22, "N_v": 0.74, "N_r": 0.216, "Y_vdot": 0.956, "N_rdot": 1 / 12 + 0.017 - 0.066}


@pytest.mark.parametrize(("name", "bracket"), BRACKETS.items())
def test_derivatives_of_round_proportions(name, bracket):
    assert getattr(derivatives_of(ROUND), name) == pytest.approx(-np.pi * 0.01 * bracket, rel=1e-12)


def test_derivatives_depend_on_proportions_alone():
    assert derivatives_of(HullForm(7.0, 1.4, 0.7, 0.5)) == derivatives_of(HullForm(56.0, 11.2, 5.6, 0.5))


@pytest.mark.parametrize("hull", TESTED_HULLS, ids=lambda h: h.name)
def test_published_derivatives_lie_about_the_regression(hull):
    for name, one in REGRESSIONS.items():
        published, estimated = one.value_of(hull.form, hull.derivatives), one.estimate(hull.form)
        assert abs(np.log(published / estimated)) < 2 * scatter_of(name), name


def test_kvlcc2_as_printed():
    """Yasukawa and Yoshimura (2015) print them over rho L T / 2."""
    hull = TESTED_HULLS[0]
    printed = {"Y_v": -0.315, "Y_r": 0.083, "N_v": -0.137, "N_r": -0.049}
    for name, value in printed.items():
        assert getattr(hull.derivatives, name) == pytest.approx(20.8 / 320 * value, rel=1e-9)


def test_another_regression_agrees():
    """Yoshimura and Masumoto (2012), over rho L T / 2, for KVLCC2: within the 6 % that the docstring states."""
    form = TESTED_HULLS[0].form
    k = 2 * form.T / form.L
    other = {"Y_v": -(np.pi / 2 * k + 1.4 * form.C_b * form.B / form.L), "N_v": -k, "N_r": -0.54 * k + k**2}
    for name, value in other.items():
        assert getattr(derivatives_of(form), name) == pytest.approx(value * form.T / form.L, rel=0.06)


def test_coefficients_over_masses_solve_the_equations_of_motion():
    form = HullForm(160.0, 24.0, 8.0, 0.7)
    d = Derivatives(-0.011, 0.003, -0.004, -0.002, -0.009, -0.0005, -1e-4, 2e-4, 0.02)
    m = 2 * 0.7 * 24 * 8 / 160**2
    masses = [[m - d.Y_vdot, m * d.x_G - d.Y_rdot], [m * d.x_G - d.N_vdot, m * (GYRATION**2 + d.x_G**2) - d.N_rdot]]
    (a, b), (c, e) = np.linalg.solve(masses, [[d.Y_v, d.Y_r - m], [d.N_v, d.N_r - m * d.x_G]])
    found = [REGRESSIONS[n].value_of(form, d) for n in ("q21", "r21", "q31", "r31")]
    assert found == pytest.approx([-a, b, c, -e], rel=1e-12)


def errors(name, **others):
    """Logarithms of published over estimated coefficients of the tested hulls, with other estimates beside Clarke's six."""
    found = []
    for h in TESTED_HULLS:
        scale, wide, deep = -np.pi * (h.form.T / h.form.L) ** 2, h.form.B / h.form.L, h.form.B / h.form.T
        estimated = dataclasses.replace(derivatives_of(h.form), **{n: scale * f(wide, deep) for n, f in others.items()})
        one = REGRESSIONS[name]
        found.append(np.log(one.value_of(h.form, h.derivatives) / one.value_of(h.form, estimated)))
    return np.array(found)


def test_scatter_is_that_of_the_tested_hulls():
    for name in REGRESSIONS:
        # Student's distribution with four degrees of freedom: the mean is known to be zero, the variance is that of four hulls.
        assert scatter_of(name) == pytest.approx(np.sqrt(np.mean(errors(name) ** 2) * 4 / 2), rel=1e-12)


def test_leaving_out_the_coupled_masses_scatters_less():
    """The shares that the docstring of `derivatives_of` states."""
    names = ("q21", "r21", "q31", "r31")
    left_out = [np.sqrt(np.mean(errors(n) ** 2)) for n in names]
    coupled = {"Y_rdot": lambda b, d: 0.67 * b - 0.0033 * d**2, "N_vdot": lambda b, d: 1.1 * b - 0.041 * d}
    taken_in = [np.sqrt(np.mean(errors(n, **coupled) ** 2)) for n in names]
    assert (round(min(left_out), 2), round(max(left_out), 2)) == (0.14, 0.19)
    assert (round(min(taken_in), 2), round(max(taken_in), 2)) == (0.18, 0.28)


def test_range_is_that_of_the_tested_hulls_and_a_tenth():
    low, high = ranges()["L/B"]
    assert low == pytest.approx((1 - MARGIN) * 320 / 58) and high == pytest.approx((1 + MARGIN) * 160.93 / 23.17)
    assert ranges()["C_b"] == pytest.approx((0.9 * 0.562, 1.1 * 0.831))
