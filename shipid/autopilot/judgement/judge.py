"""The judgement of an autopilot: every number of the report, computed in a few batches."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from shipid.autopilot.course_changes.course_changes import CourseChange
from shipid.autopilot.course_changes.run_course_changes import course_histories, ordering, run_course_changes
from shipid.autopilot.course_changes.weather import Weather, standard_weather
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import closed_loop, linear_ship
from shipid.autopilot.judgement.judgement import (
    SAMPLE_CHANGE,
    SHOWN_CHANGES,
    Judgement,
    LoopResponse,
)
from shipid.autopilot.judgement.limits import stated_limits
from shipid.autopilot.judgement.margins import Margins, loop_polynomials, margins_at
from shipid.autopilot.judgement.robust_margins import Robustness
from shipid.autopilot.judgement.robustness import robustness_of
from shipid.autopilot.on_board.on_board_runs import OnBoardRuns
from shipid.declaration.guard import NOT_SAILED
from shipid.foundation.errors import UsageError
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief
from shipid.parameters.draws import draw_coefficients

#: Course changes at the slowest, the ship's own and the fastest speed.
CHANGES = (5.0, 10.0, 20.0, 45.0, 60.0, 90.0, 120.0)
#: Directions the weather goes to, from the course, in degrees; in words of where it comes from.
_FROM = {0.0: "astern", 45.0: "the port quarter", 90.0: "port", 135.0: "the port bow", 180.0: "ahead",
         225.0: "the starboard bow", 270.0: "starboard", 315.0: "the starboard quarter"}  # fmt: skip
#: Weather is measured after this many L/u.
_BEGUN = 45.0


def judge(
    pilot: Autopilot,
    samples: int = 200,
    seed: int = 0,
    *,
    weather: Weather | None = None,
    limits: Mapping[str, str | float] | None = None,
    on_board: OnBoardRuns | None = None,
    progress: Callable[[str], object] | None = None,
) -> Judgement:
    """Judge a design at and between its speeds, over the uncertainty of the ship, and in course changes.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    samples : int
        Draws of the ship's coefficients.
    seed : int
        Of the draws and of the waves.
    weather : Weather, optional
        Wind, waves and current; by default `shipid.autopilot.course_changes.weather.standard_weather` of a ship of this length.
    limits : mapping of str to str or float, optional
        Limits that replace some of `shipid.autopilot.judgement.limits.LIMITS`: ``{"disk margin": 0.6, "phase margin": "40 deg"}``.
    on_board : OnBoardRuns, optional
        Runs of this autopilot with its Kalman filter (`shipid.run_on_board`), to be reported with the judgement.
    progress : callable, optional
        Called with a line of text before each part.

    Returns
    -------
    Judgement

    Raises
    ------
    UsageError
        If it is no autopilot, or a limit is out of range.
    UnknownNameError
        If there is no limit of a name.
    UnstatedInputError
        If the model reads an input that the course changes do not state and that declares no default.
    """
    if not isinstance(pilot, Autopilot):
        raise UsageError(
            f"an autopilot is what shipid.design_autopilot or shipid.read_schedule returns, not a {type(pilot).__name__}."
        )
    tell = progress or (lambda _: None)
    kept_to = stated_limits(limits or {})
    sea = weather or standard_weather(pilot.length, pilot.service_speed)
    speeds = pilot.speeds
    middles = 0.5 * (speeds[:-1] + speeds[1:])
    margins, between, robust, warnings = [], [], [], list(pilot.warnings)
    drawn_histories: Mapping[str, np.ndarray] = {}
    for j in range(len(pilot.ships)):
        tell("margins")
        margins.append(_margins(pilot, speeds, j))
        between.append(_margins(pilot, middles, j) if middles.size else ())
        tell("robustness")
        drawn = draw_coefficients(pilot.model, pilot.ships[j], max(samples, 1), seed)
        one, histories = robustness_of(
            pilot, drawn if samples and drawn.names else None, drawn.source, j, sea.wave_frequency
        )
        robust.append(one)
        drawn_histories = drawn_histories or histories
        warnings += _about(pilot, one, j, kept_to)
    tell("course changes")
    steps = _steps(pilot)
    tell("wind and waves")
    in_weather, words = _in_weather(pilot, seed, sea)
    lost = sorted({abs(s.change_deg) for s in steps if s.lost})
    if lost:
        warnings.append(
            Notice(
                f"lost: course changes of {', '.join(brief(c) for c in lost)} deg with this rudder limit are {NOT_SAILED} "
                f"({pilot.model.name}): it runs away, or loses its way.",
                "not-sailed",
                serious=True,
            )
        )
    return Judgement(
        pilot=pilot,
        margins=tuple(margins),
        between=tuple(between),
        robust=tuple(robust),
        steps=steps,
        in_weather=in_weather,
        weather=sea.to_dict(),
        limits=kept_to,
        responses=_responses(pilot),
        histories=course_histories(pilot, [pilot.own_speed] * len(SHOWN_CHANGES), np.deg2rad(SHOWN_CHANGES).tolist()),
        drawn_histories=drawn_histories,
        on_board=on_board,
        warnings=tuple(dict.fromkeys(warnings + words + list(on_board.warnings if on_board else ()))),
    )


def _margins(pilot: Autopilot, speeds: np.ndarray, condition: int) -> tuple[Margins, ...]:
    plants = linear_ship(pilot, speeds, condition, steered=True)
    return tuple(
        margins_at(plants.at(i), pilot.gains(float(v), condition), float(v), pilot.pace(float(v)))
        for i, v in enumerate(speeds)
    )


def _responses(pilot: Autopilot) -> tuple[LoopResponse, ...]:
    """The loop against frequency at the slowest, the ship's own and the fastest speed of the schedule."""
    places = sorted({0, int(np.abs(pilot.speeds - pilot.service_speed).argmin()), len(pilot.speeds) - 1})
    found = []
    for speed in pilot.speeds[places].tolist():
        plant = linear_ship(pilot, [speed], steered=True).at(0)
        numerator, denominator = loop_polynomials(plant, pilot.gains(speed))
        omega = pilot.pace(speed) * np.geomspace(0.05, 500, 600)
        response = np.polyval(numerator, 1j * omega) / np.polyval(denominator, 1j * omega)
        found.append(LoopResponse(speed, omega, response))
    return tuple(found)


