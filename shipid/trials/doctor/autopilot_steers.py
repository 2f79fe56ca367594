"""Whether an autopilot steers a trial against disturbances: output error is then biased, and of a kept course every method is."""

from __future__ import annotations

import functools
import warnings

import numpy as np

from shipid.trials.doctor.examinations.motion.heading import examine_wrap
from shipid.trials.doctor.examinations.record.missing import examine_missing
from shipid.trials.doctor.examinations.steering.closed_loop import examine_closed_loop
from shipid.trials.doctor.examinations.steering.rudder import examine_movement
from shipid.trials.doctor.findings import LEAST, SURE, Finding
from shipid.trials.doctor.guesses import from_trial
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.signals.plates import plates
from shipid.trials.trial import Trial

#: So often the rudder is put over in no zig-zag or turn within so short a time.
_MANY = 20


def autopilot_steers(trial: Trial) -> Finding | None:
    """Return the finding that the rudder of a trial follows its heading while disturbances turn the ship.

    Parameters
    ----------
    trial : Trial
        The trial.

    Returns
    -------
    Finding or None
        None where the orders are steps, as of a zig-zag or a turn, or the rudder explains nearly all of the turning.
    """
    return next((f for f in _steering(trial) if f.kind == "closed-loop" and f.spoils and f.confidence >= SURE), None)


def rudder_answers(trial: Trial, unit_time: float) -> bool:
    """Return whether the rudder of a trial answers what the sensors show, noise included, as that of no zig-zag or turn does.

    Parameters
    ----------
    trial : Trial
        The trial.
    unit_time : float
        L/U in s.

    Returns
    -------
    bool
        Whether it follows the heading more likely than not, or is put over to and fro faster than the ship can answer.
    """
    if any(f.kind == "closed-loop" and f.confidence >= LEAST for f in _steering(trial)):
        return True
    name = next((n for n in ("delta", "delta_order") if trial.has(n) and np.isfinite(trial[n]).any()), None)
    if name is None:
        return False
    there = np.isfinite(trial[name])
    t = trial["t"][there]
    held = [t[p.last - 1] - t[p.first] for p in plates(trial[name][there])]
    return len(held) >= _MANY and float(np.median(held)) < unit_time


def course_is_kept(trial: Trial) -> bool:
    """Return whether the doctor is sure that nothing but disturbances moves the rudder of a trial.

    Parameters
    ----------
    trial : Trial
        The trial.
    """
    return any(f.kind == "course-keeping" and f.confidence >= SURE for f in _steering(trial))


@functools.lru_cache(maxsize=128)
def _steering(trial: Trial) -> tuple[Finding, ...]:
    """What the doctor finds in how a trial is steered."""
    copy = WorkingCopy(from_trial(trial).record)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a fit through too few samples says so in its result
        for examination in (examine_wrap, examine_missing, examine_movement, examine_closed_loop):
            if len(copy) < 4:
                return ()
            try:
                examination(copy)
            except np.linalg.LinAlgError:
                return ()
    return tuple(copy.findings)
