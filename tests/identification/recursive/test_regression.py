"""The regression: what is derived from a declaration, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid import Component, given, join, parameter, state
from shipid.foundation.errors import UnknownNameError
from shipid.identification.recursive.errors import NonlinearParameterError, NoRegressionError
from shipid.identification.recursive.identifier import RecursiveIdentifier
from shipid.identification.recursive.regression import make_regression


def call(regression, y, theta, u0, u1, known, interval):
    system = regression.system
    arguments = (y, theta, *(system.vector(system.inputs, u, default=0.0) for u in (u0, u1)))
    p = system.vector(system.coefficients, known, default=0.0)
    return [np.asarray(a.full()).ravel() for a in regression.predict(*arguments, p, interval)]


def test_euler_s_step_of_the_yaw_is_the_regression_of_the_thesis():
    """Passenier (1989), eq. (5.4), (5.5): r + T (u/L) ((u/L) q delta - p r), linear in p and q."""
    regression = make_regression(shipid.find_model("yaw-filter"), integration="euler", hold="zero")
    assert (regression.output, regression.names) == ("r", ("a", "b1"))
    assert set(regression.needed) == {"delta", "u", "cruise", "r_disturbance"}
    now = {"delta": 0.2, "u": 8.0, "cruise": 9.0, "r_disturbance": 1e-5}
    ahead, by_r, by_theta = call(regression, 0.01, [0.9, 0.6], now, now, {"L": 200.0}, 2.0)
    pace = 8.0 / 200.0
    assert ahead == pytest.approx(0.01 + 2.0 * (pace**2 * 0.9 * 0.2 - pace * 0.6 * 0.01 + 1e-5), rel=1e-14)
    assert by_r == pytest.approx(1 - 2.0 * pace * 0.6, rel=1e-14)
    assert by_theta == pytest.approx([2.0 * pace**2 * 0.2, -2.0 * pace * 0.01], rel=1e-14)


def test_runge_kutta_s_step_has_the_exact_response_and_its_derivatives():
    """At constant speed and rudder the rate of turn is known in closed form, and so is how it depends on p and q."""
    regression = make_regression(shipid.find_model("yaw-filter"))
    now = {"delta": 0.2, "u": 8.0, "cruise": 8.0, "r_disturbance": 0.0}
    p, q, pace, interval, r = 0.6, 0.9, 0.04, 2.0, 0.01
    ahead, by_r, by_theta = call(regression, r, [q, p], now, now, {"L": 200.0}, interval)
    decay, steady = np.exp(-interval * pace * p), pace * q / p * 0.2
    # The fifth order of T u p/L, 0.05, is what Runge and Kutta leave out.
    assert ahead == pytest.approx(decay * r + (1 - decay) * steady, rel=1e-7)
    assert by_r == pytest.approx(decay, rel=1e-7)
    by_p = interval * pace * decay * (steady - r) - (1 - decay) * steady / p
    assert by_theta == pytest.approx([(1 - decay) * steady / q, by_p], rel=1e-5)


def test_with_no_time_between_samples_nothing_moves(first_order):
    for model, known, inputs in (
        (first_order, {}, {"v": 1.0}),
        (shipid.find_model("yaw-filter"), {"L": 200.0}, {"delta": 0.2, "u": 8.0, "cruise": 8.0, "r_disturbance": 0.0}),
    ):
        ahead, by_y, by_theta = call(make_regression(model), 0.3, [0.6, 0.9], inputs, inputs, known, 0.0)
        assert (ahead, by_y) == (0.3, 1.0) and not by_theta.any()


def test_the_cubic_is_linear_in_its_three_parameters():
    regression = make_regression(shipid.find_model("cubic"))
    assert regression.output == "r" and regression.names == ("a", "b1", "b3")


def test_other_states_are_what_the_record_holds():
    """De Keizer's speed is a state, and for the regression of the rate of turn an input."""
    regression = make_regression(shipid.find_model("de-keizer"), "r", ["K"])
    assert (
        regression.system.states == ("r", "K") and "u" in regression.needed and "gamma" not in regression.coefficients
    )


def test_a_parameter_that_enters_nonlinearly_is_named_with_what_to_do():
    with pytest.raises(
        NonlinearParameterError, match=r"'tau' enters the equation of 'r' \(.*de_keizer\.py:\d+\) nonlin"
    ) as e:
        make_regression(shipid.find_model("de-keizer"), "r")
    assert "together with K" in str(e.value) and "1/tau and K/tau" in str(e.value) and "'ekf'" in str(e.value)
    # One of two that multiply each other is linear alone; the filter linearises.
    assert make_regression(shipid.find_model("nomoto"), estimate=["K"]).names == ("K",)
    assert make_regression(shipid.find_model("nomoto"), linear=False).names == ("K", "tau")
    assert RecursiveIdentifier("nomoto", "soesterberg", method="ekf", measured={"r": "0.02 deg/s"}).names == (
        "K",
        "tau",
    )


def test_two_states_leave_the_choice_to_the_user():
    with pytest.raises(NoRegressionError, match=r"the parameters move r, u.*measured=\{'r'"):
        make_regression(shipid.find_model("de-keizer"))


def test_a_parameter_of_another_equation_is_refused():
    with pytest.raises(NoRegressionError, match="'gamma' does not enter the equation of 'r', which reads a, b1, b3"):
        make_regression(shipid.find_model("cubic"), "r", ["gamma"])


def test_a_state_without_parameters_is_refused():
    with pytest.raises(NoRegressionError, match="the equation of 'psi' reads no parameter"):
        make_regression(shipid.find_model("nomoto"), "psi")


def test_unknown_names_are_refused():
    with pytest.raises(UnknownNameError, match="there is no parameter of model nomoto to estimate called 'kay'"):
        make_regression(shipid.find_model("nomoto"), estimate=["kay"])
    with pytest.raises(UnknownNameError, match="there is no state of model nomoto to regress called 'q'"):
        make_regression(shipid.find_model("nomoto"), "q")


def test_a_model_that_no_parameter_moves_is_refused():
    class Still(Component):
        """Nothing to estimate."""

        y = state("1", "output")
        v = given("1", "input")
        c = parameter("1/s", "a gain that is never estimated", start=1.0, low=0.0, high=2.0, estimated=False)

        @y.rate
        def motion(self):
            """Nobody (1989)."""
            return self.c * self.v

    with pytest.raises(NoRegressionError, match="no state is moved by the parameters"):
        make_regression(join("still", Still))


def test_what_is_zero_everywhere_does_not_count_as_nonlinear():
    """A product that cancels has a place in the sparsity pattern of the second derivative, and no value."""

    class Cancelling(Component):
        """(a + 1)^2 - a^2 - 1 is 2 a."""

        y = state("1", "output")
        a = parameter("1", "pole", start=0.4, low=-1, high=1)

        @y.next
        def motion(self):
            """Nobody (1989)."""
            return ((self.a + 1) ** 2 - self.a**2 - 1) * self.y

    regression = make_regression(join("cancelling", Cancelling))
    assert regression.names == ("a",)


def test_a_state_that_only_noise_moves_stays_at_its_start():
    """The wind of the yaw filter is a state of it; a regression takes none, unless the record holds it."""
    model = make_regression(shipid.find_model("yaw-filter")).system.model
    assert model["r_disturbance"].number("default") == 0.0 and model["psi"].number("default") is None
