"""The sheet of a trial day as data: the manoeuvres with their numbers, the limits beside them, the conditions, what was not measured."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from shipid.criteria.measured.form import FormEntry
from shipid.criteria.measured.measured_criteria import MeasuredCriterion
from shipid.declaration.vocabulary import to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.numbers import counted, fixed, number, uncertain_text
from shipid.foundation.result import DrawnResult, Result, ResultEntry
from shipid.trials.conditions import Conditions
from shipid.trials.measuring.results.measures import Measures
from shipid.trials.measuring.results.turning_circle import TurningCircle
from shipid.trials.measuring.spiral import MeasuredSpiral
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    import pandas as pd

#: So many overshoots stand in the text; all are on the page.
_FIRST = 4
#: The turns of a wheelhouse poster.
QUARTERS = (90, 180, 270, 360)


@dataclass(frozen=True, eq=False, repr=False)
class SheetManoeuvre(Result):
    """One manoeuvre of the day.

    Attributes
    ----------
    number : int
        On the sheet, from 1.
    measures : Measures
        Its numbers.
    record : Trial
        The part of the log it was measured in.
    """

    number: int
    measures: Measures
    record: Trial

    def to_frame(self) -> pd.DataFrame:
        """Return its numbers as a pandas table."""
        return self.measures.to_frame()

    @property
    def title(self) -> str:
        """What it is called, with its number: ``1. zig-zag 20/20, first to port``."""
        side = getattr(self.measures, "first_side", "")
        return f"{self.number}. {self.measures.title}" + (f", first to {side}" if side else "")


@dataclass(frozen=True, repr=False)
class NotMeasured(ResultEntry):
    """A log, or a manoeuvre of it, without numbers.

    Attributes
    ----------
    trial : str
        Its name.
    why : str
        The reason.
    """

    trial: str
    why: str


@dataclass(frozen=True, eq=False, repr=False)
class TrialSheet(DrawnResult):
    """What was sailed and what it measured.

    Attributes
    ----------
    conditions : Conditions
        What is stated of the ship, her loading, the surroundings and the trial.
    length : float or None
        Ship length in m, where it is known.
    manoeuvres : tuple of SheetManoeuvre
        In the order of the logs and of time.
    criteria : tuple of MeasuredCriterion
        Their quantities beside the limits of MSC.137(76) 5.3.
    not_measured : tuple of NotMeasured
        Logs and manoeuvres without numbers, with the reason.
    warnings : tuple of Notice
        What has to be known beside the numbers.
    form : tuple of FormEntry
        Ratios that the form of MSC/Circ.1053 states, as far as what they are made of is known.
    """

    conditions: Conditions
    length: float | None
    manoeuvres: tuple[SheetManoeuvre, ...]
    criteria: tuple[MeasuredCriterion, ...]
    not_measured: tuple[NotMeasured, ...]
    warnings: tuple[Notice, ...]
    form: tuple[FormEntry, ...] = ()

    def circles(self) -> Iterator[tuple[SheetManoeuvre, TurningCircle]]:
        """Yield the turning circles: those of the wheelhouse poster."""
        for sailed in self.manoeuvres:
            if isinstance(sailed.measures, TurningCircle):
                yield sailed, sailed.measures

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values; None for what is not known, and for the blanks of the record."""
        return {
            "conditions": self.conditions.to_dict(),
            "length": {"value": self.length, "unit": "m"},
            "form": [entry.to_dict() for entry in self.form],
            "manoeuvres": [{"number": m.number, "title": m.title, **m.measures.to_dict()} for m in self.manoeuvres],
            "criteria": [row.to_dict() for row in self.criteria],
            "not_measured": [{"trial": one.trial, "why": one.why} for one in self.not_measured],
            "warnings": plain_notices(self.warnings),
        }

    def to_frame(self) -> pd.DataFrame:
        """Return one row a number of every manoeuvre: manoeuvre, title, quantity, value, unit, meaning."""
        import pandas as pd

        frames = [m.measures.to_frame().assign(manoeuvre=m.number, title=m.measures.title) for m in self.manoeuvres]
        columns = ["manoeuvre", "title", "quantity", "value", "unit", "meaning"]
        return pd.concat(frames, ignore_index=True)[columns] if frames else pd.DataFrame(columns=columns)

    def text(self) -> str:
        """Return the result in lines of text."""
        lines = [f"Trial sheet: {counted(len(self.manoeuvres), 'manoeuvre')}"]
        for m in self.manoeuvres:
            lines.append(f"  {m.title} ({m.measures.trial})")
            lines += [f"       {text}" for text in _brief(m.measures, self.length)]
        if self.criteria:
            lines.append("  beside the limits of MSC.137(76) 5.3:")
        for row in self.criteria:
            value = "not known" if row.value is None else number(row.value, 3)
            if row.value is not None and row.uncertainty is not None:
                value = uncertain_text(row.value, row.uncertainty)
            words = f"; {row.words}" if row.words else ""
            head = f"    {row.manoeuvre}. {row.meaning}"
            lines.append(f"{head:<42s} {value:>14s} {row.unit:<4s} limit {row.limit_text:<26s} {row.verdict}{words}")
        lines += [f"  not measured: {one.trial}: {one.why}" for one in self.not_measured]
        return "\n".join([*lines, *(f"  {n}" for n in self.warnings)])


def _brief(measures: Measures, length: float | None) -> Iterator[str]:
    """The numbers that people ask for first."""
    shown = {n: (v, u) for n, v, u, _ in measures.quantities()}

    def told(name: str) -> str:
        value, unit = shown[name]
        return "not known" if value is None else f"{measures.told(name, value, unit)} {unit}"

    if isinstance(measures, TurningCircle):
        for name in ("advance", "transfer", "tactical_diameter"):
            value = shown[name][0]
            ratio = f" ({number(value / length, 3)} L)" if value is not None and length else ""
            yield f"{name.replace('_', ' ')} {told(name)}{ratio}"
    elif "overshoots" in shown:
        values = shown["overshoots"][0] or ()
        listed = ", ".join("not known" if v is None else fixed(v, 2) for v in values[:_FIRST])
        left = f" (the first {_FIRST} of {len(values)})" if len(values) > _FIRST else ""
        yield f"overshoots {listed or 'none'} deg{left}; period {told('period')}"
    elif isinstance(measures, MeasuredSpiral):
        why = measures.reasons.get("loop_width") or measures.no_loop
        yield f"loop width {told('loop_width')}, loop height {told('loop_height')}" + (f": {why}" if why else "")
    elif "residual_rate" in shown:
        yield f"residual rate of turn {told('residual_rate')}"


def rudder_of(measures: Measures) -> float | None:
    """Return the rudder angle of a manoeuvre in degrees, starboard positive, or None.

    Parameters
    ----------
    measures : Measures
        Its numbers.
    """
    return None if measures.rudder is None else float(to_display(measures.rudder, "delta"))
