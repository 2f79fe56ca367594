"""A trial, a voyage, a predicted track and records of filters as pages: what was recorded or estimated, against time and on a plan."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from markupsafe import Markup

import shipid
from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import FIELDS, display_factor, display_unit
from shipid.estimation.multiple.multiple_run import MultipleModelRun
from shipid.estimation.records.smoother import Smoothed
from shipid.foundation.numbers import fixed, moment
from shipid.foundation.statistics import NORMAL_95
from shipid.prediction.sailing.voyage import Voyage
from shipid.prediction.tracks.predicted_track import PredictedTrack
from shipid.report.figures.tracks import along_figure, heading_along, track_figure
from shipid.report.figures.trials import Curve, Panel, histories
from shipid.report.page import Page, Section
from shipid.report.typography.quantities import Shown, shown, shown_field
from shipid.report.views.record.plan import plan_figure
from shipid.report.views.words import listed, past_north, sentence, versions_now
from shipid.trials.measuring.track import track
from shipid.trials.trial import Trial

#: Signals come in this order, and no more than so many.
_FIRST, _MOST = ("psi", "r", "u", "v", "U", "SOG"), 8
#: What stands elsewhere: the clock, the plan, the panel of the rudder.
_APART = ("t", "x", "y", "delta", "delta_order")
#: What a voyage records beside a ship's own signals.
_LABELS = {
    "psi_order": "Ordered heading",
    "off_track": "Off the track, to starboard",
    "waypoint": "Waypoint that is sailed to",
}


def trial_page(trial: Trial) -> Page:
    """Return the page of a trial: its signals and its track.

    Parameters
    ----------
    trial : Trial
        The trial.
    """
    found = track(trial)
    return _page(
        f"Trial {trial.name}",
        _lines(trial.text()),
        _signals(_panels(trial), f"As {'simulated' if trial.source.simulated else 'recorded'}.{_north(trial)}"),
        {} if found is None else {found[2]: found[:2]},
    )


def voyage_page(voyage: Voyage) -> Page:
    """Return the page of a voyage along a route: its signals, and its track beside the plan.

    Parameters
    ----------
    voyage : Voyage
        The voyage.
    """
    trial, planned = voyage.trial, voyage.plan.line
    lines = {"track": (trial["x"], trial["y"]), "plan": (planned[:, 0], planned[:, 1])}
    return _page(
        f"Voyage {trial.name}", _lines(voyage.text()), _signals(_panels(trial), f"As simulated.{_north(trial)}"), lines
    )


def track_page(found: PredictedTrack) -> Page:
    """Return the page of a predicted track.

    Parameters
    ----------
    found : PredictedTrack
        The track.
    """
    view = {
        "figure": track_figure(found, "track"),
        "along": along_figure(found),
        "north": past_north(heading_along(found)),
        "route": False,
        "chart": None,
    }
    section = Section("Track", "prediction/plan.html", view)
    words = _lines(found.text())
    if found.half_width is None:
        words.append("No band: no spread was asked for.")
    return Page("Predicted track", [("", words)], [section], footer=f"shipid {shipid.__version__}")


def smoothed_page(found: Smoothed) -> Page:
    """Return the page of a smoothed record: each state with its 95 % band.

    Parameters
    ----------
    found : Smoothed
        The record.
    """
    design = found.design
    hidden = design.parameters.values()
    names = [*_in_order(n for n in design.model.states if n not in hidden), *design.parameters]
    panels = [_estimated(shown(design.model, n), found.t, found[n], found.std_of(n)) for n in names]
    return _page(
        f"{design.base.name}, smoothed",
        [
            f"{found.t.size} samples, {moment(found.t[0])} to {moment(found.t[-1])} s, smoothed with model "
            f"{design.base.name}: each estimate uses the whole record."
        ],
        _signals(
            panels,
            "Every estimate uses the whole record; dotted: 95 % band."
            + (past_north(np.degrees(found["psi"])) if "psi" in names else ""),
        ),
        _positions(found, design.model.states),
    )


def multiple_page(run: MultipleModelRun) -> Page:
    """Return the page of a record that a multiple-model filter has filtered: mode probabilities, states, track.

    Parameters
    ----------
    run : MultipleModelRun
        The run.
    """
    model = run.design.first.model
    modes = [
        Panel(f"Probability of {name}", "1", [Curve("estimate", run.t, run.probabilities[:, j])], span=(0.0, 1.0))
        for j, name in enumerate(run.modes)
    ]
    states = [_estimated(shown(model, n), run.t, *run.quantity(n)) for n in _in_order(run.states)]
    figure = histories(modes, "modes", "Probability of each mode along the record")
    first = Section("Modes", "record/modes.html", {"figure": figure, "caption": "How probable each mode is."})
    page = _page(
        f"{run.record}, by several models",
        [
            f"{run.t.size} samples, {moment(run.t[0])} to {moment(run.t[-1])} s, by a multiple-model filter of {len(run.modes)} modes. "
            f"Most probable at the end: {run.most_probable[-1]}, with a probability of {fixed(run.probabilities[-1].max(), 2)}."
        ],
        _signals(states, "Combined estimates; dotted: 95 % band."),
        _positions(run, run.states),
    )
    return Page(page.title, page.answers, [first, *page.sections], footer=versions_now())


def _page(
    title: str,
    words: Sequence[str],
    signals: Section | None,
    lines: dict[str, tuple[np.ndarray, np.ndarray]],
) -> Page:
    plan = plan_figure(lines, "Track, north up")
    if signals is not None and plan is not None:
        view = {**signals.view, "track": plan}
        sections = [Section("Against time, and the track", signals.template, view, "Record")]
    else:
        sections = [s for s in (signals, None if plan is None else _plan(plan)) if s is not None]
    return Page(title, [("", words)], sections, footer=f"shipid {shipid.__version__}")


def _plan(figure: Markup) -> Section:
    return Section("Track", "record/track.html", {"figure": figure, "caption": "North up."})


def _signals(panels: Sequence[Panel], caption: str) -> Section | None:
    if not panels:
        return None
    if left := [p.label.lower() for p in panels[_MOST:]]:
        caption += f" Not drawn: {listed(left)}."
    figure = histories(panels[:_MOST], "signals", f"Against time: {', '.join(p.label.lower() for p in panels[:_MOST])}")
    return Section("Against time", "record/signals.html", {"figure": figure, "caption": caption})


def _panels(trial: Trial) -> list[Panel]:
    """The signals of a trial against time, and the rudder with its order."""
    names = _in_order(n for n in trial.table.columns if n not in _APART and np.isfinite(trial[n]).any())
    panels, kind = [], "simulated" if trial.source.simulated else "measured"
    for name in names:
        how = shown_field(name) if name in FIELDS else _of_its_own(name, trial.unit(name))
        panels.append(Panel(how.label, how.unit, [Curve(kind, trial["t"], trial[name] * how.factor)]))
    how = shown_field("delta")
    rudder = [
        Curve(label, trial["t"], trial[n] * how.factor)
        for n, label in (("delta", "rudder"), ("delta_order", "order"))
        if trial.has(n) and np.isfinite(trial[n]).any()
    ]
    if rudder:
        # After what is drawn in any case, so that it is drawn too.
        panels.insert(min(len(panels), _MOST - 1), Panel(how.label, how.unit, rudder))
    return panels


def _north(trial: Trial) -> str:
    return past_north(np.degrees(trial["psi"])) if trial.has("psi") else ""


def _in_order(names: Iterable[str]) -> list[str]:
    """The signals that every reader looks for, then the others; two positions are on the plan."""
    found = list(names)
    planned = ("x", "y") if {"x", "y"} <= set(found) else ()
    first = [n for n in _FIRST if n in found]
    return [*first, *(n for n in found if n not in (*first, *planned))]


def _of_its_own(name: str, unit: str) -> Shown:
    """How a column outside the vocabulary is shown."""
    return Shown(_LABELS.get(name, name), pretty(display_unit(name, unit)), display_factor(name, unit))


def _estimated(how: Shown, t: np.ndarray, value: np.ndarray, std: np.ndarray) -> Panel:
    band = [Curve("95 % band", t, (value + s * NORMAL_95 * std) * how.factor) for s in (-1, 1)]
    return Panel(how.label, how.unit, [Curve("estimate", t, value * how.factor), *band])


def _positions(found: Smoothed | MultipleModelRun, states: Sequence[str]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    return {"estimate": (found["x"], found["y"])} if {"x", "y"} <= set(states) else {}


def _lines(text: str) -> list[str]:
    return [sentence(line.strip()) + "." for line in text.splitlines()[:2]]
