"""Quantities and the equations that define them: the words of the declaration language.

A quantity is declared by one line in the body of a component, and is data afterwards: nothing about it
changes when the class is built. The decorators ``@x.rate``, ``@x.next``, ``@y.equals`` and ``@p.instead``
return an `Equation`, which stands in the class under the name of the method it decorates.
"""

from __future__ import annotations

import importlib
import inspect
import operator
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

from shipid.foundation.aliases import Expression
from shipid.foundation.errors import DeclarationError

Kind = Literal["state", "given", "derived", "constant", "parameter", "output", "guard"]
EquationKind = Literal["rate", "next", "equals", "instead"]
Number = float | str | None

#: Which equation each kind of quantity may carry.
ALLOWED: dict[str, tuple[str, ...]] = {
    "state": ("rate", "next"),
    "derived": ("equals",),
    "output": ("equals",),
    "guard": ("equals",),
    "parameter": ("instead",),
    "given": (),
    "constant": (),
}
#: Kinds whose value follows from the others.
COMPUTED = ("derived", "output", "guard")


@dataclass(frozen=True)
class Equation:
    """One equation: what it defines, how, and the method that says it.

    Attributes
    ----------
    quantity : Quantity
        What it defines.
    kind : {"rate", "next", "equals", "instead"}
        Time derivative, next sample, value, or the value in terms of published coefficients.
    function : callable
        The method; it takes the scope (``self``) and returns the right-hand side.
    """

    quantity: Quantity = field(repr=False)
    kind: EquationKind
    function: Callable[[Any], Any] = field(repr=False)

    @property
    def target(self) -> str:
        """Name of the quantity it defines."""
        return self.quantity.name

    @property
    def name(self) -> str:
        """Name of the method."""
        return self.function.__name__

    @property
    def source(self) -> str:
        """The docstring of the method: where the equation comes from."""
        return inspect.cleandoc(self.function.__doc__ or "")

    @property
    def place(self) -> str:
        """File and line of the method, for messages."""
        code = self.function.__code__
        return f"{code.co_filename}:{code.co_firstlineno}"

    def __reduce__(self) -> tuple[object, ...]:
        # pickle finds a function by its name, and under that name the class holds this equation.
        return _restore, (self.quantity, self.kind, self.function.__module__, self.function.__qualname__)


def _restore(quantity: Quantity, kind: EquationKind, module: str, qualname: str) -> Equation:
    """Make an equation again in another process, from the place where its method is declared."""
    found: Any = operator.attrgetter(qualname)(importlib.import_module(module))
    return Equation(quantity, kind, found.function if isinstance(found, Equation) else found)


@dataclass(frozen=True)
class Quantity:
    """A named quantity of a component; made by `state`, `given`, `derived`, `constant`, `parameter`, `output`, `guard`.

    Attributes
    ----------
    kind : str
        What it is: state, given, derived, constant, parameter, output or guard.
    unit : str
        Coherent SI unit, radians for angles; ``"1"`` where it has none.
    meaning : str
        One line in words, with the sign convention where there is one.
    start, low, high : float, str or None
        Where an estimate or a simulation starts, and its bounds, in `unit` (or a string with its own unit).
    spread : float, str or None
        Standard deviation about `start`: of the prior of a parameter, or of the initial value of a state.
    nominal : float, str or None
        A typical size, used for scaling.
    name : str
        The name of the class attribute it is assigned to.
    latex : str or None
        The symbol in print; derived from the name when not given.
    wraps : bool
        Whether the angle wraps at a full turn.
    default : float, str or None
        The value of a given that nothing states and no trial holds, or of a constant no parameter set holds.
    dimensional : str or None
        For a coefficient made dimensionless with L and U: the unit its dimensional form has.
    prime : bool
        For a dimensional coefficient: `start`, `low` and `high` count in powers of L and L/U, so that one
        declaration fits a model on a pond and a tanker.
    estimated : bool
        Whether identification estimates the parameter unless told otherwise.
    measures : str or None
        For an output: the quantity it measures.
    noise : str or None
        For an output: its standard deviation per sample. For a state, an input or a parameter: the white noise a filter
        lets drive it, per sample in its own unit, or as a density per root second (``"0.01 deg/s^1.5"`` on a rate).
    delays : str or None
        For a parameter in s: the input that acts so much later than it is given.
    """

    kind: Kind
    unit: str
    meaning: str
    start: Number = None
    low: Number = None
    high: Number = None
    spread: Number = None
    nominal: Number = None
    latex: str | None = None
    wraps: bool = False
    default: Number = None
    dimensional: str | None = None
    prime: bool = False
    estimated: bool = True
    measures: str | None = None
    noise: str | None = None
    delays: str | None = None
    name: str = ""

    def __set_name__(self, owner: type, name: str) -> None:
        if not self.name:
            object.__setattr__(self, "name", name)

    def _equation(self, kind: EquationKind, function: Callable[[Any], Any]) -> Equation:
        if kind not in ALLOWED[self.kind]:
            allowed = ", ".join(f"@{a}" for a in ALLOWED[self.kind]) or "no equation"
            raise DeclarationError(
                f"a {self.kind} takes {allowed}, and '{function.__name__}' ({function.__code__.co_filename}:"
                f"{function.__code__.co_firstlineno}) gives it @{kind}."
            )
        return Equation(self, kind, function)

    def rate(self, function: Callable[[Any], Any]) -> Equation:
        """Decorate the method that returns the time derivative of a state.

        Parameters
        ----------
        function : callable
            The method; its docstring cites the source of the equation.

        Returns
        -------
        Equation
        """
        return self._equation("rate", function)

    def next(self, function: Callable[[Any], Any]) -> Equation:
        """Decorate the method that returns a state one sampling interval ``T_s`` later.

        Parameters
        ----------
        function : callable
            The method; its docstring cites the source of the equation.

        Returns
        -------
        Equation
        """
        return self._equation("next", function)

    def equals(self, function: Callable[[Any], Any]) -> Equation:
        """Decorate the method that returns a derived quantity or an output.

        Parameters
        ----------
        function : callable
            The method; its docstring cites the source of the equation.

        Returns
        -------
        Equation
        """
        return self._equation("equals", function)

    def instead(self, function: Callable[[Any], Any]) -> Equation:
        """Decorate the method that returns a parameter in terms of the coefficients that are published instead.

        Parameters
        ----------
        function : callable
            The method; its docstring cites the source of the equation.

        Returns
        -------
        Equation
        """
        return self._equation("instead", function)


