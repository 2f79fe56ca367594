"""Whether a sound trial can be identified from: a clock without gaps, and a rudder that moves."""

from __future__ import annotations

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.trials.checks import STEADY_RUDDER, gaps
from shipid.trials.errors import ClockGapError, NonFiniteError, NoRudderMovementError, UnknownColumnError
from shipid.trials.trial import Trial


def check_regular(trial: Trial) -> None:
    """Refuse a trial whose clock has a gap: a model cannot be run through a stretch without samples.

    Parameters
    ----------
    trial : Trial
        The trial.

    Raises
    ------
    NonFiniteError
        If a sample is missing.
    ClockGapError
        With the longest gap, and the stretches before and after it.
    """
    holes = [name for name in trial.table.columns if trial.table[name].isna().any()]
    if holes:
        raise NonFiniteError(
            f"trial '{trial.name}': samples of {', '.join(holes)} are missing. Use a window without them (FILE@start:end)."
        )
    t = trial["t"]
    found = gaps(t, trial.sampling)
    if found.size:
        k = int(found[np.argmax(np.diff(t)[found])])
        raise ClockGapError(
            f"trial '{trial.name}': the clock has {found.size} gaps, the longest from {t[k]:g} to {t[k + 1]:g} s, "
            f"where samples come every {trial.sampling:.4g} s. Use the stretches on either side: "
            f"@{t[0]:g}:{t[k]:g} and @{t[k + 1]:g}:{t[-1]:g}."
        )


def check_identifiable_input(trial: Trial, column: str = "delta") -> None:
    """Refuse a trial in which the rudder does not move: there is no response to identify.

    Parameters
    ----------
    trial : Trial
        The trial.
    column : str
        The input: ``delta`` or ``delta_order``.

    Raises
    ------
    NoRudderMovementError
        If the rudder stays within 0.5 deg.
    UnknownColumnError
        If there is no such column.
    """
    if not trial.has(column):
        raise UnknownColumnError(
            f"trial '{trial.name}' has no column '{column}', and without the rudder angle there is nothing to "
            f"identify. It has {', '.join(trial.table.columns)}."
        )
    delta = trial[column]
    spread = float(np.ptp(delta))
    if spread <= STEADY_RUDDER:
        raise NoRudderMovementError(
            f"trial '{trial.name}', column '{column}': the rudder stays at {angle(float(np.median(delta)), 3)} "
            f"(it moves by {angle(spread, 2)}), so the response to it cannot be identified. "
            "Use a stretch with a manoeuvre in it, or check which column holds the rudder angle."
        )
