"""IMO's manoeuvring criteria of a model: a page of their own, and a section of the page of a fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from shipid.criteria.criteria import NOT_COVERED, OPEN, Criteria, Criterion, CriterionSide, spiral_words
from shipid.declaration.guard import NOT_SAILED
from shipid.declaration.vocabulary import angle
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief, given, number
from shipid.report.figures.comparisons import limits_drawing
from shipid.report.page import Page, Row, Section
from shipid.report.views.words import sentence, versions_now


def criteria_page(found: Criteria) -> Page:
    """Return what the page says of the criteria of a model.

    Parameters
    ----------
    found : Criteria
        The criteria.
    """
    return Page(
        f"Manoeuvring criteria of {found.ship} with model {found.model}",
        [("", _answer(found))],
        [_told(found, [n for n in found.notes if not isinstance(n, Notice)])],
        warnings=[sentence(n) for n in found.notes if isinstance(n, Notice) and n.serious],
        cautions=[sentence(n) for n in found.notes if isinstance(n, Notice) and not n.serious],
        footer=versions_now(),
    )


def _answer(found: Criteria) -> list[str]:
    """Which quantities are within their limits: the verdicts of the table in words."""
    said = []
    loop = _loop(found.spiral)
    for verdict, words in ((False, "Beyond the limit"), (True, "Within the limit")):
        names = [row.meaning for row in found.rows if row.within is verdict and not row.extrapolated]
        names += loop.get(verdict, [])
        said += [f"{words}: {'; '.join(names)}."] if names else []
        names = [row.meaning for row in found.rows if row.within is verdict and row.extrapolated]
        said += [f"{words} by extrapolation: {'; '.join(names)}."] if names else []
    open_ = [row.meaning for row in found.rows if row.within is None and row.limit is not None]
    open_ += loop.get(None, [])
    return [*said, *([f"Not decided: {'; '.join(open_)}."] if open_ else [])] or ["No value is judged."]


def _loop(spiral: Mapping[str, Plain] | None) -> dict[bool | None, list[str]]:
    """The width of the loop by its verdict; nothing where it is not judged, or a stable ship has none."""
    if spiral is None or (spiral["within"] is None and not spiral["words"]):
        return {}
    if spiral["within"] and spiral["loop_width"]["value"] == 0:
        return {}
    return {spiral["within"]: ["width of the spiral loop"]}


def criteria_section(found: Criteria | str | None) -> Section | None:
    """Return the section on IMO's criteria; None where they were not asked for.

    Parameters
    ----------
    found : Criteria, str or None
        The criteria of the model, or why there are none.
    """
    if found is None:
        return None
    if isinstance(found, str):
        return _section({"refused": found})
    return _told(found, found.notes)


def _told(found: Criteria, notes: Sequence[str]) -> Section:
    length, speed = found.length, found.speed
    head = (
        f"L {given(length)} m, V {brief(speed)} m/s, L/V {number(length / speed, 3)} s; turning circle with "
        f"{angle(found.rudder, 2)} of rudder."
    )
    if any(side.band95 for row in found.rows for side in (row.starboard, row.port)):
        head += " Each number is followed by its 95 % band."
    rows: list[Row] = [
        {
            "meaning": sentence(row.meaning),
            "verdict": row.verdict,
            "class": {True: "", False: "beyond", None: "" if row.limit is None else "undecided"}[row.within],
            "starboard": _value(row, row.starboard),
            "port": _value(row, row.port),
            "limit": row.limit_text or "none",
            # Of both sides once; what the model does not sail at all is told in a note.
            "remark": " ".join(
                ([f"{sentence(OPEN)}."] if row.within is None and row.open else [])
                + list(
                    dict.fromkeys(
                        _why(s) for s in (row.starboard, row.port) if s.value is None and NOT_SAILED not in s.words
                    )
                )
            ),
        }
        for row in found.rows
    ]
    view = {
        "refused": "",
        "head": head,
        "rows": rows,
        "spiral": _spiral(found),
        "figure": None if (drawing := limits_drawing(found.rows)) is None else drawing.svg("limits"),
        "notes": [*notes, *(f"Not covered: {what}." for what in NOT_COVERED)],
    }
    return _section(view)


def _section(view: Row) -> Section:
    return Section("Manoeuvring criteria", "criteria/criteria.html", view)


def _value(row: Criterion, side: CriterionSide) -> str:
    cell = row.cell(side).replace("-", "−")
    return row.cell(side) if side.value is None else f"{cell} {row.unit}"


def _why(side: CriterionSide) -> str:
    why = sentence(side.words.partition(":")[2].strip())
    return f"{why}." if why and not why.endswith(".") else why


def _spiral(found: Criteria) -> str:
    return f"Spiral: {spiral_words(found.spiral)}."
