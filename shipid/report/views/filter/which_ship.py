"""Which of several ships a record was sailed by, as a page."""

from __future__ import annotations

from shipid.estimation.multiple.which_ship import WhichShip
from shipid.foundation.numbers import fixed, moment
from shipid.report.figures.trials import Curve, Panel, halves
from shipid.report.page import Page, Section
from shipid.report.typography.quantities import shown
from shipid.report.views.equations import equations_section
from shipid.report.views.words import versions_now


def which_ship_page(found: WhichShip) -> Page:
    """Return what the page says of the ships compared.

    Parameters
    ----------
    found : WhichShip
        The comparison.
    """
    run = found.run
    return Page(
        f"Trial {run.record}: which ship sails, with model {run.design.first.base.name}",
        [("", [found.answer])],
        [_probabilities(found), _noise(found), equations_section(run.design.first.base)],
        [str(n) for n in found.warnings if n.serious],
        [
            *(str(n) for n in found.warnings if not n.serious),
            "The probabilities compare the ships given: that one is the most probable does not say that it is right.",
            *run.arranged.words,
        ],
        f"{run.t.size} samples, {moment(run.t[0])} to {moment(run.t[-1])} s. {versions_now()}",
    )


def _probabilities(found: WhichShip) -> Section:
    run, last = found.run, found.run.probabilities[-1]
    rows = [
        {
            "name": n,
            "end": fixed(last[j], 4),
            "mean": fixed(run.probabilities[:, j].mean(), 4),
            "alone": fixed(found.log_likelihoods[n], 1),
        }
        for j, n in enumerate(run.modes)
    ]
    panels = [
        Panel(f"probability of {n}", "1", [Curve("estimate", run.t, run.probabilities[:, j])], span=(0.0, 1.0))
        for j, n in enumerate(run.modes)
    ]
    figures = halves(panels, "ships", "Along the record")
    return Section("Ships", "filter/ships.html", {"rows": rows, "figures": figures})


def _noise(found: WhichShip) -> Section:
    design = found.run.design.first
    sensors = []
    for name, level in zip(design.measured, design.r):
        how = shown(design.model, name)
        sensors.append({"name": name, "level": how.number(float(level)), "unit": how.unit})
    return Section("Noise levels", "filter/noise.html", {"sensors": sensors, "sources": [], "added": []})