def state(
    unit: str,
    meaning: str,
    *,
    start: Number = None,
    nominal: Number = None,
    wraps: bool = False,
    latex: str | None = None,
    spread: Number = None,
    noise: str | None = None,
) -> Expression:
    """Declare a state: it needs ``@x.rate`` (continuous) or ``@x.next`` (discrete).

    Parameters
    ----------
    unit : str
        Coherent SI unit.
    meaning : str
        One line in words.
    start : float or str, optional
        Initial value where nothing else says (0 when not given).
    nominal : float or str, optional
        A typical size, for scaling.
    wraps : bool
        Whether the angle wraps at a full turn.
    latex : str, optional
        The symbol in print.
    spread : float or str, optional
        Standard deviation of the initial value, where a filter starts.
    noise : str, optional
        The white noise that drives it in a filter: per sample, or per root second.

    Returns
    -------
    Quantity
        In the class body; in an equation ``self.NAME`` is its value.
    """
    return Quantity(
        "state", unit, meaning, start=start, nominal=nominal, wraps=wraps, latex=latex, spread=spread, noise=noise
    )


def given(
    unit: str,
    meaning: str,
    *,
    default: Number = None,
    latex: str | None = None,
    wraps: bool = False,
    noise: str | None = None,
) -> Expression:
    """Declare what the equations read and this component does not state: an input or another's quantity.

    Parameters
    ----------
    unit, meaning, latex, wraps
        As for `state`.
    default : float or str, optional
        Its value where no component states it and no trial holds it.
    noise : str, optional
        White noise it carries in a filter: per sample, or times root second.

    Returns
    -------
    Quantity
        In the class body; in an equation ``self.NAME`` is its value.
    """
    return Quantity("given", unit, meaning, default=default, latex=latex, wraps=wraps, noise=noise)


def derived(unit: str, meaning: str, *, latex: str | None = None, wraps: bool = False) -> Expression:
    """Declare a quantity that follows from the others: it needs ``@y.equals``.

    Parameters
    ----------
    unit, meaning, latex, wraps
        As for `state`.

    Returns
    -------
    Quantity
        In the class body; in an equation ``self.NAME`` is its value.
    """
    return Quantity("derived", unit, meaning, latex=latex, wraps=wraps)


def constant(unit: str, meaning: str, *, default: Number = None, latex: str | None = None) -> Expression:
    """Declare a particular of the ship; components that name the same constant share it.

    Parameters
    ----------
    unit, meaning, latex
        As for `state`.
    default : float or str, optional
        Its value where no parameter set holds it.

    Returns
    -------
    Quantity
        In the class body; in an equation ``self.NAME`` is its value.
    """
    return Quantity("constant", unit, meaning, default=default, latex=latex)


def parameter(
    unit: str,
    meaning: str,
    *,
    start: Number = None,
    low: Number = None,
    high: Number = None,
    spread: Number = None,
    nominal: Number = None,
    latex: str | None = None,
    dimensional: str | None = None,
    prime: bool = False,
    estimated: bool = True,
    noise: str | None = None,
    delays: str | None = None,
) -> Expression:
    """Declare a coefficient that identification may estimate.

    Parameters
    ----------
    unit, meaning, nominal, latex
        As for `state`.
    start, low, high : float or str, optional
        Where the search starts, and its bounds.
    spread : float or str, optional
        Standard deviation of its prior about `start`; used when it is fitted for prediction.
    dimensional : str, optional
        For a coefficient made dimensionless with L and U: the unit its dimensional form has, such as ``"1/s"`` for K*.
    prime : bool
        For a dimensional coefficient: `start`, `low` and `high` are in the prime system (powers of L and L/U).
    estimated : bool
        Whether it is estimated unless the user chooses.
    noise : str, optional
        Noise of its random walk where a filter estimates it: per sample, or per root second.
    delays : str, optional
        For a dead time in s: the input that acts so much later than it is given. Records of inputs are shifted by it.

    Returns
    -------
    Quantity
        In the class body; in an equation ``self.NAME`` is its value.
    """
    return Quantity(
        "parameter",
        unit,
        meaning,
        start=start,
        low=low,
        high=high,
        spread=spread,
        nominal=nominal,
        latex=latex,
        dimensional=dimensional,
        prime=prime,
        estimated=estimated,
        noise=noise,
        delays=delays,
    )


def output(unit: str, meaning: str, *, measures: str | None = None, noise: str | None = None) -> Expression:
    """Declare what a sensor shows, where that is not simply a quantity: it needs ``@z.equals``.

    Parameters
    ----------
    unit, meaning
        As for `state`.
    measures : str, optional
        The quantity it measures.
    noise : str, optional
        Its standard deviation per sample, as in ``"0.2 deg"``.

    Returns
    -------
    Quantity
        In the class body; in an equation ``self.NAME`` is its value.
    """
    return Quantity("output", unit, meaning, measures=measures, noise=noise)
