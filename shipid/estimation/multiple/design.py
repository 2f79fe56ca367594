"""The design of a multiple-model filter: its settings, read and checked once, and the cycle generated from them."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import shown
from shipid.estimation.design import FilterDesign
from shipid.estimation.errors import ModeError
from shipid.estimation.multiple.cycle.cycle import CycleSettings, make_cycle
from shipid.estimation.multiple.cycle.layout import CycleLayout
from shipid.estimation.multiple.cycle.moves import DisplacedMoves, GridMoves, Moves
from shipid.estimation.multiple.structures import AdaptiveGrid, Displaced, Structure
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.numbers import brief
from shipid.foundation.result import Printed
from shipid.generation.loop import Loop, make_loop


@dataclass(frozen=True, eq=False, repr=False)
class MultipleModelDesign(Printed):
    """A multiple-model filter as its settings define it, SI.

    Attributes
    ----------
    modes : mapping of str to FilterDesign
        The filter of each mode, by name.
    transition : ndarray, shape (modes, modes)
        Transition probabilities from each mode (row) to each.
    per : float or None
        The interval in s they hold for; None where they hold from sample to sample.
    probabilities : ndarray, shape (modes,)
        Of the modes before the first sample.
    settings : CycleSettings
        What the generated cycle does.
    compiled : bool
        Whether to compile.
    """

    modes: Mapping[str, FilterDesign]
    transition: np.ndarray
    per: float | None
    probabilities: np.ndarray
    settings: CycleSettings
    compiled: bool
    _loops: dict[bool, Loop] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the modes, in order."""
        return tuple(self.modes)

    @functools.cached_property
    def designs(self) -> tuple[FilterDesign, ...]:
        """The filters of the modes, in order."""
        return tuple(self.modes.values())

    @property
    def first(self) -> FilterDesign:
        """The first mode: its states are those of the combined estimate."""
        return self.designs[0]

    @property
    def states(self) -> tuple[str, ...]:
        """States of the combined estimate."""
        return self.first.model.states

    @property
    def measured(self) -> tuple[str, ...]:
        """The measured quantities, in the order of the sensors."""
        return self.first.measured

    @functools.cached_property
    def layout(self) -> CycleLayout:
        """Where everything stands in the vectors of the cycle."""
        return CycleLayout(self.designs, self.settings.moves is not None, self.settings.correlated)

    @functools.cached_property
    def constants(self) -> np.ndarray:
        """Coefficients and noise levels of all modes, in the order the cycle takes them."""
        return np.concatenate([*(d.p for d in self.designs), *(d.q for d in self.designs)])

    @functools.cached_property
    def parameter(self) -> np.ndarray:
        """The moving parameter of each mode at the start, SI, shape (modes,); empty where none moves."""
        moves = self.settings.moves
        if moves is None:
            return np.empty(0)
        return np.array([d.instruments.inputs[moves.parameter] for d in self.designs])

    def loop(self, full: bool = True) -> Loop:
        """Return the cycle with the loop over scans, compiled once.

        Parameters
        ----------
        full : bool
            Whether it returns the estimates of each mode as well.
        """
        if full not in self._loops:
            self._loops[full] = make_loop(make_cycle(self.designs, self.settings, full), self.compiled)
        return self._loops[full]

    def __repr__(self) -> str:
        sensors = ", ".join(
            f"{n} ({shown(level, self.first.model[n].quantity.measures or n, self.first.model[n].unit, digits=3)})"
            for n, level in zip(self.measured, self.first.r)
        )
        models = ", ".join(f"{n} ({d.base.name})" for n, d in self.modes.items())
        return f"<multiple-model filter: modes {models}; states {', '.join(self.states)}; sensors {sensors}>"


