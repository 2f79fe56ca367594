"""Multiple shooting: the record in short segments with states of their own, which the search joins as it goes.

Over a whole record a model that is far off runs away, and the search sees a plateau. Over a segment it cannot go far: the
segments start from what was measured, and the coefficients are fitted to all of them. That each segment ends where the next
begins (Bock 1983) is asked for more and more strictly, and in the end by output error, which has no joints.

Each search is a Gauss-Newton method in a trust region on the records' exact sensitivities; the samples of a segment are
condensed to as many rows as it has unknowns.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from shipid.generation.record import Record, make_record
from shipid.generation.runs import run_many
from shipid.identification.problem import RUNAWAY, Problem
from shipid.identification.sailed import Sailed
from shipid.identification.search import search, triangle
from shipid.identification.solve import Box, Solution, bounds_of

#: Length of a segment in L/U, the fewest samples in one, and the most node states of a problem: the search factorises them.
_SEGMENT = 1.5
_SAMPLES = 5
_MOST = 300
#: What a joint that does not meet counts, in samples that are off as much; one round each.
_STRICT = (1.0, 30.0, 1000.0, 30_000.0)
_EVALUATIONS = 60


@dataclass(frozen=True, eq=False)
class _Segments:
    """One trial cut into segments of the same length that share their ends.

    Attributes
    ----------
    inputs : ndarray, shape (segments, inputs, n)
    intervals : ndarray, shape (segments, n)
        Zero where a short last segment is filled up.
    measured : ndarray, shape (segments, signals, n)
    counted : ndarray, shape (segments, n)
        Whether a sample counts: the last one of a segment belongs to the next.
    nodes : ndarray, shape (segments, states)
        First guess of the states at which the segments begin.
    """

    inputs: np.ndarray
    intervals: np.ndarray
    measured: np.ndarray
    counted: np.ndarray
    nodes: np.ndarray


class _Shooting:
    """Residuals and Jacobian over ``z = [parameters, then for each trial its biases and the states of its nodes]``."""

    def __init__(self, problem: Problem, unit_time: float) -> None:
        self.problem = problem
        shown = tuple(dict.fromkeys((*problem.signals, *problem.initial)))
        self.record: Record = make_record(problem.model, shown, problem.estimated, problem.initial, problem.biases)
        self.ends = [shown.index(n) for n in problem.initial]
        states = self.record.system.states
        self.at = [states.index(n) for n in problem.initial]
        self.scale = np.array([self._size(n) for n in problem.initial])
        most = max(2, _MOST // max(1, len(problem.sailed) * len(problem.initial)))
        self.cut = [_cut(s, problem.initial, self.at, unit_time, most) for s in problem.sailed]
        self.strict = _STRICT[0]
        self.starts, begin = [], len(problem.estimated)
        for cut in self.cut:
            self.starts.append(begin)
            begin += len(problem.biases) + cut.nodes.size
        self.size = begin

    def _size(self, name: str) -> float:
        """What counts as one unit at a joint: the weight of a fitted signal, else what the declaration calls usual."""
        problem = self.problem
        if name in problem.signals:
            return float(problem.sigma[problem.signals.index(name)])
        return 0.1 * (problem.model[name].number("nominal") or 1.0)

    def first_guess(self, q: np.ndarray) -> np.ndarray:
        """Parameters and biases of single shooting, and nodes as measured."""
        problem, z = self.problem, np.zeros(self.size)
        shared, states = len(problem.estimated), len(problem.initial)
        z[:shared] = q[:shared]
        for i, (begin, cut) in enumerate(zip(self.starts, self.cut)):
            own = q[problem.own(i)]
            z[begin : begin + len(problem.biases)] = own[states:]
            nodes = cut.nodes.copy()
            nodes[0] = own[:states]
            z[begin + len(problem.biases) : begin + len(problem.biases) + nodes.size] = nodes.ravel()
        return z

    @property
    def columns(self) -> np.ndarray:
        """Where the unknowns of single shooting stand in z: the first node of each trial is its initial state."""
        problem = self.problem
        columns = [np.arange(len(problem.estimated))]
        for begin in self.starts:
            biases = begin + np.arange(len(problem.biases))
            columns += [begin + len(problem.biases) + np.arange(len(problem.initial)), biases]
        return np.concatenate(columns)

    def evaluate(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals, joints and beliefs, and their Jacobian."""
        problem = self.problem
        shared, count = len(problem.estimated), len(problem.biases)
        rows, blocks = [], []
        for i, cut in enumerate(self.cut):
            begin = self.starts[i] + count
            size = len(cut.nodes)
            nodes = z[begin : begin + cut.nodes.size].reshape(size, -1)
            y, dy = self._run(z, i, nodes)
            residual, slope = self._misfit(y, dy, cut)
            condensed = triangle(residual, slope)
            # Columns of the record: parameters, states at the node, biases.
            where = np.empty((size, shared + nodes.shape[1] + count), dtype=int)
            where[:, :shared] = np.arange(shared)
            where[:, shared : shared + nodes.shape[1]] = begin + np.arange(nodes.size).reshape(size, -1)
            where[:, shared + nodes.shape[1] :] = self.starts[i] + np.arange(count)
            blocks.append(_spread(condensed[:, :, :-1], where, self.size))
            rows.append(condensed[:, :, -1].ravel())
            gap, gap_slope = self._joints(y, dy, nodes)
            block = _spread(gap_slope, where[:-1], self.size)
            joined = np.arange(gap.size)
            block[joined, begin + nodes.shape[1] + joined] -= np.tile(self._stiff(), size - 1)
            blocks.append(block)
            rows.append(gap.ravel())
        if problem.prior is not None:
            columns = self.columns
            believed, by = problem.beliefs(z[columns], problem.prior)
            block = np.zeros((believed.size, self.size))
            block[:, columns] = by
            rows.append(believed)
            blocks.append(block)
        return np.concatenate(rows), np.concatenate(blocks)

    def gap(self, z: np.ndarray) -> float:
        """The widest joint, in units of its scale."""
        widest = 0.0
        for i, cut in enumerate(self.cut):
            begin = self.starts[i] + len(self.problem.biases)
            nodes = z[begin : begin + cut.nodes.size].reshape(len(cut.nodes), -1)
            gap, _ = self._joints(*self._run(z, i, nodes), nodes)
            widest = max(widest, float(np.abs(gap).max(initial=0.0)) / np.sqrt(self.strict))
        return widest

    def _stiff(self) -> np.ndarray:
        return np.sqrt(self.strict) / self.scale

    def _run(self, z: np.ndarray, i: int, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        problem, cut = self.problem, self.cut[i]
        system = self.record.system
        x0 = np.repeat(problem.sailed[i].x0[None], len(nodes), axis=0)
        x0[:, self.at] = nodes
        values = {**problem.fixed, **dict(zip(problem.estimated, z))}
        p = system.vector(system.coefficients, values)
        own = np.concatenate([nodes[0], z[self.starts[i] : self.starts[i] + len(problem.biases)]])
        bias = np.repeat(problem.bias_vector(own)[None], len(nodes), axis=0)
        p = np.repeat(p[None], len(nodes), axis=0)
        return run_many(self.record, x0, cut.inputs, cut.intervals, p, bias)

    def _misfit(self, y: np.ndarray, dy: np.ndarray, cut: _Segments) -> tuple[np.ndarray, np.ndarray]:
        """Weighted residuals (segments, rows) and slopes (segments, rows, unknowns); large and flat where it runs away."""
        signals = len(self.problem.signals)
        with np.errstate(over="ignore", invalid="ignore"):
            residual = (y[:, :signals] - cut.measured) / self.problem.sigma[:, None]
            slope = dy[:, :signals] / self.problem.sigma[:, None, None]
            good = (np.abs(residual) < RUNAWAY) & (np.abs(slope) < RUNAWAY**2).all(axis=2)
        counted = cut.counted[:, None, :]
        residual = np.where(counted, np.where(good, residual, RUNAWAY), 0.0)
        slope = np.where((counted & good)[:, :, None, :], slope, 0.0)
        count = len(residual)
        return residual.reshape(count, -1), slope.transpose(0, 1, 3, 2).reshape(count, -1, slope.shape[2])

    def _joints(self, y: np.ndarray, dy: np.ndarray, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How far each segment ends from where the next begins, and the slope of its end."""
        stiff = self._stiff()
        with np.errstate(over="ignore", invalid="ignore"):
            gap = (y[:-1][:, self.ends, -1] - nodes[1:]) * stiff
            slope = dy[:-1][:, self.ends][..., -1] * stiff[:, None]
            good = (np.abs(gap) < RUNAWAY * np.sqrt(self.strict)) & (np.abs(slope) < RUNAWAY**2).all(axis=2)
        return np.where(good, gap, RUNAWAY), np.where(good[:, :, None], slope, 0.0)


def _cut(sailed: Sailed, names: tuple[str, ...], at: list[int], unit_time: float, most: int) -> _Segments:
    count = sailed.intervals.size
    step = float(np.median(sailed.intervals[:-1]))
    length = max(_SAMPLES, round(_SEGMENT * unit_time / step), -(-(count - 1) // most))
    segments = max(1, -(-(count - 1) // length))
    index = np.arange(segments)[:, None] * length + np.arange(length + 1)
    inside = index < count
    index = np.minimum(index, count - 1)
    counted = inside.copy()
    counted[:-1, -1] = False
    # Nobody knows a state that is not measured: it begins as the trial does.
    nodes = np.repeat(sailed.x0[None, at], segments, axis=0)
    for k, name in enumerate(names):
        if sailed.trial.has(name):
            nodes[:, k] = sailed.column(name)[index[:, 0]]
    return _Segments(
        sailed.inputs[:, index].transpose(1, 0, 2),
        np.where(inside & (index < count - 1), sailed.intervals[index], 0.0),
        sailed.measured[:, index].transpose(1, 0, 2),
        counted,
        nodes,
    )


def _spread(rows: np.ndarray, where: np.ndarray, size: int) -> np.ndarray:
    """Put the columns of each segment's rows where its unknowns stand, shape (segments x rows, size)."""
    count, height, _ = rows.shape
    whole = np.zeros((count, height, size))
    np.put_along_axis(whole, np.broadcast_to(where[:, None, :], rows.shape), rows, axis=2)
    return whole.reshape(-1, size)


def shoot(problem: Problem, q0: np.ndarray, box: Box, unit_time: float) -> Solution:
    """Solve by multiple shooting, and return the unknowns as output error sees them.

    Parameters
    ----------
    problem : Problem
        Of thinned records; a robust loss does not enter.
    q0 : ndarray, shape (unknowns,)
        Start.
    box : Box
        Bounds of the parameters.
    unit_time : float
        L/U in s, which sets the segments.

    Returns
    -------
    Solution
        Not yet finished by output error; its message says whether the joints were closed.
    """
    problem = replace(problem, loss="linear", weights=None)
    shooting = _Shooting(problem, unit_time)
    columns = shooting.columns
    low, high = np.full(shooting.size, -np.inf), np.full(shooting.size, np.inf)
    low[columns], high[columns] = bounds_of(problem, box)
    logs = np.zeros(shooting.size, dtype=bool)
    logs[: len(problem.estimated)] = box.in_log
    z, evaluations = shooting.first_guess(q0), 0
    for shooting.strict in _STRICT:
        found = search(shooting.evaluate, z, logs, low, high, _EVALUATIONS, 1e-6)
        z = found.q
        evaluations += found.evaluations
    q, gap = z[columns], shooting.gap(z)
    residual, jacobian = problem.residuals(q)
    lengths = ", ".join(f"{len(c.nodes)}" for c in shooting.cut)
    message = f"{lengths} segments, the widest joint left open by {gap:.2g} of a signal's weight."
    return Solution(problem, q, residual, jacobian, gap < 1.0, message, evaluations)
