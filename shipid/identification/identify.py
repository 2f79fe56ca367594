"""The verb: trials and a model in, an identified ship out."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import metadata
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

import shipid
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.generation.system import generate
from shipid.identification.fit import Fit
from shipid.identification.methods import LOSSES, METHODS, PURPOSES
from shipid.identification.problem.output_error import make_problem
from shipid.identification.problem.prior import INDEPENDENT, prior_of, scales_of
from shipid.identification.problem.setting import Setting, check_length, search_box, settle
from shipid.identification.problem.trial_data import Sailed, check_answer, fitted_signals, prepare, unknown_biases
from shipid.identification.problem.weights import enough_of, seen_on_every_sample, weigh_again
from shipid.identification.search.ladder import Climb, Rung, climb
from shipid.identification.search.least_squares import Box, Progress, Solution
from shipid.identification.uncertainty.covariance import correlation_of, covariance_of
from shipid.identification.uncertainty.estimates import estimates_of
from shipid.identification.validation.predictions import compare, predictions, warm_up_samples
from shipid.parameters.correlation import Joint
from shipid.parameters.parameter_set import PARTICULARS, ParameterSet, Value
from shipid.trials.fitness import check_identifiable_input, check_regular
from shipid.trials.trial import Trial

#: First weights, before the residuals say better; only their ratio matters.
_FIRST_SIGMA = {"psi": np.deg2rad(1.0), "r": 0.02, "u": 0.05, "v": 0.05, "x": 10.0, "y": 10.0}


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
    method: str | None = None,
    loss: str = "linear",
    check: bool = True,
    rudder_bias: bool = True,
    starts: int = 5,
    seed: int = 0,
    progress: Progress | None = None,
) -> Fit:
    """Identify a model from trials, by output error unless told otherwise.

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
    purpose : {"prediction", "filter"}, optional
        For prediction, rudder biases are pooled: the trials share one, about which each may be off by a tenth of a degree,
        and initial states stay near what was measured. By default both are free in each trial. For a filter, coefficients and
        noise levels come from the likelihood through the Kalman filter (method prediction-error).
    method : {"output-error", "equation-error", "instrumental-variables", "multiple-shooting", "prediction-error"}, optional
        By default the ladder of them: output error from several starts, one of them by equation error where the states
        are measured, and multiple shooting where it fails. A method that is named is the only one tried.
    loss : {"linear", "huber", "soft-l1"}
        How residuals count: by their squares, or the largest less, so that wild samples decide nothing.
    check : bool
        Whether the trials' doctor is asked (`Fit.findings`); it repairs nothing.
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
    for what, name, known in (("purpose", purpose, PURPOSES), ("method", method, METHODS), ("loss", loss, LOSSES)):
        if name is not None and name not in known:
            raise UnknownNameError(what, name, known)
    if purpose == "filter" and method is None:
        method = PURPOSES[purpose]
    if loss != "linear" and method in ("equation-error", "instrumental-variables", "prediction-error"):
        raise UsageError(f"the loss '{loss}' is one of output error; method {method} knows squares only.")
    if not trials:
        raise UsageError("identify needs at least one trial.")
    trials, validate = _named_apart(trials, validate)
    setting = settle(model, trials, ship, estimate, dict(fixed or {}))
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
    check_length(setting, trials)
    sigma, weigh = _weights(shown, noise, setting.unit_time)
    levels = "noise levels estimated" if weigh else "noise levels given"
    if purpose == "prediction" and noise is None:
        sigma, weigh = scales_of(shown, sailed[0], setting.unit_time), False
        levels = "weighted by the errors of a low-order model"
    box = search_box(setting)
    fixed_values = {n: v for n, v in setting.known.items() if n not in setting.estimated}
    biases = unknown_biases(setting.model, shown, rudder_bias)
    problem = make_problem(setting.model, sailed, shown, setting.estimated, fixed_values, sigma, biases)
    if purpose == "prediction":
        believed = prior_of(setting.model, problem.initial, biases, sailed[0], setting.unit_time, setting.estimated)
        problem = replace(problem, prior=believed)
    problem = replace(problem, loss=loss)
    how = Climb(starts, seed, weigh, setting.unit_time, progress or (lambda _: None))
    # The matrices are tall and thin: several threads on each cost more than they bring.
    with threadpool_limits(1, "blas"):
        pooled = purpose == "prediction" and noise is None
        searched = enough_of(problem, setting.unit_time) if pooled else problem
        solution, rungs = climb(searched, box, method, how)
        if pooled:
            # Coefficients of a method that minimises no residuals are not to be moved by new weights.
            if solution.covariance is None:
                solution = weigh_again(solution, box, sigma, INDEPENDENT * setting.unit_time)
            solution = seen_on_every_sample(solution, problem)
        fit = _result(setting, solution, rungs, box, sailed, levels, check)
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
    levels = [to_si(noise[s], FIELDS[s].unit, f"noise on {s}") for s in signals]
    if min(levels) <= 0:
        raise UsageError("a noise level of zero or less has no weight; give a positive standard deviation.")
    return np.array(levels), False


