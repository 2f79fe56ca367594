"""Null directions in words: which coefficients the trials cannot tell apart, how they may move together, and what would help.

The eigenvectors of the covariance in relative units are the directions in which the coefficients may move. Those that no data
hold (a combination that does not show in the model at all, a coefficient without influence) are made as sparse as they can be,
so that each names the fewest coefficients. What would help is not guessed: the information of other manoeuvres, another
speed and missing signals is worked out for the fitted ship, and the one that narrows the direction most is named.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from shipid.declaration.scale import prime_factor
from shipid.foundation.errors import ShipidError
from shipid.generation.system import generate
from shipid.identification.problem.prior import scales_of
from shipid.identification.problem.scale import unit_time_of
from shipid.identification.problem.trial_data import SIGNALS, unknown_biases
from shipid.identification.uncertainty.covariance import UNDETERMINED, covariance_of
from shipid.identification.uncertainty.information import Question, Sail
from shipid.trials.manoeuvres.manoeuvre import parse_manoeuvre
from shipid.trials.measuring.measure import measure
from shipid.trials.measuring.measures import ZigZag

if TYPE_CHECKING:
    from shipid.identification.fit import Fit

#: Relative standard deviation from which a direction is spoken of; beyond `_OPEN` no data hold it.
WEAK, _OPEN, _LOOSE = 0.1, 30.0, 1e3
#: Weight, beside the largest, from which a coefficient takes part.
_PART = 0.1
#: Coefficients whose share in a direction is spelt out, beside the one that moves most.
_NAMED = 3
_MANOEUVRES = ("zigzag:5/5", "zigzag:10/10", "zigzag:20/20", "zigzag:30/20", "turn:20", "turn:35")
_NAMES = {"v": "the sway speed", "u": "the forward speed", "r": "the rate of turn", "psi": "the heading"}
#: A manoeuvre helps if it narrows the direction to this part; a pair of trials of one kind gives 0.7.
_HELPS = 0.5


@dataclass(frozen=True)
class Direction:
    """A direction in which the coefficients may move together.

    Attributes
    ----------
    parameters : mapping of str to float
        The coefficients that take part and how far each moves, relative to its size; the largest moves by 1 or -1.
    relative_std : float or None
        Standard deviation of that one along the direction, relative to its size; None where no data hold it.
    words : str
        The same in words, and what would help.
    """

    parameters: dict[str, float]
    relative_std: float | None
    words: str

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return {"parameters": dict(self.parameters), "relative_std": self.relative_std, "words": self.words}


def directions_of(fit: Fit) -> tuple[Direction, ...]:
    """Return the directions in which a fit is weakly determined, the weakest first; empty where there is none.

    Parameters
    ----------
    fit : Fit
        The fit.
    """
    problem, solution = fit._problem, fit._solution
    if problem is None or not np.isfinite(solution.jacobian).all():
        return ()
    names = problem.estimated
    size = _sizes(fit)
    relative = covariance_of(solution, _LOOSE * size).matrix[: len(names), : len(names)] / np.outer(size, size)
    if not np.isfinite(relative).all():
        return ()
    variances, vectors = np.linalg.eigh(relative)
    spreads = np.sqrt(np.clip(variances, 0.0, None))
    lost = spreads > _OPEN
    basis = [(v, None) for v in _sparse(vectors[:, lost].T)]
    basis += [(vectors[:, k], spreads[k]) for k in np.argsort(-spreads) if not lost[k]]
    found: list[Direction] = []
    help_ = _Help(fit, relative, size)
    for vector, spread in basis:
        top = float(np.abs(vector).max())
        moved = vector / vector[int(np.argmax(np.abs(vector)))]
        deviation = None if spread is None else float(spread * top)
        if deviation is not None and deviation < WEAK:
            continue
        parts = {
            n: round(float(w), 4) for n, w in sorted(zip(names, moved), key=lambda p: -abs(p[1])) if abs(w) >= _PART
        }
        found.append(Direction(parts, deviation, f"{_what(fit, parts, deviation)} {help_.words(vector, deviation)}"))
    return tuple(found)


def _sizes(fit: Fit) -> np.ndarray:
    """A typical size of each fitted coefficient: its value, or its declared start where that is larger."""
    trials = [c.trial for c in fit.fitted]
    unit_time = unit_time_of(fit.ship, trials)
    speed = (fit.ship.particular("L", "m") or unit_time) / unit_time
    sizes = []
    for name, value in zip(fit._problem.estimated, fit._solution.q):
        entry = fit.model[name]
        start = abs(entry.number("start") or 0.0)
        start *= prime_factor(entry.unit, speed * unit_time, speed) if entry.quantity.prime else 1.0
        low = entry.number("low")
        positive = low is not None and low > 0
        sizes.append(abs(value) if positive or abs(value) > start else start or abs(value) or 1.0)
    return np.array(sizes)


def _sparse(basis: np.ndarray) -> list[np.ndarray]:
    """Row echelon form with full pivoting: the fewest coefficients in each direction; rows of unit length."""
    rows = basis.copy()
    pivots: list[int] = []
    for i in range(len(rows)):
        open_ = np.abs(rows[i:]).copy()
        open_[:, pivots] = 0.0
        j, k = divmod(int(np.argmax(open_)), open_.shape[1])
        rows[[i, i + j]] = rows[[i + j, i]]
        rows[i] /= rows[i, k]
        for other in range(len(rows)):
            if other != i:
                rows[other] -= rows[other, k] * rows[i]
        pivots.append(k)
    rows[np.abs(rows) < 1e-3] = 0.0
    return [row / np.linalg.norm(row) for row in rows]


def _what(fit: Fit, parts: dict[str, float], deviation: float | None) -> str:
    names, from_ = list(parts), _sailed(fit)
    lead, *others = names
    if not others:
        if deviation is None:
            return f"{lead} does not show in {from_} at all."
        how = "is hardly seen in" if deviation > UNDETERMINED else "is only roughly known from"
        return f"{lead} {how} {from_}: ±{_percent(deviation)}."
    named = others[:_NAMED]
    together = "; ".join(f"{n} by {abs(parts[n]):.2g} times as much {_side(parts[n], parts[lead])}" for n in named)
    together += f"; {_listed(others[_NAMED:])} by less" if others[_NAMED:] else ""
    how = (
        "can be told apart only roughly"
        if deviation is not None and deviation <= UNDETERMINED
        else "cannot be told apart"
    )
    far = "without limit" if deviation is None else f"by ±{_percent(deviation)}"
    return (
        f"{_listed(names)} {how} from {from_}: {lead} may move {far} (one standard deviation, of its size)"
        if deviation is not None
        else f"{_listed(names)} {how} from {from_}: {lead} may move {far}"
    ) + f" as long as the others go with it: {together}."


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %" if share < 0.995 else f"{100 * share:.0f} %"


def _side(one: float, other: float) -> str:
    return "to the same side" if one * other > 0 else "to the opposite side"


def _listed(names: Sequence[str], last: str = "and") -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {last} {names[-1]}"


def _sailed(fit: Fit) -> str:
    """What was fitted, in words: ``one 20/20 zig-zag``."""
    kinds = []
    for c in fit.fitted:
        try:
            found = measure(c.trial)
            kinds.append(f"{found.nominal} zig-zag" if isinstance(found, ZigZag) else found.kind)
        except ShipidError:
            kinds.append("record")
    counts = Counter(kinds)
    numbers = {1: "one", 2: "two", 3: "three", 4: "four", 5: "five"}
    words = [f"{numbers.get(n, str(n))} {kind}{'s' if n > 1 else ''}" for kind, n in counts.items()]
    return _listed(words) + f" with {_listed([_NAMES.get(s, s) for s in fit._problem.signals])}"


class _Help:
    """What would narrow a direction: information of other manoeuvres, worked out when it is first asked for."""

    def __init__(self, fit: Fit, relative: np.ndarray, size: np.ndarray) -> None:
        self._fit, self._relative, self._size = fit, relative, size
        self._found: list[tuple[str, np.ndarray]] | None = None

    def words(self, vector: np.ndarray, deviation: float | None) -> str:
        if self._found is None:
            try:
                self._found = list(self._candidates())
            except ShipidError:
                self._found = []
        if not self._found:
            return "What would help: other amplitudes and speeds, or holding one of them at a value that is known."
        unit = vector / np.linalg.norm(vector)
        before = float(np.sqrt(unit @ self._relative @ unit))
        inverse = np.linalg.inv(self._relative)
        variances = [float(unit @ np.linalg.inv(inverse + matrix) @ unit) for _, matrix in self._found]
        # Where a combination is entirely open, rounding may leave less than nothing of a variance.
        ratios = [float(np.sqrt(max(variance, 0.0))) / before for variance in variances]
        helping = [k for k, ratio in enumerate(ratios) if ratio < _HELPS]
        if not helping:
            best = int(np.argmin(ratios))
            if ratios[best] > 0.9 or deviation is None:
                return (
                    "No other manoeuvre or signal tells them in this model: only the combination matters. Hold one of them at "
                    "a value that is known, or choose a model without it."
                )
            return f"{self._found[best][0]} as well: that would bring it to {_percent(ratios[best])} of this, more of it to less."
        # The least effort first: the same sensors, and of the manoeuvres that help nearly as much, the first.
        best = min(helping, key=lambda k: ratios[k])
        easy = next(k for k in helping if ratios[k] <= 1.5 * ratios[best])
        left = ratios[easy] * before * float(np.abs(unit).max())
        return f"{self._found[easy][0]} as well: that would bring it to about ±{_percent(left)}."

    def _candidates(self) -> Any:
        fit, problem = self._fit, self._fit._problem
        trials = [c.trial for c in fit.fitted]
        length, unit_time = fit.ship.particular("L", "m"), unit_time_of(fit.ship, trials)
        if length is None or "delta" not in problem.model.inputs:
            return
        speed = length / unit_time
        limit = fit.ship.particular("delta_max", "rad") or np.deg2rad(35.0)
        own = dict(zip(problem.estimated, fit._solution.q[: len(problem.estimated)].tolist()))
        machine = {"delta_max": limit, "delta_rate": fit.ship.particular("delta_rate", "rad/s") or np.deg2rad(2.3)}
        known = {"tau_delta": 0.5} | machine | dict(problem.fixed) | own
        excess = covariance_of(fit._solution).excess[: len(problem.estimated)]
        rate = 1 / trials[0].sampling / max(1.0, float(np.mean(excess)))
        extra = [s for s in SIGNALS if s in problem.model and s not in problem.signals and _predicted(problem.model, s)]
        level = dict(zip(problem.signals, problem.sigma.tolist()))
        level |= dict(zip(extra, 0.2 * scales_of(tuple(extra), problem.sailed[0], unit_time)))
        sizes = np.array([abs(s) for s in self._size])

        def information(text: str, signals: tuple[str, ...], at: float) -> np.ndarray | None:
            initial = generate(problem.model).states_behind(signals)
            sigma = np.array([level[s] for s in signals])
            biases = unknown_biases(problem.model, signals)
            question = Question(problem.model, length, problem.estimated, initial, biases, signals, sigma, rate, limit)
            found = question.information(Sail(parse_manoeuvre(text), at), [30 * length / at], known, sizes)
            return None if found is None else np.asarray(found[-1])

        allowed = [m for m in _MANOEUVRES if parse_manoeuvre(m).numbers[0] <= limit + 1e-9]
        for text in allowed:
            matrix = information(text, problem.signals, speed)
            if matrix is not None:
                yield f"Sail a {_manoeuvre_words(text)}", matrix
        if all(problem.model[n].unit in ("", "1") for n in problem.estimated):
            matrix = information("zigzag:20/20", problem.signals, 0.6 * speed)
            if matrix is not None:
                yield f"Sail a 20/20 zig-zag at {0.6 * speed:.2g} m/s", matrix
        for signal in extra:
            matrix = information("zigzag:20/20", (*problem.signals, signal), speed)
            if matrix is not None:
                yield f"Measure {_NAMES.get(signal, signal)} in a 20/20 zig-zag", matrix


def _predicted(model: Any, name: str) -> bool:
    return model[name].quantity.kind in ("state", "derived", "output")


def _manoeuvre_words(text: str) -> str:
    kind, _, numbers = text.partition(":")
    return f"{numbers} zig-zag" if kind == "zigzag" else f"turning circle with {numbers} deg of rudder"
