"""Null directions in words: combinations of coefficients that the trials do not determine, and what would help.

The eigenvectors of the covariance in relative units are the directions in which the coefficients may move. Those that no data
determine (a combination without effect in the model, a coefficient without influence) are made as sparse as possible,
so that each names the fewest coefficients. What would help is computed: the information of other manoeuvres, another
speed and missing signals is found for the fitted ship (`shipid.identification.uncertainty.remedies`), and the one that
narrows the direction most is named.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from shipid.estimation.standing import UNDETERMINED
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import brief
from shipid.foundation.result import Result
from shipid.identification.identified import Identified
from shipid.identification.uncertainty.covariance import covariance_of
from shipid.identification.uncertainty.remedies import SIGNAL_WORDS, Remedies, share_words

#: Relative standard deviation from which a direction is reported; beyond `_OPEN` no data determine it.
WEAK, _OPEN, _LOOSE = 0.1, 30.0, 1e3
#: Weight, beside the largest, from which a coefficient takes part.
_PART = 0.1
#: Coefficients whose share in a direction is spelt out, beside the one that moves most.
_NAMED = 3


@dataclass(frozen=True, repr=False)
class NullDirection(Result):
    """A direction in which the coefficients may move together.

    Attributes
    ----------
    parameters : mapping of str to float
        The coefficients that take part and how far each moves, relative to its size; the largest moves by 1 or -1.
    relative_std : float or None
        Standard deviation of that one along the direction, relative to its size; None where no data determine it.
    words : str
        The same in words, and what would help.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"relative_std": "1"}

    parameters: dict[str, float]
    relative_std: float | None
    words: str

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {"parameters": dict(self.parameters), "relative_std": self.relative_std, "words": self.words}


def directions_of(identified: Identified, manoeuvres: Sequence[str]) -> tuple[NullDirection, ...]:
    """Return the directions in which the coefficients are weakly determined, the weakest first; empty where there is none.

    Parameters
    ----------
    identified : Identified
        What was identified.
    manoeuvres : sequence of str
        What each fitted trial is, in words, as in ``"20/20 zig-zag"``.
    """
    problem, solution = identified.problem, identified.solution
    if not np.isfinite(solution.jacobian).all():
        return ()
    names, size = problem.estimated, _sizes(identified)
    relative = covariance_of(solution, _LOOSE * size).matrix[: len(names), : len(names)] / np.outer(size, size)
    if not np.isfinite(relative).all():
        return ()
    variances, vectors = np.linalg.eigh(relative)
    spreads = np.sqrt(np.clip(variances, 0.0, None))
    lost = spreads > _OPEN
    basis = [(v, None) for v in sparse_basis(vectors[:, lost].T)]
    basis += [(vectors[:, k], spreads[k]) for k in np.argsort(-spreads) if not lost[k]]
    found: list[NullDirection] = []
    fitted = _fitted(manoeuvres, problem.signals)
    remedies = Remedies(identified, relative, size)
    for vector, spread in basis:
        top = float(np.abs(vector).max())
        moved = vector / vector[int(np.argmax(np.abs(vector)))]
        deviation = None if spread is None else float(spread * top)
        if deviation is not None and deviation < WEAK:
            continue
        parts = {
            n: round(float(w), 4) for n, w in sorted(zip(names, moved), key=lambda p: -abs(p[1])) if abs(w) >= _PART
        }
        found.append(
            NullDirection(parts, deviation, f"{_what(fitted, parts, deviation)} {remedies.words(vector, deviation)}")
        )
    return tuple(found)


def _sizes(identified: Identified) -> np.ndarray:
    """A typical size of each fitted coefficient: its value, or its declared start where that is larger."""
    sizes = []
    for name, value in zip(identified.problem.estimated, identified.solution.parameters.tolist()):
        entry = identified.model[name]
        start, low = abs(identified.scale.start_of(entry) or 0.0), entry.number("low")
        positive = low is not None and low > 0
        sizes.append(abs(value) if positive or abs(value) > start else start or abs(value) or 1.0)
    return np.array(sizes)


def sparse_basis(basis: np.ndarray) -> list[np.ndarray]:
    """Return vectors of unit length that span the same space, each with the fewest coefficients.

    Parameters
    ----------
    basis : ndarray, shape (directions, n)
        Independent rows; they are brought to row echelon form with full pivoting.
    """
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


def _what(fitted: str, parts: dict[str, float], deviation: float | None) -> str:
    lead, *others = names = list(parts)
    if not others:
        if deviation is None:
            return f"{lead} has no effect in {fitted}."
        how = "has hardly any effect in" if deviation > UNDETERMINED else "is only roughly known from"
        return f"{lead} {how} {fitted}: ±{share_words(deviation)}."
    named = others[:_NAMED]
    together = "; ".join(
        f"{n} by {brief(abs(parts[n]), 2)} times as much {_side(parts[n], parts[lead])}" for n in named
    )
    together += f"; {_listed(others[_NAMED:])} by less" if others[_NAMED:] else ""
    roughly = deviation is not None and deviation <= UNDETERMINED
    how = "can be separated only roughly" if roughly else "cannot be separated"
    far = (
        "without limit" if deviation is None else f"by ±{share_words(deviation)} (one standard deviation, of its size)"
    )
    return f"{_listed(names)} {how} from {fitted}: {lead} may move {far} as long as the others go with it: {together}."


def _side(one: float, other: float) -> str:
    return "to the same side" if one * other > 0 else "to the opposite side"


def _listed(names: Sequence[str], last: str = "and") -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {last} {names[-1]}"


def _fitted(manoeuvres: Sequence[str], signals: Sequence[str]) -> str:
    """What was fitted, in words: ``one 20/20 zig-zag with the heading``."""
    numbers = {1: "one", 2: "two", 3: "three", 4: "four", 5: "five"}
    words = [f"{numbers.get(n, str(n))} {kind}{'s' if n > 1 else ''}" for kind, n in Counter(manoeuvres).items()]
    return _listed(words) + f" with {_listed([SIGNAL_WORDS.get(s, s) for s in signals])}"
