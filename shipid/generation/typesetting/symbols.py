"""The symbols of quantities: LaTeX as it is declared or made from a name, and MathML made from the LaTeX."""

from __future__ import annotations

import re
from html import escape

from shipid.declaration.model import Entry

# fmt: off
_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "eta": "η", "theta": "θ",
    "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ",
    "chi": "χ", "psi": "ψ", "omega": "ω",
}
_MORE_GREEK = {
    "iota": "ι", "pi": "π", "upsilon": "υ", "varphi": "φ", "varepsilon": "ε", "Gamma": "Γ", "Delta": "Δ", "Theta": "Θ",
    "Lambda": "Λ", "Xi": "Ξ", "Pi": "Π", "Sigma": "Σ", "Phi": "Φ", "Psi": "Ψ", "Omega": "Ω",
}
# fmt: on
_LETTERS = _GREEK | _MORE_GREEK
_ACCENTS = {"dot": "˙", "ddot": "¨", "bar": "¯", "hat": "^", "tilde": "~"}
_SIGNS = {"nabla": "∇", "infty": "∞", "prime": "′", "circ": "°", "cdot": "·"}
_UPRIGHT = ("mathrm", "text", "operatorname")
_TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[{}_^]|\s+|\d+|.", re.DOTALL)


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
        A name of Python's, parts separated by underscores.
    """
    head, *rest = name.split("_")
    match = re.fullmatch(r"([A-Za-z]+?)(\d+)", head)
    if match:
        head, rest = match.group(1), [match.group(2), *rest]
    letter = rf"\{head}" if head in _GREEK else head if len(head) == 1 else rf"\mathrm{{{head}}}"
    below = ",".join(rf"\{r}" if r in _GREEK else r if len(r) < 3 else rf"\mathrm{{{r}}}" for r in rest)
    return f"{letter}_{{{below}}}" if below else letter


def symbol_mathml(latex: str, name: str, *, rate: bool = False) -> str:
    r"""Return a LaTeX symbol such as ``\tau_{u}^*`` as presentation MathML, without the ``math`` element around it.

    Parameters
    ----------
    latex : str
        The symbol: letters, Greek letters, digits, sub- and superscripts, primes, accents, upright words.
    name : str
        What is shown, upright, where the symbol uses anything else.
    rate : bool
        Whether a dot stands over its letter.

    Returns
    -------
    str
        One element.
    """
    reader = _Symbol(latex)
    try:
        return reader.whole(rate)
    except (_UnknownLatexError, IndexError):
        word = _letter(escape(name), True)
        return _accented(word, _ACCENTS["dot"]) if rate else word


class _UnknownLatexError(ValueError):
    """LaTeX that a symbol is not expected to hold."""


def _letter(text: str, upright: bool) -> str:
    return f'<mi mathvariant="normal">{text}</mi>' if upright else f"<mi>{text}</mi>"


def _accented(element: str, accent: str) -> str:
    return f'<mover accent="true">{element}<mo>{accent}</mo></mover>'


def _row(elements: list[str]) -> str:
    return elements[0] if len(elements) == 1 else f"<mrow>{''.join(elements)}</mrow>"


class _Symbol:
    """A reader of the LaTeX of one symbol, token by token."""

    def __init__(self, latex: str) -> None:
        self.tokens = [t for t in _TOKEN.findall(latex) if t.strip()]

    def whole(self, rate: bool) -> str:
        elements = self._sequence(False, rate)
        if self.tokens or not elements:
            raise _UnknownLatexError
        return _row(elements)

    def _sequence(self, upright: bool, rate: bool = False) -> list[str]:
        elements = []
        while self.tokens and self.tokens[0] != "}":
            base = self._atom(upright)
            # The dot of a rate stands over the letter, not over its scripts.
            elements.append(self._with_scripts(_accented(base, _ACCENTS["dot"]) if rate else base))
        return elements

    def _with_scripts(self, base: str) -> str:
        below, above = "", []
        while self.tokens and self.tokens[0] in ("_", "^", "'"):
            token = self.tokens.pop(0)
            if token == "'":
                above.append("<mo>′</mo>")
            elif token == "^":
                above.append(self._atom(False))
            elif below:
                raise _UnknownLatexError
            else:
                below = self._atom(False)
        if below and above:
            return f"<msubsup>{base}{below}{_row(above)}</msubsup>"
        if below:
            return f"<msub>{base}{below}</msub>"
        return f"<msup>{base}{_row(above)}</msup>" if above else base

    def _atom(self, upright: bool) -> str:
        token = self.tokens.pop(0)
        if token == "{":
            inside = self._word() if upright else _row(self._sequence(upright) or ["<mrow></mrow>"])
            if self.tokens.pop(0) != "}":
                raise _UnknownLatexError
            return inside
        if token.startswith("\\"):
            return self._command(token[1:], upright)
        if token in "_^}":
            raise _UnknownLatexError
        if token.isdigit():
            return f"<mn>{token}</mn>"
        if token.isalpha():
            return _letter(token, upright)
        return f"<mo>{escape(token)}</mo>"

    def _word(self) -> str:
        """Return what stands between the braces of an upright word as one identifier."""
        letters = ""
        while self.tokens[0] != "}":
            token = self.tokens.pop(0)
            if not token.isalnum():
                raise _UnknownLatexError
            letters += token
        return _letter(letters, True)

    def _command(self, command: str, upright: bool) -> str:
        if command in _LETTERS:
            return _letter(_LETTERS[command], upright or command[0].isupper())
        if command in _SIGNS:
            return f"<mo>{_SIGNS[command]}</mo>"
        if command in _UPRIGHT:
            return self._atom(True)
        if command in _ACCENTS:
            return _accented(self._atom(upright), _ACCENTS[command])
        raise _UnknownLatexError
