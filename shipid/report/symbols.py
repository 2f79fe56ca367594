"""LaTeX symbols of quantities as simple HTML: Greek letters, sub- and superscripts, dots."""

from __future__ import annotations

import re

from markupsafe import Markup, escape

_TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[{}_^]|\s+|.", re.DOTALL)
_GREEK = dict(
    zip(
        "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon phi chi psi "
        "omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega varphi varepsilon".split(),
        "αβγδεζηθικλμνξπρστυφχψωΓΔΘΛΞΠΣΦΨΩφε",
    )
)
_MARKS = {"dot": "\u0307", "ddot": "\u0308", "bar": "\u0304", "hat": "\u0302", "tilde": "\u0303"}
_SIGNS = {"infty": "∞", "prime": "′", "circ": "°", "cdot": "·"}
_UPRIGHT = ("mathrm", "text", "operatorname")


class _Unknown(ValueError):
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
            raise _Unknown(tokens[0])
    except (_Unknown, IndexError):
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
            raise _Unknown("{")
        return inside
    if token.startswith("\\"):
        return _command(token[1:], tokens, upright)
    if token in "_^}":
        raise _Unknown(token)
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
        return Markup(text[:-4] + _MARKS[command] + "</i>" if text.endswith("</i>") else text + _MARKS[command])  # noqa: S704
    raise _Unknown(command)
