"""A predicted track as a page: the answer, the plan, the stages of the turn, and what it began from."""

from __future__ import annotations

import shipid
from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import compass, display_unit, label, to_display
from shipid.foundation.numbers import fixed, last_place, number
from shipid.prediction.prediction import Prediction
from shipid.report.figures.tracks import along_figure, track_figure
from shipid.report.page import Page, Row, Section
from shipid.report.views.words import sentence

#: What is shown of a situation, with the units inside.
_UNITS = {
    "x": "m", "y": "m", "psi": "rad", "r": "rad/s", "u": "m/s", "v": "m/s", "delta": "rad", "current_north": "m/s",
    "current_east": "m/s", "wind_speed": "m/s", "wind_direction": "rad",
}  # fmt: skip
#: A value is rounded to so many decimals first: of a current to the east, the sine leaves a rest to the north.
_DECIMALS = 9
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
        answer.append(f"The 95 % band reaches {reach} to each side there.")
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


def _value(value: float, std: float | None) -> str:
    """A value with the digits that its standard deviation allows."""
    return number(round(value, _DECIMALS), 4) if std is None else fixed(value, max(0, last_place(std)))


def _situation(found: Prediction) -> list[Row]:
    known = found.situation
    rows: list[Row] = []
    for name, value in known.values.items():
        unit = _UNITS.get(name)
        if unit is None:
            continue
        told = float(to_display(value, name, unit))
        # A heading is told in compass degrees.
        told = told % 360 if name == "psi" else told
        known_std = known.told_std(name)
        std = float(to_display(known_std, name, unit)) if known_std else None
        rows.append(
            {
                "what": label(name),
                "value": _value(told, std),
                "std": "taken as known" if std is None else number(std, 2),
                "unit": pretty(display_unit(name, unit)),
            }
        )
    return rows
