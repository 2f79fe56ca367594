"""Motion of other ships: exact steps, and slopes through zero turn rate."""

import numpy as np
import pytest
from scipy.linalg import expm

import shipid
from shipid.generation.step import make_step
from shipid.models import coordinated_turn, coordinated_turn_augmented, turning_at_unknown_rate
from shipid.models.plot_motion import SMALL_TURN

STATE = np.array([120.0, -40.0, 9.0, 4.0])


def step_of(model):
    """The generated step over one interval, as a function of state, inputs and interval."""
    system = shipid.generate(model)
    function = make_step(system, hold="zero").function
    p = system.vector(system.coefficients, {})

    def step(x, T=3.0, **given):
        u = system.vector(system.inputs, given, default=0.0)
        return function(x, u, u, p, T)

    return system, step, function


@pytest.mark.parametrize("rate", [0.0, 1e-12, -1e-6, 0.016, SMALL_TURN / 3 - 1e-9, SMALL_TURN / 3 + 1e-9, -0.1, 0.7])
def test_a_turn_is_the_matrix_exponential(rate):
    _, step, _ = step_of(coordinated_turn)
    flow = np.zeros((4, 4))
    flow[0, 2] = flow[1, 3] = 1.0
    flow[2, 3], flow[3, 2] = -rate, rate
    assert step(STATE, omega=rate).full().ravel() == pytest.approx(expm(3.0 * flow) @ STATE, abs=1e-11)


@pytest.mark.parametrize("rate", [0.0, 1e-9, -1e-4, 0.016, SMALL_TURN / 3, -SMALL_TURN / 3, 0.1, -0.7])
@pytest.mark.parametrize("model", [turning_at_unknown_rate, coordinated_turn_augmented])
def test_the_jacobian_equals_differences_through_zero_turn_rate(model, rate):
    system, step, function = step_of(model)
    x = np.array([*STATE, rate])
    u = system.vector(system.inputs, {}, default=0.0)
    p = system.vector(system.coefficients, {})
    slope = function.jacobian()(x, u, u, p, 3.0, np.zeros(5))[0].full()
    # Richardson's difference; its error is of the fourth order in h.
    differences = np.empty((5, 5))
    for j in range(5):

        def central(h, j=j):
            e = np.zeros(5)
            e[j] = h
            return (step(x + e) - step(x - e)).full().ravel() / (2 * h)

        h = 1e-3 if j == 4 else 1.0
        differences[:, j] = (4 * central(h / 2) - central(h)) / 3
    assert slope == pytest.approx(differences, rel=1e-8, abs=1e-8)


def test_a_steady_turn_comes_round():
    _, step, _ = step_of(turning_at_unknown_rate)
    x = np.array([*STATE, 2 * np.pi / 120])
    for _ in range(40):
        x = step(x).full().ravel()
    assert x[:4] == pytest.approx(STATE, abs=1e-9)
    quarter = np.array([0.0, 0.0, 5.0, 0.0, np.pi / 2 / 3])
    east = step(quarter).full().ravel()
    # A positive rate turns to starboard: from north to east.
    assert east[2:4] == pytest.approx([0.0, 5.0], abs=1e-12)


def test_speed_and_course_over_the_ground():
    system = shipid.generate(coordinated_turn)
    shown = system.function(["SOG", "COG"])
    u = system.vector(system.inputs, {}, default=0.0)
    assert shown(np.array([0, 0, -3.0, 4.0]), u, []).full().ravel() == pytest.approx([5.0, np.arctan2(4, -3)])
