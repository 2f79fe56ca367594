"""The expressions and their derivatives, against the same equations over plain numbers."""

import subprocess
import sys
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from shipid import Component, find_model, generate, given, join, parameter, state
from shipid.foundation.errors import DeclarationError, UnknownNameError
from shipid.generation.step import make_step
from shipid.generation.system import System
from shipid.parts.helm import ZigzagHelm

T = 2.0


def arguments(system: System, point: dict[str, float]) -> tuple[np.ndarray, ...]:
    return tuple(system.vector(n, point) for n in (system.states, system.inputs, system.coefficients))


def test_expressions_equal_the_equations_over_floats(pair: Any, plain: Any, rng: Any) -> None:
    """To 1e-12: both do the same few dozen operations, in double precision, perhaps in another order."""
    system = generate(pair.model)
    shown = system.model.derived + system.model.outputs
    moves = ca.vertcat(system.rates, *system.nexts.values(), system.expression(shown))
    function = ca.Function("all", [system.x, system.u, system.p, system.T], [moves])
    named = [s for i, s in enumerate(system.states) if i in system.nexts]
    compared = 0
    for _ in range(20):
        point = pair.random(rng)
        rates = plain(pair.model, point | {"T_s": T}, "rate")
        others = plain(pair.model, point | {"T_s": T}, "next", "equals")
        wanted = [rates.get(s, 0.0) for s in system.states] + [others[n] for n in (*named, *shown)]
        got = np.asarray(function(*arguments(system, point), T)).ravel()
        np.testing.assert_allclose(got, np.array(wanted, dtype=float), rtol=1e-12, atol=0)
        compared += np.isfinite(got).sum()
    assert compared >= 20 * len(system.states)


def test_functions_equal_the_expressions(continuous: Any, plain: Any, rng: Any) -> None:
    system, point = generate(continuous.model), continuous.random(rng)
    wanted = plain(continuous.model, point)
    rates = system.right_hand_side(*arguments(system, point)).full().ravel()
    np.testing.assert_allclose(rates, [plain(continuous.model, point, "rate")[s] for s in system.states], rtol=1e-12)
    for name in system.model.derived:
        assert float(system.function([name])(*arguments(system, point))) == pytest.approx(wanted[name], rel=1e-12)


def differentiate(plain: Any, model: Any, point: dict[str, float], by: str, kinds: tuple[str, ...]) -> dict[str, float]:
    """Complex step, exact to rounding; five-point differences where an equation takes a size, a sign or an angle."""
    whole = ("pershitz", "cross-flow", "cubic-wind", "mmg", "constant-velocity", "coordinated-", "turning-at")
    if not model.name.startswith(whole) or "track" in model.name:
        size = 1e-30
        sides = plain(model, point | {"T_s": T, by: point[by] + 1j * size}, *kinds)
        return {n: np.imag(v) / size for n, v in sides.items()}
    size = 1e-3 * abs(point[by])
    sides = {k: plain(model, point | {"T_s": T, by: point[by] + k * size}, *kinds) for k in (-2, -1, 1, 2)}
    return {n: (8 * (sides[1][n] - sides[-1][n]) - sides[2][n] + sides[-2][n]) / (12 * size) for n in sides[1]}


def test_jacobians_are_exact(one: Any, plain: Any, rng: Any) -> None:
    """By states, inputs and coefficients, of every rate, next sample, derived quantity and output.

    Each entry, times the size of what it is taken by, is compared within 1e-9 of the row's largest: the complex step
    leaves rounding, the five-point differences (1e-3)^4 times a fifth derivative.
    """
    system = generate(one.model)
    targets = {s: system.rates[i] for i, s in enumerate(system.states) if i not in system.nexts}
    targets |= {system.states[i]: e for i, e in system.nexts.items()}
    of_states = ("rate", "next")
    groups = {"x": system.states, "u": system.inputs, "p": system.coefficients}
    for _ in range(3):
        point = one.random(rng)
        for kinds, wanted in ((of_states, targets), (("equals",), {n: system.values[n] for n in system.model.derived})):
            blocks = {}
            for letter, names in groups.items():
                derivative = ca.jacobian(ca.vertcat(*wanted.values()), getattr(system, letter))
                function = ca.Function("J", [system.x, system.u, system.p, system.T], [derivative])
                dense = function(*arguments(system, point), T).full()
                blocks |= {n: dense[:, j] * point[n] for j, n in enumerate(names)}
            got = np.array(list(blocks.values())).T
            columns = [differentiate(plain, one.model, point, n, kinds) for n in blocks]
            measured = np.array([[c[w] * point[n] for c, n in zip(columns, blocks)] for w in wanted])
            measured = measured.reshape(got.shape)
            defined = np.isfinite(got).all(axis=1)
            assert defined[: len(wanted)].all() or kinds == ("equals",)  # tau1 of complex poles is no number
            scale = np.abs(got).max(axis=1, keepdims=True, initial=1e-300)
            assert (np.abs(got - measured) / scale)[defined].max(initial=0.0) < 1e-9


