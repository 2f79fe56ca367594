"""The equations of a model as a regression: both sides of each, sample by sample, where the states are measured.

Derivatives of noisy records are not taken: both sides of ``x' = f(x, u, q)`` are weighted by a smooth function that lives on
a short window and vanishes at its ends, and the derivative is moved to it (modulating functions, Shinbrot 1957). Equations,
and their derivatives by coefficients and rudder bias, come from the declaration; nothing is written by hand.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from shipid.foundation.aliases import CasadiFunction, Expression
from shipid.generation.simulator import coefficient_vector
from shipid.identification.problem.output_error import Problem
from shipid.identification.problem.trial_data import TrialData

#: Half the window in L/U, at least so many samples, and how many windows begin within it.
_HALF = 0.5
_LEAST = 4
_OVERLAP = 3
#: Smoothed values for each unknown that are enough to find it.
_EQUATIONS = 2
#: Samples of a trial that are used; more add no information.
_MOST = 20_000


@dataclass(frozen=True, eq=False)
class DerivativeWindow:
    """A smooth function on a short window, and its derivative, as sums over samples.

    Attributes
    ----------
    weights, slopes : ndarray, shape (samples,)
        Weights of the samples that give a smoothed value, and its derivative.
    stride : int
        Samples from one window to the next.
    """

    weights: np.ndarray
    slopes: np.ndarray
    stride: int

    def smooth(self, rows: np.ndarray) -> np.ndarray:
        """Return smoothed values along the second axis.

        Parameters
        ----------
        rows : ndarray, shape (rows, N)
            Values at the samples.
        """
        return np.asarray(self._over(rows) @ self.weights)

    def rate(self, rows: np.ndarray) -> np.ndarray:
        """Return the derivatives of smoothed values along the second axis.

        Parameters
        ----------
        rows : ndarray, shape (rows, N)
            Values at the samples.
        """
        return np.asarray(self._over(rows) @ self.slopes)

    def _over(self, rows: np.ndarray) -> np.ndarray:
        return np.lib.stride_tricks.sliding_window_view(rows, self.weights.size, axis=1)[:, :: self.stride]


def make_window(half: int, step: float) -> DerivativeWindow:
    """Return a window of so many samples to either side.

    Parameters
    ----------
    half : int
        Samples to either side.
    step : float
        Sampling interval in s.
    """
    s = np.arange(-half, half + 1) / (half + 1)
    weights, slopes = (1 - s**2) ** 3, 6 * s * (1 - s**2) ** 2
    # The derivative is exact for a straight line, however few samples there are.
    return DerivativeWindow(
        weights / weights.sum(), slopes / (slopes @ s) / ((half + 1) * step), max(1, (half + 1) // _OVERLAP)
    )


@dataclass(frozen=True, eq=False)
class RegressionBlock:
    """One trial of a regression.

    Attributes
    ----------
    states, inputs : ndarray, shapes (states, N) and (inputs, N)
        As measured; zero where a state is not.
    intervals : ndarray, shape (N,)
        Time to the next sample in s.
    left : ndarray, shape (equations, windows)
        Smoothed derivatives of states, or smoothed values.
    window : DerivativeWindow
        Of the smoothing.
    used : ndarray of bool, shape (all windows,)
        Which windows are used: those in which nothing that is measured has a hole.
    """

    states: np.ndarray
    inputs: np.ndarray
    intervals: np.ndarray
    left: np.ndarray
    window: DerivativeWindow
    used: np.ndarray

    def smooth(self, rows: np.ndarray) -> np.ndarray:
        """Return smoothed values over the windows that are used, along the second axis.

        Parameters
        ----------
        rows : ndarray, shape (rows, N, ...)
            Values at the samples.
        """
        return self.window.smooth(rows)[:, self.used]


@dataclass(frozen=True, eq=False)
class Regression:
    """The equations of a problem as a regression; its unknowns are the coefficients, then a rudder bias for each trial.

    Attributes
    ----------
    problem : Problem
        What it belongs to.
    equations : tuple of str
        States whose rate, and measured quantities whose value, is regressed.
    covered : tuple of str
        Estimated coefficients that stand in one of them.
    lacking : mapping of str to str
        Why the others cannot be had, by coefficient.
    biased : bool
        Whether the rudder biases are unknowns.
    linear : bool
        Whether the equations are linear in the coefficients, at a given bias.
    blocks : tuple of RegressionBlock
        The trials.
    function : CasadiFunction
        ``(states, inputs, coefficients) -> (right-hand sides, their derivatives)``, of many samples at once.
    """

    problem: Problem
    equations: tuple[str, ...]
    covered: tuple[str, ...]
    lacking: dict[str, str]
    biased: bool
    linear: bool
    blocks: tuple[RegressionBlock, ...] = field(repr=False, default=())
    function: CasadiFunction = field(repr=False, default=None)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.covered) + self.biased * len(self.blocks)

    def rows(self, theta: np.ndarray, at: list[np.ndarray] | None = None) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return for each trial the error of each equation, shape (equations, windows), and its slope.

        The slope is that of the right-hand side by the unknowns, shape (equations, windows, size).

        Parameters
        ----------
        theta : ndarray, shape (size,)
            The unknowns.
        at : list of ndarray, optional
            States by trial where the right-hand side is taken, shape (states, N); as measured by default.
        """
        count = len(self.covered)
        values = {**self.problem.fixed, **dict.fromkeys(self.lacking, 0.0), **dict(zip(self.covered, theta.tolist()))}
        p = coefficient_vector(self.problem.model, values)[:, None]
        out = []
        for i, block in enumerate(self.blocks):
            if not block.left.shape[1]:
                # A stretch that is shorter than a window has no equations.
                out.append((block.left, np.zeros((*block.left.shape, self.size))))
                continue
            inputs = block.inputs + self.bias(theta, i)[:, None]
            states = block.states if at is None else at[i]
            value, slope = self.function(states, inputs, np.repeat(p, states.shape[1], axis=1))
            by = block.smooth(slope.full().reshape(len(self.equations), states.shape[1], -1))
            whole = np.zeros((*by.shape[:2], self.size))
            whole[:, :, :count] = by[:, :, :count]
            if self.biased:
                whole[:, :, count + i] = by[:, :, count]
            out.append((block.left - block.smooth(value.full()), whole))
        return out

    def bias(self, theta: np.ndarray, index: int) -> np.ndarray:
        """Return the bias of every input of one trial.

        Parameters
        ----------
        theta : ndarray, shape (size,)
            The unknowns.
        index : int
            Which trial.
        """
        inputs = self.problem.model.inputs
        bias = np.array([self.problem.bias_offset.get(n, 0.0) for n in inputs])
        if self.biased:
            bias[inputs.index("delta")] += theta[len(self.covered) + index]
        return bias


