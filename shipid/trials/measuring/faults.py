"""What the doctor found that bears on measured numbers: samples that count as missing, and what to say beside the numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from shipid.foundation.notices import Notice
from shipid.foundation.numbers import moment
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.doctor.findings import LEAST, SURE, Diagnosis
from shipid.trials.signals.order import lag_behind_order
from shipid.trials.trial import Trial

#: Kinds of findings whose samples show nothing of the ship.
_SHOW_NOTHING = ("frozen", "outlier", "heading-glitch", "position-jump")
#: The kind that makes headings before and behind it incomparable.
_STEP = "heading-step"
#: Kinds that spoil no identification, and are said beside the distances of a turn all the same.
_BESIDE = ("track-inconsistent",)
#: Kinds that make of positions no track along and across a course.
_ELSEWHERE = ("track-direction", "unit")
#: Kinds that are told at the numbers they touch.
_TOLD = ("gap", "hole", "missing", "sentinel", "short")
#: Kinds that mislead an identification and no number measured here: the execute is the order, and the uncertainty stated holds the
#: grain and the interval of the samples.
_HARMLESS = ("order-not-feedback", "coarse-sampling", "quantised", "written-on-change")
#: A finding about single samples that are scattered says where they begin and end, not which they are.
_TOGETHER = 0.8
#: A rudder that sets out this much before its order does not follow it [s].
_AHEAD = 0.5
_NAMES = {
    "psi": "the heading", "delta": "the rudder", "delta_order": "the order", "x": "the position", "y": "the position",
    "u": "the speed", "v": "the speed", "U": "the speed", "r": "the rate of turn",
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Faults:
    """What is wrong with the channels of a trial.

    Attributes
    ----------
    diagnosis : Diagnosis
        What the doctor says.
    wrong : Mapping of str to ndarray of bool, shape (samples,)
        Samples that count as missing, by column.
    why : Mapping of str to sequence of (float, float, str)
        From when to when [s] these samples are, and what is wrong with them, by column.
    follows : bool
        Whether the rudder follows its order, both being logged: what is wrong with the clock of one is wrong with the other's.
    """

    diagnosis: Diagnosis
    wrong: Mapping[str, np.ndarray] = field(default_factory=dict)
    why: Mapping[str, Sequence[tuple[float, float, str]]] = field(default_factory=dict)
    follows: bool = False

    def hole(self, name: str, hole: tuple[float, float]) -> str:
        """Return why nothing is known in a hole of a channel, in words.

        Parameters
        ----------
        name : str
            The column.
        hole : tuple of float
            From when to when [s].
        """
        a, b = hole
        for start, end, kind in self.why.get(name, ()):
            if start < b and end > a:
                return f"{kind} {moment(start)} to {moment(end)} s in {_NAMES.get(name, name)}"
        return f"gap {moment(a)} to {moment(b)} s in {_NAMES.get(name, name)}"

    def step(self, start: float, end: float) -> str | None:
        """Return that the heading was set to another value between two times, in words; None where it was not.

        Parameters
        ----------
        start, end : float
            The times [s].
        """
        for when, _ in self._spans(_STEP, start, end):
            return f"the heading is set to another value at {moment(when)} s"
        return None

    def jumps(self, start: float, end: float) -> list[tuple[float, float]]:
        """Return the spans in which the positions jump, between two times [s].

        Parameters
        ----------
        start, end : float
            The times [s].
        """
        return self._spans("position-jump", start, end)

    def misplaced(self) -> Notice | None:
        """Return that the positions are not where heading and speed take the ship, or in another unit; None where they are."""
        said = (n for n in self.notes(("x", "y")) if n.serious and n.kind in _ELSEWHERE)
        return next(said, None)

    def _spans(self, kind: str, start: float, end: float) -> list[tuple[float, float]]:
        return [
            (when, until)
            for found in self.diagnosis.findings
            if found.kind == kind and found.confidence >= SURE
            for when, until in found.spans or (found.seconds,)
            if start < when <= end
        ]

    def notes(self, names: Sequence[str]) -> list[Notice]:
        """Return what the doctor is sure of about these columns and what is not left out already; serious where numbers are misled.

        Parameters
        ----------
        names : sequence of str
            The columns that are measured.
        """
        said: list[Notice] = []
        for found in self.diagnosis.bearing_on(names):
            beside = found.kind in _BESIDE and found.confidence >= SURE
            # A gap is told at the numbers it touches.
            if (found.serious or beside) and found.kind not in _TOLD:
                left_out = found.kind in _SHOW_NOTHING and bool({*found.channels} & {*self.wrong})
                words = f"{found.kind} ({found.channel}): {found.message}" + ("; left out" if left_out else "")
                serious = found.serious and not left_out and found.kind not in _HARMLESS
                said.append(Notice(words, found.kind, serious=serious, channel=found.channel))
            elif found.kind == "latency" and found.confidence >= LEAST and not found.handled:
                said.append(Notice(f"latency ({found.channel}): {found.message}", found.kind, channel=found.channel))
        if "psi" in names:
            # Heading and rate of turn disagree in time or in size, and the heading may be the one that is wrong.
            said += [
                Notice(
                    f"{f.kind} (r): {f.message}; overshoots are right if it is not the heading that is {word}",
                    f.kind,
                    channel="r",
                )
                for f in self.diagnosis.findings
                for kind, word, least in (("latency", "late", SURE), ("rate-scale", "wrong", LEAST))
                if f.kind == kind and f.channel == "r" and f.confidence >= least and not f.handled and not f.serious
            ]
        bearing = self.diagnosis.bearing_on(names)
        if "psi" in names and "delta_order" in names and self.follows:
            # An order that the rudder follows is as early beside the heading as the rudder is.
            early = [
                f for f in self.diagnosis.serious if f.kind == "latency" and f.channel == "delta" and f not in bearing
            ]
            said += [
                Notice(f"latency (delta): {f.message}; its order with it", f.kind, serious=True, channel="delta")
                for f in early
            ]
            bearing = (*bearing, *early)
        others = [f for f in self.diagnosis.serious if f not in bearing and f.kind not in _TOLD]
        if others:
            what = ", ".join(f"{f.kind} ({f.channel})" for f in others)
            said.append(Notice(f"in columns that are not measured here the doctor finds: {what}", "elsewhere"))
        return said


def faults_of(trial: Trial, diagnosis: Diagnosis | None) -> Faults:
    """Return what is wrong with the channels of a trial.

    Parameters
    ----------
    trial : Trial
        The trial.
    diagnosis : Diagnosis or None
        What the doctor says of it; the doctor is asked where it is None.

    Returns
    -------
    Faults
    """
    said = check_trial(trial) if diagnosis is None else diagnosis
    t = trial["t"]
    wrong: dict[str, np.ndarray] = {}
    why: dict[str, list[tuple[float, float, str]]] = {}
    for found in said.findings:
        if found.kind not in _SHOW_NOTHING or found.confidence < SURE or found.handled:
            continue
        spans = found.spans or (found.seconds,)
        mask = np.zeros(len(t), dtype=bool)
        for start, end in spans:
            mask |= (t >= start - 1e-9) & (t <= end + 1e-9)
        # Beside a rate of turn the doctor sees glitches of a heading too small to be found again.
        seen = found.kind == "heading-glitch" and found.count == mask.sum()
        if (found.count < 3 and not seen) or found.count < _TOGETHER * mask.sum() or mask.sum() > 0.5 * len(t):
            # Single wild samples are found again, one by one.
            continue
        for name in found.channels:
            if trial.has(name):
                wrong[name] = wrong.get(name, np.zeros(len(t), dtype=bool)) | mask
                kind = found.kind.replace("heading-glitch", "glitches")
                why.setdefault(name, []).extend((start, end, kind) for start, end in spans)
    follows = False
    if trial.has("delta") and trial.has("delta_order"):
        lag = lag_behind_order(t, trial["delta_order"], trial["delta"])
        follows = lag is not None and lag > -_AHEAD
    return Faults(said, wrong, why, follows)