def test_the_jacobian_functions_are_those_derivatives(continuous: Any, rng: Any) -> None:
    system, point = generate(continuous.model), continuous.random(rng)
    at = arguments(system, point)
    for by in "xup":
        whole = ca.Function("J", [system.x, system.u, system.p], [ca.jacobian(system.rates, getattr(system, by))])
        assert np.array_equal(system.jacobian("rates", by)(*at).full(), whole(*at).full())
    quantity = system.jacobian("vx" if "vx" in system.states else "r", "x")(*at).full()
    assert quantity.shape == (1, len(system.states))
    assert np.abs(quantity).sum() > 0


def test_a_sampled_model_has_no_right_hand_side() -> None:
    with pytest.raises(DeclarationError, match=r"x, y, psi, Omega is sampled\. Use a step"):
        _ = generate(find_model("pershitz-discrete")).right_hand_side


def test_making_a_step_leaves_the_system_alone(one: Any) -> None:
    system = generate(one.model)
    make_step(system)
    assert str(system.x) == f"[{', '.join(one.model.states)}]"
    assert system.x.is_valid_input()


def test_states_behind_a_quantity() -> None:
    system = generate(find_model("nomoto"))
    assert system.states_behind(["r"]) == ("r",)
    assert system.states_behind(["psi"]) == ("r", "psi")
    assert system.states_behind(["y"]) == ("r", "y", "psi")
    assert system.states_behind(["u"]) == ()
    assert system.states_behind([]) == ()
    # The drift angle moves the rate of turn, and the position moves neither.
    assert generate(find_model("pershitz")).states_behind(["r"]) == ("omega", "beta")
    assert generate(find_model("pershitz-discrete")).states_behind(["psi"]) == ("psi", "Omega")
    with_helm = generate(join("helmed", find_model("nomoto"), _RudderFromOrder, ZigzagHelm))
    assert set(with_helm.states_behind(["r"])) == set(with_helm.states) - {"x", "y"}


def test_inputs_behind_a_quantity() -> None:
    system = generate(find_model("nomoto"))
    assert system.inputs_behind(["r"]) == ("delta", "r_disturbance")
    assert system.inputs_behind(["u"]) == ("u",)
    assert system.inputs_behind(["y"]) == ("delta", "r_disturbance", "u", "v", "current_east")
    assert system.inputs_behind([]) == ()


class _RudderFromOrder(Component):
    delta = state("rad", "rudder angle")
    delta_order = given("rad", "rudder order")

    @delta.rate
    def servo(self) -> Any:
        """A lag of a second."""
        return (self.delta_order - self.delta) / self.lag

    lag = parameter("s", "time constant", start=1.0)


def test_vectors() -> None:
    system = generate(find_model("nomoto"))
    assert system.vector(("tau", "K"), {"K": 0.1, "tau": 30.0}).tolist() == [30.0, 0.1]
    assert system.vector(("r_disturbance",), {}).tolist() == [0.0]  # its declared default
    assert system.vector(("u",), {}, default=4.0).tolist() == [4.0]
    with pytest.raises(DeclarationError, match="'u' of model nomoto has no value"):
        system.vector(("u",), {})
    with pytest.raises(UnknownNameError, match="Did you mean delta"):
        system.expression(["dleta"])


def with_constant(number: float) -> Any:
    class Lag(Component):
        r = state("1", "something")

        @r.rate
        def yaw(self) -> Any:
            """Made up."""
            return -number * self.r / self.second

        second = parameter("s", "a second", start=1.0)

    return join("lag", Lag)


def test_the_digest_changes_with_an_equation() -> None:
    assert generate(with_constant(1.9)).digest == generate(with_constant(1.9)).digest
    assert generate(with_constant(1.9)).digest != generate(with_constant(1.9000000001)).digest
    models = [find_model(n) for n in ("de-keizer", "de-keizer-minimal", "de-keizer-cubic", "nomoto", "norrbin")]
    assert len({generate(m).digest for m in models}) == len(models)
    nomoto = find_model("nomoto")
    assert generate(nomoto).digest == generate(replace(nomoto, name="another name")).digest


def test_the_digest_is_the_same_in_another_process() -> None:
    code = "from shipid import *\nprint(generate(find_model('pershitz-discrete')).digest)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == generate(find_model("pershitz-discrete")).digest


def test_states_that_an_input_drives() -> None:
    system = generate(find_model("nomoto"))
    assert system.states_driven_by(["delta"]) == system.states
    assert system.states_driven_by([]) == ()
    position = generate(find_model("position-filter"))
    driven = position.states_driven_by(["psi"])
    assert {"x", "y"} <= set(driven) and not {"current_north", "current_east"} & set(driven)


def test_a_system_prints_its_names_and_shows_its_model():
    model = find_model("nomoto")
    system = generate(model)
    assert repr(system).startswith("<equations of 'nomoto': states r") and len(repr(system)) < 300
    assert system._repr_html_() == model._repr_html_()
