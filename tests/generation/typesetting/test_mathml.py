"""Equations as MathML: well formed, with the symbols that are declared, broken into lines where they are long."""

from __future__ import annotations

from collections.abc import Iterator
from xml.dom import minidom

import pytest
import sympy

from shipid import find_model, typeset
from shipid.generation.typesetting.mathml import equation_mathml
from shipid.parameters.catalogue import known_models

a, b, c = sympy.symbols("a b c", real=True)
KNOWN = {
    "mrow",
    "mi",
    "mn",
    "mo",
    "mfrac",
    "msup",
    "msub",
    "msubsup",
    "msqrt",
    "mroot",
    "mover",
    "mtable",
    "mtr",
    "mtd",
    "mtext",
}


def elements(text: str) -> list[minidom.Element]:
    """Return the ``math`` elements, each of them well formed."""
    root = minidom.parseString(f"<all>{text}</all>").documentElement
    assert root is not None
    return [n for n in root.childNodes if isinstance(n, minidom.Element)]


def tags(node: minidom.Element) -> Iterator[str]:
    for child in node.childNodes:
        if isinstance(child, minidom.Element):
            yield child.tagName
            yield from tags(child)


def words(node: minidom.Node) -> str:
    """Return the text of a node, without the signs that show nothing."""
    if isinstance(node, minidom.Text):
        return node.data.replace("\u2062", "")
    return "".join(words(child) for child in node.childNodes)


@pytest.mark.parametrize("name", list(known_models()))
def test_every_equation_is_well_formed_presentation_mathml(name: str) -> None:
    for equation in typeset(find_model(name)):
        parts = elements(equation.mathml)
        assert parts and all(p.tagName == "math" for p in parts)
        assert {t for p in parts for t in tags(p)} <= KNOWN, equation.plain
        shown = "".join(words(p) for p in parts)
        assert "=" in words(parts[0]) and "&" not in shown and "_" not in shown and "-" not in shown


def test_nomotos_yaw_equation() -> None:
    yaw = next(e for e in typeset(find_model("nomoto")) if e.target == "r")
    left, disturbance, rudder = elements(yaw.mathml)
    assert (words(left), words(disturbance), words(rudder)) == ("r˙=", "r˙d", "+Kδ−rτ")
    assert "<mfrac>" in rudder.toxml()


@pytest.mark.parametrize(
    ("expression", "shown"),
    [
        (a * (b - c), "a(b−c)"),
        (-a / b, "−ab"),
        (sympy.Min(a, 2), "min(2,a)"),
        (sympy.Abs(a), "|a|"),
        (sympy.log(a), "ln(a)"),
        (sympy.Piecewise((a, a < b), (b, True)), "{aif\u00a0a<bbotherwise\u00a0"),
        (sympy.Float("1e-18", 6) * a, "1.0·10−18a"),
        (sympy.sqrt(a), "a"),
    ],
)
def test_expressions(expression: sympy.Expr, shown: str) -> None:
    [whole] = elements(equation_mathml("<mi>y</mi>", expression, {}))
    assert words(whole) == f"y={shown}"


def test_declared_symbols_stand_in_place_of_names() -> None:
    known = {"a": "<msub><mi>α</mi><mn>1</mn></msub>"}
    [whole] = elements(equation_mathml("<mi>y</mi>", 2 * a, known))
    assert words(whole) == "y=2α1"


def test_terms_and_long_sums_are_broken() -> None:
    """Each piece keeps its sign, and what the pieces say together is the equation."""
    long = a * sum((sympy.Integer(k) * b**k / (c + k) for k in range(1, 10)), sympy.Integer(0)) - c
    parts = elements(equation_mathml("<mi>y</mi>", long, {}))
    assert len(parts) == 11  # left side, nine terms inside the parenthesis, the last one
    shown = [words(p) for p in parts]
    assert shown[0] == "y=" and shown[-1] == "−c"
    assert sum(s.count("(") for s in shown) == sum(s.count(")") for s in shown) == 1
    assert all(s.startswith("+") for s in shown[2:-1])
