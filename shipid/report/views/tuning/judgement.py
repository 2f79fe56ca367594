"""The judgement of an autopilot as the page shows it, a section an aspect."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from markupsafe import Markup

from shipid.autopilot.course_changes.course_changes import CourseChange
from shipid.autopilot.judgement.judgement import LEAST_OVERSHOOT, SAMPLE_CHANGE, Judgement, Weakest
from shipid.autopilot.judgement.margins import Margins
from shipid.foundation.numbers import fixed, given, number, percent
from shipid.report.page import Row, Section
from shipid.report.typography.quantities import shown_field
from shipid.report.views.words import sentence

_ADAPTATIONS = {
    "none": "the gains are those of the schedule",
    "gains": "by the filter the gains are adapted to the ship it estimates",
    "reference": "by the filter the gains are those of a reference that follows the ship it estimates, and rudder compensates the difference",
}


def points_section(judged: Judgement) -> Section:
    """Return the section of the weak points: the worst value of each quantity that has a limit.

    Parameters
    ----------
    judged : Judgement
        The judgement.
    """
    worst: dict[tuple[str, bool], Weakest] = {}
    for point in judged.points():
        key = (point.what, "uncertainty" in point.where)
        if key not in worst or point.share < worst[key].share:
            worst[key] = point
    rows = [
        {
            "what": sentence(w.what),
            "where": w.where,
            "value": given(float(f"{w.value:.3g}")),
            "limit": given(w.limit),
            "unit": w.unit,
            "within": w.share >= 1,
        }
        for w in sorted(worst.values(), key=lambda w: w.share)
    ]
    # The table of the course changes holds larger ones: a reader would take one of those for the worst.
    overshoot = (
        f" An overshoot may be {percent(judged.limits['overshoot'])} of its course change, and {given(LEAST_OVERSHOOT)} deg in any "
        "case: the one nearest to its limit stands here, not the largest."
        if any(r["what"] == "Overshoot" for r in rows)
        else ""
    )
    return Section("Weak points", "tuning/points.html", {"points": rows, "overshoot": overshoot})


def margins_section(judged: Judgement, figures: Mapping[str, Markup]) -> Section:
    """Return the section of the margins of the loop, at the speeds of the schedule and between them.

    Parameters
    ----------
    judged : Judgement
        The judgement.
    figures : mapping of str to Markup
        By name.
    """
    pilot = judged.pilot
    margins = []
    for j in range(len(pilot.ships)):
        both = [*((m, False) for m in judged.margins[j]), *((m, True) for m in judged.between[j])]
        rows = [
            _margin_row(m, between, judged.limits["disk margin"])
            for m, between in sorted(both, key=lambda b: b[0].speed)
        ]
        margins.append({"name": _condition(judged, j), "rows": rows})
    view = {
        "limit": number(judged.limits["disk margin"], 2),
        "margins": margins,
        "figure": figures["margins"],
        "bode": figures["bode"],
        "nyquist": figures["nyquist"],
        "sensitivity": figures["sensitivity"],
    }
    return Section("Margins", "tuning/margins.html", view)


def _margin_row(m: Margins, between: bool, limit: float) -> Row:
    disk = fixed(m.disk, 2)
    return {
        "class": "own" if between else "",
        "speed": fixed(m.speed, 2),
        "disk": Markup('<span class="no">{}</span>').format(disk) if m.disk < limit else disk,
        "gain": " / ".join("none" if g is None else number(g, 3) for g in (m.gain_low, m.gain_high)),
        "phase": "none" if m.phase_deg is None else fixed(m.phase_deg, 0),
        "delay": "none" if m.delay_s is None else number(m.delay_s, 3),
        "bandwidth": "none" if m.bandwidth is None else number(m.bandwidth, 3),
        "sensitivity": fixed(m.sensitivity, 2),
        "complementary": fixed(m.complementary, 2),
    }


def robustness_section(judged: Judgement, figures: Mapping[str, Markup]) -> Section:
    """Return the section of the margins under the uncertainty of the ship.

    Parameters
    ----------
    judged : Judgement
        The judgement.
    figures : mapping of str to Markup
        By name.
    """
    conditions = [
        {
            "name": _condition(judged, j),
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
    view = {"conditions": conditions, "figure": figures.get("drawn")}
    return Section("Robustness", "tuning/robustness.html", view)


def _reached(value: float | None, decimals: int) -> str:
    return "not reached" if value is None else fixed(value, decimals)


def steps_section(judged: Judgement, figures: Mapping[str, Markup]) -> Section:
    """Return the section of the course changes in calm.

    Parameters
    ----------
    judged : Judgement
        The judgement.
    figures : mapping of str to Markup
        By name.
    """
    groups: dict[tuple[str, float], dict[float, CourseChange]] = {}
    for s in judged.steps:
        groups.setdefault((s.weather, s.speed), {})[s.change_deg] = s
    heads = [f"{fixed(speed, 2)} m/s" + (f", {words[6:]}" if words != "calm" else "") for words, speed in groups]
    columns = [(head, f"c{k}", "n") for k, head in enumerate(heads)]
    rows = [
        {"change": fixed(change, 0), **{f"c{k}": _step_cell(g[change]) for k, g in enumerate(groups.values())}}
        for change in sorted({s.change_deg for s in judged.steps})
    ]
    view = {"columns": columns, "rows": rows, "figure": figures["steps"]}
    return Section("Course changes", "tuning/steps.html", view)


def _step_cell(s: CourseChange) -> str:
    if s.lost:
        return "ran away"
    return f"{_reached(s.overshoot_deg, 2)} / {_reached(s.settling_s, 0)}"


def weather_section(judged: Judgement) -> Section:
    """Return the section of courses kept and changed in wind, waves and current.

    Parameters
    ----------
    judged : Judgement
        The judgement.
    """
    w = judged.weather
    head = (
        f"Wind {number(w['wind_m_s'], 2)} m/s and waves at {number(w['wave_frequency_rad_s'], 2)} rad/s that yaw a ship at rest by "
        f"{number(w['wave_heading_rms_deg'], 2)} deg rms, both from one side; current {number(w['current_m_s'], 2)} m/s across. "
        "Unless they are stated, they are in proportion to the length of the ship below 100 m. The sea filter is on: a notch at "
        "the frequency of encounter, and a lag."
    )
    raw = {s.weather: s for s in judged.in_weather if not s.sea_filter}
    filtered = [s for s in judged.in_weather if s.sea_filter]
    kept = [s for s in filtered if not s.change_deg]
    view = {
        "head": head,
        "why": _why_it_moves(judged, kept, list(raw.values())),
        "kept": [_weather_row(s, raw.get(s.weather)) for s in kept],
        "turned": [_weather_row(s) for s in filtered if s.change_deg],
        "change": fixed(SAMPLE_CHANGE, 0),
    }
    return Section("Wind, waves and current", "tuning/weather.html", view, short="Wind and waves")


def _why_it_moves(judged: Judgement, kept: Sequence[CourseChange], raw: Sequence[CourseChange]) -> str:
    """Why the rudder is busy in waves, in numbers: the feedback of the rate of turn, and two reversals a wave."""
    if not judged.weather["wave_heading_rms_deg"] or not kept or not raw:
        return ""
    turning = judged.weather["wave_turning_rms_deg_s"]
    gain = judged.pilot.gains(judged.pilot.own_speed).Kd
    met = [s.waves_met or 0.0 for s in kept]
    most = judged.pilot.limits["delta_rate"] * shown_field("delta").factor

    def worst(runs: Sequence[CourseChange], name: str, decimals: int) -> str:
        return fixed(max((getattr(s, name) or 0.0 for s in runs), default=0.0), decimals)

    return (
        f"Why the rudder moves: the rate of turn is fed back with a gain Kd of {number(gain, 3)} s, so that waves that turn a ship at rest at "
        f"{number(turning, 2)} deg/s rms ask for {number(gain * turning, 2)} deg of rudder rms. A rudder that answers each wave "
        f"reverses twice a wave, and the ship meets {fixed(min(met), 1)} to {fixed(max(met), 1)} waves a minute. At worst the rudder "
        f"travels {worst(raw, 'travel_deg_s', 2)} deg/s and reverses {worst(raw, 'reversals', 1)} times a minute without the sea "
        f"filter, {worst(kept, 'travel_deg_s', 2)} deg/s and {worst(kept, 'reversals', 1)} times with it. Reversals of less than "
        "half a degree are not counted."
        + (
            f" Without the filter the steering machine, which turns by at most {fixed(most, 2)} deg/s, cannot follow each swing."
            if max((s.travel_deg_s or 0.0 for s in raw), default=0.0) > 0.6 * most
            else ""
        )
    )


def _weather_row(s: CourseChange, raw: CourseChange | None = None) -> Row:
    def beside(name: str, decimals: int) -> str:
        value = _reached(getattr(s, name), decimals)
        return value if raw is None else f"{value} ({_reached(getattr(raw, name), decimals)})"

    return {
        "weather": s.weather.removeprefix("weather from "),
        "rms": _reached(s.rms_error_deg, 2),
        "mean": "not reached" if s.mean_error_deg is None else fixed(s.mean_error_deg, 2, sign=True),
        "overshoot": _reached(s.overshoot_deg, 2),
        "rudder": beside("rms_rudder_deg", 2),
        "travel": beside("travel_deg_s", 2),
        "reversals": beside("reversals", 1),
        "waves": "" if s.waves_met is None else fixed(s.waves_met, 1),
        "track": "not reached" if s.cross_track_m is None else number(s.cross_track_m, 3),
    }


def on_board_section(judged: Judgement, figures: Mapping[str, Markup]) -> Section | None:
    """Return the section of the runs with a Kalman filter in the loop; None where there were none.

    Parameters
    ----------
    judged : Judgement
        The judgement.
    figures : mapping of str to Markup
        By name.
    """
    found = judged.on_board
    if found is None:
        return None
    sensors = ", ".join(f"{n} {level}" for n, level in found.sensors.items())
    head = (
        f"Course changes one after the other, with a sample every {number(found.interval, 3)} s: by the instruments ({sensors}), "
        f"and by the Kalman filter {found.kalman}; {_ADAPTATIONS[found.adaptation]}."
    )
    groups = [
        (
            f"By the {r.feedback}, {'in calm' if r.weather == 'calm' else r.weather}",
            [_on_board_row(c, r.weather) for c in r.changes],
        )
        for r in found.runs
    ]
    return Section("On board", "tuning/on_board.html", {"head": head, "groups": groups, "figure": figures["on_board"]})


def _on_board_row(c: CourseChange, weather: str) -> Row:
    overshoot = "ran away" if c.lost else _reached(c.overshoot_deg, 2) if c.change_deg else ""
    return {
        "change": fixed(c.change_deg, 0),
        "overshoot": overshoot,
        "settling": _reached(c.settling_s, 0) if c.change_deg and weather == "calm" else "",
        "rms": _reached(c.rms_error_deg, 2),
        "rudder": _reached(c.rms_rudder_deg, 2),
        "reversals": _reached(c.reversals, 1),
    }


def _condition(judged: Judgement, j: int) -> str:
    """The load condition, where there are several."""
    return judged.pilot.conditions[j] if len(judged.pilot.conditions) > 1 else ""
