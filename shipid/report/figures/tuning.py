"""Figures of a tuning, and of two."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from markupsafe import Markup

from shipid.autopilot.design.schedule import GAINS
from shipid.autopilot.judgement.compare_tunings import TuningComparison
from shipid.autopilot.judgement.judge import SAMPLE_CHANGE, histories
from shipid.autopilot.judgement.judgement import LIMITS, Judgement
from shipid.autopilot.judgement.margins import loop_polynomials
from shipid.report.figures.charts import Axes, Line, chart, nyquist

#: Course changes shown against time.
_SHOWN = (10.0, 60.0, 120.0)
#: Unit of a gain in a figure, whose numbers have two decimals, and the factor to it.
_GAIN_UNITS = {"Kp": ("", 1.0), "Kd": ("s", 1.0), "Ki": ("1/1000 s", 1000.0)}


def tuning_figures(judged: Judgement) -> dict[str, Markup]:
    """Return the figures of one tuning by name.

    Parameters
    ----------
    judged : Judgement
        The design and its judgement.
    """
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


def _cloud_axes(cloud: Mapping[str, np.ndarray]) -> list[Axes]:
    heading, rudder = [], []
    last = _until(dict(cloud), np.full(len(cloud["t"]), np.deg2rad(SAMPLE_CHANGE)))
    for k in (*range(1, len(cloud["t"])), 0):
        kept = np.isfinite(cloud["psi"][k]) & (cloud["t"][k] <= last)
        look, label = ("line", "as designed") if k == 0 else ("faint", "draws" if k == 1 else "")
        t = cloud["t"][k][kept]
        heading.append(Line(label, t, np.rad2deg(cloud["psi"][k][kept]), look))
        rudder.append(Line("", t, np.rad2deg(cloud["delta"][k][kept]), look))
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
