"""A predicted track as a page: the answer, the plan, the stages of the turn, and what it began from."""

from __future__ import annotations

import shipid
from shipid.declaration.vocabulary import compass, label
from shipid.foundation.numbers import fixed, number
from shipid.prediction.prediction import Prediction
from shipid.report.figures.tracks import along_figure, heading_along, track_figure
from shipid.report.page import Page, Row, Section
from shipid.report.views.words import past_north, sentence

#: What is shown of a situation.
_SHOWN = ("x", "y", "psi", "r", "u", "v", "delta", "current_north", "current_east", "wind_speed", "wind_direction")
#: The columns of the stages.
_COLUMNS = [
    ("Time [s]", "t", "n"), ("Ahead [m]", "ahead", "n"), ("Aside [m]", "aside", "n"), ("Heading [deg]", "heading", "n"),
    ("Speed [m/s]", "speed", "n"), ("95 % band [m]", "band", "n"),
]  # fmt: skip


def prediction_page(found: Prediction) -> Page:
    """Return what the page says of a prediction.

    Parameters
    ----------
    found : Prediction
        The prediction.
    """
    track = found.track
    last = found.stages[-1]
    answer = [
        f"Order: {track.order}.",
        f"The track is {number(track.s_star[-1], 3)} ship lengths and {fixed(last.t, 0)} s long; at its end the ship is "
        f"{_away(last.ahead, 'ahead', 'astern')} and {_away(last.aside, 'to starboard', 'to port')} of where she was.",
    ]
    answer += [f"{sentence(line)}." for line in found.surrounding_words]
    if found.turn is not None:
        answer += [f"{sentence(line)}." for line in found.turn.words]
    if last.half_width is not None:
        reach = f"{fixed(last.half_width, 0)} m" if last.half_width >= 0.5 else "less than 1 m"
        answer.append(f"At the end of the track the 95 % band reaches {reach} to each side.")
    serious = [sentence(w) for w in found.warnings if w.serious]
    others = [sentence(w) for w in found.warnings if not w.serious]
    return Page(
        f"Predicted track of {found.ship}",
        [("", answer)],
        [
            Section("Track", "prediction/plan.html", _plan(found)),
            Section("Stages", "prediction/stages.html", {"columns": _COLUMNS, "rows": _stages(found)}),
            Section(
                "Where it begins", "prediction/situation.html", {"origin": found.origin, "rows": _situation(found)}
            ),
        ],
        warnings=serious,
        cautions=others,
        footer=f"shipid {shipid.__version__}",
    )


def _plan(found: Prediction) -> Row:
    """The figure, and what it shows below the track."""
    turn, chart, track = found.turn, found.chart, found.track
    now = None if turn is None or turn.wheel_over is None or turn.wheel_over.due else turn.now
    figure = track_figure(track, "track", turn=turn, chart=chart, now=now)
    return {
        "figure": figure,
        "along": along_figure(track),
        "north": past_north(heading_along(track)),
        "route": turn is not None,
        "chart": None if chart is None else chart.name,
    }


def _away(metres: float, forward: str, back: str) -> str:
    return f"{fixed(abs(metres), 0)} m {forward if metres >= 0 else back}"


def _stages(found: Prediction) -> list[Row]:
    return [
        {
            "what": sentence(s.what),
            "t": fixed(s.t, 0),
            "ahead": fixed(s.ahead, 0),
            "aside": fixed(s.aside, 0),
            "heading": compass(s.heading),
            "speed": fixed(s.speed, 2),
            "band": s.band_words,
        }
        for s in found.stages
    ]


def _situation(found: Prediction) -> list[Row]:
    rows: list[Row] = []
    for name in (n for n in found.situation.values if n in _SHOWN):
        value, std, unit = found.situation.told(name)
        value = value.replace("-", "−")
        rows.append({"what": label(name), "value": value, "std": std or "taken as known", "unit": unit})
    return rows
