"""The manoeuvres of a record, numbered, each with the window it is measured in."""

from __future__ import annotations

from dataclasses import dataclass

from shipid.foundation.numbers import moment
from shipid.trials.doctor.findings import Diagnosis, Stretch
from shipid.trials.errors import SeveralManoeuvresError
from shipid.trials.trial import Trial

_KINDS = {"zigzag": "zig-zag", "turn": "turning circle"}
_AROUND = 0.5
"""A manoeuvre is measured with this share of its duration before and after it, as far as nothing else is sailed there."""
_AT_ONCE = 0.1
"""A turn that follows another manoeuvre within this share of its duration begins from the rudder of that one, which belongs to it."""
_MOST = 0.3
"""A manoeuvre that is a smaller share of its record is measured in its own window, even where it is the only one."""
_CIRCLE = 270.0
"""A turn that is not held, or checked by the other side, is a change of course up to this angle [deg]."""


@dataclass(frozen=True)
class ListedManoeuvre:
    """One manoeuvre of a record.

    Attributes
    ----------
    number : int
        From 1, in order of time.
    kind : {"zig-zag", "turning circle"}
        What it is.
    title : str
        What it is called, with its angles and side.
    start, end : float
        From when to when it was sailed [s].
    window : tuple of float
        From when to when the record belongs to it: with the approach, and with what follows it [s].
    """

    number: int
    kind: str
    title: str
    start: float
    end: float
    window: tuple[float, float]

    def __str__(self) -> str:
        return f"{self.number}: {self.title}, {moment(self.start)} to {moment(self.end)} s"


def manoeuvres_in(trial: Trial, diagnosis: Diagnosis) -> tuple[ListedManoeuvre, ...]:
    """Return the zig-zags and turning circles that the doctor found in a record.

    Parameters
    ----------
    trial : Trial
        The trial.
    diagnosis : Diagnosis
        What the doctor says of it.

    Returns
    -------
    tuple of ListedManoeuvre
        In order of time.
    """
    sailed = [m for m in diagnosis.manoeuvres if m.kind in (*_KINDS, "pull-out")]
    result: list[ListedManoeuvre] = []
    t = trial["t"]
    for k, found in enumerate(sailed):
        if found.kind == "pull-out":
            continue
        pull_out = k + 1 < len(sailed) and sailed[k + 1].kind == "pull-out"
        before = sailed[k - 1].end if k else float(t[0])
        after = sailed[k + 1 + pull_out].start if k + 1 + pull_out < len(sailed) else float(t[-1])
        around = _AROUND * (found.end - found.start)
        end = sailed[k + 1].end if pull_out else found.end
        if k and _KINDS[found.kind] == "turning circle" and found.start - before < _AT_ONCE * (found.end - found.start):
            # The rudder goes over from one side to the other: the order is given while the manoeuvre before it ends.
            whole = sailed[k - 2] if k > 1 and sailed[k - 1].kind == "pull-out" else sailed[k - 1]
            before = max(whole.start, whole.end - _AT_ONCE * (found.end - found.start))
        window = (max(before, found.start - around, float(t[0])), min(after, end + around, float(t[-1])))
        result.append(
            ListedManoeuvre(len(result) + 1, _KINDS[found.kind], _title(found), found.start, found.end, window)
        )
    return tuple(result)


def chosen(trial: Trial, listed: tuple[ListedManoeuvre, ...], number: int | None, kind: str | None) -> Trial:
    """Return the part of a record to measure: the whole where it holds one manoeuvre, else the window of the one asked for.

    Parameters
    ----------
    trial : Trial
        The trial.
    listed : tuple of ListedManoeuvre
        Its manoeuvres.
    number : int or None
        Which one.
    kind : str or None
        Of this kind only.

    Returns
    -------
    Trial

    Raises
    ------
    SeveralManoeuvresError
        If there are several and none is chosen, or there is none with this number; the message lists them.
    """
    if number is not None:
        found = next((m for m in listed if m.number == number), None)
        if found is None:
            raise SeveralManoeuvresError(f"trial '{trial.name}' has no manoeuvre {number}. {_list(trial, listed)}")
        return trial.window(*found.window)
    fitting = [m for m in listed if kind in (None, m.kind)]
    if len(fitting) > 1:
        raise SeveralManoeuvresError(f"trial '{trial.name}' holds several manoeuvres. {_list(trial, tuple(fitting))}")
    if not fitting:
        return trial
    only = fitting[0]
    alone = len(listed) == 1 and only.end - only.start > _MOST * trial.duration
    return trial if alone else trial.window(*only.window)


def _list(trial: Trial, listed: tuple[ListedManoeuvre, ...]) -> str:
    if not listed:
        return "The doctor finds none in it."
    path = trial.source.path or trial.name
    lines = "".join(f"\n  {found}" for found in listed)
    return f"It holds{lines}\nChoose one: shipid measure {path} --manoeuvre {listed[0].number} (in Python manoeuvre=N)."


def _title(found: Stretch) -> str:
    if found.kind == "zigzag":
        title = f"zig-zag {found.rudder_deg:g}/{found.heading_deg:g}, first to {found.side}"
    else:
        what = "turning circle" if found.regular or (found.heading_deg or 0.0) > _CIRCLE else "change of course"
        title = f"{what} with {found.rudder_deg:g} deg of rudder through {found.heading_deg:.0f} deg to {found.side}"
    return title if found.regular or title.startswith("change") else f"{title} (not regular)"
