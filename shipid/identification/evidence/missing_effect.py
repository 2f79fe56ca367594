"""An effect that a model lacks: what its residuals share with the rudder, the speed or the heading, and what that does to its coefficients.

A model of too simple a form fits a manoeuvre by coefficients that are not the ship's: a first-order model of a second-order ship
finds half her gain in a zig-zag, and the same half in each of its swings. No resampling of the record shows that, and the
autoregression of the residuals takes for noise what the rudder does. So residuals are compared with simple effects that the model
may lack: the rudder angle, its square and its sign, its size, its angle at the speed that is lost, and the heading, each through three time
constants. Their sizes are random with a common spread. Where the marginal likelihood of the residuals grows by one of them
(against noise of an autoregression, as in the covariance), it is missing, and its posterior tells how far it pulls the
coefficients: a discrepancy of the model as in Kennedy and O'Hagan (2001), in the linear terms of the fit.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from shipid.foundation.notices import Notice
from shipid.foundation.numbers import number
from shipid.foundation.result import ResultEntry
from shipid.foundation.statistics import plain
from shipid.identification.noise.autoregression import Autoregression, autoregression_of, colour, whitened
from shipid.identification.noise.residual_groups import groups_of
from shipid.identification.problem.output_error import Problem
from shipid.identification.problem.trial_data import TrialData
from shipid.identification.search.solution import Solution
from shipid.identification.validation.comparison import Comparison

#: What an effect goes with, in words.
EFFECTS = {
    "lag": "the rudder through another time constant, as sway or a steering gear gives it",
    "force": "a force that is not proportional to the rudder angle, as a damping or a dead band gives it",
    "side": "the size of the rudder angle to both sides, as in a ship that turns unlike to port and to starboard",
    "speed": "the speed that the ship loses in her turns",
    "heading": "the heading, as wind and current give it",
}
#: Kind of the notice.
EFFECT_MISSING = "effect-missing"
#: Time constants of each effect, in L/U; they cover those of ships.
_TIMES = (0.3, 1.0, 3.0)
#: Logarithm of the likelihood ratio from which an effect is missing. Of 45 right models in noise and waves (eight ships, three noises and
#: samplings), 44 stay below 12; in gusts 34 of 40 are above this and 32 above 50, whose walk of the heading no autoregression holds. One
#: zig-zag by a ship with hull, propeller and rudder gives a first-order model 22 to 48, and two of them give hundreds.
_EVIDENCE = 20.0
#: Effects that have this share of the largest evidence may be it as well: their errors come together.
_ABOUT_AS_WELL = 0.5
#: Usual and largest size of an effect, in shares of how the ship turns: a model that explains the turns lacks a part of them.
_USUAL, _SIZES = 0.3, np.geomspace(1e-4, 1.0, 81)
#: A factor on intervals that nobody sees.
_WIDER = 1.05
#: How often the noise is found anew without the effect.
_TURNS = 2
#: Singular values below this share of the largest are nothing.
_NOTHING = 1e-8
_YAW = ("psi", "r")


@dataclass(frozen=True, eq=False, repr=False)
class MissingEffect(ResultEntry):
    """An effect that a model lacks.

    Attributes
    ----------
    names : tuple of str
        Of `EFFECTS`, those that explain the residuals about as well, the best first.
    evidence : float
        Logarithm of the likelihood ratio of the residuals with the best to those without.
    errors : ndarray, shape (unknowns, unknowns)
        Mean products of the errors that they make in the unknowns.
    covariance : ndarray, shape (parameters, parameters)
        Of the coefficients, with these errors.
    wider : float
        By what factor it widens the interval that it widens most.
    """

    names: tuple[str, ...]
    evidence: float
    errors: np.ndarray
    covariance: np.ndarray
    wider: float

    def __str__(self) -> str:
        return str(self.notice)

    @property
    def lasting(self) -> bool:
        """Whether it is one of the ship, and so in every manoeuvre alike: what goes with the heading is of the day."""
        return "heading" not in self.names

    @property
    def steering(self) -> bool:
        """Whether the gain that makes up for it in a zig-zag is not that of a steady turn: another answer to the rudder, or weather.

        The lost speed and unlike sides are in both alike, and what the bands have of left-out trials holds them.
        """
        return self.names[0] in ("lag", "force", "heading")

    @property
    def notice(self) -> Notice:
        """What there is to say of it."""
        wider = f"up to {number(self.wider, 2)} times as wide as" if self.wider < 100 else "far wider than"
        wider = "hardly wider than" if self.wider < _WIDER else wider
        leaves = ", or with ".join(EFFECTS[n] for n in self.names)
        return Notice(
            f"The model lacks an effect: what it leaves of the turns goes with {leaves}. Coefficients take the place of it; their "
            f"intervals hold what such an effect does to them, and are {wider} by noise. They describe manoeuvres like these; a model "
            "that has the effect may describe the ship (compare).",
            EFFECT_MISSING,
            effect=list(self.names),
            wider=plain(self.wider),
        )


@dataclass(frozen=True, eq=False)
class _Rows:
    """Weighted residuals of one series: with their derivatives by the unknowns and by the sizes of the effects."""

    residual: np.ndarray
    slopes: np.ndarray
    effects: np.ndarray


@dataclass(frozen=True, eq=False)
class _Weighed:
    """The likelihood of residuals under one noise, and the posterior of the sizes of an effect."""

    likelihood: float
    mean: np.ndarray
    covariance: np.ndarray


def missing_effect(
    solution: Solution, covariance: np.ndarray, fitted: Sequence[Comparison], unit_time: float
) -> MissingEffect | None:
    """Return the effect that the residuals of heading and rate of turn share most with; None where they are noise.

    Parameters
    ----------
    solution : Solution
        At its optimum, of least squares, also of whitened residuals; none is looked for in another.
    covariance : ndarray, shape (parameters, parameters)
        Of its coefficients by noise; infinite variances stay.
    fitted : sequence of Comparison
        The fitted trials, which tell how the ship turns.
    unit_time : float
        L/U in s.
    """
    problem, shared = solution.problem, len(solution.problem.estimated)
    yaw = [j for j, s in enumerate(problem.signals) if s in _YAW]
    turning = _turning(fitted)
    by_residuals = solution.covariance is None or solution.whitened
    if not by_residuals or not (yaw and shared and turning and "delta" in problem.model.inputs):
        return None
    noise = _coloured(solution, yaw)
    if not noise:
        return None
    kinds = [dict(_effects(problem, data, unit_time)) for data in problem.trials]
    names = [n for n in EFFECTS if all(n in k for k in kinds)]
    before: float | None = None
    evidence, errors = {}, {}
    for name, (rows, pulled) in zip(names, _rows(solution, yaw, [[k[n] for n in names] for k in kinds], turning)):
        if before is None:
            # Without an effect all are alike.
            before = _weighed(rows, noise, alone=True).likelihood
        if solution.whitened:
            pulled = _pulled_white(rows, noise)
        after = _with_effect(rows)
        evidence[name] = after.likelihood - before
        second = np.outer(after.mean, after.mean) + after.covariance
        errors[name] = pulled @ second @ pulled.T
    best = max(evidence, key=evidence.__getitem__, default="")
    if not best or evidence[best] < _EVIDENCE:
        return None
    about_as_well = [n for n in evidence if evidence[n] >= _ABOUT_AS_WELL * evidence[best]]
    together = np.sum([errors[n] for n in about_as_well], axis=0)
    wide, wider = _widened(covariance, together[:shared, :shared])
    return MissingEffect(
        tuple(sorted(about_as_well, key=lambda n: -evidence[n])), evidence[best], together, wide, wider
    )


def _coloured(solution: Solution, yaw: Sequence[int]) -> list[Autoregression]:
    """The noise of each series of the residuals of heading and rate of turn; empty where none is coloured: then nothing is missing."""
    problem = solution.problem
    series = []
    for i, (data, rows) in enumerate(zip(problem.trials, problem.rows)):
        residual = solution.residual[rows].reshape(len(problem.signals), -1)
        for g in groups_of(data, i, residual, np.zeros((*residual.shape, 0)), np.arange(0)):
            kept = [k for k, j in enumerate(g.signals) if j in yaw]
            if kept:
                series.append(g.residual[kept])
    noise = [autoregression_of(s) for s in series]
    # A record in many series has one of them that looks coloured by chance.
    chance = np.log(max(len(series), 1))
    return noise if sum(colour(m, s) for m, s in zip(noise, series) if m.order) > chance else []


def _widened(covariance: np.ndarray, errors: np.ndarray) -> tuple[np.ndarray, float]:
    """A covariance with further errors, and by what factor a standard deviation grows at most."""
    known = np.isfinite(np.diag(covariance))
    wide = np.where(np.outer(known, known), covariance + errors, covariance)
    before, after = np.diag(covariance)[known], np.diag(wide)[known]
    ratios = after[before > 0] / before[before > 0]
    return wide, float(np.sqrt(ratios.max(initial=1.0)))


def _turning(fitted: Sequence[Comparison]) -> float:
    """Root-mean-square of the predicted rate of turn in rad/s; zero where there is none."""
    rates = []
    for c in fitted:
        psi, t = c.predicted.get("psi"), c.trial["t"]
        if "r" in c.predicted or (psi is not None and t.size > 1):
            rates.append(c.predicted["r"] if "r" in c.predicted else np.gradient(np.asarray(psi), t))
    together = np.concatenate(rates) if rates else np.zeros(0)
    together = together[np.isfinite(together)]
    return float(np.std(together)) if together.size else 0.0


def _effects(problem: Problem, data: TrialData, unit_time: float) -> Iterator[tuple[str, np.ndarray]]:
    """Each effect on rate of turn and heading, through each time constant, shape (2, times, N)."""
    t = data.t
    step = max(float(np.median(data.intervals[:-1])) if t.size > 1 else 0.0, t[-1] / 20_000, 1e-9)
    grid = np.arange(0.0, t[-1] + step, step)
    rudder = np.interp(grid, t, data.inputs[problem.model.inputs.index("delta")])
    size = float(np.sqrt(np.mean(rudder**2)))
    if not np.isfinite(size) or size <= 0:
        return

    def answers(*drives: np.ndarray) -> np.ndarray:
        rates = np.array([_late(d, step / (time * unit_time)) for d in drives for time in _TIMES])
        turned = np.cumsum(rates, axis=1) * step - rates * step
        return np.array([[np.interp(t, grid, row) for row in kind] for kind in (rates, turned)])

    yield "lag", answers(rudder)
    yield "force", answers(rudder * np.abs(rudder) / size, size * np.tanh(rudder / (0.1 * size)))
    yield "side", answers(np.abs(rudder))
    if data.shows("u"):
        speed = np.interp(grid, t, data.column("u"))
        # Of a log with noise the mean over half of L/U, from the speed at the start on.
        start = float(np.mean(speed[: max(1, int(0.5 * unit_time / step))]))
        lost = _late(speed - start, step / (0.5 * unit_time))
        if start > 0 and np.ptp(lost) > _NOTHING * start:
            yield "speed", answers(rudder * lost / start)
    if data.shows("psi"):
        heading = np.interp(grid, t, data.column("psi"))
        yield "heading", answers(size * np.sin(heading), size * np.cos(heading))


def _late(drive: np.ndarray, share: float) -> np.ndarray:
    """The drive through a first-order lag, of which a step is so large a share."""
    kept = np.exp(-share)
    return np.asarray(lfilter([1.0 - kept], [1.0, -kept], drive))


def _rows(
    solution: Solution, yaw: Sequence[int], effects: Sequence[Sequence[np.ndarray]], turning: float
) -> Iterator[tuple[list[_Rows], np.ndarray]]:
    """Of each effect the series of the residuals of heading and rate of turn, and by what one of unit size pulls each unknown.

    The effects of each trial are those of `EFFECTS` that all trials have, in the same order.
    """
    problem = solution.problem
    signals, size = len(problem.signals), problem.size
    if not effects or not effects[0]:
        return
    widths = [e.shape[1] for e in effects[0]]
    # All effects beside each other: residuals are put in series once.
    together = [np.concatenate(of_trial, axis=1) for of_trial in effects]
    unit = np.sqrt(np.concatenate([e[0] ** 2 for e in together], axis=1).mean(axis=1))
    scale = np.where(unit > 0, turning / np.where(unit > 0, unit, 1.0), 0.0)
    found, along = [], np.zeros((size, scale.size))
    for i, (data, effect, rows) in enumerate(zip(problem.trials, together, problem.rows)):
        count = data.intervals.size
        shown = np.zeros((signals, count, scale.size))
        for j in yaw:
            shown[j] = (effect[0 if problem.signals[j] == "r" else 1].T * scale) / problem.sigma[j]
        if problem.weights is not None:
            shown *= np.sqrt(problem.weights[i])[:, :, None]
        shown[~data.there] = 0.0
        slopes = solution.jacobian[rows]
        along += slopes.T @ shown.reshape(-1, scale.size)
        both = np.concatenate([slopes.reshape(signals, count, -1), shown], axis=2)
        every = np.arange(size)
        for g in groups_of(data, i, solution.residual[rows].reshape(signals, count), both, every):
            kept = [k for k, j in enumerate(g.signals) if j in yaw]
            if kept:
                found.append((g.residual[kept], g.jacobian[kept]))
    norms = np.linalg.norm(solution.jacobian, axis=0)
    norms = np.where(norms > 0, norms, 1.0)
    inverse = np.linalg.pinv(solution.jacobian / norms, rcond=_NOTHING) / norms[:, None]
    pulled = inverse @ inverse.T @ along
    ends = np.cumsum(widths)
    for begin, end in zip(ends - widths, ends):
        own = [_Rows(r, j[:, :, :size], j[:, :, size + begin : size + end]) for r, j in found]
        yield own, pulled[:, begin:end]


def _pulled_white(rows: Sequence[_Rows], noise: Sequence[Autoregression]) -> np.ndarray:
    """By what an effect of unit size pulls each unknown where residuals are whitened: there the noise says which rows count."""
    white = [whitened(model, np.concatenate([r.slopes, r.effects], axis=2))[0] for r, model in zip(rows, noise)]
    together, unknowns = np.concatenate(white), rows[0].slopes.shape[2]
    return np.array([_solved(together[:, :unknowns], column) for column in together[:, unknowns:].T]).T


def _with_effect(rows: Sequence[_Rows]) -> _Weighed:
    """The likelihood with an effect, under the noise that is left without it."""
    slopes = np.concatenate([r.slopes.reshape(-1, r.slopes.shape[2]) for r in rows])
    effects = np.concatenate([r.effects.reshape(-1, r.effects.shape[2]) for r in rows])
    residual = np.concatenate([r.residual.ravel() for r in rows])
    free = _solved(np.hstack([slopes, effects]), residual)
    own, size = free[: slopes.shape[1]], free[slopes.shape[1] :]
    best: _Weighed | None = None
    for _ in range(_TURNS):
        noise = [autoregression_of(r.residual - r.slopes @ own - r.effects @ size) for r in rows]
        found = _weighed(rows, noise)
        best = found if best is None or found.likelihood > best.likelihood else best
        size = found.mean
        own = _solved(slopes, residual - effects @ size)
    assert best is not None, "there is one turn at least"
    return best


def _solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Least squares, with columns of very different size."""
    norms = np.linalg.norm(matrix, axis=0)
    norms = np.where(norms > 0, norms, 1.0)
    return np.asarray(np.linalg.lstsq(matrix / norms, right, rcond=_NOTHING)[0] / norms)


