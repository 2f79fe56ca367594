"""The equations of a model in print: LaTeX, and plain text for a terminal.

The same methods run once more, over SymPy symbols, so what is printed is what is computed.
"""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

import shipid
from shipid.declaration.component import SAMPLING_INTERVAL
from shipid.declaration.model import Entry, Evaluation, Model
from shipid.foundation.cache import keep, kept
from shipid.generation.system import generate

_GREEK = [
    "alpha",
    "beta",
    "gamma",
    "delta",
    "epsilon",
    "zeta",
    "eta",
    "theta",
    "kappa",
    "lambda",
    "mu",
    "nu",
    "xi",
    "rho",
    "sigma",
    "tau",
    "phi",
    "chi",
    "psi",
    "omega",
]


@dataclass(frozen=True)
class Typeset:
    """One equation in print.

    Attributes
    ----------
    target, kind : str
        What it defines, and how: rate, next, equals, or instead (where a parameter set publishes other coefficients).
    component, method : str
        Where it is declared.
    latex, plain : str
        The whole equation, left side included.
    source : str
        Its docstring.
    """

    target: str
    kind: str
    component: str
    method: str
    latex: str
    plain: str
    source: str


def symbol(entry: Entry) -> str:
    r"""Return the LaTeX symbol of a quantity: declared, or made from its name (``tau_u`` becomes ``\tau_{u}``).

    Parameters
    ----------
    entry : Entry
        The quantity in its model.
    """
    return entry.quantity.latex or symbol_of(entry.name)


def symbol_of(name: str) -> str:
    """Return a LaTeX symbol for a name, with Greek letters and subscripts.

    Parameters
    ----------
    name : str
        As an equation spells it.
    """
    head, *rest = name.split("_")
    match = re.fullmatch(r"([A-Za-z]+?)(\d+)", head)
    if match:
        head, rest = match.group(1), [match.group(2), *rest]
    letter = rf"\{head}" if head in _GREEK else head if len(head) == 1 else rf"\mathrm{{{head}}}"
    below = ",".join(rf"\{r}" if r in _GREEK else r if len(r) < 3 else rf"\mathrm{{{r}}}" for r in rest)
    return f"{letter}_{{{below}}}" if below else letter


class _Traced(np.lib.mixins.NDArrayOperatorsMixin):
    """A SymPy expression that NumPy's functions and arithmetic accept."""

    def __init__(self, expr: Any) -> None:
        self.expr = expr

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **_: Any) -> Any:
        return _call(ufunc.__name__, inputs)

    def __array_function__(self, func: Any, _types: Any, args: Any, _kwargs: Any) -> Any:
        return _call(func.__name__, args)


def _expr(value: Any) -> Any:
    import sympy

    if isinstance(value, _Traced):
        return value.expr
    number = float(value)
    return sympy.Integer(int(number)) if number == int(number) else sympy.Float(repr(number), 6)


def _call(name: str, args: Any) -> _Traced:
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
    arguments = [_expr(a) if not _is_relation(a) else a.expr for a in args]
    function = table.get(name) or sympy.Function(name)
    return _Traced(function(*arguments))


def _is_relation(value: Any) -> bool:
    return isinstance(value, _Traced) and bool(getattr(value.expr, "is_Boolean", False))


def typeset(model: Model) -> list[Typeset]:
    """Return every equation of a model in print, in the order of declaration.

    Parameters
    ----------
    model : Model
        The model. A quantity that an equation reads stands as its symbol and is not written out.

    Returns
    -------
    list of Typeset

    Notes
    -----
    What was typeset once is kept in the cache: SymPy takes a third of a second to load.
    """
    key = f"typeset-{_fingerprint(model)}.json"
    known = kept(key)
    if known is not None:
        try:
            return [Typeset(**entry) for entry in json.loads(known)]
        except (ValueError, TypeError):
            pass  # half a file, or one of another version: typeset anew
    made = _typeset(model)
    keep(key, json.dumps([asdict(e) for e in made], ensure_ascii=False))
    return made


def _fingerprint(model: Model) -> str:
    """A hash of all that shows in print: equations, symbols, names, sources."""
    shown = [
        (
            n,
            e.quantity.kind,
            symbol(e),
            e.owner.__name__,
            e.equation and (e.equation.kind, e.equation.name, e.equation.source),
        )
        for n, e in model.entries.items()
    ]
    return hashlib.sha256(f"{generate(model).digest}{shown}{shipid.__version__}".encode()).hexdigest()[:32]


def _typeset(model: Model) -> list[Typeset]:
    """Typeset anew."""
    import sympy

    symbols = {n: _Traced(sympy.Symbol(n, real=True)) for n in [*model.entries, SAMPLING_INTERVAL]}
    names = {sympy.Symbol(n, real=True): symbol(e) for n, e in model.entries.items()}
    evaluation = Evaluation(model, symbols)
    result = []
    for entry in model.entries.values():
        if entry.equation is None:
            continue
        right = _expr(evaluation.equation(entry))
        mark = symbol(entry)
        left_latex, left_plain = {
            "rate": (rf"\dot{{{mark}}}", f"d{entry.name}/dt"),
            "next": (rf"{mark}(k+1)", f"{entry.name}(k+1)"),
        }.get(entry.equation.kind, (mark, entry.name))
        result.append(
            Typeset(
                entry.name,
                entry.equation.kind,
                entry.owner.__name__,
                entry.equation.name,
                f"{left_latex} = {sympy.latex(right, symbol_names=names)}",
                f"{left_plain} = {sympy.sstr(right).replace('**', '^')}",
                entry.equation.source,
            )
        )
    return result
