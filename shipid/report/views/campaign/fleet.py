"""The trials of a fleet as a page: one row a trial, and the scatter of the coefficients."""

from __future__ import annotations

from collections.abc import Iterator

from markupsafe import Markup

import shipid
from shipid.campaign.fleet import PARTS
from shipid.campaign.fleet_result import FleetResult
from shipid.declaration.units import pretty
from shipid.estimation.standing import DETERMINED, NEAR_ZERO, UNKNOWN
from shipid.foundation.numbers import number, uncertain
from shipid.foundation.statistics import plain
from shipid.report.page import Page, Row, Section
from shipid.report.views.campaign.fleet_figure import fleet_figure
from shipid.report.views.campaign.page import provenance_rows
from shipid.report.views.words import count, listed, sentence


def fleet_page(found: FleetResult) -> Page:
    """Return what the page says of a fleet.

    Parameters
    ----------
    found : FleetResult
        The fleet.
    """
    names, total = list(found.coefficients), len(found.rows["trial"])
    units = {n: pretty(found.coefficients[n].unit) for n in names}
    columns = [
        ("Outcome", "outcome", "keep"),
        *((f"{n} [{units[n]}]" if units[n] != "1" else n, n) for n in names),
    ]
    rows = [_row(found, k) for k in range(total)]
    return Page(
        f"{found.model} identified from {count(total, 'trial')}",
        [("", list(_answer(found)))],
        [
            Section("Trials", "campaign/trials.html", {"columns": columns, "rows": rows}),
            Section(
                "Over the trials",
                "campaign/scatter.html",
                {"rows": _scatter(found), "figure": fleet_figure(found, "fleet")},
            ),
            Section("Provenance", "campaign/provenance.html", {"rows": provenance_rows(found.provenance)}),
        ],
        warnings=[sentence(w) for w in found.warnings if w.serious],
        cautions=[sentence(w) for w in found.warnings if not w.serious],
        footer=f"shipid {shipid.__version__}",
    )


def _answer(found: FleetResult) -> Iterator[str]:
    good, total = int(found.identified.sum()), len(found.rows["trial"])
    ship = f" with ship {found.ship}" if found.ship else ""
    yield f"{'Each was' if good == total else f'{good} of {total} were'} identified{ship}."
    several = {n: s for n, s in found.coefficients.items() if s.probability is not None}
    agreed = [n for n, s in several.items() if not s.differs]
    if agreed:
        yield f"The trials agree on {listed(agreed)}."
    told = {n: set(found.rows[f"{n}_{PARTS[3]}"]) - {""} for n, s in found.coefficients.items() if not s.count}
    small = [n for n, standings in told.items() if standings == {NEAR_ZERO}]
    for what, names in ((UNKNOWN, [n for n in told if n not in small]), (NEAR_ZERO, small)):
        if names:
            yield f"{what.capitalize()} by any of these trials: {listed(names)}."


def _row(found: FleetResult, k: int) -> Row:
    rows = found.rows
    row: dict[str, object] = {
        "what": str(rows["trial"][k]),
        "outcome": str(rows["outcome"][k]),
        "remark": " ".join(_remarks(str(rows["message"][k]), str(rows["doctor"][k]))),
    }
    for name in found.coefficients:
        value, std = (plain(float(rows[c][k])) for c in (name, f"{name}_std"))
        text = "–" if value is None else uncertain(value, std)
        standing = rows[f"{name}_{PARTS[3]}"][k]
        kept = Markup('<span class="keep">{}</span>').format(text)
        row[name] = kept if value is None or standing == DETERMINED else kept + f", {standing}"
    return row


def _remarks(message: str, doctor: str) -> Iterator[str]:
    """Why a trial was not identified, and what the check of it found serious."""
    if message:
        yield message
    if doctor:
        yield f"Check: {doctor}."


def _scatter(found: FleetResult) -> list[Row]:
    return [
        {
            "what": name,
            "count": str(s.count),
            "mean": "–" if s.mean is None else uncertain(s.mean, s.mean_std),
            "scatter": "" if s.scatter is None else number(s.scatter, 2),
            "probability": "" if s.probability is None else number(s.probability, 2),
            "unit": pretty(s.unit),
            "remark": sentence(s.meaning) + "." if s.meaning else "",
        }
        for name, s in found.coefficients.items()
    ]
