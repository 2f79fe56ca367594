"""Figures of a tuning, and of two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.schedule import GAINS
from shipid.autopilot.judgement.compare_tunings import TuningComparison
from shipid.autopilot.judgement.judgement import SAMPLE_CHANGE, SHOWN_CHANGES, Judgement
from shipid.autopilot.on_board.on_board_runs import OnBoardRuns
from shipid.foundation.numbers import brief
from shipid.report.figures.charts import Axes, Line, chart, nyquist
from shipid.report.typography.quantities import shown_field

#: Unit of a gain in a figure, whose numbers have two decimals, and the factor to it.
_GAIN_UNITS = {"Kp": ("", 1.0), "Kd": ("s", 1.0), "Ki": ("10⁻³ 1/s", 1000.0)}
_HEADING, _RUDDER = shown_field("psi"), shown_field("delta")


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
    # In the order of the page: the first one is what `plot` draws.
    steps = chart(
        _step_axes([judged], [""]), "time [s]", "steps", "Course changes at the ship's own speed: heading and rudder"
    )
    found = {"steps": steps, **design_figures(judged.pilot)}
    found["margins"] = chart(_margin_axes(judged), "speed [m/s]", "margins", "Margins against speed, with their limits")
    disk = judged.limits["disk margin"]
    found["bode"] = chart(_bode_axes(judged), "frequency [rad/s]", "bode", "Bode diagram of the loop", log=True)
    found["sensitivity"] = chart(
        _sensitivity_axes(judged), "frequency [rad/s]", "sensitivity", "Sensitivity of the loop", log=True
    )
    found["nyquist"] = nyquist(_nyquist_lines(judged), disk, "nyquist", "Nyquist curves of the loop")
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
    disk.append(Line("limit", ends, np.full(2, judged.limits["disk margin"]), "limit"))
    phase.append(Line("", ends, np.full(2, judged.limits["phase margin"]), "limit"))
    return [Axes("Disk margin", "", disk), Axes("Phase margin", _HEADING.unit, phase), Axes("Delay margin", "s", delay)]


def _bode_axes(judged: Judgement) -> list[Axes]:
    """Gain and phase of the loop where its gain is within 40 dB of one, with a dot where it is one."""
    gain, phase = [], []
    for k, loop in enumerate(judged.responses):
        size = 20 * np.log10(np.abs(loop.response))
        turned = np.rad2deg(np.unwrap(np.angle(loop.response)))
        crossings = np.flatnonzero((size[:-1] >= 0) & (size[1:] < 0))
        at = int(crossings[-1]) if crossings.size else int(np.abs(size).argmin())
        # Of the angles that say the same, the one between -360 deg and 0 where the gain is one.
        turned -= 360 * np.ceil(turned[at] / 360)
        shown = np.abs(size) <= 40
        gain.append(Line(f"{brief(loop.speed)} m/s", loop.omega[shown], size[shown], "line", k))
        phase.append(Line("", loop.omega[shown], turned[shown], "line", k))
        if crossings.size:
            gain.append(Line("", loop.omega[[at]], size[[at]], "points", k))
            phase.append(Line("", loop.omega[[at]], turned[[at]], "points", k))
    ends = np.array([min(line.x.min() for line in gain), max(line.x.max() for line in gain)])
    gain.append(Line("", ends, np.zeros(2), "limit"))
    phase.append(Line("", ends, np.full(2, -180.0), "limit"))
    return [Axes("Gain", "dB", gain), Axes("Phase", _HEADING.unit, phase)]


def _sensitivity_axes(judged: Judgement) -> list[Axes]:
    """Sensitivity 1/(1 + L) and complementary sensitivity L/(1 + L) of the loop L, where its gain is within 40 dB of one."""
    own, rest = [], []
    for k, loop in enumerate(judged.responses):
        size = 20 * np.log10(np.abs(loop.response))
        shown = np.abs(size) <= 40
        reduced = -20 * np.log10(np.abs(1 + loop.response[shown]))
        own.append(Line(f"{brief(loop.speed)} m/s", loop.omega[shown], reduced, "line", k))
        rest.append(Line("", loop.omega[shown], size[shown] + reduced, "line", k))
    ends = np.array([min(line.x.min() for line in own), max(line.x.max() for line in own)])
    for lines in (own, rest):
        lines.append(Line("", ends, np.zeros(2), "limit"))
    return [Axes("Sensitivity", "dB", own), Axes("Complementary sensitivity", "dB", rest)]


def _nyquist_lines(judged: Judgement) -> list[Line]:
    return [
        Line(f"{brief(loop.speed)} m/s", loop.response.real, loop.response.imag, "line", k)
        for k, loop in enumerate(judged.responses)
    ]


def _step_axes(judged: Sequence[Judgement], names: Sequence[str]) -> list[Axes]:
    """Course changes at the ship's own speed; of several designs a colour each, of one a colour for each change."""
    runs = []
    for k, (one, name) in enumerate(zip(judged, names)):
        last = _until(one.histories, SHOWN_CHANGES)
        for i, change in enumerate(SHOWN_CHANGES):
            label, colour = (name if i == 0 else "", k) if name else (f"{change:.0f} {_HEADING.unit}", i)
            run = {n: values[i] for n, values in one.histories.items()}
            runs.append(_Run(label, run, "line" if k == 0 else "dashed", colour, last))
    return _heading_and_rudder(runs)


