"""Recursive identification as a page: that of a filtered record, with one measured state."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shipid.foundation.numbers import fixed, moment
from shipid.identification.recursive.result import RecursiveIdentification
from shipid.report.figures.trials import Curve, Panel, halves, histories
from shipid.report.page import Page, Section
from shipid.report.typography.quantities import shown
from shipid.report.views.equations import equations_section
from shipid.report.views.filter.innovations import innovation_panel, innovation_row
from shipid.report.views.filter.parameters import last_estimates, parameters_section
from shipid.report.views.words import past_north, sentence, versions_now

#: The sections of the page, in order; one that has nothing to say is None. A new one is a line here and a template.
SECTIONS: list[Callable[[RecursiveIdentification], Section | None]] = [
    lambda run: parameters_section(run, run.design.model),
    lambda run: _signals(run),
    lambda run: _innovations(run),
    lambda run: _noise(run),
    lambda run: equations_section(run.design.model),
]


def recursive_page(run: RecursiveIdentification) -> Page:
    """Return what the page says of recursive identification.

    Parameters
    ----------
    run : RecursiveIdentification
        The run.
    """
    design = run.design
    answer = [f"{sentence(design.method.line)}; {run.t.size} samples of {run.record}."]
    answer += last_estimates(run)
    cautions = [*run.arranged.words, *(n for n in run.warnings if not n.serious)]
    return Page(
        f"Trial {run.record} identified recursively with model {design.model.name}",
        [("", answer)],
        [s for section in SECTIONS if (s := section(run)) is not None],
        [f"Not reliable: {run.why_diverged}"] if run.diverged else [],
        cautions,
        f"{run.t.size} samples, {moment(run.t[0])} to {moment(run.t[-1])} s. {versions_now()}",
    )


def _signals(run: RecursiveIdentification) -> Section:
    how = shown(run.design.model, run.design.output)
    measured = run.arranged.z[run.arranged.shown, 0] * how.factor
    there = run.arranged.there[run.arranged.shown, 0]
    curves = [Curve("measured beneath", run.t[there], measured[there]), Curve("estimate", run.t, run.y * how.factor)]
    title = "Measured and estimated signal"
    north = past_north(run.y * how.factor) if run.design.output == "psi" else ""
    figures = halves([Panel(how.label, how.unit, curves)], "signals", title)
    return Section("Filtered signals", "filter/signals.html", {"states": [], "figures": figures, "north": north})


def _innovations(run: RecursiveIdentification) -> Section:
    how, taken = shown(run.design.model, run.design.output), np.isfinite(run.innovations)
    values, variances = run.innovations[taken], run.innovation_variances[taken]
    nis = "" if run.nis_mean is None else fixed(run.nis_mean, 3)
    row = innovation_row(how, values, run.white_p, samples=str(values.size), rejected="0", nis=nis, band="")
    panel = innovation_panel(how, run.t[taken], values, variances)
    figure = histories([panel], "innovations", "Innovations with their 95 percent bounds")
    return Section("Innovations", "filter/innovations.html", {"rows": [row], "figure": figure, "consistency": None})


def _noise(run: RecursiveIdentification) -> Section:
    how = shown(run.design.model, run.design.output)
    sensor = {"name": run.design.sensor, "level": how.number(run.noise_level), "unit": how.unit}
    return Section("Noise levels", "filter/noise.html", {"sensors": [sensor], "sources": [], "added": []})
