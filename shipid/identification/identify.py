"""Identification: from trials and a model to an identified ship."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import metadata

import numpy as np
from threadpoolctl import threadpool_limits

import shipid
from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.estimation.estimate import Estimate
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.foundation.statistics import plain
from shipid.generation.system import generate
from shipid.identification.evidence.between_samples import follow_corners
from shipid.identification.evidence.bias_spread import BiasSpread
from shipid.identification.evidence.explained import COURSE_KEPT, UNEXPLAINED, least_unexplained, nothing_explained
from shipid.identification.evidence.load_part import LoadPart, weigh_load_part
from shipid.identification.evidence.marginal_likelihood import Weighing
from shipid.identification.evidence.missing_effect import missing_effect
from shipid.identification.evidence.several_ends import conclude_likeliest, undecided
from shipid.identification.fit import Fit
from shipid.identification.fit_text import method_words
from shipid.identification.identified import Identified
from shipid.identification.loading import with_load_part
from shipid.identification.methods import LOSSES, METHODS, OUTPUT_ERROR, PURPOSES, Loss, Method, Purpose
from shipid.identification.noise.coefficients_apart import coefficients_apart
from shipid.identification.noise.whitened import WHITENED, as_not_whitened, on_white_residuals
from shipid.identification.problem.box import Box
from shipid.identification.problem.dead_time import with_dead_time
from shipid.identification.problem.first_weights import first_weights, given_weights
from shipid.identification.problem.output_error import Problem, make_problem
from shipid.identification.problem.prior import INDEPENDENT, prior_of, structural_errors
from shipid.identification.problem.setting import Setting, check_length, search_box, settle
from shipid.identification.problem.signals import check_answer, fitted_signals, unknown_biases
from shipid.identification.problem.trial_data import prepare, with_whole_inputs
from shipid.identification.search.ladder import SearchSettings, climb
from shipid.identification.search.least_squares import Progress
from shipid.identification.search.prediction_error import levels_at
from shipid.identification.search.prediction_weights import independent_samples
from shipid.identification.search.rung import Rung
from shipid.identification.search.solution import Solution, residual_levels
from shipid.identification.uncertainty.covariance import correlation_of, covariance_of
from shipid.identification.uncertainty.estimates import estimates_of, unseen_words, without_values
from shipid.identification.uncertainty.identified_ship import identified_ship
from shipid.identification.validation.predictions import fitted_comparisons
from shipid.parameters.catalogue import model_of
from shipid.parameters.loading import measure_of
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.doctor.autopilot_steers import autopilot_steers, course_is_kept, rudder_answers
from shipid.trials.fitness import check_identifiable
from shipid.trials.logs.reading import Trials, trials_of
from shipid.trials.trial import Trial


def identify(
    model: Model | type[Component] | str,
    trials: Trials,
    *,
    ship: ParameterSet | str | None = None,
    estimate: Sequence[str] | None = None,
    fixed: Mapping[str, str | float] | None = None,
    signals: Sequence[str] | None = None,
    noise: Mapping[str, str | float] | None = None,
    validate: Trials = (),
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
    trials : Trial, str, Path or sequence of them
        Trials, or their files. Fitted jointly: the parameters are shared, and each trial has its own initial state and rudder bias.
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
    validate : Trial, str, Path or sequence of them, optional
        Trials to predict.
    purpose : {"prediction", "filter"}, optional
        For prediction is the default: rudder biases of the trials are spread about a common mean, by a standard deviation that
        is estimated with the coefficients, and initial states stay near what was measured. For a filter, coefficients and
        noise levels come from the likelihood through the Kalman filter (method prediction-error).
    method : {"output-error", "equation-error", "instrumental-variables", "multiple-shooting", "prediction-error"}, optional
        By default the ladder of them: output error from several starts, one of them by equation error where the states
        are measured, and multiple shooting where it fails; prediction error where an autopilot steers a trial against
        disturbances, which biases output error. A method that is named is the only one tried.
    loss : {"linear", "huber", "soft-l1"}
        How residuals count: by their squares, or large ones less, so that outliers have little effect.
    rudder_bias : bool
        Whether the rudder of each trial has a bias.
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
    trials, validate = _named_apart(trials_of(trials), trials_of(validate))
    if not trials:
        raise UsageError("identify needs at least one trial.")
    if unasked := purpose == "filter" and method is None:
        method = PURPOSES["filter"]
    if loss != "linear" and method in ("equation-error", "instrumental-variables", "prediction-error"):
        raise UsageError(f"the loss '{loss}' is one of output error; method {method} uses squares only.")
    free = purpose is None and method is None and noise is None and loss == "linear"
    steered = [t.name for t in trials if autopilot_steers(t) is not None] if free else []
    method = "prediction-error" if steered else method
    check_identifiable(trials, model_of(model))
    load_part = None
    if free and not steered and not (estimate or fixed):
        model = with_dead_time(model, trials)
        if (loaded := with_load_part(model, trials)) is not None:
            fit = identify(
                loaded,
                trials,
                ship=ship,
                signals=signals,
                rudder_bias=rudder_bias,
                starts=starts,
                seed=seed,
                progress=progress,
            )
            load_part = fit.identified.load_part
            if load_part is not None and load_part.kept:
                return fit.validate(validate) if validate else fit
    setting = settle(model, trials, ship, estimate, fixed or {})
    shown = fitted_signals(setting.model, [*trials, *validate], signals)
    for trial in trials:
        check_answer(trial, shown)
    check_length(setting, trials)
    own_speed, unit_time = setting.ship.particular("speed", "m/s"), setting.scale.unit_time
    # Under an autopilot the rudder answers the noise, and output error is biased.
    answers = (free or unasked) and any(rudder_answers(t, unit_time) for t in trials)
    # Holes in what drives the model split a trial; each stretch is a trial of its own from here on.
    pairs, predicted = (
        [(s, t) for t in group for s in with_whole_inputs(setting.model, t, shown, unit_time)]
        for group in (trials, validate)
    )
    trials = [s for s, _ in pairs]
    # The trials to predict are checked as well, so that missing columns are found before the search.
    everything = [prepare(setting.model, s, shown, own_speed, unit_time, t) for s, t in (*pairs, *predicted)]
    data = everything[: len(trials)]
    problem = make_problem(
        setting.model,
        data,
        shown,
        setting.estimated,
        setting.fixed,
        first_weights(shown, unit_time)
        if noise is None
        else given_weights(shown, noise, {s: setting.model[s].given_unit for s in shown}),
        unknown_biases(setting.model, shown, rudder_bias),
    )
    problem = replace(problem, loss=loss)
    how = SearchSettings(starts, seed, noise is None, unit_time, progress or (lambda _: None))
    # The matrices are tall and thin: several threads on each cost more than they bring.
    with threadpool_limits(1, "blas"):
        records = len({id(t) for _, t in pairs})
        search = _by_residuals if method in OUTPUT_ERROR else _by_another_method
        found = search(problem, search_box(setting), method, how, records)
        if (unasked or steered) and found.solution.levels is not None and found.solution.levels.lasting is not None:
            found = _by_lasting_sensors(problem, search_box(setting), how, records, found, answers, unasked)
        elif unasked and not answers:
            found = _beside_simulation(problem, search_box(setting), how, records, found)
        elif free and answers and not steered and found.solution.converged:
            found = _on_white(found)
        if steered:
            found = replace(found, rungs=_for_autopilots(found.rungs, steered))
        fit = _result(setting, found, [t for _, t in pairs], noise is not None, load_part)
        return fit.validate(validate) if validate else fit


@dataclass(frozen=True, eq=False)
class _Found:
    """The end of a search, how it came about, and what was found of the spread of the biases."""

    solution: Solution
    rungs: tuple[Rung, ...]
    box: Box
    spread: BiasSpread | None = None


def _by_residuals(problem: Problem, box: Box, method: Method | None, how: SearchSettings, records: int) -> _Found:
    """Output error, with rudder biases as random effects and weights by how long residuals last."""
    unit_time, first = how.unit_time, problem.trials[0]
    least = structural_errors(problem.signals, first, unit_time)
    prior = prior_of(problem.model, problem.initial, problem.biases, first, unit_time, problem.estimated)
    if not how.weigh:
        # Where noise levels are given every sample counts by them, and initial states are as free as the samples let them be.
        prior = replace(prior, initial={}, strength=1.0)
    problem = replace(problem, prior=prior, sigma=least if how.weigh else problem.sigma)
    rough = replace(how, weigh=False)
    solution, rungs = climb(independent_samples(problem, unit_time), box, method, rough)
    weighing = Weighing(least, not how.weigh, INDEPENDENT * unit_time, how.tell, records)
    solution, spread, rungs = conclude_likeliest(solution, rungs, problem, box, weighing)
    return _Found(follow_corners(solution, box), rungs, box, spread)


def _by_another_method(problem: Problem, box: Box, method: Method | None, how: SearchSettings, _: int) -> _Found:
    """A method that minimises no residuals of whole records."""
    return _Found(*climb(problem, box, method, how), box)


def _on_white(found: _Found) -> _Found:
    """The same from whitened residuals, where they have a colour; where the search leads nowhere that is said."""
    solution = on_white_residuals(found.solution, found.box)
    if solution is None:
        return replace(found, solution=as_not_whitened(found.solution))
    why = f"The rudder follows the heading, and noise that lasts with it, which biases output error: {WHITENED}."
    rungs = tuple(replace(r, reason=f"{why} {r.reason}") if r.used else r for r in found.rungs)
    return replace(found, solution=solution, rungs=rungs)


def _by_lasting_sensors(
    problem: Problem, box: Box, how: SearchSettings, records: int, before: _Found, answers: bool, filtered: bool
) -> _Found:
    """Output error, for a filter with noise levels at its coefficients, where what the sensors show lasts and moves no ship.

    An autopilot answers it with the rudder, which biases output error, and leaves prediction error, that takes it for a force on the
    ship, without a gain: there the residuals are whitened. Where that leads nowhere prediction error stands, which says so.
    """
    found = _by_residuals(problem, box, None, how, records)
    levels, solution = before.solution.levels, found.solution
    assert levels is not None and levels.lasting is not None, "both descriptions of the record were compared"
    if not solution.converged:
        return before
    words = levels.lasting.words
    if answers:
        if (better := on_white_residuals(solution, box)) is None:
            return before
        solution, words = better, f"{words}. The rudder answers it, which biases output error: {WHITENED}"
    at = None
    if filtered:
        seen = replace(problem, sigma=residual_levels(solution))
        at = replace(levels_at(seen, solution.parameters, how.unit_time, how.tell), lasting=levels.lasting)
    rungs = [replace(r, used=False) if r.method == "prediction-error" else r for r in before.rungs]
    used = [replace(r, reason=f"{words[0].upper()}{words[1:]}. {r.reason}") for r in found.rungs if r.used]
    return replace(found, solution=replace(solution, levels=at), rungs=(*rungs, *used))


def _beside_simulation(problem: Problem, box: Box, how: SearchSettings, records: int, found: _Found) -> _Found:
    """The same, with what output error finds elsewhere: no rudder answers the noise here, which would bias that."""
    if found.solution.levels is None or not found.solution.converged:
        return found
    other = _by_residuals(problem, box, None, how, records).solution
    if not other.converged:
        return found
    shared = len(problem.estimated)
    both = [(s.parameters, np.sqrt(np.diag(covariance_of(s).matrix)[:shared])) for s in (found.solution, other)]
    apart = coefficients_apart(problem.model, problem.estimated, *both)
    return replace(found, solution=replace(found.solution, levels=replace(found.solution.levels, apart=apart)))


def _for_autopilots(rungs: tuple[Rung, ...], steered: Sequence[str]) -> tuple[Rung, ...]:
    """The methods that were tried, with the reason for prediction error."""
    why = f"an autopilot steers {', '.join(steered)} against disturbances, which biases output error."
    return tuple(replace(r, reason=f"{why} {r.reason[0].upper()}{r.reason[1:]}") if r.used else r for r in rungs)


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


def _told_apart(solution: Solution, used: Rung, parameters: Mapping[str, Estimate]) -> bool:
    """Whether coefficients are told from disturbances, which are part of the model: determined, and nothing serious against it."""
    sound = solution.converged and solution.levels is not None and not any(n.serious for n in solution.levels.notices)
    determined = any(e.identifiable and not e.follows for e in parameters.values())
    return sound and used.method == "prediction-error" and determined


def _result(
    setting: Setting, found: _Found, records: Sequence[Trial], noise_given: bool, load_part: LoadPart | None
) -> Fit:
    solution, rungs, box = found.solution, found.rungs, found.box
    problem, covariance = solution.problem, covariance_of(solution)
    by_residuals = solution.covariance is None or solution.whitened
    noise = residual_levels(solution) if by_residuals and not noise_given else problem.sigma
    shared = len(problem.estimated)
    unseen = [n for n, v in zip(problem.estimated, np.diag(covariance.matrix)) if np.isinf(v)]
    # About these the trials say nothing: they keep what is known of them beforehand.
    spreads = {n: std for n in unseen if (std := setting.stated.get(n, (0.0, None))[1]) is not None}
    if spreads:
        covariance = covariance_of(solution, np.array([spreads.get(n, np.inf) for n in problem.estimated]))
    block = covariance.matrix[:shared, :shared]
    elsewhere = undecided(solution.notices)
    words = unseen_words({n: float(solution.q[problem.estimated.index(n)]) for n in unseen}, setting.stated)
    degrees = None if solution.levels is None else solution.levels.degrees
    used = next(r for r in rungs if r.used)
    length = setting.known.get("L", setting.ship.particular("L", "m"))
    fitted = fitted_comparisons(problem, solution.q, records, length, covariance.matrix)
    lacks = missing_effect(solution, block, fitted, setting.scale.unit_time)
    wide = block if lacks is None else lacks.covariance
    parameters = estimates_of(problem, solution.q, wide, box, setting.scale, elsewhere | words, degrees, elsewhere)
    # Where disturbances are part of the model, they may move the ship more than her rudder does: the coefficients are then as
    # sure as their intervals say, and the run with the rudder alone is not their measure.
    least = least_unexplained(fitted, setting.scale.unit_time)
    unexplained = nothing_explained(least) and not _told_apart(solution, used, parameters)
    if (kept := all(course_is_kept(t) for t in records)) or unexplained:
        parameters = without_values(parameters, COURSE_KEPT if kept else UNEXPLAINED)
        unseen = list(problem.estimated)
        lacks, wide = None, np.diag(np.full(shared, np.inf))
    correlation = correlation_of(wide)
    trials = [data.trial for data in problem.trials]
    names = ", ".join(t.name for t in trials)
    source = f"identified by {used.method.replace('-', ' ')} from {names} (shipid {shipid.__version__})"
    ship = identified_ship(setting, parameters, trials, source, correlation, unseen)
    if measure_of(setting.model) is not None:
        structural = found.spread is not None and found.spread.structural
        load_part = weigh_load_part(problem, solution.parameters, block, structural)
    return Fit(
        model=setting.model,
        ship=ship,
        method=method_words(used, solution, noise_given),
        converged=solution.converged,
        message=" ".join((solution.message, *setting.notes)),
        parameters=parameters,
        fixed=dict(problem.fixed),
        covariance=wide,
        correlation=correlation,
        condition_number=plain(covariance.condition_number),
        noise=dict(zip(problem.signals, noise.tolist())),
        fitted=fitted,
        validation=(),
        chi_square=_chi_square(solution, noise),
        evaluations=solution.evaluations,
        provenance=_provenance(setting.model, trials),
        identified=Identified(
            ship, setting.scale, solution, covariance, parameters, used.method, noise, spreads, load_part
        ),
        ladder=rungs,
        loss=problem.loss,
        levels=solution.levels,
        bias_spread=found.spread,
        lacks=lacks,
    )


def _chi_square(solution: Solution, noise: np.ndarray) -> float:
    """Mean squared residual, in standard deviations of the noise, per degree of freedom."""
    problem = solution.problem
    split = problem.by_signal(solution.residual)
    together = np.concatenate([r * (s / n) for trial in split for r, s, n in zip(trial, problem.sigma, noise)])
    together = together[np.isfinite(together)]
    return float(together @ together / max(1, together.size - problem.size))


def _provenance(model: Model, trials: Sequence[Trial]) -> dict[str, Plain]:
    versions = {name: metadata.version(name) for name in ("casadi", "numpy", "scipy")}
    return {
        "versions": {"shipid": shipid.__version__, "python": sys.version.split()[0], **versions},
        "model_sha256": generate(model).digest,
        "trials": {t.name: {**t.source.to_dict(), "samples": len(t)} for t in trials},
    }
