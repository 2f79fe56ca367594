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


def shown(model: Model, name: str) -> Shown:
    """Return how a quantity of a model, or a field of a record, is shown.

    Parameters
    ----------
    model : Model
        The model.
    name : str
        The quantity.
    """
    entry = model.entries.get(name)
    inside = FIELDS[name].unit if name in FIELDS else entry.unit if entry is not None else "1"
    called = label(name, "" if entry is None else entry.quantity.meaning)
    return Shown(called, pretty(display_unit(name, inside)), display_factor(name, inside))


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
