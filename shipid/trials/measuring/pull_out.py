"""Measure a pull-out: the rate of turn that is left when the rudder was put amidships after a steady turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.trials.errors import NotAManoeuvreError
from shipid.trials.measuring.faults import Faults
from shipid.trials.measuring.results.measures import Measures, quantity, words
from shipid.trials.measuring.rudder.steering import Steering, steering_of
from shipid.trials.signals.channel import Channel, channel_of
from shipid.trials.trial import Trial

_MIDSHIPS = 0.1
"""The rudder is amidships within this share of the angle it came from."""
_SETTLED = 0.05
"""A rate that still changes by more than this share of the turn's rate, over its last fifth, has not settled."""


@dataclass(frozen=True, repr=False, kw_only=True)
class PullOut(Measures):
    """A pull-out, in the terms of ITTC 7.5-04-02-01. The first execute is the order amidships.

    Attributes
    ----------
    kind : str
        ``"pull-out"``.
    side : {"starboard", "port"}
        The side of the turn before.
    turning_rate, residual_rate : float or None
        Rate of turn before the order amidships, and what is left of it at the end.
    """

    kind: ClassVar[str] = "pull-out"
    side: str = words()
    turning_rate: float | None = quantity("rad/s", "rate of turn before the rudder was put amidships, to starboard")
    residual_rate: float | None = quantity("rad/s", "rate of turn left at the end, to starboard")

    @property
    def title(self) -> str:
        """What the manoeuvre is called, such as ``pull-out from port``."""
        return f"{self.kind} from {self.side}"


def measure_pull_out(trial: Trial, execute: str | None, length: float | None, faults: Faults) -> PullOut:
    """Measure a pull-out (see `shipid.trials.measuring.measure.measure`).

    Parameters
    ----------
    trial : Trial
        The trial, or a window of it, with heading and rudder.
    execute, length
        Not needed here.
    faults : Faults
        What the doctor found.

    Returns
    -------
    PullOut

    Raises
    ------
    NotAManoeuvreError
        If the rudder is not put amidships after it was held over, and left there.
    """
    steering = steering_of(trial, "order", wrong=faults.wrong.get("delta"))
    psi = channel_of(trial, "psi", faults.wrong.get("psi"))
    t, y = steering.channel.t, steering.channel.y
    size = float(np.quantile(np.abs(y), 0.98))
    over = np.flatnonzero(np.abs(y) >= 0.5 * size)
    last = int(over[-1]) if over.size else 0
    side = float(np.sign(y[last])) if over.size else 0.0
    lying = last + 1 + np.flatnonzero(np.abs(y[last + 1 :]) < _MIDSHIPS * size)
    if size <= np.radians(1.5) or lying.size < 10 or lying.size < 0.8 * (len(y) - lying[0]):
        raise NotAManoeuvreError(
            f"trial '{trial.name}' is no pull-out: the rudder is not put amidships after a turn and left there. "
            "Choose the window of the manoeuvre (FILE@start:end), or state its kind."
        )
    released = float(t[int(np.flatnonzero(side * y[: last + 1] >= 0.85 * size)[-1])])
    begin, end = float(t[lying[0]]), float(psi.t[-1])
    before = _slope(psi, max(float(psi.t[0]), released - 0.3 * (end - begin)), released)
    late = _slope(psi, end - 0.2 * (end - begin), end)
    middle = _slope(psi, end - 0.4 * (end - begin), end - 0.2 * (end - begin))
    reasons: dict[str, str] = {}
    for name, value, span in (
        ("turning_rate", before, (released - 0.3 * (end - begin), released)),
        ("residual_rate", late, (end - 0.2 * (end - begin), end)),
    ):
        if value is None:
            reasons[name] = faults.hole("psi", psi.hole(*span) or span)
    notes = []
    if late is not None and middle is not None and before and abs(late - middle) > _SETTLED * abs(before):
        notes.append(f"the rate of turn had not settled: it changed by {angle(late - middle, 2)}/s over the last fifth")
    return PullOut(
        trial=trial.name,
        execute="order",
        read_from=_words(steering),
        side="starboard" if side > 0 else "port",
        rudder=float(np.median(y[over])),
        first_execute=released,
        turning_rate=before,
        residual_rate=late,
        reasons=reasons,
        notes=(*notes, *faults.notes(("psi", steering.channel.name))),
    )


def _words(steering: Steering) -> str:
    return "the order" if steering.logged else "the rudder leaving the angle it held"


def _slope(psi: Channel, start: float, end: float) -> float | None:
    part = (psi.t >= start) & (psi.t <= end)
    if part.sum() < 3 or psi.hole(start, end, 0.3 * (end - start)) is not None:
        return None
    return float(np.polynomial.polynomial.polyfit(psi.t[part] - end, psi.y[part], 1)[1])
