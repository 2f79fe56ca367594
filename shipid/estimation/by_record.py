"""A record through a filter whose noise levels come from it."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

from shipid.estimation.errors import FilterDivergedError
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.levels.judge_filter import judge_filter, unit_text
from shipid.estimation.levels.record_levels import BatchEstimate, RecordLevels
from shipid.estimation.records.arrangement import FilterRecord
from shipid.estimation.records.run import FilterRun
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief

#: A recursion that ends so many standard deviations off the most probable value was linearised too far from it.
_NEAR = 0.5
#: It then starts at that value with so many times its standard deviation, which counts the record twice by 4 %.
_UNCERTAIN = 5.0


def filter_by_record(
    kalman: ExtendedKalmanFilter,
    record: FilterRecord,
    kept: Collection[str] = (),
    tell: Callable[[str], None] = lambda _: None,
    identified: Callable[[], BatchEstimate | None] = lambda: None,
) -> tuple[FilterRun, RecordLevels]:
    """Filter a record with the noise levels under which it is most probable, and judge the result.

    An extended Kalman filter is linearised at its own estimates. Where it starts far from the coefficients of the ship, its
    first steps are taken along wrong slopes, and it ends beside the most probable coefficients. It then runs once more from
    these, with a first standard deviation so small that its slopes stay right.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter, with the levels to start from.
    record : Trial or mapping of str to ndarray
        What is filtered.
    kept : collection of str
        ``sensor:NAME`` and ``noise:NAME`` that stay as they are, and ``bias:INPUT`` that is none.
    tell : callable
        Called with what is being done.
    identified : callable
        What identification makes of the same record, or None where it cannot: the filter is judged beside it. It is asked where
        the model has such an estimate, and the filter's own output error is taken instead where there is no answer.

    Returns
    -------
    run : FilterRun
        With its warnings.
    levels : RecordLevels
        The levels, and what else comes from the record.

    Raises
    ------
    FilterDivergedError
        If the estimate diverges.
    """
    tell("finding the noise levels")
    levels = kalman.learn_levels(record, tuple(kept))
    if levels.simulated:
        tell("identifying")
        batch = identified()
        levels = levels if batch is None else levels.beside(batch)
    tuned = kalman.with_levels(levels)
    tell("filtering")
    given = kalman.settings.start or {}
    values = {n: c.value for n, c in levels.coefficients.items() if n not in given}
    starts = {n: (v, _UNCERTAIN * levels.coefficients[n].std) for n, v in values.items()}
    try:
        run = tuned.filter(record)
    except FilterDivergedError:
        if not values:
            raise
        run = None
    if run is not None and not _missed(run, values):
        return judge_filter(run, levels), levels
    again = judge_filter(tuned.started_at(starts).filter(record), levels)
    note = Notice(
        "From the first values the filter does not come to the most probable coefficients of the record, so it starts from "
        f"these: {', '.join(f'{n} {brief(v, 4)}{unit_text(again.design.base[n].unit)}' for n, v in values.items())}.",
        "started-at-most-probable",
    )
    return replace(again, warnings=(*again.warnings, note)), levels


def _missed(run: FilterRun, values: dict[str, float]) -> bool:
    """Whether the last estimate of a coefficient is not its most probable value."""
    return any(abs(float(run[n][-1]) - v) > _NEAR * float(run.std_of(n)[-1]) for n, v in values.items())
