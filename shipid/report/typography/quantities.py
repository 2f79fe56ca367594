"""Quantities as a page shows them: symbol and name, label, and the unit a reader expects."""

from __future__ import annotations

from dataclasses import dataclass

from markupsafe import Markup

from shipid.declaration.model import Model
from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import FIELDS, display_factor, display_unit, label
from shipid.foundation.numbers import number
from shipid.generation.typesetting.symbols import symbol, symbol_mathml


@dataclass(frozen=True)
class Shown:
    """How a quantity is shown.

    Attributes
    ----------
    label : str
        What a figure or a table calls it.
    unit : str
        As it is printed.
    factor : float
        From the unit inside to the one that is shown.
    """

    label: str
    unit: str
    factor: float

    def number(self, value: float, digits: int = 3) -> str:
        """Return a value with so many significant digits, without its unit.

        Parameters
        ----------
        value : float
            In the unit inside.
        digits : int
            Significant digits.
        """
        return number(value * self.factor, digits)


def shown_field(name: str) -> Shown:
    """Return how a field of the vocabulary is shown.

    Parameters
    ----------
    name : str
        The field.
    """
    return Shown(FIELDS[name].label, pretty(FIELDS[name].display), display_factor(name, FIELDS[name].unit))


def shown(model: Model, name: str) -> Shown:
    """Return how a quantity of a model, or a field of a record, is shown.

    Parameters
    ----------
    model : Model
        The model.
    name : str
        The quantity.
    """
    if name in FIELDS:
        return shown_field(name)
    entry = model[name]
    unit = pretty(display_unit(name, entry.unit))
    return Shown(label(name, entry.quantity.meaning), unit, display_factor(name, entry.unit))


def symbol_markup(model: Model, name: str) -> Markup:
    """Return the symbol of a quantity; its name where the model does not know it.

    Parameters
    ----------
    model : Model
        The model.
    name : str
        The quantity.
    """
    latex = symbol(model[name]) if name in model else ""
    return Markup(f"<math>{symbol_mathml(latex, name)}</math>")


def named(model: Model, name: str) -> Markup:
    """Return the symbol of a quantity and, beside it, its name.

    Parameters
    ----------
    model : Model
        The model.
    name : str
        The quantity.
    """
    return symbol_markup(model, name) + Markup(' <code class="soft">{}</code>').format(name)
