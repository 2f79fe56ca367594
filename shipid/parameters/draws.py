"""Coefficients of a ship, drawn at random from the uncertainty in its parameter set."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.declaration.units import factor
from shipid.parameters.parameter_set import ParameterSet

#: Standard deviation of a coefficient that the trials do not determine: of its logarithm, or relative to its size.
_LOOSE = 1.0


@dataclass(frozen=True, eq=False)
class Drawn:
    """Samples of coefficients.

    Attributes
    ----------
    names : tuple of str
        Those that are drawn; the others keep their value.
    nominal : ndarray, shape (names,)
        Their values in the set, SI.
    values : ndarray, shape (draws, names)
        SI.
    source : str
        In words, where the spread comes from.
    """

    names: tuple[str, ...]
    nominal: np.ndarray
    values: np.ndarray
    source: str


def draw_coefficients(model: Model, ship: ParameterSet, count: int, seed: int = 0) -> Drawn:
    """Draw the coefficients of a model from the standard deviations and the correlation of a ship's set.

    Coefficients that are positive by their declaration are drawn by their logarithm, and all within their bounds. One that
    the identification left open, without a standard deviation, is spread over its bounds.

    Parameters
    ----------
    model : Model
        The model.
    ship : ParameterSet
        The ship; a table against speed counts as its value at the ship's own speed.
    count : int
        Number of draws.
    seed : int
        Of the draws, which are the same each time by default.

    Returns
    -------
    Drawn
    """
    # A set may state its range alone.
    joint = next((ship.joint[n] for n in model.known_as if n in ship.joint and ship.joint[n].names), None)
    scale = Scale(ship.particular("L", "m"), ship.particular("speed", "m/s"))
    names, nominal, spread, box = [], [], [], []
    open_ones = []
    for name in model.parameters:
        found = ship.find(model, name)
        known = joint is not None and name in joint.names
        if found is None or found.speed or not (found.std or known):
            continue
        entry = model[name]
        value = found.at(None, entry.unit, f"ship {ship.name}")
        # A value from the ship's own set takes precedence over a declared bound.
        low, high = (bound(b, value) for bound, b in zip((min, max), scale.bounds_of(entry)))
        in_log = low > 0 and value > 0
        if found.std:
            deviation = found.std * factor(found.unit, entry.unit)
            deviation = deviation / value if in_log else deviation
        else:
            open_ones.append(name)
            span = np.log(high / low) if in_log and np.isfinite(high) else high - low
            loose = _LOOSE if in_log else _LOOSE * max(abs(value), abs(scale.start_of(entry) or 0.0))
            deviation = min(span / 4, loose) if np.isfinite(span) else loose
        names.append(name)
        nominal.append(value)
        spread.append(deviation)
        box.append((low, high, in_log))
    correlation = np.eye(len(names))
    if joint is not None:
        for i, a in enumerate(names):
            for j, b in enumerate(names):
                if i != j and a in joint.names and b in joint.names:
                    correlation[i, j] = joint.correlation[joint.names.index(a)][joint.names.index(b)]
    values, vectors = np.linalg.eigh(correlation)
    steps = normal_draws(len(names), count, seed) @ (vectors * np.sqrt(np.clip(values, 0.0, None))).T * np.array(spread)
    drawn = np.empty((count, len(names)))
    for k, (low, high, in_log) in enumerate(box):
        moved = nominal[k] * np.exp(np.clip(steps[:, k], -20, 20)) if in_log else nominal[k] + steps[:, k]
        drawn[:, k] = np.clip(moved, low, high)
    return Drawn(tuple(names), np.array(nominal), drawn, _in_words(ship, model, names, open_ones, joint is not None))


def _in_words(ship: ParameterSet, model: Model, names: list[str], open_ones: list[str], joint: bool) -> str:
    if not names:
        return f"ship {ship.name} states no standard deviation for the coefficients of model {model.name}"
    words = f"the covariance of {', '.join(names)} in the set of ship {ship.name}"
    if not joint:
        words = f"the standard deviations of {', '.join(names)} in the set of ship {ship.name}, taken as independent"
    return words + (f"; {', '.join(open_ones)} not determined by trials, spread over the bounds" if open_ones else "")


def normal_draws(size: int, count: int, seed: int) -> np.ndarray:
    """Return standard normal numbers, shape (count, size): a Latin hypercube, each column with one number in every stratum.

    Parameters
    ----------
    size, count : int
        Columns and rows.
    seed : int
        Of the draws.

    Returns
    -------
    ndarray, shape (count, size)
    """
    from scipy.stats import qmc  # loads all of scipy.stats, a third of a second

    if not size:
        return np.zeros((count, 0))
    return np.asarray(ndtri(qmc.LatinHypercube(size, rng=np.random.default_rng([seed, 3])).random(count)))
