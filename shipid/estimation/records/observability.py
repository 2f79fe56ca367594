"""Which directions of the state the sensors tell nothing of, at the points where the filter was linearised.

The observability Gramian adds up what every sample tells of the first state, ``W = sum Phi' H' R^-1 H Phi``, with the exact
transitions and sensor rows of the run. Scaled by the first standard deviations its eigenvalues are information gained over
belief: along a direction whose eigenvalue is zero no sample ever shows anything, and what was believed at the start stays,
whatever the filter's covariance makes of it later.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from shipid.estimation.records.vectors import first_estimate
from shipid.estimation.recursion.step import TAKEN
from shipid.generation.loop import Loop, make_loop

if TYPE_CHECKING:
    from shipid.estimation.kalman import ExtendedKalmanFilter
    from shipid.estimation.records.run import FilterRun

#: Eigenvalue, as a share of the largest, that rounding leaves of a zero.
_NULL = 1e-12
#: Information below which a record makes a direction no surer than it was believed to be.
_WEAK = 1e-2
#: Part of a direction below which a state is not named in it.
_NAMED = 0.05
#: Samples that are looked at: transitions of an unstable ship over a long record would overflow.
_ENOUGH = 4000


@dataclass(frozen=True)
class Direction:
    """A combination of states that the record shows little of.

    Attributes
    ----------
    weights : mapping of str to float
        What changes together along it, in first standard deviations, largest 1.
    information : float
        Gained over believed: 1 halves the variance; 0 for one that nothing shows.
    """

    weights: dict[str, float]
    information: float

    def __str__(self) -> str:
        parts = [f"{w:+.2g} {n}" for n, w in self.weights.items()]
        return " ".join(parts)


@dataclass(frozen=True)
class Observability:
    """What a record tells of the state.

    Attributes
    ----------
    states : tuple of str
        Names of the states.
    information : ndarray, shape (states,)
        Eigenvalues of the scaled Gramian, smallest first.
    unobservable : tuple of Direction
        Directions that no sample shows anything of.
    weak : tuple of Direction
        Directions that the record hardly makes surer.
    """

    states: tuple[str, ...]
    information: np.ndarray
    unobservable: tuple[Direction, ...]
    weak: tuple[Direction, ...]

    @property
    def messages(self) -> tuple[str, ...]:
        """One sentence for each direction that is not observed."""
        said = []
        for d in self.unobservable:
            if len(d.weights) == 1:
                said.append(
                    f"{next(iter(d.weights))} is not observable: no sensor shows it, and it keeps the error it starts with."
                )
            else:
                names = " and ".join([", ".join(list(d.weights)[:-1]), list(d.weights)[-1]])
                said.append(
                    f"{names} are not observable apart: no sensor shows the combination {d}, which keeps the error it starts "
                    "with. Take one of them as known, or start from a consistent estimate."
                )
        return tuple(said)

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return {
            "unobservable": [dict(d.weights) for d in self.unobservable],
            "weak": [{"weights": dict(d.weights), "information": d.information} for d in self.weak],
            "messages": list(self.messages),
        }


def make_gramian(kalman: ExtendedKalmanFilter) -> Loop:
    """Return the loop that adds up the Gramian of a filter.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter.
    """
    eq, layout = kalman.equations, kalman.layout
    n = layout.n
    # Noise is no part of what the state shows; its first value tells nothing.
    phi, gramian = ca.SX.sym("F", n, n), ca.SX.sym("W", n, n)
    before, ahead = ca.SX.sym("xb", layout.joint), ca.SX.sym("xp", layout.joint)
    taken, deviation = ca.SX.sym("m", layout.sensors), ca.SX.sym("r", layout.sensors)
    transition = ca.substitute(eq.transition[:, :n], eq.joint, before)
    if eq.sampled:
        transition = ca.if_else(eq.T > 0, ca.densify(transition), ca.SX.eye(n))
    moved = transition @ phi
    rows = ca.substitute(eq.sensitivity[:, :n], eq.joint, ahead) @ moved
    weights = ca.diag(taken / deviation**2)
    summed = gramian + rows.T @ weights @ rows
    z = ca.vertcat(ca.vec(phi), ca.vec(gramian))
    step = ca.Function(
        "gramian",
        [z, ca.vertcat(before, ahead, eq.u0, eq.u1, eq.T, taken), ca.vertcat(eq.p, deviation)],
        [ca.densify(ca.vertcat(ca.vec(moved), ca.vec(summed))), ca.SX(1, 1)],
    )
    return make_loop(step, kalman.compiled)


def observability(run: FilterRun) -> Observability:
    """Work out the observability of a filtered record.

    Parameters
    ----------
    run : FilterRun
        The run, which holds where everything was linearised.

    Returns
    -------
    Observability
    """
    kalman, out, control = run.filter, run._out[:_ENOUGH], run._control[:_ENOUGH]
    layout = kalman.layout
    full, places, carried = layout.full, layout.control, layout.carried
    first = np.concatenate([run._start[carried["x"]], run._start[carried["w"]]])
    before = np.vstack([first, np.concatenate([out[:, full["x"]], out[:, full["w"]]], axis=1)[:-1]])
    inputs = control[:, places["u"]]
    inputs_before = np.vstack([run._start[carried["u"]], inputs[:-1]])
    rows = np.concatenate(
        [
            before,
            out[:, full["ahead"]],
            inputs_before,
            inputs,
            control[:, places["T"]],
            out[:, full["fate"]] == TAKEN,
        ],
        axis=1,
    )
    _, deviation = first_estimate(kalman, {})
    n = layout.n
    # The state is measured in first standard deviations from the start, so that no product loses digits.
    z0 = np.concatenate([np.diag(deviation).ravel(order="F"), np.zeros(n * n)])
    constants = kalman.constants
    p = np.concatenate([constants[layout.constants["p"]], constants[layout.constants["r"]]])
    end, _ = kalman.gramian(z0, rows, p)
    gramian = end[n * n :].reshape(n, n, order="F")
    values, vectors = np.linalg.eigh((gramian + gramian.T) / 2)
    values = np.maximum(values, 0.0)
    # A zero is judged beside what the same states are told in other directions.
    null = values <= _NULL * max(float(values[-1]), 1.0)
    names = kalman.model.states
    unobservable = tuple(Direction(w, 0.0) for w in _described(vectors[:, null], names))
    weak = tuple(
        Direction(_described(vectors[:, [i]], names)[0], float(values[i]))
        for i in np.flatnonzero(~null & (values < _WEAK))
    )
    return Observability(names, values, unobservable, weak)


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
