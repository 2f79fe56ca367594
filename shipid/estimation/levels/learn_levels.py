"""Noise levels from a record: those under which it is most probable, found together with the coefficients.

Sensors differ from ship to ship, and a model of low order is never exact: neither its sensors' noise nor what drives its states
is known beforehand. Both are in the innovations (Mehra 1970; Astrom 1980). The likelihood is maximised over the levels and over
the estimated coefficients, as constants with the filter's own first standard deviations as prior, on a record without its wild
samples.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np

from shipid.declaration.vocabulary import display_unit
from shipid.estimation.design import FilterDesign, FilterSettings, design_filter
from shipid.estimation.levels.ascent import Summit, climb
from shipid.estimation.levels.cleaned import cleaned, pieces, resolution
from shipid.estimation.levels.long_run import long_run_deviations
from shipid.estimation.levels.record_levels import Judged, RecordLevels
from shipid.estimation.records.arrangement import FilterRecord
from shipid.estimation.records.likelihood import make_likelihood
from shipid.estimation.settings.instruments import Amount
from shipid.estimation.settings.noise import times

#: A sensor is at most so many times better and worse than the level it starts from; noise of states likewise.
_BETTER, _WORSE, _LEAST, _MOST = 100.0, 300.0, 1e-3, 1e3
#: Prior standard deviation of the logarithm of a level: one of which the record says nothing stays where it starts.
_PRIOR = 3.0
#: Sensors are taken for so many times worse at first: from there the search finds its way more often.
_FIRST = 3.0
#: Prior standard deviation of the bias of a rudder [rad].
_BIAS = np.deg2rad(5.0)
#: Share of its default at which noise of a state has no influence: what remains is output error.
_NOTHING = 1e-5
#: Natural logarithm of the largest factor on a coefficient.
_REACH = 5.0


def learn_levels(
    design: FilterDesign, settings: FilterSettings, record: FilterRecord, kept: Collection[str] = ()
) -> RecordLevels:
    """Return the noise levels of a filter under which a record is most probable.

    Parameters
    ----------
    design : FilterDesign
        The filter, with the levels to start from.
    settings : FilterSettings
        What it was made of.
    record : Trial or mapping of str to ndarray
        What is filtered.
    kept : collection of str
        ``sensor:NAME`` and ``noise:NAME`` that stay as they are.

    Returns
    -------
    RecordLevels
    """
    problem = _Problem(design, settings, record)
    stays = {*kept, *(f"noise:{n}" for n in design.instruments.lost)}
    learnt = tuple(k for k in problem.keys if k not in stays)
    low, high = problem.bounds(learnt)
    found = climb(problem, problem.start(), low, high)
    levels = problem.levels(found.at) if np.isfinite(found.value) else problem.levels(problem.middle)
    coefficients = {}
    if np.isfinite(found.value):
        inverse, spread = problem.deviations(found)
        simulated = _simulated(problem, found)
        for i, name in enumerate(problem.still):
            own = np.sqrt(inverse[i, i])
            widening = max(1.0, float(spread[i] / own)) if own > 0 and np.isfinite(spread[i]) else 1.0
            coefficients[name] = Judged(float(problem.coefficients(found.at)[i]), widening, *simulated.get(name, ()))
    sensors = {n: levels[f"sensor:{n}"] for n in design.measured}
    noise = {s.name: levels[f"noise:{s.name}"] for s in design.sources}
    return RecordLevels(sensors, noise, learnt, coefficients, found.converged, found.evaluations, problem.units)


def _simulated(problem: _Problem, found: Summit) -> dict[str, tuple[float, float]]:
    """Value and standard deviation of each coefficient by output error: no noise drives the ship, and the rudder has a bias.

    Where the model itself is declared with noise, or coefficients change, there is no such estimate.
    """
    design = problem.design
    if not problem.still or any(not s.assumed for s in design.sources) or len(problem.still) < len(design.parameters):
        return {}
    sensors = tuple(k for k in problem.keys if k.startswith("sensor:"))
    low, high = problem.bounds(sensors, biased=True)
    quiet = [i for i, k in enumerate(problem.names) if k.startswith("noise:")]
    low[quiet] = high[quiet] = problem.middle[quiet] + np.log(_NOTHING)
    start = np.where([k in sensors for k in problem.names], problem.middle + np.log(_FIRST), found.at)
    ended = climb(problem, np.clip(start, low, high), low, high)
    if not ended.converged:
        return {}
    _, spread = problem.deviations(ended)
    values = problem.coefficients(ended.at)
    slopes = problem.slopes(ended.at)
    return {n: (float(values[i]), float(spread[i] * slopes[i])) for i, n in enumerate(problem.still)}


class _Problem:
    """The likelihood of a record, with priors, as a function of coefficients, logarithms of levels, and the bias of a rudder.

    Positive coefficients are unknowns by their logarithm, others in units of their first standard deviation.
    """

    def __init__(self, design: FilterDesign, settings: FilterSettings, record: FilterRecord) -> None:
        self.design = design
        driven = {s.name for s in design.sources}
        walking = [n for n, state in design.parameters.items() if state in driven]
        self.still = tuple(n for n in design.parameters if n not in walking)
        self.keys = (*(f"sensor:{n}" for n in design.measured), *(f"noise:{s.name}" for s in design.sources))
        fixed = design_filter(design.base, design.ship, self._with_constants(settings, walking))
        given = settings.inputs or {}
        biases = tuple(f"bias:{n}" for n in ("delta",) if n in fixed.model.inputs and n not in given)
        self.names = (*self.still, *self.keys, *biases)
        self.units = {k: _units_of(design, k) for k in self.keys}
        columns = cleaned(design, record)
        self.likelihoods = [make_likelihood(fixed, part, self.names) for part in pieces(columns)]
        first = design.first.parameters
        self.logs = np.array([design.parameters[n] != n for n in self.still], dtype=bool)
        self.origin = np.array([first[n][0] for n in self.still])
        own = np.array([design.first.deviations.get(n, first[n][1]) for n in self.still])
        self.size = np.where(self.logs, 1.0, np.where(own > 0, own, 1.0))
        levels = np.log(np.concatenate([design.r, design.q]))
        self.middle = np.concatenate(
            [np.where(self.logs, np.log(np.abs(self.origin) + ~self.logs), 0.0), levels, np.zeros(len(biases))]
        )
        prior = np.where(self.logs, own / np.abs(self.origin + ~self.logs), own / self.size)
        self.prior = np.concatenate([prior, np.full(levels.size, _PRIOR), np.full(len(biases), _BIAS)])
        steps = [self._resolution(columns, n) for n in design.measured]
        self._finest = np.log(np.maximum(design.r / _BETTER, np.array(steps) / np.sqrt(12)))

    def _with_constants(self, settings: FilterSettings, walking: list[str]) -> FilterSettings:
        """The settings of the same filter in which coefficients that do not change are constants."""

        def others(given: Mapping[str, Amount] | None) -> dict[str, Amount]:
            return {n: v for n, v in (given or {}).items() if n not in self.still}

        values = dict(settings.values or {}) | {n: self.design.first.parameters[n][0] for n in self.still}
        return replace(
            settings,
            values=values,
            estimated=walking,
            noise=others(settings.noise),
            start=others(settings.start),
            initial=others(settings.initial),
            gate=None,
            form="covariance",
            switchable=False,
            single=False,
        )

    def _resolution(self, columns: Mapping[str, np.ndarray], sensor: str) -> float:
        column = self.design.instruments.column_of(sensor, columns)
        return 0.0 if column is None else resolution(columns[column])

    def start(self) -> np.ndarray:
        """Where the search begins."""
        sensors = [k.startswith("sensor:") for k in self.names]
        return np.where(sensors, self.middle + np.log(_FIRST), self.middle)

    def bounds(self, learnt: Collection[str], biased: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Bounds of the unknowns: levels that are not learnt stay, and so does the bias where there is none."""
        low, high = self.middle.copy(), self.middle.copy()
        still, sensors = len(self.still), len(self.design.measured)
        low[:still], high[:still] = self.middle[:still] - _REACH, self.middle[:still] + _REACH
        low[still : still + sensors] = np.minimum(self._finest, high[still : still + sensors])
        high[still : still + sensors] += np.log(_WORSE)
        rest = slice(still + sensors, still + len(self.keys))
        low[rest] += np.log(_LEAST)
        high[rest] += np.log(_MOST)
        if biased:
            low[still + len(self.keys) :], high[still + len(self.keys) :] = -4 * _BIAS, 4 * _BIAS
        held = [k in self.keys and k not in learnt for k in self.names]
        low[held] = high[held] = self.middle[held]
        return low, high

    def inside(self, z: np.ndarray) -> np.ndarray:
        """The unknowns as the likelihood takes them: SI, logarithms of levels."""
        q = z.copy()
        q[: len(self.still)] = self.coefficients(z)
        return q

    def coefficients(self, z: np.ndarray) -> np.ndarray:
        """The coefficients, SI."""
        own = z[: len(self.still)]
        return np.asarray(np.where(self.logs, np.exp(np.where(self.logs, own, 0.0)), self.origin + self.size * own))

    def slopes(self, z: np.ndarray) -> np.ndarray:
        """Derivative of the coefficients by their unknowns."""
        return np.asarray(np.where(self.logs, self.coefficients(z), self.size))

    def levels(self, z: np.ndarray) -> dict[str, float]:
        """The noise levels, SI, by key."""
        at = len(self.still)
        return dict(zip(self.keys, np.exp(z[at : at + len(self.keys)]).tolist()))

    def _scale(self, z: np.ndarray) -> np.ndarray:
        scale = np.ones(z.size)
        scale[: len(self.still)] = self.slopes(z)
        return scale

    def __call__(self, z: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Value, gradient and information."""
        off, scale = z - self.middle, self._scale(z)
        value, gradient = -0.5 * float(np.sum((off / self.prior) ** 2)), -off / self.prior**2
        information = np.diag(1 / self.prior**2)
        for likelihood in self.likelihoods:
            v, g, h = likelihood(self.inside(z))
            value, gradient, information = value + v, gradient + g * scale, information + h * np.outer(scale, scale)
        return value, gradient, information

    def deviations(self, summit: Summit) -> tuple[np.ndarray, np.ndarray]:
        """Inverse of the information of the coefficients and the bias, and standard deviations under the scores as they are."""
        seen = [i for i, k in enumerate(self.names) if k not in self.keys and np.diag(summit.information)[i] > 0]
        seen = [i for i in seen if not self.names[i].startswith("bias:") or summit.at[i] != 0.0]
        inverse = np.linalg.pinv(summit.information[np.ix_(seen, seen)])
        q, scale = self.inside(summit.at), self._scale(summit.at)
        moves = np.concatenate([likelihood.scores(q) for likelihood in self.likelihoods]) * scale
        return inverse, long_run_deviations(moves[:, seen], inverse)


def _units_of(design: FilterDesign, key: str) -> tuple[str, str]:
    """The unit of a level, and the one it is shown in."""
    kind, _, name = key.partition(":")
    own = design.model[name].unit
    quantity = design.model[name].quantity.measures or name
    units = (own, display_unit(quantity, own))
    source = next((s for s in design.sources if kind == "noise" and s.name == name), None)
    if source is None or not source.density:
        return units
    root = "s^0.5" if source.place == "input" else "1/s^0.5"
    return times(units[0], root), times(units[1], root)
