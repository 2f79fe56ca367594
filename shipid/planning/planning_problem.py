"""A planning problem in numbers: the coefficients to estimate, their prior, and the time available."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.declaration.units import to_si
from shipid.foundation.errors import ParameterSetError, ShipidError, UsageError
from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief
from shipid.generation.system import generate
from shipid.identification.problem.setting import estimated_parameters, time_constant
from shipid.identification.problem.signals import unknown_biases, usual_signals
from shipid.identification.uncertainty.information import CandidateManoeuvre, Experiment
from shipid.parameters.draws import normal_draws
from shipid.parameters.parameter_set import ParameterSet, Value, lacks_speed, missing_values
from shipid.parameters.validity import beyond
from shipid.parts.rudder_delay import gear_of, not_steered, steered_by
from shipid.trials.manoeuvres.noise import parse_noise

#: Shortest manoeuvre, longest, and the steady approach between two, in L/U.
_SHORTEST, _LONGEST, _BETWEEN = 8.0, 150.0, 5.0
#: Longest time that is planned, in L/U.
_MOST = 5000.0
_LENGTHS = 18
_SLOW = 0.75
#: Draws to choose those from under which the standard zig-zags can be simulated, for each that is wanted.
SPARE_DRAWS = 4


class TimeTooShortError(ShipidError):
    """A time that no manoeuvre fits into."""

    exit_code = ExitCode.USAGE


@dataclass(frozen=True, eq=False)
class PlanningProblem:
    """A planning problem in numbers.

    Attributes
    ----------
    experiment : Experiment
        The coefficients to estimate, and the signals.
    ship : ParameterSet
        The ship.
    known : dict of str to float
        Coefficients and constants, SI.
    size : ndarray, shape (estimated,)
        A typical size of each coefficient to estimate.
    draws : tuple of dict
        The values themselves, then draws about them, more than are wanted.
    speeds : tuple of float
        Speeds of the approach in m/s.
    time : float
        The time available, in s.
    between : float or None
        Steady approach between two manoeuvres in s, if it was given.
    sampling : float
        Sampling interval of the sensors in s.
    """

    experiment: Experiment
    ship: ParameterSet
    known: dict[str, float]
    size: np.ndarray
    draws: tuple[dict[str, float], ...]
    speeds: tuple[float, ...]
    time: float
    between: float | None
    sampling: float

    def gap(self, speed: float) -> float:
        """Return the steady approach between two manoeuvres in s.

        Parameters
        ----------
        speed : float
            In m/s.
        """
        return _BETWEEN * self.experiment.length / speed if self.between is None else self.between

    def shortest(self, speed: float) -> float:
        """Return the shortest manoeuvre in s: eight L/U, and no shorter than a time constant, which identification requires.

        Parameters
        ----------
        speed : float
            In m/s.
        """
        return max(_SHORTEST * self.experiment.length / speed, time_constant(self.experiment.model, self.known))

    def longest(self, speed: float) -> float:
        """Return the longest manoeuvre in s.

        Parameters
        ----------
        speed : float
            In m/s.
        """
        return max(min(self.time, _LONGEST * self.experiment.length / speed), self.shortest(speed))

    def lengths(self, speed: float) -> list[float]:
        """Return lengths to choose from in s, equal shares of the time among them.

        Parameters
        ----------
        speed : float
            In m/s.
        """
        low, high = self.shortest(speed), self.longest(speed)
        shares = [(self.time - k * self.gap(speed)) / (k + 1) for k in range(6)]
        raw = [*np.linspace(low, high, _LENGTHS), *(s for s in shares if low <= s <= high)]
        return sorted({self.rounded(float(d), speed) for d in raw})

    def rounded(self, duration: float, speed: float) -> float:
        """Return a length rounded down to round seconds, so that it still fits the time.

        Parameters
        ----------
        duration : float
            In s.
        speed : float
            In m/s.
        """
        step = 1.0 if self.shortest(speed) > 20 else 0.1
        return round(float(np.floor(duration / step + 1e-9)) * step, 6) or duration

    def beyond(self, sailed: Sequence[CandidateManoeuvre]) -> list[Notice]:
        """Return what has to be said where manoeuvres go beyond the range that the ship's coefficients come from.

        Parameters
        ----------
        sailed : sequence of CandidateManoeuvre
            The manoeuvres.
        """
        hardest = max((s.rudder or self.experiment.limit for s in sailed), default=None)
        return beyond(self.experiment.model, self.ship, [s.speed for s in sailed], hardest)


def _si(value: str | float, unit: str, what: str) -> float:
    number = to_si(value, unit, what) if isinstance(value, str) else float(value)
    if not 0 < number < np.inf:
        raise UsageError(f"{what} is {value}: it has to be greater than zero.")
    return number


def planning_problem(
    model: Model,
    ship: ParameterSet,
    time: str | float,
    *,
    speed: str | float | Sequence[str | float] | None,
    estimate: Sequence[str] | None,
    noise: str | Mapping[str, str | float],
    values: dict[str, str | float],
    sampling: str | float | None,
    correlation: str | float | None,
    between: str | float | None,
    spread: float,
    draws: int,
    seed: int,
) -> PlanningProblem:
    """Check the request, and return it in numbers.

    Parameters
    ----------
    model, ship, time, speed, estimate, noise, values, sampling, correlation, between, spread, draws, seed
        See `shipid.planning.plan_trials.plan_trials`.

    Returns
    -------
    PlanningProblem

    Raises
    ------
    UsageError
        For names and values that do not fit, and a model that reads no rudder angle.
    ParameterSetError
        If the ship lacks its length, its speed or a coefficient.
    TimeTooShortError
        If the time is too short for any manoeuvre.
    """
    if steered_by(model) is None:
        raise UsageError(not_steered(model))
    if not 0 < spread < np.inf or draws < 0:
        raise UsageError(f"a spread of {spread:g} with {draws} draws is no prior: give a spread greater than zero.")
    seconds = _si(time, "s", "the time")
    length = ship.particular("L", "m")
    if length is None or length <= 0:
        raise ParameterSetError(f"ship {ship.name} has no length L greater than zero, which sets the times of a plan.")
    own = [_si(s, "m/s", "the speed") for s in _listed(speed)]
    first = own[0] if own else ship.particular("speed", "m/s")
    if first is None:
        raise lacks_speed(ship, "--speed '9 kn'")
    if seconds > _MOST * length / first:
        raise UsageError(
            f"{time} is more than {_MOST:.0f} times the {brief(length / first, 3)} s in which ship {ship.name} sails her length: "
            "plan a part of it."
        )
    held = {n: to_si(v, model[n].given_unit, f"'{n}' ({model[n].quantity.meaning})") for n, v in values.items()}
    for n in held:
        if model[n].quantity.kind not in ("parameter", "constant", "derived"):
            raise UsageError(f"'{n}' is no coefficient of model {model.name}, and takes no value.")
    ship = _with_values(model, ship, held)
    steered = join(model.name, model, *gear_of(model))
    known = ship.values(steered, speed=first)
    lacking = missing_values(steered, known, f"ship {ship.name}")
    if lacking:
        raise lacking

    every = _holds_at_every_speed(model, ship)
    if len(own) > 1 and not every:
        raise UsageError(
            f"the coefficients of model {model.name} with ship {ship.name} belong to one speed, and {len(own)} are given: "
            "plan for one, or with a model that is scaled with the speed."
        )
    speeds = tuple(own) if own else (first, _SLOW * first) if every else (first,)
    estimated = estimated_parameters(model, estimate)
    signals, sigma = _signals(model, noise)
    interval = _own_sampling(length / first) if sampling is None else _si(sampling, "s", "the sampling interval")
    apart = interval if correlation is None else max(interval, _si(correlation, "s", "the correlation time"))
    limit = known.get("delta_max", ship.particular("delta_max", "rad") or np.deg2rad(35))
    initial, biases = generate(model).states_behind(signals), unknown_biases(model, signals)
    experiment = Experiment(model, length, estimated, initial, biases, signals, sigma, 1 / apart, limit)
    scale = Scale(length, first)
    size = np.array([_size(model, n, known[n], scale) for n in estimated])
    gap = None if between is None else _si(between, "s", "the time between two manoeuvres")
    std = np.array([_prior_std(model, ship, n, s, scale, spread) for n, s in zip(estimated, size)])
    drawn = _draws(model, estimated, known, std, scale, draws, seed)
    problem = PlanningProblem(experiment, ship, known, size, drawn, speeds, seconds, gap, interval)
    fitting = tuple(s for s in speeds if problem.shortest(s) <= seconds)
    if not fitting:
        least = min(problem.shortest(s) for s in speeds)
        raise TimeTooShortError(
            f"{brief(seconds, 4)} s is too short for any manoeuvre: the shortest for ship {ship.name} takes {np.ceil(least):.0f} s "
            f"at {brief(max(speeds), 4)} m/s."
        )
    return replace(problem, speeds=fitting)


def _with_values(model: Model, ship: ParameterSet, held: Mapping[str, float]) -> ParameterSet:
    """Return the ship with some values replaced; a published coefficient takes the place of the one it defines."""
    if not held:
        return ship
    # Two published coefficients may define the same two others.
    taken: list[str] = []
    for n in held:
        partner = model.partner(n, taken) if model[n].quantity.kind == "derived" else None
        taken += [partner] if partner is not None else []
    kept = {s: {n: v for n, v in values.items() if n not in taken} for s, values in ship.sections.items()}
    given = {n: Value(n, v, model[n].unit, "given for the plan") for n, v in held.items()}
    return replace(ship, sections={**kept, model.name: {**kept.get(model.name, {}), **given}})


def _listed(speed: str | float | Sequence[str | float] | None) -> list[str | float]:
    if speed is None:
        return []
    if isinstance(speed, str):
        return [s.strip() for s in speed.split(",")]
    return [speed] if isinstance(speed, (int, float)) else list(speed)


def _holds_at_every_speed(model: Model, ship: ParameterSet) -> bool:
    """Whether the model is scaled with the speed: it reads one, and no coefficient belongs to a speed."""
    entries = [model[n] for n in model.parameters]
    found = [ship.find(model, n) for n in model.entries]
    tables = any(v is not None and v.speed for v in found)
    return bool({"cruise", "u"} & set(model.inputs)) and not tables and not any(e.quantity.prime for e in entries)


def _signals(model: Model, noise: str | Mapping[str, str | float]) -> tuple[tuple[str, ...], np.ndarray]:
    """The signals that are measured and predicted, chosen as in identification, and their noise."""
    levels = {n: d for n, d in parse_noise(noise).items() if d > 0}
    found = usual_signals(model, levels)
    if not found:
        raise UsageError(
            f"no signal that model {model.name} predicts has noise, and without noise every trial determines all coefficients exactly. "
            "Give the noise of the sensors, as in --noise 'psi=0.2 deg,r=0.02 deg/s'."
        )
    return found, np.array([levels[n] for n in found])


def _own_sampling(unit_time: float) -> float:
    """A round interval near L/U/30, as simulated trials have."""
    steps = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
    return max((i for i in steps if i <= unit_time / 20), default=steps[0])


def _size(model: Model, name: str, value: float, scale: Scale) -> float:
    """A typical size of a coefficient: its value, or its declared start where the value is zero."""
    return abs(value) or abs(scale.start_of(model[name]) or 0.0) or scale.factor_of(model[name])


def _prior_std(model: Model, ship: ParameterSet, name: str, size: float, scale: Scale, spread: float) -> float:
    """Standard deviation of a coefficient before the trials: the ship's, the declaration's, or a share of its size."""
    entry, held = model[name], ship.find(model, name)
    if held is not None and held.std and not held.speed:
        return to_si((held.std, held.unit), entry.unit, f"the standard deviation of '{name}'")
    declared = entry.number("spread")
    return spread * size if declared is None else declared * scale.factor_of(entry)


def _draws(
    model: Model,
    estimated: tuple[str, ...],
    known: Mapping[str, float],
    std: np.ndarray,
    scale: Scale,
    count: int,
    seed: int,
) -> tuple[dict[str, float], ...]:
    """The values themselves, then draws of them by Latin hypercube: normal, log-normal where positive, within bounds."""
    if not count:
        return (dict(known),)
    columns = {}
    for name, deviation, z in zip(estimated, std, normal_draws(len(estimated), SPARE_DRAWS * count, seed).T):
        (low, high), value = scale.bounds_of(model[name]), known[name]
        drawn = value * np.exp(deviation / value * z) if low > 0 and value > 0 else value + deviation * z
        # A declared bound is widened to hold the value of the ship's own set.
        columns[name] = np.clip(drawn, min(low, value), max(high, value))
    each = ({n: float(c[i]) for n, c in columns.items()} for i in range(SPARE_DRAWS * count))
    return (dict(known), *({**known, **values} for values in each))
