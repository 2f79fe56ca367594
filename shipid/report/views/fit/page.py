"""An identified model as a page: the answer in words, then sections."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import PureWindowsPath

from shipid.criteria.criteria import Criteria
from shipid.estimation.standing import NEAR_ZERO, UNKNOWN
from shipid.foundation.numbers import number
from shipid.identification.fit import Fit
from shipid.identification.validation.comparison import Comparison
from shipid.report.figures.runaway import runaway
from shipid.report.page import Page, Row, Section
from shipid.report.typography.quantities import shown
from shipid.report.views.criteria.page import criteria_section
from shipid.report.views.equations import equations_section
from shipid.report.views.fit.belief import belief_section
from shipid.report.views.fit.coefficients import coefficients_section, correlation_section, held_section
from shipid.report.views.fit.picture import picture_section
from shipid.report.views.fit.search import check_section, noise_section, posterior_section
from shipid.report.views.fit.trial import trials_section
from shipid.report.views.words import count, listed, sentence
from shipid.trials.trial import Trial

_NOT_ASSESSED = (
    "The fit was not assessed: residuals, weakly determined directions, prediction bands and the check of the trials are those "
    "of shipid.assess, which was not asked for."
)


def provenance_section(fit: Fit) -> Section:
    """Return the section of the files, and of the software.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    versions = ", ".join(f"{name} {version}" for name, version in fit.provenance.get("versions", {}).items())
    files = [_file(c.trial, "fitted") for c in fit.fitted] + [_file(c.trial, "validation") for c in fit.validation]
    view = {
        "files": files,
        "model": fit.model.name,
        "model_sha256": str(fit.provenance.get("model_sha256", "")),
        "versions": f"{versions}.",
    }
    return Section("Provenance", "fit/provenance.html", view, folded=True)


#: The sections of the page, in order; one that has nothing to say is None. A new one is a line here and a template.
SECTIONS: list[Callable[[Fit, Criteria | str | None], Section | None]] = [
    lambda fit, _: picture_section(fit),
    lambda fit, _: check_section(fit),
    lambda fit, _: belief_section(fit),
    lambda fit, _: coefficients_section(fit),
    lambda _, criteria: criteria_section(criteria),
    lambda fit, _: trials_section(fit),
    lambda fit, _: equations_section(fit.model),
    lambda fit, _: held_section(fit),
    lambda fit, _: correlation_section(fit),
    lambda fit, _: posterior_section(fit),
    lambda fit, _: noise_section(fit),
    lambda fit, _: provenance_section(fit),
]


def fit_page(fit: Fit, criteria: Criteria | str | None = None) -> Page:
    """Return what the page says of a fit.

    Parameters
    ----------
    fit : Fit
        The result.
    criteria : Criteria or str, optional
        The manoeuvring criteria of the identified model, or why there are none.
    """
    return Page(
        f"Identification of {fit.ship.name} with model {fit.model.name}",
        [("", _answer(fit))],
        [s for section in SECTIONS if (s := section(fit, criteria)) is not None],
        _warnings(fit),
        _cautions(fit),
    )


def _answer(fit: Fit) -> list[str]:
    """The one-paragraph answer, a sentence an entry."""
    simulated = sum(c.trial.source.simulated for c in fit.fitted)
    kind = "simulated trial" if simulated == len(fit.fitted) else "trial"
    ship = fit.ship.name + (f" ({fit.ship.title})" if fit.ship.title else "")
    sentences = [
        f"Model {fit.model.name} was fitted to {count(len(fit.fitted), kind)} of {ship}"
        + (f" ({simulated} of them simulated)." if 0 < simulated < len(fit.fitted) else "."),
        "The search converged." if fit.converged else "The search did not converge: do not use these coefficients.",
    ]
    sentences += _accuracy(fit, fit.fitted, "reproduces", "of the fitted trials")
    sentences += _accuracy(fit, fit.validation, "predicts", "of trials that were not fitted")
    if not fit.validation:
        sentences.append("No trial was kept apart to test its prediction.")
    for standing in (UNKNOWN, NEAR_ZERO):
        names = [n for n in fit.estimated if fit.parameters[n].standing == standing]
        sentences += [f"{standing.capitalize()} by these trials: {listed(names)}."] if names else []
    if not fit.unidentifiable:
        sentences.append("The trials determine all fitted coefficients.")
    following = [n for n, e in fit.parameters.items() if e.follows and not e.identifiable]
    if following:
        sentences.append(f"Published coefficients that are not determined either: {listed(following)}.")
    return sentences


def _accuracy(fit: Fit, comparisons: tuple[Comparison, ...], verb: str, where: str) -> list[str]:
    """How near the model comes to the heading, or to the first signal where there is none."""
    lead = "psi" if any("psi" in c.rmse for c in fit.fitted) else next(iter(fit.noise), None)
    if lead is None:
        return []
    how = shown(fit.model, lead)
    errors = [
        f"{how.number(c.rmse[lead], 2)} {how.unit} rms ({c.trial.name})"
        for c in comparisons
        if lead in c.rmse and runaway(c) is None
    ]
    lost = [c.trial.name for c in comparisons if runaway(c) is not None]
    said = [f"It {verb} the {how.label.lower()} {where} to within {listed(errors)}."] if errors else []
    return said + ([f"Its prediction of {listed(lost)} runs away."] if lost else [])


def _warnings(fit: Fit) -> list[str]:
    """What makes the result unusable: the serious warnings of the fit in its own words, and predictions that run away."""
    found = [f"{sentence(str(n)).rstrip('.')}." for n in fit.warnings if n.serious]
    for c in (*fit.fitted, *fit.validation):
        t = runaway(c)
        # What the model does not sail is told already, with its reason.
        if t is not None and c.departure is None:
            found.append(
                f"The prediction of {c.trial.name} runs away at t = {number(t)} s; its curves stop there, and it has no rms error."
            )
    return found


def _cautions(fit: Fit) -> list[str]:
    """What limits the result: the other warnings of the fit, and what was not asked for."""
    found = [str(n) for n in fit.warnings if not n.serious]
    return found if fit.assessment is not None else [*found, _NOT_ASSESSED]


def _file(trial: Trial, role: str) -> Row:
    source = trial.source
    return {
        "name": trial.name,
        "role": role,
        "ship": trial.ship or "",
        "file": "" if source.path is None else PureWindowsPath(source.path).name,
        "sha256": source.sha256 or "",
        "format": "" if source.format is None else PureWindowsPath(source.format).name,
        "notes": source.notes,
        "simulated": source.simulated,
        "samples": len(trial),
    }
