"""The verb: trials and a model in, an identified ship out."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import metadata
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

import shipid
from shipid.declaration.catalogue import find_model, find_ship, whole_ship
from shipid.declaration.errors import ParameterSetError, UnknownNameError, UsageError
from shipid.declaration.model import Model
from shipid.declaration.parameters import PARTICULARS, ParameterSet, Value, missing_values
from shipid.declaration.units import prime_factor, to_si
from shipid.generation.system import generate
from shipid.identification.beliefs import INDEPENDENT, prior_of, scales_of
from shipid.identification.errors import TrialTooShortError
from shipid.identification.estimates import estimates_of
from shipid.identification.fit import Fit
from shipid.identification.problem import make_problem
from shipid.identification.sailed import Sailed, check_answer, fitted_signals, prepare, unknown_biases
from shipid.identification.scale import own_unit_time, speed_of
from shipid.identification.solve import Box, Progress, Solution, box_of, solve
from shipid.identification.uncertainty import correlation_of, covariance_of
from shipid.identification.validation import compare, predictions, warm_up_samples
from shipid.identification.weighing import enough_of, seen_on_every_sample, weigh_again
from shipid.trials.columns import COLUMNS
from shipid.trials.fitness import check_identifiable_input, check_regular
from shipid.trials.trial import Trial

#: First weights, before the residuals say better; only their ratio matters.
_FIRST_SIGMA = {"psi": np.deg2rad(1.0), "r": 0.02, "u": 0.05, "v": 0.05, "x": 10.0, "y": 10.0}


@dataclass(frozen=True)
class _Setting:
    """What is known before the search."""

    model: Model
    ship: ParameterSet
    known: dict[str, float]
    estimated: tuple[str, ...]
    length: float
    speed: float
    notes: tuple[str, ...]

    @property
    def unit_time(self) -> float:
        return self.length / self.speed


def identify(
    model: Model | str | Any,
    trials: Sequence[Trial],
    *,
    ship: ParameterSet | str | None = None,
    estimate: Sequence[str] | None = None,
    fixed: Mapping[str, str | float] | None = None,
    signals: Sequence[str] | None = None,
    noise: Mapping[str, str | float] | None = None,
    validate: Sequence[Trial] = (),
    purpose: str | None = None,
    rudder_bias: bool = True,
    starts: int = 5,
    seed: int = 0,
    progress: Progress | None = None,
) -> Fit:
    """Identify a model from trials by output error.

    Parameters
    ----------
    model : Model, component class or str
        What to fit; a component is joined with planar motion, a name is looked up.
    trials : sequence of Trial
        Fitted jointly: the parameters are shared, and each trial has its own initial state and rudder bias.
    ship : ParameterSet or str, optional
        Particulars (and known coefficients, where the search starts).
    estimate : sequence of str, optional
        Coefficients to estimate, published names included; by default all that the model declares as estimated.
    fixed : mapping of str to str, optional
        Coefficients to hold, with units: ``{"n3": "0.4 s^2/deg^2"}``.
    signals : sequence of str, optional
        Signals to fit; by default heading, rate of turn, forward and sway speed, as far as they are measured and
        predicted.
    noise : mapping of str to str, optional
        Standard deviation of each signal, with units; estimated from the residuals when not given.
    validate : sequence of Trial, optional
        Trials to predict.
    purpose : {"prediction"}, optional
        For prediction, rudder biases are pooled: the trials share one, about which each may be off by a tenth of a degree,
        and initial states stay near what was measured. By default both are free in each trial.
    rudder_bias : bool
        Whether each trial has a rudder bias of its own.
    starts : int
        Number of starting points.
    seed : int
        Of the random ones.
    progress : callable, optional
        Called with a line of text after each stage.

    Returns
    -------
    Fit

    Raises
    ------
    ShipidError
        For trials, names and values that do not fit; a search that fails is a result, with ``converged`` False.
    """
    if purpose not in (None, "prediction"):
        raise UnknownNameError("purpose", purpose, ("prediction",))
    if not trials:
        raise UsageError("identify needs at least one trial.")
    trials, validate = _named_apart(trials, validate)
    setting = _settle(model, trials, ship, estimate, dict(fixed or {}))
    for trial in (*trials, *validate):
        check_regular(trial)
    shown = fitted_signals(setting.model, [*trials, *validate], signals)
    for trial in trials:
        check_identifiable_input(trial)
        check_answer(trial, shown)
    own_speed = setting.ship.particular("speed", "m/s")
    # The trials to predict as well: what they lack is found before the search, not after it.
    everything = [
        prepare(setting.model, t, shown, own_speed, warm_up_samples(t, setting.unit_time)) for t in (*trials, *validate)
    ]
    sailed = everything[: len(trials)]
    _check_length(setting, trials)
    sigma, weigh = _weights(shown, noise, setting.unit_time)
    if purpose == "prediction" and noise is None:
        sigma, weigh = scales_of(shown, sailed[0], setting.unit_time), False
    box = _box(setting)
    fixed_values = {n: v for n, v in setting.known.items() if n not in setting.estimated}
    biases = unknown_biases(setting.model, shown, rudder_bias)
    problem = make_problem(setting.model, sailed, shown, setting.estimated, fixed_values, sigma, biases)
    if purpose == "prediction":
        problem = replace(
            problem,
            prior=prior_of(setting.model, problem.initial, biases, sailed[0], setting.unit_time, setting.estimated),
        )
    # The matrices are tall and thin: several threads on each cost more than they bring.
    with threadpool_limits(1, "blas"):
        pooled = purpose == "prediction" and noise is None
        searched = enough_of(problem, setting.unit_time) if pooled else problem
        solution = solve(
            searched, box, starts=starts, seed=seed, weigh=weigh, unit_time=setting.unit_time, progress=progress
        )
        if pooled:
            solution = weigh_again(solution, box, sigma, INDEPENDENT * setting.unit_time)
            solution = seen_on_every_sample(solution, problem)
        fit = _result(setting, solution, box, sailed, weigh)
        return fit.validate(validate) if validate else fit


def _named_apart(*groups: Sequence[Trial]) -> list[list[Trial]]:
    """Give trials of the same name a number, so that each has a place of its own in the result."""
    seen: dict[str, int] = {}
    result: list[list[Trial]] = []
    for group in groups:
        result.append([])
        for trial in group:
            seen[trial.name] = seen.get(trial.name, 0) + 1
            again = seen[trial.name]
            result[-1].append(trial if again == 1 else replace(trial, name=f"{trial.name}-{again}"))
    return result


def _settle(
    model: Model | str | Any,
    trials: Sequence[Trial],
    ship: ParameterSet | str | None,
    estimate: Sequence[str] | None,
    fixed: dict[str, str | float],
) -> _Setting:
    whole = find_model(model) if isinstance(model, str) else model if isinstance(model, Model) else whole_ship(model)
    given = find_ship(ship) if isinstance(ship, str) else ship or ParameterSet("unnamed")
    held = {n: to_si(v, whole[n].unit, f"'{n}' ({whole[n].quantity.meaning})") for n, v in fixed.items()}
    for name in held:
        if whole[name].quantity.kind not in ("parameter", "constant", "derived"):
            kind = "input" if whole[name].quantity.kind == "given" else whole[name].quantity.kind
            raise UsageError(f"'{name}' is no coefficient of model {whole.name} but its {kind}; it cannot be fixed.")
    published = [n for n in held if whole[n].quantity.kind == "derived"]
    whole = whole.impose(published) if published else whole

    speed = speed_of(given, trials)
    known = given.values(whole, speed=speed) | held
    length = known.get("L", given.particular("L", "m"))
    if length is not None and not length > 0:
        raise ParameterSetError(f"the length L of ship {given.name} is {length:g} m; a ship is longer than that.")
    if length is None:
        length = speed * own_unit_time(trials)
    estimated = _estimated(whole, estimate, held)
    notes = []
    for name in whole.parameters:
        start = whole[name].number("start")
        if name not in known and start is not None and name not in estimated:
            known[name] = start * (prime_factor(whole[name].unit, length, speed) if whole[name].quantity.prime else 1.0)
            notes.append(f"{name} was held at its declared start, {known[name]:.4g}, which is assumed.")
    lacking = missing_values(whole, {**known, **dict.fromkeys(estimated, 0.0)}, f"ship {given.name}")
    if lacking:
        raise lacking
    return _Setting(whole, given, known, estimated, length, speed, tuple(notes))


def _estimated(model: Model, wanted: Sequence[str] | None, held: Mapping[str, float]) -> tuple[str, ...]:
    if wanted is None:
        chosen = [n for n in model.parameters if model[n].quantity.estimated and n not in held]
    else:
        chosen = []
        for name in wanted:
            partner = name if name in model.parameters else model.partner(name) if name in model else None
            if partner is None:
                raise UnknownNameError(f"parameter of model {model.name} to estimate called", name, model.parameters)
            if partner in held:
                raise UsageError(f"'{name}' is to be estimated and is fixed as well; choose one.")
            chosen.append(partner)
    if not chosen:
        raise UsageError(f"nothing is left to estimate in model {model.name}: every parameter is fixed.")
    return tuple(n for n in model.parameters if n in chosen)


def _weights(
    signals: tuple[str, ...], noise: Mapping[str, str | float] | None, unit_time: float
) -> tuple[np.ndarray, bool]:
    if noise is None:
        first = [_FIRST_SIGMA.get(s, 1.0) / (unit_time if s == "r" else 1.0) for s in signals]
        return np.array(first), True
    lacking = [s for s in signals if s not in noise]
    if lacking:
        raise UsageError(
            f"noise levels are given, and none for {', '.join(lacking)}. Give one for every fitted signal."
        )
    levels = [to_si(noise[s], COLUMNS[s].unit, f"noise on {s}") for s in signals]
    if min(levels) <= 0:
        raise UsageError("a noise level of zero or less has no weight; give a positive standard deviation.")
    return np.array(levels), False


def _box(setting: _Setting) -> Box:
    bounds = {}
    for name in setting.estimated:
        entry = setting.model[name]
        scale = prime_factor(entry.unit, setting.length, setting.speed) if entry.quantity.prime else 1.0
        low, high = (entry.number(a) for a in ("low", "high"))
        declared = entry.number("start")
        low = -np.inf if low is None else low * scale
        high = np.inf if high is None else high * scale
        start = setting.known.get(name, scale if declared is None else declared * scale)
        # A value from the ship's own set is believed over a declared bound.
        bounds[name] = (start, min(low, start), max(high, start))
    return box_of(bounds)


def _check_length(setting: _Setting, trials: Sequence[Trial]) -> None:
    constants = [n for n in ("tau", "tau1") if n in setting.model.parameters and setting.model[n].unit == "s"]
    slowest = max((abs(setting.known[n]) for n in constants if n in setting.known), default=0.0)
    needed = max(setting.unit_time, slowest)
    why = (
        "the ship's time constant" if slowest > setting.unit_time else "the time L/U in which the ship sails its length"
    )
    for trial in trials:
        if trial.duration < needed:
            raise TrialTooShortError(
                f"trial {trial.name} lasts {trial.duration:.3g} s, and {why} is {needed:.3g} s: it ends before the ship has "
                "answered its rudder. Give a longer trial, or a wider window."
            )


def _result(setting: _Setting, solution: Solution, box: Box, sailed: Sequence[Sailed], weigh: bool) -> Fit:
    problem = solution.problem
    covariance = covariance_of(solution)
    shared = len(problem.estimated)
    block = covariance.matrix[:shared, :shared]
    parameters = estimates_of(
        setting.model, problem.estimated, problem.fixed, solution.q[:shared], block, box, setting.length, setting.speed
    )
    fitted = tuple(compare(problem, solution.q, i) for i in range(len(sailed)))
    dof = max(1, solution.residual.size - problem.size)
    levels = "noise levels estimated" if weigh else "noise levels given"
    pooled = ", rudder biases pooled" if problem.prior is not None else ""
    condition = covariance.condition_number if np.isfinite(covariance.condition_number) else None
    return Fit(
        model=setting.model,
        ship=_identified_ship(setting, parameters, problem.fixed, [s.trial for s in sailed]),
        method=f"output error on {', '.join(problem.signals)}, exact sensitivities, {levels}{pooled}",
        converged=solution.converged,
        message=" ".join((solution.message, *setting.notes)),
        parameters=parameters,
        fixed=dict(problem.fixed),
        covariance=block,
        correlation=correlation_of(block),
        condition_number=condition,
        noise=dict(zip(problem.signals, problem.sigma.tolist())),
        fitted=fitted,
        validation=(),
        chi_square=2 * solution.cost / dof,
        evaluations=solution.evaluations,
        provenance=_provenance(setting.model, [s.trial for s in sailed]),
        _problem=problem,
        _solution=solution,
        _predict=predictions,
    )


def _identified_ship(
    setting: _Setting, parameters: Mapping[str, Any], fixed: Mapping[str, float], trials: Sequence[Trial]
) -> ParameterSet:
    where = f"identified by output error from {', '.join(t.name for t in trials)} (shipid {shipid.__version__})"
    section = {}
    for name, e in parameters.items():
        if not e.follows and e.value is not None:
            note = "" if e.identifiable else f"not determined by these trials: {e.why}"
            section[name] = Value(name, e.value, e.unit, where, std=e.std, note=note)
    particulars = dict(setting.ship.sections.get(PARTICULARS, {}))
    for name, value in fixed.items():
        if setting.ship.particular(name, setting.model[name].unit) == value:
            continue
        held = setting.ship.find(setting.model, name)
        source = held.source if held is not None else "held during the identification"
        target = particulars if name == "L" else section
        target[name] = Value(name, value, setting.model[name].unit, source)
    sections = {**setting.ship.sections, PARTICULARS: particulars, setting.model.name: section}
    return replace(setting.ship, sections=sections)


def _provenance(model: Model, trials: Sequence[Trial]) -> dict[str, Any]:
    versions = {name: metadata.version(name) for name in ("casadi", "numpy", "scipy")}
    return {
        "versions": {"shipid": shipid.__version__, "python": sys.version.split()[0], **versions},
        "model_sha256": generate(model).digest,
        "trials": {t.name: {**t.source.to_dict(), "samples": len(t)} for t in trials},
    }
