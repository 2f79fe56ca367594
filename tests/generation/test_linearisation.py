"""Linear models and steady motions, against closed forms, differences and python-control."""

from typing import Any

import numpy as np
import pytest

from shipid import Component, augment, constant, find_model, find_ship, given, join, linearise, state
from shipid.foundation.errors import DeclarationError, UnknownNameError, UsageError
from shipid.generation.linearisation import NoSteadyStateError, find_steady_state
from shipid.generation.system import generate
from shipid.models import PlanarMotion
from shipid.parts.steering_machine import SteeringMachine


def container(model: str = "de-keizer", **changed: float) -> dict[str, float]:
    return find_ship("soesterberg").values(find_model(model), speed=9.5) | {"cruise": 9.5, "u": 9.5} | changed


def test_a_and_b_against_differences(continuous: Any, plain: Any, rng: Any) -> None:
    """Central differences of the equations over floats; 1e-6 of the largest entry of a row is what they can show."""
    model, point = continuous.model, continuous.random(rng)
    linear = linearise(model, point)
    for matrix, names in ((linear.A, model.states), (linear.B, model.inputs)):
        scaled, measured = np.zeros(matrix.shape), np.zeros(matrix.shape)
        for j, name in enumerate(names):
            step = 1e-5 * (abs(point[name]) or 1.0)
            ahead, behind = (plain(model, point | {name: point[name] + s * step}, "rate") for s in (1, -1))
            measured[:, j] = [(ahead[n] - behind[n]) / 2e-5 for n in model.states]
            scaled[:, j] = matrix[:, j] * step / 1e-5
        size = np.abs(plain_row(plain, model, point)) + np.abs(scaled).max(axis=1)
        assert (np.abs(scaled - measured).max(axis=1) <= 1e-6 * size).all()


def plain_row(plain: Any, model: Any, point: dict[str, float]) -> np.ndarray:
    rates = plain(model, point, "rate")
    return np.array([rates[s] for s in model.states])


def test_outputs() -> None:
    """The sway of De Keizer's container is -gamma L r; a ship that reads its rudder back feeds it through."""
    linear = linearise(find_model("de-keizer"), container(), ["r", "u"], ["delta"], ["v", "r", "delta"])
    assert linear.A.shape == (2, 2)
    np.testing.assert_allclose(linear.C, [[-0.573 * 226, 0], [1, 0], [0, 0]], rtol=1e-14)
    assert linear.D.ravel().tolist() == [0, 0, 1]
    assert (linear.states, linear.inputs, linear.outputs) == (("r", "u"), ("delta",), ("v", "r", "delta"))


def test_poles_of_nomoto() -> None:
    linear = linearise(find_model("nomoto"), {"K": 0.185, "tau": 107.3, "u": 7.7}, ["r"], ["delta"])
    np.testing.assert_allclose(linear.poles, [-1 / 107.3], rtol=1e-15)
    second = {"K": 0.185, "tau1": 118.0, "tau2": 7.8, "tau3": 18.5, "u": 7.7}
    linear = linearise(find_model("nomoto-second-order"), second, ["r", "w"], ["delta"])
    np.testing.assert_allclose(linear.poles, [-1 / 118.0, -1 / 7.8], rtol=1e-12)
    # K (1 + tau3 s) / ((1 + tau1 s)(1 + tau2 s))
    system, s = linear.to_state_space(), 0.03j
    wanted = 0.185 * (1 + 18.5 * s) / ((1 + 118 * s) * (1 + 7.8 * s))
    assert system(s)[0, 0] == pytest.approx(wanted, rel=1e-12)


def test_de_keizers_poles_in_a_steady_turn() -> None:
    """By hand, in ship lengths: with q = K delta and loss s = K_u q^2, the matrix of (r*, u*)."""
    rudder, values = 0.2, container(delta=0.2)
    found = find_steady_state(find_model("de-keizer"), values)
    linear = linearise(find_model("de-keizer"), values | found, ["r", "u"], ["delta"])
    k, tau, k_u, tau_u = (values[n] for n in ("K", "tau", "K_u", "tau_u"))
    q = k * rudder
    loss = k_u * q**2
    pace = 9.5 * (1 - loss) / 226
    # r' = (u/L)^2 (K delta - r L/u)/tau and u' = -U0 (u/L) (K_u (r L/u)^2 - (U0-u)/U0)/tau_u, in r*L/u and u/u0
    a = pace / tau * np.array([[-1.0, q], [0, 0]])
    a[1] = pace / tau_u * np.array([-2 * k_u * q / (1 - loss), 2 * loss / (1 - loss) - 1])
    np.testing.assert_allclose(linear.poles, np.sort_complex(np.linalg.eigvals(a))[::-1], rtol=1e-10)


