"""A judged autopilot as the page shows it: words first, then tables and charts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

import shipid
from shipid.autopilot.comparing import TuningComparison
from shipid.autopilot.judgement import LIMITS, CourseChange, Judgement
from shipid.autopilot.judging import SAMPLE_CHANGE, histories
from shipid.autopilot.margins import loop_polynomials
from shipid.autopilot.schedule import GAINS
from shipid.declaration.units import pretty
from shipid.report.charts import Axes, Line, chart, nyquist
from shipid.report.numbers import fixed, number

#: Warnings that begin so stand in red: they say that the design may not hold.
_GRAVE = ("unstable draws", "disk margin", "outside the identified range", "lost", "rudder rate", "negative rate gain")
#: Course changes shown against time.
_SHOWN = (10.0, 60.0, 120.0)
_ADVICE = {
    "disk margin": "A lower natural frequency or more trials of this ship raise it.",
    "gain margin": "A lower natural frequency raises it.",
    "phase margin": "A lower natural frequency or a higher damping raises it.",
    "overshoot": "A higher damping lowers it.",
    "steady error in wind": "An integral (--design pid) takes it out.",
    "course change": "A smaller rudder limit keeps the ship within what its model describes.",
}
#: Unit of a gain in a figure, whose numbers have two decimals, and the factor to it.
_GAIN_UNITS = {"Kp": ("", 1.0), "Kd": ("s", 1.0), "Ki": ("1/1000 s", 1000.0)}
_DESIGNS = {
    "pole": "poles placed",
    "lqr": "least cost of heading error and rudder",
    "pid": "poles placed, with an integral",
}


@dataclass(frozen=True, eq=False)
class TuningView:
    """Everything the template of one tuning reads; see the template for where it stands."""

    title: str
    answer: list[str]
    warnings: list[str]
    cautions: list[str]
    schedules: list[dict[str, Any]]
    margins: list[dict[str, Any]]
    limits: dict[str, str]
    points: list[dict[str, Any]]
    robust: list[dict[str, Any]]
    steps: dict[str, Any]
    weather: dict[str, Any]
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
    pilot = judged.pilot
    grave = [w for w in judged.warnings if w.startswith(_GRAVE)]
    return TuningView(
        title=f"Autopilot of {pilot.ship.name}, tuned with model {pilot.model.name}",
        answer=answer(judged),
        warnings=grave,
        cautions=[w for w in judged.warnings if w not in grave],
        schedules=[_schedule(judged, j) for j in range(len(pilot.ships))],
        margins=[_margins(judged, j) for j in range(len(pilot.ships))],
        limits={n: number(v, 2) for n, v in LIMITS.items()},
        points=[_point(w) for w in _worst_of_each(judged)],
        robust=[_robust(judged, j) for j in range(len(pilot.ships))],
        steps=_steps(judged),
        weather=_weather(judged),
        figures=_figures(judged),
        ship=pilot.ship.name + (f" ({pilot.ship.title})" if pilot.ship.title else ""),
        model=pilot.model.name,
        facts=_facts(judged),
        version=shipid.__version__,
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


def _facts(judged: Judgement) -> list[tuple[str, str]]:
    pilot = judged.pilot
    names = {"omega_n": ("Natural frequency at the ship's own speed", "rad/s"), "damping": ("Damping ratio", ""),
             "integral": ("Third pole over the natural frequency", ""), "rudder_weight": ("Weight of the rudder", "")}  # fmt: skip
    found = [("Design", _DESIGNS[pilot.design])]
    found += [(names[n][0], f"{number(v, 4)} {names[n][1]}".strip()) for n, v in pilot.request.items()]
    found.append(("Ship's own speed", f"{number(pilot.service_speed, 4)} m/s"))
    found.append(("Rudder limit of the autopilot", f"{fixed(np.rad2deg(pilot.rudder_limit), 1)} deg"))
    found.append(("Largest rudder angle", f"{fixed(np.rad2deg(pilot.limits['delta_max']), 1)} deg"))
    found.append(("Largest rudder rate", f"{fixed(np.rad2deg(pilot.limits['delta_rate']), 2)} deg/s"))
    return [*found, ("Steering machine", pilot.actuator.__name__)]


def _schedule(judged: Judgement, condition: int) -> dict[str, Any]:
    pilot = judged.pilot
    rows = []
    for i, speed in enumerate(pilot.speeds):
        gains = [number(table[condition][i], 4) for table in pilot.schedule.gains.values()]
        rows.append({"speed": fixed(speed, 2), "gains": gains, "poles": _poles(pilot.poles(float(speed), condition))})
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


def _margins(judged: Judgement, condition: int) -> dict[str, Any]:
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


def _worst_of_each(judged: Judgement) -> list[Any]:
    worst: dict[tuple[str, bool], Any] = {}
    for point in judged.points():
        key = (point.what, "uncertainty" in point.where)
        if key not in worst or point.share < worst[key].share:
            worst[key] = point
    return sorted(worst.values(), key=lambda w: w.share)


def _point(w: Any) -> dict[str, Any]:
    return {"what": w.what, "where": w.where, "value": number(w.value, 3), "limit": number(w.limit, 3), "unit": w.unit,
            "within": w.share >= 1}  # fmt: skip


def _robust(judged: Judgement, condition: int) -> dict[str, Any]:
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


def _or(value: float | None, show: Any) -> str:
    return "not reached" if value is None else str(show(value))


def _steps(judged: Judgement) -> dict[str, Any]:
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


def _weather(judged: Judgement) -> dict[str, Any]:
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
            for s in judged.weathered
            if bool(s.change_deg) == changing and s.sea_filter
        ]

    raw = [s for s in judged.weathered if not s.sea_filter]
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


def _figures(judged: Judgement) -> dict[str, Markup]:
    pilot = judged.pilot
    several = len(pilot.ships) > 1
    panels = [
        Axes(
            f"{n}, {GAINS[n][1]}",
            _GAIN_UNITS[n][0],
            [
                Line(pilot.conditions[j] if several else "", pilot.speeds, table[j] * _GAIN_UNITS[n][1], "points", j)
                for j in range(len(pilot.ships))
            ],
        )
        for n, table in pilot.schedule.gains.items()
    ]
    found = {"schedule": chart(panels, "speed [m/s]", "schedule", "Gains against speed")}
    found["margins"] = chart(_margin_axes(judged), "speed [m/s]", "margins", "Margins against speed, with their limits")
    found["nyquist"] = nyquist(_nyquist_lines(judged), LIMITS["disk margin"], "nyquist", "Nyquist curves of the loop")
    found["steps"] = chart(
        _step_axes([judged], [""]), "time [s]", "steps", "Course changes at the ship's own speed: heading and rudder"
    )
    cloud = judged.cloud
    if len(cloud["t"]) > 1:
        found["cloud"] = chart(
            _cloud_axes(cloud), "time [s]", "cloud", "Course changes of ships drawn from the uncertainty"
        )
    return found


def _margin_axes(judged: Judgement) -> list[Axes]:
    pilot = judged.pilot
    disk: list[Line] = []
    phase: list[Line] = []
    delay: list[Line] = []
    for j, name in enumerate(pilot.conditions):
        both = sorted((*judged.margins[j], *judged.between[j]), key=lambda m: m.speed)
        speeds = np.array([m.speed for m in both])
        load = f", {name}" if len(pilot.conditions) > 1 else ""
        disk.append(Line(f"as designed{load}", speeds, np.array([m.disk for m in both]), "line", 2 * j))
        robust = judged.robust[j]
        if robust.samples:
            by_speed = np.array(robust.disk_by_speed)
            disk.append(Line(f"worst of {robust.samples} draws{load}", pilot.speeds, by_speed, "dashed", 2 * j + 1))
        for values, lines in (([m.phase_deg for m in both], phase), ([m.delay_s for m in both], delay)):
            good = np.array([v is not None for v in values])
            lines.append(Line("", speeds[good], np.array([v for v in values if v is not None]), "line", 2 * j))
    ends = np.array([pilot.speeds[0], pilot.speeds[-1]])
    disk.append(Line("limit", ends, np.full(2, LIMITS["disk margin"]), "limit"))
    phase.append(Line("", ends, np.full(2, LIMITS["phase margin"]), "limit"))
    return [Axes("Disk margin", "", disk), Axes("Phase margin", "deg", phase), Axes("Delay margin", "s", delay)]


def _nyquist_lines(judged: Judgement) -> list[Line]:
    pilot = judged.pilot
    places = sorted({0, int(np.abs(pilot.speeds - pilot.service_speed).argmin()), len(pilot.speeds) - 1})
    lines = []
    for k, i in enumerate(places):
        speed = float(pilot.speeds[i])
        plant = pilot.plants(np.array([speed]), steered=True).at(0)
        numerator, denominator = loop_polynomials(plant, pilot.gains(speed))
        s = 1j * pilot.pace(speed) * np.geomspace(0.05, 500, 600)
        loop = np.polyval(numerator, s) / np.polyval(denominator, s)
        lines.append(Line(f"{speed:.3g} m/s", loop.real, loop.imag, "line", k))
    return lines


def _step_axes(judged: list[Judgement], names: list[str]) -> list[Axes]:
    heading: list[Line] = []
    rudder: list[Line] = []
    for k, (one, name) in enumerate(zip(judged, names)):
        pilot = one.pilot
        speed = float(np.clip(pilot.service_speed, pilot.speeds[0], pilot.speeds[-1]))
        shown = histories(pilot, [speed] * len(_SHOWN), [float(np.deg2rad(c)) for c in _SHOWN])
        last = _until(shown, np.deg2rad(_SHOWN))
        for i, change in enumerate(_SHOWN):
            t, psi, delta = (shown[n][i] for n in ("t", "psi", "delta"))
            kept = np.isfinite(psi) & (t <= last)
            colour, label = (k, name if i == 0 else "") if name else (i, f"{change:.0f} deg")
            look = "line" if k == 0 else "dashed"
            heading.append(Line(label, t[kept], np.rad2deg(psi[kept]), look, colour))
            rudder.append(Line("", t[kept], np.rad2deg(delta[kept]), look, colour))
    return [Axes("Heading", "deg", heading), Axes("Rudder", "deg", rudder)]


def _until(shown: dict[str, np.ndarray], changes: np.ndarray) -> float:
    """Until when a course change is worth showing: half as long again as the slowest takes."""
    last = 0.0
    for t, psi, change in zip(shown["t"], shown["psi"], changes):
        out = np.flatnonzero(~(np.abs(psi - change) < 0.01 * abs(change)))
        last = max(last, float(t[out[-1]]) if out.size else 0.0)
    return min(1.4 * last, float(shown["t"].max()))


def _cloud_axes(cloud: Any) -> list[Axes]:
    heading, rudder = [], []
    last = _until(dict(cloud), np.full(len(cloud["t"]), np.deg2rad(SAMPLE_CHANGE)))
    for k in (*range(1, len(cloud["t"])), 0):
        kept = np.isfinite(cloud["psi"][k]) & (cloud["t"][k] <= last)
        look, label = ("line", "as designed") if k == 0 else ("faint", "draws" if k == 1 else "")
        t = cloud["t"][k][kept]
        heading.append(Line(label, t, np.rad2deg(cloud["psi"][k][kept]), look))
        rudder.append(Line("", t, np.rad2deg(cloud["delta"][k][kept]), look))
    return [Axes("Heading", "deg", heading), Axes("Rudder", "deg", rudder)]


def comparison_view(found: TuningComparison) -> dict[str, Any]:
    """Return what the page says of two tunings side by side.

    Parameters
    ----------
    found : TuningComparison
        The comparison.
    """
    panels = [
        Axes(
            f"{n}, {GAINS[n][1]}",
            _GAIN_UNITS[n][0],
            [
                Line(name, j.pilot.speeds, j.pilot.schedule.gains[n][0] * _GAIN_UNITS[n][1], "points", k)
                for k, (name, j) in enumerate(zip(found.names, found.judged))
                if n in j.pilot.schedule.gains
            ],
        )
        for n in GAINS
        if any(n in j.pilot.schedule.gains for j in found.judged)
    ]
    disk = [
        Line(name, np.array([m.speed for m in j.margins[0]]), np.array([m.disk for m in j.margins[0]]), "points", k)
        for k, (name, j) in enumerate(zip(found.names, found.judged))
    ]
    speeds = np.array([min(line.x.min() for line in disk), max(line.x.max() for line in disk)])
    disk.append(Line("limit", speeds, np.full(2, LIMITS["disk margin"]), "limit"))
    return {
        "title": f"Two tunings: {found.names[0]} and {found.names[1]}",
        "names": found.names,
        "answers": [answer(j) for j in found.judged],
        "rows": [
            {
                "what": r.what[:1].upper() + r.what[1:],
                "unit": r.unit,
                "cells": [
                    {"text": "none" if v is None else number(v, 4), "better": r.better == k}
                    for k, v in enumerate(r.values)
                ],
            }
            for r in found.rows
        ],
        "warnings": found.warnings,
        "figures": {
            "schedule": chart(panels, "speed [m/s]", "schedule", "Gains of both against speed"),
            "margins": chart(
                [Axes("Disk margin", "", disk)], "speed [m/s]", "margins", "Disk margins of both against speed"
            ),
            "steps": chart(
                _step_axes(list(found.judged), list(found.names)),
                "time [s]",
                "steps",
                "Course changes of both: heading and rudder",
            ),
        },
        "version": shipid.__version__,
    }
