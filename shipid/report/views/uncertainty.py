"""How far an identified model may be believed, as the page shows it: criteria, directions, residuals."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from shipid.criteria.criteria import Criteria, CriterionSide
from shipid.criteria.manoeuvring_criteria import manoeuvring_criteria
from shipid.foundation.errors import ShipidError
from shipid.identification.fit import Fit
from shipid.report.typography.numbers import fixed, number
from shipid.report.views.trial import label_of, shown_unit

#: Draws for the bands of the criteria: five manoeuvres to both sides for each of them, on a page that is to be quick.
_DRAWS = 12


@functools.lru_cache(maxsize=4)
def _criteria_of(fit: Fit) -> Criteria | str:
    """The criteria of a fit, or why there are none."""
    try:
        return manoeuvring_criteria(fit, draws=_DRAWS)
    except ShipidError as error:
        return str(error)


def criteria_view(fit: Fit) -> dict[str, Any] | None:
    """Return the section on IMO's criteria, or None where the ship's length is unknown.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    if fit.ship.particular("L", "m") is None:
        return None
    found = _criteria_of(fit)
    if isinstance(found, str):
        return {"refused": found, "head": "", "rows": [], "spiral": "", "notes": []}
    rows = [
        {
            "meaning": row.meaning,
            "unit": row.unit,
            "starboard": _side(row.starboard),
            "port": _side(row.port),
            "limit": row.limit_text,
            "within": row.within,
        }
        for row in found.rows
    ]
    length, speed = found.length, found.speed
    head = (
        f"L {number(length)} m, V {number(speed, 3)} m/s, L/V {number(length / speed, 3)} s; turning circle with "
        f"{fixed(float(np.rad2deg(found.rudder)), 0)} deg of rudder. Each number is followed by its 95 % band."
    )
    return {"refused": "", "head": head, "rows": rows, "spiral": _spiral(found), "notes": list(found.notes)}


def _side(side: CriterionSide) -> dict[str, str]:
    if side.value is None:
        return {"value": side.words.partition(":")[0], "band": ""}
    return {"value": fixed(side.value, 2), "band": band_text(side.band95, 2) or side.words}


def band_text(band: tuple[float, float] | None, decimals: int, scale: float = 1.0) -> str:
    """Return ``2.75 to 3.46``, or nothing where there is no band.

    Parameters
    ----------
    band : tuple of float or None
        Both ends.
    decimals : int
        Decimals.
    scale : float
        What both are multiplied by.
    """
    return "" if band is None else f"{fixed(band[0] * scale, decimals)} to {fixed(band[1] * scale, decimals)}"


def _spiral(found: Criteria) -> str:
    s = found.spiral
    if s is None:
        return "The model has no steady turn to draw a spiral from."
    if s["half_width_deg"] == 0:
        return "Spiral: no loop; the ship is stable on a straight course."
    height = s["loop_height_deg_s"]
    band = s["half_width_band95_deg"]
    words = (
        f"Spiral: the ship is unstable on a straight course; half width of the loop {fixed(s['half_width_deg'], 2)} deg"
    )
    words += f" (95 % band {band_text(band, 2)} deg)" if band else ""
    return words + (f", height {number(height, 3)} deg/s." if height is not None else ".")


def directions_view(fit: Fit) -> list[dict[str, str]]:
    """Return the directions in which the coefficients may move together, in words.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    return [
        {
            "names": ", ".join(d.parameters),
            "spread": "open" if d.relative_std is None else f"±{100 * d.relative_std:.2g} %",
            "words": d.words,
        }
        for d in (fit.assessment.directions if fit.assessment else ())
    ]


def residuals_view(fit: Fit) -> list[dict[str, Any]]:
    """Return one row a signal: noise level, effective samples, whiteness, chi-square.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    rows = []
    for name, level in fit.noise.items():
        unit, scale = shown_unit(fit.model, name)
        found = fit.assessment.residuals.get(name) if fit.assessment else None
        row: dict[str, Any] = {"label": label_of(fit.model, name), "level": number(level * scale, 3), "unit": unit}
        if found is None:
            row |= {"effective": "none", "time": "–", "p": "–", "white": None, "chi": "–"}
        else:
            row |= {
                "effective": f"{found.effective:.0f} of {found.samples}",
                "time": number(found.autocorrelation_time_s, 2),
                "p": "below 0.0001" if found.p_value < 1e-4 else fixed(found.p_value, 4),
                "white": found.white,
                "chi": number(found.chi_square, 3),
            }
        rows.append(row)
    return rows
