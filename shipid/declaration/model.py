"""Models: components joined by name, as immutable data.

`evaluate` is the one place where equations are called. Whatever the values are (floats, quantities with
units, CasADi or SymPy symbols), the same methods run, so every use has the same equations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any

from shipid.declaration.component import SAMPLING_INTERVAL, Component, Scope, slug
from shipid.declaration.described import model_html, model_text
from shipid.declaration.quantity import COMPUTED, Equation, Kind, Quantity
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import given_unit
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import DeclarationError, UnknownNameError


@dataclass(frozen=True)
class Entry:
    """A quantity of a model: its declaration, the component that states it, and its equation.

    Attributes
    ----------
    quantity : Quantity
        Its declaration; ``kind`` is the role it has in the model ("given" means an input of the model).
    owner : type[Component]
        The component that states it (for an input: the first that reads it).
    equation : Equation or None
        What defines it.
    reads : tuple of tuple of str
        What the equation reads under another name: its own name for it, and the one in the model.
    """

    quantity: Quantity
    owner: type[Component]
    equation: Equation | None = None
    reads: tuple[tuple[str, str], ...] = ()

    @property
    def name(self) -> str:
        """Name of the quantity."""
        return self.quantity.name

    @property
    def unit(self) -> str:
        """Its declared SI unit."""
        return self.quantity.unit

    @property
    def given_unit(self) -> str:
        """The unit in which values of it are taken, see `shipid.declaration.vocabulary.given_unit`."""
        return given_unit(self.name, self.unit)

    def value(self, lookup: Callable[[str], Expression]) -> Expression:
        """Return the right-hand side of its equation.

        Parameters
        ----------
        lookup : callable
            Returns the value of a quantity of the model by its name.
        """
        assert self.equation is not None, self.name
        names = dict(self.reads)
        return self.equation.function(Scope(self.owner, lambda n: lookup(names.get(n, n))))

    def number(self, attribute: str) -> float | None:
        """Return a declared number in SI, or None where the declaration says none.

        Parameters
        ----------
        attribute : {"start", "low", "high", "spread", "nominal", "default", "noise"}
            Which one.
        """
        value = getattr(self.quantity, attribute)
        if value is None:
            return None
        if isinstance(value, str):
            return to_si(value, self.unit, f"{attribute} of '{self.name}' in {self.owner.__name__}")
        return float(value)


@dataclass(frozen=True)
class Model:
    """A ship model made by `shipid.join`. Immutable; every change returns a new model.

    Attributes
    ----------
    name : str
        Its name; parameter sets and the command line find it by this.
    entries : mapping of str to Entry
        Every quantity, in the order of declaration.
    components : tuple of type[Component]
        What it was joined from.
    extended : tuple of str
        Names of the models it was joined from: what is known of a ship under these names is known of it.
    """

    name: str
    entries: Mapping[str, Entry]
    components: tuple[type[Component], ...]
    extended: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "entries", MappingProxyType(dict(self.entries)))

    def __getitem__(self, name: str) -> Entry:
        try:
            return self.entries[name]
        except KeyError:
            raise UnknownNameError(f"quantity in model {self.name} called", name, self.entries) from None

    def __contains__(self, name: object) -> bool:
        return name in self.entries

    def __hash__(self) -> int:
        return hash((self.name, self.components, tuple(self.entries)))

    def __reduce__(self) -> tuple[object, ...]:
        return Model, (self.name, dict(self.entries), self.components, self.extended)

    @cached_property
    def known_as(self) -> tuple[str, ...]:
        """Names under which a parameter set may hold its coefficients: its own, those of the models it extends, its components'."""
        return tuple(dict.fromkeys((self.name, *self.extended, *(slug(c) for c in self.components))))

    def _names(self, *kinds: Kind) -> tuple[str, ...]:
        return tuple(n for n, e in self.entries.items() if e.quantity.kind in kinds and n != SAMPLING_INTERVAL)

    @cached_property
    def states(self) -> tuple[str, ...]:
        """Names of the states, in order."""
        return self._names("state")

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs, which no component states: rudder, speed, current, ..."""
        return self._names("given")

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Names of what identification may estimate."""
        return self._names("parameter")

    @cached_property
    def constants(self) -> tuple[str, ...]:
        """Names of the particulars of the ship."""
        return self._names("constant")

    @cached_property
    def derived(self) -> tuple[str, ...]:
        """Names of the quantities that follow from the others."""
        return self._names("derived")

    @cached_property
    def outputs(self) -> tuple[str, ...]:
        """Names of the sensor outputs."""
        return self._names("output")

    @cached_property
    def guards(self) -> tuple[str, ...]:
        """Names of the margins that are not negative while the model is valid."""
        return self._names("guard")

    @cached_property
    def delays(self) -> Mapping[str, str]:
        """The inputs that act later than they are given, and the parameter or constant that says by how much, in s."""
        dead_times = (e.quantity for n, e in self.entries.items() if n in self.parameters + self.constants)
        return MappingProxyType({q.delays: q.name for q in dead_times if q.delays in self.inputs})

    @property
    def is_sampled(self) -> bool:
        """Whether every state is defined by its next sample, so that no integration is needed."""
        return all(self._equation(s).kind == "next" for s in self.states)

    def _equation(self, name: str) -> Equation:
        equation = self[name].equation
        assert equation is not None, name
        return equation

    def __repr__(self) -> str:
        return model_text(self.name, [c.__name__ for c in self.components], self._quantities())

    def _repr_html_(self) -> str:
        """The model in a notebook: its equations typeset, and its quantities with their units."""
        import shipid

        equations = [(e.mathml, e.plain, e.source) for e in shipid.typeset(self)]
        return model_html(self.name, [c.__name__ for c in self.components], self._quantities(), equations)

    def _quantities(self) -> list[Quantity]:
        return [replace(e.quantity, name=n) for n, e in self.entries.items() if n != SAMPLING_INTERVAL]

    def impose(self, names: Iterable[str]) -> Model:
        """Return a new model in which published coefficients take the place of the parameters they define.

        A parameter that declares ``@p.instead`` becomes derived; the published coefficient becomes a constant.
        Imposing ``n3`` on Norrbin's model makes its ``b3`` equal to ``n3 b1``, whatever ``b1`` is.

        Parameters
        ----------
        names : iterable of str
            Derived quantities that are read by a parameter's ``@p.instead``.

        Raises
        ------
        DeclarationError
            If no parameter is defined by one of the names, or they do not determine each other.
        """
        entries = dict(self.entries)
        names = tuple(dict.fromkeys(names))
        taken: set[str] = set()
        for name in names:
            published = self[name]
            parameter = self.partner(name, taken)
            if parameter is None:
                raise DeclarationError(
                    f"'{name}' of model {self.name} is a {published.quantity.kind} quantity that follows from the "
                    f"others; it cannot be given. What can: {', '.join(self.parameters + self.constants)}."
                )
            taken.add(parameter)
            instead = self._equation(parameter)
            entries[name] = replace(published, quantity=replace(published.quantity, kind="constant"), equation=None)
            equation = Equation(instead.quantity, "equals", instead.function)
            entries[parameter] = replace(
                self[parameter], quantity=replace(self[parameter].quantity, kind="derived"), equation=equation
            )
        model = replace(self, entries=entries)
        find_loops(model, advice=f"Give the published coefficients that belong to {', '.join(names)} as well.")
        return model

    def partner(self, published: str, taken: Iterable[str] = ()) -> str | None:
        """Return the parameter whose ``@p.instead`` defines it by the published coefficient, or None.

        Parameters
        ----------
        published : str
            The published coefficient.
        taken : iterable of str
            Parameters that have their coefficient already: two published coefficients may define the same two parameters
            (a pair of time constants does).
        """
        own = [p for p in self.parameters if self[p].equation is not None and p not in set(taken)]
        for parameter in own:
            reads = reads_of(self, self[parameter])
            if published in reads and published not in self.parameters:
                return parameter
        return None


