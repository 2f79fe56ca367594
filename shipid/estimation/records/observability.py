"""Which directions of the state the sensors do not show, at the points where the filter was linearised.

The observability Gramian sums the information of every sample on the first state, ``W = sum Phi' H' R^-1 H Phi``, with the exact
transitions and sensor rows of the run. Scaled by the first standard deviations its eigenvalues are the information gained in
that of the first estimate. Along a direction whose eigenvalue is zero the samples hold no information: the error of the first
estimate stays, even where the filter's covariance shrinks.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from shipid.estimation.records.first_estimate import first_estimate
from shipid.estimation.records.run import FilterRun
from shipid.estimation.records.smoother import rows_before
from shipid.estimation.recursion.gate import TAKEN
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief
from shipid.foundation.result import DrawnResult, ResultEntry, table

if TYPE_CHECKING:
    import pandas as pd

#: Eigenvalue, as a share of the largest, below which it is zero but for rounding.
_NULL = 1e-12
#: Information below which a record hardly reduces the first standard deviation along a direction.
_WEAK = 1e-2
#: Part of a direction below which a state is not named in it.
_NAMED = 0.05
#: Largest number of samples used: transitions of an unstable ship over a long record would overflow.
_ENOUGH = 4000


@dataclass(frozen=True, repr=False)
class UnseenDirection(ResultEntry):
    """A combination of states that the record shows little of.

    Attributes
    ----------
    weights : mapping of str to float
        What changes together along it, in first standard deviations, largest 1.
    information : float
        Information gained, in units of that of the first estimate: 1 halves the variance; 0 if no sensor shows the direction.
    """

    weights: dict[str, float]
    information: float

    def __str__(self) -> str:
        parts = [f"{w:+.2g} {n}" for n, w in self.weights.items()]
        return " ".join(parts)


@dataclass(frozen=True, eq=False, repr=False)
class Observability(DrawnResult):
    """What a record shows of the state.

    Attributes
    ----------
    run : FilterRun
        The filtered record.
    information : ndarray, shape (states,)
        Eigenvalues of the scaled Gramian, smallest first.
    unobservable : tuple of UnseenDirection
        Directions that no sample shows.
    weak : tuple of UnseenDirection
        Directions along which the record hardly reduces the standard deviation.
    """

    run: FilterRun = field(repr=False)
    information: np.ndarray
    unobservable: tuple[UnseenDirection, ...]
    weak: tuple[UnseenDirection, ...]

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return self.run.states

    @property
    def messages(self) -> tuple[Notice, ...]:
        """One sentence for each direction that is not observable."""
        said = []
        for d in self.unobservable:
            if len(d.weights) == 1:
                said.append(
                    f"{next(iter(d.weights))} is not observable: no sensor shows it, and no measurement makes its error smaller."
                )
            else:
                names = " and ".join([", ".join(list(d.weights)[:-1]), list(d.weights)[-1]])
                said.append(
                    f"{names} are not observable apart: no sensor shows the combination {d}, whose error no "
                    "measurement makes smaller. Take one of them as known, or start from a consistent estimate."
                )
        return tuple(Notice(s, "not-observable") for s in said)

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {
            "unobservable": [dict(d.weights) for d in self.unobservable],
            "weak": [{"weights": dict(d.weights), "information": d.information} for d in self.weak],
        }

    def to_frame(self) -> pd.DataFrame:
        """Return the directions that the record shows little of as a pandas table."""
        rows = ({"direction": str(d), "information": d.information} for d in (*self.unobservable, *self.weak))
        return table(rows, "direction", ("information",))

    def text(self) -> str:
        """Return the result in lines of text."""
        head = f"what record {self.run.record} shows of {', '.join(self.states)}"
        lines = [f"  {said}" for said in self.messages]
        lines += [f"  weak: {d}, information {brief(d.information, 2)}" for d in self.weak]
        return "\n".join([head, *(lines or ["  every state is observable"])])


def observability(run: FilterRun) -> Observability:
    """Return what a filtered record shows of the state, in its longest stretch between holes of an input.

    Parameters
    ----------
    run : FilterRun
        The run, which holds where everything was linearised.

    Returns
    -------
    Observability
    """
    design, pieces = run.design, run.arranged.pieces
    longest = int(np.argmax([piece.stop - piece.start for piece in pieces]))
    piece = pieces[longest]
    out, control = run.out[piece][:_ENOUGH], run.control[piece][:_ENOUGH]
    full, places, n = design.layout.full, design.layout.control, design.layout.n
    before, inputs_before = rows_before(design, control, out, run.starts[longest])
    rows = [
        before,
        out[:, full["ahead"]],
        inputs_before,
        control[:, places["u"]],
        control[:, places["T"]],
        out[:, full["fate"]] == TAKEN,
    ]
    _, deviation = first_estimate(design, {})
    # The state is measured in first standard deviations from the start, so that no product loses digits.
    first = np.concatenate([np.diag(deviation).ravel(order="F"), np.zeros(n * n)])
    end, _ = design.gramian(first, np.concatenate(rows, axis=1), np.concatenate([design.p, design.r]))
    gramian = end[n * n :].reshape(n, n, order="F")
    values, vectors = np.linalg.eigh((gramian + gramian.T) / 2)
    values = np.maximum(values, 0.0)
    # An eigenvalue is zero in relation to the information on the same states in other directions.
    null = values <= _NULL * max(float(values[-1]), 1.0)
    names = design.model.states
    unobservable = tuple(UnseenDirection(w, 0.0) for w in _described(vectors[:, null], names))
    weak = tuple(
        UnseenDirection(_described(vectors[:, [i]], names)[0], float(values[i]))
        for i in np.flatnonzero(~null & (values < _WEAK))
    )
    return Observability(run, values, unobservable, weak)


def _described(basis: np.ndarray, names: tuple[str, ...]) -> list[dict[str, float]]:
    """Describe the space that columns span by directions of as few states as possible (reduced row echelon form)."""
    rows = basis.T.copy()
    used: list[int] = []
    for k in range(len(rows)):
        pivot = int(np.argmax(np.abs(rows[k]) * ~np.isin(np.arange(rows.shape[1]), used)))
        used.append(pivot)
        rows[k] /= rows[k, pivot]
        for other in range(len(rows)):
            if other != k:
                rows[other] -= rows[other, pivot] * rows[k]
    described = []
    for row in rows:
        row = row / row[np.argmax(np.abs(row))]
        order = np.argsort(-np.abs(row), kind="stable")
        described.append({names[i]: round(float(row[i]), 6) for i in order if abs(row[i]) > _NAMED})
    return described