def _result(
    setting: Setting,
    solution: Solution,
    rungs: tuple[Rung, ...],
    box: Box,
    sailed: Sequence[Sailed],
    levels: str,
    check: bool,
) -> Fit:
    problem = solution.problem
    covariance = covariance_of(solution)
    shared = len(problem.estimated)
    block = covariance.matrix[:shared, :shared]
    parameters = estimates_of(
        setting.model, problem.estimated, problem.fixed, solution.q[:shared], block, box, setting.length, setting.speed
    )
    fitted = tuple(compare(problem, solution.q, i) for i in range(len(sailed)))
    dof = max(1, solution.residual.size - problem.size)
    used = next(r for r in rungs if r.used)
    condition = covariance.condition_number if np.isfinite(covariance.condition_number) else None
    return Fit(
        model=setting.model,
        ship=_identified_ship(
            setting, parameters, problem.fixed, [s.trial for s in sailed], used.method, correlation_of(block)
        ),
        method=_in_words(used, solution, levels),
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
        ladder=rungs,
        loss=problem.loss,
        checked=check,
        provenance=_provenance(setting.model, [s.trial for s in sailed]),
        _problem=problem,
        _solution=solution,
        _predict=predictions,
    )


def _in_words(rung: Rung, solution: Solution, levels: str) -> str:
    """How the coefficients were found."""
    problem = solution.problem
    signals = ", ".join(problem.signals)
    words = [METHODS[rung.method] if solution.covariance is not None else f"{METHODS[rung.method]} on {signals}"]
    if solution.covariance is None:
        words += ["exact sensitivities", levels]
        if problem.prior is not None:
            # A least-squares search with beliefs among its residuals ends at the maximum of the posterior density.
            words += ["rudder biases pooled", "maximum a posteriori"]
    else:
        words += [f"initial states and biases by output error on {signals}"]
    return ", ".join([*words, *([f"{problem.loss} loss"] if problem.loss != "linear" else [])])


def _identified_ship(
    setting: Setting,
    parameters: Mapping[str, Any],
    fixed: Mapping[str, float],
    trials: Sequence[Trial],
    method: str,
    correlation: np.ndarray,
) -> ParameterSet:
    where = f"identified by {method.replace('-', ' ')} from {', '.join(t.name for t in trials)} (shipid {shipid.__version__})"
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
    speeds = [float(np.median(t[n])) for t in trials for n in ("u", "U") if t.has(n)]
    # As written: a set that is read again says the same. Rounding leaves a badly conditioned matrix a little askew.
    even = np.clip(0.5 * (correlation + correlation.T), -1.0, 1.0)
    np.fill_diagonal(even, 1.0)
    matrix = tuple(tuple(float(f"{v:.6g}") for v in row) for row in even)
    joint = Joint(setting.estimated, matrix, (min(speeds), max(speeds)) if speeds else None)
    return replace(setting.ship, sections=sections, joint={**setting.ship.joint, setting.model.name: joint})


def _provenance(model: Model, trials: Sequence[Trial]) -> dict[str, Any]:
    versions = {name: metadata.version(name) for name in ("casadi", "numpy", "scipy")}
    return {
        "versions": {"shipid": shipid.__version__, "python": sys.version.split()[0], **versions},
        "model_sha256": generate(model).digest,
        "trials": {t.name: {**t.source.to_dict(), "samples": len(t)} for t in trials},
    }