def test_python_control_linearises_alike() -> None:
    """Its differences are one-sided with a step of 1e-6, so it agrees to about 1e-6 of the rates' curvature."""
    import control

    model, values = find_model("de-keizer"), container(delta=0.2)
    system = generate(model)
    p = system.vector(system.coefficients, values)
    right = system.right_hand_side
    theirs = control.nlsys(
        lambda t, x, u, params: right(x, u, p).full().ravel(),
        None,
        inputs=list(system.inputs),
        states=list(system.states),
        outputs=list(system.states),
    )
    found = find_steady_state(model, values)
    at = list(found.values())
    reference = control.linearize(theirs, at, system.vector(system.inputs, values))
    ours = linearise(model, values | found).to_state_space()
    assert ours.state_labels == list(model.states)
    assert ours.input_labels == list(model.inputs)
    assert ours.output_labels == list(model.states)
    for name in "ABCD":
        ours_block, theirs_block = getattr(ours, name), getattr(reference, name)
        np.testing.assert_allclose(ours_block, theirs_block, atol=2e-6 * max(1, np.abs(ours_block).max()))


@pytest.mark.parametrize("rudder", [-0.2, 0.05, 0.3])
def test_de_keizers_steady_turn(rudder: float) -> None:
    values = container(delta=rudder)
    found = find_steady_state(find_model("de-keizer"), values)
    q = values["K"] * rudder
    assert 1 - found["u"] / 9.5 == pytest.approx(values["K_u"] * q**2, rel=1e-9)
    assert found["r"] * 226 / found["u"] == pytest.approx(q, rel=1e-9)
    assert (found["x"], found["y"], found["psi"]) == (0, 0, 0)


def test_the_distance_sailed_does_not_have_to_come_to_rest() -> None:
    values = container("van-leeuwen", delta=0.2)
    found = find_steady_state(find_model("van-leeuwen"), values)
    assert found["r_star"] == pytest.approx(values["K"] * 0.2, rel=1e-12)
    assert found["u_star"] == pytest.approx(values["K_u"] * (values["K"] * 0.2) ** 2, rel=1e-12)


def test_nomoto_norrbin_and_pershitz_turn_steadily() -> None:
    found = find_steady_state(find_model("nomoto"), container("nomoto", delta=0.1))
    assert found["r"] == pytest.approx(0.1 * 9.5 / 226 * 1.6, rel=1e-6)  # the file rounds K to six digits
    cubic = find_steady_state(find_model("norrbin"), {"a": 0.001, "b1": 0.02, "b3": 50.0, "delta": 0.3, "u": 5.0})
    assert 0.02 * cubic["r"] + 50.0 * cubic["r"] ** 3 == pytest.approx(0.0003, rel=1e-9)
    pershitz = find_model("pershitz")
    values = find_ship("semerdjiev").values(pershitz) | {"cruise": 30.0, "delta": np.pi / 6, "omega": 0.1, "beta": 0.3}
    assert find_steady_state(pershitz, values)["omega"] / 30 == pytest.approx(0.0046466, abs=5e-8)


def test_augmented_parameters_stay_where_they_are() -> None:
    model = augment(find_model("nomoto"), ["K", "tau"])
    values = container("nomoto", delta=0.1) | {"unit_K": 1.0, "unit_tau": 1.0, "log_K": -2.5, "log_tau": 3.7}
    found = find_steady_state(model, values)
    assert (found["log_K"], found["log_tau"]) == (-2.5, 3.7)
    assert found["r"] == pytest.approx(np.exp(-2.5) * 0.1, rel=1e-12)


def test_a_ship_of_coordinates_alone_is_always_steady() -> None:
    assert find_steady_state(join("path", PlanarMotion), {"u": 5.0, "r": 0.1, "psi": 1.0})["psi"] == 1.0


def test_no_steady_motion() -> None:
    """What pushes harder the faster it goes never settles: thrust + k u^2 has no zero."""

    class Rocket(Component):
        u = state("m/s", "speed")
        thrust = given("m/s^2", "acceleration")
        k = constant("1/m", "gain")

        @u.rate
        def gather(self) -> Any:
            """Made up."""
            return self.thrust + self.k * self.u**2

    with pytest.raises(NoSteadyStateError, match="no steady motion near the given start") as caught:
        find_steady_state(join("rocket", Rocket), {"thrust": 0.5, "k": 0.1})
    assert caught.value.exit_code == 4


def test_what_linearising_refuses() -> None:
    nomoto = find_model("nomoto")
    with pytest.raises(DeclarationError, match="'K' of model nomoto has no value"):
        linearise(nomoto, {})
    values = {"K": 0.1, "tau": 10.0}
    with pytest.raises(UnknownNameError, match="state of model nomoto called 'q'"):
        linearise(nomoto, values, states=["q"])
    with pytest.raises(UnknownNameError, match="input of model nomoto called 'rudder'"):
        linearise(nomoto, values, inputs=["rudder"])
    with pytest.raises(UnknownNameError, match="called 'q'"):
        linearise(nomoto, values, outputs=["q"])
    with pytest.raises(DeclarationError, match="is sampled"):
        linearise(find_model("pershitz-discrete"), {})


def test_a_helmsman_cannot_be_linearised() -> None:
    from shipid.parts.helm import ZigzagHelm

    whole = join("helmed", find_model("nomoto"), SteeringMachine, ZigzagHelm)
    with pytest.raises(DeclarationError, match="helm_clock, helm_side is sampled"):
        linearise(whole, {})


def test_a_ship_is_no_condition():
    with pytest.raises(
        UsageError, match=r"numbers by name, such as .* and no ParameterSet; fit\.to_control\(\) takes a ship"
    ):
        linearise(find_model("nomoto"), find_ship("zeefakkel"))
