"""The score of a prediction: what people judge one by, each in shares of what was measured, with its weight."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.statistics import plain
from shipid.identification.problem.signals import SIGNALS, is_predicted
from shipid.identification.validation.closed_loop import Swings
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.left_out import LeftOut

#: What a prediction is judged by: unit of the value, weight in the score, meaning. A heading that is not corrected for a rudder
#: bias has no weight: on a ship that hardly keeps her course it measures the bias, which no structure knows. Overshoots are
#: looked at twice, because an error of one swing goes on to the next where the recorded rudder is followed.
MEASURES = {
    "rate": ("rad/s", 1.0, "rms error of the rate of turn, nothing refitted"),
    "heading_refitted_bias": ("rad", 1.0, "rms error of the heading with rudder bias and initial state refitted"),
    "overshoot": ("rad", 1.0, "rms error of the first two overshoot angles, recorded rudder"),
    "overshoot_closed": ("rad", 1.0, "the same with the rudder reversed at the headings of the trial"),
    "period": ("s", 0.5, "error of the mean time between two reversals, rudder reversed at the headings"),
    "speed": ("m/s", 0.5, "rms error of the forward speed, nothing refitted"),
    "sway": ("m/s", 0.5, "rms error of the sway speed, nothing refitted"),
    "heading_warm": ("rad", 0.0, "rms error of the heading after a warm-up to the first reversal of the rudder"),
    "heading": ("rad", 0.0, "rms error of the heading, nothing refitted"),
}
#: Share of what was measured at which a prediction is no better than none, and one below which sensors decide.
WORTHLESS, PERFECT = 3.0, 0.02
#: Overshoots that count.
_FIRST = 2


def measures_of(model: Model, c: Comparison, swings: Swings | None) -> tuple[dict[str, float | None], dict[str, float]]:
    """Return the measures of a prediction, SI, and the size of what was measured, by measure.

    Parameters
    ----------
    model : Model
        What predicted.
    c : Comparison
        The trial and its prediction.
    swings : Swings or None
        Its zig-zag in closed loop.
    """
    size = {n: float(np.nanstd(c.trial[n])) if _is_there(c, n) else 1.0 for n in SIGNALS}
    found = {
        "rate": c.rmse.get("r"),
        "heading_warm": c.warm.get("psi"),
        "heading_refitted_bias": c.refitted.get("psi"),
        "overshoot": _missed_overshoots(c.overshoots, c.predicted_overshoots),
        "overshoot_closed": None if swings is None else _missed_overshoots(c.overshoots, swings.overshoots),
        "speed": _missed(model, c, "u"),
        "sway": _missed(model, c, "v"),
        "heading": c.rmse.get("psi"),
    }
    usual = float(np.mean(c.overshoots[:_FIRST])) if c.overshoots else 1.0
    sizes = {
        "rate": size["r"],
        "heading_warm": size["psi"],
        "heading_refitted_bias": size["psi"],
        "overshoot": usual,
        "overshoot_closed": usual,
        "speed": size["u"],
        "sway": size["v"],
    }
    found["period"], sizes["period"] = _missed_period(c, swings)
    return {n: plain(found[n]) for n in MEASURES}, sizes


def score_of(measures: Mapping[str, float | None], size: Mapping[str, float]) -> float:
    """Return the weighted geometric mean of the measures in shares of what was measured.

    Parameters
    ----------
    measures : mapping of str to float or None
        See `measures_of`.
    size : mapping of str to float
        What was measured.
    """
    counted = [
        (weight, min(WORTHLESS, max(PERFECT, value / size[n])))
        for n, (_, weight, _) in MEASURES.items()
        if weight and (value := measures[n]) is not None and size[n] > 0
    ]
    if not counted:
        return WORTHLESS
    weights, shares = zip(*counted)
    return float(np.exp(np.average(np.log(shares), weights=weights)))


def counted_measures(
    left_out: Sequence[LeftOut], model: Model
) -> list[tuple[dict[str, float | None], float, float | None]]:
    """Return for each trial its measures, its score, and the error of the rate of turn in shares of its size.

    Parameters
    ----------
    left_out : sequence of LeftOut
        The trials.
    model : Model
        What predicted them.
    """
    found = []
    for one in left_out:
        measures, sizes = measures_of(model, one.comparison, one.swings)
        rate = measures["rate"]
        known = rate is not None and sizes["rate"] > 0
        found.append(
            (measures, score_of(measures, sizes), rate / sizes["rate"] if known and rate is not None else None)
        )
    return found


def together(values: Sequence[float | None]) -> float | None:
    """Return the root-mean-square of the values that are known.

    Parameters
    ----------
    values : sequence of float or None
        The values.
    """
    known = [v for v in values if v is not None]
    return float(np.sqrt(np.mean(np.square(known)))) if known else None


def _missed_overshoots(measured: Sequence[float], predicted: Sequence[float | None]) -> float | None:
    """Root-mean-square error of the first overshoots; one that is not reached is missed whole."""
    pairs = [(m, p or 0.0) for m, p in zip(measured[:_FIRST], predicted)]
    return float(np.sqrt(np.mean([(m - p) ** 2 for m, p in pairs]))) if pairs else None


def _missed_period(c: Comparison, swings: Swings | None) -> tuple[float | None, float]:
    """Error of the mean time between two reversals, and that time; a zig-zag that is not sailed on is missed whole."""
    measured = c.measures.zigzag.leading_executes if c.measures.zigzag is not None else ()
    if swings is None or len(measured) < 2:
        return None, 1.0
    last = min(len(measured), len(swings.reversals)) - 1
    if last < 1:
        whole = (measured[-1] - measured[0]) / (len(measured) - 1)
        return whole, whole
    own = (measured[last] - measured[0]) / last
    return abs((swings.reversals[last] - swings.reversals[0]) / last - own), own


def _is_there(c: Comparison, name: str) -> bool:
    return c.trial.has(name) and bool(np.isfinite(c.trial[name]).any())


def _missed(model: Model, c: Comparison, name: str) -> float | None:
    """Error of a speed; a model that says nothing of it has the speed of the approach, and no sway."""
    if not _is_there(c, name):
        return None
    if name in c.predicted and is_predicted(model, name):
        predicted = c.predicted[name]
    else:
        predicted = c.predicted["u"][:1] if name == "u" and "u" in c.predicted else np.zeros(1)
    with np.errstate(over="ignore", invalid="ignore"):
        errors = (c.trial[name] - predicted)[np.isfinite(c.trial[name])]
        return float(np.sqrt(np.mean(errors**2)))
