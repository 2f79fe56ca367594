"""Generated functions over a list of targets: each row is one target, and nothing is carried from row to row."""

from __future__ import annotations

import functools
import math

import casadi as ca
import numpy as np

from shipid.declaration.model import Model
from shipid.estimation.multiple.cycle.mixing import merged
from shipid.estimation.multiple.cycle.moves import DisplacedMoves, GridMoves
from shipid.estimation.records.triangles import packed_of, unpacked
from shipid.estimation.recursion import covariance_form
from shipid.estimation.recursion.equations import make_equations
from shipid.estimation.settings.noise import NoiseSource
from shipid.foundation.aliases import Expression
from shipid.generation.loop import Loop, make_loop

#: The states that the association reads, in their order; one more follows: the estimated part of the turn.
STATES = ("x", "y", "vx", "vy")
SIZE = len(STATES) + 1
_PACKED = covariance_form.size(SIZE)


def turn_of(model: Model) -> tuple[str, str] | None:
    """Return the input that says how a target turns, and the state that is its estimated part; None where a model has no such pair.

    Parameters
    ----------
    model : Model
        The motion of a target.
    """
    stated = [n for n in model.inputs if model[n].number("default") is None]
    further = [n for n in model.states if n not in STATES]
    if not set(STATES) <= set(model.states) or len(stated) != 1 or len(further) != 1:
        return None
    return stated[0], further[0]


def predicted(
    model: Model, x: np.ndarray, P: np.ndarray, turn: np.ndarray, level: np.ndarray, interval: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return estimates after an interval.

    Parameters
    ----------
    model : Model
        The motion of a target, with the states `STATES` and one more.
    x : ndarray, shape (..., 5)
        Estimates.
    P : ndarray, shape (..., 5, 5)
        Their covariances.
    turn : ndarray, shape (...)
        Its input.
    level : ndarray, shape (...)
        Density of the noise that drives the velocities, m/s^1.5.
    interval : float
        In s.
    """
    rows = [x, packed_of(P), turn[..., None], level[..., None], np.full((*turn.shape, 1), interval)]
    return _estimates(_over(_prediction(model), rows))


def mixed(weights: np.ndarray, x: np.ndarray, P: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mean and covariance of mixtures over the modes (`shipid.estimation.multiple.cycle.mixing.merged`).

    Parameters
    ----------
    weights : ndarray, shape (n, modes, mixtures)
        Of each mode in each mixture; they sum to one over the modes.
    x : ndarray, shape (n, modes, 5)
        Estimates of the modes.
    P : ndarray, shape (n, modes, 5, 5)
        Their covariances.

    Returns
    -------
    x, P : ndarray, shapes (n, mixtures, 5) and (n, mixtures, 5, 5)
    """
    n, modes, mixtures = weights.shape
    parts = np.concatenate([x.reshape(n, modes * SIZE), packed_of(P).reshape(n, modes * _PACKED)], axis=1)
    rows = [weights.swapaxes(1, 2), np.broadcast_to(parts[:, None], (n, mixtures, parts.shape[1]))]
    return _estimates(_over(_mixture(modes), rows))


def moved(
    moves: DisplacedMoves | GridMoves, turn: np.ndarray, mu: np.ndarray, more: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the turns of the modes as they move after a scan, and what remains of the estimated parts.

    Parameters
    ----------
    moves : DisplacedMoves or GridMoves
        How they move; the estimated part is the only state it is told of.
    turn, mu, more : ndarray, shape (n, modes)
        Turns, mode probabilities, and the estimated parts of the turns.
    """
    out = _over(_moves(moves, turn.shape[1]), [turn, mu, more])
    return out[:, : turn.shape[1]], out[:, turn.shape[1] :]


def _over(loop: Loop, parts: list[np.ndarray]) -> np.ndarray:
    """Outputs of the function for each row; the last axis of the parts is that of its arguments."""
    rows = np.concatenate(parts, axis=-1)
    _, out = loop(np.zeros(1), rows.reshape(math.prod(rows.shape[:-1]), rows.shape[-1]), np.zeros(0))
    return np.asarray(out.reshape(*rows.shape[:-1], out.shape[1]))


def _estimates(out: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means and covariances out of rows of a mean and a packed covariance."""
    rows = out.shape[:-1]
    return out[..., :SIZE], unpacked(out[..., SIZE:].reshape(-1, _PACKED), SIZE).reshape(*rows, SIZE, SIZE)


def _rowwise(name: str, row: Expression, out: Expression) -> Loop:
    """A function of a row as a step without memory."""
    memory = ca.SX.sym("memory", 1)
    out = ca.cse([ca.densify(out)])[0]
    return make_loop(ca.Function(name, [memory, row, ca.SX.sym("none", 0)], [memory, out]))


@functools.lru_cache(maxsize=8)
def _prediction(model: Model) -> Loop:
    row = ca.SX.sym("row", SIZE + _PACKED + 3)
    sources = tuple(NoiseSource(name, 1.0, "state", True) for name in ("vx", "vy"))
    equations = make_equations(model, ("x", "y"), sources, "rk4", "zero", 1)
    named = turn_of(model)
    assert named is not None, "checked where a motion is made"
    order = [equations.system.states.index(name) for name in (*STATES, named[1])]
    inputs = ca.SX.zeros(equations.u0.shape[0])
    inputs[equations.system.inputs.index(named[0])] = row[-3]
    x, packed = row[:SIZE], row[SIZE:-3]
    own, cov = ca.SX(SIZE, 1), covariance_form.unpack(packed, SIZE)
    reordered = ca.SX(SIZE, SIZE)
    for a, i in enumerate(order):
        own[i] = x[a]
        for b, j in enumerate(order):
            reordered[i, j] = cov[a, b]
    ahead, spread = ca.substitute(
        [equations.advanced, covariance_form.predicted(equations, reordered)],
        [equations.joint, equations.u0, equations.u1, equations.T, equations.p, equations.levels, equations.scale],
        [
            own,
            inputs,
            inputs,
            row[-1],
            ca.SX(equations.p.shape[0], 1),
            ca.vertcat(row[-2], row[-2]),
            ca.SX.ones(2, 1),
        ],
    )
    return _rowwise("predict_targets", row, ca.vertcat(ahead[order], covariance_form.pack(spread[order, order])))


@functools.lru_cache(maxsize=8)
def _mixture(modes: int) -> Loop:
    row = ca.SX.sym("row", modes * (1 + SIZE + _PACKED))
    weights, means, triangles = ca.vertsplit(row, [0, modes, modes * (1 + SIZE), row.shape[0]])
    parts = [
        (mean, covariance_form.unpack(triangle, SIZE))
        for mean, triangle in zip(ca.vertsplit(means, SIZE), ca.vertsplit(triangles, _PACKED))
    ]
    x, P = merged(ca.vertsplit(weights), parts, parts[0][0], [False] * SIZE)
    return _rowwise("mix_targets", row, ca.vertcat(x, covariance_form.pack(P)))


@functools.lru_cache(maxsize=8)
def _moves(moves: DisplacedMoves | GridMoves, modes: int) -> Loop:
    row = ca.SX.sym("row", 3 * modes)
    turn, mu, more = ca.vertsplit(row, modes)
    parts = [more[j] + 0 for j in range(modes)]
    following = moves.move(parts, mu, turn, ca.SX(1))
    return _rowwise("move_targets", row, ca.vertcat(following, *parts))
