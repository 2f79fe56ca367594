"""Identification: from trials and a model to an identified ship."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import metadata

import numpy as np
from threadpoolctl import threadpool_limits

import shipid
from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.foundation.statistics import plain
from shipid.generation.system import generate
from shipid.identification.fit import Fit
from shipid.identification.fit_text import method_words
from shipid.identification.identified import Identified
from shipid.identification.methods import LOSSES, METHODS, PURPOSES, Loss, Method, Purpose
from shipid.identification.problem.box import Box
from shipid.identification.problem.first_weights import first_weights, given_weights
from shipid.identification.problem.output_error import make_problem
from shipid.identification.problem.prior import INDEPENDENT, prior_of, structural_errors
from shipid.identification.problem.setting import Setting, check_length, search_box, settle
from shipid.identification.problem.signals import check_answer, fitted_signals, unknown_biases
from shipid.identification.problem.trial_data import prepare, with_whole_inputs
from shipid.identification.search.ladder import SearchSettings, climb
from shipid.identification.search.least_squares import Progress
from shipid.identification.search.prediction_weights import independent_samples, on_every_sample, weigh_again
from shipid.identification.search.rung import Rung
from shipid.identification.search.solution import Solution
from shipid.identification.uncertainty.covariance import correlation_of, covariance_of
from shipid.identification.uncertainty.estimates import estimates_of, unseen_words
from shipid.identification.uncertainty.identified_ship import identified_ship
from shipid.identification.validation.predictions import fitted_comparisons
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.doctor.autopilot_steers import autopilot_steers
from shipid.trials.fitness import check_identifiable_input
from shipid.trials.trial import Trial


def identify(
    model: Model | type[Component] | str,
    trials: Sequence[Trial],
    *,
    ship: ParameterSet | str | None = None,
    estimate: Sequence[str] | None = None,
    fixed: Mapping[str, str | float] | None = None,
    signals: Sequence[str] | None = None,
    noise: Mapping[str, str | float] | None = None,
    validate: Sequence[Trial] = (),
    purpose: Purpose | None = None,
    method: Method | None = None,
    loss: Loss = "linear",
    rudder_bias: bool = True,
    starts: int = 5,
    seed: int = 0,
    progress: Progress | None = None,
) -> Fit:
    """Identify a model from trials, by output error unless another method is given.

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
        are measured, and multiple shooting where it fails; prediction error where an autopilot steers a trial against
        disturbances, which biases output error. A method that is named is the only one tried.
    loss : {"linear", "huber", "soft-l1"}
        How residuals count: by their squares, or large ones less, so that outliers have little effect.
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
    UnknownNameError
        For a name that does not exist: model, ship, coefficient, signal, purpose, method or loss.
    UsageError
        If there is no trial, the loss does not go with the method, or the values given do not fit together.
    ShipidError
        For trials that cannot be fitted. A search that fails is a result, with ``converged`` False.
    """
    for what, name, known in (("purpose", purpose, PURPOSES), ("method", method, METHODS), ("loss", loss, LOSSES)):
        if name is not None and name not in known:
            raise UnknownNameError(what, name, known)
    if purpose == "filter" and method is None:
        method = PURPOSES[purpose]
    if loss != "linear" and method in ("equation-error", "instrumental-variables", "prediction-error"):
        raise UsageError(f"the loss '{loss}' is one of output error; method {method} uses squares only.")
    if not trials:
        raise UsageError("identify needs at least one trial.")
    trials, validate = _named_apart(trials, validate)
    free = purpose is None and method is None and noise is None and loss == "linear"
    steered = [t.name for t in trials if autopilot_steers(t) is not None] if free else []
    if steered:
        method = "prediction-error"
    setting = settle(model, trials, ship, estimate, fixed or {})
    shown = fitted_signals(setting.model, [*trials, *validate], signals)
    for trial in trials:
        check_identifiable_input(trial)
        check_answer(trial, shown)
    check_length(setting, trials)
    own_speed, unit_time = setting.ship.particular("speed", "m/s"), setting.scale.unit_time
    # Holes in what drives the model split a trial; each stretch is a trial of its own from here on.
    pairs, predicted = (
        [(s, t) for t in group for s in with_whole_inputs(setting.model, t, shown, unit_time)]
        for group in (trials, validate)
    )
    trials = [stretch for stretch, _ in pairs]
    # The trials to predict are checked as well, so that missing columns are found before the search.
    everything = [prepare(setting.model, s, shown, own_speed, unit_time, t) for s, t in (*pairs, *predicted)]
    data = everything[: len(trials)]
    # For prediction, residuals are weighted by what a low-order model can reach, and the trials share their biases.
    structural = purpose == "prediction" and noise is None
    if noise is not None:
        sigma, weights = given_weights(shown, noise), "noise levels given"
    elif structural:
        sigma, weights = structural_errors(shown, data[0], unit_time), "weighted by the errors of a low-order model"
    else:
        sigma, weights = first_weights(shown, unit_time), "noise levels estimated"
    biases, box = unknown_biases(setting.model, shown, rudder_bias), search_box(setting)
    problem = make_problem(setting.model, data, shown, setting.estimated, setting.fixed, sigma, biases)
    problem = replace(problem, loss=loss)
    if purpose == "prediction":
        prior = prior_of(setting.model, problem.initial, biases, data[0], unit_time, setting.estimated)
        problem = replace(problem, prior=prior)
    how = SearchSettings(starts, seed, noise is None and not structural, unit_time, progress or (lambda _: None))
    # The matrices are tall and thin: several threads on each cost more than they bring.
    with threadpool_limits(1, "blas"):
        solution, rungs = climb(independent_samples(problem, unit_time) if structural else problem, box, method, how)
        if structural:
            # Coefficients of a method that minimises no residuals are not to be moved by new weights.
            if solution.covariance is None:
                solution = weigh_again(solution, box, sigma, INDEPENDENT * unit_time)
            solution = on_every_sample(solution, problem)
        if steered:
            why = f"an autopilot steers {', '.join(steered)} against disturbances, which biases output error."
            rungs = tuple(
                replace(r, reason=f"{why} {r.reason[0].upper()}{r.reason[1:]}") if r.used else r for r in rungs
            )
        fit = _result(setting, solution, rungs, box, [t for _, t in pairs], weights)
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


def _result(
    setting: Setting, solution: Solution, rungs: tuple[Rung, ...], box: Box, records: Sequence[Trial], weights: str
) -> Fit:
    problem, covariance = solution.problem, covariance_of(solution)
    shared = len(problem.estimated)
    unseen = [n for n, v in zip(problem.estimated, np.diag(covariance.matrix)) if np.isinf(v)]
    # About these the trials say nothing: they keep what is known of them beforehand.
    spreads = {n: std for n in unseen if (std := setting.stated.get(n, (0.0, None))[1]) is not None}
    if spreads:
        covariance = covariance_of(solution, np.array([spreads.get(n, np.inf) for n in problem.estimated]))
    block = covariance.matrix[:shared, :shared]
    correlation = correlation_of(block)
    words = unseen_words({n: float(solution.q[problem.estimated.index(n)]) for n in unseen}, setting.stated)
    degrees = None if solution.levels is None else solution.levels.degrees
    parameters = estimates_of(problem, solution.q, block, box, setting.scale, words, degrees)
    used = next(r for r in rungs if r.used)
    trials = [data.trial for data in problem.trials]
    names = ", ".join(t.name for t in trials)
    source = f"identified by {used.method.replace('-', ' ')} from {names} (shipid {shipid.__version__})"
    ship = identified_ship(setting, parameters, trials, source, correlation, unseen)
    return Fit(
        model=setting.model,
        ship=ship,
        method=method_words(used, solution, weights),
        converged=solution.converged,
        message=" ".join((solution.message, *setting.notes)),
        parameters=parameters,
        fixed=dict(problem.fixed),
        covariance=block,
        correlation=correlation,
        condition_number=plain(covariance.condition_number),
        noise=dict(zip(problem.signals, problem.sigma.tolist())),
        fitted=fitted_comparisons(problem, solution.q, records, ship.particular("L", "m")),
        validation=(),
        chi_square=2 * solution.cost / max(1, solution.residual.size - problem.missing - problem.size),
        evaluations=solution.evaluations,
        provenance=_provenance(setting.model, trials),
        identified=Identified(ship, setting.scale, solution, covariance, parameters, used.method, spreads),
        ladder=rungs,
        loss=problem.loss,
        levels=solution.levels,
    )


def _provenance(model: Model, trials: Sequence[Trial]) -> dict[str, Plain]:
    versions = {name: metadata.version(name) for name in ("casadi", "numpy", "scipy")}
    return {
        "versions": {"shipid": shipid.__version__, "python": sys.version.split()[0], **versions},
        "model_sha256": generate(model).digest,
        "trials": {t.name: {**t.source.to_dict(), "samples": len(t)} for t in trials},
    }
