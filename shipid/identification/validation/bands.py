"""Prediction bands: what the uncertainty of a fit means for the overshoots and the circle of each trial.

Parameters, rudder bias and (for a fitted trial) initial state are drawn together from their covariance and run through the
recorded rudder, and through the zig-zag as its helmsman would have steered that ship. The error of the model's structure
(`shipid.identification.validation.structure_error`) comes on top; the noise of a measured overshoot is not in the bands.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
import pandas as pd

from shipid.declaration.vocabulary import FIELDS
from shipid.generation.record import make_record
from shipid.identification.identified import Identified
from shipid.identification.problem.ship_scale import scale_before
from shipid.identification.problem.signals import is_predicted
from shipid.identification.uncertainty.amplitudes import recorded_speeds
from shipid.identification.uncertainty.draws import Draws, band_of
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.predicted_manoeuvre import TURN, Band, PredictedManoeuvre, PredictedQuantity
from shipid.identification.validation.predictions import shown_outputs
from shipid.identification.validation.runs import Run, Runs, runs_of, simulator_of
from shipid.identification.validation.structure_error import StructureError, growth_of
from shipid.identification.validation.trial_measures import measured_circle
from shipid.trials.measuring.results.turning_circle import TurningCircle
from shipid.trials.measuring.results.zigzag import ZigZag
from shipid.trials.measuring.track import driven_until
from shipid.trials.measuring.zigzags.swings import overshoots_of
from shipid.trials.trial import Trial

#: Samples of a circle that are enough to measure it.
_ENOUGH = 3000
#: L/U before the order from where a turn is predicted.
_APPROACH = 1.0
#: So many times as long as it was recorded a turn is sailed on by draws that turn more slowly.
_LONGER = 3.0
_Read = TypeVar("_Read")


def manoeuvres_of(
    identified: Identified,
    comparisons: Sequence[Comparison],
    draws: Draws,
    structure: StructureError | None = None,
    turning: Draws | None = None,
) -> dict[str, PredictedManoeuvre]:
    """Return the manoeuvre of every trial, fitted and predicted, with its bands, by the name of the trial.

    Parameters
    ----------
    identified : Identified
        What was identified.
    comparisons : sequence of Comparison
        The trials beside their predictions.
    draws : Draws
        Unknowns drawn from the covariance.
    structure : StructureError, optional
        What the structure of the model is wrong by; without it the bands are those of the coefficients alone.
    turning : Draws, optional
        Draws for turning circles, where they are others.
    """
    places = {id(data.trial): i for i, data in enumerate(identified.problem.trials)}
    return {
        c.trial.name: _manoeuvre(identified, c, draws, turning or draws, structure, places.get(id(c.trial)))
        for c in comparisons
    }


def _manoeuvre(
    identified: Identified,
    comparison: Comparison,
    draws: Draws,
    turning: Draws,
    structure: StructureError | None,
    index: int | None,
) -> PredictedManoeuvre:
    trial, circle = comparison.trial, comparison.measures.circle
    zigzag = comparison.measures.zigzag if comparison.overshoots else None
    open_loop = tuple(None if o is None or not np.isfinite(o) else o for o in comparison.predicted_overshoots)
    found = PredictedManoeuvre(trial.name, comparison.overshoots, open_loop)
    if circle is None and zigzag is None:
        return found
    runs = runs_of(identified, comparison, draws.unknowns, index)
    growth = growth_of(identified.model, identified.ship, comparison)
    if zigzag is not None:
        found = _with_swings(found, identified, runs, zigzag, structure, growth)
    if circle is not None:
        approached = _from_the_order(identified, comparison, circle) if index is None else comparison
        if index is None or turning is not draws:
            runs = runs_of(identified, approached, turning.unknowns, index)
        found = replace(found, turn=_circle(identified, runs, circle, structure, growth))
    return replace(found, growth=growth)


def _from_the_order(identified: Identified, comparison: Comparison, circle: TurningCircle) -> Comparison:
    """The trial from shortly before the order: what a ship in wind drifts off on a long approach is nothing of her turn."""
    ordered, trial = circle.first_execute, comparison.trial
    if ordered is None:
        return comparison
    start = ordered - _APPROACH * scale_before(identified.ship, trial).unit_time
    if start <= trial["t"][0]:
        return comparison
    # The initial state that was found is that of the beginning of the record.
    return replace(comparison, trial=trial.window(start, None), initial={})


def _over(
    identified: Identified,
    runs: Iterable[Run],
    record: tuple[np.ndarray, np.ndarray],
    read: Callable[[dict[str, np.ndarray]], _Read],
) -> list[_Read]:
    """Run a record, its inputs and intervals, for each run, and read each result from its columns."""
    outputs = shown_outputs(identified.problem)
    system = make_record(identified.model, outputs, guarded=True)

    def sailed(x0: np.ndarray, p: np.ndarray, bias: np.ndarray) -> np.ndarray:
        y, _, margins = system.run(x0, *record, p, bias)
        # A run that leaves the range of the model has no numbers.
        return y if (margins >= 0).all() else np.full_like(y, np.nan)

    results = (sailed(*run) for run in runs)
    return [read(dict(zip(outputs, y))) for y in results]


def _with_swings(
    found: PredictedManoeuvre,
    identified: Identified,
    runs: Runs,
    measured: ZigZag,
    structure: StructureError | None,
    growth: float,
) -> PredictedManoeuvre:
    trial, count = runs.data.trial, len(found.overshoots)
    executes = measured.leading_executes
    side = 1 if measured.first_side == "starboard" else -1

    def read(run: dict[str, np.ndarray]) -> tuple[float | None, ...]:
        if not np.isfinite(run["psi"]).all():
            return (None,) * count
        return _filled(overshoots_of(trial["t"], run["psi"], executes, side=side), count)

    point, *drawn = _over(identified, runs, (runs.data.inputs, runs.data.intervals), read)
    wide = (0.0, 0.0) if structure is None else tuple(structure.half_width(closed, growth) for closed in (False, True))
    found = replace(found, open_loop=point, band95=_bands(point, drawn, wide[0]))
    simulator = simulator_of(identified, runs.data, measured)
    if simulator is None:
        return found
    point, *drawn = (_filled(simulator(*run).overshoots, count) for run in runs)
    return replace(found, closed_loop=point, closed_loop_band95=_bands(point, drawn, wide[1]))


def _filled(overshoots: Sequence[float | None], count: int) -> tuple[float | None, ...]:
    """So many overshoots, None for those that were not reached."""
    return (*overshoots[:count], *(None,) * (count - len(overshoots)))


def _bands(point: tuple[float | None, ...], drawn: list[tuple[float | None, ...]], wide: float) -> tuple[Band, ...]:
    """Bands of overshoots, which are not negative."""
    found = [_widened(p, band_of(p, [d[k] for d in drawn]), wide) for k, p in enumerate(point)]
    return tuple(None if b is None else (max(0.0, b[0]), b[1]) for b in found)


def _widened(point: float | None, band: Band, wide: float) -> Band:
    """A band with an independent error of that half-width on top."""
    if band is None or point is None:
        return None
    return point - float(np.hypot(point - band[0], wide)), point + float(np.hypot(band[1] - point, wide))


def _lost_speed(identified: Identified) -> float:
    """The largest share of her speed that the ship lost in a fitted trial."""
    seen = [recorded_speeds([data.trial]) for data in identified.problem.trials]
    return max((1.0 - low / high for low, high in (s for s in seen if s is not None) if high > 0), default=0.0)


def _held_on(trial: Trial, measured: TurningCircle) -> tuple[np.ndarray, np.ndarray] | None:
    """Rows and times of a turn that goes on: a ship that turns more slowly is not through when the record ends.

    What stands at the end of the turn, before the rudder is put back or the propeller stopped, is held for several times as long; None
    where the propeller stops before the rudder is over.
    """
    t, begin = trial["t"], measured.first_execute or 0.0
    rudder = trial["delta" if trial.has("delta") else "delta_order"]
    over = np.abs(rudder) >= 0.5 * abs(measured.rudder or 0.0)
    turning = np.flatnonzero(over & (t < driven_until(trial, begin)))
    if not turning.size:
        return None
    last = int(turning[-1])
    step = float(np.median(np.diff(t)))
    more = int(_LONGER * (t[last] - begin) / step)
    rows = np.concatenate([np.arange(last + 1), np.full(more, last)])
    return rows, np.concatenate([t[: last + 1], t[last] + step * np.arange(1, more + 1)])


def _circle(
    identified: Identified, runs: Runs, measured: TurningCircle, structure: StructureError | None, growth: float
) -> dict[str, PredictedQuantity]:
    data, trial, model = runs.data, runs.data.trial, identified.model
    speed = "u" in model and is_predicted(model, "u")

    def turned(runs: Iterable[Run], rows: np.ndarray, t: np.ndarray) -> list[dict[str, float | None]]:
        every = max(1, len(trial) // _ENOUGH)
        kept = {n: trial[n][rows][::every] for n in ("delta", "delta_order") if trial.has(n)}

        def read(run: dict[str, np.ndarray]) -> dict[str, float | None]:
            if not all(np.isfinite(column).all() for column in run.values()):
                return {}
            signals = {n: column[::every] for n, column in run.items() if n in FIELDS}
            columns = {"t": t[::every], **kept, **signals}
            found = measured_circle(Trial(trial.name, pd.DataFrame(columns)), None, measured.execute)
            if found is None:
                return {}
            return {name: getattr(found, name) for name in TURN if speed or name != "steady_speed"}

        return _over(identified, runs, (data.inputs[:, rows], np.diff(t, append=t[-1])), read)

    found = turned(runs, np.arange(len(trial)), trial["t"])
    # What was measured, or is predicted: a run that lacks any of it, the prediction itself too, is not through where the record ends.
    wanted = [n for n in TURN if getattr(measured, n) is not None and (speed or n != "steady_speed")]
    wanted += [n for n, value in found[0].items() if value is not None and n not in wanted]
    slow = [k for k, one in enumerate(found) if any(one.get(n) is None for n in wanted)]
    if slow and (held := _held_on(trial, measured)) is not None:
        every_run = list(runs)
        for k, longer in zip(slow, turned([every_run[k] for k in slow], *held)):
            found[k] = {n: longer.get(n) if (own := found[k].get(n)) is None else own for n in (TURN if k else wanted)}
    point, *drawn = found
    # A model that is told the speed turns at that of the approach: the ship loses some in a circle, and her path is shorter.
    lost = 0.0 if speed else _lost_speed(identified)
    result = {}
    for name, (unit, factor) in TURN.items():
        own, foreseen = getattr(measured, name), point.get(name)
        share = 0.0 if structure is None else structure.share(name, growth)
        share = float(np.hypot(share, lost)) if unit == "m" else share
        band = _widened(foreseen, band_of(foreseen, [d.get(name) for d in drawn]), share * abs(foreseen or 0.0))
        result[name] = PredictedQuantity(
            None if own is None else own * factor,
            None if foreseen is None else foreseen * factor,
            None if band is None else (band[0] * factor, band[1] * factor),
        )
    return result
