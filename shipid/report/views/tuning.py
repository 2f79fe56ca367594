"""A judged autopilot as the page shows it: words first, then tables and charts."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from markupsafe import Markup

import shipid
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.schedule import GAINS
from shipid.autopilot.judgement.judge import SAMPLE_CHANGE
from shipid.autopilot.judgement.judgement import LIMITS, CourseChange, Judgement, Weakest
from shipid.autopilot.judgement.margins import Margins
from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import to_display
from shipid.foundation.numbers import fixed, number
from shipid.report.figures.tuning import tuning_figures
from shipid.report.page import Page, Row, Section
from shipid.report.views.words import sentence

#: Warnings that begin so stand in red: they say that the design may not hold.
_GRAVE = ("unstable draws", "disk margin", "outside the identified range", "lost", "rudder rate", "negative rate gain")
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


#: The sections of the page, in order. A new one is a line here and a template.
SECTIONS: list[Callable[[Judgement, Mapping[str, Markup]], Section]] = [
    lambda judged, _: _points(judged),
    lambda judged, figures: _schedules(judged, figures),
    lambda judged, figures: _margins(judged, figures),
    lambda judged, figures: _robustness(judged, figures),
    lambda judged, figures: _steps(judged, figures),
    lambda judged, _: _weather(judged),
    lambda judged, _: _method(judged),
]


def tuning_page(judged: Judgement) -> Page:
    """Return what the page says of a judged autopilot.

    Parameters
    ----------
    judged : Judgement
        The design and its judgement.
    """
    pilot, figures = judged.pilot, tuning_figures(judged)
    grave = [w for w in judged.warnings if w.startswith(_GRAVE)]
    return Page(
        f"Autopilot of {pilot.ship.name}, tuned with model {pilot.model.name}",
        [("", answer(judged))],
        [section(judged, figures) for section in SECTIONS],
        [sentence(w) for w in grave],
        [sentence(w) for w in judged.warnings if w not in grave],
        f"shipid {shipid.__version__}",
    )


def answer(judged: Judgement) -> list[str]:
    """Return the paragraph that comes first, a sentence an entry.

    Parameters
    ----------
    judged : Judgement
        The design and its judgement.
    """
    pilot, weakest = judged.pilot, judged.weakest
    speeds = (
        f"{pilot.speeds[0]:.3g} to {pilot.speeds[-1]:.3g} m/s"
        if len(pilot.speeds) > 1
        else f"{pilot.speeds[0]:.3g} m/s"
    )
    sentences = [f"A heading autopilot for {pilot.ship.name} from {speeds}: {_DESIGNS[pilot.design]}."]
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


def _name(pilot: Autopilot, condition: int) -> str:
    """The load condition, where there are several."""
    return pilot.conditions[condition] if len(pilot.conditions) > 1 else ""


def _points(judged: Judgement) -> Section:
    worst: dict[tuple[str, bool], Weakest] = {}
    for point in judged.points():
        key = (point.what, "uncertainty" in point.where)
        if key not in worst or point.share < worst[key].share:
            worst[key] = point
    rows = [
        {
            "what": sentence(w.what),
            "where": w.where,
            "value": number(w.value, 3),
            "limit": number(w.limit, 3),
            "unit": w.unit,
            "within": w.share >= 1,
        }
        for w in sorted(worst.values(), key=lambda w: w.share)
    ]
    return Section("Weak points", "tuning/points.html", {"points": rows})


def _schedules(judged: Judgement, figures: Mapping[str, Markup]) -> Section:
    pilot = judged.pilot
    gains = [
        (f"{n} [{pretty(GAINS[n][0])}]" if pretty(GAINS[n][0]) != "1" else n, n, "n") for n in pilot.schedule.gains
    ]
    schedules = [
        {
            "name": _name(pilot, j),
            "rows": [
                {
                    "speed": fixed(speed, 2),
                    "poles": _poles(pilot.poles(float(speed), j)),
                    **{n: number(table[j][i], 4) for n, table in pilot.schedule.gains.items()},
                }
                for i, speed in enumerate(pilot.speeds)
            ],
        }
        for j in range(len(pilot.ships))
    ]
    view = {
        "schedules": schedules,
        "gains": gains,
        "integral": "Ki" in pilot.schedule.gains,
        "figure": figures["schedule"],
    }
    return Section("Schedule", "tuning/schedule.html", view)


def _poles(poles: np.ndarray) -> str:
    """Pairs by frequency and damping, real poles as they are."""
    words = []
    for p in poles:
        if abs(p.imag) <= 1e-9 * abs(p):
            words.append(number(p.real, 3))
        elif p.imag > 0:
            words.append(f"ω {number(abs(p), 3)}, ζ {fixed(-p.real / abs(p), 2)}")
    return "; ".join(words)


def _margins(judged: Judgement, figures: Mapping[str, Markup]) -> Section:
    pilot = judged.pilot
    margins = []
    for j in range(len(pilot.ships)):
        both = [*((m, False) for m in judged.margins[j]), *((m, True) for m in judged.between[j])]
        rows = [_margin_row(m, between) for m, between in sorted(both, key=lambda b: b[0].speed)]
        margins.append({"name": _name(pilot, j), "rows": rows})
    view = {
        "limit": number(LIMITS["disk margin"], 2),
        "margins": margins,
        "figure": figures["margins"],
        "nyquist": figures["nyquist"],
    }
    return Section("Margins", "tuning/margins.html", view)


def _margin_row(m: Margins, between: bool) -> Row:
    disk = fixed(m.disk, 2)
    return {
        "class": "own" if between else "",
        "speed": fixed(m.speed, 2),
        "disk": Markup('<span class="no">{}</span>').format(disk) if m.disk < LIMITS["disk margin"] else disk,
        "gain": " / ".join("none" if g is None else number(g, 3) for g in (m.gain_low, m.gain_high)),
        "phase": "none" if m.phase_deg is None else fixed(m.phase_deg, 0),
        "delay": "none" if m.delay_s is None else number(m.delay_s, 3),
        "bandwidth": "none" if m.bandwidth is None else number(m.bandwidth, 3),
        "sensitivity": fixed(m.sensitivity, 2),
        "complementary": fixed(m.complementary, 2),
    }


def _robustness(judged: Judgement, figures: Mapping[str, Markup]) -> Section:
    conditions = [
        {
            "name": _name(judged.pilot, j),
            "samples": robust.samples,
            "source": robust.source,
            "worst": fixed(robust.disk_worst, 2),
            "low": fixed(robust.disk_low, 2),
            "speed": fixed(robust.speed_worst, 2),
            "unstable": robust.unstable,
            "overshoot": [_reached(v, 2) for v in robust.overshoot_deg],
            "settling": [_reached(v, 0) for v in robust.settling_s],
            "change": fixed(robust.sample_change_deg, 0),
            "variants": [
                {
                    "name": sentence(name),
                    "disk": _reached(v["disk"], 2),
                    "overshoot": _reached(v["overshoot_deg"], 2),
                    "settling": _reached(v["settling_s"], 0),
                }
                for name, v in robust.variants.items()
            ],
        }
        for j, robust in enumerate(judged.robust)
    ]
    view = {"conditions": conditions, "figure": figures.get("cloud")}
    return Section("Robustness", "tuning/robustness.html", view)


def _reached(value: float | None, decimals: int) -> str:
    return "not reached" if value is None else fixed(value, decimals)


def _steps(judged: Judgement, figures: Mapping[str, Markup]) -> Section:
    groups: dict[tuple[str, float], dict[float, CourseChange]] = {}
    for s in judged.steps:
        groups.setdefault((s.weather, s.speed), {})[s.change_deg] = s
    columns = [f"{fixed(speed, 2)} m/s" + (f", {words[6:]}" if words != "calm" else "") for words, speed in groups]
    rows = [
        {"change": fixed(change, 0), "cells": [c for group in groups.values() for c in _step_cells(group[change])]}
        for change in sorted({s.change_deg for s in judged.steps})
    ]
    view = {"columns": columns, "rows": rows, "figure": figures["steps"]}
    return Section("Course changes", "tuning/steps.html", view)


def _step_cells(s: CourseChange) -> tuple[str, str]:
    if s.lost:
        return "ran away", "ran away"
    return _reached(s.overshoot_deg, 2), _reached(s.settling_s, 0)


def _weather(judged: Judgement) -> Section:
    w = judged.weather
    head = (
        f"Wind {number(w['wind_m_s'], 2)} m/s and waves at {number(w['wave_frequency_rad_s'], 2)} rad/s that yaw a ship at rest by "
        f"{number(w['wave_heading_rms_deg'], 2)} deg rms, both from one side; current {number(w['current_m_s'], 2)} m/s across. "
        "In proportion to the length of the ship below 100 m. The sea filter is on, a notch at the frequency of encounter."
    )
    raw = [s for s in judged.weathered if not s.sea_filter]
    without = [max((getattr(s, n) or 0.0 for s in raw), default=0.0) for n in ("rms_rudder_deg", "reversals")]
    words = (
        f"Without the sea filter the rms rudder is {fixed(without[0], 2)} deg at worst, with {fixed(without[1], 1)} reversals a "
        "minute at worst."
    )
    filtered = [s for s in judged.weathered if s.sea_filter]
    view = {
        "head": head,
        "without": words,
        "kept": [_weather_row(s) for s in filtered if not s.change_deg],
        "turned": [_weather_row(s) for s in filtered if s.change_deg],
        "change": fixed(SAMPLE_CHANGE, 0),
    }
    return Section("Wind, waves and current", "tuning/weather.html", view, short="Wind and waves")


def _weather_row(s: CourseChange) -> Row:
    return {
        "weather": s.weather.removeprefix("weather from "),
        "rms": _reached(s.rms_error_deg, 2),
        "mean": "not reached" if s.mean_error_deg is None else fixed(s.mean_error_deg, 2, sign=True),
        "overshoot": _reached(s.overshoot_deg, 2),
        "rudder": _reached(s.rms_rudder_deg, 2),
        "reversals": _reached(s.reversals, 1),
        "track": "not reached" if s.cross_track_m is None else number(s.cross_track_m, 3),
    }


def _method(judged: Judgement) -> Section:
    pilot = judged.pilot
    names = {"omega_n": ("Natural frequency at the ship's own speed", "rad/s"), "damping": ("Damping ratio", ""),
             "integral": ("Third pole over the natural frequency", ""), "rudder_weight": ("Weight of the rudder", "")}  # fmt: skip
    facts = {
        "Design": _DESIGNS[pilot.design],
        **{names[n][0]: f"{number(v, 4)} {names[n][1]}".strip() for n, v in pilot.request.items()},
        "Ship's own speed": f"{number(pilot.service_speed, 4)} m/s",
        "Rudder limit of the autopilot": f"{fixed(to_display(pilot.rudder_limit, 'delta'), 1)} deg",
        "Largest rudder angle": f"{fixed(to_display(pilot.limits['delta_max'], 'delta'), 1)} deg",
        "Largest rudder rate": f"{fixed(to_display(pilot.limits['delta_rate'], '', 'rad/s'), 2)} deg/s",
        "Steering machine": pilot.actuator.__name__,
    }
    view = {
        "ship": pilot.ship.name + (f" ({pilot.ship.title})" if pilot.ship.title else ""),
        "model": pilot.model.name,
        "facts": [{"name": name, "value": value} for name, value in facts.items()],
    }
    return Section("Method", "tuning/method.html", view)
