"""Which of several ships, or of several conditions of one ship, a record was sailed by: a multiple-model filter over parameter sets."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.model import Model
from shipid.estimation.errors import ModeError
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.levels.judge_filter import judge_filter
from shipid.estimation.levels.record_levels import RecordLevels
from shipid.estimation.multiple.interacting import InteractingMultipleModel
from shipid.estimation.multiple.multiple_run import MultipleModelRun
from shipid.estimation.records.arrangement import FilterRecord
from shipid.estimation.settings.instruments import Amount
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.numbers import brief
from shipid.foundation.result import DrawnResult, table
from shipid.parameters.catalogue import ship_of
from shipid.parameters.parameter_set import ParameterSet

if TYPE_CHECKING:
    import pandas as pd

#: A ship's condition changes once in so long, in s: hardly ever within a trial.
_KEPT = 3600.0
#: A mode less probable than this at the end is ruled out; between the two the record does not tell.
_CERTAIN = 0.95


@dataclass(frozen=True, eq=False, repr=False)
class WhichShip(DrawnResult):
    """What a record says of several parameter sets.

    Attributes
    ----------
    run : MultipleModelRun
        The filter over all of them; a mode each.
    levels : RecordLevels
        The noise levels of all modes: those under which the record is most probable by the best of them.
    log_likelihoods : mapping of str to float
        Of the record by each set alone, with these levels.
    warnings : tuple of Notice
        What speaks against the most probable set by itself.
    """

    run: MultipleModelRun
    levels: RecordLevels
    log_likelihoods: Mapping[str, float]
    warnings: tuple[Notice, ...] = ()

    @property
    def answer(self) -> str:
        """In one sentence, which one sails."""
        last = dict(zip(self.run.modes, self.run.probabilities[-1].tolist()))
        best = max(last, key=lambda n: last[n])
        if last[best] < _CERTAIN:
            shares = ", ".join(f"{n} {brief(p, 2)}" for n, p in last.items())
            return f"The record does not tell which one sails: {shares}."
        return f"{best} sails, with a probability of {brief(last[best], 4)} among those given."

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, free of NaN."""
        told = self.run.probabilities[-1].max() >= _CERTAIN
        own = self.run.to_dict()
        for name, value in self.log_likelihoods.items():
            own["modes"][name]["log_likelihood_alone"] = value
        said = {"told": bool(told), "answer": self.answer, "warnings": plain_notices(self.warnings)}
        return own | self.levels.to_dict() | said

    def text(self) -> str:
        """Return the result in lines of text."""
        alone = "\n".join(f"  log-likelihood of {n} alone {v:.1f}" for n, v in self.log_likelihoods.items())
        caution = (
            "  The probabilities compare the sets given; that one is the most probable does not say that it is right."
        )
        notes = [f"  {'WARNING' if n.serious else 'note'}: {n}" for n in self.warnings]
        return "\n".join([f"{self.run.text()}\n{alone}\n  {self.answer}\n{caution}", *notes])

    def to_frame(self) -> pd.DataFrame:
        """Return the sets as a pandas table: probability at the end and on average, log-likelihood alone."""
        last, mean = self.run.probabilities[-1].tolist(), self.run.probabilities.mean(axis=0).tolist()
        rows = zip(self.run.modes, last, mean)
        return table(
            (
                {"ship": n, "probability": p, "mean_probability": m, "log_likelihood_alone": self.log_likelihoods[n]}
                for n, p, m in rows
            ),
            "ship",
        )


def which_ship(
    model: Model,
    ships: Sequence[ParameterSet | str],
    record: FilterRecord,
    *,
    measured: Mapping[str, Amount | None],
    kept: Sequence[str] = (),
    noise: Mapping[str, Amount] | None = None,
    initial: Mapping[str, Amount] | None = None,
    start: Mapping[str, Amount] | None = None,
    inputs: Mapping[str, Amount] | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> WhichShip:
    """Compare parameter sets of one model on a record.

    The noise levels come from the record, as those of `shipid filter` do: found for each set alone, and taken from the one by which
    the record is most probable, so that no set is helped by noise of its own.

    Parameters
    ----------
    model : Model
        The model.
    ships : sequence of ParameterSet or str
        Two or more parameter sets, with different names.
    record : Trial or mapping of str to ndarray
        What was measured.
    measured, noise, initial, start, inputs
        As for `shipid.ExtendedKalmanFilter`.
    kept : sequence of str
        ``sensor:NAME`` and ``noise:NAME`` that stay as given.
    tell : callable
        Called with what is being done.

    Returns
    -------
    WhichShip

    Raises
    ------
    ModeError
        If there are fewer than two, or two of the same name.
    ShipidError
        For names, units and levels that do not fit.
    """
    sets = [ship_of(s) for s in ships]
    names = [s.name for s in sets]
    if len(sets) < 2 or len(set(names)) < len(names):
        raise ModeError(f"give two or more ships with different names to compare; given: {', '.join(names) or 'none'}.")
    best: tuple[float, RecordLevels] | None = None
    filters = {}
    for each in sets:
        kalman = ExtendedKalmanFilter(
            model,
            each,
            measured=measured,
            estimated=(),
            noise=noise,
            initial=initial,
            start=start,
            inputs=inputs,
            gate=None,
            shared_noise=False,
        )
        tell(f"finding the noise levels of {each.name}")
        filters[each.name] = kalman
        levels = kalman.learn_levels(record, tuple(kept))
        reached = kalman.with_levels(levels).filter(record).log_likelihood
        if best is None or reached > best[0]:
            best = reached, levels
    assert best is not None
    tuned = {n: f.with_levels(best[1]) for n, f in filters.items()}
    count = len(tuned)
    stay = 1 - 1 / _KEPT
    transition = np.full((count, count), (1 - stay) / (count - 1))
    np.fill_diagonal(transition, stay)
    tell("comparing the ships")
    run = InteractingMultipleModel.of_filters(tuned, transition, per="1 s").filter(record)
    alone = {n: f.filter(record) for n, f in tuned.items()}
    probable = alone[run.most_probable[-1]]
    return WhichShip(
        run,
        best[1],
        {n: r.log_likelihood for n, r in alone.items()},
        judge_filter(probable, best[1]).warnings,
    )
