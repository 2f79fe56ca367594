"""A judged autopilot as the page shows it: words first, then tables and charts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

import shipid
from shipid.autopilot.course_changes.course_changes import CourseChange
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.schedule import GAINS
from shipid.autopilot.judgement.judgement import LIMITS, SAMPLE_CHANGE, Judgement, Weakest
from shipid.autopilot.on_board.on_board_runs import OnBoardRuns
from shipid.declaration.units import pretty
from shipid.foundation.aliases import Plain
from shipid.report.figures.tuning import design_figures, tuning_figures
from shipid.report.typography.numbers import fixed, number

#: Warnings that begin so stand in red: they say that the design may not hold.
_GRAVE = ("unstable draws", "disk margin", "outside the identified range", "lost", "rudder rate", "negative rate gain",
          "on board")  # fmt: skip
_ADVICE = {
    "disk margin": "A lower natural frequency or more trials of this ship raise it.",
    "gain margin": "A lower natural frequency raises it.",
    "phase margin": "A lower natural frequency or a higher damping raises it.",
    "overshoot": "A higher damping lowers it.",
    "steady error in wind": "An integral (--design pid) takes it out.",
    "course change": "A smaller rudder limit keeps the ship within what its model describes.",
}
_DESIGNS = {
    "pole": "poles placed",
    "lqr": "least cost of heading error and rudder",
    "pid": "poles placed, with an integral",
}


#: The control law of each mode as the page writes it.
_LAWS = {
    "course": "Kp (heading ordered − heading) − Kd rate of turn",
    "rate": "Kd (rate of turn ordered − rate of turn) + Kp integral of (rate of turn ordered − rate of turn)",
}
#: Said instead of a judgement.
NOT_JUDGED = "The design was not judged: margins, robustness and course changes are those of shipid.judge, which was not asked for."


@dataclass(frozen=True, eq=False)
class TuningView:
    """Everything the template of one tuning reads; see the template for where it stands."""

    title: str
    answer: list[str]
    warnings: list[str]
    cautions: list[str]
    law: str
    schedules: list[dict[str, Plain]]
    judged: dict[str, Plain] | None
    figures: dict[str, Markup]
    ship: str
    model: str
    facts: list[tuple[str, str]]
    version: str


def tuning_view(judged: Judgement) -> TuningView:
    """Return what the page says of a judged autopilot.

    Parameters
    ----------
    judged : Judgement
        The design and its judgement.
    """
    conditions = range(len(judged.pilot.ships))
    parts = {
        "margins": [_margins(judged, j) for j in conditions],
        "limits": {n: number(v, 2) for n, v in LIMITS.items()},
        "points": [_point(w) for w in _worst_of_each(judged)],
        "robust": [_robust(judged, j) for j in conditions],
        "steps": _steps(judged),
        "weather": _weather(judged),
        "on_board": None if judged.on_board is None else _on_board(judged.on_board),
    }
    return _view(judged.pilot, answer(judged), judged.warnings, parts, tuning_figures(judged))


def design_view(pilot: Autopilot) -> TuningView:
    """Return what the page says of an autopilot that was not judged.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    """
    return _view(pilot, [_what(pilot), NOT_JUDGED], pilot.warnings, None, design_figures(pilot))


def _view(
    pilot: Autopilot,
    words: list[str],
    warnings: Sequence[str],
    judged: dict[str, Plain] | None,
    figures: dict[str, Markup],
) -> TuningView:
    grave = [w for w in warnings if w.startswith(_GRAVE)]
    return TuningView(
        title=f"Autopilot of {pilot.ship.name}, tuned with model {pilot.model.name}",
        answer=words,
        warnings=grave,
        cautions=[w for w in warnings if w not in grave],
        law=_LAWS[pilot.mode]
        + (" + Ki integral of (heading ordered − heading)" if "Ki" in pilot.schedule.gains else ""),
        schedules=[_schedule(pilot, j) for j in range(len(pilot.ships))],
        judged=judged,
        figures=figures,
        ship=pilot.ship.name + (f" ({pilot.ship.title})" if pilot.ship.title else ""),
        model=pilot.model.name,
        facts=_facts(pilot),
        version=shipid.__version__,
    )


def _what(pilot: Autopilot) -> str:
    first, last = pilot.speeds[0], pilot.speeds[-1]
    speeds = f"{first:.3g} to {last:.3g} m/s" if len(pilot.speeds) > 1 else f"{first:.3g} m/s"
    kind = "heading" if pilot.mode == "course" else "rate-of-turn"
    return f"A {kind} autopilot for {pilot.ship.name} from {speeds}: {_DESIGNS[pilot.design]}."


def answer(judged: Judgement) -> list[str]:
    """Return the paragraph that comes first, a sentence an entry.

    Parameters
    ----------
    judged : Judgement
        The design and its judgement.
    """
    pilot, weakest = judged.pilot, judged.weakest
    sentences = [_what(pilot)]
    own = [s for s in judged.steps if s.change_deg == SAMPLE_CHANGE and abs(s.speed - pilot.service_speed) < 1e-6]
    if own and own[0].overshoot_deg is not None and own[0].settling_s is not None:
        sentences.append(
            f"A course change of {SAMPLE_CHANGE:.0f} degrees at {own[0].speed:.3g} m/s settles in {own[0].settling_s:.0f} s with "
            f"an overshoot of {fixed(own[0].overshoot_deg, 1)} degrees."
        )
    sentences.append(
        weakest.sentence + (f" {_ADVICE[weakest.what]}" if weakest.share < 1 and weakest.what in _ADVICE else "")
    )
    for name, robust in zip(pilot.conditions, judged.robust):
        load = f" ({name})" if len(pilot.conditions) > 1 else ""
        if robust.samples:
            below = f", below {LIMITS['disk margin']:g}" if robust.disk_worst < LIMITS["disk margin"] else ""
            sentences.append(
                f"Over {robust.samples} ships drawn from {robust.source}{load}, the disk margin is never less than "
                f"{robust.disk_worst:.2g}{below}."
            )
        else:
            sentences.append(
                f"What the uncertainty of the ship{load} leaves of the margins is not known; of the ship as it is the least disk "
                f"margin is {robust.disk_worst:.2g}"
                + (", below 0.5." if robust.disk_worst < LIMITS["disk margin"] else ".")
            )
    return sentences


def _facts(pilot: Autopilot) -> list[tuple[str, str]]:
    names = {"omega_n": ("Natural frequency at the ship's own speed", "rad/s"), "damping": ("Damping ratio", ""),
             "integral": ("Third pole over the natural frequency", ""), "rudder_weight": ("Weight of the rudder", "")}  # fmt: skip
    found = [("Design", _DESIGNS[pilot.design])]
    found += [(names[n][0], f"{number(v, 4)} {names[n][1]}".strip()) for n, v in pilot.request.items()]
    found.append(("Ship's own speed", f"{number(pilot.service_speed, 4)} m/s"))
    found.append(("Rudder limit of the autopilot", f"{fixed(np.rad2deg(pilot.rudder_limit), 1)} deg"))
    found.append(("Largest rudder angle", f"{fixed(np.rad2deg(pilot.limits['delta_max']), 1)} deg"))
    found.append(("Largest rudder rate", f"{fixed(np.rad2deg(pilot.limits['delta_rate']), 2)} deg/s"))
    return [*found, ("Steering machine", pilot.actuator.__name__)]


def _schedule(pilot: Autopilot, condition: int) -> dict[str, Plain]:
    rows = []
    for i, speed in enumerate(pilot.speeds):
        gains = [number(table[condition][i], 4) for table in pilot.schedule.gains.values()]
        rows.append({"speed": fixed(speed, 2), "gains": gains, "poles": _poles(pilot.poles[condition][i])})
    heads = [f"{n} [{pretty(GAINS[n][0])}]" if pretty(GAINS[n][0]) != "1" else n for n in pilot.schedule.gains]
    return {"name": pilot.conditions[condition], "heads": heads, "rows": rows}


def _poles(poles: np.ndarray) -> str:
    """Pairs by frequency and damping, real poles as they are."""
    words = []
    for p in poles:
        if abs(p.imag) <= 1e-9 * abs(p):
            words.append(number(p.real, 3))
        elif p.imag > 0:
            words.append(f"ω {number(abs(p), 3)}, ζ {fixed(-p.real / abs(p), 2)}")
    return "; ".join(words)


def _margins(judged: Judgement, condition: int) -> dict[str, Plain]:
    rows = []
    both = [(m, "") for m in judged.margins[condition]] + [(m, "between") for m in judged.between[condition]]
    for m, place in sorted(both, key=lambda b: b[0].speed):
        gain = " / ".join("none" if g is None else number(g, 3) for g in (m.gain_low, m.gain_high))
        rows.append(
            {
                "speed": fixed(m.speed, 2),
                "between": bool(place),
                "disk": fixed(m.disk, 2),
                "weak": m.disk < LIMITS["disk margin"],
                "gain": gain,
                "phase": "none" if m.phase_deg is None else fixed(m.phase_deg, 0),
                "delay": "none" if m.delay_s is None else number(m.delay_s, 3),
                "bandwidth": "none" if m.bandwidth is None else number(m.bandwidth, 3),
                "sensitivity": fixed(m.sensitivity, 2),
                "complementary": fixed(m.complementary, 2),
            }
        )
    return {"name": judged.pilot.conditions[condition], "rows": rows}


def _worst_of_each(judged: Judgement) -> list[Weakest]:
    worst: dict[tuple[str, bool], Weakest] = {}
    for point in judged.points():
        key = (point.what, "uncertainty" in point.where)
        if key not in worst or point.share < worst[key].share:
            worst[key] = point
    return sorted(worst.values(), key=lambda w: w.share)


def _point(w: Weakest) -> dict[str, Plain]:
    return {"what": w.what, "where": w.where, "value": number(w.value, 3), "limit": number(w.limit, 3), "unit": w.unit,
            "within": w.share >= 1}  # fmt: skip


def _robust(judged: Judgement, condition: int) -> dict[str, Plain]:
    robust = judged.robust[condition]
    overshoot = [_or(v, lambda x: fixed(x, 2)) for v in robust.overshoot_deg]
    settling = [_or(v, lambda x: fixed(x, 0)) for v in robust.settling_s]
    return {
        "name": judged.pilot.conditions[condition],
        "samples": robust.samples,
        "source": robust.source,
        "worst": fixed(robust.disk_worst, 2),
        "low": fixed(robust.disk_low, 2),
        "speed": fixed(robust.speed_worst, 2),
        "unstable": robust.unstable,
        "overshoot": overshoot,
        "settling": settling,
        "change": fixed(robust.sample_change_deg, 0),
        "variants": [
            {
                "name": name,
                "disk": _or(v["disk"], lambda x: fixed(x, 2)),
                "overshoot": _or(v["overshoot_deg"], lambda x: fixed(x, 2)),
                "settling": _or(v["settling_s"], lambda x: fixed(x, 0)),
            }
            for name, v in robust.variants.items()
        ],
    }


def _or(value: float | None, show: Callable[[float], str]) -> str:
    return "not reached" if value is None else show(value)


def _steps(judged: Judgement) -> dict[str, Plain]:
    groups: dict[tuple[str, float], list[CourseChange]] = {}
    for s in judged.steps:
        groups.setdefault((s.weather, s.speed), []).append(s)
    columns = [f"{fixed(speed, 2)} m/s" + (f", {words[6:]}" if words != "calm" else "") for words, speed in groups]
    changes = sorted({s.change_deg for s in judged.steps})
    rows = []
    for change in changes:
        cells = []
        for group in groups.values():
            s = next(x for x in group if x.change_deg == change)
            lost = "ran away" if s.lost else None
            cells += [
                lost or _or(s.overshoot_deg, lambda x: fixed(x, 2)),
                lost or _or(s.settling_s, lambda x: fixed(x, 0)),
            ]
        rows.append({"change": fixed(change, 0), "cells": cells})
    return {"columns": columns, "rows": rows}


def _weather(judged: Judgement) -> dict[str, Plain]:
    w = judged.weather
    head = (
        f"Wind {number(w['wind_m_s'], 2)} m/s and waves at {number(w['wave_frequency_rad_s'], 2)} rad/s that yaw a ship at rest by "
        f"{number(w['wave_heading_rms_deg'], 2)} deg rms, both from one side; current {number(w['current_m_s'], 2)} m/s across. "
        "In proportion to the length of the ship below 100 m. The sea filter is on, a notch at the frequency of encounter."
    )

    def rows(changing: bool) -> list[dict[str, str]]:
        return [
            {
                "weather": s.weather.removeprefix("weather from "),
                "rms": _or(s.rms_error_deg, lambda x: fixed(x, 2)),
                "mean": _or(s.mean_error_deg, lambda x: fixed(x, 2, sign=True)),
                "overshoot": _or(s.overshoot_deg, lambda x: fixed(x, 2)),
                "rudder": _or(s.rms_rudder_deg, lambda x: fixed(x, 2)),
                "reversals": _or(s.reversals, lambda x: fixed(x, 1)),
                "track": _or(s.cross_track_m, lambda x: number(x, 3)),
            }
            for s in judged.in_weather
            if bool(s.change_deg) == changing and s.sea_filter
        ]

    raw = [s for s in judged.in_weather if not s.sea_filter]
    without = [max((getattr(s, n) or 0.0 for s in raw), default=0.0) for n in ("rms_rudder_deg", "reversals")]
    words = (
        f"Without the sea filter the rms rudder is {fixed(without[0], 2)} deg at worst, with {fixed(without[1], 1)} reversals a "
        "minute at worst."
    )
    return {
        "without": words,
        "head": head,
        "kept": rows(False),
        "turned": rows(True),
        "change": fixed(SAMPLE_CHANGE, 0),
    }


def _on_board(found: OnBoardRuns) -> dict[str, Plain]:
    adapted = {
        "none": "the gains are those of the schedule",
        "gains": "by the filter the gains are adapted to the ship it estimates",
        "reference": "by the filter the gains are those of a reference that follows the ship it estimates, and rudder compensates the difference",
    }
    sensors = ", ".join(f"{n} {level}" for n, level in found.sensors.items())
    return {
        "head": (
            f"Course changes one after the other, with a sample every {number(found.interval, 3)} s: by the instruments ({sensors}), "
            f"and by the Kalman filter {found.kalman}; {adapted[found.adaptation]}."
        ),
        "rows": [
            {
                "feedback": run.feedback,
                "weather": run.weather,
                "change": fixed(c.change_deg, 0),
                "overshoot": "ran away"
                if c.lost
                else _or(c.overshoot_deg, lambda x: fixed(x, 2))
                if c.change_deg
                else "",
                "settling": _or(c.settling_s, lambda x: fixed(x, 0)) if c.change_deg and run.weather == "calm" else "",
                "rms": _or(c.rms_error_deg, lambda x: fixed(x, 2)),
                "rudder": _or(c.rms_rudder_deg, lambda x: fixed(x, 2)),
                "reversals": _or(c.reversals, lambda x: fixed(x, 1)),
            }
            for run in found.runs
            for c in run.changes
        ],
    }
