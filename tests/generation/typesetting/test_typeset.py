"""What is printed is what is computed."""

from typing import Any

import casadi as ca
import mpmath
import numpy as np
import pytest
import sympy

from shipid import Component, derived, find_model, generate, given, join, parameter, state, typeset
from shipid.foundation.errors import UsageError

T = 2.0


def test_every_equation_is_printed(one: Any) -> None:
    model = one.model
    printed = typeset(model)
    assert [p.target for p in printed] == [n for n, e in model.entries.items() if e.equation is not None]
    for p in printed:
        assert p.source == model[p.target].equation.source
        assert p.component == model[p.target].owner.__name__
        left = {"rate": f"d{p.target}/dt", "next": f"{p.target}(k+1)"}.get(p.kind, p.target)
        assert p.plain.startswith(f"{left} = ")
        assert p.latex.count("{") == p.latex.count("}")
        assert p.latex.count(r"\left") == p.latex.count(r"\right")


def test_nomotos_yaw_equation() -> None:
    yaw = next(p for p in typeset(find_model("nomoto")) if p.target == "r")
    assert yaw.plain == "dr/dt = r_disturbance + (K*delta - r)/tau"
    assert yaw.latex == r"\dot{r} = \dot r_d + \frac{K \delta - r}{\tau}"
    assert (yaw.kind, yaw.component, yaw.method) == ("rate", "Nomoto", "yaw")


def read(text: str, names: list[str]) -> Any:
    """Read a printed right side with nothing known but the names of the quantities."""
    symbols = {n: sympy.Symbol(n, real=True) for n in names}
    return sympy.sympify(text.partition(" = ")[2], locals=symbols)


def test_the_print_evaluates_to_the_generated_function(one: Any, plain: Any, rng: Any) -> None:
    """The plain text, read back by SymPy and evaluated, against CasADi's function at random points, to 1e-10.

    A quantity stands in print as its symbol, so it is given the value it has. What is left is the rounding of an
    expression that SymPy has reordered; a difference of large terms multiplies it.
    """
    system = generate(one.model)
    names = [*one.model.entries, "T_s"]
    moves = dict(zip(system.states, ca.vertsplit(system.rates))) | {
        system.states[i]: e for i, e in system.nexts.items()
    }
    equations = [p for p in typeset(one.model) if p.kind != "instead"]
    wanted = ca.vertcat(*(moves.get(p.target, system.values[p.target]) for p in equations))
    everything = ca.Function(
        "all", [system.x, system.u, system.p, system.T], [wanted, system.expression(one.model.derived)]
    )
    expressions = [read(p.plain, names) for p in equations]
    symbols = [sorted(e.free_symbols, key=str) for e in expressions]
    functions = [sympy.lambdify(s, e, "mpmath", cse=True) for s, e in zip(symbols, expressions)]
    for _ in range(3):
        point = one.random(rng)
        at = [system.vector(n, point) for n in (system.states, system.inputs, system.coefficients)]
        generated, quantities = (np.asarray(v).ravel() for v in everything(*at, T))
        known = point | {"T_s": T} | dict(zip(one.model.derived, quantities))
        for printed, at, function, value in zip(equations, symbols, functions, generated):
            if not np.isfinite(value):
                assert printed.target in ("tau1", "tau2")  # of complex poles
                continue
            # The points and weights of the cross-flow are printed to six digits; so is the 8/pi of the slipstream, of which a
            # small difference of two angles is left at the rudder.
            rounding = {"cross": 1e-5, "mmg": 1e-4}.get(one.model.name.partition("-")[0], 1e-10)
            with mpmath.workdps(30):
                shown = float(function(*(mpmath.mpf(float(known[s.name])) for s in at)))
            assert shown == pytest.approx(value, rel=rounding), printed.plain


def test_published_coefficients_are_printed_as_the_model_defines_them() -> None:
    instead = {p.target: p.plain for p in typeset(find_model("norrbin")) if p.kind == "instead"}
    assert instead == {"a": "a = K*b1", "b1": "b1 = 1/tau", "b3": "b3 = b1*n3"}


class Everything(Component):
    """Functions an equation may use and no installed model does."""

    a = given("1", "a number")
    b = given("1", "another number")
    shown = derived("1", "all of them together")

    @shown.equals
    def formula(self) -> Any:
        """Made up."""
        bounded = np.clip(self.a, -0.5, 0.5) + np.tanh(self.b) * np.square(self.a)
        chosen = np.where(np.logical_or(self.a < self.b, self.b >= 2.0), np.hypot(self.a, self.b), np.exp(-self.b))
        return bounded + chosen + np.arctan2(self.a, self.b) - np.log(self.b) * np.sign(self.a)


def test_functions_no_ship_uses() -> None:
    model = join("everything", Everything)
    [equation] = typeset(model)
    function = generate(model).function(["shown"])
    expression = read(equation.plain, ["a", "b"])
    for a, b in [(0.3, 1.2), (-0.7, 0.4), (2.5, 1.1), (3.0, 2.0)]:
        numbers = {sympy.Symbol("a", real=True): a, sympy.Symbol("b", real=True): b}
        assert float(expression.subs(numbers)) == pytest.approx(float(function([], [a, b], [])), rel=1e-13)


def test_a_series_near_zero_is_printed_as_the_function_it_stands_for() -> None:
    north = next(p for p in typeset(find_model("coordinated-turn")) if p.target == "x")
    assert "vx*sin(T_s*omega)/(T_s*omega)" in north.plain and "Piecewise" not in north.plain


def test_a_dead_band_is_no_series() -> None:
    """Two different functions on both sides of a limit stay two."""

    class Slack(Component):
        """A gear with a slack."""

        error = given("rad", "what is asked")
        moved = derived("rad", "what moves")

        @moved.equals
        def law(self):
            """Nothing inside the slack."""
            return np.where(np.abs(self.error) < 0.05, 0.0, self.error)

    (printed,) = typeset(join("slack", Slack))
    assert printed.plain == "moved = Piecewise((0, Abs(error) < 0.05), (error, True))"


class Tabled(Component):
    """A rate of turn by a table of the rudder."""

    r = state("rad/s", "rate of turn")
    delta = given("rad", "rudder angle")
    a = parameter("1/s^2", "gain", start=0.1)

    @r.rate
    def yaw(self) -> Any:
        """Notebook, page 3."""
        return self.a * np.interp(self.delta, [-0.5, 0.0, 0.5], [-0.4, 0.0, 0.3])


def test_an_equation_with_a_table_is_typeset() -> None:
    (printed,) = typeset(join("tabled", Tabled))
    assert "interp(delta" in printed.plain and "0.3" in printed.plain and "<math" in printed.mathml


class Stepped(Tabled):
    """A rudder that stands in steps."""

    def yaw(self) -> Any:
        """Notebook, page 4."""
        return self.a * round(self.delta, 1)


def test_what_python_rounds_is_typeset() -> None:
    """It runs over symbols of CasADi, and was "a fault in shipid itself" in print."""
    (printed,) = typeset(join("stepped", Stepped))
    assert "round(delta, 1)" in printed.plain


class Transposed(Tabled):
    """What has a value over numbers and symbols, and no print."""

    def yaw(self) -> Any:
        """Notebook, page 5."""
        return self.a * self.delta.T


def test_what_cannot_be_printed_stands_by_the_name_of_its_equation() -> None:
    (printed,) = typeset(join("transposed", Transposed))
    assert printed.plain == "dr/dt = yaw"


def test_what_is_no_model_is_not_typeset() -> None:
    for verb in (typeset, generate):
        with pytest.raises(UsageError, match="find_model"):
            verb("de-keizer")
