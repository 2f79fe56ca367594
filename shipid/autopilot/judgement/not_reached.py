"""What a design does not reach, in sentences: a cell of a table is easily passed over, the summary is not."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from shipid.autopilot.course_changes.course_changes import CourseChange
from shipid.autopilot.judgement.robust_margins import Robustness
from shipid.autopilot.on_board.on_board_runs import OnBoardRuns
from shipid.foundation.numbers import brief


def not_reached(
    steps: Sequence[CourseChange],
    in_weather: Sequence[CourseChange],
    robust: Sequence[Robustness],
    on_board: OnBoardRuns | None = None,
) -> tuple[str, ...]:
    """Return what no run reached, a sentence an entry.

    Parameters
    ----------
    steps : sequence of CourseChange
        In calm.
    in_weather : sequence of CourseChange
        In wind, waves and current; those without the sea filter are passed over, as the filter is on in weather.
    robust : sequence of Robustness
        For each load condition.
    on_board : OnBoardRuns, optional
        Runs with the Kalman filter in the loop.
    """
    filtered = [s for s in in_weather if s.sea_filter]
    found = [
        *_of_steps(steps),
        *_of_weather([s for s in filtered if not s.change_deg], "The course is not kept"),
        *_of_weather([s for s in filtered if s.change_deg], "The new course is not reached"),
    ]
    for one in robust:
        change = f"A course change of {brief(one.sample_change_deg)} deg"
        unsettled = [n for n, v in one.variants.items() if v["settling_s"] is None]
        found += [f"{change} does not settle with {_listed(unsettled)}."] if unsettled else []
        if one.samples and one.settling_s[0] is not None and one.settling_s[-1] is None:
            found.append(f"{change} does not settle within the run for more than 5 % of the ships drawn.")
    if on_board is not None:
        lost = [
            f"by the {r.feedback} in {r.weather}"
            for r in on_board.runs
            if any(c.lost or (c.change_deg and r.weather == "calm" and c.settling_s is None) for c in r.changes)
        ]
        found += [f"On board a course change is not completed {_listed(lost)}."] if lost else []
    return tuple(found)


def _of_steps(steps: Sequence[CourseChange]) -> list[str]:
    """Course changes that do not settle, by speed; a run that was lost is told by a warning of the judgement."""
    groups: dict[tuple[str, float], list[str]] = {}
    for s in steps:
        if s.settling_s is None and not s.lost:
            groups.setdefault((s.weather, s.speed), []).append(brief(abs(s.change_deg)))
    return [
        f"At {brief(speed)} m/s{words.removeprefix('calm')} a course change of {_listed(changes)} deg does not settle within the run."
        for (words, speed), changes in groups.items()
    ]


def _of_weather(runs: Sequence[CourseChange], what: str) -> list[str]:
    missed = [s.weather.removeprefix("weather from ") for s in runs if s.cross_track_m is None]
    return [f"{what} in weather from {_listed(missed)} ({len(missed)} of {len(runs)} directions)."] if missed else []


def _listed(names: Iterable[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} or {last}" if first else last
