"""Figures of a tuning, and of two."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from markupsafe import Markup

from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.schedule import GAINS
from shipid.autopilot.judgement.compare_tunings import TuningComparison
from shipid.autopilot.judgement.judgement import LIMITS, SAMPLE_CHANGE, SHOWN_CHANGES, Judgement
from shipid.autopilot.on_board.on_board_runs import OnBoardRuns
from shipid.declaration.vocabulary import to_display
from shipid.report.figures.charts import Axes, Line, chart, nyquist

#: Unit of a gain in a figure, whose numbers have two decimals, and the factor to it.
_GAIN_UNITS = {"Kp": ("", 1.0), "Kd": ("s", 1.0), "Ki": ("1/1000 s", 1000.0)}


def design_figures(pilot: Autopilot) -> dict[str, Markup]:
    """Return the figures of a design by name.

    Parameters
    ----------
    pilot : Autopilot
        The design.
    """
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
    return {"schedule": chart(panels, "speed [m/s]", "schedule", "Gains against speed")}


def tuning_figures(judged: Judgement) -> dict[str, Markup]:
    """Return the figures of a judged design by name.

    Parameters
    ----------
    judged : Judgement
        The design and its judgement.
    """
    found = design_figures(judged.pilot)
    found["margins"] = chart(_margin_axes(judged), "speed [m/s]", "margins", "Margins against speed, with their limits")
    found["nyquist"] = nyquist(_nyquist_lines(judged), LIMITS["disk margin"], "nyquist", "Nyquist curves of the loop")
    found["steps"] = chart(
        _step_axes([judged], [""]), "time [s]", "steps", "Course changes at the ship's own speed: heading and rudder"
    )
    if len(judged.drawn_histories["t"]) > 1:
        axes = _drawn_axes(judged.drawn_histories)
        found["drawn"] = chart(axes, "time [s]", "drawn", "Course changes of ships drawn from the uncertainty")
    if judged.on_board is not None:
        axes = _on_board_axes(judged.on_board)
        found["on_board"] = chart(axes, "time [s]", "on_board", "On board, in weather: heading and rudder")
    return found


def _margin_axes(judged: Judgement) -> list[Axes]:
    pilot = judged.pilot
    disk: list[Line] = []
    phase: list[Line] = []
    delay: list[Line] = []
    for j, name in enumerate(pilot.conditions):
        both = sorted((*judged.margins[j], *judged.between[j]), key=lambda m: m.speed)
        speeds = np.array([m.speed for m in both])
        several = len(pilot.conditions) > 1
        disk.append(Line(name if several else "as designed", speeds, np.array([m.disk for m in both]), "line", 2 * j))
        robust = judged.robust[j]
        if robust.samples:
            by_speed = np.array(robust.disk_by_speed)
            disk.append(
                Line("" if several else f"worst of {robust.samples} draws", pilot.speeds, by_speed, "dashed", 2 * j + 1)
            )
        for values, lines in (([m.phase_deg for m in both], phase), ([m.delay_s for m in both], delay)):
            good = np.array([v is not None for v in values])
            lines.append(Line("", speeds[good], np.array([v for v in values if v is not None]), "line", 2 * j))
    ends = np.array([pilot.speeds[0], pilot.speeds[-1]])
    disk.append(Line("limit", ends, np.full(2, LIMITS["disk margin"]), "limit"))
    phase.append(Line("", ends, np.full(2, LIMITS["phase margin"]), "limit"))
    return [Axes("Disk margin", "", disk), Axes("Phase margin", "deg", phase), Axes("Delay margin", "s", delay)]


def _nyquist_lines(judged: Judgement) -> list[Line]:
    return [
        Line(f"{loop.speed:.3g} m/s", loop.response.real, loop.response.imag, "line", k)
        for k, loop in enumerate(judged.responses)
    ]


def _step_axes(judged: list[Judgement], names: list[str]) -> list[Axes]:
    heading: list[Line] = []
    rudder: list[Line] = []
    for k, (one, name) in enumerate(zip(judged, names)):
        shown = one.histories
        last = _until(shown, np.deg2rad(SHOWN_CHANGES))
        for i, change in enumerate(SHOWN_CHANGES):
            t, psi, delta = (shown[n][i] for n in ("t", "psi", "delta"))
            kept = np.isfinite(psi) & (t <= last)
            colour, label = (k, name if i == 0 else "") if name else (i, f"{change:.0f} deg")
            look = "line" if k == 0 else "dashed"
            heading.append(Line(label, t[kept], to_display(psi[kept], "psi"), look, colour))
            rudder.append(Line("", t[kept], to_display(delta[kept], "delta"), look, colour))
    return [Axes("Heading", "deg", heading), Axes("Rudder", "deg", rudder)]


def _until(shown: Mapping[str, np.ndarray], changes: np.ndarray) -> float:
    """End of the time axis of course changes: 1.5 times the time of the slowest."""
    last = 0.0
    for t, psi, change in zip(shown["t"], shown["psi"], changes):
        out = np.flatnonzero(~(np.abs(psi - change) < 0.01 * abs(change)))
        last = max(last, float(t[out[-1]]) if out.size else 0.0)
    return min(1.4 * last, float(shown["t"].max()))


def _drawn_axes(drawn: Mapping[str, np.ndarray]) -> list[Axes]:
    heading, rudder = [], []
    last = _until(drawn, np.full(len(drawn["t"]), np.deg2rad(SAMPLE_CHANGE)))
    for k in (*range(1, len(drawn["t"])), 0):
        kept = np.isfinite(drawn["psi"][k]) & (drawn["t"][k] <= last)
        look, label = ("line", "as designed") if k == 0 else ("faint", "draws" if k == 1 else "")
        t = drawn["t"][k][kept]
        heading.append(Line(label, t, to_display(drawn["psi"][k][kept], "psi"), look))
        rudder.append(Line("", t, to_display(drawn["delta"][k][kept], "delta"), look))
    return [Axes("Heading", "deg", heading), Axes("Rudder", "deg", rudder)]


def _on_board_axes(found: OnBoardRuns) -> list[Axes]:
    """Heading and rudder of the runs in weather: by the instruments (faint) and by the filter."""
    heading, rudder = [], []
    for run in found.runs:
        if run.weather == "calm":
            continue
        look = "faint" if run.feedback == "instruments" else "line"
        t, psi, delta = (run.histories[n] for n in ("t", "psi", "delta"))
        kept = np.isfinite(psi)
        heading.append(Line(f"by the {run.feedback}", t[kept], to_display(psi[kept], "psi"), look))
        rudder.append(Line("", t[kept], to_display(delta[kept], "delta"), look))
    return [Axes("Heading", "deg", heading), Axes("Rudder", "deg", rudder)]


def comparison_figures(found: TuningComparison) -> dict[str, Markup]:
    """Return the figures of two tunings by name.

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
    }
