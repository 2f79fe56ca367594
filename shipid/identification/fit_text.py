"""The parts of a fit in lines of text, as they are printed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import display_unit, shown, shown_error, shown_estimate, to_display
from shipid.estimation.estimate import Estimate
from shipid.foundation.numbers import brief, number, uncertain_text
from shipid.foundation.statistics import WHITE
from shipid.identification.evidence.bias_spread import BiasSpread
from shipid.identification.evidence.explained import ASTERN, MOTION_UNEXPLAINED, NOT_DETERMINED, WIND_UNREAD
from shipid.identification.evidence.missing_effect import EFFECT_MISSING
from shipid.identification.evidence.record_doubts import SEEN_BEFORE, TRIAL_TWICE
from shipid.identification.evidence.several_ends import ANOTHER_MINIMUM
from shipid.identification.methods import METHODS
from shipid.identification.problem.prior_shares import held_words
from shipid.identification.search.noise_levels import APART, LASTING, NoiseLevels
from shipid.identification.search.rung import Rung
from shipid.identification.search.solution import Solution
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.predicted_manoeuvre import PredictedManoeuvre
from shipid.parameters.correlation import Joint
from shipid.parameters.validity import range_words
from shipid.trials.signals.ship_length import SHIP_LENGTH

#: The kinds of warnings that stand before the coefficients.
FIRST = (
    NOT_DETERMINED,
    ANOTHER_MINIMUM,
    MOTION_UNEXPLAINED,
    EFFECT_MISSING,
    LASTING,
    APART,
    ASTERN,
    WIND_UNREAD,
    TRIAL_TWICE,
    SEEN_BEFORE,
    SHIP_LENGTH,
)


def coefficient_lines(parameters: Mapping[str, Estimate]) -> list[str]:
    """Return one line a coefficient: its value, and why the trials do not determine it.

    Parameters
    ----------
    parameters : mapping of str to Estimate
        The coefficients.
    """
    return [
        f"  {e.name:<10s} {_value_text(e)}" + ("" if e.identifiable else f"   {e.standing}: {e.why}")
        for e in parameters.values()
    ]


def dead_time_lines(model: Model) -> list[str]:
    """Return one line for a dead time of a model: what it is, and how the fit goes without it.

    Parameters
    ----------
    model : Model
        The fitted model.
    """
    return [
        f"  {name:<10s} is a dead time: '{late}' acts so much later than it is recorded, by its gear or by a clock. Every record of "
        f"it is shifted by that, and orders in a closed loop are late by it, two samples at least; --fix '{name}=0 s' fits without."
        for late, name in model.delays.items()
    ]


def prior_lines(shares: Mapping[str, float]) -> list[str]:
    """Return one line of the coefficients that are known more by their prior than by the trials.

    Parameters
    ----------
    shares : mapping of str to float
        Share of the information that the prior is, by coefficient.
    """
    held = held_words(shares)
    return [f"  held      {held}: that much of the information is the prior that the model declares"] if held else []


def range_lines(model: Model, known: Joint | None) -> list[str]:
    """Return the speeds and amplitudes that the fitted trials reach, and the speed that coefficients with a dimension belong to.

    Parameters
    ----------
    model : Model
        The model.
    known : Joint or None
        What the set says of the origin of its coefficients.
    """
    words = {} if known is None else range_words(known)
    said = [f"speeds {words[n]}" if n == "u" else words[n] for n in words]
    lines = [f"  seen      {', '.join(said)}; beyond that it extrapolates"] if said else []
    # A length alone is the same at every speed.
    dimensional = [n for n in model.parameters if model[n].quantity.prime and Scale(1.0, 2.0).factor_of(model[n]) != 1]
    if known is not None and known.belongs_to is not None and dimensional:
        at = shown(known.belongs_to, "u", "m/s", digits=3)
        lines.append(
            f"            {', '.join(dimensional)} belong to {at} before the manoeuvre; at other speeds they are scaled by L/U"
        )
    return lines


def comparison_lines(comparisons: Sequence[Comparison], role: str) -> list[str]:
    """Return errors and overshoots of each trial.

    Parameters
    ----------
    comparisons : sequence of Comparison
        The trials beside their predictions.
    role : {"fitted", "predicted"}
        Whether they were fitted or predicted.
    """
    lines = []
    for c in comparisons:
        explained = c.fit_percent
        errors = ", ".join(
            _error_text(c, s, v) + (f" (fit {fit_words(explained[s])})" if s in explained else "")
            for s, v in c.rmse.items()
        )
        lines.append(f"  {role:<9s}  {c.trial.name}: rms error {errors}")
        if c.departure is not None:
            lines.append(f"             {c.departure}")
        if c.refitted:
            again = ", ".join(_error_text(c, s, v) for s, v in c.refitted.items())
            lines.append(f"             with rudder bias and initial state refitted: {again}")
        if c.overshoots:
            pairs = [f"{_angle(m)} / {_angle(p)}" for m, p in zip(c.overshoots, c.predicted_overshoots)]
            lines.append(
                f"             overshoots measured / predicted: {', '.join(pairs)} {display_unit('psi', 'rad')}"
            )
        if any(there < possible for there, possible in c.samples.values()):
            counts = ", ".join(f"{s} {there} of {possible}" for s, (there, possible) in c.samples.items())
            lines.append(f"             samples there: {counts}")
    # The stretches of one record have its notes in common.
    notes = dict.fromkeys(note for c in comparisons for note in c.notes)
    return lines + [f"             {note}" for note in notes]


def band_lines(manoeuvres: Mapping[str, PredictedManoeuvre]) -> list[str]:
    """Return one line for each manoeuvre that goes beyond the amplitudes that were fitted.

    Parameters
    ----------
    manoeuvres : mapping of str to PredictedManoeuvre
        With their bands.
    """
    return [
        f"  bands     {name}: {m.growth:.1f} times as far as the fitted trials go (rudder angle or rate of turn); the part of the bands "
        "that is due to the structure of the model is as many times wider"
        for name, m in manoeuvres.items()
        if m.growth > 1
    ]


def ladder_lines(ladder: Sequence[Rung]) -> list[str]:
    """Return one line for each method that was tried, where there were several.

    Parameters
    ----------
    ladder : sequence of Rung
        The rungs.
    """
    lines = []
    for rung in ladder if len(ladder) > 1 else ():
        cost = "runs away" if rung.cost is None else f"cost {number(rung.cost, 4)}"
        state = f"{'' if rung.converged else ', not converged'}{', used' if rung.used else ''}"
        lines.append(f"  tried     {rung.method} ({cost}{state}): {rung.reason}")
    return lines


def bias_lines(spread: BiasSpread | None, fitted: Sequence[Comparison]) -> list[str]:
    """Return one line for the rudder biases and their spread, where there are several trials.

    Parameters
    ----------
    spread : BiasSpread or None
        The spread.
    fitted : sequence of Comparison
        The fitted trials.
    """
    if spread is None:
        return []
    each = ", ".join(f"{c.trial.name} {shown_estimate(c.bias, c.bias_std, 'delta')}" for c in fitted)
    lines = [f"  rudder    biases {each}; {spread.words}"]
    return lines + ([] if spread.notice is None else [f"  biases    {spread.notice}"])


def noise_lines(levels: NoiseLevels, model: Model) -> list[str]:
    """Return one line for each source of noise.

    Parameters
    ----------
    levels : NoiseLevels
        Process noise and sensor noise.
    model : Model
        For the units.
    """
    lines = []
    for name, level in levels.process.items():
        density = shown(level, name, model[name].unit, digits=3)
        lines.append(f"  noise     drives {name}: {density}/s^0.5 (white, per root second)")
    for name, gust in levels.gusts.items():
        size = f"{brief(to_display(gust.size, name, model[name].unit), 3)} {display_unit(name, model[name].unit)}/s"
        lines.append(f"  noise     drives {name}: gusts of {size} that last for {brief(gust.time, 3)} s")
    for name, level in levels.sensors.items():
        std = shown(level, name, model[name].unit, digits=3)
        lines.append(f"  noise     sensor of {name}: {std} in one sample")
    if levels.lasting is not None:
        lines.append(f"  noise     {levels.lasting.words}")
    coloured = [n for n, p in levels.whiteness.items() if p < WHITE]
    if levels.whiteness:
        words = (
            f"not white in {', '.join(coloured)}: standard deviations by their spectrum; what the noise lacks, such as waves, may bias the coefficients"
            if coloured
            else "white"
        )
        lines.append(f"  noise     innovations are {words}")
    return lines


def method_words(rung: Rung, solution: Solution, noise_given: bool) -> str:
    """Return how the coefficients were found.

    Parameters
    ----------
    rung : Rung
        The one that was used.
    solution : Solution
        Where the search ended.
    noise_given : bool
        Whether noise levels were given, not estimated.
    """
    problem = solution.problem
    signals, method = ", ".join(problem.signals), METHODS[rung.method]
    if solution.covariance is None:
        weights = "noise levels given" if noise_given else "weighted by size and duration of the residuals"
        words = [f"{method} on {signals}", "exact sensitivities", weights]
        if problem.prior is not None and problem.prior.biases and len(problem.trials) > 1:
            words.append("rudder biases as random effects")
    elif solution.whitened:
        words = [f"{method} on {signals}", "exact sensitivities", "residuals whitened by their autoregression"]
    else:
        words = [method, f"initial states and biases by output error on {signals}"]
    return ", ".join([*words, *([f"{problem.loss} loss"] if problem.loss != "linear" else [])])


def fit_words(value: float) -> str:
    """Return a fit in percent: ``97.3 %``; of one that is far worse than the mean only that it is.

    Parameters
    ----------
    value : float
        In percent.
    """
    return f"{round(value, 1) + 0.0:.1f} %" if value >= -99.95 else "below -100 %"


def _angle(value: float | None) -> str:
    return "-" if value is None else f"{to_display(value, 'psi'):.1f}"


def _value_text(e: Estimate) -> str:
    """A value with its standard deviation and its unit."""
    if e.value is None:
        return e.lacks
    return uncertain_text(e.value, e.std) + ("" if pretty(e.unit) == "1" else f" {pretty(e.unit)}")


def _error_text(c: Comparison, signal: str, error: float) -> str:
    """An error of a signal in its display unit."""
    return f"{signal} {shown_error(error, signal, c.unit(signal))}" if np.isfinite(error) else f"{signal} runs away"