class Evaluation:
    """The equations of a model over given values, each evaluated once, when it is asked for.

    Parameters
    ----------
    model : Model
        Whose equations.
    values : mapping
        States, inputs, parameters, constants (and ``T_s`` where a discrete equation reads it) by name. A value given
        for a derived quantity is used instead of its equation.
    missing : callable, optional
        Called with a name that has no value; it returns one or raises.
    """

    def __init__(self, model: Model, values: Mapping[str, Any], missing: Callable[[str], Any] | None = None) -> None:
        self._model = model
        self._known = dict(values)
        self._missing = missing
        self._path: list[str] = []

    def __getitem__(self, name: str) -> Expression:
        if name in self._known:
            return self._known[name]
        entry = self._model[name]
        if entry.quantity.kind in COMPUTED:
            self._known[name] = self._call(name, entry)
            return self._known[name]
        if self._missing is not None:
            return self._missing(name)
        raise DeclarationError(f"the {entry.quantity.kind} '{name}' of model {self._model.name} has no value.")

    def _call(self, name: str, entry: Entry) -> Expression:
        if name in self._path:
            loop = " -> ".join([*self._path[self._path.index(name) :], name])
            owners = ", ".join(dict.fromkeys(f"{self._model[n].owner.__name__}.{n}" for n in self._path))
            raise DeclarationError(
                f"model {self._model.name} has an algebraic loop: {loop} ({owners}). One of them has to become a state, "
                "or be written without the others."
            )
        self._path.append(name)
        try:
            return self.equation(entry)
        finally:
            self._path.pop()

    def equation(self, entry: Entry) -> Expression:
        """Return the right-hand side of an entry's equation.

        Parameters
        ----------
        entry : Entry
            A quantity that an equation defines.
        """
        return entry.value(self.__getitem__)

    def right_hand_sides(self, kind: str) -> dict[str, Any]:
        """Return ``{name: right-hand side}`` of all equations of one kind.

        Parameters
        ----------
        kind : {"rate", "next", "equals"}
            Which kind.
        """
        return {
            n: self[n] if kind == "equals" else self.equation(e)
            for n, e in self._model.entries.items()
            if e.equation is not None and e.equation.kind == kind
        }


def reads_of(model: Model, entry: Entry) -> frozenset[str]:
    """Return the names an entry's equation reads directly, found by running it over numbers.

    Parameters
    ----------
    model : Model
        The model.
    entry : Entry
        A quantity of it that an equation defines.
    """
    import numpy as np

    read: set[str] = set()

    def lookup(name: str) -> Expression:
        read.add(name)
        return np.float64(0.7311)

    with np.errstate(all="ignore"):
        entry.value(lookup)
    return frozenset(read)


def find_loops(model: Model, advice: str = "") -> None:
    """Refuse derived quantities that define each other in a circle.

    Parameters
    ----------
    model : Model
        The model.
    advice : str
        What to do, at the end of the message.

    Raises
    ------
    DeclarationError
        With the names along the circle.
    """
    import numpy as np

    plain = {n: np.float64(0.7311) for n, e in model.entries.items() if e.quantity.kind not in COMPUTED}
    evaluation = Evaluation(model, plain | {SAMPLING_INTERVAL: np.float64(0.7311)})
    with np.errstate(all="ignore"):
        try:
            evaluation.right_hand_sides("equals")
        except DeclarationError as error:
            raise DeclarationError(f"{error} {advice}".strip()) from None
