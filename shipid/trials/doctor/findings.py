"""Results of the trial doctor: findings, the manoeuvres of the record, and the diagnosis that holds both."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import given, moment, percent, quantity
from shipid.foundation.result import DrawnResult, ResultEntry, table

if TYPE_CHECKING:
    import pandas as pd

SURE = 0.8
"""Findings of at least this confidence count; one below it is worth checking by hand."""
CERTAIN = 0.9
"""Repairs of findings of at least this confidence are applied; those below it are for the user to judge."""
LEAST = 0.5
"""Findings below this confidence are no findings."""
_FULLY_TOLD = 3
"""Up to so many findings of one kind are told in full."""
MOST_SPANS = 20
"""So many spans of time at most a finding says; those beyond are joined to their neighbours."""


@dataclass(frozen=True, repr=False)
class LeftOut(ResultEntry):
    """Rows of a log that are not part of the record.

    Attributes
    ----------
    rows : int
        How many.
    why : str
        For which reason.
    """

    rows: int
    why: str

    def __str__(self) -> str:
        return f"{self.rows} left out: {self.why}"


@dataclass(frozen=True, repr=False)
class Finding(ResultEntry):
    """One fault or property of a trial.

    Attributes
    ----------
    kind : str
        Its kind, as in ``"rudder-sign"``.
    channel : str
        The column concerned, by its name inside a trial; several are joined by commas.
    rows : tuple of int
        First and last sample concerned, counted from 0.
    seconds : tuple of float
        Their times [s]; the number of the row where the clock has no time for it.
    count : int
        How many samples are concerned.
    confidence : float
        Confidence that it is there, from 0 to 1.
    effect : str
        What it does to an identification.
    repair : str
        What repairs it, in words.
    message : str
        What was found, with its numbers.
    fix : Mapping or None
        The repair as data, which `shipid.trials.doctor.repair.fix_trial` applies; None where no repair is safe.
    spoils : bool
        Whether it would spoil an identification; otherwise it is a property of the trial to know about.
    handled : bool
        Whether the format file the trial is read with already repairs it.
    spans : tuple of tuple of float
        Stretches of time [s] in which the samples concerned lie.
    """

    kind: str
    channel: str
    rows: tuple[int, int]
    seconds: tuple[float, float]
    count: int
    confidence: float
    effect: str
    repair: str
    message: str
    fix: Mapping[str, Plain] | None = None
    spoils: bool = True
    handled: bool = False
    spans: tuple[tuple[float, float], ...] = ()

    @property
    def channels(self) -> tuple[str, ...]:
        """The columns concerned."""
        return tuple(name.strip() for name in self.channel.split(","))

    @property
    def repaired(self) -> bool:
        """Whether the repair is certain enough that `shipid.trials.doctor.repair.fix_trial` applies it."""
        return self.fix is not None and self.confidence >= CERTAIN

    def touches(self, channels: Collection[str], start: float, end: float) -> bool:
        """Return whether it concerns any of some channels within a span of time.

        Parameters
        ----------
        channels : collection of str
            Columns; a fault of the clock concerns all of them.
        start, end : float
            The span [s].
        """
        mine = self.channels
        if "t" not in mine and not set(mine) & set(channels):
            return False
        return any(a <= end and b >= start for a, b in self.spans or (self.seconds,))

    @property
    def serious(self) -> bool:
        """Whether it is sure, would spoil an identification, and is not put right by the format file."""
        return self.spoils and not self.handled and self.confidence >= SURE

    def to_dict(self) -> dict[str, Plain]:
        """Return the finding as plain values."""
        return {
            "kind": self.kind,
            "channel": self.channel,
            "where": {
                "rows": list(self.rows),
                "seconds": list(self.seconds),
                "count": self.count,
                "spans": [list(span) for span in self.spans],
            },
            "confidence": round(self.confidence, 3),
            "message": self.message,
            "effect": self.effect,
            "repair": self.repair,
            "fix": None if self.fix is None else dict(self.fix),
            "spoils": self.spoils,
            "handled": self.handled,
            "serious": self.serious,
            "repaired": self.repaired,
        }

    @property
    def when(self) -> str:
        """Where in the record it lies by the clock: ``140 s``, ``45 to 278.8 s``."""
        first, last = (given(s).replace("−", "-") for s in self.seconds)
        return f"{first} s" if first == last else f"{first} to {last} s"

    @property
    def in_rows(self) -> str:
        """Where in the record it lies by its rows: ``row 700``, ``rows 225-1394``."""
        first, last = self.rows
        return f"row {first}" if first == last else f"rows {first}-{last}"

    def __str__(self) -> str:
        state = ", put right by the format file" if self.handled else ""
        head = f"{self.kind} ({self.channel}, {percent(self.confidence)}{state})"
        return f"{head}: {self.message} [{self.in_rows}, {self.when}]\n    effect: {self.effect}\n    repair: {self.repair}"


@dataclass(frozen=True, repr=False)
class Stretch(ResultEntry):
    """A manoeuvre, or a stretch without one.

    Attributes
    ----------
    kind : {"zigzag", "turn", "pull-out", "steady", "irregular"}
        What the manoeuvre is.
    start, end : float
        Times [s] of the record's clock.
    rudder_deg, heading_deg : float or None
        Nominal rudder angle, and the heading change of a zig-zag or a turn [deg]; positive to the side of the first
        execute in ``side``.
    side : {"starboard", "port"} or None
        Side of the first execute.
    regular : bool
        Whether the rudder was held and reversed as the manoeuvre asks.
    """

    kind: str
    start: float
    end: float
    rudder_deg: float | None = None
    heading_deg: float | None = None
    side: str | None = None
    regular: bool = True

    def to_dict(self) -> dict[str, Plain]:
        """Return the stretch as plain values."""
        return {
            "kind": self.kind,
            "rudder": quantity(self.rudder_deg, "deg"),
            "heading": quantity(self.heading_deg, "deg"),
            "side": self.side,
            "from": quantity(round(self.start, 3), "s"),
            "to": quantity(round(self.end, 3), "s"),
            "regular": self.regular,
        }

    def __str__(self) -> str:
        angles = ""
        if self.kind == "zigzag":
            angles = f" {self.rudder_deg:g}/{self.heading_deg:g}, first to {self.side}"
        elif self.kind == "turn":
            angles = f" with {self.rudder_deg:g} deg of rudder through {self.heading_deg:.0f} deg to {self.side}"
        return f"{moment(self.start)} to {moment(self.end)} s: {self.kind}{angles}{'' if self.regular or self.kind == 'irregular' else ' (not regular)'}"


@dataclass(frozen=True, repr=False)
class Diagnosis(DrawnResult):
    """The findings and manoeuvres of one record.

    Attributes
    ----------
    trial : str
        Name of the trial.
    findings : tuple of Finding
        The surest and worst first.
    manoeuvres : tuple of Stretch
        In order of time.
    notes : tuple of str
        How the record was read: columns guessed from their names, and so on.
    path : str or None
        The file.
    rows : int
        How many rows the record holds, as read.
    left_out : tuple of LeftOut
        Rows of it that were not examined and are not part of a repaired trial, with the reason.
    """

    trial: str
    findings: tuple[Finding, ...] = ()
    manoeuvres: tuple[Stretch, ...] = ()
    notes: tuple[str, ...] = field(default=())
    path: str | None = None
    rows: int = 0
    left_out: tuple[LeftOut, ...] = ()

    @property
    def kept(self) -> int:
        """How many rows were examined."""
        return self.rows - sum(part.rows for part in self.left_out)

    def bearing_on(
        self, channels: Collection[str], start: float = float("-inf"), end: float = float("inf")
    ) -> tuple[Finding, ...]:
        """Return the findings that concern some channels within a span of time, in the order of the diagnosis.

        Parameters
        ----------
        channels : collection of str
            Columns by their names inside a trial; a fault of the clock concerns all of them.
        start, end : float
            The span [s]; by default the whole record.

        Returns
        -------
        tuple of Finding
            What the format file has put right is not among them.
        """
        return tuple(f for f in self.findings if not f.handled and f.touches(channels, start, end))

    def within(self, start: float, end: float) -> Diagnosis:
        """Return what concerns a span of time of the record, as for a stretch that is cut out of it.

        Parameters
        ----------
        start, end : float
            The span [s].

        Returns
        -------
        Diagnosis
            The findings that touch the span, and the manoeuvres as far as they lie in it; rows are those of the whole record.
        """
        manoeuvres = [m for m in self.manoeuvres if m.start < end and m.end > start]
        return replace(
            self,
            findings=tuple(f for f in self.findings if f.touches(f.channels, start, end)),
            manoeuvres=tuple(replace(m, start=max(m.start, start), end=min(m.end, end)) for m in manoeuvres),
        )

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds found, each once."""
        return tuple(dict.fromkeys(f.kind for f in self.findings))

    @property
    def serious(self) -> tuple[Finding, ...]:
        """The findings that would spoil an identification."""
        return tuple(f for f in self.findings if f.serious)

    @property
    def verdict(self) -> str:
        """Whether an identification can use the record, in words."""
        return "not usable as it is" if self.serious else "usable"

    def to_dict(self) -> dict[str, Plain]:
        """Return the diagnosis as plain values."""
        return {
            "trial": self.trial,
            "verdict": self.verdict,
            "path": self.path,
            "findings": [f.to_dict() for f in self.findings],
            "manoeuvres": [m.to_dict() for m in self.manoeuvres],
            "notes": list(self.notes),
            "rows": {
                "read": self.rows,
                "kept": self.kept,
                "left_out": [{"rows": part.rows, "why": part.why} for part in self.left_out],
            },
        }

    def text(self) -> str:
        """Return the result in lines of text."""
        count = len(self.findings)
        head = "nothing found" if not count else f"{count} finding{'s' * (count > 1)}, {len(self.serious)} serious"
        lines = [f"Check of '{self.trial}': {self.verdict}; {head}"]
        for kind in self.kinds:
            told = [f for f in self.findings if f.kind == kind]
            # One kind in many channels is told once, and the channels on a line.
            shown = len(told) if len(told) <= _FULLY_TOLD else 1
            lines += [f"  {f}" for f in told[:shown]]
            if told[shown:]:
                also = by_words(told[shown:]).items()
                lines.append(
                    "    also: "
                    + "; ".join(
                        f"{', '.join(f'{f.channel} ({percent(f.confidence)})' for f in same)}: {words}"
                        for words, same in also
                    )
                )
        lines.append(f"  rows: {self.rows} read, {self.kept} kept" + "".join(f"; {part}" for part in self.left_out))
        if self.manoeuvres:
            lines += ["  manoeuvres", *(f"    {m}" for m in self.manoeuvres)]
        return "\n".join([*lines, *(f"  note: {note}" for note in self.notes)])

    def to_frame(self) -> pd.DataFrame:
        """Return the findings as a pandas table."""
        columns = ("channel", "serious", "confidence", "message", "effect", "repair")
        rows = (
            {
                "kind": f.kind,
                "from [s]": f.seconds[0],
                "to [s]": f.seconds[1],
                **{n: getattr(f, n) for n in columns},
            }
            for f in self.findings
        )
        return table(rows, "kind", ("from [s]", "to [s]", *columns))


def by_words(found: Sequence[Finding]) -> dict[str, list[Finding]]:
    """Return findings by what they say, so that one sentence stands once for all its channels.

    Parameters
    ----------
    found : sequence of Finding
        Of one kind.
    """
    groups: dict[str, list[Finding]] = {}
    for finding in found:
        groups.setdefault(finding.message, []).append(finding)
    return groups


def not_read(trial: str, why: str) -> Diagnosis:
    """Return the diagnosis of a file that is no trial, to stand beside those of others.

    Parameters
    ----------
    trial : str
        The file.
    why : str
        What kept it from being read.
    """
    found = Finding(
        "not-read", "t", (0, 0), (0.0, 0.0), 0, 1.0, "no identification can use it", "see what was seen", why
    )
    return Diagnosis(trial, (found,))
