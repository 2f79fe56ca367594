"""The likelihood of a record through the filter, with its exact gradient by coefficients, noise levels and first states.

One pass over the record gives the value, the gradient and Fisher's expected information; the generated step is that of
`shipid.estimation.recursion.score`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.records.arrangement import FilterRecord, arrange
from shipid.estimation.records.controls import controls_of
from shipid.estimation.records.first_estimate import carried_vector, first_carried
from shipid.estimation.records.restart import first_behind
from shipid.estimation.records.triangles import unpacked
from shipid.estimation.recursion import covariance_form
from shipid.estimation.recursion.layout import StepLayout, total
from shipid.estimation.recursion.score import Unknown, bare
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.result import Result
from shipid.generation.loop import Loop


@dataclass(frozen=True, eq=False, repr=False)
class Likelihood(Result):
    """Logarithm of the likelihood of one record as a function of unknowns; made by `make_likelihood`.

    Attributes
    ----------
    unknowns : tuple of str
        Coefficients by name, ``noise:NAME`` and ``sensor:NAME`` (natural logarithms of levels), ``x0:STATE``,
        ``bias:INPUT``.
    start : ndarray, shape (unknowns,)
        Their values in the filter.
    """

    TABLE: ClassVar[str] = "unknowns"
    UNITS: ClassVar[Mapping[str, str]] = {"start": "SI"}

    unknowns: tuple[str, ...]
    start: np.ndarray
    _design: FilterDesign = field(repr=False)
    _carried: tuple[np.ndarray, ...] = field(repr=False)
    _controls: tuple[np.ndarray, ...] = field(repr=False)
    _places: tuple[Unknown, ...] = field(repr=False)
    _inputs: int = field(repr=False)

    def __call__(self, q: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Evaluate at unknowns.

        Parameters
        ----------
        q : ndarray, shape (unknowns,)
            SI; natural logarithms of noise levels.

        Returns
        -------
        value : float
            Logarithm of the likelihood; minus infinity where the filter diverges.
        gradient : ndarray, shape (unknowns,)
        information : ndarray, shape (unknowns, unknowns)
            Fisher's, summed over the record.
        """
        size = len(self.unknowns)
        value, gradient, information = 0.0, np.zeros(size), np.zeros((size, size))
        for end, out in self._passes(q, self._design.score(self._places)):
            with np.errstate(invalid="ignore", over="ignore"):  # a filter that diverges is told below
                value, gradient = value + float(out[:, 0].sum()), gradient + out[:, 1:].sum(axis=0)
            information = information + unpacked(end[None, end.size - covariance_form.size(size) :], size)[0]
        if not (np.isfinite(value) and np.isfinite(gradient).all()):
            return -np.inf, np.zeros(size), np.zeros((size, size))
        return value, gradient, information

    def innovations(self, q: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the innovations in standard deviations and their derivatives, one pair for each stretch between holes of an input.

        Parameters
        ----------
        q : ndarray, shape (unknowns,)
            SI; natural logarithms of noise levels.

        Returns
        -------
        list of (ndarray, ndarray)
            Shapes (sensors, N) and (sensors, N, unknowns); NaN and zero where a sample is missing.
        """
        pairs = []
        for _, out in self._passes(q, self._design.score(self._places, innovations=True)):
            sensors = out.shape[1] // (2 + len(self.unknowns))
            there, series = out[:, :sensors].T > 0, out[:, sensors : 2 * sensors].T
            slopes = out[:, 2 * sensors :].reshape(len(out), len(self.unknowns), sensors).transpose(2, 0, 1)
            pairs.append((np.where(there, series, np.nan), slopes))
        return pairs

    def _passes(self, q: np.ndarray, loop: Loop) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """What is carried at the end of each stretch, and its outputs sample by sample."""
        first, constants = self._carried[0].copy(), self._design.constants.copy()
        shift = np.zeros(self._inputs)
        for value, place in zip(q, self._places):
            if place.kind == "constant":
                constants[place.at] = value
            elif place.kind == "level":
                constants[place.at] = np.exp(value)
            elif place.kind == "state":
                first[place.at] = value
            else:
                shift[place.at] += value
        # Behind a hole of an input everything starts anew.
        for z0, control in zip((first, *self._carried[1:]), self._controls):
            if shift.any():
                control = control.copy()
                control[:, : self._inputs] += shift
            yield loop(z0, control, constants)


def make_likelihood(
    design: FilterDesign, record: FilterRecord, unknowns: Sequence[str], *, filled: bool = False
) -> Likelihood:
    """Generate the likelihood of a record; samples are not gated, since a gate has no derivative.

    The stretches between holes of an input count as independent records; an unknown first state is that of the first one.

    Parameters
    ----------
    design : FilterDesign
        The filter (covariance form).
    record : Trial or mapping of str to ndarray
        What was measured.
    unknowns : sequence of str
        See `Likelihood`.
    filled : bool
        Whether the inputs of the record are known to be whole.

    Returns
    -------
    Likelihood

    Raises
    ------
    UnknownNameError
        If the filter has no such unknown.
    """
    layout = StepLayout(design.equations, bare(design.step_settings))
    places = tuple(_place(design, layout, n) for n in unknowns)
    arranged = arrange(design.instruments, record, filled=filled)
    first = first_carried(design, record, arranged)
    behind = (carried_vector(design, first_behind(design, arranged, h), arranged.inputs[h.row]) for h in arranged.holes)
    starts = [z[: total(layout.carried)] for z in (first, *behind)]
    seeds = [np.zeros((z.size, len(unknowns))) for z in starts]
    for k, seed in enumerate(seeds):
        for j, place in enumerate(places):
            if place.kind == "state" and k == 0:
                seed[place.at, j] = 1.0
            elif place.kind == "input":
                seed[layout.carried["u"].start + place.at, j] = 1.0
    information = np.zeros(covariance_form.size(len(unknowns)))
    control = controls_of(design, arranged)
    return Likelihood(
        tuple(unknowns),
        np.array([_value(design.constants, starts[0], p) for p in places]),
        design,
        tuple(np.concatenate([z, seed.ravel(order="F"), information]) for z, seed in zip(starts, seeds)),
        tuple(control[piece] for piece in arranged.pieces),
        places,
        layout.inputs,
    )


def _value(constants: np.ndarray, carried: np.ndarray, place: Unknown) -> float:
    if place.kind == "input":
        return 0.0
    value = float((carried if place.kind == "state" else constants)[place.at])
    return float(np.log(value)) if place.kind == "level" else value


def _place(design: FilterDesign, layout: StepLayout, name: str) -> Unknown:
    """Where an unknown stands: among the constants, the first states or the inputs."""
    head, colon, tail = name.partition(":")
    constants, model = layout.constants, design.model
    rows: dict[str, tuple[Literal["level", "state", "input"], int, tuple[str, ...]]] = {
        "noise": ("level", constants["q"].start, tuple(s.name for s in design.sources)),
        "sensor": ("level", constants["r"].start, design.measured),
        "x0": ("state", layout.carried["x"].start, model.states),
        "bias": ("input", 0, model.inputs),
    }
    coefficients = design.system.coefficients
    if not colon and name in coefficients:
        return Unknown("constant", constants["p"].start + coefficients.index(name))
    if head in rows and tail in rows[head][2]:
        kind, begin, names = rows[head]
        return Unknown(kind, begin + names.index(tail))
    known = [*coefficients, *(f"{head}:{n}" for head, (_, _, names) in rows.items() for n in names)]
    raise UnknownNameError("unknown of the likelihood called", name, known)
