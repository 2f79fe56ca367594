"""Components: the classes in which quantities and equations are declared."""

from __future__ import annotations

import inspect
import re
import types
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import ClassVar

from shipid.declaration.quantity import COMPUTED, Equation, Quantity
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import DeclarationError, nearest

#: The name under which an equation reads the sampling interval.
SAMPLING_INTERVAL = "T_s"
_RESERVED = ("t",)


class _Body(dict[str, object]):
    """The body of a component while it is read: what is declared in it is not declared again, or lost to a method, without a word."""

    def __init__(self, component: str) -> None:
        super().__init__()
        self._component = component
        self._lines: dict[str, int] = {}

    def __setitem__(self, name: str, value: object) -> None:
        before, here = self.get(name), inspect.currentframe()
        frame = here and here.f_back
        line = frame.f_lineno if frame else 0
        if isinstance(before, Quantity | Equation):
            what = "the method of an equation" if isinstance(before, Equation) else f"a quantity ({before.kind})"
            where = f" ({frame.f_code.co_filename})" if frame else ""
            raise DeclarationError(
                f"component {self._component} uses the name '{name}' twice{where}: in line {self._lines[name]} for {what}, "
                f"and in line {line} again, where it would be lost. Give one of them another name."
            )
        self._lines[name] = line
        super().__setitem__(name, value)


class _Declaration(type):
    """The class of components, which reads their bodies."""

    @classmethod
    def __prepare__(cls, name: str, bases: tuple[type, ...], /, **kwargs: object) -> _Body:
        return _Body(name)

    def __new__(cls, name: str, bases: tuple[type, ...], body: dict[str, object], **kwargs: object) -> _Declaration:
        return super().__new__(cls, name, bases, dict(body), **kwargs)


class Component(metaclass=_Declaration):
    """A part of a ship model: quantities with units, and one method for each equation.

    Subclass it, declare quantities with `state`, `given`, `derived`, `constant`, `parameter`, `output` or `guard`, and
    write one decorated method for each equation; NumPy's functions and arithmetic are all an equation needs.
    A subclass of a component inherits its quantities and equations; a method of the same name replaces the
    equation. Components are never instantiated: `shipid.join` makes a model of them.
    """

    #: Coefficients that a loading of the ship does not change: those of her gear and of a logger.
    same_at_any_loading: ClassVar[tuple[str, ...]] = ()
    __quantities__: ClassVar[dict[str, Quantity]] = {}
    __equations__: ClassVar[dict[str, Equation]] = {}

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        quantities: dict[str, Quantity] = {}
        methods: dict[str, Equation] = {}
        for base in reversed(cls.__mro__):
            for name, member in vars(base).items():
                if isinstance(member, Quantity):
                    quantities.pop(name, None)
                    quantities[name] = member
                elif isinstance(member, Equation):
                    methods[name] = member
                elif isinstance(member, types.FunctionType) and name in methods:
                    methods[name] = Equation(methods[name].quantity, methods[name].kind, member)
        cls.__quantities__ = quantities
        cls.__equations__ = _by_target(cls, methods)
        for name, quantity in quantities.items():
            _check_quantity(cls, name, quantity)

    def __new__(cls, *_: object, **__: object) -> Component:  # noqa: D102
        raise DeclarationError(
            f"{cls.__name__} is a declaration and is not instantiated: pass the class to shipid.join."
        )


def declared_quantities(component: type[Component]) -> Mapping[str, Quantity]:
    """Return the quantities that a component declares, by name, in the order of declaration.

    Parameters
    ----------
    component : type[Component]
        The component.
    """
    return MappingProxyType(component.__quantities__)


def declared_equations(component: type[Component]) -> Mapping[str, Equation]:
    """Return the equations of a component by the quantity each defines.

    Parameters
    ----------
    component : type[Component]
        The component.
    """
    return MappingProxyType(component.__equations__)


def slug(component: type[Component]) -> str:
    """Return the name of a component as the command line writes it: DeKeizer is ``de-keizer``.

    Parameters
    ----------
    component : type[Component]
        The component.
    """
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", component.__name__).lower()


def _by_target(cls: type[Component], methods: dict[str, Equation]) -> dict[str, Equation]:
    equations: dict[str, Equation] = {}
    for equation in methods.values():
        if equation.target in equations:
            other = equations[equation.target]
            raise DeclarationError(
                f"component {cls.__name__} defines '{equation.target}' twice: in '{other.name}' ({other.place}) "
                f"and in '{equation.name}' ({equation.place})."
            )
        equations[equation.target] = equation
    return equations


def _check_quantity(cls: type[Component], name: str, quantity: Quantity) -> None:
    if name in _RESERVED or name.startswith("_") or name.endswith("_"):
        why = (
            "t is the time of a record, and what changes with it is an input, declared as given(...)"
            if name in _RESERVED
            else "no quantity begins or ends with _"
        )
        raise DeclarationError(
            f"component {cls.__name__} may not name a quantity '{name}': the name is reserved; {why}."
        )
    if name == SAMPLING_INTERVAL and quantity.kind != "given":
        raise DeclarationError(
            f"component {cls.__name__} states '{SAMPLING_INTERVAL}', which is the sampling interval: declare it as given('s', ...)."
        )
    equation = cls.__equations__.get(name)
    if quantity.kind == "given" and equation is not None:
        raise DeclarationError(
            f"'{name}' of {cls.__name__} is given, and '{equation.name}' ({equation.place}) is its equation. Where it is inherited from two "
            "components, join them instead."
        )
    if quantity.kind == "state" and equation is None:
        raise DeclarationError(f"state '{name}' of {cls.__name__} has no equation: add a method under @{name}.rate.")
    if quantity.kind in COMPUTED and equation is None:
        raise DeclarationError(
            f"{quantity.kind} '{name}' of {cls.__name__} has no equation: add a method under @{name}.equals."
        )
    if not isinstance(quantity.unit, str):
        raise DeclarationError(
            f"'{name}' of {cls.__name__} has the unit {quantity.unit!r}: write it in quotes, as in 'm/s', or '1' for a number."
        )
    if not quantity.meaning.strip():
        raise DeclarationError(f"'{name}' of {cls.__name__} has no meaning: write one line in words.")


class Scope:
    """What an equation sees as ``self``: the quantities its component declares, its helpers, and nothing else.

    Parameters
    ----------
    component : type[Component]
        The component whose equation runs.
    lookup : callable
        Returns the value of a quantity by its name.
    """

    __slots__ = ("_component", "_lookup")

    def __init__(self, component: type[Component], lookup: Callable[[str], Expression]) -> None:
        self._component = component
        self._lookup = lookup

    def __getattr__(self, name: str) -> Expression:
        component = self._component
        if name in component.__quantities__:
            return self._lookup(name)
        member = getattr(component, name, None)
        if isinstance(member, types.FunctionType):
            return types.MethodType(member, self)
        if isinstance(member, property) and member.fget is not None:
            return member.fget(self)
        if member is not None and not isinstance(member, Equation):
            return member
        raise DeclarationError(
            f"an equation of {component.__name__} reads '{name}', which the component does not declare. "
            f"{nearest(name, component.__quantities__)}Declare what another component states as given(...)."
        )
