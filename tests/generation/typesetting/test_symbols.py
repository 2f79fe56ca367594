"""Symbols: LaTeX made of names, and MathML made of LaTeX."""

from __future__ import annotations

from xml.dom import minidom

import pytest

from shipid.generation.typesetting.symbols import symbol, symbol_mathml, symbol_of
from shipid.parameters.catalogue import known_models


@pytest.mark.parametrize(
    ("name", "latex"),
    [
        ("K", "K"),
        ("tau", r"\tau"),
        ("tau_u", r"\tau_{u}"),
        ("tau1", r"\tau_{1}"),
        ("alpha3", r"\alpha_{3}"),
        ("helm_clock", r"\mathrm{helm}_{\mathrm{clock}}"),
        ("Y_delta", r"Y_{\delta}"),
        ("K_u_star", r"K_{u,\mathrm{star}}"),
    ],
)
def test_symbols_made_of_names(name: str, latex: str) -> None:
    assert symbol_of(name) == latex


@pytest.mark.parametrize(
    ("latex", "shown"),
    [
        (r"\tau_{u}^*", "<msubsup><mi>τ</mi><mi>u</mi><mo>*</mo></msubsup>"),
        (r"\dot r_d", '<msub><mover accent="true"><mi>r</mi><mo>˙</mo></mover><mi>d</mi></msub>'),
        ("Y_{vv}'", "<msubsup><mi>Y</mi><mrow><mi>v</mi><mi>v</mi></mrow><mo>′</mo></msubsup>"),
        (
            r"a_{\mathrm{wind},\delta}",
            '<msub><mi>a</mi><mrow><mi mathvariant="normal">wind</mi><mo>,</mo><mi>δ</mi></mrow></msub>',
        ),
        (r"\Delta u", '<mrow><mi mathvariant="normal">Δ</mi><mi>u</mi></mrow>'),
        ("b_1", "<msub><mi>b</mi><mn>1</mn></msub>"),
        ("<b>", "<mrow><mo>&lt;</mo><mi>b</mi><mo>&gt;</mo></mrow>"),
    ],
)
def test_latex_becomes_mathml(latex: str, shown: str) -> None:
    assert symbol_mathml(latex, "name") == shown


@pytest.mark.parametrize("latex", [r"\frac{a}{b}", "a_{", "a_b_c", "", "}", r"\mathrm{a b_c}"])
def test_what_is_not_understood_becomes_the_name(latex: str) -> None:
    assert symbol_mathml(latex, "<name>") == '<mi mathvariant="normal">&lt;name&gt;</mi>'


def test_the_dot_of_a_rate_stands_over_the_letter() -> None:
    dotted = '<mover accent="true"><mi>r</mi><mo>˙</mo></mover>'
    assert symbol_mathml("r^*", "r_star", rate=True) == f"<msup>{dotted}<mo>*</mo></msup>"


def test_every_declared_symbol_is_understood() -> None:
    for model in known_models().values():
        for name, entry in model.entries.items():
            shown = symbol_mathml(symbol(entry), name)
            assert minidom.parseString(shown).documentElement is not None
            upright = f'<mi mathvariant="normal">{name}</mi>'
            assert shown != upright or symbol(entry) == rf"\mathrm{{{name}}}", (model.name, name)
