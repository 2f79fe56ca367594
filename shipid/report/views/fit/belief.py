"""What may be believed of a fit, and how far: one verdict a question, with its numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from shipid.foundation.numbers import number
from shipid.identification.fit import Fit
from shipid.identification.fit_text import fit_words
from shipid.identification.problem.prior_shares import MOSTLY, held_words
from shipid.identification.validation.comparison import Comparison
from shipid.parameters.validity import range_words
from shipid.report.figures.runaway import runaway
from shipid.report.page import Row, Section
from shipid.report.typography.quantities import shown
from shipid.report.views.words import listed, sentence

_COLUMNS = [("Question", "question"), ("Verdict", "verdict", "keep"), ("In numbers", "numbers", "wide")]


def belief_section(fit: Fit) -> Section:
    """Return the section of the verdicts.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    view = {"columns": _COLUMNS, "rows": list(_rows(fit))}
    return Section("What may be believed, and how far", "fit/belief.html", view, short="Belief")


def _rows(fit: Fit) -> Iterator[Row]:
    yield _row(
        "Did the search converge?",
        "yes" if fit.converged else "no",
        sentence(fit.message),
        "" if fit.converged else "beyond",
    )
    yield _trials(fit)
    yield _determined(fit)
    yield from _held(fit)
    yield _near("Does it reproduce the fitted trials?", fit, fit.fitted)
    if fit.validation:
        yield _near("Does it predict trials that were not fitted?", fit, fit.validation)
    else:
        words = "No trial was kept apart. Name one with --validate: only such a trial tests a prediction."
        yield _row("Does it predict trials that were not fitted?", "not tested", words, "undecided")
    yield from _bands(fit)
    yield from _white(fit)
    yield _range(fit)


def _row(question: str, verdict: str, numbers: str, kind: str = "") -> Row:
    return {"question": question, "verdict": verdict, "numbers": numbers, "class": kind}


def _trials(fit: Fit) -> Row:
    question = "Are the trials sound?"
    findings = None if fit.assessment is None else fit.assessment.findings
    if findings is None:
        return _row(question, "not checked", "The trials were not checked.", "undecided")
    serious = [f for f in findings if f.finding.serious and f.bears]
    if serious:
        named = listed([f"{f.trial} ({f.finding.kind})" for f in serious])
        return _row(question, "no", f"A fault that spoils an identification stands in {named}.", "beyond")
    other = f" {len(findings)} of the findings below spoil nothing here." if findings else ""
    return _row(question, "yes", f"The check found no fault that spoils the fit.{other}")


def _determined(fit: Fit) -> Row:
    names, lost = fit.estimated, fit.unidentifiable
    count = f"{len(names) - len(lost)} of {len(names)}"
    words = "; ".join(f"{n}: {fit.parameters[n].standing}" for n in lost)
    return _row(
        "Do the trials determine the coefficients?",
        "all" if not lost else count,
        words + "." if words else f"Each of the {len(names)} has an interval that the trials set.",
        "undecided" if lost else "",
    )


def _held(fit: Fit) -> Iterator[Row]:
    """How much of the coefficients comes from the priors that the model declares."""
    shares = fit.prior_shares
    if not shares:
        return
    held = held_words(shares)
    words = f"{held}: that much of the information is the prior that the model declares." if held else ""
    count = sum(share > MOSTLY for share in shares.values())
    yield _row(
        "Or do priors hold them?",
        f"{count} of {len(fit.estimated)}" if held else "no",
        words or "Of each coefficient with a prior, the trials say more than the prior.",
        "undecided" if held else "",
    )


def _near(question: str, fit: Fit, comparisons: Sequence[Comparison]) -> Row:
    """How near the model comes, in each signal."""
    lost = [c.trial.name for c in comparisons if runaway(c) is not None]
    if lost:
        return _row(question, "no", f"The prediction of {listed(lost)} runs away.", "beyond")
    parts = []
    lead: list[float] = []
    for name in fit.noise:
        found = [(c.fit_percent[name], c.rmse[name]) for c in comparisons if name in c.fit_percent]
        if not found:
            continue
        how = shown(fit.model, name)
        lead = lead or [f for f, _ in found]
        errors = [e for _, e in found]
        parts.append(
            f"{how.label.lower()} {_between([_percent(f) for f, _ in sorted(found)])}, rms {_ends(errors, how.number)} {how.unit}"
        )
    verdict = "" if not lead else _between([_percent(f) for f in sorted(lead)])
    return _row(
        question, f"fit {verdict}" if verdict else "not known", sentence("; ".join(parts)) + "." if parts else ""
    )


def _percent(value: float) -> str:
    return fit_words(value).replace("-", "−")


def _between(values: Sequence[str]) -> str:
    return values[0] if values[0] == values[-1] else f"{values[0].removesuffix(' %')} to {values[-1]}"


def _ends(values: Sequence[float], text: Callable[[float], str]) -> str:
    low, high = text(min(values)), text(max(values))
    return low if low == high else f"{low} to {high}"


def _bands(fit: Fit) -> Iterator[Row]:
    """How many of the measured overshoots lie in the band of their prediction."""
    known = {} if fit.assessment is None or fit.assessment.manoeuvres is None else fit.assessment.manoeuvres
    inside = total = 0
    for c in fit.validation:
        m = known.get(c.trial.name)
        for measured, band in zip(m.overshoots, m.band95) if m else ():
            if band is not None:
                total += 1
                inside += band[0] <= measured <= band[1]
    if total:
        words = (
            f"{inside} of {total} measured overshoots of trials that were not fitted lie in the 95 % band of their prediction. The "
            "bands hold the uncertainty of the coefficients, and what the structure of such a model is usually wrong by."
        )
        yield _row("Do the bands hold?", f"{inside} of {total}", words, "" if inside >= 0.8 * total else "undecided")


def _white(fit: Fit) -> Iterator[Row]:
    found = {} if fit.assessment is None else fit.assessment.residuals
    if not found:
        return
    coloured = {n: r for n, r in found.items() if not r.white}
    question = "Is anything left unexplained?"
    if not coloured:
        yield _row(
            question, "no", "The residuals of every signal of the fitted trials are white: what is left there is noise."
        )
        return
    parts = [
        f"{shown(fit.model, n).label.lower()} for {number(r.autocorrelation_time_s, 2)} s" for n, r in coloured.items()
    ]
    words = (
        f"The residuals are correlated: {listed(parts)}. The model leaves out something of the ship, the sea or the sensors; the "
        "standard deviations count it as noise."
    )
    yield _row(question, "yes", words, "undecided")


def _range(fit: Fit) -> Row:
    """The range that the fitted trials cover."""
    known = fit.ship.joint.get(fit.model.name)
    words = {} if known is None else range_words(known)
    parts = [f"speeds {words[n]}" if n == "u" else words[n] for n in words]
    said = f"The fitted trials hold {listed(parts)}. " if parts else ""
    verdict = words.get("delta", words.get("u", "not known"))
    return _row(
        "Up to where?",
        verdict.removeprefix("rudder angles "),
        f"{said}Beyond what was sailed the model extrapolates, and no band contains that error.",
    )
