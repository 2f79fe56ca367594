"""Trials at several loadings: what there is to say of it, and the coefficients at each."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np

from shipid.declaration.vocabulary import shown, shown_estimate
from shipid.estimation.estimate import Estimate, estimate_of
from shipid.foundation.notices import Notice
from shipid.generation.simulator import coefficient_vector
from shipid.generation.system import generate
from shipid.identification.evidence.load_part import LoadPart
from shipid.identification.identified import Identified
from shipid.identification.uncertainty.estimates import published_names
from shipid.parameters.loading import REFERENCE, load_parts, measure_of, value_at_loading
from shipid.trials.conditions import Conditions, different_loadings

#: Kind of the notice.
LOADINGS = "loadings"


def loading_notices(stated: Mapping[str, Conditions], part: LoadPart | None = None) -> list[Notice]:
    """Return a notice where trials state different loadings and one set of coefficients stands for all of them.

    Parameters
    ----------
    stated : mapping of str to Conditions
        By trial.
    part : LoadPart, optional
        What the trials say of coefficients that change with the loading.
    """
    if part is not None and part.kept:
        return []
    found = different_loadings(stated)
    if found is None:
        return []
    tried = (
        "State the draught or the displacement of every trial, and identify tries coefficients that change with it (by its default; "
        "the ending -draught or -displacement of the name of the model asks for them)."
        if part is None
        else f"Coefficients that change with the {part.measure} were tried: {part.why}"
    )
    words = (
        f"the trials state different loadings, and one set of coefficients stands for all of them: {found}. It is an "
        f"average of different ships: fit each loading alone, and compare the coefficients. {tried}"
    )
    return [Notice(words, LOADINGS)]


def coefficients_at(identified: Identified, loading: float) -> dict[str, Estimate]:
    """Return the coefficients of a fit at a loading, with their intervals by first order.

    Parameters
    ----------
    identified : Identified
        Of a model whose coefficients depend on the loading.
    loading : float
        Draught in m, or displacement in kg, whichever the model reads.

    Returns
    -------
    dict of str to Estimate
        Those that change with it, and the published ones that follow from them.
    """
    problem, model = identified.problem, identified.model
    measure = measure_of(model)
    assert measure is not None, model.name
    system = generate(model)
    names = [*load_parts(model), *published_names(model)]
    expression = system.expression([value_at_loading(model, n) for n in names])
    function = ca.Function("at", [system.u, system.p], [expression, ca.jacobian(expression, system.p)])
    u = np.array([loading if n == measure else 1.0 for n in model.inputs])
    numbers, slopes = function(u, coefficient_vector(model, identified.values))
    slope = slopes.full()[:, [system.coefficients.index(n) for n in problem.estimated]]
    shared = len(problem.estimated)
    matrix = identified.covariance.matrix[:shared, :shared]
    found = {}
    for k, name in enumerate(names):
        by = np.flatnonzero(slope[k])
        variance = float(slope[k, by] @ matrix[np.ix_(by, by)] @ slope[k, by])
        found[name] = estimate_of(model[name], float(numbers[k]), float(np.sqrt(variance)), follows=True)
    return found


def loading_lines(identified: Identified) -> list[str]:
    """Return one line for each loading of the trials with the coefficients there, and one that says how they depend on it.

    Parameters
    ----------
    identified : Identified
        What was identified; no lines where its coefficients do not depend on the loading.
    """
    part, model = identified.load_part, identified.model
    measure = measure_of(model)
    if measure is None or part is None:
        return []
    reference = shown(identified.values[f"{measure}{REFERENCE}"], measure)
    lines = [
        f"  loading   {', '.join(load_parts(model))} are those at a {measure} of {reference}, and change with it (odds {part.odds}"
        + (")" if part.kept else f"): not shown by these trials: {part.why}")
    ]
    for loading in part.loadings:
        found = coefficients_at(identified, loading)
        values = ", ".join(f"{n} {shown_estimate(e.value, e.std, n, e.unit)}" for n, e in found.items())
        lines.append(f"            at {shown(loading, measure, digits=3)}: {values}")
    return lines
