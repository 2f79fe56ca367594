"""Results of measuring a manoeuvre: frozen, with units, JSON-able."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from typing import ClassVar

import pandas as pd

from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import display_unit, to_display
from shipid.foundation.aliases import Plain


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


def words() -> Plain:
    """Return a field of a dataclass that says something about the manoeuvre in words."""
    return field(default="", metadata={"text": True})


@dataclass(frozen=True, repr=False, kw_only=True)
class Measures:
    """What a manoeuvre amounts to; SI inside, shown in the units of the field.

    Attributes
    ----------
    kind : str
        What the manoeuvre is.
    trial : str
        Name of the trial.
    execute : {"moved", "order"}
        How the execute was read (`shipid.trials.measuring.executes`).
    rudder, approach_speed, first_execute, course : float or None
        What every manoeuvre has; see the meaning of each in `quantities`.
    """

    kind: ClassVar[str] = "manoeuvre"
    trial: str
    execute: str
    rudder: float | None = quantity("rad", "rudder angle held, median")
    approach_speed: float | None = quantity("m/s", "speed at the first execute")
    first_execute: float | None = quantity("s", "time of the first execute")
    course: float | None = quantity("rad", "initial course")

    def quantities(self) -> Iterator[tuple[str, Plain, str, str]]:
        """Yield name, value in the unit shown (None where not reached), that unit, and meaning."""
        for entry in fields(self):
            if "unit" not in entry.metadata:
                continue
            inside = entry.metadata["unit"]
            value = getattr(self, entry.name)
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
        return result

    def to_frame(self) -> pd.DataFrame:
        """Return one row a number: quantity, value, unit, meaning (NaN where not reached)."""
        rows = []
        for name, value, unit, meaning in self.quantities():
            several = value if isinstance(value, tuple) else (value,)
            for k, single in enumerate(several, start=1):
                label = f"{name}[{k}]" if isinstance(value, tuple) else name
                rows.append((label, float("nan") if single is None else single, unit, meaning))
        return pd.DataFrame(rows, columns=["quantity", "value", "unit", "meaning"])

    def __repr__(self) -> str:
        read = "the order" if self.execute == "order" else "the rudder leaving its plate"
        lines = [f"{self.title} in trial '{self.trial}', executes read from {read}"]
        for name, value, unit, _ in self.quantities():
            if value is None or value == ():
                continue
            shown = "" if unit == "1" else " " + pretty(unit)
            several = value if isinstance(value, tuple) else (value,)
            numbers = ", ".join("not reached" if v is None else f"{v:.4g}" for v in several)
            lines.append(f"  {name.replace('_', ' '):<28s} {numbers}{shown}")
        return "\n".join(lines)

    @property
    def title(self) -> str:
        """What the manoeuvre is called."""
        return self.kind


@dataclass(frozen=True, repr=False, kw_only=True)
class ZigZag(Measures):
    """A zig-zag, in the terms of ITTC 7.5-04-02-01. `executes` are the reversals: the second execute and on.

    Attributes
    ----------
    kind : str
        ``"zig-zag"``.
    nominal : str
        Rudder angle and heading of the zig-zag, such as 20/10, to the nearest 5 deg.
    first_side : {"starboard", "port"}
        The side of the first plate measured.
    heading, period, reach, initial_turning_time, initial_turning_distance, initial_turning_ratio : float or None
        See the meaning of each in `quantities`.
    executes : tuple of float or None
        One a reversal.
    execute_headings, overshoots, extreme_headings, times_to_check_yaw : tuple of float or None
        Entry k belongs to reversal k.
    """

    kind: ClassVar[str] = "zig-zag"
    nominal: str = words()
    first_side: str = words()
    heading: float | None = quantity("rad", "heading change at the executes, median")
    executes: tuple[float | None, ...] | None = quantity("s", "times of the reversals: second execute and on")
    execute_headings: tuple[float | None, ...] | None = quantity(
        "rad", "heading at each reversal, from the initial course"
    )
    overshoots: tuple[float | None, ...] | None = quantity("rad", "overshoot angle after each reversal")
    extreme_headings: tuple[float | None, ...] | None = quantity(
        "rad", "extreme heading after each reversal, from the initial course"
    )
    times_to_check_yaw: tuple[float | None, ...] | None = quantity("s", "from each reversal to the extreme heading")
    period: float | None = quantity("s", "complete cycle: between reversals to the same side, mean")
    reach: float | None = quantity("s", "from the first execute to the return to the initial course")
    initial_turning_time: float | None = quantity("s", "from the first to the second execute")
    initial_turning_distance: float | None = quantity("m", "track between first and second execute")
    initial_turning_ratio: float | None = quantity("1", "that track in ship lengths")

    @property
    def title(self) -> str:
        """What the manoeuvre is called, such as ``zig-zag 20/10``."""
        return f"{self.kind} {self.nominal}"


@dataclass(frozen=True, repr=False, kw_only=True)
class TurningCircle(Measures):
    """A turning circle, in the terms of IMO MSC.137(76) 4.2 and ITTC 7.5-04-02-01.

    Attributes
    ----------
    kind : str
        ``"turning circle"``.
    side : {"starboard", "port"}
        The side it turns to.
    track : str
        Where the track comes from: positions, or speeds and heading.
    advance, transfer, tactical_diameter, advance_ratio, transfer_ratio, tactical_diameter_ratio : float or None
        See the meaning of each in `quantities`.
    times, speeds : tuple of float or None
        One a quarter of the circle.
    steady_rate, steady_speed, steady_drift, steady_diameter, steady_diameter_ratio, speed_loss : float or None
        Of the steady turn.
    pull_out_rate : float or None
        After the rudder was put amidships.
    """

    kind: ClassVar[str] = "turning circle"
    side: str = words()
    track: str = words()
    advance: float | None = quantity("m", "along the initial course, at 90 deg")
    transfer: float | None = quantity("m", "across the initial course, at 90 deg")
    tactical_diameter: float | None = quantity("m", "across the initial course, at 180 deg")
    advance_ratio: float | None = quantity("1", "advance in ship lengths")
    transfer_ratio: float | None = quantity("1", "transfer in ship lengths")
    tactical_diameter_ratio: float | None = quantity("1", "tactical diameter in ship lengths")
    times: tuple[float | None, ...] | None = quantity("s", "from the execute to 90, 180, 270, 360 deg")
    speeds: tuple[float | None, ...] | None = quantity("m/s", "speed at 90, 180, 270, 360 deg")
    steady_rate: float | None = quantity("rad/s", "steady rate of turn, size")
    steady_speed: float | None = quantity("m/s", "steady speed in the turn")
    steady_drift: float | None = quantity("rad", "steady drift angle, size")
    steady_diameter: float | None = quantity("m", "steady turning diameter")
    steady_diameter_ratio: float | None = quantity("1", "steady turning diameter in ship lengths")
    speed_loss: float | None = quantity("1", "share of the approach speed lost in the steady turn")
    pull_out_rate: float | None = quantity("rad/s", "rate of turn left after the pull-out, to starboard")

    @property
    def title(self) -> str:
        """What the manoeuvre is called, such as ``turning circle to port``."""
        return f"{self.kind} to {self.side}"