def _weighed(rows: Sequence[_Rows], noise: Sequence[Autoregression], alone: bool = False) -> _Weighed:
    """The likelihood of the residuals, the unknowns being free, with the most likely size of the effect or without it."""
    whole, volume = [], 0.0
    for r, model in zip(rows, noise):
        joined = np.concatenate([r.residual[:, :, None], r.slopes, r.effects], axis=2)
        white, log_volume = whitened(model, joined)
        whole.append(white)
        volume += log_volume
    together = np.concatenate(whole)
    unknowns = rows[0].slopes.shape[2]
    residual, slopes, effects = together[:, 0], together[:, 1 : 1 + unknowns], together[:, 1 + unknowns :]
    norms = np.linalg.norm(slopes, axis=0)
    seen = norms > _NOTHING * norms.max(initial=0.0)
    basis = np.linalg.qr(slopes[:, seen] / norms[seen])[0]
    residual, effects = (x - basis @ (basis.T @ x) for x in (residual, effects))
    likelihood = -0.5 * (volume + float(residual @ residual))
    count = effects.shape[1]
    if alone:
        return _Weighed(likelihood, np.zeros(count), np.zeros((count, count)))
    information, vectors = np.linalg.eigh(effects.T @ effects)
    information = np.clip(information, 0.0, None)
    pull = vectors.T @ (effects.T @ residual)
    variance = _SIZES[:, None] ** 2
    gains = 0.5 * (variance * pull**2 / (1 + variance * information) - np.log1p(variance * information)).sum(axis=1)
    gains -= 0.5 * (_SIZES / _USUAL) ** 2
    k = int(np.argmax(gains))
    posterior = variance[k] / (1 + variance[k] * information)
    return _Weighed(likelihood + float(gains[k]), vectors @ (posterior * pull), (vectors * posterior) @ vectors.T)
