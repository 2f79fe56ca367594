"""The equations of a model in print: LaTeX, MathML for pages, and plain text for a terminal.

The same methods run once more, over SymPy symbols, so what is printed is what is computed.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass

import shipid
from shipid.declaration.model import Model
from shipid.foundation.cache import keep, kept
from shipid.foundation.errors import UsageError
from shipid.generation.system import generate
from shipid.generation.typesetting.mathml import equation_mathml
from shipid.generation.typesetting.symbols import symbol, symbol_mathml
from shipid.generation.typesetting.tracing import right_hand_sides

#: Counts the ways in which equations were put in print: what the cache holds from an earlier one is typeset anew.
_WAY = 2
_NEXT = '<mo stretchy="false">(</mo><mi>k</mi><mo>+</mo><mn>1</mn><mo stretchy="false">)</mo>'


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
    mathml : str
        The same as presentation MathML: ``math`` elements, between which a line may break.
    """

    target: str
    kind: str
    component: str
    method: str
    latex: str
    plain: str
    source: str
    mathml: str


def typeset(model: Model) -> list[Typeset]:
    """Return every equation of a model in print, in the order of declaration.

    Parameters
    ----------
    model : Model
        The model. A quantity that an equation reads stands as its symbol and is not written out.

    Returns
    -------
    list of Typeset

    Raises
    ------
    UsageError
        If it is no model.

    Notes
    -----
    What was typeset once is kept in the cache: SymPy takes a third of a second to load.
    """
    if not isinstance(model, Model):
        raise UsageError(
            f"typeset takes a model, as shipid.join or shipid.find_model('de-keizer') returns it, and no {type(model).__name__}."
        )
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
            str(generate(model).values[n]) if e.quantity.kind == "guard" else "",
        )
        for n, e in model.entries.items()
    ]
    return hashlib.sha256(f"{generate(model).digest}{shown}{shipid.__version__}{_WAY}".encode()).hexdigest()[:32]


def _typeset(model: Model) -> list[Typeset]:
    """Typeset anew."""
    import sympy

    latex = {sympy.Symbol(n, real=True): symbol(e) for n, e in model.entries.items()}
    mathml = {n: symbol_mathml(symbol(e), n) for n, e in model.entries.items()}
    result = []
    for entry, right in right_hand_sides(model):
        assert entry.equation is not None
        mark, kind = symbol(entry), entry.equation.kind
        left_latex, left_plain, left_mathml = {
            "rate": (rf"\dot{{{mark}}}", f"d{entry.name}/dt", symbol_mathml(mark, entry.name, rate=True)),
            "next": (rf"{mark}(k+1)", f"{entry.name}(k+1)", mathml[entry.name] + _NEXT),
        }.get(kind, (mark, entry.name, mathml[entry.name]))
        result.append(
            Typeset(
                entry.name,
                kind,
                entry.owner.__name__,
                entry.equation.name,
                f"{left_latex} = {sympy.latex(right, symbol_names=latex)}",
                f"{left_plain} = {sympy.sstr(right).replace('**', '^')}",
                entry.equation.source,
                equation_mathml(left_mathml, right, mathml),
            )
        )
    return result