def _steps(pilot: Autopilot) -> tuple[CourseChange, ...]:
    speeds = sorted({float(pilot.speeds[0]), pilot.own_speed, float(pilot.speeds[-1])})
    found: list[CourseChange] = []
    for j in range(len(pilot.ships)):
        grid = [(v, c) for v in speeds for c in CHANGES]
        runs = run_course_changes(pilot, [v for v, _ in grid], np.deg2rad([c for _, c in grid]), condition=j)
        words = "calm" if len(pilot.ships) == 1 else f"calm, {pilot.conditions[j]}"
        found += [runs.one(i, words) for i in range(len(grid))]
    return tuple(found)


def _in_weather(pilot: Autopilot, seed: int, weather: Weather) -> tuple[tuple[CourseChange, ...], list[str]]:
    directions = np.deg2rad(list(_FROM))
    words = []
    if "r_disturbance" not in pilot.model.inputs:
        words.append(f"no wind: model {pilot.model.name} reads no 'r_disturbance', so wind does not act on it here.")
    elif pilot.ship.find(closed_loop(pilot, *ordering(pilot), *weather.components(pilot.model)), "N_w") is None:
        words.append(
            f"assumed: ship {pilot.ship.name} states no wind coefficients; those of a ship of its length are used, and the "
            "results in wind are only of that order."
        )
    speeds, change = np.full(8, pilot.own_speed), np.deg2rad(SAMPLE_CHANGE)
    kept, raw = (
        run_course_changes(
            pilot, speeds, np.zeros(8), weather=weather, headings=directions, measured_from=_BEGUN, lengths=2 * _BEGUN,
            seed=seed, filtered=filtered,
        )
        for filtered in (True, False)
    )  # fmt: skip
    turned = run_course_changes(
        pilot, speeds, np.full(8, change), weather=weather, headings=directions, seed=seed, filtered=True
    )
    found = []
    for runs, filtered, ahead in ((kept, True, 0.0), (raw, False, 0.0), (turned, True, change)):
        met = weather.encounter(speeds, directions - ahead) * 60 / (2 * np.pi)
        found += [
            replace(runs.one(i, f"weather from {w}", filtered), waves_met=float(met[i]))
            for i, w in enumerate(_FROM.values())
        ]
    return tuple(found), words


def _about(pilot: Autopilot, robust: Robustness, condition: int, limits: Mapping[str, float]) -> list[str]:
    found, ship = [], pilot.conditions[condition]
    if not robust.samples:
        found.append(f"no uncertainty: {robust.source}, so the robustness of the design is not known.")
    if robust.unstable:
        words = (
            f"unstable draws: with {robust.unstable} of {robust.samples} draws of ship {ship} the loop is unstable. The trials do "
            "not determine this ship well enough for this design."
            if robust.samples
            else f"unstable: the loop of ship {ship} is unstable at {brief(robust.speed_worst)} m/s."
        )
        found.append(Notice(words, "unstable", serious=True))
    if robust.disk_worst < limits["disk margin"]:
        over = "over the uncertainty of the ship" if robust.samples else "of the design"
        found.append(
            f"disk margin: the least {over} is {brief(robust.disk_worst)} at {brief(robust.speed_worst)} m/s, below "
            f"{limits['disk margin']:g}."
        )
    filtered = robust.variants["sea filter on"]["disk"]
    if filtered is not None and filtered < limits["disk margin"]:
        found.append(
            f"sea filter: while it is on, the least disk margin is {brief(filtered)}, below {limits['disk margin']:g}; a lower natural "
            "frequency raises it."
        )
    return found
