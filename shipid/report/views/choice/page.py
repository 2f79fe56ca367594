"""Models ranked by their predictions, as a page: the one to take, every model over each trial that was left out, the numbers."""

from __future__ import annotations

from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import display_unit, to_display
from shipid.foundation.numbers import fixed, number
from shipid.identification.choice.choosing import Rank
from shipid.identification.choice.ranking import Ranking
from shipid.identification.choice.scoring import MEASURES
from shipid.identification.validation.comparison import Comparison
from shipid.report.figures.comparisons import heading_drawing, track_drawing
from shipid.report.page import Page, Row, Section
from shipid.report.views.words import count, listed, sentence, versions_now

_NAMES = {
    "rate": "Rate of turn",
    "heading_refitted_bias": "Heading, bias refitted",
    "overshoot": "Overshoot, open loop",
    "overshoot_closed": "Overshoot, closed loop",
    "period": "Period",
    "speed": "Speed",
    "sway": "Sway speed",
    "heading_warm": "Heading, warmed up",
    "heading": "Heading as it is",
}
#: So many trials are drawn, with the best models of each.
_DRAWN, _MODELS = 4, 4


def ranking_page(ranking: Ranking) -> Page:
    """Return what the page says of a comparison of models.

    Parameters
    ----------
    ranking : Ranking
        The comparison.
    """
    return Page(
        f"Comparison of {count(len(ranking.ranks), 'model')}",
        [("", _answer(ranking))],
        [s for s in (_pictures(ranking), _scores(ranking), _errors(ranking), _kept(ranking)) if s is not None],
        [sentence(str(n)) for n in ranking.warnings if n.serious],
        [str(n) for n in ranking.warnings if not n.serious],
        versions_now(),
    )


def _answer(ranking: Ranking) -> list[str]:
    if ranking.best is None:
        return ["There is no model to take."]
    return [
        f"The model to take is {ranking.best}.",
        *ranking.words,
        f"Each model predicted what it was not fitted to: {listed(ranking.folds)}.",
    ]


def _score(rank: Rank) -> str:
    # As many decimals as the terminal shows.
    if rank.score is None:
        return ""
    return fixed(rank.score, 3) + (f" ± {fixed(rank.std, 3)}" if rank.std else "")


def _scores(ranking: Ranking) -> Section:
    rows: list[Row] = []
    weights = ranking.weights
    for r in ranking.ranks:
        take = "take" if r.model == ranking.best else "tied" if r.model in ranking.tied else ""
        rows.append(
            {
                "model": r.model,
                "verdict": take or ("worse" if r.score is not None else "not fitted"),
                "error": "" if r.error is None else fixed(r.error, 3),
                "score": _score(r),
                "spread": fixed(r.spread, 3) if r.score is not None else "",
                "weight": f"{100 * weights[r.model]:.0f} %",
                "coefficients": str(r.coefficients),
                "free": str(r.free),
                "reads": str(r.reads),
                "remark": sentence(r.message) if r.message else "",
            }
        )
    return Section("Ranking", "choice/scores.html", {"rows": rows})


def _errors(ranking: Ranking) -> Section:
    names = [n for n in MEASURES if any(r.measures.get(n) is not None for r in ranking.ranks)]
    columns = [
        ("Model", "model"),
        *((f"{_NAMES[n]} [{pretty(display_unit('', MEASURES[n][0]))}]", n, "n") for n in names),
    ]
    rows = [{"model": r.model, **{n: _shown(n, r.measures.get(n)) for n in names}} for r in ranking.ranks]
    meanings = [f"{_NAMES[n]}: {MEASURES[n][2]}{'' if MEASURES[n][1] else '; not counted'}." for n in names]
    return Section(
        "Errors of the predictions", "choice/errors.html", {"columns": columns, "rows": rows, "notes": meanings}
    )


def _kept(ranking: Ranking) -> Section | None:
    """Trials of --validate, which the ranking does not see."""
    names = [n for n in MEASURES if any(m.get(n) is not None for r in ranking.ranks for m in r.validation.values())]
    if not names:
        return None
    columns = [
        ("Trial", "trial"),
        ("Model", "model"),
        *((f"{_NAMES[n]} [{pretty(display_unit('', MEASURES[n][0]))}]", n, "n") for n in names),
    ]
    trials = dict.fromkeys(t for r in ranking.ranks for t in r.validation)
    rows = [
        {"trial": t, "model": r.model, **{n: _shown(n, r.validation[t].get(n)) for n in names}}
        for t in trials
        for r in ranking.ranks
        if t in r.validation
    ]
    notes = ["The ranking does not see these trials."]
    return Section("Trials kept apart", "choice/kept.html", {"columns": columns, "rows": rows, "notes": notes})


def _shown(name: str, value: float | None) -> str:
    return "" if value is None else number(to_display(value, "", MEASURES[name][0]), 3)


def _pictures(ranking: Ranking) -> Section | None:
    """The best models over each trial that was left out."""
    trials: dict[str, dict[str, Comparison]] = {}
    for r in ranking.ranks:
        for c in r.predictions:
            of = trials.setdefault(c.trial.name, {})
            if len(of) < _MODELS:
                of[r.model] = c
    views = []
    for k, (name, of) in enumerate(list(trials.items())[:_DRAWN]):
        heading, (track, note) = heading_drawing(of), track_drawing(of)
        views.append(
            {
                "name": name,
                "heading": None if heading is None else heading.svg(f"c{k}-h"),
                "track": None if track is None else track.svg(f"c{k}-t"),
                "note": note,
            }
        )
    if not views:
        return None
    left = len(trials) - len(views)
    words = f"{sentence(count(left, 'trial'))} more {'is' if left == 1 else 'are'} not drawn." if left else ""
    return Section(
        "Each trial, predicted by models that were not fitted to it",
        "choice/pictures.html",
        {"trials": views, "left": words},
        short="Picture",
    )