def _drawn_axes(drawn: Mapping[str, np.ndarray]) -> list[Axes]:
    """A course change of each ship drawn, faint, and in front of them the ship as it is."""
    count = len(drawn["t"])
    last = _until(drawn, [SAMPLE_CHANGE] * count)
    runs = []
    for k in (*range(1, count), 0):
        look, label = ("line", "as designed") if k == 0 else ("faint", "draws" if k == 1 else "")
        runs.append(_Run(label, {n: values[k] for n, values in drawn.items()}, look, last=last))
    return _heading_and_rudder(runs)


def _on_board_axes(found: OnBoardRuns) -> list[Axes]:
    """Heading and rudder of the runs in weather: by the instruments (faint) and by the filter."""
    return _heading_and_rudder(
        [
            _Run(f"by the {run.feedback}", run.histories, "faint" if run.feedback == "instruments" else "line")
            for run in found.runs
            if run.weather != "calm"
        ]
    )


@dataclass(frozen=True, eq=False)
class _Run:
    """A run to draw: its heading and rudder against time, until `last`."""

    label: str
    histories: Mapping[str, np.ndarray]
    look: str
    colour: int = 0
    last: float = np.inf


def _heading_and_rudder(runs: Sequence[_Run]) -> list[Axes]:
    heading, rudder = [], []
    for run in runs:
        t, psi, delta = (run.histories[n] for n in ("t", "psi", "delta"))
        kept = np.isfinite(psi) & (t <= run.last)
        heading.append(Line(run.label, t[kept], psi[kept] * _HEADING.factor, run.look, run.colour))
        rudder.append(Line("", t[kept], delta[kept] * _RUDDER.factor, run.look, run.colour))
    return [Axes(_HEADING.label, _HEADING.unit, heading), Axes(_RUDDER.label, _RUDDER.unit, rudder)]


def _until(histories: Mapping[str, np.ndarray], changes: Sequence[float]) -> float:
    """Until when a course change is worth showing: half as long again as the slowest takes."""
    last = 0.0
    for t, psi, change in zip(histories["t"], histories["psi"], changes):
        out = np.flatnonzero(~(np.abs(psi * _HEADING.factor - change) < 0.01 * abs(change)))
        last = max(last, float(t[out[-1]]) if out.size else 0.0)
    return min(1.4 * last, float(histories["t"].max()))


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
    disk.append(Line("limit", speeds, np.full(2, found.judged[0].limits["disk margin"]), "limit"))
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
