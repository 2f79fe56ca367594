"""Whether rudder or order of a trial act later than they are logged: the dead time of a steering gear, or a clock that is early."""

from __future__ import annotations

import functools
import warnings
from dataclasses import dataclass

import numpy as np

from shipid.trials.doctor.examinations.motion.heading import examine_wrap
from shipid.trials.doctor.examinations.record.missing import examine_missing
from shipid.trials.doctor.examinations.steering.delay import answer_to, examine_delay
from shipid.trials.doctor.examinations.steering.order_alone import LateAnswer, late_answer
from shipid.trials.doctor.examinations.steering.rudder import examine_movement
from shipid.trials.doctor.findings import CERTAIN
from shipid.trials.doctor.guesses import from_trial
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.trial import Trial


@dataclass(frozen=True)
class EarlyRudder:
    """A rudder that is logged before it acts.

    Attributes
    ----------
    seconds : float
        By how much, in s.
    confidence : float
        Confidence that it is a dead time, from 0 to 1.
    """

    seconds: float
    confidence: float

    @property
    def firm(self) -> bool:
        """Whether the confidence is that of a certain finding."""
        return self.confidence >= CERTAIN


@functools.lru_cache(maxsize=128)
def early_rudder(trial: Trial) -> EarlyRudder | None:
    """Return by how much the rudder of a trial is logged before it acts, or None where the doctor finds nothing.

    Parameters
    ----------
    trial : Trial
        The trial.
    """
    copy = WorkingCopy(from_trial(trial).record)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a fit through too few samples says so in its result
        try:
            for examination in (examine_wrap, examine_missing, examine_movement, examine_delay):
                if len(copy) < 4:
                    return None
                examination(copy)
            found = next((f for f in copy.findings if f.kind == "latency" and f.fix is None), None)
            answer = None if found is None or copy.rudder is None else answer_to(copy, copy.rudder)
        except np.linalg.LinAlgError:
            return None
    if found is None or answer is None or answer.delay <= 0:
        return None
    return EarlyRudder(answer.delay, found.confidence)


@functools.lru_cache(maxsize=128)
def order_answered(trial: Trial, name: str) -> LateAnswer | None:
    """Return when the rudder sets out after an order with no rudder angle beside it, or None where the record does not tell.

    Parameters
    ----------
    trial : Trial
        The trial.
    name : str
        The column of the order.
    """
    copy = WorkingCopy(from_trial(trial).record)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a fit through too few samples says so in its result
        try:
            for examination in (examine_wrap, examine_missing):
                if len(copy) < 4:
                    return None
                examination(copy)
            return late_answer(copy, name)
        except np.linalg.LinAlgError:
            return None
