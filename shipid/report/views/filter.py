"""A filtered record as the page shows it: words first, then parameters, innovations, signals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import metadata
from typing import Any

import numpy as np
from markupsafe import Markup

import shipid
from shipid.declaration.model import Entry
from shipid.declaration.units import factor, pretty
from shipid.estimation.records.run import FilterRun, Innovations, ParameterEstimate
from shipid.generation.typesetting.symbols import symbol
from shipid.generation.typesetting.typeset import typeset
from shipid.report.figures.trials import Curve, Panel, histories
from shipid.report.typography.numbers import fixed, interval, number, uncertain
from shipid.report.typography.symbols import html_symbol
from shipid.report.views.trial import LABELS

_Z95 = 1.959963984540054
#: Probability below which innovations are called coloured.
_COLOURED = 0.01
#: Samples over which the normalised innovations squared are averaged in the figure, as a part of the record.
_WINDOW = 0.05


@dataclass(frozen=True, eq=False)
class FilterView:
    """Everything the template of a filtered record reads; see the template for where it stands."""

    title: str
    answer: list[str]
    warnings: list[str]
    cautions: list[str]
    parameters: list[dict[str, Any]]
    parameter_figure: Markup | None
    innovations: list[dict[str, Any]]
    innovation_figure: Markup
    consistency_figure: Markup | None
    signal_figure: Markup | None
    states: list[dict[str, Any]]
    sensors: list[dict[str, str]]
    sources: list[dict[str, str]]
    equations: list[dict[str, str]]
    model_name: str
    record: str
    versions: dict[str, str]


def filter_view(run: FilterRun) -> FilterView:
    """Return what the page says of a filtered record.

    Parameters
    ----------
    run : FilterRun
        The run.
    """
    kalman = run.filter
    seen = run.observability()
    return FilterView(
        title=f"{kalman.base.name} on {run.record}",
        answer=_answer(run),
        warnings=list(seen.messages),
        cautions=_cautions(run),
        parameters=[parameter_row(run.parameters[n], run.filter.base[n]) for n in run.parameters],
        parameter_figure=parameter_figure(
            run.t, {n: (run[n], run.std_of(n), kalman.base[n].unit) for n in run.parameters}
        ),
        innovations=[_innovation(run, n, i) for n, i in run.innovations.items()],
        innovation_figure=_innovation_figure(run),
        consistency_figure=_consistency_figure(run),
        signal_figure=_signal_figure(run),
        states=[_state(run, n) for n in run.states if n not in kalman.parameters.values()],
        sensors=[
            _sensor(run, n, level) for n, level in zip(kalman.measured, kalman.constants[kalman.layout.constants["r"]])
        ],
        sources=[_source(run, s) for s in kalman.sources],
        equations=[
            {"plain": e.plain, "source": e.source, "where": f"{e.component}.{e.method}"} for e in typeset(kalman.base)
        ],
        model_name=kalman.base.name,
        record=f"{run.t.size} samples, {run.t[0]:g} to {run.t[-1]:g} s",
        versions={"shipid": shipid.__version__, **{n: metadata.version(n) for n in ("casadi", "numpy", "scipy")}},
    )


def shown_size(unit: str) -> tuple[float, str]:
    """Return the size in SI of the unit a reader expects, degrees for angles, and how it is printed."""
    wanted = unit.replace("rad", "deg") if "rad" in unit and "/rad" not in unit else unit
    return factor(wanted, unit), pretty(wanted)


def _answer(run: FilterRun) -> list[str]:
    kind = "Kalman filter" if run.filter.linear else "extended Kalman filter"
    said = [f"The {kind} of model {run.filter.base.name} went through {run.t.size} samples of {run.record}."]
    for name, p in run.parameters.items():
        said.append(f"{name} ended at {uncertain(p.value, p.std)} {pretty(p.unit)}.")
    return said


def _cautions(run: FilterRun) -> list[str]:
    said = []
    for name, i in run.innovations.items():
        if i.rejected:
            said.append(f"{i.rejected} of {i.t.size} samples of {name} lay beyond the gate and were rejected.")
        if i.limited:
            said.append(f"{i.limited} samples of {name} were outside the sensor's range and were left out.")
        if i.nis_mean is not None and i.nis_band is not None and not i.nis_band[0] <= i.nis_mean <= i.nis_band[1]:
            more = i.nis_mean > 1
            said.append(
                f"The innovations of {name} are {'larger' if more else 'smaller'} than the filter expects "
                f"({i.nis_mean:.2f} times in square): {'its standard deviations are too small' if more else 'its noise levels are too large'}."
            )
        if i.white_p is not None and i.white_p < _COLOURED:
            said.append(
                f"The innovations of {name} are not white (p {i.white_p:.1g}): the model leaves something in them, and the "
                "standard deviations count it as noise."
            )
    if run.arranged.back:
        said.append(f"{run.arranged.back} samples were left out because the clock did not go forward.")
    return said


def parameter_row(p: ParameterEstimate, entry: Entry) -> dict[str, Any]:
    """Return a row of the table of parameters.

    Parameters
    ----------
    p : ParameterEstimate
        The estimate.
    entry : Entry
        The parameter in its model.
    """
    return {
        "symbol": html_symbol(symbol(entry), p.name),
        "name": p.name,
        "value": uncertain(p.value, p.std),
        "unit": pretty(p.unit),
        "interval": interval(p.interval, p.std),
        "determined": p.determined,
        "meaning": p.meaning,
    }


def _state(run: FilterRun, name: str) -> dict[str, Any]:
    size, shown = shown_size(run.filter.model[name].unit)
    return {
        "name": name,
        "value": uncertain(float(run[name][-1]) / size, float(run.std_of(name)[-1]) / size),
        "unit": shown,
        "meaning": run.filter.model[name].quantity.meaning,
    }


def _sensor(run: FilterRun, name: str, level: float) -> dict[str, str]:
    size, shown = shown_size(run.filter.model[name].unit)
    return {"name": name, "level": number(level / size, 3), "unit": shown}


def _source(run: FilterRun, source: Any) -> dict[str, str]:
    size, shown = shown_size(run.filter.model[source.name].unit)
    root = "" if not source.density else "/√s" if source.place == "state" else "·√s"
    return {
        "name": source.name,
        "level": number(source.level / size, 3),
        "unit": f"{shown}{root}",
        "kind": "per root second" if source.density else "per sample",
        "origin": "default of the toolbox" if source.assumed else "given or declared",
    }


def _innovation(run: FilterRun, name: str, i: Innovations) -> dict[str, Any]:
    size, shown = shown_size(run.filter.model[name].unit)
    rms = float(np.sqrt(np.mean(i.values[i.taken] ** 2))) / size if i.taken.any() else None
    return {
        "label": LABELS.get(name, name),
        "samples": str(i.t.size),
        "rejected": str(i.rejected + i.limited),
        "rms": "–" if rms is None else number(rms, 3),
        "unit": shown,
        "nis": "–" if i.nis_mean is None else fixed(i.nis_mean, 3),
        "band": "–" if i.nis_band is None else f"{i.nis_band[0]:.3f} to {i.nis_band[1]:.3f}",
        "p": "–" if i.white_p is None else f"{i.white_p:.2g}",
        "white": None if i.white_p is None else i.white_p >= _COLOURED,
    }


def parameter_figure(t: np.ndarray, courses: Mapping[str, tuple[np.ndarray, np.ndarray, str]]) -> Markup | None:
    """Return the histories of estimates with their bands.

    Parameters
    ----------
    t : ndarray, shape (N,)
        Times in s.
    courses : mapping of str to tuple
        By parameter: estimates, standard deviations and their unit.
    """
    panels = []
    for name, (value, std, unit) in courses.items():
        curves = [Curve("estimate", t, value)]
        curves += [Curve("95 % band", t, value + s * _Z95 * std) for s in (-1, 1)]
        panels.append(Panel(name, pretty(unit), curves))
    return histories(panels, "parameters", "Histories of the estimated parameters") if panels else None


def _innovation_figure(run: FilterRun) -> Markup:
    panels = []
    for name, i in run.innovations.items():
        size, shown = shown_size(run.filter.model[name].unit)
        bound = _Z95 * np.sqrt(i.variances) / size
        curves = [Curve("innovation", i.t, i.values / size)]
        curves += [Curve("95 % bounds", i.t, s * bound) for s in (-1, 1)]
        panels.append(Panel(f"Innovation, {LABELS.get(name, name).lower()}", shown, curves))
    return histories(panels, "innovations", "Innovations with their 95 percent bounds")


def _consistency_figure(run: FilterRun) -> Markup:
    from scipy.special import chdtri

    panels = []
    for name, i in run.innovations.items():
        squares = i.normalised**2
        width = max(10, int(_WINDOW * squares.size))
        if squares.size <= width:
            continue
        sums = np.concatenate([[0.0], np.cumsum(squares)])
        mean, t = (sums[width:] - sums[:-width]) / width, i.t[i.taken][width - 1 :]
        low, high = (float(chdtri(width, p)) / width for p in (0.975, 0.025))
        curves = [Curve("estimate", t, mean)]
        curves += [Curve("95 % bounds", t, np.full(t.size, b)) for b in (low, high)]
        panels.append(Panel(f"NIS, {LABELS.get(name, name).lower()}, mean of {width} samples", "1", curves))
    return histories(panels, "nis", "Normalised innovations squared") if panels else Markup("")


def _signal_figure(run: FilterRun) -> Markup | None:
    panels, arranged = [], run.arranged
    for j, name in enumerate(run.filter.measured):
        shows = run.filter.model[name].quantity.measures or name
        if shows not in run.states:
            continue
        size, shown = shown_size(run.filter.model[shows].unit)
        there = arranged.there[:, j]
        curves = [
            Curve("measured", arranged.t[there], arranged.z[there, j] / size),
            Curve("estimate", run.t, run[shows] / size),
        ]
        panels.append(Panel(LABELS.get(shows, shows), shown, curves))
    return histories(panels, "signals", "Measured and filtered signals") if panels else None
