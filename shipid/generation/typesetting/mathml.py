"""Presentation MathML of a SymPy expression, in pieces between which a line may break."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape, unescape
from typing import TYPE_CHECKING
from xml.dom import minidom

if TYPE_CHECKING:
    import sympy

#: Operations in a term beyond which its sums are broken over lines.
_LONG = 25
#: The product sign is invisible; a thin space separates upright words.
_TIMES = '<mo lspace="0.12em" rspace="0.12em">\u2062</mo>'

#: An operator at the end of a piece would be set as a sign, without space around it.
_AROUND = 'form="infix" lspace="0.2em" rspace="0.2em"'

_OPEN, _CLOSE = "<mo>(</mo>", "<mo>)</mo>"
_OPEN_LOW, _CLOSE_LOW = '<mo stretchy="false">(</mo>', '<mo stretchy="false">)</mo>'


def equation_mathml(left: str, right: sympy.Expr, symbols: Mapping[str, str]) -> str:
    """Return an equation as a sequence of ``math`` elements, between which a browser may break a line.

    A browser does not break the lines of one ``math`` element, and an equation has to be read on a phone too. So the
    left side and each term of the right side are elements of their own.

    Parameters
    ----------
    left : str
        The left side, MathML without a ``math`` element around it.
    right : sympy.Expr
        The right side.
    symbols : mapping of str to str
        MathML of each symbol, by the name it has in SymPy.

    Returns
    -------
    str
        ``math`` elements separated by spaces.
    """
    pieces = _Pieces(symbols).of(right)
    first = f"<mrow>{left}<mo {_AROUND}>=</mo></mrow>"
    if len(pieces) == 1:
        return _math(f"<mrow>{left}<mo>=</mo>{pieces[0]}</mrow>")
    return " ".join(_math(piece) for piece in (first, *pieces))


def _math(inside: str) -> str:
    return f'<math displaystyle="true">{inside}</math>'


class _Pieces:
    """Terms of expressions as MathML, each with the operator before it."""

    def __init__(self, symbols: Mapping[str, str]) -> None:
        from sympy.printing.mathml import MathMLPresentationPrinter

        class Printer(MathMLPresentationPrinter):  # type: ignore[misc]
            """SymPy's printer with the declared symbols, and cases side by side."""

            def text(self, expression: sympy.Expr) -> str:
                return _serial(self._print(expression))

            def _print_Symbol(self, sym: sympy.Symbol, style: str = "plain") -> minidom.Element:
                return _element(symbols.get(sym.name) or f"<mi>{escape(sym.name)}</mi>")

            def _print_Piecewise(self, expr: sympy.Piecewise) -> minidom.Element:
                rows = ""
                for value, condition in expr.args:
                    when = "otherwise" if condition == True else "if"  # noqa: E712 - SymPy's true
                    shown = "" if when == "otherwise" else self.text(condition)
                    rows += f"<mtr><mtd>{self.text(value)}</mtd><mtd><mtext>{when}\u00a0</mtext>{shown}</mtd></mtr>"
                table = f'<mtable columnalign="left left" columnspacing="1em">{rows}</mtable>'
                return _element(f'<mrow><mo fence="true" stretchy="true">{{</mo>{table}</mrow>')

        self.printer = Printer({"ln_notation": True})

    def of(self, expression: sympy.Expr) -> list[str]:
        """Return the pieces of an expression.

        Parameters
        ----------
        expression : sympy.Expr
            The expression.
        """
        if not expression.is_Add:
            return self._term(expression, first=True)
        terms = expression.as_ordered_terms()
        return [piece for k, term in enumerate(terms) for piece in self._term(term, first=k == 0)]

    def _term(self, term: sympy.Expr, *, first: bool) -> list[str]:
        import sympy

        negative = term.could_extract_minus_sign()
        term = -term if negative else term
        operator = "−" if negative else "" if first else "+"
        sign = f'<mo form="prefix">{operator}</mo>' if first else f"<mo {_AROUND}>{operator}</mo>"
        sign = sign if operator else ""
        top = sympy.fraction(term)[0]
        sums = [f for f in sympy.Mul.make_args(top) if f.is_Add and f.count_ops() > _LONG]
        if not sums:
            return [f"<mrow>{sign}{self.printer.text(term)}</mrow>"]
        inside = self.of(sums[0])
        outside = term / sums[0]
        factor = "" if outside == 1 else self.printer.text(outside) + _TIMES
        opening = f"<mrow>{sign}{factor}{_OPEN_LOW}{inside[0]}</mrow>"
        return [opening, *inside[1:-1], f"<mrow>{inside[-1]}{_CLOSE_LOW}</mrow>"]


def _element(text: str) -> minidom.Element:
    element = minidom.parseString(text).documentElement
    assert element is not None
    return element


def _serial(node: minidom.Node) -> str:
    """Return a node as text: SymPy's printer writes entities and a bare ``<`` into its text nodes."""
    if isinstance(node, minidom.Text):
        return escape(unescape(node.data).replace("\u2147", "e"), quote=False)
    assert isinstance(node, minidom.Element)
    children = [_serial(child) for child in node.childNodes]
    inside = "".join(children)
    if children[:1] == [_OPEN] and children[-1:] == [_CLOSE] and "<mfrac>" not in inside:
        # Parentheses around a single line stay as they are: stretched ones leave gaps.
        inside = "".join([_OPEN_LOW, *children[1:-1], _CLOSE_LOW])
    if node.tagName in ("mo", "mn"):
        inside = inside.replace("-", "−")
        if inside == "\u2062":
            return _TIMES
    attributes = "".join(f' {name}="{escape(value)}"' for name, value in node.attributes.items())
    return f"<{node.tagName}{attributes}>{inside}</{node.tagName}>"
