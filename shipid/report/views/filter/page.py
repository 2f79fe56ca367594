"""A filtered record as a page: words first, then parameters, signals, innovations, noise levels, equations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from markupsafe import Markup
from scipy.special import chdtri

from shipid.estimation.levels.judge_filter import not_white
from shipid.estimation.records.observability import Observability
from shipid.estimation.records.run import FilterRun, Innovations
from shipid.foundation.numbers import fixed, moment, uncertain
from shipid.foundation.statistics import WHITE
from shipid.report.figures.trials import Curve, Panel, halves, histories
from shipid.report.page import Page, Row, Section
from shipid.report.typography.quantities import shown
from shipid.report.views.equations import equations_section
from shipid.report.views.filter.innovations import innovation_panel, innovation_row
from shipid.report.views.filter.parameters import last_estimates, parameters_section
from shipid.report.views.words import boxes, past_north, sentence, versions_now

#: Samples over which the normalised innovations squared are averaged in the figure, as a part of the record.
_WINDOW = 0.05
_FROM_RECORD = "found from the record"
_NOT_ASKED = "Whether the sensors show every state was not worked out; ask ExtendedKalmanFilter.observability."

#: The sections of the page, in order; one that has nothing to say is None. A new one is a line here and a template.
SECTIONS: list[Callable[[FilterRun], Section | None]] = [
    lambda run: parameters_section(run, run.design.base),
    lambda run: _signals(run),
    lambda run: _innovations(run),
    lambda run: _noise(run),
    lambda run: equations_section(run.design.base),
]


def observability_page(seen: Observability) -> Page:
    """Return the page of a filtered record with what it shows of the state.

    Parameters
    ----------
    seen : Observability
        With its run.
    """
    return filter_page(seen.run, seen)


def filter_page(run: FilterRun, seen: Observability | None = None) -> Page:
    """Return what the page says of a filtered record.

    Parameters
    ----------
    run : FilterRun
        The run.
    seen : Observability, optional
        What the record shows of the state, where that was worked out.
    """
    warnings, notes = boxes(_told(run))
    return Page(
        f"Trial {run.record} filtered with model {run.design.base.name}",
        [("", _answer(run))],
        [s for section in SECTIONS if (s := section(run)) is not None],
        warnings if seen is None else [*warnings, *seen.messages],
        notes if seen is not None else [*notes, _NOT_ASKED],
        f"{run.t.size} samples, {moment(run.t[0])} to {moment(run.t[-1])} s. {versions_now()}",
    )


def _answer(run: FilterRun) -> list[str]:
    kind = "Kalman filter" if run.design.linear else "extended Kalman filter"
    said = [f"The {kind} of model {run.design.base.name} filtered {run.t.size} samples of {run.record}."]
    if run.innovations and all(_expected(i) for i in run.innovations.values()):
        said.append("The innovations are as large as the filter expects them, and white.")
    return said + last_estimates(run)


def _expected(i: Innovations) -> bool:
    """Whether the innovations of a sensor are as the filter predicts them."""
    if i.nis_mean is None or i.nis_band is None or i.white_p is None:
        return False
    return i.nis_band[0] <= i.nis_mean <= i.nis_band[1] and i.white_p >= WHITE


def _told(run: FilterRun) -> list[str]:
    said: list[str] = list(run.warnings)
    for name, i in run.innovations.items():
        if i.rejected:
            said.append(f"{i.rejected} of {i.t.size} samples of {name} were outside the gate and were rejected.")
        if i.limited:
            said.append(f"{i.limited} samples of {name} were outside the sensor's range and were left out.")
        # The filter warns of sizes that are far off in words of its own.
        warned = any(n.kind == "noise-does-not-fit" and n.known.get("sensor") == name for n in run.warnings)
        if (
            not warned
            and i.nis_mean is not None
            and i.nis_band is not None
            and not i.nis_band[0] <= i.nis_mean <= i.nis_band[1]
        ):
            size, cause = (
                ("larger", "the standard deviations of the estimates are too small")
                if i.nis_mean > 1
                else ("smaller", "the noise levels are too large")
            )
            said.append(
                f"The innovations of {name} are {size} than expected (mean square {i.nis_mean:.2f} times the variance): {cause}."
            )
    # One that was judged has said it.
    said += [n for n in not_white(run) if n not in run.warnings]
    said += run.arranged.words
    if run.arranged.back:
        said.append(f"{run.arranged.back} samples were left out because the clock did not go forward.")
    return said


def _signals(run: FilterRun) -> Section:
    rows = []
    for name in (n for n in run.states if n not in run.design.parameters.values()):
        how = shown(run.design.model, name)
        last = float(run[name][-1]) * how.factor
        # A heading is read on a compass, from 0 to 360.
        last = last % 360 if name == "psi" else last
        value = uncertain(last, float(run.std_of(name)[-1]) * how.factor)
        rows.append(
            {"name": name, "value": value, "unit": how.unit, "meaning": run.design.model[name].quantity.meaning}
        )
    north = past_north(np.degrees(run["psi"])) if "psi" in run.states else ""
    view = {"states": rows, "figures": _signal_figures(run), "north": north}
    return Section("Filtered signals", "filter/signals.html", view)


def _signal_figures(run: FilterRun) -> list[Markup]:
    panels, arranged = [], run.arranged
    for j, name in enumerate(run.design.measured):
        measures = run.design.model[name].quantity.measures or name
        if measures not in run.states:
            continue
        how, there = shown(run.design.model, measures), arranged.there[:, j]
        curves = [
            Curve("measured beneath", arranged.t[there], arranged.z[there, j] * how.factor),
            Curve("estimate", run.t, run[measures] * how.factor),
        ]
        panels.append(Panel(how.label, how.unit, curves))
    return halves(panels, "signals", "Measured and filtered")


def _innovations(run: FilterRun) -> Section:
    rows, panels = [], []
    for name, i in run.innovations.items():
        how = shown(run.design.model, name)
        rows.append(
            innovation_row(
                how,
                i.values[i.taken],
                i.white_p,
                samples=str(i.t.size),
                rejected=str(i.rejected + i.limited),
                nis="" if i.nis_mean is None else fixed(i.nis_mean, 3),
                band="" if i.nis_band is None else f"{i.nis_band[0]:.3f} to {i.nis_band[1]:.3f}",
            )
        )
        panels.append(innovation_panel(how, i.t, i.values, i.variances))
    figure = histories(panels, "innovations", "Innovations with their 95 percent bounds")
    view = {"rows": rows, "figure": figure, "consistency": _consistency_figure(run)}
    return Section("Innovations", "filter/innovations.html", view)


def _consistency_figure(run: FilterRun) -> Markup | None:
    panels = []
    for name, i in run.innovations.items():
        squares = i.normalised**2
        width = max(10, int(_WINDOW * squares.size))
        if squares.size <= width:
            continue
        sums = np.concatenate([[0.0], np.cumsum(squares)])
        mean, t = (sums[width:] - sums[:-width]) / width, i.t[i.taken][width - 1 :]
        curves = [Curve("moving mean", t, mean)]
        curves += [Curve("95 % bounds", t, np.full(t.size, chdtri(width, p) / width)) for p in (0.975, 0.025)]
        label = shown(run.design.model, name).label.lower()
        panels.append(Panel(f"NIS, {label}, mean of {width} samples", "1", curves))
    return histories(panels, "nis", "Normalised innovations squared") if panels else None


def _noise(run: FilterRun) -> Section:
    design = run.design
    sensors: list[Row] = []
    for name, level in zip(design.measured, design.r):
        how = shown(design.model, name)
        origin = _FROM_RECORD if f"sensor:{name}" in run.learnt else "given or standard"
        sensors.append({"name": name, "level": how.number(level), "unit": how.unit, "origin": origin})
    sources: list[Row] = []
    for source in design.sources:
        how = shown(design.model, source.name)
        root = "" if not source.density else "/√s" if source.place == "state" else "·√s"
        sources.append(
            {
                "name": source.name,
                "level": how.number(source.level),
                "unit": f"{how.unit}{root}",
                "kind": "per root second" if source.density else "per sample",
                "origin": _FROM_RECORD
                if f"noise:{source.name}" in run.learnt
                else "default of the toolbox"
                if source.assumed
                else "given or declared",
            }
        )
    added: list[Row] = []
    for name, bias in design.instruments.biases.items():
        how = shown(design.model, name)
        row: Row = {"name": name, "bias": how.number(bias), "unit": how.unit}
        if name in run.added:
            std, doubt = run.added[name]
            row = {**row, "bias": uncertain(bias * how.factor, std * how.factor), "remark": sentence(doubt)}
        added.append(row)
    return Section("Noise levels", "filter/noise.html", {"sensors": sensors, "sources": sources, "added": added})
