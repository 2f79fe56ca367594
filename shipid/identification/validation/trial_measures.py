"""The manoeuvre of a trial, measured once for everything that reads it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from shipid.foundation.errors import ShipidError
from shipid.trials.filling import interpolated
from shipid.trials.measuring.measure import detect, measure
from shipid.trials.measuring.measures import TurningCircle, ZigZag
from shipid.trials.trial import Trial


@dataclass(frozen=True)
class TrialMeasures:
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

    @property
    def words(self) -> str:
        """What the trial is, as in ``20/20 zig-zag``."""
        if self.kind == "zig-zag" and self.zigzag is not None:
            return f"{self.zigzag.nominal} zig-zag"
        return TurningCircle.kind if self.circle is not None else "record"


def measures_of(trial: Trial, length: float | None) -> TrialMeasures:
    """Measure a trial.

    Parameters
    ----------
    trial : Trial
        The trial.
    length : float or None
        Length of the ship in m, for ratios to it.

    Returns
    -------
    TrialMeasures
    """
    metres = f"{length!r} m" if length else None
    trial = between_samples(trial)
    try:
        kind = detect(trial)
    except ShipidError:
        kind = ""
    circle = measured_circle(trial, metres) if kind == TurningCircle.kind else None
    try:
        zigzag = measure(trial, ZigZag.kind, length=metres)
    except ShipidError:
        zigzag = None
    return TrialMeasures(
        "zig-zag" if kind == ZigZag.kind else "turning circle" if kind else "",
        zigzag if isinstance(zigzag, ZigZag) else None,
        circle,
    )


def between_samples(trial: Trial) -> Trial:
    """Return a trial with straight lines over the short holes of its signals, and without the signals that have long ones.

    Parameters
    ----------
    trial : Trial
        The trial.
    """
    if not trial.table.isna().to_numpy().any():
        return trial
    t = trial["t"]
    filled = {n: interpolated(t, trial[n]) for n in trial.table.columns if n != "t"}
    # Before the first and behind the last sample of a slow signal it is not known: the others are read there.
    whole = np.isfinite(filled["psi"]) if "psi" in filled else np.ones(t.size, dtype=bool)
    inside = slice(int(np.argmax(whole)), t.size - int(np.argmax(whole[::-1])))
    table = trial.table.assign(**filled).iloc[inside].reset_index(drop=True)
    return replace(trial, table=table.dropna(axis="columns"))


def measured_circle(trial: Trial, length: str | None, execute: str | None = None) -> TurningCircle | None:
    """Measure a turning circle.

    Parameters
    ----------
    trial : Trial
        The record.
    length : str or None
        Length of the ship with its unit, for ratios to it.
    execute : {"moved", "order"}, optional
        How the execute is read, see `shipid.trials.measuring.measure.measure`.

    Returns
    -------
    TurningCircle or None
        None where the record is none.
    """
    try:
        found = measure(trial, TurningCircle.kind, execute=execute, length=length)
    except ShipidError:
        return None
    return found if isinstance(found, TurningCircle) else None
