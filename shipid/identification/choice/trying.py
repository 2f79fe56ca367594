"""One candidate tried: fitted to all trials, then each left out in turn and predicted by the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from threadpoolctl import threadpool_limits

from shipid.declaration.model import Model
from shipid.declaration.vocabulary import shown
from shipid.foundation.errors import ShipidError
from shipid.foundation.notices import Notice
from shipid.generation.record import make_record
from shipid.identification.choice.hard_turn import HardTurn, hard_turn
from shipid.identification.choice.scoring import MEASURES, WORTHLESS, counted_measures, together
from shipid.identification.evidence.explained import ASTERN
from shipid.identification.evidence.record_doubts import SEEN_BEFORE, TRIAL_TWICE
from shipid.identification.fit import Fit
from shipid.identification.identified import Identified
from shipid.identification.identify import identify
from shipid.identification.uncertainty.amplitudes import beyond_of_record, largest_amplitudes
from shipid.identification.uncertainty.draws import draws_of
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.left_out import LeftOutTrial, can_be_left_out, left_out, records_of
from shipid.identification.validation.runs import runs_of, swings_of
from shipid.parameters.held_inputs import hold_inputs
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.validity import BEYOND
from shipid.trials.signals.ship_length import SHIP_LENGTH
from shipid.trials.trial import Trial

#: What a model may take as given although it is what the ship does.
_MOTION = ("x", "y", "psi", "u", "v", "r", "cruise")
#: Coefficients of the least surge equation: what a model is spared that is told the speed of the trial it predicts.
_SURGE = 2
#: What a trial may go beyond the others in, by the field: its name among the amplitudes, the words before the number, its unit.
_SIZES = {
    "delta": ("rudder", "the rudder goes to", "rad"),
    "r": ("rate", "the ship turns at", "rad/s"),
    "beta": ("drift", "the drift angle is", "rad"),
}


@dataclass(frozen=True, eq=False)
class Attempt:
    """A model to try, and on what.

    Attributes
    ----------
    model : Model
        The model.
    trials, validate : tuple of Trial
        Trials that are left out in turn, and trials kept apart.
    ship : ParameterSet, str or None
        Particulars and first values.
    starts, seed : int
        Of the search.
    inputs : mapping of str to str
        Inputs that are held at a value, with its unit, where the model reads them. They are held by who tries it: such a model is made
        on the spot, and cannot be sent from process to process.
    """

    model: Model
    trials: tuple[Trial, ...]
    validate: tuple[Trial, ...]
    ship: ParameterSet | str | None
    starts: int
    seed: int
    inputs: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Fold:
    """A record that was left out.

    Attributes
    ----------
    measures : mapping of str to float or None
        Root-mean-square of each measure over its stretches, SI.
    score : float
        See `shipid.identification.choice.scoring.score_of`.
    rate : float or None
        Error of the rate of turn in shares of its size.
    """

    measures: dict[str, float | None]
    score: float
    rate: float | None


@dataclass(frozen=True)
class Tried:
    """What became of a candidate.

    Attributes
    ----------
    model : str
        Its name, with the parts that the plain identification gave it: a change with the loading, a dead time.
    coefficients, free, reads : int
        How many it estimates, how many of them only trials determine, and how many recorded inputs it reads.
    folds : tuple of Fold or None
        One for each record left out; None where the others give no fit.
    spread : float
        Standard deviation over draws of the rate of turn of what is to be predicted, in shares of its size.
    turn : HardTurn or None
        What it does in a hard turn.
    validation : mapping of str to mapping
        Measures of trials kept apart, from a fit to all the others.
    beyond : tuple of Notice
        Where a trial that is left out or kept apart goes beyond those that were fitted, or its ship astern.
    message : str
        What went wrong on the way.
    predictions : tuple of Comparison
        The records left out beside their predictions.
    """

    model: str
    coefficients: int
    free: int
    reads: int
    folds: tuple[Fold | None, ...]
    spread: float = WORTHLESS
    turn: HardTurn | None = None
    validation: dict[str, dict[str, float | None]] = field(default_factory=dict)
    beyond: tuple[Notice, ...] = ()
    message: str = ""
    predictions: tuple[Comparison, ...] = ()


def try_candidate(candidate: Attempt) -> Tried:
    """Return what becomes of a candidate; one that cannot be fitted stops nothing.

    Parameters
    ----------
    candidate : Attempt
        The model and the trials.
    """
    held = {name: text for name, text in candidate.inputs.items() if name in candidate.model.inputs}
    candidate = replace(candidate, model=hold_inputs(candidate.model, held))
    model, trials = candidate.model, candidate.trials
    estimated = [model[n].quantity for n in model.parameters if model[n].quantity.estimated]
    reads = [n for n in model.inputs if n not in _MOTION and all(t.has(n) for t in trials)]
    free = sum(q.spread is None for q in estimated) + (_SURGE if "u" in model.inputs else 0)
    counts = len(estimated), free, len(reads)
    try:
        with threadpool_limits(1, "blas"):
            fit = _fitted(candidate, candidate.trials, candidate.validate)
            left = _left_out(candidate, fit)
            drawn = list(draws_of(fit.identified).unknowns)
            turn = hard_turn(fit.identified, drawn, WORTHLESS)
            targets = fit.validation or [one.comparison for record in left for one in record or ()]
            spread = _spread(fit.identified, targets, drawn, None if fit.validation else turn)
    except ShipidError as error:
        return Tried(model.name, *counts, (None,) * len(trials), message=str(error))
    return Tried(
        fit.model.name,
        *counts,
        tuple(None if record is None else _fold(record, model) for record in left),
        spread,
        turn,
        {
            c.trial.name: counted_measures([LeftOutTrial(c, swings_of(fit.identified, c))], model)[0][0]
            for c in fit.validation
        },
        tuple(_beyond_the_others(fit, candidate.trials, candidate.validate)),
        "" if fit.converged else "the search did not converge.",
        tuple(one.comparison for record in left for one in record or ()),
    )


#: What a fit says of its trials that bears on the choice of a model.
_OF_RECORDS = (ASTERN, TRIAL_TWICE, SEEN_BEFORE, SHIP_LENGTH)


def _beyond_the_others(fit: Fit, trials: Sequence[Trial], kept_apart: Sequence[Trial]) -> list[Notice]:
    """What is wrong with the trials, and where one that is predicted goes beyond the rudder angles and motions of those that are fitted."""
    model, joint = fit.model, fit.ship.joint.get(fit.model.name)
    told = [
        n for n in fit.warnings if n.kind in _OF_RECORDS or (n.kind == BEYOND and n.known["quantity"] not in _SIZES)
    ]
    if joint is None:
        return told
    pairs = [(one, [t for t in trials if t is not one]) for one in trials if len(trials) > 1]
    for one, fitted in [*pairs, *((one, list(trials)) for one in kept_apart)]:
        seen, reached = largest_amplitudes(fitted), largest_amplitudes([one])
        range_seen = replace(joint, rudder=seen.get("rudder"), rate=seen.get("rate"), drift=seen.get("drift"))
        ship = replace(fit.ship, joint={**fit.ship.joint, model.name: range_seen})
        for notice in beyond_of_record(model, ship, one):
            if notice.kind != BEYOND or notice.known["quantity"] not in _SIZES:
                continue
            which = "the trials that were fitted" if one in kept_apart else "the other trials"
            said = []
            for quantity in (notice.known["quantity"], *notice.known.get("also", ())):
                key, words, unit = _SIZES[quantity]
                here, there = (shown(sizes[key], quantity, unit, digits=3) for sizes in (reached, seen))
                said.append(f"{words} {here}, and at most {there} in {which}")
            sentence = f"{'; '.join(said)}: its prediction is an extrapolation."
            told.append(Notice(sentence, BEYOND, **notice.known).about(one.name))
    return told


def _fitted(candidate: Attempt, trials: Sequence[Trial], validate: Sequence[Trial]) -> Fit:
    return identify(
        candidate.model,
        trials,
        ship=candidate.ship,
        validate=validate,
        starts=candidate.starts,
        seed=candidate.seed,
    )


def _left_out(candidate: Attempt, fit: Fit) -> tuple[tuple[LeftOutTrial, ...] | None, ...]:
    """The records of a fit left out in turn; where it minimises no cost that can go on without them, each is fitted anew."""
    records = records_of(fit.fitted)
    if can_be_left_out(fit.identified) and len(records) == len(candidate.trials):
        return left_out(fit.identified, fit.fitted, records)
    found: list[tuple[LeftOutTrial, ...] | None] = []
    for one in candidate.trials:
        try:
            again = _fitted(candidate, [o for o in candidate.trials if o is not one], [one])
        except ShipidError:
            found.append(None)
            continue
        found.append(tuple(LeftOutTrial(c, swings_of(again.identified, c)) for c in again.validation))
    return tuple(found)


def _fold(record: Sequence[LeftOutTrial], model: Model) -> Fold:
    counted = counted_measures(record, model)
    return Fold(
        {n: together([measures[n] for measures, _, _ in counted]) for n in MEASURES},
        float(np.exp(np.mean(np.log([score for _, score, _ in counted])))),
        together([rate for _, _, rate in counted]),
    )


def _spread(
    identified: Identified, targets: Sequence[Comparison], drawn: Sequence[np.ndarray], turn: HardTurn | None
) -> float:
    """Spread of the rate of turn over draws, in shares of its size, root-mean-square over what is to be predicted.

    A hard turn in which the model runs away shows nothing of the other manoeuvres: the choice asks for it on its own.
    """
    shares = [_spread_of(identified, c, drawn) for c in targets]
    found = [] if not shares else [float(np.sqrt(np.mean(np.square(shares))))]
    return together([*found, *([] if turn is None or turn.rate is None else [turn.spread])]) or 0.0


def _spread_of(identified: Identified, c: Comparison, drawn: Sequence[np.ndarray]) -> float:
    model = identified.model
    if "r" not in model:
        return 0.0
    runs = runs_of(identified, c, drawn, None)
    record = make_record(model, ("r",))
    rates = np.array([record.run(x0, runs.data.inputs, runs.data.intervals, p, bias)[0][0] for x0, p, bias in runs])
    size = float(np.nanstd(c.trial["r"])) if c.trial.has("r") else float(np.std(rates[0]))
    if not np.isfinite(rates).all() or not size > 0:
        return WORTHLESS
    return min(WORTHLESS, float(np.sqrt(np.mean((rates[1:] - rates[0]) ** 2))) / size)
