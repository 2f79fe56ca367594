"""An autopilot as a page: words first, then the design, and the sections of its judgement where it was judged."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np
from markupsafe import Markup

import shipid
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.schedule import GAINS
from shipid.autopilot.judgement.judgement import SAMPLE_CHANGE, Judgement
from shipid.declaration.units import pretty
from shipid.foundation.numbers import brief, fixed, given, number
from shipid.report.figures.tuning import design_figures, tuning_figures
from shipid.report.page import Page, Section
from shipid.report.typography.quantities import shown_field
from shipid.report.views.tuning.judgement import (
    margins_section,
    on_board_section,
    points_section,
    robustness_section,
    steps_section,
    weather_section,
)
from shipid.report.views.words import boxes, sentence

_ADVICE = {
    "disk margin": "A lower natural frequency or more trials of this ship raise it.",
    "gain margin": "A lower natural frequency raises it.",
    "phase margin": "A lower natural frequency or a higher damping raises it.",
    "overshoot": "A higher damping lowers it.",
    "steady error in wind": "An integral (--design pid) removes it.",
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
_INTEGRAL = " + Ki integral of (heading ordered − heading)"
#: Said instead of a judgement.
NOT_JUDGED = "The design was not judged: margins, robustness and course changes are those of shipid.judge, which was not asked for."


def tuning_page(judged: Judgement) -> Page:
    """Return what the page says of a judged autopilot.

    Parameters
    ----------
    judged : Judgement
        The design and its judgement.
    """
    figures = tuning_figures(judged)
    sections = [
        steps_section(judged, figures),
        points_section(judged),
        margins_section(judged, figures),
        _schedule(judged.pilot, figures),
        robustness_section(judged, figures),
        weather_section(judged),
        on_board_section(judged, figures),
        _method(judged.pilot),
    ]
    return _page(judged.pilot, answer(judged), judged.warnings, [s for s in sections if s is not None])


def design_page(pilot: Autopilot) -> Page:
    """Return what the page says of an autopilot that was not judged.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    """
    sections = [_schedule(pilot, design_figures(pilot)), _method(pilot)]
    return _page(pilot, [_what(pilot), NOT_JUDGED], pilot.warnings, sections)


def _page(pilot: Autopilot, words: Sequence[str], warnings: Sequence[str], sections: Sequence[Section]) -> Page:
    grave, notes = boxes(warnings, sentence)
    return Page(
        f"Autopilot of {pilot.ship.name}, tuned with model {pilot.model.name}",
        [("", words)],
        sections,
        grave,
        notes,
        f"shipid {shipid.__version__}",
    )


def _what(pilot: Autopilot) -> str:
    first, last = pilot.speeds[0], pilot.speeds[-1]
    speeds = f"{brief(first)} to {brief(last)} m/s" if len(pilot.speeds) > 1 else f"{brief(first)} m/s"
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
            f"A course change of {SAMPLE_CHANGE:.0f} degrees at {brief(own[0].speed)} m/s settles in {own[0].settling_s:.0f} s with "
            f"an overshoot of {fixed(own[0].overshoot_deg, 1)} degrees."
        )
    sentences.append(
        weakest.sentence + (f" {_ADVICE[weakest.what]}" if weakest.share < 1 and weakest.what in _ADVICE else "")
    )
    sentences += judged.not_reached
    limit = judged.limits["disk margin"]
    for name, robust in zip(pilot.conditions, judged.robust):
        load = f" ({name})" if len(pilot.conditions) > 1 else ""
        if robust.samples:
            below = f", below {limit:g}" if robust.disk_worst < limit else ""
            sentences.append(
                f"Over {robust.samples} ships drawn from {robust.source}{load}, the disk margin is never less than "
                f"{brief(robust.disk_worst)}{below}."
            )
        else:
            sentences.append(
                f"The margins under the uncertainty of the ship{load} are not known; the least disk margin of the nominal ship "
                f"is {brief(robust.disk_worst)}" + (f", below {limit:g}." if robust.disk_worst < limit else ".")
            )
    return sentences


def _schedule(pilot: Autopilot, figures: Mapping[str, Markup]) -> Section:
    gains = [
        (f"{n} [{pretty(GAINS[n][0])}]" if pretty(GAINS[n][0]) != "1" else n, n, "n") for n in pilot.schedule.gains
    ]
    schedules = [
        {
            "name": pilot.conditions[j] if len(pilot.conditions) > 1 else "",
            "rows": [
                {
                    "speed": fixed(speed, 2),
                    "poles": _poles(pilot.poles[j][i]),
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
        "law": _LAWS[pilot.mode] + (_INTEGRAL if "Ki" in pilot.schedule.gains else ""),
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
            words.append(f"ω\u00a0{number(abs(p), 3)}, ζ\u00a0{fixed(-p.real / abs(p), 2)}")
    return "; ".join(words)


def _method(pilot: Autopilot) -> Section:
    names = {"omega_n": ("Natural frequency at the ship's own speed", "rad/s"), "damping": ("Damping ratio", ""),
             "integral": ("Third pole over the natural frequency", ""), "rudder_weight": ("Weight of the rudder", "")}  # fmt: skip
    rudder = shown_field("delta")
    facts = {
        "Design": _DESIGNS[pilot.design],
        **{names[n][0]: f"{given(float(f'{v:.4g}'))} {names[n][1]}".strip() for n, v in pilot.request.items()},
        "Ship's own speed": f"{given(pilot.service_speed)} m/s",
        "Rudder limit of the autopilot": f"{fixed(pilot.rudder_limit * rudder.factor, 1)} {rudder.unit}",
        "Largest rudder angle": f"{fixed(pilot.limits['delta_max'] * rudder.factor, 1)} {rudder.unit}",
        "Largest rudder rate": f"{fixed(pilot.limits['delta_rate'] * rudder.factor, 2)} {rudder.unit}/s",
        "Actuator": re.sub(r"(?<=[a-z])(?=[A-Z])", " ", pilot.actuator.__name__).lower(),
    }
    view = {
        "ship": pilot.ship.name + (f" ({pilot.ship.title})" if pilot.ship.title else ""),
        "model": pilot.model.name,
        "facts": [{"name": name, "value": value} for name, value in facts.items()],
    }
    return Section("Method", "tuning/method.html", view)
