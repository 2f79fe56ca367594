"""IMO's manoeuvring criteria of an identified model, as the page shows them."""

from __future__ import annotations

from shipid.criteria.criteria import NOT_COVERED, Criteria, CriterionSide
from shipid.declaration.vocabulary import angle
from shipid.foundation.numbers import fixed, number
from shipid.report.page import Row, Section


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
    length, speed = found.length, found.speed
    head = (
        f"L {number(length)} m, V {number(speed, 3)} m/s, L/V {number(length / speed, 3)} s; turning circle with "
        f"{angle(found.rudder, 2)} of rudder. Each number is followed by its 95 % band."
    )
    rows = [
        {
            "meaning": row.meaning[:1].upper() + row.meaning[1:],
            "unit": row.unit,
            "starboard": _value(row.starboard),
            "starboard_band": _band_of(row.starboard),
            "port": _value(row.port),
            "port_band": _band_of(row.port),
            "limit": row.limit_text or "–",
            "within": row.within,
        }
        for row in found.rows
    ]
    view = {
        "refused": "",
        "head": head,
        "rows": rows,
        "spiral": _spiral(found),
        "notes": [*found.notes, *(f"Not covered: {what}." for what in NOT_COVERED)],
    }
    return _section(view)


def _section(view: Row) -> Section:
    return Section("Manoeuvring criteria", "fit/criteria.html", view)


def _value(side: CriterionSide) -> str:
    return side.words.partition(":")[0] if side.value is None else fixed(side.value, 2)


def _band_of(side: CriterionSide) -> str:
    return "" if side.value is None else _band(side.band95) or side.words


def _band(band: tuple[float, float] | None) -> str:
    return "" if band is None else f"{fixed(band[0], 2)} to {fixed(band[1], 2)}"


def _spiral(found: Criteria) -> str:
    s = found.spiral
    if s is None:
        return "The model has no steady turn to draw a spiral from."
    if s["half_width"]["value"] == 0:
        return "Spiral: no loop; the ship is stable on a straight course."
    height, band = s["loop_height"]["value"], _band(s["half_width"]["interval_95"])
    words = f"Spiral: the ship is unstable on a straight course; half width of the loop {fixed(s['half_width']['value'], 2)} deg"
    words += f" (95 % band {band} deg)" if band else ""
    words += f", height {number(height, 3)} deg/s" if height is not None else ""
    verdict = "within" if s["within"] else "beyond"
    return f"{words}; its width of {fixed(s['loop_width']['value'], 2)} deg is {verdict} the {s['limit_text']}."
