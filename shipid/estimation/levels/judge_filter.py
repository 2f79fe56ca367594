"""Whether a filter fits its record: what was rejected, the size of the innovations, and where the coefficients ended."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from shipid.declaration.units import pretty
from shipid.estimation.levels.record_levels import Judged, RecordLevels
from shipid.estimation.records.consistency import FITTING, REJECTED_SHARE
from shipid.estimation.records.run import FilterRun
from shipid.estimation.recursion.gate import REJECTED, TAKEN
from shipid.estimation.standing import DETERMINED
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief, percent, probability, uncertain_text
from shipid.foundation.statistics import WHITE, interval_95

#: So many samples of a sensor say something.
_ENOUGH = 10
#: Innovations so many times larger than expected say nothing any more: intervals are withheld.
_HOPELESS = 5.0
#: Where identification knows a coefficient so well, one that is a tenth off is another one already at the second number.
_TENTH_APART, _TENTH, _GOOD = 0.9, 0.1, 0.15
#: So many standard deviations off its most probable value, the recursion has not come to it.
_UNFINISHED = 2.0
#: Intervals that grow by more are told of.
_WIDER = 1.5


def judge_filter(run: FilterRun, levels: RecordLevels | None = None) -> FilterRun:
    """Return a run with what speaks against it, and with intervals as wide as its innovations ask for.

    Parameters
    ----------
    run : FilterRun
        What the filter made of the record.
    levels : RecordLevels, optional
        What the record says of the noise of the filter.

    Returns
    -------
    FilterRun
    """
    sizes = {n: _squares(run, i) for i, n in enumerate(run.design.measured)}
    common = float(np.sqrt(max([1.0, *(_size(*both) for both in sizes.values() if both[0].size)])))
    widening = {n: common for n in run.design.parameters}
    for name, judged in ({} if levels is None else levels.coefficients).items():
        own = float(run.std_of(name)[-1])
        # The record's own deviation counts that of the biases, of which the filter knows nothing.
        ratio = judged.widening * max(1.0, judged.std / own) if own > 0 else 1.0
        widening[name] = max(common, ratio if np.isfinite(ratio) else 1.0)
    withheld = ""
    if common > _HOPELESS:
        withheld = f"the innovations are {common:.0f} times as large as this filter expects them"
    found = replace(run, widening=widening, withheld=withheld)
    if levels is not None:
        known = levels.bias_standings.items()
        added = {n: (b.std, "" if b.standing == DETERMINED else f"{b.standing}: {b.why}") for n, b in known}
        found = replace(found, learnt=levels.learnt, added=added)
    return replace(found, warnings=tuple(_notices(found, levels, sizes)))


def _squares(run: FilterRun, i: int) -> tuple[np.ndarray, np.ndarray]:
    """Squared normalised innovations of a sensor, before the gate was opened for any, and which samples were beyond the gate."""
    e, spread, fate, opened = (run.rows(n)[:, i] for n in ("e", "S", "fate", "inflation"))
    there = (fate == TAKEN) | (fate == REJECTED)
    forced = opened[there] > 1
    squares = np.where(forced, opened[there] ** 2, e[there] ** 2 / spread[there])
    return squares, forced | (fate[there] == REJECTED)


def _size(squares: np.ndarray, beyond: np.ndarray) -> float:
    """Mean squared innovation of a sensor; without the samples beyond the gate where these are so few that they are outliers."""
    few = float(np.mean(beyond)) <= REJECTED_SHARE
    return float(np.mean(squares[~beyond] if few else squares))


def _notices(
    run: FilterRun, levels: RecordLevels | None, sizes: dict[str, tuple[np.ndarray, np.ndarray]]
) -> Iterator[Notice]:
    yield from _about_search(levels)
    for name, (squares, beyond) in sizes.items():
        yield from _about_sensor(run, levels, name, squares, beyond)
    yield from not_white(run)
    yield from _about_coefficients(run, levels)


def not_white(run: FilterRun) -> Iterator[Notice]:
    """Yield what there is to say of each sensor whose innovations are correlated.

    Parameters
    ----------
    run : FilterRun
        What the filter made of the record.
    """
    for name, innovations in run.innovations.items():
        if innovations.white_p is not None and innovations.white_p < WHITE:
            yield Notice(
                f"The innovations of {name} are not white (p {probability(innovations.white_p)}): the model does not explain part of "
                "them, and the standard deviations treat that part as noise.",
                "innovations-not-white",
                sensor=name,
                p_value=innovations.white_p,
            )


def _about_search(levels: RecordLevels | None) -> Iterator[Notice]:
    if levels is not None and levels.learnt and not levels.converged:
        yield Notice(
            f"The noise levels could not be found from the record in {levels.evaluations} passes: give --measured and --noise.",
            "noise-not-found",
            serious=True,
        )


def _about_sensor(
    run: FilterRun, levels: RecordLevels | None, name: str, squares: np.ndarray, beyond: np.ndarray
) -> Iterator[Notice]:
    if squares.size < _ENOUGH:
        return
    count, share = int(np.count_nonzero(beyond)), float(np.mean(beyond))
    taken = count - run.innovations[name].rejected
    size = _size(squares, beyond)
    if share > REJECTED_SHARE:
        opened = f" The gate was opened for {taken} of them." if taken else ""
        yield Notice(
            f"{count} of {squares.size} samples of {name} ({percent(share)}) are beyond the gate: so many are rarely wrong, and the "
            f"noise levels or the model do not fit.{opened}{_advice(levels, name)}",
            "rejected",
            serious=True,
        )
    elif size > FITTING[1]:
        yield Notice(
            f"The innovations of {name} are {np.sqrt(size):.1f} times as large as this filter expects them: its noise levels are "
            f"too small, and so are its standard deviations.{_advice(levels, name)}",
            "noise-does-not-fit",
            serious=True,
            sensor=name,
        )
    elif size < FITTING[0]:
        yield Notice(
            f"The innovations of {name} are {np.sqrt(size):.2f} times as large as this filter expects them: its noise levels are "
            f"too large, and intervals too wide.{_advice(levels, name)}",
            "noise-does-not-fit",
            sensor=name,
        )


def _advice(levels: RecordLevels | None, name: str) -> str:
    if levels is None or f"sensor:{name}" in levels.learnt:
        return ""
    return f" The noise of {name} was given; leave it out, and it is taken from the record."


def _about_coefficients(run: FilterRun, levels: RecordLevels | None) -> Iterator[Notice]:
    wider = {n: w for n, w in run.widening.items() if w > _WIDER}
    if wider and not run.withheld:
        factor = max(wider.values())
        yield Notice(
            f"The innovations are larger than expected or correlated: the interval{'s' if len(wider) > 1 else ''} of "
            f"{' and '.join(wider)} {'are' if len(wider) > 1 else 'is'} {factor:.1f} times as wide as the filter's own.",
            "interval-widened",
        )
    if run.withheld:
        yield Notice(f"No interval is given: {run.withheld}.", "interval-withheld", serious=True)
    if levels is None or run.withheld:
        return
    other, missed = [], []
    for name, judged in levels.coefficients.items():
        estimate, unit = run.parameters[name], unit_text(run.design.base[name].unit)
        if estimate.value is None:
            continue
        own = f"{name} {uncertain_text(estimate.value, estimate.std)}{unit}"
        simulated, deviation = judged.simulated, judged.simulated_std
        if simulated is not None and deviation is not None and _differ(estimate.value, judged):
            other.append(f"{own} (by {levels.method} {uncertain_text(simulated, deviation)}{unit})")
        elif abs(estimate.value - judged.value) > _UNFINISHED * judged.widening * float(run.std_of(name)[-1]) > 0:
            missed.append(f"{own} (most probable {brief(judged.value, 4)}{unit})")
    if other:
        yield Notice(
            f"The model is not exact, and what it leaves out counts here as noise that drives the ship: {', '.join(other)}. For "
            "predictions take the coefficients of shipid identify.",
            "coefficients-differ",
            serious=True,
        )
    if levels.at_bound:
        several = len(levels.at_bound) > 1
        yield Notice(
            f"By {levels.method} this record does not determine {' and '.join(levels.at_bound)}: the search ended at "
            f"{'their bounds' if several else 'its bound'}. So nothing confirms the coefficients of the filter: they rest on noise "
            "that drives the ship. Filter a longer record, or one with more rudder.",
            "not-confirmed",
            serious=True,
        )
    for name, words in levels.undecided.items():
        yield Notice(
            f"By {levels.method} this record does not determine {name}: {words} So nothing confirms the coefficients of the filter. Filter "
            "a longer record, or one of another manoeuvre.",
            "not-confirmed",
            serious=True,
        )
    if missed:
        yield Notice(
            f"The recursion did not come to the most probable coefficients: {', '.join(missed)}. Start closer to them (--start), "
            "or take the coefficients of shipid identify.",
            "coefficients-differ",
            serious=True,
        )


def _differ(value: float, judged: Judged) -> bool:
    """Whether an estimate is another one than that of the identification of the same record: it is outside its 95 % interval."""
    other, deviation = judged.simulated, judged.simulated_std
    if other is None or deviation is None:
        return False
    low, high = judged.simulated_ends or interval_95(other, deviation)
    much = abs(value - other) > max(_TENTH_APART * deviation, _TENTH * abs(other)) and deviation < _GOOD * abs(other)
    return not low <= value <= high or much


def unit_text(unit: str) -> str:
    """Return a unit as it stands behind a number: with a blank before it, or nothing for the unit 1.

    Parameters
    ----------
    unit : str
        The unit.
    """
    return "" if unit in ("", "1") else f" {pretty(unit)}"
