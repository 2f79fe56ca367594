"""Choosing a structure: every model predicts trials it was not fitted to, and the predictions are ranked.

Each trial is left out in turn, the model is fitted to the others and predicts it; a single trial is cut in two halves that
predict each other. The error of the fitted trials never enters: it falls with every coefficient that is added. The spread of
the coefficients on what is to be predicted does, because a left-out trial is sailed like the others and a hard turn is not.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.foundation.errors import ShipidError, UsageError
from shipid.identification.choice.candidates import CANDIDATES, completed
from shipid.identification.choice.choosing import Rank
from shipid.identification.choice.ranking import Ranking
from shipid.identification.choice.scoring import MEASURES, WORTHLESS, together
from shipid.identification.choice.side_by_side import try_all
from shipid.identification.choice.trying import Attempt, Tried
from shipid.identification.search.least_squares import Progress
from shipid.parameters.held_inputs import hold_inputs
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.logs.reading import Trials, trials_of
from shipid.trials.measuring.measure import measure
from shipid.trials.measuring.results.zigzag import ZigZag
from shipid.trials.trial import Trial

#: Overshoots of a campaign with which structures can be told apart.
_OVERSHOOTS = 4


def compare_models(
    models: Sequence[Model | type[Component] | str] | None,
    trials: Trials,
    *,
    ship: ParameterSet | str | None = None,
    inputs: Mapping[str, str] | None = None,
    validate: Trials = (),
    starts: int = 5,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Ranking:
    """Rank models by their predictions of trials they were not fitted to.

    Parameters
    ----------
    models : sequence of Model, component class or str, or None
        The candidates; None for those of `shipid.identification.choice.candidates.CANDIDATES`. Where every trial holds the true
        wind a candidate is taken with the moment of the wind, and where its rudder is an order with a lag.
    trials : Trial, str, Path or sequence of them
        Trials, or their files. Left out in turn; a single one is cut in two halves.
    ship : ParameterSet or str, optional
        Particulars and first values.
    inputs : mapping of str to str, optional
        Inputs that no trial records, held at a value with its unit in every candidate that reads them: the depth of the water, the
        revolutions.
    validate : Trial, str, Path or sequence of them
        Trials kept apart: reported for each model, never used for the score. The spread of the coefficients is taken over what
        their rudder does, which is known before a manoeuvre is sailed.
    starts, seed
        See `shipid.identify`.
    workers : int, optional
        How many candidates are tried at a time, each in a process; by default one for each processor.
    progress : callable, optional
        Called with a line of text for each candidate.

    Returns
    -------
    Ranking

    Raises
    ------
    UsageError
        If there are no models or no trials, no trial shows how the ship turns, or an input is read by no candidate.
    UnitError
        If the value of an input has no unit where it needs one, or one that does not fit.
    """
    if models is None:
        models = CANDIDATES
    if not models or not trials:
        raise UsageError("a comparison needs at least one model and one trial.")
    trials, validate = trials_of(trials), trials_of(validate)
    if not any(t.has(n) for t in trials for n in ("psi", "r")):
        raise UsageError(
            "a comparison judges predictions by heading and rate of turn, and no trial has one of them (psi, r). Fit each model (identify "
            "--validate), and put their errors side by side."
        )
    whole = completed(models, [*trials, *validate])
    pieces = _pieces(trials)
    held = dict(inputs or {})
    _check_inputs(whole, held)
    candidates = [Attempt(m, tuple(pieces), tuple(validate), ship, starts, seed, held) for m in whole]
    found = try_all(candidates, progress or (lambda _: None), workers)
    ranks = sorted((_rank(one) for one in found), key=lambda r: (r.error is None, r.error or 0.0))
    beyond = {
        (n.known.get("subject", n.known.get("trial")), n.known.get("quantity", n.kind)): n
        for one in found
        for n in one.beyond
    }
    return Ranking(tuple(ranks), tuple(p.name for p in pieces), _lacking(trials), tuple(beyond.values()))


def _check_inputs(models: Sequence[Model], inputs: Mapping[str, str]) -> None:
    """Raise an error for an input that no candidate reads, or whose value does not fit."""
    for name, text in inputs.items():
        readers = [m for m in models if name in m.inputs]
        if len(models) > 1 and not readers:
            read = dict.fromkeys(n for m in models for n in m.inputs)
            raise UsageError(f"no candidate reads an input '{name}'; they read {', '.join(read)}.")
        hold_inputs((readers or models)[0], {name: text})


def _pieces(trials: Sequence[Trial]) -> list[Trial]:
    """What is left out in turn: the trials, or the halves of a single one."""
    if len(trials) > 1:
        return list(trials)
    clock = trials[0]["t"]
    middle = clock[clock.size // 2]
    return [trials[0].window(clock[0], middle), trials[0].window(middle, clock[-1])]


def _lacking(trials: Sequence[Trial]) -> tuple[str, ...]:
    """What a campaign lacks for a choice, in sentences."""
    found = []
    overshoots = sum(_overshoots(t) for t in trials)
    if len(trials) < 2:
        found.append("A second trial is missing: one trial can only be cut in halves that predict each other.")
    if overshoots < _OVERSHOOTS:
        found.append(
            f"Reversals of the rudder are missing: {overshoots or 'no'} overshoot{'s' * (overshoots != 1)} can be read from the trials, and a "
            f"choice needs {_OVERSHOOTS} or more (two zig-zags)."
        )
    return tuple(found)


def _overshoots(trial: Trial) -> int:
    """How many overshoots a trial shows."""
    try:
        found = measure(trial, ZigZag.kind)
    except ShipidError:
        return 0
    return len(found.leading_overshoots) if isinstance(found, ZigZag) else 0


def _rank(tried: Tried) -> Rank:
    folds = [fold for fold in tried.folds if fold is not None]
    # A fold that could not be fitted counts as a prediction that is worth nothing.
    shares = np.array([WORTHLESS if fold is None else fold.score for fold in tried.folds])
    score = float(np.exp(np.mean(np.log(shares)))) if folds else None
    std = (
        score * float(np.std(np.log(shares), ddof=1)) / shares.size**0.5
        if score is not None and len(folds) > 1
        else None
    )
    return Rank(
        tried.model,
        tried.coefficients,
        tried.free,
        tried.reads,
        score,
        std,
        tuple(shares.tolist()),
        {n: together([fold.measures[n] for fold in folds]) for n in MEASURES},
        tried.validation,
        tried.message,
        tried.spread,
        together([fold.rate for fold in folds]),
        tried.turn,
        tried.predictions,
    )
