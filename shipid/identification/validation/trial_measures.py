"""The manoeuvre of a trial, measured once for everything that reads it."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from shipid.foundation.errors import ShipidError
from shipid.foundation.result import Result
from shipid.trials.checks import FEWEST_SAMPLES
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.findings import Diagnosis
from shipid.trials.measuring.measure import detect, measure
from shipid.trials.measuring.results.turning_circle import TurningCircle
from shipid.trials.measuring.results.zigzag import ZigZag
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, repr=False)
class TrialMeasures(Result):
    """What a trial is, and its numbers.

    Attributes
    ----------
    kind : {"zig-zag", "turning circle", ""}
        What it was found to be; empty where it is neither.
    zigzag : ZigZag or None
        Read as a zig-zag; None where it has no reversals of the rudder to read.
    circle : TurningCircle or None
        Read as a turning circle; None where it is none.
    """

    kind: Literal["zig-zag", "turning circle", ""]
    zigzag: ZigZag | None
    circle: TurningCircle | None

    def to_frame(self) -> pd.DataFrame:
        """Return the table of what the trial was found to be; that of the fields where it is neither."""
        found = self.zigzag if self.kind == "zig-zag" else self.circle
        return super().to_frame() if found is None else found.to_frame()

    @property
    def words(self) -> str:
        """What the trial is, as in ``20/20 zig-zag``."""
        if self.kind == "zig-zag" and self.zigzag is not None:
            return f"{self.zigzag.nominal} zig-zag"
        return TurningCircle.kind if self.circle is not None else "record"


def measures_of(trial: Trial, said: Diagnosis, length: float | None) -> TrialMeasures:
    """Measure a trial.

    Parameters
    ----------
    trial : Trial
        The trial, or a stretch of one.
    said : Diagnosis
        What the doctor says of the whole trial, see `examined`.
    length : float or None
        Length of the ship in m, for ratios to it.

    Returns
    -------
    TrialMeasures
    """
    metres = f"{length!r} m" if length else None
    if any(trial.has(n) and np.isfinite(trial[n]).sum() < FEWEST_SAMPLES for n in ("psi", "delta")):
        # A stretch of a record in which the compass was silent.
        return TrialMeasures("", None, None)
    said = said.within(float(trial["t"][0]), float(trial["t"][-1]))
    try:
        kind = detect(trial, said)
    except ShipidError:
        kind = ""
    circle = measured_circle(trial, metres, diagnosis=said) if kind == TurningCircle.kind else None
    try:
        zigzag = measure(trial, ZigZag.kind, length=metres, diagnosis=said)
    except ShipidError:
        zigzag = None
    return TrialMeasures(
        "zig-zag" if kind == ZigZag.kind else "turning circle" if kind == TurningCircle.kind else "",
        zigzag if isinstance(zigzag, ZigZag) else None,
        circle,
    )


@functools.lru_cache(maxsize=64)
def examined(trial: Trial) -> Diagnosis:
    """Return what the doctor says of a trial, once for all that is measured of it and of its stretches, whichever model is fitted to it.

    Parameters
    ----------
    trial : Trial
        The trial, as it was read.
    """
    try:
        return check_trial(trial)
    except ShipidError:
        return Diagnosis(trial.name)


def measured_circle(
    trial: Trial, length: str | None, execute: str | None = None, diagnosis: Diagnosis | None = None
) -> TurningCircle | None:
    """Measure a turning circle.

    Parameters
    ----------
    trial : Trial
        The record.
    length : str or None
        Length of the ship with its unit, for ratios to it.
    execute : {"moved", "order"}, optional
        How the execute is read, see `shipid.trials.measuring.measure.measure`.
    diagnosis : Diagnosis, optional
        What the doctor says of the record. Without it the record counts as sound, as one that a model predicts is.

    Returns
    -------
    TurningCircle or None
        None where the record is none.
    """
    try:
        sound = Diagnosis(trial.name) if diagnosis is None else diagnosis
        found = measure(trial, TurningCircle.kind, execute=execute, length=length, diagnosis=sound)
        if diagnosis is None and isinstance(found, TurningCircle) and found.course is None:
            # No helmsman keeps a model on her course: the one she turns from is her heading at the order.
            kept = _on_course(trial, found.first_execute)
            found = measure(kept, TurningCircle.kind, execute=execute, length=length, diagnosis=sound)
    except ShipidError:
        return None
    return found if isinstance(found, TurningCircle) else None


def _on_course(trial: Trial, order: float | None) -> Trial:
    """The trial with the heading at the order also before it."""
    t, psi = trial["t"], trial["psi"]
    at = -np.inf if order is None else order
    return replace(trial, table=trial.table.assign(psi=np.where(t < at, np.interp(at, t, psi), psi)))
