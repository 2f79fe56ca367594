"""The sheet of a trial day as a page: the verdicts, each manoeuvre with its plot and its numbers, the poster, the record."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import shipid
from shipid.criteria.measured.form import FormEntry
from shipid.criteria.measured.measured_criteria import MeasuredCriterion
from shipid.criteria.measured.sheet import QUARTERS, SheetManoeuvre, TrialSheet, rudder_of
from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import to_display
from shipid.foundation.notices import notice_of
from shipid.foundation.numbers import fixed, given, number, uncertain
from shipid.report.figures.manoeuvres import manoeuvre_figure
from shipid.report.page import Page, Row, Section
from shipid.report.views.words import count, listed, sentence
from shipid.trials.measuring.results.measures import Measures
from shipid.trials.measuring.results.turning_circle import TurningCircle
from shipid.trials.trial import Trial

_GROUPS = (
    ("ship", "The ship"), ("loading", "Loading"), ("surroundings", "Place and surroundings"), ("trial", "The trial"),
)  # fmt: skip
_LIMITS = [
    ("Quantity", "meaning"), ("Verdict", "verdict", "keep"), ("Measured", "value", "n"), ("Limit", "limit", "keep"),
]  # fmt: skip
#: What the figure of a manoeuvre shows, by the class of its measures.
_CAPTIONS = {
    "ZigZag": "Heading and rudder; each overshoot is marked. The tables count time from the beginning of the record; ± is the 95 % uncertainty.",
    "TurningCircle": "The track of the circle, averaged as for its dimensions, with the ship's outline; ± is the 95 % uncertainty.",
    "MeasuredSpiral": "Steady rate of turn against rudder angle.",
    "PullOut": "Rate of turn after the rudder is put amidships.",
}
_NUMBERS = [("Quantity", "name"), ("Measured", "value", "n"), ("Meaning", "meaning", "wide")]
#: A ratio to the ship length stands beside the distance itself, and so does the same in still water.
_RATIO, _STILL = "_ratio", "_still_water"
#: So many quantities that are not known for one reason are told of in one sentence.
_SHARED = 3


def sheet_page(sheet: TrialSheet) -> Page:
    """Return what the page says of a trial day.

    Parameters
    ----------
    sheet : TrialSheet
        The sheet.
    """
    name = sheet.conditions.shown("ship")
    sections = []
    if sheet.criteria:
        rows = _limit_rows(sheet.criteria)
        known = any(row.uncertainty is not None for row in sheet.criteria)
        sections.append(
            Section("Beside the limits", "sheet/limits.html", {"columns": _LIMITS, "rows": rows, "uncertain": known})
        )
    if sheet.manoeuvres:
        shown = [_manoeuvre(m, sheet.length) for m in sheet.manoeuvres]
        meanings = {f"{r['name']}: {r['meaning']}" for m in sheet.manoeuvres for r in _single(m.measures)}
        view = {"manoeuvres": shown, "meanings": _in_order(meanings)}
        sections.append(Section("Manoeuvres", "sheet/manoeuvres.html", view))
    poster = _poster(sheet)
    if poster["rows"]:
        sections.append(Section("Turning circles for the wheelhouse poster", "sheet/poster.html", poster, "Poster"))
    if sheet.not_measured:
        lost = [{"trial": one.trial, "why": one.why} for one in sheet.not_measured]
        sections.append(Section("Not measured", "sheet/lost.html", {"rows": lost}))
    groups = [(title, [{"what": n, "value": v} for n, v in sheet.conditions.lines(key)]) for key, title in _GROUPS]
    form = [_form_row(entry) for entry in sheet.form]
    sections.append(Section("Record of the trial", "sheet/record.html", {"groups": groups, "form": form}))
    return Page(
        f"Manoeuvring trials{f' of {name}' if name else ''}",
        [("", list(_answer(sheet)))],
        sections,
        warnings=[sentence(w) for w in sheet.warnings if w.serious],
        cautions=[sentence(w) for w in sheet.warnings if not w.serious],
        footer=f"shipid {shipid.__version__}",
    )


def measures_page(measures: Measures) -> Page:
    """Return the page of one manoeuvre: its plot and its numbers.

    Parameters
    ----------
    measures : Measures
        The manoeuvre, as it was measured.
    """
    shown = _numbers(measures, measures.record, measures.title, None, "m1")
    view = {"manoeuvres": [shown], "meanings": _in_order(f"{r['name']}: {r['meaning']}" for r in _single(measures))}
    serious = [sentence(note) for note in map(notice_of, measures.notes) if note.serious]
    return Page(
        f"{sentence(measures.title)} in trial {measures.trial}",
        [],
        [Section("Manoeuvres", "sheet/manoeuvres.html", view)],
        warnings=serious,
        footer=f"shipid {shipid.__version__}",
    )


def _in_order(meanings: Iterable[str]) -> list[str]:
    """Meanings by the names of their quantities."""
    return sorted(meanings, key=lambda words: words.partition(":")[0])


def _answer(sheet: TrialSheet) -> Iterator[str]:
    when = sheet.conditions.shown("date")
    yield sentence(f"{count(len(sheet.manoeuvres), 'manoeuvre')} measured{f', {when}' if when else ''}.")
    for verdict, words in (
        ("beyond", "beyond the limit"),
        ("not decided", "not decided"),
        ("within", "within the limit"),
    ):
        named: dict[str, list[str]] = {}
        for row in sheet.criteria:
            if row.verdict == verdict:
                named.setdefault(row.meaning, []).append(str(row.manoeuvre))
        if named:
            told = [f"{what} of manoeuvre{'s' * (len(them) > 1)} {listed(them)}" for what, them in named.items()]
            yield sentence(f"{words}: {'; '.join(told)}.")
    if not any(row.verdict != "no limit" for row in sheet.criteria):
        yield "No manoeuvre of the standard is among them, so no limit is compared."


def _form_row(entry: FormEntry) -> Row:
    value = None
    if entry.value is not None:
        value = given(float(f"{entry.value:.3g}")) + ("" if entry.unit == "1" else f" {pretty(entry.unit)}")
    return {"what": entry.label, "value": value, "asked": entry.asked, "met": entry.met}


def _limit_rows(criteria: Iterable[MeasuredCriterion]) -> list[Row]:
    """A row each; what holds for several quantities of a manoeuvre is said below the first of them."""
    rows: list[Row] = []
    said: set[tuple[int, str]] = set()
    for one in criteria:
        told = (one.manoeuvre, one.words) in said
        rows.append({**_limit_row(one), **({"remark": ""} if told else {})})
        said.add((one.manoeuvre, one.words))
    return rows


def _limit_row(row: MeasuredCriterion) -> Row:
    value = number(row.value, 3) if row.uncertainty is None else uncertain(row.value, row.uncertainty)
    return {
        "meaning": f"{row.manoeuvre}. {sentence(row.meaning)}",
        "value": "not known" if row.value is None else f"{value} {pretty(row.unit)}",
        "limit": row.limit_text,
        "verdict": row.verdict,
        "class": {"beyond": "beyond", "not decided": "undecided"}.get(row.verdict, ""),
        "remark": sentence(row.words) if row.words else "",
    }


def _manoeuvre(sailed: SheetManoeuvre, length: float | None) -> dict[str, object]:
    return _numbers(sailed.measures, sailed.record, sailed.title, length, f"m{sailed.number}")


def _numbers(measures: Measures, record: Trial | None, title: str, length: float | None, key: str) -> dict[str, object]:
    rows, said = _told_once(list(_single(measures)))
    return {
        "title": title,
        "trial": measures.trial,
        "simulated": record is not None and record.source.simulated,
        "read_from": measures.read_from,
        "caption": _CAPTIONS.get(type(measures).__name__, "The manoeuvre as it was measured."),
        "figure": None if record is None else manoeuvre_figure(measures, record, length, key),
        "columns": _NUMBERS,
        "rows": rows,
        "parts": _parts(measures),
        "notes": [*said, *(sentence(note) for note in measures.notes)],
    }


def _told_once(rows: list[Row]) -> tuple[list[Row], list[str]]:
    """The rows without those that share a reason why they are not known, and a sentence for each such reason."""
    shared: dict[str, list[str]] = {}
    for row in rows:
        if row["remark"]:
            shared.setdefault(str(row["remark"]), []).append(str(row["name"]))
    shared = {why: names for why, names in shared.items() if len(names) >= _SHARED}
    said = [f"Not known: {'; '.join([names[0], *map(str.lower, names[1:])])}. {why}." for why, names in shared.items()]
    return [row for row in rows if row["remark"] not in shared], said


def _single(measures: Measures) -> Iterator[Row]:
    """A row for each quantity that is one number, or is not known for a reason."""
    known = {name: value for name, value, _, _ in measures.quantities()}
    beside = measures.told_beside()
    for name, value, unit, meaning in measures.quantities():
        reason = measures.reason(name)
        if isinstance(value, tuple) or (value is None and reason is None) or name.endswith(_RATIO) or name in beside:
            continue
        ratio = known.get(f"{name.removesuffix('_distance')}{_RATIO}")
        yield {
            "name": sentence(name.replace(_STILL, " in still water").replace("_", " ")),
            "value": _value(measures, name, value, unit) + ("" if ratio is None else f" ({number(ratio, 3)} L)"),
            "meaning": sentence(meaning),
            "remark": sentence(reason) if reason else "",
        }


def _value(measures: Measures, name: str, value: float | None, unit: str) -> str:
    if value is None:
        return "not known"
    shown = measures.told(name, value, unit).replace("-", "−")
    return shown if unit == "1" else f"{shown} {pretty(unit)}"


def _parts(measures: Measures) -> dict[str, object] | None:
    """What has one number a reversal or stage, a row each."""
    heads, cells = measures.table()
    if not cells:
        return None
    reasons = list(dict.fromkeys(why for key, why in measures.reasons.items() if key.split("[")[0] in measures.columns))
    return {
        "columns": [(sentence(head), str(k), "n" if k else "") for k, head in enumerate(heads)],
        "rows": [{str(k): cell for k, cell in enumerate(row)} for row in cells],
        "reasons": [sentence(why) for why in reasons],
    }


def _poster(sheet: TrialSheet) -> dict[str, object]:
    """A row for each circle: distances, and the time and the speed at every quarter."""
    columns = [("Turning circle", "title"), ("Rudder [deg]", "rudder", "n"), ("Approach [m/s]", "approach", "n")]
    columns += [(f"{n.replace('_', ' ').capitalize()} [m]", n, "n") for n in _DISTANCES]
    times = [("Turned through", "title"), *((f"{q}°", f"q{k}", "n") for k, q in enumerate(QUARTERS))]
    rows: list[Row] = []
    quarters: list[Row] = []
    for sailed, circle in sheet.circles():
        angle = rudder_of(circle)
        rows.append(
            {
                "title": sailed.title,
                "rudder": "" if angle is None else number(abs(angle), 3),
                "approach": "" if circle.approach_speed is None else number(circle.approach_speed, 3),
                **{n: _distance(circle, n, sheet.length) for n in _DISTANCES},
            }
        )
        for name, words in (("times", "time [min:s]"), ("speeds", "speed [m/s]")):
            values = getattr(circle, name) or ()
            cells = {f"q{k}": _quarter(name, values[k] if k < len(values) else None) for k in range(len(QUARTERS))}
            quarters.append({"title": f"{sailed.title}: {words}", **cells})
    return {"columns": columns, "rows": rows, "times": times, "quarters": quarters}


_DISTANCES = ("advance", "transfer", "tactical_diameter")


def _distance(circle: TurningCircle, name: str, length: float | None) -> str:
    """The value in still water where the drift of the circle is known, else over the ground."""
    still = getattr(circle, f"{name}_still_water")
    value = getattr(circle, name) if still is None else still
    if value is None:
        return "not known" if circle.reason(name) else "not reached"
    return circle.told(name if still is None else f"{name}_still_water", value, "m") + (
        f" ({number(value / length, 3)} L)" if length else ""
    )


def _quarter(name: str, value: float | None) -> str:
    if value is None:
        return "not known"
    if name == "times":
        minutes, seconds = divmod(round(value), 60)
        return f"{minutes}:{seconds:02d}"
    return fixed(float(to_display(value, "U")), 2)
