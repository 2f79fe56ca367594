"""The picture that comes first: each trial's heading with the rudder and its track, measured and predicted, and how near they are."""

from __future__ import annotations

from shipid.foundation.numbers import number
from shipid.identification.fit import Fit
from shipid.identification.fit_text import fit_words
from shipid.identification.validation.comparison import Comparison
from shipid.report.figures.comparisons import heading_drawing, track_drawing
from shipid.report.figures.runaway import runaway
from shipid.report.page import Row, Section
from shipid.report.typography.quantities import shown

#: So many trials are drawn; the others are told in the details.
_DRAWN = 4


def picture_section(fit: Fit) -> Section:
    """Return the section of the pictures, trials that were not fitted first.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    pairs = [*(("not fitted", c) for c in fit.validation), *(("fitted", c) for c in fit.fitted)]
    views = [_picture(fit, role, c, f"p{k}") for k, (role, c) in enumerate(pairs[:_DRAWN])]
    left = [c.trial.name for _, c in pairs[_DRAWN:]]
    return Section(
        "Measured and predicted", "fit/picture.html", {"trials": views, "left": ", ".join(left)}, short="Picture"
    )


def error_rows(fit: Fit, comparison: Comparison) -> list[Row]:
    """Return a row a signal: rms error and fit, in units a reader expects.

    Parameters
    ----------
    fit : Fit
        The result.
    comparison : Comparison
        A trial beside its prediction.
    """
    lost, explained = runaway(comparison), comparison.fit_percent
    rows: list[Row] = []
    for name, value in comparison.rmse.items():
        how, again = shown(fit.model, name), comparison.refitted.get(name)
        rows.append(
            {
                "label": how.label,
                "unit": how.unit,
                "rms": "ran away" if lost is not None else f"{how.number(value)} {how.unit}",
                "fit": ""
                if lost is not None or name not in explained
                else fit_words(explained[name]).replace("-", "−"),
                "refitted": ""
                if again is None
                else "ran away"
                if how.number(again) == number(None)
                else f"{how.number(again)} {how.unit}",
            }
        )
    return rows


def _picture(fit: Fit, role: str, comparison: Comparison, key: str) -> Row:
    heading = heading_drawing({"predicted": comparison})
    track, note = track_drawing({"predicted": comparison})
    return {
        "name": comparison.trial.name,
        "role": role,
        "simulated": comparison.trial.source.simulated,
        "heading": None if heading is None else heading.svg(f"{key}-h"),
        "track": None if track is None else track.svg(f"{key}-t"),
        "note": note,
        "errors": error_rows(fit, comparison),
        "refitted": bool(comparison.refitted),
    }