def make_regression(problem: Problem, unit_time: float) -> Regression:
    """Return the equations of a problem as a regression, as far as the quantities they read are measured.

    Parameters
    ----------
    problem : Problem
        The problem.
    unit_time : float
        L/U in s, which sets the window.
    """
    system = problem.record.system
    parameters = system.p[[system.coefficients.index(n) for n in problem.estimated]]
    hidden = {n for n in system.states if not all(data.shows(n) for data in problem.trials)}
    rows: dict[str, Expression] = {}
    lacking: dict[str, str] = {}
    for name in (*problem.initial, *(n for n in problem.signals if n not in system.states)):
        state = system.states.index(name) if name in system.states else None
        row = system.values[name] if state is None else system.rates[state]
        here = _read_by(row, parameters, problem.estimated)
        unseen = [n for n in _read_by(row, system.x, system.states) if n in hidden]
        if name in hidden:
            reason = f"the state '{name}' is not measured"
        elif state in system.nexts:
            reason = f"'{name}' is sampled and has no rate"
        elif unseen:
            reason = f"the equation of '{name}' reads quantities that are not measured: {', '.join(unseen)}"
        else:
            rows |= {name: row} if here else {}
            continue
        lacking |= {n: reason for n in here if n not in lacking}
    everything = ca.vertcat(*rows.values()) if rows else ca.SX(0, 1)
    covered = tuple(_read_by(everything, parameters, problem.estimated))
    open_ = [n for n in problem.estimated if n not in covered]
    at = [system.coefficients.index(n) for n in covered]
    by = ca.jacobian(everything, system.p)[:, at]
    linear = not covered or not ca.jacobian(ca.vec(by), system.p[at]).nnz()
    biased = False
    if "delta" in problem.biases:
        by_bias = ca.jacobian(everything, system.u)[:, system.inputs.index("delta")]
        biased = bool(by_bias.nnz())
        by = ca.horzcat(by, by_bias) if biased else by
    blocks = tuple(_block(problem, tuple(rows), data, unit_time) for data in problem.trials) if covered else ()
    if sum(block.left.size for block in blocks) < _EQUATIONS * (len(covered) + biased * len(blocks)):
        lacking |= dict.fromkeys(covered, "too few stretches of the trials are without holes")
        blocks, covered, open_ = (), (), list(problem.estimated)
    return Regression(
        problem,
        tuple(rows),
        covered,
        {n: lacking.get(n, "it is in no equation of a measured quantity") for n in open_},
        biased,
        linear,
        blocks,
        ca.Function("equations", [system.x, system.u, system.p], [ca.densify(everything), ca.densify(by)]),
    )


def _read_by(expression: Expression, symbols: Expression, names: tuple[str, ...]) -> list[str]:
    """The symbols that an expression depends on, by name."""
    columns = ca.jacobian_sparsity(expression, symbols).get_col() if expression.numel() and names else []
    return [n for k, n in enumerate(names) if k in set(columns)]


def _block(problem: Problem, equations: tuple[str, ...], data: TrialData, unit_time: float) -> RegressionBlock:
    kept = data.thinned(_MOST)
    step = kept.step if kept.regular else max(data.step, float(data.t[-1]) / _MOST)
    # Windows count samples: where the clock is irregular the trial is laid on a regular one, in straight lines.
    at = kept.t if kept.regular else np.arange(0.0, data.t[-1] + 0.5 * step, step)
    inputs = kept.inputs if kept.regular else np.array([np.interp(at, data.t, row) for row in data.inputs])
    states = problem.model.states
    half = int(np.clip(np.ceil(_HALF * unit_time / step), _LEAST, max(_LEAST, (at.size - 1) // 8)))
    if at.size < 2 * half + 1:
        nothing, none = np.zeros((len(equations), 0)), np.zeros((len(states), 0))
        return RegressionBlock(none, inputs[:, :0], np.zeros(0), nothing, make_window(half, step), np.zeros(0, bool))
    window = make_window(half, step)
    names = [n for n in dict.fromkeys((*states, *equations)) if data.shows(n)]
    column = {n: kept.column(n, at) for n in names}
    known = np.array([True if kept.regular else data.known(n, at) for n in names]).all(axis=0)
    used = window.smooth(np.broadcast_to(known, (1, at.size)).astype(float))[0] > 1 - 1e-9
    left = [(window.rate if n in states else window.smooth)(column[n][None])[0][used] for n in equations]
    measured = np.array([column.get(n, np.zeros(at.size)) for n in states])
    return RegressionBlock(measured, inputs, np.diff(at, append=at[-1]), np.array(left), window, used)
