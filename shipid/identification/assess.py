"""The verb that assesses a fit: weakly determined directions, residuals, prediction bands, findings on its trials."""

from __future__ import annotations

from dataclasses import replace

from threadpoolctl import threadpool_limits

from shipid.identification.assessment import Assessment
from shipid.identification.fit import Fit
from shipid.identification.problem.dead_time import has_lag
from shipid.identification.uncertainty.directions import directions_of
from shipid.identification.uncertainty.draws import DRAWS, draws_of
from shipid.identification.uncertainty.residuals import residuals_of
from shipid.identification.validation.bands import manoeuvres_of
from shipid.identification.validation.left_out import can_be_left_out, left_out, records_of
from shipid.identification.validation.structure_error import StructureError, structure_error
from shipid.identification.validation.trial_findings import findings_of


def assess(fit: Fit, *, bands: bool = True, findings: bool = True, draws: int = DRAWS, seed: int = 0) -> Fit:
    """Assess a fit: weakly determined directions, residuals, prediction bands, and faults of its trials.

    Parameters
    ----------
    fit : Fit
        The fit.
    bands : bool
        Whether the manoeuvres of the trials are predicted with 95 % bands. Each fitted trial is left out in turn for them: its error
        is that of the structure.
    findings : bool
        Whether the trials are checked for faults; nothing is repaired.
    draws : int
        Number of draws of the coefficients behind the bands.
    seed : int
        Of the draws.

    Returns
    -------
    Fit
        The same fit with its `assessment`, which printing, `to_dict` and a report read.
    """
    identified = fit.identified
    # The matrices are tall and thin: several threads on each cost more than they bring.
    with threadpool_limits(1, "blas"):
        compared = (*fit.fitted, *fit.validation)
        structure = _structure(fit) if bands else None
        drawn = draws_of(identified, draws, seed)
        # What a ship has and her model lacks is in like manoeuvres alike, and the coefficients make up for it there; for some of it they
        # do not in a steady turn, and for the weather of a day nowhere else.
        wide = drawn if fit.lacks is None else draws_of(identified, draws, seed, fit.lacks.errors)
        turning = wide if fit.lacks is not None and fit.lacks.steering else drawn
        drawn = drawn if fit.lacks is None or fit.lacks.lasting else wide
        assessment = Assessment(
            directions_of(identified, [c.measures.words for c in fit.fitted]),
            residuals_of(identified),
            manoeuvres_of(identified, compared, drawn, structure, turning) if bands else None,
            findings_of(
                fit.ship,
                fit.fitted,
                fit.validation,
                fit.model.inputs,
                identified.method,
                bool(fit.model.delays),
                has_lag(fit.model),
            )
            if findings
            else None,
            structure,
        )
    return replace(fit, assessment=assessment)


def _structure(fit: Fit) -> StructureError:
    """The error of the structure, from trials that are left out where there are two of them."""
    if not can_be_left_out(fit.identified):
        return StructureError()
    found = left_out(fit.identified, fit.fitted, records_of(fit.fitted))
    return structure_error(one for record in found for one in record or ())
