"""Equations run over SymPy symbols; NumPy's functions of them are replaced by SymPy's."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.component import SAMPLING_INTERVAL
from shipid.declaration.model import Entry, Evaluation, Model
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import ShipidError

if TYPE_CHECKING:
    import sympy

#: Shares of a limit around zero at which two expressions are compared, and how near they are where they are one function.
_LOOKED_AT = (-0.9, -0.5, 0.5, 0.9)
_SAME = 1e-9


class _Traced(np.lib.mixins.NDArrayOperatorsMixin):
    """A SymPy expression that NumPy's functions and arithmetic accept."""

    def __init__(self, expr: sympy.Basic) -> None:
        self.expr = expr

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Expression, **_: object) -> _Traced:
        return _call(ufunc.__name__, inputs)

    def __array_function__(
        self, func: Callable[..., object], _types: object, args: Sequence[Expression], _kwargs: object
    ) -> _Traced:
        return _call(func.__name__, args)

    def __round__(self, digits: int = 0) -> _Traced:
        return _call("round", (self, digits))

    def __floor__(self) -> _Traced:
        return _call("floor", (self,))

    def __ceil__(self) -> _Traced:
        return _call("ceil", (self,))


def _expr(value: Expression) -> sympy.Basic:
    import sympy

    if isinstance(value, _Traced):
        return value.expr
    if isinstance(value, list | tuple) or np.ndim(value):
        # The places of a table that is interpolated.
        return sympy.Tuple(*(_expr(v) for v in value))
    number = float(value)
    return sympy.Integer(int(number)) if number == int(number) else sympy.Float(repr(number), 6)


def _call(name: str, args: Sequence[Expression]) -> _Traced:
    import sympy

    table = {
        "absolute": sympy.Abs,
        "abs": sympy.Abs,
        "sin": sympy.sin,
        "cos": sympy.cos,
        "tan": sympy.tan,
        "arctan": sympy.atan,
        "arctan2": sympy.atan2,
        "sqrt": sympy.sqrt,
        "exp": sympy.exp,
        "log": sympy.log,
        "tanh": sympy.tanh,
        "hypot": lambda a, b: sympy.sqrt(a**2 + b**2),
        "sign": sympy.sign,
        "minimum": sympy.Min,
        "maximum": sympy.Max,
        "clip": lambda v, low, high: sympy.Min(sympy.Max(v, low), high),
        "where": _chosen,
        "add": lambda a, b: a + b,
        "subtract": lambda a, b: a - b,
        "multiply": lambda a, b: a * b,
        "divide": lambda a, b: a / b,
        "true_divide": lambda a, b: a / b,
        "power": lambda a, b: a**b,
        "float_power": lambda a, b: a**b,
        "square": lambda a: a**2,
        "negative": lambda a: -a,
        "less": sympy.Lt,
        "less_equal": sympy.Le,
        "greater": sympy.Gt,
        "greater_equal": sympy.Ge,
        "logical_and": sympy.And,
        "logical_or": sympy.Or,
        "equal": sympy.Eq,
        "not_equal": sympy.Ne,
    }
    function = table.get(name) or sympy.Function(name)
    return _Traced(function(*(_expr(a) for a in args)))


def _chosen(condition: sympy.Basic, near: sympy.Basic, far: sympy.Basic) -> sympy.Basic:
    """One of two expressions; a series that stands for the other one near zero is left out.

    ``sin(a)/a`` has no value at zero, so that an equation takes a series there. Both are one function, and a reader wants that.
    """
    import sympy

    if isinstance(condition, sympy.Lt) and isinstance(condition.lhs, sympy.Abs):
        size, limit = condition.lhs.args[0], condition.rhs
        one, other = (_resolved(e, condition, inside) for e, inside in ((near, True), (far, False)))
        a = sympy.Dummy("a", real=True)
        one_in_a, other_in_a = (e.subs(size, a) for e in (one, other))
        if one_in_a.free_symbols | other_in_a.free_symbols == {a} and limit.is_number:
            at = [share * float(limit) for share in _LOOKED_AT]
            pairs = [(float(one_in_a.subs(a, v)), float(other_in_a.subs(a, v))) for v in at]
            if all(abs(p - q) <= _SAME * max(abs(p), abs(q)) for p, q in pairs):
                return other
    return sympy.Piecewise((near, condition), (far, True))


def _resolved(expr: sympy.Basic, condition: sympy.Basic, inside: bool) -> sympy.Basic:
    """An expression in which choices by a condition are made."""
    import sympy

    return expr.replace(
        lambda e: isinstance(e, sympy.Piecewise) and len(e.args) == 2 and e.args[0].cond == condition,
        lambda e: e.args[0 if inside else 1].expr,
    )


def right_hand_sides(model: Model) -> list[tuple[Entry, sympy.Basic]]:
    """Return every entry that has an equation, with the right side of the equation over SymPy symbols.

    Parameters
    ----------
    model : Model
        The model. A quantity that an equation reads stands as its symbol, real, under its own name.

    Returns
    -------
    list of (Entry, sympy.Basic)
        In the order of declaration.
    """
    import sympy

    symbols = {n: _Traced(sympy.Symbol(n, real=True)) for n in [*model.entries, SAMPLING_INTERVAL]}
    evaluation = Evaluation(model, symbols)
    return [(e, _printed(evaluation, e)) for e in model.entries.values() if e.equation is not None]


def _printed(evaluation: Evaluation, entry: Entry) -> sympy.Basic:
    """The right side of an equation; its name where it does with symbols of CasADi what SymPy cannot."""
    import sympy

    try:
        return _expr(evaluation.equation(entry))
    except ShipidError:
        raise
    except Exception:  # it runs, and what runs is shown by name
        assert entry.equation is not None
        return sympy.Symbol(entry.equation.name)
