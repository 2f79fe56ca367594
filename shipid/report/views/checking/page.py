"""What the check of one trial or several found, as a page: the verdict of each, its findings, its manoeuvres, its rows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.numbers import given, number
from shipid.report.page import Page, Row, Section
from shipid.report.views.checking.timeline import timeline
from shipid.report.views.words import count, listed, sentence, versions_now
from shipid.trials.doctor.findings import Diagnosis, Finding, Stretch, by_words

#: So many findings of one kind are told one by one.
_FULLY_TOLD = 3


def check_page(found: Diagnosis) -> Page:
    """Return what the page says of one trial.

    Parameters
    ----------
    found : Diagnosis
        What was found.
    """
    return checks_page([found])


def checks_page(found: Sequence[Diagnosis]) -> Page:
    """Return what the page says of several trials.

    Parameters
    ----------
    found : sequence of Diagnosis
        At least one.
    """
    title = f"Check of {found[0].trial}" if len(found) == 1 else f"Check of {count(len(found), 'trial')}"
    trials = [_trial(d, f"t{k}") for k, d in enumerate(found, 1)]
    read = [t for d, t in zip(found, trials) if d.rows]
    several = {"named": len(found) > 1}
    return Page(
        title,
        [("", _answer(found))],
        [
            Section("Verdicts", "check/verdicts.html", {"rows": [_verdict(d) for d in found]}),
            Section("Findings", "check/findings.html", {**several, "trials": trials}),
            *(_of_records({**several, "trials": read}) if read else ()),
        ],
        footer=versions_now(),
    )


def _of_records(view: Row) -> Iterator[Section]:
    yield Section("Manoeuvres", "check/manoeuvres.html", view)
    yield Section("How the records were read", "check/rows.html", view, short="Rows", folded=True)


def _answer(found: Sequence[Diagnosis]) -> list[str]:
    read = [d for d in found if d.rows]
    lost = len(found) - len(read)
    said = [f"{sentence(count(lost, 'file'))} could not be read."] if lost else []
    bad = [d.trial for d in read if d.serious]
    if not bad:
        clean = f"Nothing was found that would spoil an identification with {_these(read)}."
        return [*said, clean] if read else said
    said += [f"{listed(bad)} would spoil an identification as {'it is' if len(bad) == 1 else 'they are'}."]
    if all(f.repaired for d in read for f in d.serious):
        said.append("The repairs are certain enough to be applied: shipid check --fix -o FILE.")
    return said


def _these(found: Sequence[Diagnosis]) -> str:
    return found[0].trial if len(found) == 1 else "these trials"


def _verdict(d: Diagnosis) -> Row:
    return {
        "trial": d.trial,
        "verdict": d.verdict if d.rows else "not read",
        "class": "beyond" if d.serious else "",
        "findings": str(len(d.findings)),
        "serious": str(len(d.serious)),
        "rows": f"{d.kept} of {d.rows}",
    }


def _trial(d: Diagnosis, key: str) -> Row:
    return {
        "name": d.trial,
        "figure": timeline(d, key) if d.rows else None,
        # A file that could not be read has a reason, and no record with findings along it.
        "unread": "" if d.rows else " ".join(f.message for f in d.findings),
        "findings": _findings(d),
        "manoeuvres": [_stretch(m) for m in d.manoeuvres],
        "rows": f"{d.rows} rows read, {d.kept} kept.",
        "left_out": [sentence(str(part)) for part in d.left_out],
        "notes": [sentence(note) for note in d.notes],
    }


def _findings(d: Diagnosis) -> list[Row]:
    """A row a finding; one kind in many channels is told once, with the channels on a line."""
    rows: list[Row] = []
    for kind in d.kinds:
        told = [f for f in d.findings if f.kind == kind]
        shown = told if len(told) <= _FULLY_TOLD else told[:1]
        rows += [_finding(f) for f in shown]
        rest = told[len(shown) :]
        if rest:
            also = (f"{', '.join(map(_channels, same))}: {words}" for words, same in by_words(rest).items())
            rows[-1] = {**rows[-1], "remark": f"Also: {'; '.join(also)}."}
    return rows


def _finding(f: Finding) -> Row:
    spoils = "put right by the format file" if f.handled else "spoils a fit" if f.serious else "to know about"
    return {
        "what": f"{f.kind} ({_channels(f)})",
        "verdict": spoils,
        "class": "beyond" if f.serious else "",
        "sure": f"{100 * f.confidence:.0f} %",
        "where": f.when,
        "message": f.message,
        "effect": sentence(f.effect),
        "repair": sentence(f.repair),
    }


def _channels(f: Finding) -> str:
    return ", ".join(FIELDS[c].label.lower() if c in FIELDS else c for c in f.channels)


def _stretch(m: Stretch) -> Row:
    angles = ""
    if m.kind == "zigzag":
        angles = f"{given(m.rudder_deg)}/{given(m.heading_deg)} deg, first to {m.side}"
    elif m.kind == "turn":
        angles = f"{given(m.rudder_deg)} deg of rudder through {number(m.heading_deg, 3)} deg to {m.side}"
    return {
        "kind": "zig-zag" if m.kind == "zigzag" else m.kind,
        "angles": angles,
        "span": f"{given(m.start)} to {given(m.end)} s",
        "regular": m.regular,
    }
