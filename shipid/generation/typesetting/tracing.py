"""Equations run over SymPy symbols; NumPy's functions of them are replaced by SymPy's."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.component import SAMPLING_INTERVAL
from shipid.declaration.model import Entry, Evaluation, Model
from shipid.foundation.aliases import Expression

if TYPE_CHECKING:
    import sympy


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


def _expr(value: Expression) -> sympy.Basic:
    import sympy

    if isinstance(value, _Traced):
        return value.expr
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
        "where": lambda c, a, b: sympy.Piecewise((a, c), (b, True)),
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
    return [(e, _expr(evaluation.equation(e))) for e in model.entries.values() if e.equation is not None]
