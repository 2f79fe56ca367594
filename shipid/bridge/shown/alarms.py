"""Alarms: raised once for a condition, acknowledged one by one, gone when both the condition and the need for an answer are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from shipid.bridge.shown.plain_values import number
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError

#: How urgent it is.
AlarmKind: TypeAlias = Literal["alarm", "warning", "caution"]
_ORDER = ("alarm", "warning", "caution")


@dataclass
class Alarm:
    """One alarm.

    Attributes
    ----------
    id : int
        By which it is acknowledged.
    kind : {"alarm", "warning", "caution"}
        How urgent it is.
    text : str
        What is the matter.
    since : float
        When it was raised, in s on the bridge's clock.
    acknowledged : bool
        Whether it was.
    active : bool
        Whether its condition still holds.
    """

    id: int
    kind: AlarmKind
    text: str
    since: float
    acknowledged: bool = False
    active: bool = True


class Alarms:
    """The alarms there are."""

    def __init__(self) -> None:
        self._by_condition: dict[str, Alarm] = {}
        self._count = 0

    def set(self, condition: str, holds: bool, t: float, kind: AlarmKind = "warning", text: str = "") -> None:
        """Say whether a condition holds; it raises its alarm once, and once more when it comes back after it was gone.

        Parameters
        ----------
        condition : str
            Its name.
        holds : bool
            Whether it holds now.
        t : float
            In s on the bridge's clock.
        kind : {"alarm", "warning", "caution"}
            How urgent it is.
        text : str
            What is the matter; the text of an alarm that is raised already follows it.
        """
        alarm = self._by_condition.get(condition)
        if holds:
            if alarm is None or (alarm.acknowledged and not alarm.active):
                self._count += 1
                self._by_condition[condition] = Alarm(self._count, kind, text, t)
            else:
                alarm.active, alarm.text = True, text
        elif alarm is not None:
            alarm.active = False
            if alarm.acknowledged:
                del self._by_condition[condition]

    def drop(self, condition: str) -> None:
        """Forget the alarm of a condition that no longer matters.

        Parameters
        ----------
        condition : str
            Its name.
        """
        self._by_condition.pop(condition, None)

    def acknowledge(self, number_of_it: int) -> None:
        """Acknowledge one alarm.

        Parameters
        ----------
        number_of_it : int
            Its id.

        Raises
        ------
        UsageError
            If there is no such alarm.
        """
        for condition, alarm in self._by_condition.items():
            if alarm.id == number_of_it:
                alarm.acknowledged = True
                if not alarm.active:
                    del self._by_condition[condition]
                return
        raise UsageError(f"there is no alarm {str(number_of_it)[:40]} to acknowledge.")

    @property
    def conditions(self) -> dict[str, Alarm]:
        """The alarms by the name of their condition."""
        return dict(self._by_condition)

    def to_list(self) -> list[Plain]:
        """Return plain values: not acknowledged first, then by urgency, then the newest first."""
        found = sorted(self._by_condition.values(), key=lambda a: (a.acknowledged, _ORDER.index(a.kind), -a.id))
        return [
            {
                "id": a.id,
                "kind": a.kind,
                "text": a.text if a.active else f"{a.text} (no longer)",
                "since": number(a.since),
                "acknowledged": a.acknowledged,
            }
            for a in found
        ]
