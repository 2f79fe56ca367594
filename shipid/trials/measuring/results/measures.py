"""Results of measuring a manoeuvre: frozen, with units, JSON-able."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, fields
from math import pi
from typing import ClassVar

import pandas as pd

from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import display_unit, to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, notice_of, plain_notices
from shipid.foundation.numbers import fixed, uncertain_text
from shipid.foundation.result import DrawnResult
from shipid.trials.trial import Trial

#: From here on four digits are too few.
_LARGE = 1e3
#: Decimals of a measured number at the most, in the unit shown: what is smaller is noise of the arithmetic.
_DECIMALS = 3
#: Units of which no instrument of a trial shows more than three digits; an angle and a time have four.
_THREE = ("m", "m/s", "1", "deg/s")
#: Signs of a page, and what a terminal has in their place.
_PLAIN = str.maketrans("−–", "--")
#: An uncertainty of less than this share of a number is none that its digits show.
_SHOWN = 0.0005
#: Directions from 0 to 360 deg.
_AROUND_COMPASS = ("course", "drift_direction")


def quantity(unit: str, meaning: str) -> Plain:
    """Return a field of a dataclass that holds a measured quantity.

    Parameters
    ----------
    unit : str
        The unit inside.
    meaning : str
        What it is.
    """
    return field(default=None, metadata={"unit": unit, "meaning": meaning})


def measured(value: float, unit: str) -> str:
    """Return a measured number as it is shown everywhere: three or four digits, and at most three decimals.

    Parameters
    ----------
    value : float
        In the unit shown.
    unit : str
        That unit.
    """
    if unit == "s":  # Also a moment of a clock that counts from long ago keeps its hundredths, and none has more.
        return f"{round(value, 2) + 0.0:.2f}" if abs(value) >= _LARGE else f"{round(value, 2) + 0.0:.4g}"
    return f"{float(f'{round(value, _DECIMALS):.{3 if unit in _THREE else 4}g}') + 0.0:.12g}"


def words() -> Plain:
    """Return a field of a dataclass that says something about the manoeuvre in words."""
    return field(default="", metadata={"text": True})


@dataclass(frozen=True, repr=False, kw_only=True)
class Measures(DrawnResult):
    """What a manoeuvre amounts to; SI inside, shown in the units of the field.

    Attributes
    ----------
    kind : str
        What the manoeuvre is.
    part : str
        What several numbers of one quantity belong to, such as a reversal.
    columns : Mapping of str to tuple
        Title and decimals of each column of the table of these parts, by its quantity.
    beside : tuple of str
        Columns that are left out where nothing of them is known.
    trial : str
        Name of the trial.
    execute : {"order", "moved"}
        How the execute was read (`shipid.trials.measuring.rudder.executes`).
    read_from : str
        From what it was read, in words.
    rudder, rudder_rate, approach_speed, first_execute, execute_within, course : float or None
        What every manoeuvre has; see the meaning of each in `quantities`.
    reasons : Mapping of str to str
        Why a quantity is not known, by its name; entry k of several has the name ``name[k]``, counted from 1.
    notes : tuple of str
        What has to be known beside the numbers; what the doctor found is a `Notice`, serious where it misleads them.
    record : Trial or None
        The part of the trial that was measured, which a plot draws.
    """

    kind: ClassVar[str] = "manoeuvre"
    part: ClassVar[str] = ""
    columns: ClassVar[Mapping[str, tuple[str, int]]] = {}
    beside: ClassVar[tuple[str, ...]] = ()
    trial: str
    execute: str
    read_from: str = words()
    rudder: float | None = quantity("rad", "rudder angle held, median")
    rudder_rate: float | None = quantity("rad/s", "rate of the rudder on its way over, median")
    approach_speed: float | None = quantity("m/s", "speed at the first execute")
    first_execute: float | None = quantity("s", "time of the first execute")
    execute_within: float | None = quantity(
        "s", "each execute is within this time of the one stated, before or after it"
    )
    course: float | None = quantity("rad", "initial course")
    reasons: Mapping[str, str] = field(default_factory=dict, hash=False)
    notes: tuple[str, ...] = ()
    record: Trial | None = field(default=None, compare=False)

    def quantities(self) -> Iterator[tuple[str, Plain, str, str]]:
        """Yield name, value in the unit shown (None where not reached), that unit, and meaning."""
        for entry in fields(self):
            if "unit" not in entry.metadata:
                continue
            inside = entry.metadata["unit"]
            value = getattr(self, entry.name)
            if entry.name in _AROUND_COMPASS and value is not None:
                # Inside it is continuous with the heading of the trial.
                value = value % (2 * pi)
            if isinstance(value, tuple):
                value = tuple(None if v is None else to_display(v, entry.name, inside) for v in value)
            elif value is not None:
                value = to_display(value, entry.name, inside)
            yield entry.name, value, display_unit(entry.name, inside), entry.metadata["meaning"]

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values: for every quantity its value (or list), unit and meaning; None where not reached."""
        result: dict[str, Plain] = {"kind": self.kind, "trial": self.trial, "execute": self.execute}
        result |= {e.name: getattr(self, e.name) for e in fields(self) if "text" in e.metadata}
        for name, value, unit, meaning in self.quantities():
            plain = list(value) if isinstance(value, tuple) else value
            result[name] = {"value": plain, "unit": unit, "meaning": meaning}
            reason = self.reason(name)
            if reason is not None:
                result[name]["reason"] = reason
        told = plain_notices(note for note in self.notes if isinstance(note, Notice))
        return result | {"reasons": dict(self.reasons), "notes": [str(note) for note in self.notes], "warnings": told}

    def reason(self, name: str) -> str | None:
        """Return why a quantity, or entries of it, are not known; None where nothing is missing.

        Parameters
        ----------
        name : str
            Of the quantity.
        """
        own = [why for key, why in self.reasons.items() if key == name or key.startswith(f"{name}[")]
        return "; ".join(dict.fromkeys(own)) or None

    def table(self) -> tuple[list[str], list[list[str]]]:
        """Return the heads, with units, and the rows of what has one number a reversal or stage, in words; empty where nothing has."""
        shown = {name: (value or (), unit) for name, value, unit, _ in self.quantities() if name in self.columns}
        known = [name for name in self.columns if shown[name][0] or name not in self.beside]
        count = max((len(shown[name][0]) for name in known), default=0)
        if not count:
            return [], []
        heads = [self.part, *(f"{self.columns[name][0]} [{pretty(shown[name][1])}]" for name in known)]
        return heads, [[str(k + 1), *(self._cell(name, shown[name][0], k) for name in known)] for k in range(count)]

    def _cell(self, name: str, values: Plain, k: int) -> str:
        value = values[k] if k < len(values) else None
        if value is not None:
            return fixed(value, self.columns[name][1])
        return "–" if name in self.beside else "not known" if f"{name}[{k + 1}]" in self.reasons else "not reached"

    def to_frame(self) -> pd.DataFrame:
        """Return one row a number: quantity, value, unit, meaning (NaN where not reached)."""
        rows = []
        for name, value, unit, meaning in self.quantities():
            several = value if isinstance(value, tuple) else (value,)
            for k, single in enumerate(several, start=1):
                label = f"{name}[{k}]" if isinstance(value, tuple) else name
                rows.append((label, float("nan") if single is None else single, unit, meaning))
        return pd.DataFrame(rows, columns=["quantity", "value", "unit", "meaning"])

    def text(self) -> str:
        """Return the result in lines of text."""
        lines = [f"{self.title} in trial '{self.trial}'"]
        if self.read_from:
            lines.append(f"  executes read from {self.read_from}")
        lines += self._lines()
        lines += [f"  {'WARNING' if notice_of(note).serious else 'note'}: {note}" for note in self.notes]
        return "\n".join(lines)

    def _lines(self, without: Collection[str] = ()) -> list[str]:
        """One line a quantity that has a value, or a reason why it has none."""
        lines, elsewhere = [], {*without, *self.columns, *self.told_beside()}
        for name, value, unit, _ in self.quantities():
            reason = self.reason(name)
            if name in elsewhere or (reason is None and (value is None or (isinstance(value, tuple) and not value))):
                continue
            lines.append(f"  {name.replace('_', ' '):<28s} {self._shown(name, value, unit)}")
        heads, rows = self.table()
        for row in [heads, *rows] if rows else ():
            cells = (f"{cell:>{max(len(head), 11) + 2}s}" for head, cell in zip(heads[1:], row[1:]))
            lines.append(f"  {row[0]:<9s}{''.join(cells)}".translate(_PLAIN))
        return lines

    def told(self, name: str, value: float, unit: str) -> str:
        """Return one number of a quantity as a terminal and a page print it, with its uncertainty, without its unit, an ASCII minus sign.

        Parameters
        ----------
        name : str
            Of the quantity.
        value : float
            In the unit shown.
        unit : str
            That unit.
        """
        of = name.removesuffix("_ratio")
        off = getattr(self, f"{of}_uncertainty", None)
        if off is not None and (whole := getattr(self, of)) and off >= _SHOWN * abs(whole):
            return uncertain_text(value, off * value / whole)
        # Three digits, as a course is spoken: 359.98 deg is 000.0 deg.
        return f"{round(value, 1) % 360:05.1f}" if name in _AROUND_COMPASS else measured(value, unit)

    @classmethod
    def told_beside(cls) -> tuple[str, ...]:
        """Return the uncertainties that are told with the quantity they belong to."""
        names = [entry.name for entry in fields(cls)]
        return tuple(name for name in (f"{n}_uncertainty" for n in names) if name in names)

    def _shown(self, name: str, value: Plain, unit: str) -> str:
        tail = "" if unit == "1" else " " + pretty(unit)
        if value is None:
            return f"not known: {self.reasons[name]}"
        if not isinstance(value, tuple):
            return f"{self.told(name, value, unit)}{tail}"
        numbers = [
            measured(v, unit) if v is not None else "not known" if f"{name}[{k}]" in self.reasons else "not reached"
            for k, v in enumerate(value, start=1)
        ]
        reason = self.reason(name)
        return ", ".join(numbers) + tail + (f" ({reason})" if reason else "")

    @property
    def title(self) -> str:
        """What the manoeuvre is called."""
        return self.kind