def read_moves(structure: Structure, modes: Mapping[str, FilterDesign]) -> Moves | None:
    """Return how the modes' parameter moves.

    Parameters
    ----------
    structure : Displaced, AdaptiveGrid or None
        As given.
    modes : mapping of str to FilterDesign
        The modes.

    Raises
    ------
    ModeError
        If a mode lacks the parameter or its displacement, bounds are empty or overlap, or a grid is not one.
    """
    if structure is None:
        return None
    for name, design in modes.items():
        if structure.parameter not in design.instruments.inputs:
            raise ModeError(
                f"mode '{name}' has no constant input '{structure.parameter}', the parameter that moves: give it with "
                f"Mode(..., inputs={{'{structure.parameter}': ...}})."
            )
    unit = next(iter(modes.values())).model[structure.parameter].unit
    if isinstance(structure, AdaptiveGrid):
        return _grid(structure, modes, unit)
    return _displaced(structure, modes, unit)


def _displaced(given: Displaced, modes: Mapping[str, FilterDesign], unit: str) -> DisplacedMoves:
    for name, design in modes.items():
        if given.displacement not in design.model.states:
            raise ModeError(
                f"mode '{name}' has no state '{given.displacement}', the displacement of '{given.parameter}': use an augmented model."
            )
    bounds = given.bounds or {}
    for name in bounds:
        if name not in modes:
            raise UnknownNameError("mode with bounds called", name, modes)
    low, high = np.full(len(modes), -np.inf), np.full(len(modes), np.inf)
    for j, name in enumerate(modes):
        if name in bounds:
            low[j], high[j] = (to_si(v, unit, f"bound of '{given.parameter}' in mode '{name}'") for v in bounds[name])
            if low[j] > high[j]:
                raise ModeError(
                    f"the bounds of '{given.parameter}' in mode '{name}' run from {bounds[name][0]} to {bounds[name][1]}."
                )
            own = modes[name].instruments.inputs[given.parameter]
            if not low[j] - 1e-12 <= own <= high[j] + 1e-12:
                raise ModeError(
                    f"mode '{name}' starts with '{given.parameter}' at {brief(own, 6)} {unit}, outside its bounds of {bounds[name][0]} to "
                    f"{bounds[name][1]}."
                )
    names = list(modes)
    bounded = sorted((j for j in range(len(names)) if names[j] in bounds), key=lambda j: (low[j], high[j]))
    for a, b in pairwise(bounded):
        if low[b] < high[a]:
            raise ModeError(
                f"the bounds of modes '{names[a]}' and '{names[b]}' overlap between {brief(low[b], 6)} and {brief(min(high[a], high[b]), 6)} {unit}: "
                "modes that can be the same cannot be told apart. Separate them."
            )
    places = [d.model.states.index(given.displacement) for d in modes.values()]
    return DisplacedMoves(given.parameter, tuple(places), low, high, given.variable)


def _grid(given: AdaptiveGrid, modes: Mapping[str, FilterDesign], unit: str) -> GridMoves:
    names = list(modes)
    if len(given.order) != 3 or sorted(given.order) != sorted(names):
        raise ModeError(
            f"an adaptive grid has three modes, upper, middle and lower: its order names {', '.join(given.order)}, and the modes are "
            f"{', '.join(names)}."
        )
    values = [modes[n].instruments.inputs[given.parameter] for n in given.order]
    if not values[0] > values[1] > values[2]:
        raise ModeError(
            f"the modes {', '.join(given.order)} of the grid start with '{given.parameter}' at {values}: it must decrease."
        )
    closest, widest = (
        to_si(v, unit, f"distance of neighbours on the grid of '{given.parameter}'")
        for v in (given.closest, given.widest)
    )
    if not 0 < closest <= widest:
        raise ModeError(
            f"the distance of neighbours on the grid lies between {given.closest} and {given.widest}: give 0 < closest <= widest."
        )
    limit = (
        max(abs(v) for v in values)
        if given.limit is None
        else to_si(given.limit, unit, f"limit of '{given.parameter}'")
    )
    order = tuple(names.index(n) for n in given.order)
    return GridMoves(
        given.parameter, (order[0], order[1], order[2]), closest, widest, limit, given.improbable, given.dominant
    )
