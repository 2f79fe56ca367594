"""What identification makes of the record that a filter ran over: what the filter is judged beside."""

from __future__ import annotations

from collections.abc import Sequence

from shipid.declaration.model import Model
from shipid.estimation.levels.record_levels import BatchEstimate
from shipid.estimation.settings.defaults import parameters_to_estimate
from shipid.estimation.standing import AT_BOUND
from shipid.foundation.errors import ShipidError
from shipid.identification.evidence.several_ends import undecided
from shipid.identification.identify import identify
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.trial import Trial


def beside_filter(
    model: Model, record: Trial, ship: ParameterSet | None, names: Sequence[str], signals: Sequence[str] | None = None
) -> BatchEstimate | None:
    """Return the coefficients that `identify` finds in a record with its defaults.

    A filter and an identification of the same record are two answers to one question. The filter is judged beside the numbers that a
    user gets from the other command, and not beside an estimate of its own under other weights and other priors.

    Parameters
    ----------
    model : Model
        The model of the filter.
    record : Trial
        What was filtered.
    ship : ParameterSet or None
        Where the search starts.
    names : sequence of str
        Coefficients that the filter estimates.
    signals : sequence of str, optional
        What the filter measures, where that was chosen; the usual signals by default.

    Returns
    -------
    BatchEstimate or None
        None where the record cannot be identified, or the search did not converge. A coefficient that ended at its bound has no
        value: it is named.
    """
    try:
        # Coefficients that are named are no more the model's own choice, and a dead time would not be looked for.
        usual = set(names) == set(parameters_to_estimate(model))
        fit = identify(model, [record], ship=ship, estimate=None if usual else tuple(names), signals=signals)
    except ShipidError:
        return None
    values = {
        n: (e.value, e.std, e.ci95)
        for n, e in fit.parameters.items()
        if e.value is not None and e.std is not None and e.ci95 is not None
    }
    if not fit.converged:
        return None
    at_bound = tuple(n for n, e in fit.parameters.items() if e.why.startswith(AT_BOUND))
    used = next(r.method for r in fit.ladder if r.used)
    return BatchEstimate(used.replace("-", " "), values, at_bound, undecided(fit.identified.solution.notices))
