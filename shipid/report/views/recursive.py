"""Recursive identification as the page shows it: the page of a filtered record, with one measured state."""

from __future__ import annotations

from importlib import metadata

import numpy as np

import shipid
from shipid.generation.typesetting.typeset import typeset
from shipid.identification.recursive.result import RecursiveIdentification
from shipid.report.figures.trials import Curve, Panel, histories
from shipid.report.typography.numbers import fixed, number, uncertain
from shipid.report.views.filter import FilterView, parameter_figure, parameter_row, shown_size
from shipid.report.views.trial import LABELS

_Z95 = 1.959963984540054
_COLOURED = 0.01


def recursive_view(run: RecursiveIdentification) -> FilterView:
    """Return what the page says of recursive identification.

    Parameters
    ----------
    run : RecursiveIdentification
        The run.
    """
    identifier, model, output = run.identifier, run.identifier.model, run.identifier.output
    size, unit = shown_size(model[output].unit)
    label = LABELS.get(output, output)
    taken = np.isfinite(run.innovations)
    e, bound = run.innovations[taken] / size, _Z95 * np.sqrt(run.innovation_variances[taken]) / size
    t = run.t[taken]
    white = run.white_p
    answer = [
        f"{identifier.method.line[:1].upper()}{identifier.method.line[1:]}; {run.t.size} samples of {run.record}."
    ]
    answer += [f"{n} ended at {uncertain(p.value, p.std)}." for n, p in run.parameters.items()]
    measured = run.arranged.z[run.arranged.shown, 0] / size
    there = run.arranged.there[run.arranged.shown, 0]
    return FilterView(
        title=f"{model.name} on {run.record}, by {identifier.method.name}",
        answer=answer,
        warnings=[f"Not to be believed: {run.why_diverged}"] if run.diverged else [],
        cautions=[]
        if white is None or white >= _COLOURED
        else [f"The innovations are not white (p {white:.1g}): the model leaves something in them."],
        parameters=[parameter_row(p, model[n]) for n, p in run.parameters.items()],
        parameter_figure=parameter_figure(run.t, {n: (run[n], run.std_of(n), model[n].unit) for n in run.parameters}),
        innovations=[
            {
                "label": label,
                "samples": str(t.size),
                "rejected": "0",
                "rms": number(float(np.sqrt(np.mean(e**2))), 3) if e.size else "–",
                "unit": unit,
                "nis": "–" if run.nis_mean is None else fixed(run.nis_mean, 3),
                "band": "–",
                "p": "–" if white is None else f"{white:.2g}",
                "white": None if white is None else white >= _COLOURED,
            }
        ],
        innovation_figure=histories(
            [
                Panel(
                    f"Innovation, {label.lower()}",
                    unit,
                    [Curve("innovation", t, e), *(Curve("95 % bounds", t, s * bound) for s in (-1, 1))],
                )
            ],
            "innovations",
            "Innovations with their 95 percent bounds",
        ),
        consistency_figure=None,
        signal_figure=histories(
            [
                Panel(
                    label,
                    unit,
                    [Curve("measured", run.t[there], measured[there]), Curve("estimate", run.t, run.y / size)],
                )
            ],
            "signals",
            "Measured signal, and as the recursion remembers it",
        ),
        states=[],
        sensors=[{"name": identifier.sensor, "level": number(run.noise_level / size, 3), "unit": unit}],
        sources=[],
        equations=[
            {"plain": e.plain, "source": e.source, "where": f"{e.component}.{e.method}"} for e in typeset(model)
        ],
        model_name=model.name,
        record=f"{run.t.size} samples, {run.t[0]:g} to {run.t[-1]:g} s",
        versions={"shipid": shipid.__version__, **{n: metadata.version(n) for n in ("casadi", "numpy", "scipy")}},
    )
