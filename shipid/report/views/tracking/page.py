"""Tracks as a page: the answer, the plan, each target, how fast and in which mode she was, and the truth where it is known."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

import shipid
from shipid.declaration.vocabulary import compass
from shipid.encounter.tracking.scoring import HORIZONS, TrackingScore
from shipid.encounter.tracking.target_track import TargetTrack
from shipid.encounter.tracking.tracking import Tracking
from shipid.foundation.numbers import counted, fixed
from shipid.report.figures.charts import Axes, Line, chart
from shipid.report.figures.targets import targets_figure
from shipid.report.page import Page, Row, Section
from shipid.report.views.words import count, sentence

_TARGETS = [
    ("Target", "number"), ("Status", "status"), ("From [s]", "first", "n"), ("To [s]", "last", "n"), ("North [m]", "x", "n"),
    ("East [m]", "y", "n"), ("± [m]", "spread", "n"), ("Speed [m/s]", "speed", "n"), ("Course [deg]", "course", "n"),
    ("CPA [m]", "cpa", "n"), ("CPA 95 % [m]", "between", "n"), ("TCPA [s]", "tcpa", "n"),
]  # fmt: skip
_JUDGED = [
    ("Ship", "name"), ("Scans visible", "visible", "n"), ("Held [%]", "held", "n"),
    *((f"Error {h:.0f} s ahead [m]" if h else "Error now [m]", f"e{k}", "n") for k, h in enumerate(HORIZONS)), ("NEES", "nees", "n"),
]  # fmt: skip
#: Tracks whose speeds are drawn: the ones that were held longest.
_MOST = 4


def tracking_page(found: Tracking) -> Page:
    """Return what the page says of tracks.

    Parameters
    ----------
    found : Tracking
        The tracks.
    """
    first, last = found.plots.span
    held = [one for one in found.tracks if one.status == "held"]
    answer = [
        f"{counted(len(found.plots), 'plot')} in {counted(len(found.plots.scans), 'scan')} over {fixed(last - first, 0)} s gave "
        f"{count(len(found.tracks), 'confirmed track')}; {count(len(held), 'track')} {'is' if len(held) == 1 else 'are'} held at the end.",
    ]
    answer.append(sentence(found.nearest_words) + ".")
    longest = sorted(found.tracks, key=lambda o: -int(o.held.sum()))[:_MOST]
    shown = sorted(longest, key=lambda o: o.number)
    sections = [
        Section(
            "Plan",
            "tracking/plan.html",
            {
                "motion": _motion(shown) if shown else None,
                "modes": _modes(found, longest[0]) if shown else None,
                "figure": targets_figure(found, "plan"),
                "caption": f"The tracks, in metres from {found.plots.frame}"
                + (", relative to own ship" if found.relative else "")
                + "; dots are plots, and the line ahead of each track is a minute long.",
            },
        ),
        Section("Targets", "tracking/targets.html", {"columns": _TARGETS, "rows": [_row(o) for o in found.tracks]}),
    ]
    if found.score is not None:
        sections.append(Section("Beside the truth", "tracking/judged.html", _judged(found.score)))
    return Page(
        f"Tracks of {found.name}",
        [("", answer)],
        sections,
        warnings=[sentence(w) for w in found.warnings if w.serious],
        cautions=[sentence(w) for w in found.warnings if not w.serious],
        footer=f"shipid {shipid.__version__}",
    )


def _row(one: TargetTrack) -> Row:
    near = one.approach
    ends = None if near is None else near.cpa_interval
    return {
        "number": f"track {one.number}",
        "status": one.status,
        "first": fixed(one.t[0], 0),
        "last": fixed(one.t[-1], 0),
        "x": fixed(one.x[-1, 0], 0),
        "y": fixed(one.x[-1, 1], 0),
        "spread": fixed(float(np.sqrt(max(one.P[-1, 0, 0] + one.P[-1, 1, 1], 0.0))), 0),
        "speed": f"{fixed(float(one.speed[-1]), 1)} ± {fixed(float(one.speed_std[-1]), 1)}",
        "course": compass(float(one.course[-1]), 0) if one.moves[-1] else "none",
        "cpa": "not known" if near is None or near.motion == "unsure" else fixed(near.cpa, 0),
        "between": "" if ends is None else f"{fixed(ends[0], 0)} to {fixed(ends[1], 0)}",
        "tcpa": "" if near is None else fixed(near.tcpa, 0) if np.isfinite(near.tcpa) else near.motion,
    }


def _motion(shown: list[TargetTrack]) -> Markup:
    def lines(values: list[np.ndarray]) -> list[Line]:
        return [Line(f"track {o.number}", o.t, v, colour=k) for k, (o, v) in enumerate(zip(shown, values))]

    panels = [
        Axes("Speed over ground", "m/s", lines([o.speed for o in shown])),
        Axes("Course over ground", "deg", lines([course_shown(o) for o in shown])),
    ]
    return chart(panels, "Time since the first plot [s]", "motion", "Speed and course")


def course_shown(one: TargetTrack) -> np.ndarray:
    """Return the course without jumps at north, in deg, its median between 0 and 360; NaN where the target may lie still.

    Parameters
    ----------
    one : TargetTrack
        The track.
    """
    moving = one.moves
    course = np.full(one.t.size, np.nan)
    course[moving] = np.rad2deg(np.unwrap(one.course[moving]))
    return course - 360.0 * np.floor(np.median(course[moving]) / 360.0) if moving.any() else course


def _modes(found: Tracking, one: TargetTrack) -> Markup | None:
    """The modes that are most probable on the whole; None where there is one only."""
    if len(found.modes) < 2:
        return None
    most = sorted(np.argsort(-one.mu.mean(axis=0))[:_MOST])
    lines = [Line(found.modes[k], one.t, one.mu[:, k], colour=i) for i, k in enumerate(most)]
    axes = [Axes(f"Mode probability of track {one.number}", "1", lines)]
    return chart(axes, "Time since the first plot [s]", "modes", "Mode probabilities")


def _judged(score: TrackingScore) -> dict[str, object]:
    rows: list[Row] = []
    for ship in score.ships:
        if ship.held is None:
            continue
        errors = {f"e{k}": "not known" if e is None else fixed(e, 1) for k, e in enumerate(ship.rmse)}
        nees = "not known" if ship.nees is None else fixed(ship.nees, 1)
        rows.append(
            {"name": ship.name, "visible": ship.visible, "held": fixed(100 * ship.held, 0), "nees": nees, **errors}
        )
    words = (
        f"{_false(score)} A track within {fixed(score.near, 0)} m is a ship's. The stated spread fits the error where the NEES is 2; "
        "far above it, the error is larger than stated."
    )
    return {"words": words, "columns": _JUDGED, "rows": rows}


def _false(score: TrackingScore) -> str:
    """What moves where no ship is."""
    false, surely = score.false_tracks, score.false_movers
    if not false:
        return "No confirmed track moves where no ship is within 250 m."
    rate = "" if score.false_rate is None else f", {fixed(score.false_rate, 2)} a minute"
    rest = "" if surely == false else f", {count(surely, 'track')} surely; the others may lie still"
    moves = "moves" if false == 1 else "move"
    return sentence(f"{count(false, 'confirmed track')} {moves} where no ship is within 250 m{rate}{rest}.")
