"""The loadings of trials: what each states of its own in one number, and the reference of a model whose coefficients depend on it."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence

import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.errors import UsageError
from shipid.parameters.loading import MEASURES, REFERENCE, at_loading, measure_of
from shipid.trials.conditions import one_loading
from shipid.trials.trial import Trial


def loading_of(trial: Trial, measure: str) -> float | None:
    """Return the loading of a trial, SI: the median of a column of that name, or what its conditions state; None where neither does.

    Parameters
    ----------
    trial : Trial
        The trial.
    measure : {"draught", "displacement"}
        What says the loading.
    """
    column = trial[measure] if trial.has(measure) else np.zeros(0)
    there = column[np.isfinite(column)]
    return float(np.median(there)) if there.size else trial.source.conditions.loading.get(measure)


def loadings_of(trials: Sequence[Trial]) -> dict[str, list[float]]:
    """Return the loadings of trials that were sailed at several, SI, by what says them: only what every trial states.

    Parameters
    ----------
    trials : sequence of Trial
        The trials.
    """
    found = {}
    for measure in MEASURES:
        stated = [v for t in trials if (v := loading_of(t, measure)) is not None]
        if len(stated) == len(trials) and not one_loading(stated):
            found[measure] = stated
    return found


def with_load_part(model: Model, trials: Sequence[Trial]) -> Model | None:
    """Return a model whose coefficients depend on the loading, where trials at several state it; None otherwise.

    Parameters
    ----------
    model : Model
        The model; None as well where its coefficients depend on a loading already, or none of them can.
    trials : sequence of Trial
        The trials.
    """
    measure = next(iter(loadings_of(trials)), None)
    if measure is None or measure_of(model) is not None:
        return None
    with contextlib.suppress(UsageError):
        return at_loading(model, measure)
    return None


def reference_loading(model: Model, trials: Sequence[Trial]) -> dict[str, float]:
    """Return the reference that coefficients are stated at where nothing else says it: the mean loading of the trials, SI, by its name.

    Parameters
    ----------
    model : Model
        A model; one whose coefficients do not depend on the loading has none.
    trials : sequence of Trial
        The trials.
    """
    measure = measure_of(model)
    stated = [] if measure is None else [v for t in trials if (v := loading_of(t, measure)) is not None]
    # As it is written: the mean of each loading once, so that many trials at one do not move it.
    return {f"{measure}{REFERENCE}": float(f"{np.mean([min(stated), max(stated)]):.3g}")} if stated else {}
