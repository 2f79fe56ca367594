"""LaTeX symbols of quantities as simple HTML: Greek letters, sub- and superscripts, dots."""

from __future__ import annotations

import re

from markupsafe import Markup, escape

_TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[{}_^]|\s+|.", re.DOTALL)
# fmt: off
_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "eta": "η", "theta": "θ",
    "iota": "ι", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "pi": "π", "rho": "ρ", "sigma":
    "σ", "tau": "τ", "upsilon": "υ", "phi": "φ", "chi": "χ", "psi": "ψ", "omega": "ω", "Gamma": "Γ", "Delta": "Δ",
    "Theta": "Θ", "Lambda": "Λ", "Xi": "Ξ", "Pi": "Π", "Sigma": "Σ", "Phi": "Φ", "Psi": "Ψ", "Omega": "Ω",
    "varphi": "φ", "varepsilon": "ε",
}
# fmt: on
_MARKS = {"dot": "\u0307", "ddot": "\u0308", "bar": "\u0304", "hat": "\u0302", "tilde": "\u0303"}
_SIGNS = {"infty": "∞", "prime": "′", "circ": "°", "cdot": "·"}
_UPRIGHT = ("mathrm", "text", "operatorname")


class _UnknownError(ValueError):
    """Something this small converter does not know."""


def html_symbol(latex: str, name: str) -> Markup:
    r"""Return a symbol such as ``\tau_{u}^*`` as HTML; the plain name where it cannot be converted faithfully.

    Parameters
    ----------
    latex : str
        The symbol.
    name : str
        The name to fall back on.
    """
    tokens = [t for t in _TOKEN.findall(latex) if t.strip()]
    try:
        result = _sequence(tokens, upright=False)
        if tokens:
            raise _UnknownError(tokens[0])
    except (_UnknownError, IndexError):
        return Markup("<i>{}</i>").format(name)
    return result


def _sequence(tokens: list[str], upright: bool) -> Markup:
    result = Markup("")
    while tokens and tokens[0] != "}":
        token = tokens.pop(0)
        if token in "_^":
            tag = "sub" if token == "_" else "sup"
            result += Markup(f"<{tag}>{{}}</{tag}>").format(_atom(tokens, upright))
        else:
            tokens.insert(0, token)
            result += _atom(tokens, upright)
    return result


def _atom(tokens: list[str], upright: bool) -> Markup:
    token = tokens.pop(0)
    if token == "{":
        inside = _sequence(tokens, upright)
        if tokens.pop(0) != "}":
            raise _UnknownError("{")
        return inside
    if token.startswith("\\"):
        return _command(token[1:], tokens, upright)
    if token in "_^}":
        raise _UnknownError(token)
    if token == "'":
        return Markup("′")
    return Markup("<i>{}</i>").format(token) if token.isalpha() and not upright else escape(token)


def _command(command: str, tokens: list[str], upright: bool) -> Markup:
    if command in _GREEK:
        return Markup("<i>{}</i>").format(_GREEK[command])
    if command in _SIGNS:
        return escape(_SIGNS[command])
    if command in _UPRIGHT:
        return _atom(tokens, True)
    if command in _MARKS:
        under = _atom(tokens, upright)
        # The mark follows its letter, inside the element that makes it italic.
        text = str(under)
        return Markup(text[:-4] + _MARKS[command] + "</i>" if text.endswith("</i>") else text + _MARKS[command])
    raise _UnknownError(command)
