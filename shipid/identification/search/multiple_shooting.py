"""Multiple shooting: the record in short segments with states of their own, which the search joins as it goes.

Over a whole record a model that is far off runs away, and the cost has a plateau. Over a segment its error stays small: the
segments start from what was measured, and the coefficients are fitted to all of them. That each segment ends where the next
begins (Bock 1983) is weighted more and more, and enforced in the end by output error, which has no joints. Where the model
runs away over a segment as well, the segments are first cut shorter.

Each search is a Gauss-Newton method in a trust region on the records' exact sensitivities; the samples of a segment are
condensed to as many rows as it has unknowns.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from shipid.foundation.numbers import brief
from shipid.generation.ensemble import run_many
from shipid.generation.record import Record, make_record
from shipid.generation.simulator import coefficient_vector, initial_state
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import RUNAWAY, Problem
from shipid.identification.problem.trial_data import TrialData
from shipid.identification.search.least_squares import bounds_of
from shipid.identification.search.solution import Solution
from shipid.identification.search.trust_region import search, triangle

#: Length of a segment in L/U, the fewest samples in one, how much shorter it is cut at a time, and the most states of all nodes:
#: the search factorises them.
_SEGMENT = 1.5
_SAMPLES = 2
_SHORTER = 3
_MOST = 300
#: Ranges of a measured signal that a segment may be off before it counts as running away.
_FAR = 3.0
#: Weight of the gap at a joint, in samples with the same error: one for each round, and those of short segments.
_STRICT = (1.0, 30.0, 1000.0, 30_000.0)
_STRICT_WHEN_SHORT = (1.0, 100.0)
_EVALUATIONS = 40


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


def shoot(problem: Problem, q0: np.ndarray, box: Box, unit_time: float) -> Solution:
    """Solve by multiple shooting, and return the unknowns of output error.

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
        Not yet finished by output error; its message gives the largest gap left at a joint.
    """
    # The matrices are small: several threads on each cost more than they bring.
    with threadpool_limits(1, "blas"):
        return _shoot(replace(problem, loss="linear", weights=None), q0, box, unit_time)


def _shoot(problem: Problem, q0: np.ndarray, box: Box, unit_time: float) -> Solution:
    paths, q, evaluations = _measured(problem), q0, 0
    lengths = _lengths(problem, unit_time)
    # As long as the start lets them be.
    tried = (_Shooting(problem, paths, n) for n in lengths)
    first = next((k for k, s in enumerate(tried) if not s.runs_away(s.first_guess(q))), len(lengths) - 1)
    for k in range(first, -1, -1):
        shooting = _Shooting(problem, paths, lengths[k])
        z = shooting.first_guess(q)
        low, high = np.full(z.size, -np.inf), np.full(z.size, np.inf)
        low[shooting.columns], high[shooting.columns] = bounds_of(problem, box)
        logs = np.zeros(z.size, dtype=bool)
        logs[: len(problem.estimated)] = box.in_log
        for shooting.strict in _STRICT if k == 0 else _STRICT_WHEN_SHORT:
            found = search(shooting.evaluate, z, logs, low, high, _EVALUATIONS, 1e-5)
            z = found.q
            evaluations += found.evaluations
        q, gap = z[shooting.columns], shooting.gap(z)
        if shooting.runs_away(z):
            # The cost is at a plateau; longer segments would not help.
            break
        joined = shooting.paths(z)
        paths = [p if np.isfinite(p).all() else before for p, before in zip(joined, paths)]
    residual, jacobian = problem.residuals(q)
    count = sum(len(c.nodes) for c in shooting.cut)
    message = f"{count} segments, the largest gap left at a joint is {brief(gap, 1)} of a signal's weight."
    return Solution(problem, q, residual, jacobian, gap < 1.0, message, evaluations)


def _lengths(problem: Problem, unit_time: float) -> list[int]:
    """Samples of a segment, the longest first, down to the shortest whose nodes can still be factorised."""
    total = sum(data.intervals.size for data in problem.trials) * len(problem.initial)
    least = max(_SAMPLES, -(-total // _MOST))
    steps = np.concatenate([data.intervals[:-1] for data in problem.trials])
    # Where signals keep their own clocks, rows lie at irregular times.
    step = float(np.median(steps) if all(data.regular for data in problem.trials) else np.mean(steps))
    lengths = [max(least, round(_SEGMENT * unit_time / step))]
    while lengths[-1] > least:
        lengths.append(max(least, lengths[-1] // _SHORTER))
    return lengths


def _measured(problem: Problem) -> list[np.ndarray]:
    """The states of each trial as far as they are measured, shape (states, N); the others stay as they begin."""
    return [
        np.array(
            [data.column(n) if data.shows(n) else np.full(data.intervals.size, data.start[n]) for n in problem.initial]
        )
        for data in problem.trials
    ]


def _cut(data: TrialData, path: np.ndarray, samples: int) -> _Segments:
    """Cut a trial into segments of so many samples, the nodes on a path of its states."""
    count = data.intervals.size
    segments = max(1, -(-(count - 1) // samples))
    index = np.arange(segments)[:, None] * samples + np.arange(samples + 1)
    inside = index < count
    index = np.minimum(index, count - 1)
    counted = inside.copy()
    counted[:-1, -1] = False
    return _Segments(
        data.inputs[:, index].transpose(1, 0, 2),
        np.where(inside & (index < count - 1), data.intervals[index], 0.0),
        data.measured[:, index].transpose(1, 0, 2),
        counted,
        path[:, index[:, 0]].T,
    )


class _Shooting:
    """Residuals and Jacobian over ``z = [parameters, then for each trial its biases and the states of its nodes]``."""

    def __init__(self, problem: Problem, paths: list[np.ndarray], samples: int) -> None:
        self.problem = problem
        shown = tuple(dict.fromkeys((*problem.shown, *problem.initial)))
        self.record: Record = make_record(problem.model, shown, problem.estimated, problem.initial, problem.biases)
        self.ends = [shown.index(n) for n in problem.initial]
        self.scale = np.array([self._size(n) for n in problem.initial])
        self.cut = [_cut(data, path, samples) for data, path in zip(problem.trials, paths)]
        self.strict = _STRICT[0]
        self.starts, begin = [], len(problem.estimated)
        for cut in self.cut:
            self.starts.append(begin)
            begin += len(problem.biases) + cut.nodes.size
        self.size = begin

    def _size(self, name: str) -> float:
        """The unit of a gap at a joint: the weight of a fitted signal, else a tenth of the usual size."""
        problem = self.problem
        if name in problem.signals:
            return float(problem.sigma[problem.signals.index(name)])
        return 0.1 * (problem.model[name].number("nominal") or 1.0)

    @property
    def columns(self) -> np.ndarray:
        """Where the unknowns of single shooting stand in z: the first node of each trial is its initial state."""
        biases, states = len(self.problem.biases), len(self.problem.initial)
        columns = [np.arange(len(self.problem.estimated))]
        for begin in self.starts:
            columns += [begin + biases + np.arange(states), begin + np.arange(biases)]
        return np.concatenate(columns)

    def first_guess(self, q: np.ndarray) -> np.ndarray:
        """Parameters, biases and initial states of single shooting, and the other nodes as they were cut."""
        z = np.zeros(self.size)
        for begin, cut in zip(self.starts, self.cut):
            at = begin + len(self.problem.biases)
            z[at : at + cut.nodes.size] = cut.nodes.ravel()
        z[self.columns] = q
        return z

    def nodes(self, z: np.ndarray, i: int) -> np.ndarray:
        """The nodes of one trial, shape (segments, states)."""
        begin = self.starts[i] + len(self.problem.biases)
        return z[begin : begin + self.cut[i].nodes.size].reshape(len(self.cut[i].nodes), -1)

    def paths(self, z: np.ndarray) -> list[np.ndarray]:
        """The states of each trial at every sample, each segment from its node, shape (states, N)."""
        out = []
        for i, data in enumerate(self.problem.trials):
            x = self._run(z, i)[0][:, self.ends].transpose(1, 0, 2)
            whole = np.concatenate([x[:, :-1, :-1].reshape(len(self.ends), -1), x[:, -1]], axis=1)
            out.append(whole[:, : data.intervals.size])
        return out

    def runs_away(self, z: np.ndarray) -> bool:
        """Whether some segment leaves what was measured by several ranges of it."""
        for i, cut in enumerate(self.cut):
            y, _ = self._run(z, i)
            measured = self.problem.trials[i].measured
            reach = _FAR * (_over(np.fmax, measured) - _over(np.fmin, measured))[:, None]
            y = y[:, : len(reach)]
            # Where a sample is missing the model has only to stay finite.
            if not np.where(np.isnan(cut.measured), np.isfinite(y), np.abs(y - cut.measured) <= reach).all():
                return True
        return False

    def gap(self, z: np.ndarray) -> float:
        """The largest gap at a joint, in units of its scale."""
        gaps = [self._joints(*self._run(z, i), self.nodes(z, i))[0] for i in range(len(self.cut))]
        return max(float(np.abs(g).max(initial=0.0)) for g in gaps) / float(np.sqrt(self.strict))

    def evaluate(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals, joints and prior, and their Jacobian."""
        problem = self.problem
        shared, biases, states = len(problem.estimated), len(problem.biases), len(problem.initial)
        rows, blocks = [], []
        for i, cut in enumerate(self.cut):
            y, dy = self._run(z, i)
            condensed = triangle(*self._misfit(y, dy, cut))
            # Columns of the record: parameters, states at the node, biases.
            where = np.empty((len(cut.nodes), shared + states + biases), dtype=int)
            begin = self.starts[i] + biases
            where[:, :shared] = np.arange(shared)
            where[:, shared : shared + states] = begin + np.arange(cut.nodes.size).reshape(-1, states)
            where[:, shared + states :] = self.starts[i] + np.arange(biases)
            rows.append(condensed[:, :, -1].ravel())
            blocks.append(_spread(condensed[:, :, :-1], where, self.size))
            gap, slope = self._joints(y, dy, self.nodes(z, i))
            block = _spread(slope, where[:-1], self.size)
            joint = np.arange(gap.size)
            block[joint, begin + states + joint] -= np.tile(np.sqrt(self.strict) / self.scale, len(cut.nodes) - 1)
            rows.append(gap.ravel())
            blocks.append(block)
        if problem.prior is not None:
            residual, by = problem.prior_residuals(z[self.columns], problem.prior)
            block = np.zeros((residual.size, self.size))
            block[:, self.columns] = by
            rows.append(residual)
            blocks.append(block)
        return np.concatenate(rows), np.concatenate(blocks)

    def _run(self, z: np.ndarray, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Run all segments of one trial: outputs and their derivatives."""
        problem, cut, nodes = self.problem, self.cut[i], self.nodes(z, i)
        start = {**problem.trials[i].start, **dict(zip(problem.initial, nodes.T))}
        x0 = np.broadcast_to(initial_state(problem.model, start).T, (len(nodes), len(problem.model.states)))
        own = np.concatenate([nodes[0], z[self.starts[i] : self.starts[i] + len(problem.biases)]])
        p = np.repeat(coefficient_vector(problem.model, problem.values(z))[None], len(nodes), axis=0)
        bias = np.repeat(problem.bias_vector(own)[None], len(nodes), axis=0)
        return run_many(self.record, x0, cut.inputs, cut.intervals, p, bias)

    def _misfit(self, y: np.ndarray, dy: np.ndarray, cut: _Segments) -> tuple[np.ndarray, np.ndarray]:
        """Weighted residuals (segments, rows) and slopes (segments, rows, unknowns); large and flat where it runs away."""
        signals, sigma = len(self.problem.signals), self.problem.sigma[:, None]
        with np.errstate(over="ignore", invalid="ignore"):
            residual = (y[:, :signals] - cut.measured) / sigma
            slope = dy[:, :signals] / sigma[:, None]
            good = (np.abs(residual) < RUNAWAY) & (np.abs(slope) < RUNAWAY**2).all(axis=2)
        counted = cut.counted[:, None, :] & np.isfinite(cut.measured)
        residual = np.where(counted, np.where(good, residual, RUNAWAY), 0.0)
        slope = np.where((counted & good)[:, :, None, :], slope, 0.0)
        count = len(residual)
        return residual.reshape(count, -1), slope.transpose(0, 1, 3, 2).reshape(count, -1, slope.shape[2])

    def _joints(self, y: np.ndarray, dy: np.ndarray, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How far each segment ends from where the next begins, and the slope of its end."""
        stiff = np.sqrt(self.strict) / self.scale
        with np.errstate(over="ignore", invalid="ignore"):
            gap = (y[:-1][:, self.ends, -1] - nodes[1:]) * stiff
            slope = dy[:-1][:, self.ends][..., -1] * stiff[:, None]
            good = (np.abs(gap) < RUNAWAY * np.sqrt(self.strict)) & (np.abs(slope) < RUNAWAY**2).all(axis=2)
        return np.where(good, gap, RUNAWAY), np.where(good[:, :, None], slope, 0.0)


def _over(pick: np.ufunc, measured: np.ndarray) -> np.ndarray:
    """The largest or smallest sample of each signal; zero where it has none."""
    return np.asarray(np.nan_to_num(pick.reduce(measured, axis=1)))


def _spread(rows: np.ndarray, where: np.ndarray, size: int) -> np.ndarray:
    """Put the columns of each segment's rows where its unknowns stand, shape (segments x rows, size)."""
    count, height, _ = rows.shape
    whole = np.zeros((count, height, size))
    np.put_along_axis(whole, np.broadcast_to(where[:, None, :], rows.shape), rows, axis=2)
    return whole.reshape(-1, size)
